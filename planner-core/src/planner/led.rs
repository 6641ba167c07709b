//! A robot that another drives along a front, back along it as well.

use crate::belief::curve::Curve;
use crate::belief::front::{Unit, metres};
use crate::geometry::lattice::Site;

/// It has turned where it has gone back by so many reaches.
const BACK: f32 = 2.0;

/// Where it is, and how far it has gone back along the front, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Led {
    site: Site,
    back: f32,
}

impl Default for Led {
    fn default() -> Self {
        Self { site: Site::ORIGIN, back: 0.0 }
    }
}

impl Led {
    /// It has come to a site. The curve turns round where the robot has.
    pub(crate) fn to(self, site: Site, curve: &mut Curve) -> Self {
        let [gone, _] = Unit::of(curve.now().heading).seen(metres(site - self.site));
        let back = if curve.is_flipped() { self.back + gone } else { self.back - gone };
        if back > BACK * curve.reach() {
            curve.turn_round();
            return Self { site, back: 0.0 };
        }
        Self { site, back: if back > 0.0 { back } else { 0.0 } }
    }
}
