//! Geometry of calibrations: files with calibration matrices and the pose of the second camera.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};

use super::notes::GeometryNote;
use super::{Format, GeometryFile};
use crate::camera::{PicturesOf, RelativePose, ViewPair};
use crate::geometry::{Camera, FundamentalMatrix, epipolar_difference};
use crate::io::calibration::{CalibratedCamera, Calibration};
use crate::io::read::ReadError;

/// Largest mean difference between the lines of two matrices of one file that rounding explains, px of an
/// image of 1000 px.
const SAME: f64 = 0.5;

/// Distance at which a difference counts as clear, px.
const MOST: f64 = 50.0;

const NO_POSE: &str = "it is a calibration without the pose of the second camera (R and T), so there is no fundamental matrix in it";

/// Completes what was read from a file by the calibration in it. The cameras of a calibration with lenses
/// take the place of rectified ones (`P1` and `P2` of `cv::stereoRectify`) beside it.
pub(super) fn completed(
    path: &Path,
    read: Result<(GeometryFile, Format), ReadError>,
) -> Result<(GeometryFile, Format), ReadError> {
    let is_other = |file: &GeometryFile| file.geometry().is_none() && !file.pairs.is_empty();
    if read.as_ref().is_ok_and(|(file, _)| is_other(file)) {
        return read;
    }
    let found = match Calibration::find(path) {
        Some(Ok(found)) => found,
        Some(Err(problem)) => return read.or(Err(problem)),
        None => return read,
    };
    // F belongs to pictures without distortion, so it does not depend on the model of a lens.
    let pair = match found.open_pair(None) {
        Ok(pair) => pair,
        Err(problem) => return read.map_err(|_| ReadError::content(path, problem)),
    };
    let Some((pose, _)) = CalibratedCamera::relative_pose(&pair) else {
        return read.map_err(|_| ReadError::content(path, NO_POSE));
    };
    let (file, format) = read.unwrap_or((GeometryFile::of(PicturesOf::Untold), Format::OpencvYaml));
    Ok((file.with_calibration(&pair, &pose), format))
}

impl GeometryFile {
    /// Returns the geometry of two calibrated cameras. `None` without poses.
    pub fn of_calibration(pair: &[CalibratedCamera; 2]) -> Option<Self> {
        let (pose, _) = CalibratedCamera::relative_pose(pair)?;
        Some(Self::of(PicturesOf::Untold).with_calibration(pair, &pose))
            .filter(|file| file.fundamental.is_some())
    }

    /// Adds the geometry of two calibrated cameras. F and cameras that are there are compared with it.
    fn with_calibration(mut self, pair: &[CalibratedCamera; 2], pose: &RelativePose) -> Self {
        let calibrations = pair.each_ref().map(|camera| camera.model.calibration());
        let Some(fundamental) = pose.fundamental(&calibrations) else { return self };
        let [k1, k2] = calibrations;
        let cameras = Camera::posed(&k1, &Matrix3::identity(), &Vector3::zeros()).zip(Camera::posed(
            &k2,
            pose.rotation.matrix(),
            &pose.translation,
        ));
        let differs = |other: &FundamentalMatrix| {
            let frame = pair[0].frame.unwrap_or(FundamentalMatrix::TYPICAL);
            epipolar_difference(&fundamental, other, [frame; 2], MOST) > SAME
        };
        let lens = pair.iter().any(|camera| !camera.model.lens().is_ideal());
        match (&self.fundamental, self.geometry()) {
            (Some(own), _) if differs(own) => self.remarks.push(GeometryNote::Contradicted.to_string()),
            (None, Some(own)) if differs(&own) => self.remarks.push(GeometryNote::OtherCameras.to_string()),
            _ => {}
        }
        self.fundamental = self.fundamental.or(Some(fundamental));
        self.cameras = cameras.map(<[Camera; 2]>::from);
        if lens {
            self.pictures = PicturesOf::Undistorted(None);
        }
        self.remarks.push(GeometryNote::OfCalibration { lens }.to_string());
        self.remarks.extend(CalibratedCamera::notes_of(pair));
        self
    }

    /// Returns the fundamental matrix of an essential one for two calibrated cameras: `K2⁻ᵀ E K1⁻¹`. `None` if
    /// the matrix of the file does not look like an essential one.
    pub fn calibrated_essential(&self, pair: &[CalibratedCamera; 2]) -> Option<Self> {
        let fundamental = of_essential(&self.essential?, &pair.each_ref().map(|c| c.model.calibration()))?;
        let lens = pair.iter().any(|camera| !camera.model.lens().is_ideal());
        let remarks = vec![GeometryNote::OfCalibration { lens }.to_string()];
        let pictures = if lens { PicturesOf::Undistorted(None) } else { self.pictures.clone() };
        Some(Self { fundamental: Some(fundamental), pictures, essential: None, remarks, ..self.clone() })
    }

    /// Returns `F` between the views of calibrated cameras. The calibration matrices of an essential matrix
    /// are added. Those of an undistorted geometry with cameras are replaced by the ones of the views.
    pub fn geometry_in(&self, views: &ViewPair) -> Option<FundamentalMatrix> {
        let of_views = views.calibrations();
        if let Some(essential) = &self.essential {
            return of_essential(essential, &of_views);
        }
        let own = self.cameras.as_ref().filter(|_| self.pictures == PicturesOf::Undistorted(None));
        let Some([k1, k2]) = own.and_then(|[a, b]| Some([a.calibration()?, b.calibration()?])) else {
            return self.geometry();
        };
        of_essential(&(k2.transpose() * self.geometry()?.matrix() * k1), &of_views)
    }
}

fn of_essential(essential: &Matrix3<f64>, calibrations: &[Matrix3<f64>; 2]) -> Option<FundamentalMatrix> {
    let [inverse1, inverse2] = [calibrations[0].try_inverse()?, calibrations[1].try_inverse()?];
    FundamentalMatrix::nearest_rank_two(inverse2.transpose() * essential * inverse1)
}
