//! The floating-point unit of a Cortex-M4F (FPv4-SP): its registers, transfers and instructions.
//!
//! Left out, and so unknown: half precision, fixed point, and FPSCR but for its four flags. The rest
//! of that stays as reset leaves it.

use std::cell::RefCell;
use std::rc::Rc;

use armagnac::core::Effect;
use armagnac::instructions::DecodeHelper;

use super::decoder::{Decoded, added};
use super::single;

/// Registers s0 to s31 and the flags N, Z, C, V of FPSCR, the highest bit first.
#[derive(Default)]
pub(super) struct Unit {
    s: [u32; 32],
    flags: u32,
}

impl Unit {
    fn float(&self, index: usize) -> f32 {
        f32::from_bits(self.s[index])
    }
}

/// Whether a code is in the unit's space: coprocessors 10 and 11.
pub(super) fn owns(code: u32) -> bool {
    code & 0xec00_0e00 == 0xec00_0a00
}

pub(super) fn decode(code: u32, unit: &Rc<RefCell<Unit>>) -> Option<Decoded> {
    let unit = Rc::clone(unit);
    match code >> 24 {
        0xec | 0xed if code & 0x0fe0_0000 == 0x0c40_0000 => move_pair(code, unit),
        0xec | 0xed => load_or_store(code, unit),
        0xee if code & 0x10 != 0 => move_one(code, unit),
        0xee if code & 0x100 == 0 => compute(code, unit),
        _ => None,
    }
}

/// Whether the code speaks of double registers.
fn double(code: u32) -> bool {
    code & 0x100 != 0
}

/// The register that four bits and one bit name, as an index into the singles.
fn register(code: u32, four: u32, one: u32) -> Option<usize> {
    let (four, one) = ((code >> four & 0xf) as usize, (code >> one & 1) as usize);
    if double(code) { (one == 0).then_some(four << 1) } else { Some(four << 1 | one) }
}

/// VMOV of two core registers to or from two singles or a double.
fn move_pair(code: u32, unit: Rc<RefCell<Unit>>) -> Option<Decoded> {
    let registers = [code.reg4(12), code.reg4(16)];
    let first = register(code, 0, 5)?;
    if code & 0xd0 != 0x10 || first == 31 {
        return None;
    }
    let to_core = code >> 20 & 1 == 1;
    Some(added(move |p| {
        for (s, &r) in unit.borrow_mut().s[first..].iter_mut().zip(&registers) {
            if to_core {
                p.set(r, *s);
            } else {
                *s = p[r];
            }
        }
        Ok(Effect::None)
    }))
}

/// VLDR, VSTR, VLDM, VSTM, VPUSH, VPOP.
fn load_or_store(code: u32, unit: Rc<RefCell<Unit>>) -> Option<Decoded> {
    let [index, up, write_back, load] = [24, 23, 21, 20].map(|bit| code >> bit & 1 == 1);
    let (rn, first, words) = (code.reg4(16), register(code, 12, 22)?, (code & 0xff) as usize);
    let one = index && !write_back;
    let count = if !one {
        words
    } else if double(code) {
        2
    } else {
        1
    };
    let several = matches!((index, up, write_back), (false, true, _) | (true, false, true));
    // An odd count of a double's words is the obsolete FLDMX.
    let odd = !one && double(code) && count % 2 == 1;
    if !(one || several) || count == 0 || odd || first + count > 32 {
        return None;
    }
    Some(added(move |p| {
        let base = if rn.is_pc() { p.pc() & !3 } else { p[rn] };
        let offset = (words as u32) << 2;
        let moved = if up { base.wrapping_add(offset) } else { base.wrapping_sub(offset) };
        let mut address = if index { moved } else { base };
        for s in &mut unit.borrow_mut().s[first..first + count] {
            if load {
                *s = p.read_u32_aligned(address)?;
            } else {
                p.write_u32_aligned(address, *s)?;
            }
            address = address.wrapping_add(4);
        }
        if write_back {
            p.set(rn, moved);
        }
        Ok(Effect::None)
    }))
}

/// VMOV of one core register to or from a single or half a double; VMRS.
fn move_one(code: u32, unit: Rc<RefCell<Unit>>) -> Option<Decoded> {
    let rt = code.reg4(12);
    let to_core = code >> 20 & 1 == 1;
    let index = match (code >> 21 & 7, double(code)) {
        (0, false) => register(code, 16, 7)?,
        (half @ 0..=1, true) if code & 0x60 == 0 => register(code, 16, 7)? + half as usize,
        (7, false) if code & 0x001f_f000 == 0x0011_f000 => return Some(flags_to_core(unit)),
        _ => return None,
    };
    Some(added(move |p| {
        if to_core {
            p.set(rt, unit.borrow().s[index]);
        } else {
            unit.borrow_mut().s[index] = p[rt];
        }
        Ok(Effect::None)
    }))
}

/// VMRS to the core's flags. FPSCR has more, which is not kept: reading or writing all of it is not
/// known.
fn flags_to_core(unit: Rc<RefCell<Unit>>) -> Decoded {
    added(move |p| {
        let q = u8::from(p.registers.psr.q());
        p.registers.psr.set_flags((unit.borrow().flags << 1) as u8 | q);
        Ok(Effect::None)
    })
}

/// Data processing on singles.
fn compute(code: u32, unit: Rc<RefCell<Unit>>) -> Option<Decoded> {
    let (d, n, m) = (register(code, 12, 22)?, register(code, 16, 7)?, register(code, 0, 5)?);
    let minus = code & 0x40 != 0;
    // The second bit of the opcode is register bits between its two neighbours.
    let operation = code >> 21 & 4 | code >> 20 & 3;
    if operation == 7 {
        return compute_one(code, d, m, unit);
    }
    if operation == 4 && minus {
        return None;
    }
    Some(added(move |_| {
        let mut unit = unit.borrow_mut();
        let [sum, a, b] = [d, n, m].map(|index| unit.float(index));
        let negated = |negate: bool, value: f32| if negate { -value } else { value };
        let result = match operation {
            // VMLA, VMLS: rounded twice
            0 => single::add(sum, negated(minus, single::multiply(a, b))),
            // VNMLS, VNMLA
            1 => single::add(-sum, negated(minus, single::multiply(a, b))),
            // VMUL, VNMUL
            2 => negated(minus, single::multiply(a, b)),
            // VADD, VSUB
            3 if minus => single::subtract(a, b),
            3 => single::add(a, b),
            4 => single::divide(a, b),
            // VFNMS, VFNMA
            5 => single::fused(-sum, negated(minus, a), b),
            // VFMA, VFMS
            _ => single::fused(sum, negated(minus, a), b),
        };
        unit.s[d] = result.to_bits();
        Ok(Effect::None)
    }))
}

/// Data processing with one operand.
fn compute_one(code: u32, d: usize, m: usize, unit: Rc<RefCell<Unit>>) -> Option<Decoded> {
    let [high, odd] = [7, 6].map(|bit| code >> bit & 1 == 1);
    let signed = code >> 16 & 1 == 1;
    let effect: Box<dyn Fn(&mut Unit)> = match (code >> 16 & 0xf, odd, high) {
        (upper, false, false) if code & 0x20 == 0 => {
            let constant = single::immediate(upper << 4 | code & 0xf).to_bits();
            Box::new(move |u| u.s[d] = constant)
        }
        // VMOV, VABS, VNEG: on bits, so that NaNs pass
        (0, true, false) => Box::new(move |u| u.s[d] = u.s[m]),
        (0, true, true) => Box::new(move |u| u.s[d] = u.s[m] & 0x7fff_ffff),
        (1, true, false) => Box::new(move |u| u.s[d] = u.s[m] ^ 0x8000_0000),
        (1, true, true) => Box::new(move |u| u.s[d] = single::square_root(u.float(m)).to_bits()),
        // VCMP, VCMPE: they differ in a sticky flag
        (4, true, _) => Box::new(move |u| u.flags = single::compare(u.float(d), u.float(m))),
        (5, true, _) => Box::new(move |u| u.flags = single::compare(u.float(d), 0.0)),
        // VCVT, VCVTR
        (8, true, signed) => {
            Box::new(move |u| u.s[d] = single::from_integer(u.s[m], signed).to_bits())
        }
        (12..=13, true, toward_zero) => {
            Box::new(move |u| u.s[d] = single::to_integer(u.float(m), signed, toward_zero))
        }
        _ => return None,
    };
    Some(added(move |_| {
        effect(&mut unit.borrow_mut());
        Ok(Effect::None)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_unit_lacks_is_unknown() {
        let unit = Rc::default();
        // vadd.f64, vcvtb.f32.f16, vseleq.f32, vrintz.f32, vmrs r0, fpscr
        for code in [0xee31_0b02, 0xeeb2_0a40, 0xfe00_0a81, 0xeeb6_0ac0, 0xeef1_0a10] {
            assert!(owns(code) && decode(code, &unit).is_none(), "{code:#x}");
        }
    }
}
