//! Decodes by `armagnac`, with the instructions added that it lacks, and keeps what was decoded.

use std::cell::RefCell;
use std::rc::Rc;

use armagnac::core::{ArmVersion, Effect, ItState, Processor, RunError};
use armagnac::decoder::{
    BasicInstructionDecoder, DecodeError, InstructionDecode, InstructionDecodeError,
};
use armagnac::instructions::{Encoding, Instruction, InstructionSize, Pattern};

use super::Core;
use super::vfp::{self, Unit};
use super::{dsp, missing_instructions};

/// A decoded instruction.
pub(super) type Decoded = Rc<dyn Instruction>;

/// Decoding is pure, and searching a hundred and fifty patterns is slow: what was decoded last is
/// kept in the slot of its code.
const SLOT_BITS: u32 = 14;

pub(super) struct Decoder {
    core: Core,
    base: BasicInstructionDecoder,
    unit: Rc<RefCell<Unit>>,
    kept: RefCell<Vec<Option<(u32, u8, Decoded)>>>,
}

impl Decoder {
    pub(super) fn new(core: Core) -> Self {
        let base = BasicInstructionDecoder::new(match core {
            Core::M0 => ArmVersion::V6M,
            Core::M4F => ArmVersion::V7EM,
        });
        Self { core, base, unit: Rc::default(), kept: RefCell::new(vec![None; 1 << SLOT_BITS]) }
    }

    fn decode(
        &self,
        code: u32,
        size: InstructionSize,
        state: ItState,
    ) -> Result<Decoded, InstructionDecodeError> {
        let added = match (size, self.core) {
            (InstructionSize::Ins16, _) => missing_instructions::decode_narrow(code, state),
            (InstructionSize::Ins32, Core::M0) => None,
            (InstructionSize::Ins32, Core::M4F) if vfp::owns(code) => {
                return vfp::decode(code, &self.unit).ok_or(InstructionDecodeError::Unknown);
            }
            (InstructionSize::Ins32, Core::M4F) if dsp::loses_flags(code) => {
                return Err(InstructionDecodeError::Unknown);
            }
            (InstructionSize::Ins32, Core::M4F) => {
                dsp::decode(code).or_else(|| missing_instructions::decode_wide(code))
            }
        };
        if let Some(added) = added {
            return Ok(added);
        }
        self.base.try_decode(code, size, state)
    }
}

impl InstructionDecode for Decoder {
    fn try_decode(
        &self,
        code: u32,
        size: InstructionSize,
        state: ItState,
    ) -> Result<Decoded, InstructionDecodeError> {
        // A halfword's code cannot be a word's: those begin with 0b111 and two bits not both 0.
        let slot = (code.wrapping_mul(0x9e37_79b1) >> (32 - SLOT_BITS)) as usize;
        if let Some((kept, within, decoded)) = &self.kept.borrow()[slot]
            && (*kept, *within) == (code, state.0)
        {
            return Ok(Rc::clone(decoded));
        }
        let decoded = self.decode(code, size, state)?;
        self.kept.borrow_mut()[slot] = Some((code, state.0, Rc::clone(&decoded)));
        Ok(decoded)
    }
}

/// An added instruction: its effect, with the fields of its code in the closure.
struct Added<F>(F);

/// Wraps the effect of an instruction.
pub(super) fn added<F>(effect: F) -> Decoded
where
    F: Fn(&mut Processor) -> Result<Effect, RunError> + 'static,
{
    Rc::new(Added(effect))
}

impl<F: Fn(&mut Processor) -> Result<Effect, RunError>> Instruction for Added<F> {
    fn patterns() -> &'static [Pattern] {
        &[]
    }

    fn try_decode(_: Encoding, _: u32, _: ItState) -> Result<Self, DecodeError> {
        Err(DecodeError::Other)
    }

    fn execute(&self, processor: &mut Processor) -> Result<Effect, RunError> {
        (self.0)(processor)
    }

    fn name(&self) -> String {
        "added".into()
    }

    fn args(&self, _pc: u32) -> String {
        String::new()
    }
}
