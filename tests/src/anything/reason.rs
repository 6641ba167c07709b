//! Confirms by brute force why a mission ended.

use host_sim::mission::definition::Mission;
use host_sim::mission::read_out::ReadOut;
use host_sim::mission::results::Ending;
use host_sim::mission::terrain::Terrain;
use planner_core::dynamics::{Dynamics, Side};
use planner_core::{
    Area, CellView, Certainty, Label, Pose, Site, StopReason, Vector, Workspace as _,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Sequences of motions that are tried, and the motions of each.
const SEQUENCES: u32 = 1_500;
const LENGTH: u32 = 6;

/// Places of the area that are asked.
const PLACES: u32 = 4_000;

/// 36 places are all missed by so large a share of the area in one of a hundred cases.
const MISSED: f64 = 0.12;

/// Open ground is thin if it is less than this share of the area.
const THIN: f64 = 0.02;

/// What is wrong with the reason for which a mission ended at a pose; `None` if it is true.
///
/// # Panics
/// When the tolerance leaves nothing of the area.
pub fn refute<D: Dynamics>(
    mission: &Mission,
    dynamics: &D,
    belief: &dyn ReadOut,
    pose: Pose,
    end: Ending,
) -> Option<String> {
    let Ending::Stopped(reason) = end else { return None };
    let area = mission.terrain().inset(mission.config.tolerance.units()).expect("an area");
    // A vehicle that is not safe may use the margin to become safe.
    let is_safe = area.contains(pose.site) && dynamics.is_safe(pose, &area);
    let ground = if is_safe { area } else { mission.terrain() };
    let judge = Judge { mission, dynamics, belief, area, ground };
    match reason {
        StopReason::SamplesFull => (!belief.is_full()).then(|| "there is room".to_owned()),
        StopReason::Known => {
            let goal = mission.goal.map(|goal| goal.in_bounds_of(&mission.config.area));
            let met = goal.is_some_and(|it| belief.reaches(it, mission.config.area.bounds()));
            (!met).then(|| "the goal is not met".to_owned())
        }
        StopReason::OutsideArea => {
            area.contains(pose.site).then(|| "it is inside the area".to_owned())
        }
        StopReason::Resolution | StopReason::Tolerance => judge.open_ground(pose),
        StopReason::Cornered | StopReason::Undecided => judge.way_on(pose),
        StopReason::Worth => judge.worthy(pose),
        StopReason::OneLabel => judge.two_labels(),
        StopReason::Closed => {
            (!mission.until_closed).then(|| "nobody asked to end at a closed front".to_owned())
        }
        _ => Some("an unknown reason".to_owned()),
    }
}

struct Judge<'a, D> {
    mission: &'a Mission,
    dynamics: &'a D,
    belief: &'a dyn ReadOut,
    /// Where motions aim.
    area: Terrain,
    /// Where motions stay.
    ground: Terrain,
}

impl<D: Dynamics> Judge<'_, D> {
    /// Whether a label at a place inside the area can tell something.
    fn is_open(&self, site: Site) -> bool {
        if !self.area.contains(site) {
            return false;
        }
        match (self.belief.version_space(), self.belief.hypotheses()) {
            (Some(space), _) => can_cut_either_way(space.lines(), site),
            (_, Some(table)) => table.start().certainty(site) == Certainty::Uncertain,
            (None, None) => false,
        }
    }

    /// Whether either label at a place can tell something, where positions err.
    fn is_told_apart(&self, site: Site) -> bool {
        self.belief.version_space().is_none_or(|space| space.lines().can_cut(site))
    }

    fn rng(&self) -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(self.mission.seed)
    }

    /// Places all over the area.
    fn places(&self) -> Vec<Site> {
        let mut rng = self.rng();
        let drawn = (0..PLACES).map(|_| place(self.area.bounds(), &mut rng));
        drawn.filter(|it| self.area.contains(*it)).collect()
    }

    /// How large a share of the area most likely has the rarer label, if it is more than a few places can miss.
    fn two_labels(&self) -> Option<String> {
        let places = self.places();
        let chance = |site| self.belief.chance_of(site, Label::Positive);
        let above = places.iter().filter(|it| chance(**it) > 0.5).count();
        let rarer = above.min(places.len() - above) as f64 / places.len().max(1) as f64;
        (rarer > MISSED).then(|| format!("{:.1} % most likely has the other label", 100.0 * rarer))
    }

    fn open_ground(&self, pose: Pose) -> Option<String> {
        let places = self.places();
        let open = places.iter().filter(|it| self.is_open(**it) && self.is_told_apart(**it));
        let share = open.count() as f64 / places.len().max(1) as f64;
        (share > THIN).then(|| format!("{:.2} % of the area is open, at {pose:?}", 100.0 * share))
    }

    /// A random sequence of motions that stays inside and ends on open ground where the vehicle is safe, if one is
    /// found.
    fn way_on(&self, pose: Pose) -> Option<String> {
        let mut rng = self.rng();
        let vehicle = self.dynamics;
        for _ in 0..SEQUENCES {
            let mut at = pose;
            for motions in 1..=LENGTH {
                let Some(next) = random_motion(vehicle, at, &mut rng) else { continue };
                if !self.may_go(at, next) {
                    continue;
                }
                if next.site != at.site
                    && self.is_open(next.site)
                    && vehicle.keeps_inside(at, next, &self.area, 0)
                {
                    return Some(format!("{motions} motions lead to {next:?} from {pose:?}"));
                }
                at = next;
            }
        }
        None
    }

    /// A random motion that ends where a label is expected to carry far more than was asked for, if one is found.
    fn worthy(&self, pose: Pose) -> Option<String> {
        let mut rng = self.rng();
        let least = 1.5 * self.mission.asking.worth + 0.05;
        (0..SEQUENCES).find_map(|_| {
            let next = random_motion(self.dynamics, pose, &mut rng)?;
            let is_open = next.site != pose.site && self.is_open(next.site);
            let bits = self.belief.expects(next.site).bits;
            let is_told = is_open && bits > least && self.may_go(pose, next);
            is_told.then(|| format!("a label at {next:?} carries {bits} bits"))
        })
    }

    fn may_go(&self, from: Pose, to: Pose) -> bool {
        self.ground.contains(to.site) && self.dynamics.stays_inside(from, to, &self.ground)
    }
}

/// A place of a rectangle.
pub(super) fn place(area: Area, rng: &mut ChaCha8Rng) -> Site {
    let (from, to) = (area.min(), area.max());
    let (x, z) = (rng.random_range(from.x()..=to.x()), rng.random_range(from.z()..=to.z()));
    Site::new(x, z).expect("inside")
}

fn can_cut_either_way(lines: CellView<'_>, site: Site) -> bool {
    let is_open = |by: Vector| {
        site.step(by).is_ok_and(|place| lines.certainty(place) == Certainty::Uncertain)
    };
    let none = Vector::new(0, 0).expect("small");
    is_open(none) && (is_open(lines.shift) || is_open(lines.shift.reversed()))
}

fn random_motion<D: Dynamics>(vehicle: &D, pose: Pose, rng: &mut ChaCha8Rng) -> Option<Pose> {
    let side = if rng.random() { Side::Left } else { Side::Right };
    if rng.random_range(0..3) == 0
        && let Some((_, turned)) = vehicle.turn_in_place(pose, side)
    {
        return Some(turned);
    }
    let speeds = vehicle.grid().speeds();
    let speed = rng.random_range(1..speeds);
    let fan = vehicle.fan();
    let [left, right] = vehicle.rays_at(speed).unwrap_or([fan.left, fan.right]);
    let count = if side == Side::Left { left } else { right.saturating_add(1) };
    if count == 0 {
        return None;
    }
    // The sharpest and the straight ones are tried more often.
    let n = match rng.random_range(0..4) {
        0 => 0,
        1 => count - 1,
        _ => rng.random_range(0..count),
    };
    vehicle.arrive(pose, &vehicle.ray(pose, side, n), speed).ok()
}
