//! Calibrations in lines of text: KITTI, Middlebury, COLMAP.

use nalgebra::{Matrix3, Matrix3x4, Rotation3, Vector3};

use super::super::number::{finite_numbers, rows};
use super::{CalibratedCamera, CameraPose};
use crate::camera::{CameraModel, IMPOSSIBLE, LengthUnit, Lens};
use crate::foreign::excerpt;
use crate::geometry::Frame;

/// Returns whether a text has rows of KITTI's calibration files.
pub(super) fn is_kitti(text: &str) -> bool {
    rows(text).any(|(_, row)| row.starts_with("K_00:") || row.starts_with("P0:"))
}

/// Reads `calib_cam_to_cam.txt` (raw images with distortion) or `calib.txt` (rectified images).
pub(super) fn kitti(text: &str) -> Result<Vec<CalibratedCamera>, String> {
    let entry = |name: &str| -> Result<Option<Vec<f64>>, String> {
        let found = rows(text).find_map(|(_, row)| row.strip_prefix(name)?.strip_prefix(':'));
        found.map(finite_numbers).transpose().map_err(|e| format!("{name}: {e}"))
    };
    let mut cameras = Vec::new();
    for k in 0..100 {
        let exact = |name: String, count: usize| -> Result<Option<Vec<f64>>, String> {
            match entry(&name)? {
                Some(numbers) if numbers.len() != count => {
                    Err(format!("{name}: expected {count} numbers, found {}", numbers.len()))
                }
                other => Ok(other),
            }
        };
        if let Some(matrix) = exact(format!("K_{k:02}"), 9)? {
            let lens = Lens::from_opencv(&entry(&format!("D_{k:02}"))?.unwrap_or_default())?;
            let size = exact(format!("S_{k:02}"), 2)?;
            let pose = match (exact(format!("R_{k:02}"), 9)?, exact(format!("T_{k:02}"), 3)?) {
                (Some(r), Some(t)) => {
                    Some(CameraPose::new(&Matrix3::from_row_slice(&r), Vector3::from_column_slice(&t))?)
                }
                _ => None,
            };
            let model = CameraModel::new(&Matrix3::from_row_slice(&matrix), lens).ok_or(IMPOSSIBLE)?;
            let frame = size.map(|size| Frame::new(size[0] as usize, size[1] as usize));
            let name = format!("{k:02}");
            let unit = LengthUnit::Metre;
            cameras.push(CalibratedCamera { name, model, frame, pose, unit });
        } else if let Some(projection) = exact(format!("P{k}"), 12)? {
            cameras.push(pinhole(format!("P{k}"), &Matrix3x4::from_row_slice(&projection))?);
        }
    }
    if cameras.is_empty() { Err("there is no camera with K or P in it".into()) } else { Ok(cameras) }
}

/// Reads Middlebury's `calib.txt`: two rectified cameras.
pub(super) fn middlebury(text: &str) -> Result<Vec<CalibratedCamera>, String> {
    let entry = |name: &str| {
        rows(text).find_map(|(_, row)| row.strip_prefix(name)?.trim_start().strip_prefix('=')).map(str::trim)
    };
    let number = |name: &str| {
        let value = entry(name).map(str::parse::<f64>);
        match value {
            None => Ok(None),
            Some(Ok(value)) if value.is_finite() => Ok(Some(value)),
            _ => Err(format!("{name}: expected a number")),
        }
    };
    let frame = match (number("width")?, number("height")?) {
        (Some(width), Some(height)) => Some(Frame::new(width as usize, height as usize)),
        _ => None,
    };
    let known = number("baseline")?;
    let unit = if known.is_some() { LengthUnit::Millimetre } else { LengthUnit::Baseline };
    let baseline = known.unwrap_or(1.0);
    let mut cameras = Vec::new();
    for (name, offset) in [("cam0", 0.0), ("cam1", -baseline)] {
        let text = entry(name).ok_or_else(|| format!("{name} is missing"))?;
        let numbers = finite_numbers(text.trim_matches(['[', ']'])).map_err(|e| format!("{name}: {e}"))?;
        if numbers.len() != 9 {
            return Err(format!("{name}: expected a 3×3 matrix, found {} numbers", numbers.len()));
        }
        let model = CameraModel::new(&Matrix3::from_row_slice(&numbers), Lens::IDEAL).ok_or(IMPOSSIBLE)?;
        let pose =
            CameraPose { rotation: Rotation3::identity(), translation: Vector3::new(offset, 0.0, 0.0) };
        let (name, pose) = (name.to_owned(), Some(pose));
        cameras.push(CalibratedCamera { name, model, frame, pose, unit });
    }
    Ok(cameras)
}

/// Returns whether a row describes a camera in COLMAP's `cameras.txt`.
pub(super) fn is_colmap(row: &str) -> bool {
    let mut words = row.split_whitespace();
    let is_number = words.next().is_some_and(|id| id.parse::<u32>().is_ok());
    let is_name = |name: &str| name.len() > 2 && name.chars().all(|c| c.is_ascii_uppercase() || c == '_');
    is_number && words.next().is_some_and(is_name)
}

/// Reads COLMAP's `cameras.txt`.
pub(super) fn colmap(text: &str) -> Result<Vec<CalibratedCamera>, String> {
    let camera = |(line, row): (usize, &str)| {
        let words: Vec<&str> = row.split_whitespace().collect();
        let [id, name, width, height, parameters @ ..] = &words[..] else {
            return Err(format!("line {line}: expected ID MODEL WIDTH HEIGHT PARAMETERS"));
        };
        let side = |word: &str| {
            word.parse::<usize>()
                .map_err(|_| format!("line {line}: {} is not a size in pixels", excerpt(word)))
        };
        let frame = Frame::new(side(width)?, side(height)?);
        let numbers = finite_numbers(&parameters.join(" ")).map_err(|e| format!("line {line}: {e}"))?;
        let model = CameraModel::from_colmap(name, &numbers).map_err(|e| format!("line {line}: {e}"))?;
        let name = (*id).to_owned();
        let unit = LengthUnit::Calibration;
        Ok(CalibratedCamera { name, model, frame: Some(frame), pose: None, unit })
    };
    rows(text).map(camera).collect()
}

/// Takes a projection matrix `K [R | t]` with `R = I` apart, as of rectified images.
fn pinhole(name: String, projection: &Matrix3x4<f64>) -> Result<CalibratedCamera, String> {
    let calibration: Matrix3<f64> = projection.fixed_columns::<3>(0).into();
    let model = CameraModel::new(&calibration, Lens::IDEAL).ok_or(IMPOSSIBLE)?;
    let inverse = calibration.try_inverse().ok_or(IMPOSSIBLE)?;
    let pose = CameraPose { rotation: Rotation3::identity(), translation: inverse * projection.column(3) };
    let (pose, unit) = (Some(pose), LengthUnit::Metre);
    Ok(CalibratedCamera { name, model, frame: None, pose, unit })
}
