//! A recorded track: rows in their order, and what was known before the first.

use anyhow::{Context as _, Result, bail};
use nalgebra::Point2;
use planner_core::motion::unicycle::Grid;
use planner_core::watch::Evidence;
use planner_core::{
    AnyReliability, AnyVehicle, Area, Belief as _, Front, Heading, Label, MapPlace, Noise,
    Planner as _, Pose, Reading, Sample, Site, Tolerance, Track, Waist,
};

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::FrontBelief;
use crate::mission::read_out::FrontKnown;
use crate::mission::results::{PTold, Start, StepResult};
use crate::mission::vehicle::Source;
use crate::replay::answer::Trust;
use crate::replay::rows::Traced;
use crate::replay::sample_file::SampleFile;
use crate::report::picture::area_around;

/// A follower's longest motion is this share of the tightest bend's radius, and of the mean of the area's sides, at most.
const SHORT: f64 = 0.125;

/// A front counts as found where its half-width is below so many of these motions.
const FOUND: f64 = 1.5;

/// After an alarm it is sought within so many of them.
const AGAIN: f64 = 6.0;

/// Rows of a table are taken in where they are so many of these motions apart. A tracker is made for labels that are
/// about one apart: of many more it learns too much, since it does not keep where in a cell they were read.
const APART: f64 = 0.2;

/// The time that passes with a row of a table is within these, in units of the tracker.
const LEAST: f64 = 1e-3;
const MOST: f64 = 4.0;

/// The greatest speed of a front, metres in a unit of time.
const FASTEST: f64 = 1e3;

/// A row of a track: where the robot came, and what it read there and on the way there.
pub(crate) struct Row {
    /// The line of the file, its feature, or the step of a trace.
    pub(crate) number: usize,
    pub(crate) site: Site,
    pub(crate) heading: Heading,
    pub(crate) label: Option<Label>,
    pub(crate) passed: Vec<(Site, Reading)>,
    /// The time since the row before, in units of the tracker: one motion of a follower takes about one.
    pub(crate) elapsed: f32,
    /// The whole way to here, metres.
    pub(crate) driven: f64,
}

/// What takes in the rows.
pub(crate) enum Known {
    /// A tracker by itself, for rows that no mission has read.
    Rows(Box<FrontBelief>),
    /// The follower of the mission.
    Mission(Box<Track<AnyVehicle>>, Pose),
}

impl Known {
    /// The probability that there is no front.
    pub(crate) fn share_nowhere(&self) -> f32 {
        match self {
            Self::Rows(tracker) => tracker.share_nowhere(),
            Self::Mission(follower, _) => f32::from(u8::from(follower.one_label().is_some())),
        }
    }

    /// Takes in a row. Whether the front is sought anew, within so many metres or in an area.
    pub(crate) fn take(&mut self, row: &Row, near: f32, area: Area) -> Result<bool> {
        match self {
            Self::Rows(tracker) => {
                tracker.moved(row.site, row.elapsed);
                match row.label {
                    Some(label) => tracker.observe(row.site, label.into())?,
                    None => tracker.settle(row.site),
                }
                Ok(tracker.seek_anew((row.site, near), area))
            }
            Self::Mission(follower, pose) => {
                let has_evidence = |it: &Track<_>| *it.belief().evidence() != Evidence::NONE;
                let had = has_evidence(follower);
                // What it plans may differ, if it is told something else than in the mission.
                let _ = follower.plan(*pose);
                for (site, reading) in &row.passed {
                    follower.observe_on_the_way(*site, *reading)?;
                }
                *pose = Pose { site: row.site, heading: row.heading };
                follower.observe(*pose, row.label.map(Into::into))?;
                Ok(had && !has_evidence(follower))
            }
        }
    }

    /// Where the front is known best, if its half-width is below this, metres.
    pub(crate) fn found(&self, within: f32) -> Option<Waist> {
        match self {
            Self::Rows(tracker) => tracker.found(within),
            Self::Mission(follower, _) => follower.found(),
        }
    }

    /// The places that the map has more after a row.
    pub(crate) fn mapped(&self, within: f32) -> Vec<MapPlace> {
        match self {
            Self::Rows(tracker) => FrontKnown::mapped(&**tracker, within),
            Self::Mission(follower, _) => follower.belief().mapped().to_vec(),
        }
    }

    /// The places that it has more at the end.
    pub(crate) fn rest(&self) -> Vec<MapPlace> {
        match self {
            Self::Rows(_) => Vec::new(),
            Self::Mission(follower, _) => FrontKnown::rest(follower.belief()),
        }
    }
}

/// A recorded track.
pub(crate) struct RecordedTrack {
    /// The rows that are taken in.
    pub(crate) rows: Vec<Row>,
    /// They are at least so far apart, metres.
    pub(crate) apart: f64,
    /// What is known of the front before the first row.
    pub(crate) known: Known,
    /// The front counts as found where its half-width is below this, metres.
    pub(crate) width: f32,
    /// After an alarm it is sought within so many metres, and then in this area.
    pub(crate) near: f32,
    pub(crate) area: Area,
    /// How often labels are true.
    pub(crate) p: PTold,
    /// Whether it ends back where the front was found, after all the way round it.
    pub(crate) is_closed: bool,
}

impl RecordedTrack {
    /// The track of a file. One of a table begins with nothing known of the box around its samples. That of a trace
    /// begins as its mission did: with its area, its given points and its longest motion.
    ///
    /// # Errors
    /// Names the file, what was found and what was expected.
    pub(crate) fn of(file: &SampleFile, front: Front, trust: Trust) -> Result<Self> {
        let told = file.mission.as_ref().and_then(|it| it.start.p_told);
        let p = trust.p.map(PTold::Number).or(told).unwrap_or(PTold::Number(file.p.unwrap_or(1.0)));
        let noise = noise(p, trust.tolerance).with_context(|| file.name.clone())?;
        match file.mission.as_deref() {
            Some(mission) => Self::of_mission(file, mission, (front, p, noise)),
            None => Self::of_rows(file, (front, p, noise)),
        }
    }

    fn of_rows(file: &SampleFile, (front, p, noise): Told) -> Result<Self> {
        let Some(area) = area_around(&file.samples) else {
            let found =
                if file.samples.is_empty() { "no samples" } else { "all samples at one place" };
            bail!("{}: --front: found {found}, expected a track", file.name);
        };
        let [x, z] = <[f64; 2]>::from(Point2::from(area.max()) - Point2::<f64>::from(area.min()));
        let radius = front.radius().unwrap_or(f64::INFINITY);
        let reach = SHORT * radius.min(0.5 * (x + z));
        let ways = ways(file.samples.iter().map(|it| it.site));
        // A unit of time is that of a motion, so the speed is told in another unit than that of a row.
        let whole = ways.last().copied().unwrap_or_default();
        let each = (whole / file.samples.len() as f64 / reach).clamp(LEAST, MOST);
        let front = front.moving((front.speed() / each).min(FASTEST))?;
        let (mut rows, mut last) = (Vec::<Row>::new(), (0, Point2::origin()));
        for (k, (&Sample { site, label }, driven)) in file.samples.iter().zip(ways).enumerate() {
            let at = Point2::<f64>::from(site);
            if rows.is_empty() || (at - last.1).norm() >= APART * reach {
                let elapsed = (each * (k - last.0) as f64) as f32;
                let (number, label, passed) = (file.line(k), Some(label), Vec::new());
                let heading = Heading::default();
                rows.push(Row { number, site, heading, label, passed, elapsed, driven });
                last = (k, at);
            }
        }
        Ok(Self {
            rows,
            apart: APART * reach,
            known: Known::Rows(Box::new(FrontBelief::new(area, front, noise))),
            width: (FOUND * reach) as f32,
            near: (AGAIN * reach) as f32,
            area,
            p,
            is_closed: false,
        })
    }

    fn of_mission(file: &SampleFile, mission: &Traced, (front, p, noise): Told) -> Result<Self> {
        let Traced { start, steps, reason } = mission;
        let at = |x, z| file.frame.site([x, z]);
        let sites = steps.iter().map(|step| at(step.pose.x, step.pose.z));
        let sites = sites.collect::<Result<Vec<_>>>()?;
        let ways = ways(sites.iter().copied());
        let row = |((step, site), driven): ((&StepResult, Site), f64)| -> Result<Row> {
            Ok(Row {
                number: step.step,
                site,
                heading: Heading::from_radians(step.pose.heading)?,
                label: match step.label {
                    Some(1) => Some(Label::Positive),
                    Some(-1) => Some(Label::Negative),
                    _ => None, // on the front itself there is no side
                },
                passed: step.passed().collect(),
                elapsed: 1.0,
                driven,
            })
        };
        let area = || -> Result<Area> {
            let Start { area, .. } = start;
            Ok(Area::new(at(area.x[0], area.z[0])?, at(area.x[1], area.z[1])?)?)
        };
        let named = || format!("{}: --front: expected the trace of a mission", file.name);
        let area = area().with_context(named)?;
        let vehicle = match &start.vehicle {
            Some(table) => table.vehicle(Source::File, Algorithm::Track, false, Grid::Fine),
            None => Ok(Grid::Fine.into()),
        };
        let given = &file.samples[..start.oracle.len()];
        let is_watch = start.front.is_some_and(|it| it.watch.is_some());
        let seeking = start.seek.unwrap_or_default().told().with_context(named)?;
        let follower = Track::new(area, vehicle.with_context(named)?, front, noise);
        let follower = follower.and_then(|it| it.seeking(seeking)).with_context(named)?;
        // How wide a front that is found may be is for the follower itself to say.
        let width = follower.width();
        let known = if is_watch {
            Known::Rows(Box::new(FrontBelief::new(area, front, noise).given(given).staying()))
        } else {
            let site = at(start.pose.x, start.pose.z)?;
            let pose = Pose { site, heading: Heading::from_radians(start.pose.heading)? };
            Known::Mission(Box::new(follower.knowing(given)), pose)
        };
        Ok(Self {
            rows: steps.iter().zip(sites).zip(ways).map(row).collect::<Result<_>>()?,
            apart: 0.0,
            width,
            near: (AGAIN / FOUND) as f32 * width,
            known,
            area,
            p,
            is_closed: reason.as_deref() == Some("closed"),
        })
    }
}

/// The whole way to each site, metres.
fn ways(sites: impl Iterator<Item = Site>) -> Vec<f64> {
    let mut last = None;
    let to = |whole: &mut f64, site: Site| {
        let at = Point2::<f64>::from(site);
        *whole += last.replace(at).map_or(0.0, |last: Point2<f64>| (at - last).norm());
        Some(*whole)
    };
    sites.scan(0.0, to).collect()
}

/// What is told: of the front, and of the labels.
type Told = (Front, PTold, Noise<AnyReliability>);

fn noise(p: PTold, tolerance: f64) -> Result<Noise<AnyReliability>> {
    let noise: Noise<AnyReliability> = match p {
        PTold::Number(p) if p < 1.0 => Noise::new(p)?.into(),
        PTold::Number(_) => Noise::NONE.into(),
        PTold::Beta([a, b]) => Noise::beta(a, b)?.into(),
    };
    Ok(Noise { tolerance: Tolerance::new(tolerance)?, ..noise })
}
