//! A recorded track: rows in their order, and what was known before the first.

use std::mem;

use anyhow::{Context as _, Result, bail};
use nalgebra::Point2;
use planner_core::{
    AnyReliability, AnyVehicle, Area, Curve, Front, FrontStretch, Guard, Heading, Label, Noise,
    OneLabel, Planner as _, Pose, Reading, Sample, Site, Tolerance, Track, Trust as _, Unicycle,
};

use crate::mission::algorithm::Algorithm;
use crate::mission::names::FanName;
use crate::mission::results::{PTold, Start, StepResult};
use crate::mission::vehicle::Source;
use crate::replay::answer;
use crate::replay::rows::Traced;
use crate::replay::sample_file::SampleFile;
use crate::report::picture::area_around;

/// The usual motion of one who crosses a front to and fro is this share of the way from one change of labels to the next.
const SHARE: f64 = 0.5;

/// The front is crossed for sure where the logarithm of the odds of labels has changed from less than this to more.
const SURE: f64 = 3.0;

/// Speeds of a follower that is led, 0 among them: only the greatest counts.
const SPEEDS: u16 = 5;

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
    /// The whole way to here, metres.
    pub(crate) driven: f64,
}

/// What takes in the rows: a follower, or the guard of a mission.
pub(crate) trait Follower {
    /// Takes in a row, planned from a pose. Whether the front is sought anew.
    fn take(&mut self, from: Pose, row: &Row) -> Result<bool>;

    /// Whether the front is known.
    fn is_found(&self) -> bool;

    fn one_label(&self) -> Option<OneLabel>;

    fn curve(&self) -> &Curve;
}

impl<const N: usize> Follower for Track<AnyVehicle, Area, N> {
    fn take(&mut self, from: Pose, row: &Row) -> Result<bool> {
        // What it plans may differ, if it is told something else than in the mission.
        let _ = self.plan(from);
        let was_begun = self.belief().is_begun();
        for (site, reading) in &row.passed {
            self.observe_on_the_way(*site, *reading)?;
        }
        self.observe(row.pose(), row.label.map(Into::into))?;
        let is_alarmed = self.alarm().is_some_and(|it| it.is_grave());
        Ok(is_alarmed || was_begun && !self.belief().is_begun())
    }

    fn is_found(&self) -> bool {
        self.found().is_some()
    }

    fn one_label(&self) -> Option<OneLabel> {
        Track::one_label(self)
    }

    fn curve(&self) -> &Curve {
        self.belief()
    }
}

impl Row {
    fn pose(&self) -> Pose {
        Pose { site: self.site, heading: self.heading }
    }
}

/// A recorded track.
pub(crate) struct RecordedTrack {
    pub(crate) rows: Vec<Row>,
    /// What is known of the front before the first row.
    pub(crate) known: Box<dyn Follower>,
    /// Where a mission begins. A follower that is led plans from each row itself.
    start: Option<Pose>,
    /// The front counts as found where its half-width is below this, metres.
    pub(crate) width: f32,
    /// How often labels are true.
    pub(crate) p: PTold,
    /// Whether it ends back where the front was found, after all the way round it.
    pub(crate) is_closed: bool,
}

impl RecordedTrack {
    /// Takes in the row of an index. Whether the front is sought anew.
    pub(crate) fn take(&mut self, index: usize) -> Result<bool> {
        let row = &self.rows[index];
        let from = self.start.as_mut().map(|from| mem::replace(from, row.pose()));
        self.known.take(from.unwrap_or(row.pose()), row)
    }

    /// The track of a file. One of a table begins with nothing known of the box around its samples. That of a trace
    /// begins as its mission did: with its area, its given points and its longest motion.
    ///
    /// # Errors
    /// Names the file, what was found and what was expected.
    pub(crate) fn of(file: &SampleFile, front: Front, trust: answer::Trust) -> Result<Self> {
        let told = file.rows.mission.as_ref().and_then(|it| it.start.p_told);
        let p = trust
            .p
            .map(PTold::Number)
            .or(told)
            .unwrap_or(PTold::Number(file.rows.p.unwrap_or(1.0)));
        let noise = noise(p, trust.tolerance).with_context(|| file.name.clone())?;
        match file.rows.mission.as_deref() {
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
        let samples = &file.samples;
        let ways = ways(samples.iter().map(|it| it.site));
        let reach = reach(samples, &ways, noise.reliability.nominal().probability());
        let step_mm = (1e3 * reach / f64::from(SPEEDS - 1)).clamp(1.0, 9e4) as u32;
        let vehicle = AnyVehicle::Unicycle(Unicycle::new(500_000, 1.5, SPEEDS, step_mm)?);
        // A unit of time is that of a motion, so the speed is told in another unit than that of a row.
        let rows = rows(file, &ways, reach);
        let each = rows.len() as f64 / samples.len() as f64;
        let front = front.moving((front.speed() / each).min(FASTEST))?;
        let follower = Track::new(area, vehicle, front, noise);
        let follower = follower.with_context(|| file.name.clone())?.led();
        Ok(Self {
            rows,
            width: follower.width(),
            known: Box::new(follower),
            start: None,
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
            Some(table) => table.vehicle(Source::File, Algorithm::Track, false, FanName::Fine),
            None => Ok(FanName::Fine.into()),
        };
        let given = &file.samples[..start.oracle.len()];
        let seeking = start.seek.unwrap_or_default().told().with_context(named)?;
        let vehicle = vehicle.with_context(named)?;
        let pose = at(start.pose.x, start.pose.z)?;
        let pose = Pose { site: pose, heading: Heading::from_radians(start.pose.heading)? };
        let (known, width): (Box<dyn Follower>, _) =
            if let Some(metres) = start.front.and_then(|it| it.watch) {
                let told = (front, FrontStretch::metres(metres)?);
                let guard = Guard::watching(area, vehicle, told, noise);
                let guard = guard.and_then(|it| it.seeking(seeking)).with_context(named)?;
                let width = guard.width();
                (Box::new(guard.knowing(given)), width)
            } else {
                let follower = Track::new(area, vehicle, front, noise);
                let follower = follower.and_then(|it| it.seeking(seeking)).with_context(named)?;
                let width = follower.width();
                (Box::new(follower.knowing(given)), width)
            };
        Ok(Self {
            rows: steps.iter().zip(sites).zip(ways).map(row).collect::<Result<_>>()?,
            width,
            known,
            start: Some(pose),
            p,
            is_closed: reason.as_deref() == Some("closed"),
        })
    }
}

/// The length of a motion, for one who crosses a front so often: no shorter than from one row to the next.
fn reach(samples: &[Sample], ways: &[f64], p: f64) -> f64 {
    let whole = ways.last().copied().unwrap_or_default();
    let each = (p / (1.0 - p)).ln().min(2.0 * SURE);
    let (mut odds, mut side, mut changes) = (0.0_f64, None, 0.0);
    for it in samples {
        odds = (odds + each * f64::from(it.label.sign())).clamp(-SURE, SURE);
        if odds.abs() >= SURE && side.replace(odds > 0.0) != Some(odds > 0.0) {
            changes += 1.0;
        }
    }
    (SHARE * whole / f64::max(changes, 1.0)).max(whole / samples.len() as f64)
}

/// The rows of a table as motions of such a length: the last of each is its end, and the others are read on the way.
fn rows(file: &SampleFile, ways: &[f64], reach: f64) -> Vec<Row> {
    let (mut rows, mut passed, mut last) = (Vec::new(), Vec::new(), None::<Point2<f64>>);
    for (k, (&Sample { site, label }, &driven)) in file.samples.iter().zip(ways).enumerate() {
        let at = Point2::<f64>::from(site);
        if last.is_none_or(|last| (at - last).norm() >= reach) {
            let (number, heading, label) = (file.line(k), Heading::default(), Some(label));
            let passed = mem::take(&mut passed);
            rows.push(Row { number, site, heading, label, passed, driven });
            last = Some(at);
        } else {
            passed.push((site, label.into()));
        }
    }
    rows
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
