//! Look-ahead prefers no place, no direction and no label. If a mission is moved, turned by quarters, or has its labels
//! swapped, its plans stay the same.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Lines;
use host_sim::mission::names::FanName;
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::{Area, Heading, Label, Plan, Pose, Sample, Site, Workspace as _};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::cases;
use tests::ensemble::{self, expect, noisy, percent};

/// Steps of a mission, and the seed of fields and labels.
const STEPS: u32 = 36;
const SEED: u64 = 5;

/// The same mission otherwise: turned by quarters about the origin, then moved, its labels swapped or not.
#[derive(Clone, Copy, Debug)]
struct View {
    swaps: bool,
    quarters: u32,
    by: [i32; 2],
}

impl View {
    const SAME: Self = Self { swaps: false, quarters: 0, by: [0, 0] };

    fn site(self, site: Site) -> Site {
        let turned = |(x, z): (i32, i32), _| (-z, x);
        let (x, z) = (0..self.quarters).fold((site.x(), site.z()), turned);
        Site::new(x + self.by[0], z + self.by[1]).expect("on the lattice")
    }

    fn pose(self, pose: Pose) -> Pose {
        let heading = Heading(pose.heading.0.wrapping_add(self.quarters << 30));
        Pose { site: self.site(pose.site), heading }
    }

    fn label(self, label: Label) -> Label {
        if self.swaps { -label } else { label }
    }

    fn area(self, area: Area) -> Area {
        let [a, b] = [area.min(), area.max()].map(|corner| self.site(corner));
        let corner = |of: fn(i32, i32) -> i32| Site::new(of(a.x(), b.x()), of(a.z(), b.z()));
        let corners = [i32::min, i32::max].map(|of| corner(of).expect("on the lattice"));
        Area::new(corners[0], corners[1]).expect("it has an inside")
    }

    /// The mission as far as its planner is told of it.
    fn mission(self, mission: &Mission) -> Mission {
        let seen = |it: &Sample| Sample { site: self.site(it.site), label: self.label(it.label) };
        let given: Vec<_> = mission.given.samples().iter().map(seen).collect();
        let mut other = mission.clone();
        other.given = Lines::new(&given).expect("lines are left as before").into();
        other.config.area = self.area(mission.config.area.bounds()).into();
        other.start = self.pose(mission.start);
        other
    }
}

/// The distances between the ends of motions planned for a mission and for a view of it, lattice units. Both have the
/// same labels and the same poses throughout.
fn apart(mission: &Mission, view: View) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(mission.seed);
    let (mut here, mut there) = (mission.planner(), view.mission(mission).planner());
    let (mut pose, mut apart) = (mission.start, Vec::new());
    while apart.len() < mission.steps as usize {
        let [one, other] = match (here.plan(pose), there.plan(view.pose(pose))) {
            (Plan::Move(one), Plan::Move(other)) => [one, other],
            stops => panic!("mission {:#x}, {view:?}: {stops:?}", mission.seed),
        };
        let off = view.site(one.target.site) - other.target.site;
        apart.push(f64::from(off.x()).hypot(f64::from(off.z())));
        pose = one.target;
        let label = one.wants_label.then(|| {
            let is_true = mission.noise.is_none_or(|it| rng.random_bool(it.p));
            let is_above = (mission.world.distance(pose.site) > 0.0) == is_true;
            if is_above { Label::Positive } else { Label::Negative }
        });
        here.observe(pose, label.map(Into::into)).expect("it is possible");
        let seen = label.map(|label| view.label(label).into());
        there.observe(view.pose(pose), seen).expect("so it is here");
    }
    apart
}

/// The distances for a view of some fields, with labels true or not, on both fans.
fn of_fields(view: View, is_noisy: bool) -> Vec<f64> {
    let fields = if is_noisy { cases(12, 100) } else { cases(60, 500) };
    let of_each = ensemble::fly(fields, |number| {
        let mut mission = standard_field::standard(SEED, number, Algorithm::Lookahead, STEPS);
        mission.vehicle =
            if number.is_multiple_of(2) { FanName::Paper } else { FanName::Fine }.into();
        apart(&if is_noisy { noisy(mission, 0.8, 0.5) } else { mission }, view)
    });
    of_each.concat()
}

/// Only differences of positions matter: not a digit is lost far from the origin. In other views three roundings are not
/// symmetric. Halves round up and not away from zero, and sums are rounded in another order. Knots of a column that find
/// no room are dropped from one end. So a few plans with two nearly equal choices make the other choice.
#[test]
fn moved_turned_or_with_its_labels_swapped_it_plans_the_same() {
    let moved = [[6_000 * UNITS_PER_METRE, -5_000 * UNITS_PER_METRE], [-12_345, 67_891]];
    let moved = moved.map(|by| (View { by, ..View::SAME }, 0.0, [0.0, 0.0]));
    let turned = [1, 2, 3].map(|quarters| View { quarters, ..View::SAME });
    let swapped = [View { swaps: true, ..View::SAME }];
    let centimetre = 0.01 * f64::from(UNITS_PER_METRE);
    let others = turned.into_iter().chain(swapped).map(|view| (view, centimetre, [0.5, 3.0]));
    for (view, near, most) in moved.into_iter().chain(others) {
        for (is_noisy, most) in [false, true].into_iter().zip(most) {
            let other = percent(&of_fields(view, is_noisy), |off| *off > near);
            expect(format!("other plans, {view:?}, noisy {is_noisy}"), other, ..=most);
        }
    }
}
