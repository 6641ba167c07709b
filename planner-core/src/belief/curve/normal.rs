//! The normal distribution in single precision, the same on every machine.

/// 1 / sqrt(2 pi).
const PEAK: f32 = 0.398_942_3;

/// Beyond so many deviations the tail is a continued fraction.
const FAR: f32 = 3.0;

/// The distribution function at a number of deviations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Normal {
    pub(crate) below: f32,
    /// The density over what lies below: the inverse of Mills' ratio.
    pub(crate) hazard: f32,
}

impl Normal {
    /// To 10^-6; `hazard` to 10^-3 of it. Some 150 instructions.
    pub(crate) fn at(u: f32) -> Self {
        let size = u.abs();
        let density = PEAK * libm::expf(-0.5 * u * u);
        let mills = mills(size);
        let tail = density * mills;
        if u < 0.0 {
            Self { below: tail, hazard: 1.0 / mills }
        } else {
            Self { below: 1.0 - tail, hazard: density / (1.0 - tail) }
        }
    }

    /// The distribution function alone.
    pub(crate) fn below(u: f32) -> f32 {
        Self::at(u).below
    }
}

/// The tail over the density, of a number that is not negative. Abramowitz and Stegun, 26.2.17 and 26.2.14.
fn mills(x: f32) -> f32 {
    if x > FAR {
        return 1.0 / (x + 1.0 / (x + 2.0 / (x + 3.0 / (x + 4.0 / (x + 5.0 / (x + 1.2))))));
    }
    let t = 1.0 / (1.0 + 0.231_641_9 * x);
    let high = -1.821_256 + t * 1.330_274_4;
    t * (0.319_381_53 + t * (-0.356_563_78 + t * (1.781_477_9 + t * high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_as_stated() {
        for n in -1_200..1_200 {
            let u = f64::from(n) * 0.01;
            let below = 0.5 * libm::erfc(-u / core::f64::consts::SQRT_2);
            let density = libm::exp(-0.5 * u * u) * f64::from(PEAK);
            let got = Normal::at(u as f32);
            assert!((f64::from(got.below) - below).abs() < 1e-6, "{u}: {got:?}");
            if below > 0.0 {
                let hazard = density / below;
                assert!(
                    (f64::from(got.hazard) / hazard - 1.0).abs() < 1e-3,
                    "{u}: {got:?} {hazard}"
                );
            }
        }
    }
}
