//! The data of a mission that a page draws: where the mission takes place, and a scene for the start and for each step.

use std::iter;

use nalgebra::{Point2, Vector2};
use planner_core::dynamics::Dynamics as _;
use planner_core::{AnyVehicle, Line, Site, Step};
use serde::Serialize;

use crate::mission::definition::Mission;
use crate::mission::front::{PassedRecord, VertexRecord};
use crate::mission::read_out::ReadOut;
use crate::mission::recording::{Recording, beside_truth};
use crate::mission::results::{LineError, LineRecord, PoseRecord, Start, StepResult};
use crate::report::bands::simplified;
use crate::report::examples::bits;
use crate::report::ground::Ground;
use crate::report::page::words::{self, Told};
use crate::report::picture::{self, Drawn, Picture, Stop};
use crate::report::pieces::ends;
use crate::report::text;
use crate::world::World;
use crate::world::extent::around;
use crate::world::polygon::Polygon;
use crate::world::way::Way;

/// Places are rounded to the area's size divided by this: a twentieth of a pixel.
const GRAIN: f64 = 20_000.0;

/// A mission that is shown.
#[derive(Debug, Serialize)]
pub(crate) struct Flight {
    /// Who planned.
    pub(crate) planner: String,
    /// What the recommended estimate is called.
    pub(crate) estimate: &'static str,
    /// Whether labels may be wrong.
    labels_err: bool,
    /// Whether a front is followed, and not a straight line sought.
    pub(crate) follows: bool,
    /// The border of the area.
    pub(crate) area: Polygon,
    /// What is kept out of.
    pub(crate) keep_outs: Vec<Polygon>,
    /// The shores of a lake: land lies beyond them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) shores: Vec<Polygon>,
    /// The samples that were given.
    pub(crate) given: Vec<(Point2<f64>, i8)>,
    /// The true line, where there is one.
    truth: Option<LineRecord>,
    /// The true boundary, where known. If it moves, the last has no ways: each scene has them.
    pub(crate) boundary: Vec<Drawn>,
    /// The start, and each step.
    pub(crate) scenes: Vec<Scene>,
    /// Why it ended, and what it came to.
    pub(crate) ended: Vec<Told>,
    /// The last places of a map, which it has at the end.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) rest: Vec<MapPlace>,
    /// The picture of the end, for where no script runs.
    #[serde(skip)]
    pub(crate) picture: Option<Picture>,
}

/// A line as it is seen in the area.
#[derive(Debug, Serialize)]
pub(crate) struct SeenLine {
    /// Where it enters and leaves the area; empty of a line that passes it by.
    pub(crate) ends: Way,
    /// Degrees.
    angle: f64,
    /// Metres; `None` of a vertical line.
    intercept: Option<f64>,
    /// Degrees to the truth, if there is one.
    pub(crate) off_deg: Option<f64>,
    /// The share of the area that gets the wrong label.
    pub(crate) misclassified: Option<f64>,
}

/// The state of knowledge after some step, and the motion that led there.
#[derive(Debug, Serialize)]
pub(crate) struct Scene {
    /// The motion; `None` at the start.
    pub(crate) motion: Option<Moved>,
    /// Where the robot is by what it reports.
    pub(crate) at: Point2<f64>,
    /// Radians.
    heading: f64,
    /// What is known of the ground.
    pub(crate) ground: Ground,
    /// The recommended estimate.
    pub(crate) estimate: Option<SeenLine>,
    /// Where the front is known best, if one is followed and found.
    pub(crate) front: Option<SeenFront>,
    /// The places that the map has more after this step.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) mapped: Vec<MapPlace>,
    /// Where the true boundary is after this step, if it moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) boundary: Option<Vec<Way>>,
    /// The slopes left, as intervals of degrees.
    pub(crate) slopes: Vec<[f64; 2]>,
    /// The intercepts left, metres; `None` when unbounded.
    pub(crate) intercepts: Option<[f64; 2]>,
    /// Bits learnt so far, by the area prior, so that planners compare.
    pub(crate) bits: f64,
    /// Bits that the labels so far were expected to carry, each when it was asked for.
    expected_bits: f64,
    /// Control cost so far.
    pub(crate) cost: f64,
    /// Metres travelled so far.
    metres: f64,
    /// The same in words.
    pub(crate) told: Vec<Told>,
}

/// A front where it is known best.
#[derive(Debug, Serialize)]
pub(crate) struct SeenFront {
    /// The place, and the ends of its 90 % interval.
    pub(crate) at: Point2<f64>,
    pub(crate) ends: [Point2<f64>; 2],
    /// The half-width, metres.
    pub(crate) half_width: f64,
    /// The distance of the place from the true front, metres.
    pub(crate) off: Option<f64>,
}

/// A place of the map of a front.
#[derive(Debug, Serialize)]
pub(crate) struct MapPlace {
    /// The step after which the robot passed it.
    pub(crate) passed: usize,
    /// Whether a piece of the map begins with it.
    pub(crate) begins: bool,
    /// The place, and the ends of its 90 % interval.
    pub(crate) at: Point2<f64>,
    pub(crate) ends: [Point2<f64>; 2],
}

/// A motion, and what was read at its end.
#[derive(Debug, Serialize)]
pub(crate) struct Moved {
    /// Whether a front was sought.
    sought: bool,
    /// What it answers, in short.
    #[serde(skip)]
    pub(crate) problem: String,
    /// The motion itself, in words.
    #[serde(skip)]
    pub(crate) motion: String,
    /// Places on the way, the last of them the end.
    pub(crate) way: Way,
    /// Where it should have ended, if it ended elsewhere.
    target: Option<Point2<f64>>,
    /// Where the robot truly was, if it errs.
    truly: Option<Point2<f64>>,
    /// -1, 0 on the boundary, 1; `None` if nothing was read.
    pub(crate) label: Option<i8>,
    /// Whether that is known to be false.
    pub(crate) is_wrong: bool,
    /// The chance of +1 there, if a label was asked for.
    pub(crate) chance: Option<f64>,
    /// Bits that it was expected to carry.
    pub(crate) expected: Option<f64>,
}

/// Rounds places to what can be seen.
#[derive(Clone, Copy, Debug)]
struct Rounding {
    /// Metres.
    unit: f64,
}

impl Rounding {
    fn of(border: &Polygon) -> Self {
        Self { unit: 10_f64.powf((size(border) / GRAIN).log10().floor()) }
    }

    fn place(self, at: Point2<f64>) -> Point2<f64> {
        // A division, if the unit is a fraction, keeps decimals short.
        let per_metre = (1.0 / self.unit).round();
        at.map(|m| if per_metre > 1.0 { (m * per_metre).round() / per_metre } else { m.round() })
    }

    fn way(self, mut places: Way) -> Way {
        for at in &mut places {
            *at = self.place(*at);
        }
        places.dedup();
        places
    }

    fn ground(self, mut ground: Ground) -> Ground {
        for ring in ground.rings() {
            *ring = self.way(std::mem::take(ring));
        }
        if let Ground::Credible(bands) = &mut ground {
            for band in bands {
                band.rings.retain(|ring| ring.len() > 2);
            }
        }
        ground
    }

    fn drawn(self, it: Drawn) -> Drawn {
        Drawn { ways: it.ways.into_iter().map(|way| self.way(way)).collect(), ..it }
    }

    /// A boundary that moves, as it is now, to a fifth of a pixel: each scene has it, so it must be short.
    fn boundary(self, world: &World, border: &Polygon) -> Option<Vec<Way>> {
        let short = |way: Way| self.way(simplified(&way, 4.0 * self.unit));
        world.moves().then(|| world.ways(border).into_iter().map(short).collect())
    }

    /// Places of a map; `is_open` says whether its last piece goes on.
    fn mapped(self, places: &[PassedRecord], is_open: &mut bool) -> Vec<MapPlace> {
        let one = |&PassedRecord { passed, begins, ref vertex }: &PassedRecord| MapPlace {
            passed,
            begins: !std::mem::replace(is_open, true) || begins,
            at: self.place(vertex.at()),
            ends: ends(vertex).map(|at| self.place(at)),
        };
        places.iter().map(one).collect()
    }

    fn front(self, step: &StepResult, world: &World) -> Option<SeenFront> {
        let vertex = step.front.as_ref()?;
        let off = || Some(world.distance(Site::try_from(vertex.at()).ok()?).abs());
        Some(SeenFront {
            at: self.place(vertex.at()),
            ends: ends(vertex).map(|at| self.place(at)),
            half_width: vertex.half_width,
            off: world.is_known().then(off).flatten(),
        })
    }
}

impl Flight {
    /// The longer side of the area, metres.
    pub(crate) fn size(&self) -> f64 {
        size(&self.area)
    }

    /// A mission as it was flown by a planner of this name.
    pub(crate) fn of(planner: &str, recording: &Recording) -> Self {
        let Recording { mission, results, steps, .. } = recording;
        let taken = iter::once(None).chain(steps.iter().zip(&results.steps).map(Some));
        let mut maker = Scenes::new(mission);
        let scenes = recording.known().zip(taken);
        let scenes = scenes.map(|(belief, taken)| maker.scene(mission, taken, belief)).collect();
        let picture = Picture::of(planner, recording);
        Self {
            scenes,
            rest: maker.rest(&results.end.mapped),
            ended: words::ended(results).collect(),
            picture: Some(picture),
            ..Self::begun(planner, mission)
        }
    }

    /// A mission before its first scene.
    pub(crate) fn begun(planner: &str, mission: &Mission) -> Self {
        let area = mission.config.area;
        let border = Polygon::from(area);
        let rounding = Rounding::of(&border);
        let before = mission.read_before.iter().map(|(site, reading)| (*site, reading.sign()));
        let given = mission.oracle().iter().map(|it| (it.site, it.label.sign())).chain(before);
        let given = given.map(|(site, sign)| (rounding.place(site.into()), sign));
        let polygon = |it: Polygon| Polygon(rounding.way(it.0));
        let boundary = picture::truth(mission, None).into_iter();
        let shores = mission.lake.iter().flat_map(|it| it.polygons.iter().flatten().cloned());
        Self {
            planner: planner.to_owned(),
            estimate: text::recommended(mission.is_noisy()),
            labels_err: mission.is_noisy(),
            follows: !mission.algorithm.seeks_line(),
            keep_outs: area.hulls().map(|hull| polygon(hull.into())).collect(),
            shores: shores.map(|it| polygon(Polygon(it))).collect(),
            given: given.collect(),
            truth: mission.world.line().map(|line| (*line).into()),
            boundary: boundary.map(|it| rounding.drawn(it)).collect(),
            area: polygon(border),
            scenes: Vec::new(),
            rest: Vec::new(),
            ended: Vec::new(),
            picture: None,
        }
    }
}

/// Makes the scenes of a mission, one after the other, from what has happened so far. So a report and a page that shows
/// the mission while it is flown have the same.
#[derive(Debug)]
pub(crate) struct Scenes {
    start: Start,
    rounding: Rounding,
    /// Where the robot was, by what it reports.
    from: Point2<f64>,
    /// Where the front was known best.
    vertex: Option<Point2<f64>>,
    /// Whether the last piece of the map goes on.
    is_open: bool,
    /// Bits learnt so far, and expected so far.
    bits: f64,
    expected_bits: f64,
}

impl Scenes {
    /// Those of a mission that begins.
    pub(crate) fn new(mission: &Mission) -> Self {
        let start = Start::of(mission);
        let from = Point2::new(start.pose.x, start.pose.z);
        let rounding = Rounding::of(&mission.config.area.into());
        let (vertex, is_open) = (None, false);
        Self { start, rounding, from, vertex, is_open, bits: 0.0, expected_bits: 0.0 }
    }

    /// The last places of the map, which it has at the end.
    pub(crate) fn rest(&self, rest: &[PassedRecord]) -> Vec<MapPlace> {
        self.rounding.mapped(rest, &mut self.is_open.clone())
    }

    /// The next scene: of the start, or after a step that was taken and what came of it. `belief` is what is known then.
    pub(crate) fn scene(
        &mut self,
        mission: &Mission,
        taken: Option<(&Step, &StepResult)>,
        belief: &dyn ReadOut,
    ) -> Scene {
        let Self { ref start, rounding, from, .. } = *self;
        let area = mission.config.area;
        let knowledge = belief.knowledge();
        let step = taken.map(|(_, result)| result);
        let world = mission.world.after(step.map_or(0, |it| it.step));
        // A front has no straight estimate.
        let centre = || beside_truth(mission, &world, belief.estimates()).centre;
        let centre = belief.front().is_none().then(centre).flatten();
        // Of a front nothing is known before it is found.
        let of_front = || step.map_or(0.0, |step| step.bits);
        let bits = if belief.front().is_some() { of_front() } else { bits(belief) };
        let read = step.map(|step| (step, bits - self.bits));
        let told = words::stage((mission, start), read, (&knowledge, bits), centre.as_ref());
        let PoseRecord { x, z, heading } = step.map_or(start.pose, |step| step.pose);
        let motion = taken.map(|(step, result)| {
            Moved::of(mission, rounding, (step, result), &Stop::of(mission, from, result))
        });
        self.from = Point2::new(x, z);
        let vertex = step.and_then(|step| step.front);
        let is_beside = vertex.is_some_and(|it| self.is_beside(mission, &it));
        self.vertex = vertex.map(|it| it.at());
        let mapped = step.map_or(&[][..], |step| &step.mapped);
        let mapped = rounding.mapped(mapped, &mut self.is_open);
        self.is_open &= vertex.is_some();
        self.bits = bits;
        self.expected_bits += step.and_then(|step| step.expected).map_or(0.0, |it| it.bits);
        Scene {
            motion,
            at: rounding.place(self.from),
            heading,
            ground: rounding.ground(Ground::of(belief, area)),
            estimate: centre.map(|line| seen(&line, &area.into(), rounding)),
            front: step.filter(|_| is_beside).and_then(|step| rounding.front(step, &world)),
            mapped,
            boundary: rounding.boundary(&world, &area.into()),
            slopes: knowledge.slope_arcs,
            intercepts: knowledge.intercept,
            bits,
            expected_bits: self.expected_bits,
            cost: step.map_or(0.0, |step| step.control_cost),
            metres: step.map_or(0.0, |step| step.metres),
            told,
        }
    }

    /// Whether the place where the front is known best now is beside the robot. While it drives back to where it
    /// began, that place lies far along the front and stays what it is.
    fn is_beside(&self, mission: &Mission, vertex: &VertexRecord) -> bool {
        let along = Vector2::new(libm::cos(vertex.heading), libm::sin(vertex.heading));
        let ahead = (self.from - vertex.at()).dot(&along);
        self.vertex != Some(vertex.at()) && ahead.abs() <= 2.0 * longest(&mission.vehicle)
    }
}

impl Moved {
    fn of(
        mission: &Mission,
        rounding: Rounding,
        (step, result): (&Step, &StepResult),
        stop: &Stop,
    ) -> Self {
        let place = |at: Point2<f64>| rounding.place(at);
        let [target, end] = [step.motion.target.site, step.pose.site];
        Self {
            sought: !mission.algorithm.seeks_line() && result.problem.as_deref() == Some("seek"),
            problem: words::problem(result),
            motion: words::motion(mission, result),
            way: stop.way.iter().copied().map(place).collect(),
            target: (target != end).then(|| place(target.into())),
            truly: stop.truly.map(place),
            label: result.label,
            is_wrong: result.is_wrong() && result.label != Some(0),
            chance: result.expected.map(|it| it.chance),
            expected: result.expected.map(|it| it.bits),
        }
    }
}

/// The longer side of what is around a polygon.
fn size(Polygon(corners): &Polygon) -> f64 {
    let [low, high] = around(corners.iter().copied()).unwrap_or_default();
    (high - low).amax()
}

fn seen(record: &LineRecord, border: &Polygon, rounding: Rounding) -> SeenLine {
    let &LineRecord { intercept, angle, coefficients: [a, b, c], error, .. } = record;
    let line = Line::from_coefficients(a, b, c);
    let ends = line.map(|line| border.across(&line)).unwrap_or_default();
    SeenLine {
        ends: rounding.way(ends),
        angle,
        intercept,
        off_deg: error.map(|LineError { degrees, .. }| degrees),
        misclassified: error.map(|LineError { misclassified, .. }| misclassified),
    }
}

/// The longest motion of a vehicle, metres.
fn longest(vehicle: &AnyVehicle) -> f64 {
    let grid = vehicle.grid();
    f64::from(grid.reach_mm(grid.speeds().saturating_sub(1))) * 1e-3
}
