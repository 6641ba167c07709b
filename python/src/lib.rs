//! The planner and its simulator for Python. `boundary_planner` is a thin face over this module: values go in and out as
//! JSON, in the words of scenario files and traces, and as arrays.

#![forbid(unsafe_code)]
#![expect(clippy::needless_pass_by_value, reason = "what comes from Python is owned")]

mod lines;
mod mission;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(boundary_planner, BoundaryError, PyValueError, "What is wrong, in one line.");

fn refused(why: anyhow::Error) -> PyErr {
    BoundaryError::new_err(format!("{why:#}"))
}

/// The module.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::BoundaryError;
    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use super::lines::Lines;
    #[pymodule_export]
    use super::mission::{Flight, Planner, run};
}

/// Does what the command line does with these words, and returns what it prints.
#[pyfunction]
fn command(py: Python<'_>, words: Vec<String>) -> PyResult<String> {
    use clap::Parser as _;
    use host_sim::cli::arguments::Cli;
    use host_sim::cli::wrong_flag::in_one_line;

    let words = ["host-sim".to_owned(), "--quiet".to_owned()].into_iter().chain(words);
    let cli = match Cli::try_parse_from(words) {
        Ok(cli) => cli,
        Err(why) if why.use_stderr() => {
            return Err(BoundaryError::new_err(in_one_line(&why).to_string()));
        }
        // Help, or a version.
        Err(answer) => return Ok(answer.to_string()),
    };
    let done = py.detach(|| cli.execute()).map_err(refused)?;
    match done.failure {
        None => Ok(done.text),
        Some((why, _)) => Err(refused(why)),
    }
}
