//! Lines and distances of a fundamental matrix, and its conventions.

use epiline::convention::check_convention as check;
use epiline::geometry::{
    FundamentalMatrix, PointPair, algebraic_residual, sampson_distance, symmetric_epipolar_distance,
};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{self, Rows, fundamental_of, pairs_of};
use crate::errors::input;
use crate::search::Threads;

/// Returns the epipolar lines of points of one image in the other.
#[pyfunction]
pub fn epilines<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    fundamental: PyReadonlyArray2<'py, f64>,
    image: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let f = fundamental_of(py, &fundamental, None)?;
    let f = match image {
        1 => f,
        2 => f.swapped(),
        _ => return Err(input(py, format!("image is 1 or 2, not {image}"))),
    };
    let points = points.as_array();
    if points.ncols() != 2 {
        return Err(input(py, format!("points have 2 columns x y, and this array has {}", points.ncols())));
    }
    let line = |row: numpy::ndarray::ArrayView1<f64>| match f.line2_from_point1([row[0], row[1]].into()) {
        Some(line) => line.coefficients().iter().copied().collect(),
        // The epipole has no line.
        None => vec![f64::NAN; 3],
    };
    Ok(arrays::array2(py, points.rows().into_iter().flat_map(line).collect(), 3))
}

/// Returns the distances of matches from their epipolar lines.
#[pyfunction]
pub fn epipolar_distance<'py>(
    py: Python<'py>,
    fundamental: PyReadonlyArray2<'py, f64>,
    rows: Rows<'py>,
    kind: &str,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let f = fundamental_of(py, &fundamental, None)?;
    let distance: fn(&FundamentalMatrix, &PointPair) -> f64 = match kind {
        "symmetric" => symmetric_epipolar_distance,
        "sampson" => sampson_distance,
        "algebraic" => algebraic_residual,
        _ => {
            return Err(input(
                py,
                format!("kind is \"symmetric\", \"sampson\" or \"algebraic\", not {kind:?}"),
            ));
        }
    };
    let pairs = pairs_of(py, &rows)?;
    Ok(PyArray1::from_vec(py, pairs.iter().map(|pair| distance(&f, pair)).collect()))
}

/// A possible meaning of a matrix.
#[pyclass(frozen, module = "epiline")]
pub struct Reading {
    /// Whether the matrix maps image 2 to image 1.
    #[pyo3(get)]
    transposed: bool,
    /// Whether points are (y, x).
    #[pyo3(get)]
    axes_exchanged: bool,
    /// Coordinate of the centre of the upper left pixel: 0, 0.5 or 1.
    #[pyo3(get)]
    origin: f64,
    /// Size of the images of the matrix over the size of the images of the matches.
    #[pyo3(get)]
    scale: f64,
    /// Median symmetric epipolar distance of the matches, px.
    #[pyo3(get)]
    median: f64,
    /// Share of the matches near their lines, 0 to 1.
    #[pyo3(get)]
    within: f64,
    /// Whether the matches distinguish this reading from the first of the list.
    #[pyo3(get)]
    told_apart: bool,
    /// Whether the matches fit this reading.
    #[pyo3(get)]
    fits: bool,
    /// The reading in words.
    #[pyo3(get)]
    words: String,
    matrix: [[f64; 3]; 3],
}

#[pymethods]
impl Reading {
    /// Matrix of shape (3, 3) in this reading, in the convention of this package.
    #[getter(F)]
    fn fundamental<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::array2(py, self.matrix.concat(), 3)
    }

    fn __repr__(&self) -> String {
        format!("<epiline.Reading: {}, median {:.2} px>", self.words, self.median)
    }
}

/// Tests under which convention a matrix fits matches.
#[pyfunction]
pub fn check_convention(
    py: Python<'_>,
    fundamental: PyReadonlyArray2<'_, f64>,
    rows: Rows<'_>,
) -> PyResult<Vec<Reading>> {
    let f = fundamental_of(py, &fundamental, None)?;
    let pairs = pairs_of(py, &rows)?;
    let found = py
        .detach(|| Threads::of_process().run(|| check(&f, &pairs)))
        .map_err(|error| input(py, error.to_string()))?;
    let reading = |ranked: &epiline::convention::RankedReading| Reading {
        transposed: ranked.reading.transposed,
        axes_exchanged: ranked.reading.axes_exchanged,
        origin: ranked.reading.origin,
        scale: ranked.reading.scale,
        median: ranked.median,
        within: ranked.within,
        told_apart: ranked.told_apart,
        fits: ranked.median <= found.limit,
        words: ranked.reading.to_string(),
        matrix: ranked.fundamental.rows(),
    };
    Ok(found.readings.iter().map(reading).collect())
}
