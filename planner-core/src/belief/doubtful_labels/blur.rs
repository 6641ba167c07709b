//! The likelihood of a label whose position errs, averaged over the lines of a hypothesis.
//!
//! A table of hypotheses needs this value some thousand times for each label, also on chips without floating-point
//! hardware. So it is computed from integers and tables.
//!
//! Let the reported position lie `s` on a line's +1 side, and let its error have the standard deviation `sigma`. The
//! true position is then on the +1 side with probability `Phi(s / sigma)`. The tolerance is three `sigma`. A logistic
//! curve approximates the normal one to 0.01. To base two it is `1 / (1 + 2^-x)`, and its integral is `x + g(x)` with
//! `g(x) = log2(1 + 2^-x)`.
//!
//! The lines of a hypothesis lie between its vertices. The distances of the vertices from the position are exact before
//! they are rounded. The distances of all lines are assumed to spread evenly about the mean of the vertices' distances.
//! They spread as far as the nearer of the two extremes. The shares that follow differ from the likelihood itself by
//! 0.0024 on average (`cargo test -p tests tolerance::`).
//!
//! The results are the same on every machine. Whatever is not an integer is a sum, product or quotient in single
//! precision.

use heapless::Vec;

use crate::belief::cells::CellView;
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::weight::LogWeight;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::line::Bound;

/// The unit of arguments of the curve, and of its integral.
const ONE: i32 = 1 << 16;

/// Larger arguments are clamped to this value, where the curve is within 2^-64 of its limit.
const BEYOND: i32 = 64 * ONE;

/// A table of a function's values, made when the program is compiled.
macro_rules! table {
    ($(#[$doc:meta])* $name:ident: [$item:ty; $len:literal] = |$k:ident| $value:expr) => {
        $(#[$doc])*
        #[expect(clippy::indexing_slicing, reason = "an error is one of compilation")]
        const $name: [$item; $len] = {
            let mut table = [0; $len];
            let mut $k = 0;
            while $k < $len {
                table[$k] = $value;
                $k += 1;
            }
            table
        };
    };
}

table! {
    /// `2^-f` for `f` from 0 to 1 in 32 parts, in units of 2^-16. Linear interpolation between entries has a relative
    /// error of 6 10^-5.
    POWERS: [u32; 33] = |k| (exp(k as f64 / -32.0 * core::f64::consts::LN_2) * 65_536.0 + 0.5) as u32
}

table! {
    /// `log2(m)` for `m` from 1 to 2 in 64 parts, in units of 2^-16. To 5 10^-5.
    LOGARITHMS: [u32; 65] =
        |k| (log1p(k as f64 / 64.0) / core::f64::consts::LN_2 * 65_536.0 + 0.5) as u32
}

table! {
    /// `log2(1 + 2^-x)` for `x` from 0 to 16 in parts of 1/16, in units of 2^-16. To 10^-4.
    SOFT: [u16; 257] = |k| {
        let power = exp(k as f64 / -16.0 * core::f64::consts::LN_2);
        let units = (log1p(power) / core::f64::consts::LN_2 * 65_536.0 + 0.5) as u32;
        if units > 65_535 { 65_535 } else { units as u16 }
    }
}

table! {
    /// `1 / sqrt(f)` for `f` from 1/4 to 1 in 192 parts, in units of 2^-14. To 6 10^-5 of it.
    ROOTS: [u16; 193] = |k| {
        let f = (k + 64) as f64 / 256.0;
        // Newton's iteration from above converges for numbers about 1.
        let mut root = 1.0;
        let mut rounds = 0;
        while rounds < 20 {
            root = 0.5 * (root + f / root);
            rounds += 1;
        }
        (16_384.0 / root + 0.5) as u16
    }
}

table! {
    /// `1 / n`, in units of 2^-16; of 0 that is 1.
    PARTS: [i32; 16] = |n| if n == 0 { ONE } else { (ONE + n as i32 / 2) / n as i32 }
}

/// The exponential function of a number from -12 to 1, when tables are made.
const fn exp(x: f64) -> f64 {
    // Of a small part, squared ten times.
    let (small, mut sum, mut term, mut k) = (x / 1_024.0, 1.0, 1.0, 1);
    while k < 10 {
        term *= small / k as f64;
        sum += term;
        k += 1;
    }
    let mut squarings = 0;
    while squarings < 10 {
        sum *= sum;
        squarings += 1;
    }
    sum
}

/// The logarithm of `1 + x` for a number from 0 to 1, when tables are made: `2 artanh(x / (2 + x))`.
const fn log1p(x: f64) -> f64 {
    let s = x / (2.0 + x);
    let (mut sum, mut power, mut k) = (0.0, s, 1);
    while k < 60 {
        sum += power / k as f64;
        power *= s * s;
        k += 2;
    }
    2.0 * sum
}

/// A value of a table whose entries are so many bits of the argument apart, by a straight line between two.
fn between(from: u32, to: u32, rest: u32, bits: u32) -> u32 {
    let by = (to.wrapping_sub(from) as i32 * rest as i32) >> bits;
    from.wrapping_add(by as u32)
}

/// `2^-x` for an argument of at least 0.
fn power(x: u32) -> f32 {
    let (whole, fraction) = (x >> 16, x & 0xffff);
    if whole >= 126 {
        return 0.0;
    }
    let k = (fraction >> 11) as usize;
    let [from, to] = [k, k + 1].map(|k| POWERS.get(k).copied().unwrap_or(1 << 15));
    let units = between(from, to, fraction & 0x7ff, 11);
    // From 2^15 to 2^16, so these are the leading digit and fifteen more.
    f32::from_bits(((126 - whole) << 23) + (units.wrapping_sub(1 << 15) << 8))
}

/// `log2(1 + 2^-x)` for an argument of at least 0.
fn soft(x: u32) -> u32 {
    let k = (x >> 12) as usize;
    match (SOFT.get(k), SOFT.get(k + 1)) {
        (Some(&from), Some(&to)) => between(from.into(), to.into(), x & 0xfff, 12),
        _ => 0,
    }
}

/// The logarithm of a positive number.
fn logarithm(value: f32) -> LogWeight {
    const LN_2: i64 = 45_426; // in units of 2^-16
    let bits = value.to_bits();
    let k = (bits >> 17 & 63) as usize;
    let [from, to] = [k, k + 1].map(|k| LOGARITHMS.get(k).copied().unwrap_or(1 << 16));
    let fraction = between(from, to, (bits & 0x1_ffff) >> 3, 14);
    let units = (((bits >> 23) as i32 - 127) << 16) + fraction as i32;
    LogWeight(i64::from(units) * LN_2)
}

/// `1 / (1 + 2^x)` for an argument of at least 0.
fn beyond(x: u32) -> f32 {
    power(x + soft(x))
}

/// The mean of `1 / (1 + 2^x)` over arguments from `near` on, `half` to either side of their middle, which is not below 0.
fn mean_beyond(near: i32, half: u32) -> f32 {
    let at = |x: i32| {
        let beyond = beyond(x.unsigned_abs());
        if x < 0 { 1.0 - beyond } else { beyond }
    };
    if half <= ONE.unsigned_abs() / 4 {
        return at(near + half as i32);
    }
    let far = near.saturating_add_unsigned(2 * half);
    if half <= ONE.unsigned_abs() {
        // By Gauss's two points: as far from the ends as 1 - 1/sqrt(3) of the half.
        let off = ((half * 27_699) >> 16) as i32;
        return 0.5 * (at(near + off) + at(far - off));
    }
    let (from, to) = (near.unsigned_abs(), far.unsigned_abs());
    let width = 2.0 * half as f32;
    if near > 8 * ONE {
        // Where the curve is all but exponential: no digits cancel.
        const LOG2_E: f32 = core::f32::consts::LOG2_E * ONE as f32;
        return LOG2_E * (power(from) - power(to)) / width;
    }
    let rise = near.min(0).unsigned_abs() + soft(from);
    rise.saturating_sub(soft(to)) as f32 / width
}

/// A vertex of a cell, which is a line: a site on it, and its unit normal in units of 2^-29.
#[derive(Clone, Copy)]
struct Ruler {
    through: Site,
    normal: Vector,
}

impl Ruler {
    /// The normal's length is right to 10^-4 of it, and its direction as its units allow.
    fn of(Bound { through, along }: Bound) -> Self {
        let square = along.dot(along).unsigned_abs();
        let even = square.leading_zeros() & !1;
        let top = (square.wrapping_shl(even) >> 32) as u32; // from 2^30 on
        let k = (top >> 24).saturating_sub(64) as usize;
        let [from, to] = [k, k + 1].map(|k| ROOTS.get(k).copied().unwrap_or(1 << 14));
        let per_length = i64::from(between(from.into(), to.into(), (top >> 10) & 0x3fff, 14));
        // The length is `2^(32 - even / 2)` times a root from a half to 1, and its inverse is in units of 2^-14.
        let unit =
            |component: i32| (((i64::from(component) * per_length) << (even / 2)) >> 17) as i32;
        let Vector { x, z } = along.left();
        Self { through, normal: Vector { x: unit(x), z: unit(z) } }
    }

    /// How far a site is on the +1 side of the vertex, lattice units: to 10^-4 of it and two more.
    fn distance(self, site: Site) -> i32 {
        ((site - self.through).dot(self.normal) >> 29) as i32
    }
}

/// The vertices of some lines, to be asked how likely labels are.
pub(crate) struct Blur<const E: usize> {
    rulers: Vec<Ruler, E, u8>,
}

impl<const E: usize> Blur<E> {
    pub(crate) fn of(lines: CellView<'_>) -> Self {
        let mut rulers = Vec::new();
        for bound in lines.bounds() {
            // There are no more vertices than edges, and `E` of these at most.
            let _ = rulers.push(Ruler::of(bound));
        }
        Self { rulers }
    }

    /// The probabilities that the true position is on the +1 side and on the -1 side if `site` is reported. Both are
    /// averages over the lines.
    pub(crate) fn sides(&self, site: Site, scale: Scale) -> [f32; 2] {
        let (mut least, mut most, mut sum) = (i32::MAX, i32::MIN, 0_i64);
        for ruler in &self.rulers {
            let distance = ruler.distance(site);
            least = least.min(distance);
            most = most.max(distance);
            sum += i64::from(distance);
        }
        let part = PARTS.get(self.rulers.len()).copied().unwrap_or(0);
        let mean = ((sum * i64::from(part)) >> 16) as i32;
        // The mean is rounded: it may be beyond an extreme by a hair.
        let half = mean.saturating_sub(least).min(most.saturating_sub(mean)).max(0);
        let near = scale.of(mean.saturating_abs().saturating_sub(half)).min(BEYOND);
        let smaller = mean_beyond(near, scale.of(half).unsigned_abs());
        if mean < 0 { [smaller, 1.0 - smaller] } else { [1.0 - smaller, smaller] }
    }

    /// The weight that some labels give the lines.
    pub(crate) fn told(&self, labels: &[Doubt]) -> LogWeight {
        let told = |doubt: &Doubt| doubt.among(self.sides(doubt.site, doubt.scale));
        labels.iter().map(told).fold(LogWeight::ZERO, core::ops::Add::add)
    }
}

/// Converts a distance into an argument of the curve.
#[derive(Clone, Copy)]
pub(crate) struct Scale {
    factor: u32,
    shift: u32,
}

impl Scale {
    pub(crate) const NONE: Self = Self { factor: 0, shift: 0 };

    /// The scale of a tolerance, which counts as one lattice unit at least. Where positions do not err, the curve is as
    /// good as a step.
    pub(crate) fn by(tolerance: Tolerance) -> Self {
        // Of the logistic curve `3 * 1.702 / tolerance`, to base two.
        const FACTOR: u32 = 482_764;
        let units = tolerance.units().max(1);
        let shift = units.ilog2();
        // `(FACTOR << shift) / units` bit by bit: a chip would carry the long division for this alone.
        let (mut rest, mut factor) = (u64::from(FACTOR) << shift, 0);
        for bit in (0..=FACTOR.ilog2()).rev() {
            let part = u64::from(units) << bit;
            if rest >= part {
                (rest, factor) = (rest - part, factor | 1 << bit);
            }
        }
        Self { factor, shift }
    }

    /// The argument of a distance, cut to what is enough.
    fn of(self, distance: i32) -> i32 {
        const MOST: i64 = 1 << 29;
        ((i64::from(distance) * i64::from(self.factor)) >> self.shift).clamp(-MOST, MOST) as i32
    }
}

/// A label that may have been read elsewhere than it was reported, ready to be weighed.
#[derive(Clone, Copy)]
pub(crate) struct Doubt {
    site: Site,
    scale: Scale,
    /// The weights of lines that have the true position on the +1 side, and of the others.
    weights: [f32; 2],
}

impl Doubt {
    pub(crate) const NONE: Self =
        Self { site: Site::ORIGIN, scale: Scale::NONE, weights: [0.0; 2] };

    pub(crate) fn new(
        Sample { site, label }: Sample,
        reliability: Reliability,
        tolerance: Tolerance,
    ) -> Self {
        let [agree, disagree] = reliability.weights();
        let is_above = label == Label::Positive;
        let weights = if is_above { [agree, disagree] } else { [disagree, agree] };
        Self { site, scale: Scale::by(tolerance), weights }
    }

    /// The weight of lines that have the true position on the +1 side and on the other with these probabilities. It is
    /// relative to the likelier label.
    fn among(&self, [above, below]: [f32; 2]) -> LogWeight {
        let [if_above, if_below] = self.weights;
        logarithm(above * if_above + below * if_below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_those_of_the_functions() {
        for n in 0..200_000_u32 {
            let x = n * 5;
            let is = f64::from(x) / f64::from(ONE);
            let near =
                |got: f64, is: f64, by: f64| assert!((got - is).abs() < by, "{x}: {got}, {is}");
            near(f64::from(power(x)) * libm::exp2(is), 1.0, 1e-4);
            near(f64::from(soft(x)) / 65_536.0, libm::log2(1.0 + libm::exp2(-is)), 1.2e-4);
            near(f64::from(beyond(x)) * (1.0 + libm::exp2(is)), 1.0, 3e-4);
            let value = f32::from_bits(0x2000_0000 + n * 2_500);
            near(logarithm(value).value(), libm::log(f64::from(value)), 1e-4 * 16.0);
        }
        assert_eq!(logarithm(1.0), LogWeight::ZERO);
    }

    #[test]
    fn a_scale_is_the_quotient() {
        for n in 0..200_000_u32 {
            let units = 1 + (n.wrapping_mul(2_654_435_761) >> (6 + n % 26));
            let tolerance = Tolerance::try_from(units).unwrap();
            let shift = units.ilog2();
            let is = (u64::from(482_764_u32) << shift) / u64::from(units);
            let Scale { factor, shift: got } = Scale::by(tolerance);
            assert_eq!((u64::from(factor), got), (is, shift), "{units}");
        }
    }

    /// Beside the mean of many points of the curve itself.
    #[test]
    fn the_mean_over_an_interval_is_that_of_the_curve() {
        for middle in (0..40).map(|n| f64::from(n) * 0.7) {
            for half in [0.0, 0.01, 0.3, 0.99, 1.01, 2.0, 7.0, 30.0] {
                let units = |x: f64| (x * f64::from(ONE)) as u32;
                let near = units(middle) as i32 - units(half) as i32;
                let got = f64::from(mean_beyond(near, units(half)));
                let points = (0..2_000).map(|n| middle + half * ((f64::from(n) + 0.5) / 1e3 - 1.0));
                let is = points.map(|x| 1.0 / (1.0 + libm::exp2(x))).sum::<f64>() / 2e3;
                assert!((got - is).abs() < 3e-4, "{middle} {half}: {got}, {is}");
                assert!((got / is - 1.0).abs() < 0.02, "{middle} {half}: {got}, {is}");
            }
        }
    }

    #[test]
    fn distances_are_those_from_the_line() {
        let site = |x, z| Site::new(x, z).unwrap();
        for n in 0..20_000_u32 {
            let random = |k: u32| {
                n.wrapping_mul(2_654_435_761).wrapping_add(k).wrapping_mul(1_640_531_527) as i32
            };
            let along = Vector { x: random(1) >> (2 + n % 27), z: random(2) >> (2 + n % 25) };
            if along == Vector::default() {
                continue;
            }
            let bound = Bound { through: site(5, -7), along };
            let q = site(random(3) >> (4 + n % 20), random(4) >> (4 + n % 20));
            let length = libm::hypot(f64::from(along.x), f64::from(along.z));
            let is = bound.at(q) as f64 / length;
            let got = f64::from(Ruler::of(bound).distance(q));
            assert!((got - is).abs() < 1e-4 * is.abs() + 2.0, "{along:?} {q:?}: {got}, {is}");
        }
    }
}
