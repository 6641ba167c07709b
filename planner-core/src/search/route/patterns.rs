//! Sweeps and spirals over a rectangle, and random changes of a route.

use crate::search::route::corners::Corners;

/// Random numbers that are the same on every machine (Marsaglia's xorshift, 2003).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Random(u32);

impl Random {
    pub(super) const START: Self = Self(0x9E37_79B9);

    fn bits(&mut self) -> u32 {
        // From 0 it would not get away.
        let mut x = self.0.max(1);
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        self.0 = x;
        x
    }

    /// A whole number below another.
    pub(super) fn below(&mut self, most: usize) -> usize {
        ((u64::from(self.bits()) * most as u64) >> 32) as usize
    }

    /// From one number to another.
    fn between(&mut self, [from, to]: [f32; 2]) -> f32 {
        from + (to - from) * (self.bits() >> 8) as f32 / 16_777_216.0
    }
}

/// The first way of a pattern keeps so many radii of a patch from the border, and its lanes lie so many apart.
const INSET: [f32; 2] = [0.4, 1.9];
const SPACING: [f32; 2] = [1.8, 4.0];

/// A corner is shifted by so many radii at most along either axis.
const SHIFT: f32 = 2.0;

/// The rectangle that routes stay in, and the radius of a patch.
#[derive(Clone, Copy)]
pub(super) struct RouteGround {
    pub(super) half: [f32; 2],
    pub(super) patch: f32,
}

impl RouteGround {
    fn any(self, random: &mut Random) -> [f32; 2] {
        self.half.map(|half| random.between([-half, half]))
    }

    /// A sweep or a spiral from a corner of the rectangle.
    pub(super) fn pattern(self, random: &mut Random) -> Corners {
        let inset = self.patch * random.between(INSET);
        let spacing = self.patch * random.between(SPACING);
        // Not more than leaves a lane in the middle.
        let [x, z] = self.half.map(|half| if half > inset { half - inset } else { 0.0 });
        let kind = random.below(16);
        let (is_spiral, is_across) = (kind & 1 == 0, kind & 2 == 0);
        let (along, aside) = if is_across { (z, x) } else { (x, z) };
        let place = |[a, b]: [f32; 2]| {
            let [a, b] = [if kind & 4 == 0 { a } else { -a }, if kind & 8 == 0 { b } else { -b }];
            if is_across { [b, a] } else { [a, b] }
        };
        let mut corners = Corners::new();
        if is_spiral {
            let (mut a, mut b) = (along, aside);
            let turns = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0_f32]];
            while a >= 0.0 && b >= 0.0 && !corners.is_full() {
                for [p, q] in turns {
                    let _ = corners.push(place([p * a, q * b]));
                }
                (a, b) = (a - spacing, b - spacing);
            }
        } else {
            let lanes = (2.0 * aside / spacing + 1.0) as usize;
            let apart = if lanes > 1 { 2.0 * aside / (lanes - 1) as f32 } else { 0.0 };
            let first = if lanes > 1 { aside } else { 0.0 };
            for lane in 0..lanes {
                let b = first - apart * lane as f32;
                let a = if lane % 2 == 0 { along } else { -along };
                let _ = corners.push(place([a, b])).and_then(|()| corners.push(place([-a, b])));
            }
        }
        corners
    }

    /// A route with a random change: a corner is shifted, added, left out or moved to another place in the order, or a
    /// part is turned round.
    pub(super) fn changed(self, route: &Corners, random: &mut Random) -> Corners {
        let mut corners = Corners::new();
        let _ = corners.extend_from_slice(route); // there is room
        let count = corners.len();
        let (a, b) = (random.below(count.max(1)), random.below(count.max(1)));
        match random.below(5) {
            0 => {
                if let Some(corner) = corners.get_mut(a) {
                    for (at, half) in corner.iter_mut().zip(self.half) {
                        let by = SHIFT * self.patch;
                        let to = *at + random.between([-by, by]);
                        *at = if to > half {
                            half
                        } else if to < -half {
                            -half
                        } else {
                            to
                        };
                    }
                }
            }
            1 => {
                let at = random.below(count + 1).min(count);
                let _ = corners.insert(at, self.any(random));
            }
            2 if a < count => {
                corners.remove(a);
            }
            3 => {
                let (from, to) = if a < b { (a, b) } else { (b, a) };
                corners.get_mut(from..=to).into_iter().for_each(<[_]>::reverse);
            }
            4 if a < count => {
                let corner = corners.remove(a);
                let to = random.below(count).min(corners.len());
                let _ = corners.insert(to, corner);
            }
            _ => {}
        }
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_and_changes_stay_in_the_rectangle() {
        let mut random = Random::START;
        for patch in [5.0, 20.0, 70.0] {
            let ground = RouteGround { half: [100.0, 75.0], patch };
            let is_inside = |it: &[f32; 2]| it[0].abs() <= 100.0 && it[1].abs() <= 75.0;
            let mut route = Corners::new();
            for _ in 0..300 {
                let pattern = ground.pattern(&mut random);
                assert!(!pattern.is_empty() && pattern.iter().all(is_inside), "{pattern:?}");
                route = ground.changed(&route, &mut random);
                assert!(route.iter().all(is_inside));
            }
            assert!(!route.is_empty());
        }
    }
}
