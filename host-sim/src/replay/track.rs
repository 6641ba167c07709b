//! A recorded track: rows in their order, and what was known before the first.

use anyhow::{Context as _, Result, bail};
use nalgebra::Point2;
use planner_core::motion::unicycle::Grid;
use planner_core::{
    AnyReliability, Area, Front, Label, Noise, Reading, Sample, Site, Tolerance, Track,
};

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::FrontBelief;
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

/// A row of a track: where the robot came, and what it read there and on the way there.
pub(crate) struct Row {
    /// The line of the file, its feature, or the step of a trace.
    pub(crate) number: usize,
    pub(crate) site: Site,
    pub(crate) label: Option<Label>,
    pub(crate) passed: Vec<(Site, Reading)>,
}

/// A recorded track.
pub(crate) struct RecordedTrack {
    pub(crate) rows: Vec<Row>,
    /// What is known of the front before the first row.
    pub(crate) tracker: FrontBelief,
    /// The front counts as found where its half-width is below this, metres.
    pub(crate) width: f32,
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
        let width = FOUND * SHORT * radius.min(0.5 * (x + z));
        let row = |(k, &Sample { site, label }): (usize, &Sample)| Row {
            number: file.line(k),
            site,
            label: Some(label),
            passed: Vec::new(),
        };
        Ok(Self {
            rows: file.samples.iter().enumerate().map(row).collect(),
            tracker: FrontBelief::new(area, front, noise),
            width: width as f32,
            p,
            is_closed: false,
        })
    }

    fn of_mission(file: &SampleFile, mission: &Traced, (front, p, noise): Told) -> Result<Self> {
        let Traced { start, steps, reason } = mission;
        let at = |x, z| file.frame.site([x, z]);
        let row = |step: &StepResult| {
            Ok(Row {
                number: step.step,
                site: at(step.pose.x, step.pose.z)?,
                label: match step.label {
                    Some(1) => Some(Label::Positive),
                    Some(-1) => Some(Label::Negative),
                    _ => None, // on the front itself there is no side
                },
                passed: step.passed().collect(),
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
        let tracker = FrontBelief::new(area, front, noise);
        let tracker = tracker.given(&file.samples[..start.oracle.len()]);
        // How wide a front that is found may be is for the follower itself to say.
        let follower = Track::new(area, vehicle.with_context(named)?, tracker.clone());
        Ok(Self {
            rows: steps.iter().map(row).collect::<Result<_>>().with_context(named)?,
            tracker,
            width: follower.with_context(named)?.width(),
            p,
            is_closed: reason.as_deref() == Some("closed"),
        })
    }
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
