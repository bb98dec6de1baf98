//! Errors of the library as exceptions of Python. They have the sentences of the command line.

use epiline::estimate::EstimateError;
use epiline::presentation::error_in_words;
use pyo3::prelude::*;

/// Returns the exception of a name in `epiline._errors`.
fn exception(py: Python<'_>, name: &str, message: String) -> PyErr {
    let made = py.import("epiline._errors").and_then(|module| module.getattr(name)?.call1((message,)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// Returns the exception for wrong input.
pub fn input(py: Python<'_>, message: impl Into<String>) -> PyErr {
    exception(py, "InputError", message.into())
}

/// Returns the exception for input from which no geometry follows.
pub fn no_geometry(py: Python<'_>, message: impl Into<String>) -> PyErr {
    exception(py, "NoGeometryError", message.into())
}

/// Returns the exception of an error of the estimator.
pub fn of_estimate(py: Python<'_>, error: &EstimateError) -> PyErr {
    let message = error_in_words(error);
    if error.is_bad_input() { input(py, message) } else { no_geometry(py, message) }
}
