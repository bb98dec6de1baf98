//! Arrays of Python as points, matrices and pictures, and back.

use std::path::PathBuf;

use epiline::estimate::Match;
use epiline::geometry::{Frame, FundamentalMatrix, HomogeneousPoint, Matrix9, Point, PointPair};
use epiline::image::Picture;
use epiline::io::MatchFile;
use image::{DynamicImage, ImageBuffer};
use nalgebra::Matrix3;
use numpy::{
    Element, PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::input;
use crate::search::Threads;

/// Rows of four coordinates `x1 y1 x2 y2`, px.
pub type Rows<'py> = PyReadonlyArray2<'py, f64>;

/// Returns the pairs of rows `x1 y1 x2 y2`.
pub fn pairs_of(py: Python<'_>, rows: &Rows) -> PyResult<Vec<PointPair>> {
    let rows = rows.as_array();
    if rows.ncols() != 4 {
        return Err(input(
            py,
            format!("pairs have 4 columns x1 y1 x2 y2, and this array has {}", rows.ncols()),
        ));
    }
    Ok(rows.rows().into_iter().map(|row| PointPair::new(row[0], row[1], row[2], row[3])).collect())
}

/// Returns the matches of a dictionary of arrays with the names of a matcher, and clauses about what was read.
pub fn matches_of(py: Python<'_>, arrays: &Bound<'_, PyDict>) -> PyResult<(Vec<Match>, Vec<String>)> {
    let mut named = Vec::new();
    for (name, array) in arrays {
        let name = name.extract::<String>()?;
        named.push(match array.cast::<PyArrayDyn<f64>>() {
            Ok(array) => {
                (name, array.shape().to_vec(), array.readonly().as_array().iter().copied().collect())
            }
            // One number too few: the array counts as damaged, but its name is known.
            Err(_) => (name, vec![1], Vec::new()),
        });
    }
    let found =
        MatchFile::of_arrays(named).map_err(|problem| input(py, format!("the matches: {problem}")))?;
    Ok((found.matches, found.remarks))
}

/// Returns a matrix of three rows.
pub fn matrix_of(py: Python<'_>, name: &str, matrix: &PyReadonlyArray2<'_, f64>) -> PyResult<Matrix3<f64>> {
    let matrix = matrix.as_array();
    if matrix.shape() != [3, 3] {
        let (rows, columns) = matrix.dim();
        return Err(input(py, format!("{name} has 3×3 numbers, and this array has {rows}×{columns}")));
    }
    Ok(Matrix3::from_fn(|row, column| matrix[[row, column]]))
}

/// Returns a fundamental matrix.
pub fn fundamental_of(
    py: Python<'_>,
    matrix: &PyReadonlyArray2<'_, f64>,
    frames: Option<[Frame; 2]>,
) -> PyResult<FundamentalMatrix> {
    let matrix = matrix_of(py, "F", matrix)?;
    FundamentalMatrix::from_numbers(matrix, frames).map_err(|error| input(py, format!("F: {error}")))
}

/// Returns the size of a picture, `(height, width)` as the shape of its array.
pub fn frame_of([height, width]: [usize; 2]) -> Frame {
    Frame::new(width, height)
}

/// Returns a covariance of nine entries.
pub fn covariance_of(py: Python<'_>, covariance: &PyReadonlyArray2<'_, f64>) -> PyResult<Matrix9> {
    let numbers = covariance.as_array();
    if numbers.shape() != [9, 9] || !numbers.iter().all(|v| v.is_finite()) {
        return Err(input(py, "the covariance of F has 9×9 finite numbers, row by row"));
    }
    Ok(Matrix9::from_fn(|row, column| numbers[[row, column]]))
}

/// Reads a picture from a file, or takes it from an array. Messages have its name.
pub fn picture_of(image: &Bound<'_, PyAny>, name: &str, threads: &Threads) -> PyResult<Picture> {
    let py = image.py();
    let failed = |error: epiline::image::LoadError| input(py, error.to_string());
    if let Ok(path) = image.extract::<PathBuf>() {
        return py.detach(|| threads.run(|| Picture::open(&path))).map_err(failed);
    }
    let Ok(array) = image.cast::<PyUntypedArray>() else {
        let kind = image.get_type().name()?.to_string();
        return Err(input(py, format!("{name} is a path or a NumPy array, not {kind}")));
    };
    let pixels = pixels_of(array, name)?;
    let made = || Picture::from_pixels(name.to_owned(), None, pixels);
    py.detach(|| threads.run(made)).map_err(failed)
}

/// Reads both pictures of a pair.
pub fn pictures_of(
    image1: &Bound<'_, PyAny>,
    image2: &Bound<'_, PyAny>,
    threads: &Threads,
) -> PyResult<[Picture; 2]> {
    Ok([picture_of(image1, "image 1", threads)?, picture_of(image2, "image 2", threads)?])
}

fn pixels_of(array: &Bound<'_, PyUntypedArray>, name: &str) -> PyResult<DynamicImage> {
    let py = array.py();
    let (height, width, channels) = match *array.shape() {
        [height, width] => (height, width, 1),
        [height, width, channels @ (1 | 3 | 4)] => (height, width, channels),
        ref other => {
            return Err(input(
                py,
                format!("{name} has the shape {other:?}. Shapes (H, W), (H, W, 3) and (H, W, 4) are read"),
            ));
        }
    };
    let too_large = || input(py, format!("{name} is too large: {width}×{height} px"));
    let [w, h] = [width, height].map(u32::try_from);
    let (Ok(w), Ok(h)) = (w, h) else { return Err(too_large()) };
    let made = if let Some(raw) = values::<u8>(array) {
        match channels {
            1 => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageLuma8),
            3 => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageRgb8),
            _ => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageRgba8),
        }
    } else if let Some(raw) = values::<u16>(array) {
        match channels {
            1 => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageLuma16),
            3 => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageRgb16),
            _ => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageRgba16),
        }
    } else if let Some(raw) = values::<f32>(array) {
        match channels {
            // The library has no grey pixels of this kind.
            1 => {
                let colours = raw.into_iter().flat_map(|v| [v; 3]).collect();
                ImageBuffer::from_raw(w, h, colours).map(DynamicImage::ImageRgb32F)
            }
            3 => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageRgb32F),
            _ => ImageBuffer::from_raw(w, h, raw).map(DynamicImage::ImageRgba32F),
        }
    } else {
        return Err(input(
            py,
            format!("{name} has the type {}. uint8, uint16 and float32 are read", array.dtype()),
        ));
    };
    made.ok_or_else(too_large)
}

/// Returns the numbers of an array in C order, whatever its strides, if they have this type.
fn values<T: Element + Copy>(array: &Bound<'_, PyUntypedArray>) -> Option<Vec<T>> {
    let array = array.cast::<PyArrayDyn<T>>().ok()?;
    let numbers = array.readonly();
    Some(match numbers.as_slice() {
        // A slice may be in Fortran order, too.
        Ok(slice) if array.is_c_contiguous() => slice.to_vec(),
        _ => numbers.as_array().iter().copied().collect(),
    })
}

pub fn matrix3<'py>(py: Python<'py>, matrix: &Matrix3<f64>) -> Bound<'py, PyArray2<f64>> {
    matrix_rows(py, 3, |row, column| matrix[(row, column)])
}

/// Returns a square array.
pub fn matrix_rows(
    py: Python<'_>,
    side: usize,
    entry: impl Fn(usize, usize) -> f64,
) -> Bound<'_, PyArray2<f64>> {
    let rows = (0..side).flat_map(|row| (0..side).map(move |column| (row, column)));
    array2(py, rows.map(|(row, column)| entry(row, column)).collect(), side)
}

/// Returns an array of this many columns, empty or not.
pub fn array2<T: Element>(py: Python<'_>, numbers: Vec<T>, columns: usize) -> Bound<'_, PyArray2<T>> {
    let rows = numbers.len() / columns;
    let flat = PyArray1::from_vec(py, numbers);
    flat.reshape([rows, columns]).expect("whole rows")
}

/// Returns an array of matrices.
pub fn array3(py: Python<'_>, numbers: Vec<f64>) -> Bound<'_, PyArray3<f64>> {
    let count = numbers.len() / 9;
    PyArray1::from_vec(py, numbers).reshape([count, 3, 3]).expect("whole matrices")
}

pub fn points(py: Python<'_>, all: impl Iterator<Item = Point>) -> Bound<'_, PyArray2<f64>> {
    array2(py, all.flat_map(|p| [p.x, p.y]).collect(), 2)
}

/// Returns both epipoles as rows of homogeneous coordinates of unit length.
pub fn epipoles<'py>(py: Python<'py>, f: &FundamentalMatrix) -> Bound<'py, PyArray2<f64>> {
    let row = |e: HomogeneousPoint| e.normalize().iter().copied().collect::<Vec<_>>();
    array2(py, [f.epipole1(), f.epipole2()].map(row).concat(), 3)
}
