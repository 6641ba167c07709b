//! A function: its calls, the constants that it makes, and how deep its stack is.

use std::collections::BTreeMap;

use super::image::{Image, Symbol};
use super::thumb::{self, Constant, Flow, Instruction, Stack};

/// A stack deeper than this grows in a loop. None of ours is as deep.
const BOTTOMLESS: u32 = 1 << 20;

const NOP: u16 = 0xbf00;

/// A place from which another function runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Site {
    /// Where that function begins; `None` if a register says.
    pub(super) target: Option<u32>,
    /// The caller's stack there, bytes.
    pub(super) depth: u32,
}

/// What is read from a function's code.
#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    pub(super) sites: Vec<Site>,
    /// Literals, and what pairs of `movw` and `movt` make.
    pub(super) constants: Vec<u32>,
    /// Its own stack at the deepest.
    pub(super) depth: u32,
}

/// An instruction, and whether a condition before it decides on it.
type Code = BTreeMap<u32, (Instruction, bool)>;

impl Body {
    /// Follows a function's code along every path. Where paths meet, the deeper stack counts.
    pub(super) fn of(image: &Image, function: &Symbol) -> Result<Self, String> {
        let code = decode(image, function)?;
        let mut body = Self { constants: constants(image, &code), ..Self::default() };
        let mut depths = BTreeMap::new();
        let mut open = vec![(function.address, 0)];
        while let Some((at, depth)) = open.pop() {
            if depths.get(&at).is_some_and(|seen| *seen >= depth) {
                continue;
            }
            depths.insert(at, depth);
            let Some((instruction, conditional)) = code.get(&at) else {
                return Err(format!("{} runs off its code at {at:#010x}", function.name));
            };
            let Some((after, deepest)) = moved(depth, instruction.stack) else {
                return Err(format!("{} moves the stack pointer at {at:#010x}", function.name));
            };
            if deepest > BOTTOMLESS {
                return Err(format!("{} has a stack without an end", function.name));
            }
            body.depth = body.depth.max(deepest);
            let next = at + instruction.size;
            let mut go = |to: u32, depth: u32, sites: &mut Vec<Site>| {
                if function.holds(to) {
                    open.push((to, depth));
                } else {
                    sites.push(Site { target: Some(to), depth });
                }
            };
            // A call at the very end, but for padding, is one that never returns.
            let padding = |at: &u32| image.halfword(*at) == Some(NOP);
            let returns = (next..).step_by(2).find(|at| !padding(at));
            let returns = returns.is_some_and(|at| code.contains_key(&at));
            let mut falls = *conditional;
            match instruction.flow {
                Flow::Next => falls = true,
                Flow::Branch(to) => go(to, after, &mut body.sites),
                Flow::Either(to) => {
                    go(to, after, &mut body.sites);
                    falls = true;
                }
                Flow::Call(to) => {
                    body.sites.push(Site { target: Some(to), depth: after });
                    falls |= returns;
                }
                Flow::CallRegister => {
                    body.sites.push(Site { target: None, depth: after });
                    falls |= returns;
                }
                Flow::JumpRegister => body.sites.push(Site { target: None, depth: after }),
                Flow::Table(width) => {
                    for to in table(image, next, width) {
                        go(to, after, &mut body.sites);
                    }
                }
                Flow::Return | Flow::Trap => {}
                Flow::Unknown => {
                    let name = &function.name;
                    return Err(format!("{name} holds what is not known here, at {at:#010x}"));
                }
            }
            if falls {
                // Passed over, it leaves the stack as it was.
                open.push((next, if *conditional { depth.max(after) } else { after }));
            }
        }
        Ok(body)
    }
}

/// The stack after an instruction, and the deepest it was by then; `None` if that is not known.
fn moved(depth: u32, stack: Stack) -> Option<(u32, u32)> {
    match stack {
        Stack::Still => Some((depth, depth)),
        Stack::Grows(bytes) => Some((depth + bytes, depth + bytes)),
        Stack::Shrinks(bytes) => Some((depth.saturating_sub(bytes), depth)),
        Stack::Moves => None,
    }
}

fn decode(image: &Image, function: &Symbol) -> Result<Code, String> {
    let mut code = Code::new();
    let (mut at, end) = (function.address, function.address + function.size);
    let mut conditions = 0_u32;
    while at < end {
        if !image.is_code(at) {
            at += 2;
            continue;
        }
        let first = image.halfword(at).ok_or_else(|| format!("no code at {at:#010x}"))?;
        let second = if thumb::is_wide(first) { image.halfword(at + 2) } else { Some(0) };
        let second = second.ok_or_else(|| format!("no code at {at:#010x}"))?;
        let instruction = Instruction::decode(at, first, second);
        code.insert(at, (instruction, conditions > 0));
        conditions = instruction.conditions.max(conditions.saturating_sub(1));
        at += instruction.size;
    }
    Ok(code)
}

/// Where a table leads. It goes as far as there is no code; a last byte may be for alignment.
fn table(image: &Image, start: u32, width: u32) -> Vec<u32> {
    let entries = (start..).step_by(width as usize).take_while(|at| !image.is_code(*at));
    let offset = |at: u32| match width {
        1 => image.bytes::<1>(at).map(|[it]| u32::from(it)),
        _ => image.halfword(at).map(u32::from),
    };
    let targets = entries.map_while(offset).map(|it| start + 2 * it);
    targets.filter(|to| image.is_code(*to)).collect()
}

fn constants(image: &Image, code: &Code) -> Vec<u32> {
    let mut low = [None; 16];
    let mut constants = Vec::new();
    for (instruction, _) in code.values() {
        match instruction.constant {
            Some(Constant::Low(register, half)) => low[usize::from(register)] = Some(half),
            Some(Constant::High(register, half)) => {
                let low = low[usize::from(register)].take().map_or(0, u32::from);
                constants.push(u32::from(half) << 16 | low);
            }
            Some(Constant::Literal(at)) => constants.extend(image.word(at)),
            None => {}
        }
    }
    constants
}
