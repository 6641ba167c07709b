//! What is given beforehand: the oracle's points, and `bounds` of the line, which become samples too.

use anyhow::Result;
use planner_core::error::GivenError;
use planner_core::{Label, Sample, VersionSpace};
use serde::Deserialize;

use crate::mission::bounds::Bounds;
use crate::mission::strict::{Table, beyond, wrong};
use crate::mission::terrain::{self, Terrain, site};
use crate::world::World;

/// Samples that a simulated planner can hold, the oracle's included: 64 labels beside its four.
pub const CAPACITY: usize = 68;

/// The version space of simulated planners.
pub type Lines = VersionSpace<CAPACITY>;

/// The most given samples that may bound the line. A hypothesis stores this many constraints.
const MOST_BOUNDING: usize = 15;

/// A point of the oracle in a scenario file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SampleTable {
    /// Metres
    pub(crate) x: Option<f64>,
    /// Metres
    pub(crate) z: Option<f64>,
    /// Degrees, where the area is from a map
    pub(crate) lat: Option<f64>,
    /// Degrees, where the area is from a map
    pub(crate) lon: Option<f64>,
    /// -1 or 1
    label: i64,
}

impl SampleTable {
    /// Where it is, metres; `None` if it says no place.
    pub(crate) fn at(&self) -> Option<[f64; 2]> {
        Some([self.x?, self.z?])
    }
}

/// What is known at the start: some samples, and the lines that they leave if they bound any.
#[derive(Clone, Debug)]
pub struct Given {
    samples: Vec<Sample>,
    lines: Option<Lines>,
}

impl Given {
    /// The samples.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The lines that they leave. `None` where they do not bound them: there are none, they have one label, or no line
    /// separates them.
    pub const fn lines(&self) -> Option<&Lines> {
        self.lines.as_ref()
    }

    /// Samples that do not bound the line.
    pub const fn open(samples: Vec<Sample>) -> Self {
        Self { samples, lines: None }
    }

    /// Samples of a front, which no line need separate.
    pub fn of_front(samples: Vec<Sample>) -> Self {
        let lines = VersionSpace::new(&samples).ok();
        Self { samples, lines }
    }
}

impl From<Lines> for Given {
    fn from(lines: Lines) -> Self {
        Self { samples: lines.samples().to_vec(), lines: Some(lines) }
    }
}

/// What is known of a front at the start: the oracle's points. A front has no bounds.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn given_of_front(
    oracle: &[Table<SampleTable>],
    bounds: &Bounds,
    area: &Terrain,
    world: &World,
) -> Result<Given> {
    if !bounds.is_empty() {
        return wrong("bounds", "some with algorithm track", "none, as they are those of a line");
    }
    points(oracle, area, world).map(Given::of_front)
}

/// The lines that the oracle's points and the bounds leave, if they bound any. The points come first. If they do not say on which side of
/// the line +1 lies, it lies above.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn given(
    oracle: &[Table<SampleTable>],
    bounds: &Bounds,
    area: &Terrain,
    world: &World,
) -> Result<Given> {
    let oracle = points(oracle, area, world)?;
    let is_of_one = oracle.windows(2).all(|pair| pair[0].label == pair[1].label);
    if is_of_one && bounds.is_empty() {
        return Ok(Given::open(oracle));
    }
    let above = bounds.samples(area.area())?;
    let below: Vec<_> =
        above.iter().map(|&Sample { site, label }| Sample { site, label: -label }).collect();
    let with = |bounds: &[Sample]| VersionSpace::new(&[&*oracle, bounds].concat());
    let lines = match with(&above) {
        Err(GivenError::NotSeparable(k)) if k >= oracle.len() => {
            with(&below).map(|lines| (lines, &below))
        }
        lines => lines.map(|lines| (lines, &above)),
    };
    let (lines, bounding) = lines.or_else(|error| refused(error, &oracle, bounds))?;
    let is_line = world.line().is_some();
    if is_line && !bounding.iter().all(|it| world.agrees(it.site, it.label)) {
        return wrong("bounds", "a line outside, the truth", "bounds that hold the truth");
    }
    let bounding = lines.cell().edges().len();
    if bounding > MOST_BOUNDING {
        let found = format!("{bounding} points that bound the line");
        return wrong("oracle", found, format!("at most {MOST_BOUNDING} that do"));
    }
    Ok(lines.into())
}

/// The oracle's points.
fn points(tables: &[Table<SampleTable>], area: &Terrain, world: &World) -> Result<Vec<Sample>> {
    let point = |(i, Table(table)): (usize, &Table<SampleTable>)| {
        let field = format!("oracle[{i}]");
        let label = match table.label {
            1 => Label::Positive,
            -1 => Label::Negative,
            other => return beyond(&format!("{field}.label"), other),
        };
        let (Some(x), Some(z)) = (table.x, table.z) else {
            let missing = if table.x.is_none() { "x" } else { "z" };
            return wrong(&format!("{field}.{missing}"), "none", "metres");
        };
        let site = site(&field, x, z)?;
        terrain::check_inside(&field, site, area)?;
        if !world.agrees(site, label) {
            let expected = format!("{}, as the truth has it", world.reading(site).sign());
            return wrong(&format!("{field}.label"), table.label, expected);
        }
        Ok(Sample { site, label })
    };
    tables.iter().enumerate().map(point).collect()
}

/// Why samples leave no lines to find, by field.
fn refused<T>(error: GivenError, oracle: &[Sample], bounds: &Bounds) -> Result<T> {
    match error {
        GivenError::Collinear => {
            wrong("oracle", "points on one line", "three or more points that are not collinear")
        }
        GivenError::OneLabel => {
            let label = oracle.first().map_or(0, |s| s.label.sign());
            wrong("oracle", format!("only the label {label}"), "points of both labels")
        }
        GivenError::NotSeparable(i) if i >= oracle.len() => {
            let found = "bounds that no line keeps with the oracle's points";
            wrong("bounds", found, "bounds that leave a line")
        }
        GivenError::NotSeparable(i) => {
            let expected = "points that a line separates by their labels";
            wrong(&format!("oracle[{i}]"), "a label that no line allows", expected)
        }
        GivenError::TooMany => {
            let count = oracle.len() + bounds.len();
            wrong("oracle", format!("{count} points"), format!("at most {CAPACITY}"))
        }
        other => wrong("oracle", other, "points that leave lines to find"),
    }
}
