//! The built-in pairs.

use epiline::geometry::{Camera, PointPair};
use epiline::image::Picture;
use epiline::synthetic::Sample;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays;
use crate::errors::input;
use crate::search::Threads;

/// Both pictures, F, both projection matrices, both calibration matrices, exact matches, and clicks.
type Parts<'py> = (
    [Bound<'py, PyArray3<u8>>; 2],
    Bound<'py, PyArray2<f64>>,
    [Bound<'py, PyArray2<f64>>; 2],
    [Bound<'py, PyArray2<f64>>; 2],
    [Bound<'py, PyArray2<f64>>; 2],
);

/// Returns a built-in pair with its exact geometry.
#[pyfunction]
pub fn sample<'py>(py: Python<'py>, name: &str) -> PyResult<Parts<'py>> {
    let known = Sample::from_name(name).ok_or_else(|| {
        let names = Sample::ALL.map(Sample::name).join(", ");
        input(py, format!("there is no built-in sample {name:?}. Choose one of {names}"))
    })?;
    let pair = py.detach(|| Threads::of_process().run(|| known.load()));
    let picture = |picture: &Picture| {
        let pixels = picture.pixels.to_rgb8();
        let shape = [pixels.height() as usize, pixels.width() as usize, 3];
        PyArray1::from_vec(py, pixels.into_raw()).reshape(shape).expect("three numbers a pixel")
    };
    let camera = |camera: &Camera| {
        let rows = camera.matrix().row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>());
        arrays::array2(py, rows.collect(), 4)
    };
    let calibration =
        |camera: &Camera| arrays::matrix3(py, &camera.calibration().expect("a camera with a finite centre"));
    let rows =
        |pairs: &[PointPair]| arrays::array2(py, pairs.iter().flat_map(PointPair::numbers).collect(), 4);
    Ok((
        pair.pictures.each_ref().map(picture),
        arrays::matrix3(py, pair.fundamental.matrix()),
        pair.cameras.each_ref().map(camera),
        pair.cameras.each_ref().map(calibration),
        [rows(&pair.matches), rows(&pair.show_me)],
    ))
}
