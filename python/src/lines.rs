//! The distribution over straight lines that labels leave, however many labels there are.

use anyhow::bail;
use host_sim::fitting::doubt::{Doubt, Votes};
use host_sim::fitting::line_posterior::LinePosterior;
use nalgebra::{Point2, Vector2};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use planner_core::{Label, Sample};
use pyo3::prelude::*;

use crate::refused;

/// Half the size of the samples on the lattice, metres: whatever their unit, they fill some of it.
const HALF: f64 = 1024.0;

/// Lines cross the ground around the samples, which is so much larger than they reach.
const WIDER: f64 = 1.25;

/// The lines that labels leave, each with its probability.
#[pyclass(frozen, module = "boundary_planner._native")]
pub(crate) struct Lines {
    posterior: LinePosterior,
    middle: Point2<f64>,
    scale: f64,
}

impl Lines {
    fn of(
        places: Vec<Point2<f64>>,
        labels: &[bool],
        p: f64,
        tolerance: f64,
    ) -> anyhow::Result<Self> {
        let least = places.iter().fold(Point2::new(f64::MAX, f64::MAX), |it, at| it.inf(at));
        let most = places.iter().fold(Point2::new(f64::MIN, f64::MIN), |it, at| it.sup(at));
        let (middle, half) = (nalgebra::center(&least, &most), (most - least) / 2.0);
        let scale = HALF / half.amax();
        if !scale.is_finite() {
            bail!("X: found one place, expected samples that are apart from each other");
        }
        let sample = |(at, is_positive): (Point2<f64>, &bool)| {
            let label = if *is_positive { Label::Positive } else { Label::Negative };
            let at = (at - middle) * scale;
            Sample::at([at.x, at.y], label)
        };
        let samples = places.into_iter().zip(labels).map(sample).collect::<Result<Vec<_>, _>>()?;
        let votes = Votes::of(&samples, &[], Point2::origin());
        let votes = votes.unwrap_or_default();
        let tolerance = (tolerance > 0.0).then_some(tolerance * scale);
        // A side that all samples lie along is no wider than they are apart along the other.
        let reach = (half * scale * WIDER).sup(&Vector2::repeat(HALF / 8.0));
        let posterior = LinePosterior::of(&votes, &Doubt::new(p, tolerance), reach);
        let posterior = posterior.map_err(|why| anyhow::anyhow!("y: {why}"))?;
        Ok(Self { posterior, middle, scale })
    }
}

#[pymethods]
impl Lines {
    #[new]
    fn new(
        py: Python<'_>,
        places: PyReadonlyArray2<'_, f64>,
        labels: PyReadonlyArray1<'_, bool>,
        p: f64,
        tolerance: f64,
    ) -> PyResult<Self> {
        let places = points(&places);
        let labels = labels.as_array().to_vec();
        py.detach(|| Self::of(places, &labels, p, tolerance)).map_err(refused)
    }

    /// The chance that each place lies on the +1 side.
    fn chance<'py>(
        &self,
        py: Python<'py>,
        places: PyReadonlyArray2<'py, f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        let places: Vec<_> = points(&places)
            .into_iter()
            .map(|at| ((at - self.middle) * self.scale).into())
            .collect();
        PyArray1::from_vec(py, py.detach(|| self.posterior.chances(&places)))
    }

    /// The mean line: `a x + b z + c`, which is positive on its +1 side, with `a^2 + b^2 = 1`.
    fn mean(&self) -> [f64; 3] {
        let (normal, distance) = self.posterior.mean();
        let at = distance / self.scale + normal.dot(&self.middle.coords);
        [normal.x, normal.y, -at]
    }

    /// What was left out of account, as a share of all, at most.
    fn pruned(&self) -> f64 {
        self.posterior.pruned_mass
    }
}

/// The rows of an array.
pub(crate) fn points(places: &PyReadonlyArray2<'_, f64>) -> Vec<Point2<f64>> {
    places.as_array().rows().into_iter().map(|it| Point2::new(it[0], it[1])).collect()
}
