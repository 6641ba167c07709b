//! Quick approximations in single precision, the same on every machine. They propose and never decide:
//! whoever uses one leaves room for its error.

/// Half a turn in the units of angles here: a quarter of a binary angle's size, so that sums of three
/// half turns are still an `i32`.
pub(crate) const HALF_TURN: i32 = 1 << 29;

const QUARTER_TURN: i32 = HALF_TURN / 2;

/// The units of angles here in a radian.
pub(crate) const UNITS_PER_RADIAN: f32 = HALF_TURN as f32 / core::f32::consts::PI;

/// The square root of a number that is not negative, to 10^-5 of it. Newton's method on `1 / sqrt(x)`.
pub(crate) fn sqrt(x: f32) -> f32 {
    let mut inverse = f32::from_bits(0x5f37_59df - (x.to_bits() >> 1));
    for _ in 0..2 {
        inverse *= 1.5 - 0.5 * x * inverse * inverse;
    }
    x * inverse
}

/// The arc cosine of a number in [-1, 1], in units of which [`HALF_TURN`] is half a turn, to 10^-4 rad.
/// In the middle by the arc sine, without a root; beyond by Abramowitz and Stegun, 4.4.45.
#[inline(never)] // it is called in three places of one small function
pub(crate) fn acos(x: f32) -> i32 {
    let size = x.abs();
    if size < 0.6 {
        let s = x * x;
        let asin = x * (1.0 + s * (0.167_385_2 + s * (0.065_445_93 + s * 0.080_477_12)));
        return QUARTER_TURN - (asin * UNITS_PER_RADIAN) as i32;
    }
    let cubic = 1.570_728_8 + size * (-0.212_114_4 + size * (0.074_261 - size * 0.018_729_3));
    let angle = (sqrt(1.0 - size) * cubic * UNITS_PER_RADIAN) as i32;
    if x < 0.0 { HALF_TURN - angle } else { angle }
}

/// The angle of a vector against the x axis as a binary angle, to 10^-5 rad.
pub(crate) fn atan2(z: f32, x: f32) -> u32 {
    let (along, up) = (x.abs(), z.abs());
    let t = if up > along { along / up } else { up / along };
    let s = t * t;
    let tail = -0.116_432_87 + s * (0.052_653_32 - s * 0.011_721_2);
    let octant = t * (0.999_977_26 + s * (-0.332_623_47 + s * (0.193_543_46 + s * tail)));
    let octant = (octant * UNITS_PER_RADIAN) as i32;
    let quadrant = if up > along { QUARTER_TURN - octant } else { octant };
    let half = if x < 0.0 { HALF_TURN - quadrant } else { quadrant };
    (if z < 0.0 { -half } else { half } as u32) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radians(angle: i32) -> f64 {
        f64::from(angle) * core::f64::consts::PI / f64::from(HALF_TURN)
    }

    #[test]
    fn errors_are_as_stated() {
        for n in 0..=20_000 {
            let x = n as f32 / 10_000.0 - 1.0;
            assert!((radians(acos(x)) - f64::from(x).acos()).abs() < 1e-4, "acos {x}");
            let (sin, cos) = (n as f32 / 1000.0).sin_cos();
            for scale in [1e-3, 1.0, 1e9] {
                let (z, x) = (scale * sin, scale * cos);
                let off = radians(atan2(z, x) as i32 >> 2) - f64::from(z).atan2(f64::from(x));
                assert!(off.sin().abs() < 1e-5, "atan2 {z} {x}: {off}");
            }
            let y = n as f32 * n as f32 * 1e9 + 1e-3;
            let off = f64::from(sqrt(y)) / f64::from(y).sqrt() - 1.0;
            assert!(off.abs() < 1e-5, "sqrt {y}: {off}");
        }
        assert!(sqrt(0.0).abs() < 1e-30);
        assert_eq!(atan2(0.0, -1.0), 1 << 31);
    }
}
