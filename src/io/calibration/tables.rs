//! Calibrations in lines of text: KITTI, Middlebury, COLMAP.

use nalgebra::{Matrix3, Matrix3x4, Rotation3, Vector3};

use super::super::number::{finite_numbers, rows};
use super::{CalibratedCamera, CameraPose, CameraReading};
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
    let exact = |name: String, count: usize| -> Result<Option<Vec<f64>>, String> {
        match entry(&name)? {
            Some(numbers) if numbers.len() != count => {
                Err(format!("{name}: expected {count} numbers, found {}", numbers.len()))
            }
            other => Ok(other),
        }
    };
    let missing = |name: String, of: &str| format!("there is {of}, but no {name}");
    let mut cameras: Vec<CalibratedCamera> = Vec::new();
    for k in 0..100 {
        let of_raw = format!("K_{k:02}");
        if let Some(matrix) = exact(of_raw.clone(), 9)? {
            let coefficients = exact(format!("D_{k:02}"), 5)?;
            let lens =
                Lens::from_opencv(&coefficients.ok_or_else(|| missing(format!("D_{k:02}"), &of_raw))?)?;
            let size = exact(format!("S_{k:02}"), 2)?;
            let pose = match (exact(format!("R_{k:02}"), 9)?, exact(format!("T_{k:02}"), 3)?) {
                (Some(r), Some(t)) => {
                    Some(CameraPose::new(&Matrix3::from_row_slice(&r), Vector3::from_column_slice(&t))?)
                }
                (None, None) => None,
                _ => return Err(format!("R_{k:02} and T_{k:02} must both be given")),
            };
            let model = CameraModel::new(&Matrix3::from_row_slice(&matrix), lens).ok_or(IMPOSSIBLE)?;
            let frame = size.map(|size| Frame::new(size[0] as usize, size[1] as usize));
            let name = format!("{k:02}");
            let unit = LengthUnit::Metre;
            let reading = CameraReading::default();
            cameras.push(CalibratedCamera { name, model, frame, pose, unit, reading });
        } else if entry(&format!("D_{k:02}"))?.is_some() {
            return Err(missing(of_raw, &format!("D_{k:02}")));
        } else if let Some(projection) = exact(format!("P{k}"), 12)? {
            // Cameras are numbered without gaps, so a gap is a name that is not known.
            if cameras.len() != k {
                return Err(missing(format!("P{}", cameras.len()), &format!("P{k}")));
            }
            cameras.push(pinhole(format!("P{k}"), &Matrix3x4::from_row_slice(&projection))?);
        }
    }
    let is_known = |name: &str| {
        let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let own = ["S_", "K_", "D_", "R_", "T_", "S_rect_", "R_rect_", "P_rect_", "P", "R0_rect", "R_rect"];
        own.contains(&letters)
            || name.starts_with("Tr")
            || ["calib_time", "corner_dist", "R0_rect"].contains(&name)
    };
    let unread = unread(text, ':', is_known);
    match cameras.first_mut() {
        Some(first) => first.reading.unread = unread,
        None => return Err("there is no camera with K or P in it".into()),
    }
    Ok(cameras)
}

/// Returns the names of rows with numbers that are not known.
fn unread(text: &str, separator: char, is_known: impl Fn(&str) -> bool) -> Vec<String> {
    let name = |(_, row): (usize, &str)| {
        let (name, value) = row.split_once(separator)?;
        let plain = value.replace(['[', ']'], " ");
        let has_numbers = finite_numbers(&plain).is_ok_and(|numbers| !numbers.is_empty());
        (has_numbers && !is_known(name.trim())).then(|| name.trim().to_owned())
    };
    rows(text).filter_map(name).collect()
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
    let is_known = |name: &str| MIDDLEBURY.contains(&name);
    let known = number("baseline")?;
    let unit = if known.is_some() { LengthUnit::Millimetre } else { LengthUnit::Baseline };
    let baseline = known.unwrap_or(1.0);
    let unread = unread(text, '=', is_known);
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
        let reading = CameraReading { unread: unread.clone(), ..CameraReading::default() };
        cameras.push(CalibratedCamera { name, model, frame, pose, unit, reading });
    }
    Ok(cameras)
}

/// Names of Middlebury's calibrations.
const MIDDLEBURY: [&str; 12] = [
    "cam0", "cam1", "doffs", "baseline", "width", "height", "ndisp", "isint", "vmin", "vmax", "dyavg",
    "dymax",
];

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
        let reading = CameraReading::default();
        Ok(CalibratedCamera { name, model, frame: Some(frame), pose: None, unit, reading })
    };
    let mut cameras: Vec<CalibratedCamera> = rows(text).map(camera).collect::<Result<_, _>>()?;
    // The order of the rows has no meaning.
    cameras.sort_by_key(|camera| camera.name.parse::<u32>().unwrap_or(u32::MAX));
    Ok(cameras)
}

/// Takes a projection matrix `K [R | t]` with `R = I` apart, as of rectified images.
fn pinhole(name: String, projection: &Matrix3x4<f64>) -> Result<CalibratedCamera, String> {
    let calibration: Matrix3<f64> = projection.fixed_columns::<3>(0).into();
    let model = CameraModel::new(&calibration, Lens::IDEAL).ok_or(IMPOSSIBLE)?;
    let inverse = calibration.try_inverse().ok_or(IMPOSSIBLE)?;
    let pose = CameraPose { rotation: Rotation3::identity(), translation: inverse * projection.column(3) };
    let (pose, unit) = (Some(pose), LengthUnit::Metre);
    Ok(CalibratedCamera { name, model, frame: None, pose, unit, reading: CameraReading::default() })
}
