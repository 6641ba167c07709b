//! The prediction of a robot that also reads labels on its way: what all labels of a motion are expected to tell together.
//!
//! Readings divide the lines by the piece of the way on which each line is crossed, and a straight way crosses a line once.
//! So the shares of lines above the places that are read also say how many lines are crossed between two of them. What the
//! labels tell is the information that they carry about the piece.
//!
//! At most four places stand for all readings. An arc is taken for its chord.

use crate::belief::predictions::predictor::{Prediction, Predictor, entropy, log2};
use crate::belief::sample::Label;
use crate::geometry::lattice::{Site, Vector};

/// Places on the way that are asked at most, the end included.
const PLACES: usize = 4;

/// The most that labels at so many places tell where they are true, bits: log2(n + 1).
const MOST: [f32; PLACES + 1] = [1.0, 1.0, 1.584_962_5, 2.0, 2.321_928];

/// Labels that are true less often are so faint that each tells nearly as much as it would alone.
const FAINT: f32 = 0.5625;

/// A prediction for motions from a place, each with so many readings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnTheWay<P> {
    prediction: P,
    from: Site,
    places: u8,
}

impl<P: Prediction> OnTheWay<P> {
    /// With so many readings a motion, the one at its end included.
    pub(crate) const fn new(prediction: P, from: Site, readings: u8) -> Self {
        let places = match readings {
            0 => 1,
            few if few < PLACES as u8 => few,
            _ => PLACES as u8,
        };
        Self { prediction, from, places }
    }

    /// How much more all labels on the way to a place tell than the one at its end, in labels that tell the most.
    #[inline(never)]
    fn more(&self, to: Site, share: f32) -> f32 {
        let p = self.prediction.reliability(to);
        let (by, places) = (to - self.from, i32::from(self.places));
        let (mut above, mut faint) = ([share; PLACES], 0.0);
        for (k, above) in (1..places).zip(&mut above) {
            // Wide enough: a way is shorter than 2^30 lattice units.
            let part = |units: i32| (i64::from(units) * i64::from(k) / i64::from(places)) as i32;
            let Ok(site) = self.from.step(Vector { x: part(by.x), z: part(by.z) }) else {
                continue;
            };
            *above = self.prediction.share_above(site);
            if p < FAINT {
                faint += self.prediction.information(site, *above);
            }
        }
        if p < FAINT {
            return faint;
        }
        let above = above.map(|it| it.clamp(0.0, 1.0));
        let along = above.get(..usize::from(self.places)).unwrap_or_default();
        (told(along, p) - told(&[share.clamp(0.0, 1.0)], p)) / (1.0 - entropy(p))
    }
}

/// The information of labels along a way, bits. The shares of lines above each place are given, and how often labels are
/// true.
#[inline(never)] // one for all beliefs
fn told(above: &[f32], p: f32) -> f32 {
    let (mut least, mut most, mut sum) = (1.0_f32, 0.0_f32, 0.0_f32);
    for (k, &share) in above.iter().enumerate() {
        least = if share < least { share } else { least };
        most = if share > most { share } else { most };
        let before = k.checked_sub(1).and_then(|k| above.get(k));
        sum += before.map_or(0.0, |before| (share - before).abs());
    }
    // A way that leads to and fro in doubt crosses some lines twice.
    let scale = if sum > 0.0 { (most - least) / sum } else { 0.0 };
    let pieces = above.iter().zip(above.get(1..).unwrap_or_default());
    let groups = pieces.map(|(before, after)| scale * (after - before));
    if p >= 1.0 {
        return of_true([least, 1.0 - most].into_iter().chain(groups.map(f32::abs)));
    }
    of_doubtful([least, most], &groups, above.len() as u32, p)
}

/// The information of so many labels that are true with probability `p`, bits. The shares of lines above all places and
/// above any are given, and by how much the share grows from each place to the next.
fn of_doubtful(
    [least, most]: [f32; 2],
    groups: &(impl Iterator<Item = f32> + Clone),
    count: u32,
    p: f32,
) -> f32 {
    let labels = (0..1_u32 << count).map(|labels| {
        // One bit for each place, the first the lowest; all below, all above, and crossed after each place.
        let agree = |truth: u32| count - (labels ^ truth).count_ones();
        let chance = |truth: u32| powers(p, agree(truth)) * powers(1.0 - p, count - agree(truth));
        let all = (1 << count) - 1;
        let mut sum = (1.0 - most) * chance(0) + least * chance(all);
        for (k, share) in (1..).zip(groups.clone()) {
            let first = (1 << k) - 1;
            // The share of lines above grows: these are above from here on.
            sum += share.abs() * chance(if share > 0.0 { all - first } else { first });
        }
        -sum * log2(sum)
    });
    labels.sum::<f32>() - count as f32 * entropy(p)
}

/// The entropy of some shares that sum up to 1, bits.
fn of_true(shares: impl Iterator<Item = f32>) -> f32 {
    let (mut rest, mut bits) = (1.0_f32, 0.0);
    for share in shares {
        if share > 0.0 && share < rest {
            bits += rest * entropy(share / rest);
        }
        rest -= share;
    }
    bits
}

/// A power of a number, by the order of its factors.
fn powers(base: f32, exponent: u32) -> f32 {
    (0..exponent).map(|_| base).product()
}

impl<P: Prediction> Prediction for OnTheWay<P> {
    fn share_above(&self, site: Site) -> f32 {
        self.prediction.share_above(site)
    }

    fn information(&self, site: Site, share: f32) -> f32 {
        self.prediction.information(site, share)
    }

    fn reliability(&self, site: Site) -> f32 {
        self.prediction.reliability(site)
    }

    fn asks(&self) -> u32 {
        u32::from(self.places)
    }

    fn most(&self) -> f32 {
        MOST.get(usize::from(self.places)).copied().unwrap_or(1.0)
    }

    fn brings(&self, site: Site, share: f32, information: f32) -> f32 {
        let more = || (information + self.more(site, share)) / self.most();
        if self.places < 2 { information } else { more() }
    }
}

impl<P: Predictor> Predictor for OnTheWay<P> {
    type After<'a>
        = OnTheWay<P::After<'a>>
    where
        Self: 'a;

    fn chance(&self, site: Site, share: f32) -> f32 {
        self.prediction.chance(site, share)
    }

    fn after(&self, site: Site, label: Label) -> Self::After<'_> {
        OnTheWay::new(self.prediction.after(site, label), site, self.places)
    }
}

#[cfg(test)]
mod tests {
    use heapless::Vec;

    use super::*;
    use crate::draws::Draws;

    /// The same by definition, in double precision: the entropy of the labels, less what is left of it where it is known
    /// which places lie above.
    fn exactly(groups: &[(f64, [bool; PLACES])], count: usize, p: f64) -> f64 {
        let entropy = |of: &dyn Fn(usize) -> f64| -> f64 {
            (0..1 << count).map(of).filter(|it| *it > 0.0).map(|it| -it * it.log2()).sum()
        };
        let given = |labels: usize, above: &[bool; PLACES]| -> f64 {
            let is_read = |k: usize| labels & (1 << k) != 0;
            (0..count).map(|k| if is_read(k) == above[k] { p } else { 1.0 - p }).product()
        };
        let all = entropy(&|labels| groups.iter().map(|(m, above)| m * given(labels, above)).sum());
        let left = groups.iter().map(|(m, above)| m * entropy(&|labels| given(labels, above)));
        all - left.sum::<f64>()
    }

    #[test]
    fn labels_on_a_way_tell_what_they_tell_by_definition() {
        let mut draws = Draws::new(3);
        for case in 0..2_000 {
            let count = 1 + case % PLACES;
            let grows = case % 2 == 0;
            // Below all, crossed before each place but the first, above all.
            let mut masses: [f64; PLACES + 1] = [(); PLACES + 1].map(|()| draws.unit());
            masses.iter_mut().skip(count + 1).for_each(|it| *it = 0.0);
            let sum: f64 = masses.iter().sum();
            let groups: Vec<_, 5, u8> = (0..=count)
                .map(|from| {
                    // Above from here on, or up to here.
                    let mut above = [false; PLACES];
                    (0..count).for_each(|k| above[k] = (k >= from) == grows);
                    (masses[from] / sum, above)
                })
                .collect();
            let share = |k: usize| groups.iter().filter(|it| it.1[k]).map(|it| it.0).sum::<f64>();
            let shares: Vec<f32, 4, u8> = (0..count).map(|k| share(k) as f32).collect();
            for p in [1.0, 0.95, 0.8, 0.6] {
                let (got, is) = (f64::from(told(&shares, p as f32)), exactly(&groups, count, p));
                assert!((got - is).abs() < 0.01, "case {case}, {p}: {got}, {is}");
                assert!(got < f64::from(MOST[count]) + 0.01, "case {case}: {got}");
            }
        }
    }
}
