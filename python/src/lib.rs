//! The extension module `epiline._epiline`. `epiline/__init__.py` documents its functions.
//!
//! All computations release the lock of the interpreter, and Ctrl-C stops them.

// PyO3 extracts the arguments of a function by value, and Python names all of them.
#![allow(clippy::needless_pass_by_value, clippy::struct_excessive_bools, clippy::too_many_arguments)]

mod arrays;
mod barcode;
mod cameras;
mod errors;
mod estimate;
mod geometry;
mod judge;
mod lines;
mod points;
mod rectify;
mod sample;
mod search;

use std::ffi::OsString;
use std::path::PathBuf;

use epiline::internals::app::model::session::{OpenSession, SessionOwner};
use epiline::internals::app::{Opening, Start};
use pyo3::prelude::*;

/// Runs the program `epiline` with arguments, the first of which is its name. Returns the exit status.
#[pyfunction]
fn run(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| epiline::internals::cli::main_with(arguments))
}

/// Opens the window on a session that `Estimate._hand_over` wrote. Returns when the window is closed.
#[pyfunction]
fn show(py: Python<'_>, session: PathBuf) -> PyResult<()> {
    let session = OpenSession { owner: SessionOwner::Caller, ..session.into() };
    let start = Start { opening: Opening::Session(session), ..Start::default() };
    py.detach(|| epiline::internals::app::run(start)).map_err(|error| errors::input(py, error.to_string()))
}

#[pymodule]
fn _epiline(module: &Bound<PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<estimate::Estimate>()?;
    module.add_class::<geometry::Reading>()?;
    module.add_class::<judge::Judgement>()?;
    module.add_class::<lines::LineMatch>()?;
    module.add_class::<lines::Suggestion>()?;
    module.add_class::<rectify::Rectification>()?;
    module.add_function(wrap_pyfunction!(estimate::estimate, module)?)?;
    module.add_function(wrap_pyfunction!(barcode::barcode, module)?)?;
    module.add_function(wrap_pyfunction!(points::estimate_points, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::check_convention, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::epilines, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::epipolar_distance, module)?)?;
    module.add_function(wrap_pyfunction!(judge::judge, module)?)?;
    module.add_function(wrap_pyfunction!(lines::line_similarity, module)?)?;
    module.add_function(wrap_pyfunction!(lines::suggest, module)?)?;
    module.add_function(wrap_pyfunction!(rectify::rectify, module)?)?;
    module.add_function(wrap_pyfunction!(sample::sample, module)?)?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(show, module)?)?;
    Ok(())
}
