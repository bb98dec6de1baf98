//! Cameras of pictures.

use epiline::camera::{CameraModel, Lens, LensModel, ViewPair};
use epiline::geometry::Frame;
use epiline::study::plan_views;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::arrays::matrix_of;
use crate::errors::input;

/// A camera: its calibration matrix, and the coefficients of OpenCV's lens model.
#[derive(FromPyObject)]
pub struct GivenCamera<'py>(PyReadonlyArray2<'py, f64>, Vec<f64>);

impl GivenCamera<'_> {
    fn model(&self, py: Python<'_>, number: usize) -> PyResult<CameraModel> {
        let Self(matrix, coefficients) = self;
        let lens = match coefficients[..] {
            [] => Lens::IDEAL,
            _ => Lens::of_model(LensModel::OpenCv.name(), coefficients).ok_or_else(|| {
                input(
                    py,
                    format!(
                        "camera {number} has {} distortion coefficients. OpenCV has 4, 5, 8 or 12",
                        coefficients.len()
                    ),
                )
            })?,
        };
        let matrix = matrix_of(py, &format!("the matrix K of camera {number}"), matrix)?;
        CameraModel::new(&matrix, lens).ok_or_else(|| {
            input(
                py,
                format!(
                    "camera {number} is impossible: K is upper triangular, with focal lengths above 0, px"
                ),
            )
        })
    }
}

/// Returns the views of two cameras.
pub fn views_of(py: Python<'_>, cameras: &[GivenCamera; 2], frames: [Frame; 2]) -> PyResult<ViewPair> {
    let models = [cameras[0].model(py, 1)?, cameras[1].model(py, 2)?];
    plan_views([&models[0], &models[1]], frames).map_err(|error| input(py, error.to_string()))
}
