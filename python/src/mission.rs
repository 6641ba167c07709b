//! Missions: flown here, or motion by motion by whoever makes the motions.

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use host_sim::mission::next::{self, Conversation};
use host_sim::mission::read_out::ReadOut;
use host_sim::mission::recording::Recording;
use host_sim::mission::trace;
use host_sim::report::on_map;
use host_sim::report::page::{Chapter, Page};
use host_sim::report::picture::Picture;
use nalgebra::Point2;
use numpy::{PyArray1, PyReadonlyArray2};
use planner_core::Site;
use pyo3::prelude::*;

use crate::lines::points;
use crate::refused;

/// A scenario: keys in JSON, and the name, the text and the folder of a file.
type Told = (String, Option<(String, String, String)>);

fn file(told: &Told) -> Option<(&str, &str, &Path)> {
    told.1.as_ref().map(|(name, text, folder)| (&**name, &**text, Path::new(&**folder)))
}

/// Flies a mission in the simulated world.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, told: Told) -> PyResult<Flight> {
    py.detach(|| {
        let mission = next::simulated(&told.0, file(&told))?;
        let (recording, refusal) = Recording::until_refusal(&mission);
        let refusal = refusal.map(|it| format!("{it:#}"));
        Ok(Flight { recording, refusal })
    })
    .map_err(refused)
}

/// A mission that was flown.
#[pyclass(frozen, module = "boundary_planner._native")]
pub(crate) struct Flight {
    recording: Recording,
    /// Why it was broken off, if a label contradicted what was known.
    #[pyo3(get)]
    refusal: Option<String>,
}

#[pymethods]
impl Flight {
    /// The trace, as JSON Lines.
    fn trace(&self) -> String {
        trace::lines(&self.recording.results)
    }

    /// What of the scenario may be meant otherwise.
    fn doubts(&self) -> Vec<String> {
        self.recording.mission.doubts.clone()
    }

    /// A figure, as SVG.
    fn svg(&self, title: &str) -> String {
        Picture::of(title, &self.recording).svg()
    }

    /// A page to step through it, as HTML.
    fn html(&self, title: &str) -> String {
        let planner = self.recording.mission.algorithm.title();
        let chapter = Chapter::new(format!("Flown by {planner}"), [(planner, &self.recording)]);
        Page::new(title, vec![chapter]).html()
    }

    /// Track, samples and what was found, as `GeoJSON`; of an area from a map.
    fn geojson(&self) -> PyResult<String> {
        on_map::geojson(&self.recording).map_err(refused)
    }

    /// The chance that the sensor reads +1, by what is known in the end, at each place.
    fn chance<'py>(
        &self,
        py: Python<'py>,
        places: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        chances(py, &*self.recording.belief, &places)
    }
}

fn chances<'py>(
    py: Python<'py>,
    belief: &dyn ReadOut,
    places: &PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let site = |at: Point2<f64>| {
        Site::try_from(at).map_err(|why| anyhow::anyhow!("({}, {}): {why}", at.x, at.y))
    };
    let sites = points(places).into_iter().map(site);
    let sites = sites.collect::<Result<Vec<_>, _>>().map_err(refused)?;
    let all = py.detach(|| sites.into_iter().map(|it| belief.chance(it)).collect());
    Ok(PyArray1::from_vec(py, all))
}

/// A mission motion by motion.
#[pyclass(frozen, module = "boundary_planner._native")]
pub(crate) struct Planner {
    conversation: Mutex<Conversation>,
}

impl Planner {
    fn now(&self) -> MutexGuard<'_, Conversation> {
        // What a thread that panicked has left is a conversation all the same.
        self.conversation.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Planner {
    #[new]
    fn new(py: Python<'_>, told: Told) -> PyResult<Self> {
        let begun = py.detach(|| Conversation::begin(&told.0, file(&told)));
        Ok(Self { conversation: begun.map_err(refused)?.into() })
    }

    /// One that goes on after what a state in JSON says.
    #[staticmethod]
    fn again(py: Python<'_>, told: Told, state: &str) -> PyResult<Self> {
        let begun = py.detach(|| Conversation::resume(&told.0, file(&told), state));
        Ok(Self { conversation: begun.map_err(refused)?.into() })
    }

    /// What is to be done next and what is known, as JSON.
    fn answer(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.now().brief_answer()).map_err(refused)
    }

    /// What was done so far, as JSON.
    fn state(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.now().state()).map_err(refused)
    }

    /// Takes in what the motion came to, as JSON.
    fn arrive(&self, py: Python<'_>, arrival: &str) -> PyResult<()> {
        py.detach(|| self.now().arrive(arrival)).map_err(refused)
    }

    /// The chance that the sensor reads +1, by what is known now, at each place.
    fn chance<'py>(
        &self,
        py: Python<'py>,
        places: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        chances(py, self.now().session().belief(), &places)
    }
}
