//! The arc beside which offsets are told: a place, a direction, and a curvature.

use crate::belief::front::{Unit, angle, limited, metres};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};

/// An arc is looked at no further than this, radians.
const TURN: f32 = 1.2;

/// A way on the inner side counts as no shorter than this share of that on the arc.
const INNER: f32 = 0.3;

/// Times that the nearest place of an arc is computed anew.
const CLOSER: u32 = 3;

/// An arc. Lengths are in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Arc {
    pub(crate) site: Site,
    /// Along the front, the way that the robot goes.
    pub(crate) heading: Heading,
    /// 1/m, positive to the left.
    pub(crate) bend: f32,
}

/// Where a site lies beside an arc, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Along the arc.
    pub(crate) along: f32,
    /// To the left of it.
    pub(crate) left: f32,
}

/// Sine and cosine of an angle up to [`TURN`], to 10^-4.
fn sin_cos(angle: f32) -> [f32; 2] {
    let square = angle * angle;
    let sin = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square / 5_040.0)));
    let cos =
        1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square / 40_320.0)));
    [sin, cos]
}

impl Arc {
    /// A length along it, no further than it is looked at.
    fn within(&self, along: f32) -> f32 {
        limited(along, TURN / (self.bend.abs() + 1e-6))
    }

    /// The place so far along it, ahead of its own and to the left.
    fn place(&self, along: f32) -> [f32; 2] {
        let t = self.bend * along;
        let square = t * t;
        let ahead = 1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square / 5_040.0));
        let left = t * (0.5 - square * (1.0 / 24.0 - square / 720.0));
        [along * ahead, along * left]
    }

    /// Where a site lies beside it.
    pub(crate) fn see(&self, site: Site) -> Seen {
        let at = Unit::of(self.heading).seen(metres(site - self.site));
        let mut along = self.within(at[0]);
        let mut left = 0.0;
        for _ in 0..=CLOSER {
            let place = self.place(along);
            let [sin, cos] = sin_cos(self.bend * along);
            let off = [at[0] - place[0], at[1] - place[1]];
            left = cos * off[1] - sin * off[0];
            // Along an arc a way beside it is shorter on the inner side.
            let per = 1.0 - self.bend * left;
            let per = if per > INNER { per } else { INNER };
            along = self.within(along + (cos * off[0] + sin * off[1]) / per);
        }
        Seen { along, left }
    }

    /// The site so far along it and to its left.
    pub(crate) fn site_at(&self, along: f32, left: f32) -> Site {
        let along = self.within(along);
        let [ahead, aside] = self.place(along);
        let [sin, cos] = sin_cos(self.bend * along);
        let at = [ahead - left * sin, aside + left * cos];
        let Unit { x, z } = Unit::of(self.heading);
        let units = UNITS_PER_METRE as f32;
        let [x, z] = [x * at[0] - z * at[1], z * at[0] + x * at[1]].map(|it| (it * units) as i32);
        let by = Vector::new(x, z).unwrap_or_default();
        self.site.step(by).unwrap_or(self.site)
    }

    /// Its direction so far along it.
    pub(crate) fn heading_at(&self, along: f32) -> Heading {
        self.heading.turned(angle(self.bend * self.within(along)))
    }

    /// The arc from a place on it on.
    pub(crate) fn from(&self, along: f32) -> Self {
        Self { site: self.site_at(along, 0.0), heading: self.heading_at(along), bend: self.bend }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_site_is_seen_where_it_was_put() {
        for bend in [-0.4, -0.05, 0.0, 0.02, 0.3_f32] {
            let arc = Arc { site: Site::ORIGIN, heading: Heading(0x1234_5678), bend };
            for along in [-2.0, -0.3, 0.0, 0.7, 2.5_f32] {
                for left in [-0.8, 0.0, 0.4] {
                    let seen = arc.see(arc.site_at(along, left));
                    let off = (seen.along - along).abs() + (seen.left - left).abs();
                    assert!(off < 2e-3, "{bend} {along} {left}: {seen:?}");
                }
            }
        }
    }
}
