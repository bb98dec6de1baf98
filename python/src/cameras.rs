//! Cameras of pictures.

use std::path::{Path, PathBuf};

use epiline::camera::{Baseline, CameraModel, Lens, LensModel, RelativePose, ViewPair};
use epiline::geometry::{Frame, PointPair};
use epiline::io::{CalibratedCamera, Calibration};
use epiline::presentation::camera_doubts;
use epiline::study::plan_views;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::arrays::matrix_of;
use crate::errors::input;
use crate::search::{Threads, watched};

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

/// Cameras of both pictures: numbers, or one or two files of a calibration.
#[derive(FromPyObject)]
pub enum GivenCameras<'py> {
    Numbers([GivenCamera<'py>; 2]),
    Files(Vec<PathBuf>),
}

/// Cameras of both pictures in views without distortion.
#[derive(Clone)]
pub struct KnownCameras {
    pub views: ViewPair,
    /// Distance between the cameras, if the file of a calibration tells it with its unit.
    pub baseline: Option<Baseline>,
    /// Pose of the second camera, if the file of a calibration tells it.
    pub pose: Option<RelativePose>,
    /// How the file was read, in sentences.
    pub notes: Vec<String>,
    /// Doubts about the cameras, in sentences.
    pub doubts: Vec<String>,
}

impl GivenCameras<'_> {
    /// Returns the cameras of pictures of these sizes. `pairs` finds matches without a geometry, for lenses whose model
    /// the file leaves open.
    pub fn known(
        &self,
        py: Python<'_>,
        threads: &Threads,
        frames: [Frame; 2],
        pairs: impl FnOnce() -> Vec<PointPair> + Send,
    ) -> PyResult<KnownCameras> {
        let (models, baseline, pose, notes) = match self {
            Self::Numbers(cameras) => {
                ([cameras[0].model(py, 1)?, cameras[1].model(py, 2)?], None, None, Vec::new())
            }
            Self::Files(files) => {
                let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
                let read = Calibration::read_pair(&paths, None).map_err(|e| input(py, e.to_string()))?;
                let settled = watched(py, threads, None, |_| CalibratedCamera::settled(read, frames, pairs))?;
                let pair = settled.map_err(|problem| input(py, problem))?;
                check_sizes(py, &pair, frames)?;
                let models = pair.each_ref().map(|camera| camera.model);
                let pose = CalibratedCamera::relative_pose(&pair).map(|(pose, _)| pose);
                (models, CalibratedCamera::baseline(&pair), pose, CalibratedCamera::notes_of(&pair))
            }
        };
        let views = plan_views(models.each_ref(), frames).map_err(|error| input(py, error.to_string()))?;
        let doubts = camera_doubts([0, 1].map(|k| (&models[k], frames[k])));
        let doubts = doubts.into_iter().map(|(_, sentence)| sentence).collect();
        Ok(KnownCameras { views, baseline, pose, notes, doubts })
    }
}

/// Refuses cameras of pictures of other sizes.
fn check_sizes(py: Python<'_>, pair: &[CalibratedCamera; 2], frames: [Frame; 2]) -> PyResult<()> {
    for (camera, frame) in pair.iter().zip(frames) {
        let is_resized = camera.is_resized_in(frame);
        let advice = if is_resized { ". If the image was resized, give K for its size" } else { "" };
        camera.check_frame(frame).map_err(|problem| input(py, format!("{problem}{advice}")))?;
    }
    Ok(())
}
