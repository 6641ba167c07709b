//! The search for a route: a few candidates a plan, and the best of them is kept.

use crate::belief::field::{BoundaryOdds, Field};
use crate::search::route::corners::{Corners, Hears};
use crate::search::route::cost::Costs;
use crate::search::route::patterns::{Random, RouteGround};

/// Visits of a region by a leg, at most: some 0.7 million instructions of a Cortex-M4F.
const VISITS: u32 = 11_000;

/// Patterns and changes that a plan tries.
const TRIED: usize = 30;

/// Patterns are tried in one of so many plans, or where the route is shorter than so many corners.
const SELDOM: usize = 10;
const SHORT: usize = 2;

/// The old route is taken unless another costs less than this share of it.
const OLD: f32 = 0.99;

/// A region with more than this share of all odds may be gone to first.
const HEAVY: f32 = 0.02;

/// A route that seeks a boundary.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Route {
    corners: Corners,
    /// Whether a user told its corners: they are not changed.
    is_told: bool,
    random: Random,
}

impl Route {
    /// No route yet.
    pub(crate) const NONE: Self =
        Self { corners: Corners::new(), is_told: false, random: Random::START };

    /// A route that a user tells, as far as there is room.
    pub(crate) fn told(corners: impl Iterator<Item = [f32; 2]>) -> Self {
        let mut told = Self { is_told: true, ..Self::NONE };
        for it in corners {
            let _ = told.corners.push(it);
        }
        told
    }

    /// Whether a user told it, and some of it is left.
    pub(crate) fn is_told(&self) -> bool {
        self.is_told && !self.corners.is_empty()
    }

    /// The corner to go to.
    pub(crate) fn next(&self) -> Option<[f32; 2]> {
        self.corners.first().copied()
    }

    /// Leaves out the corner to go to: the robot is there, or there is no way.
    pub(crate) fn pass(&mut self) {
        if !self.corners.is_empty() {
            self.corners.remove(0);
        }
    }

    /// Whether a search can have found it in an area with these half sides.
    pub(crate) fn is_valid(&self, [x, z]: [f32; 2]) -> bool {
        self.corners.iter().all(|it| it[0].abs() <= x && it[1].abs() <= z)
    }

    /// Looks for a better route from a place. The heaviest region may have a heart to be gone to first.
    #[inline(never)] // what it needs is not on the stack while a motion is sought
    pub(crate) fn improve(
        &mut self,
        (field, sought): (&Field, BoundaryOdds),
        (from, heart): ([f32; 2], Option<[f32; 2]>),
        hears: Hears,
    ) {
        let mut costs = Costs::new(hears, VISITS);
        costs.stand_for(field, sought);
        let ground = RouteGround { half: field.layout.half, patch: field.layout.patch };
        self.is_told = false;
        let Self { corners: best, random, .. } = self;
        let was_short = best.len() < SHORT;
        let mut least = costs.cost(from, best, f32::MAX).unwrap_or(f32::MAX) * OLD;
        let mut take = |best: &mut Corners, corners: Corners| {
            if let Some(cost) = costs.cost(from, &corners, least) {
                (*best, least) = (corners, cost);
            }
            costs.visits > 0
        };
        // Where the robot is there already, it needs another place to come back from.
        let is_far = |[x, z]: &[f32; 2]| {
            let way = [x - from[0], z - from[1]];
            way[0] * way[0] + way[1] * way[1] >= hears.apart * hears.apart
        };
        if let Some(heart) = heart.filter(is_far)
            && sought.heaviest.1 > HEAVY * sought.odds()
        {
            let mut corners = Corners::new();
            for it in [heart].iter().chain(best.iter()) {
                let _ = corners.push(*it); // as far as there is room
            }
            take(best, corners);
        }
        if was_short || random.below(SELDOM) == 0 {
            for _ in 0..TRIED {
                take(best, ground.pattern(random));
            }
        }
        for _ in 0..TRIED {
            let changed = ground.changed(best, random);
            if !take(best, changed) {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::field::Seeking;
    use crate::belief::sample::Label;
    use crate::geometry::area::Area;

    /// A robot that follows its route hears of an empty area about as fast as one that mows it.
    #[test]
    fn a_route_covers_an_area() {
        let area = Area::metres([0.0, 0.0], [200.0, 150.0]).unwrap();
        let mut field = Field::NONE;
        field.begin(&area, (Seeking::patches(20.0).unwrap(), true), 0.95).unwrap();
        let hears = Hears { odds: field.odds(), apart: 3.0 };
        let (mut route, mut place, mut steps) = (Route::NONE, [-90.0, -60.0], 0);
        loop {
            let sought = field.sought();
            let left = field.left(sought);
            if left.patch.unwrap() < 0.01 && left.coast < 0.01 {
                break;
            }
            let heart = sought.heaviest.0.map(|it| field.layout.heart(&area, it));
            route.improve((&field, sought), (place, heart), hears);
            assert!(route.is_valid(field.layout.half));
            let Some([x, z]) = route.next() else { panic!("no route") };
            let (dx, dz) = (x - place[0], z - place[1]);
            let way = (dx * dx + dz * dz).sqrt();
            if way <= 3.0 {
                route.pass();
                place = [x, z];
            } else {
                place = [place[0] + 3.0 * dx / way, place[1] + 3.0 * dz / way];
            }
            field.observe(field.layout.site(place).unwrap(), Label::Negative);
            steps += 1;
            assert!(steps < 700, "{left:?}");
        }
        assert!(steps > 200, "{steps}");
    }
}
