//! Factory calibrations of ZED cameras (`SN12345.conf`).
//!
//! Each picture size has a section for each camera. The rotation vector is `(RX, CV, RZ)`, and the right
//! camera stands at `+Baseline` on the x axis, so `T = −(Baseline, TY, TZ)`, mm. Source: Stereolabs'
//! `zed-opencv-native`, whose `T` has the other sign, which rectification does not notice.

use nalgebra::{Rotation3, Vector3};
use serde_json::{Map, Value};

use super::{CalibratedCamera, CameraPose, CameraReading};
use crate::camera::{CameraModel, IMPOSSIBLE, LengthUnit, Lens, calibration};
use crate::foreign::excerpt;
use crate::geometry::Frame;

/// Picture sizes by the end of the name of their section.
const SIZES: [(&str, [usize; 2]); 7] = [
    ("2K", [2208, 1242]),
    ("FHD", [1920, 1080]),
    ("FHD1200", [1920, 1200]),
    ("HD", [1280, 720]),
    ("VGA", [672, 376]),
    ("SVGA", [960, 600]),
    ("QHDPLUS", [3200, 1800]),
];
/// Names of a section that are read.
const KNOWN: [&str; 12] = ["fx", "fy", "cx", "cy", "k1", "k2", "k3", "p1", "p2", "k4", "k5", "k6"];

/// Returns whether a row opens the section of a camera.
pub(super) fn is_section(row: &str) -> bool {
    row.to_uppercase().starts_with("[LEFT_CAM_")
}

/// Returns the cameras of the first size in the file, with those of the other sizes.
pub(super) fn cameras(root: &Value) -> Result<Vec<CalibratedCamera>, String> {
    let sections = root.as_object().ok_or("there are no sections in it")?;
    let section = |name: &str| {
        sections.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).and_then(|(_, v)| v.as_object())
    };
    let mut pairs = Vec::new();
    for (size, [width, height]) in SIZES {
        let [left, right] = ["LEFT_CAM_", "RIGHT_CAM_"].map(|side| format!("{side}{size}"));
        let (left_section, right_section) = match (section(&left), section(&right)) {
            (Some(left), Some(right)) => (left, right),
            (None, None) => continue,
            (Some(_), None) => return Err(format!("there is {left}, but no {right}")),
            (None, Some(_)) => return Err(format!("there is {right}, but no {left}")),
        };
        let pose = pose(section("STEREO").ok_or("there is no section STEREO with the pose")?, size)?;
        let frame = Frame::new(width, height);
        pairs.push([
            camera(left, left_section, frame, CameraPose::origin())?,
            camera(right, right_section, frame, pose)?,
        ]);
    }
    let known = |name: &str| {
        let name = name.to_uppercase();
        let size = name.strip_prefix("LEFT_CAM_").or(name.strip_prefix("RIGHT_CAM_"));
        size.is_none_or(|size| SIZES.iter().any(|(known, _)| *known == size))
    };
    if let Some(other) = sections.keys().find(|name| !known(name)) {
        return Err(format!("the picture size of the section {} is not known", excerpt(other)));
    }
    let mut pairs = pairs.into_iter();
    let [mut left, mut right] =
        pairs.next().ok_or("there is no section LEFT_CAM_2K, LEFT_CAM_HD or the like")?;
    for [other_left, other_right] in pairs {
        left.reading.other_sizes.push(other_left);
        right.reading.other_sizes.push(other_right);
    }
    Ok(vec![left, right])
}

fn number(section: &Map<String, Value>, name: &str) -> Option<f64> {
    section.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).and_then(|(_, v)| v.as_f64())
}

fn camera(
    name: String,
    section: &Map<String, Value>,
    frame: Frame,
    pose: CameraPose,
) -> Result<CalibratedCamera, String> {
    let need = |key: &str| number(section, key).ok_or_else(|| format!("{name}: {key} is missing"));
    let mut coefficients = vec![need("k1")?, need("k2")?, need("p1")?, need("p2")?, need("k3")?];
    if number(section, "k4").is_some() {
        coefficients.extend([need("k4")?, need("k5")?, need("k6")?]);
    }
    let matrix = calibration([need("fx")?, need("fy")?], [need("cx")?, need("cy")?]);
    let model = CameraModel::new(&matrix, Lens::from_opencv(&coefficients)?).ok_or(IMPOSSIBLE)?;
    let is_known = |key: &String| KNOWN.iter().any(|known| known.eq_ignore_ascii_case(key));
    let unread = section.iter().filter(|(key, value)| !is_known(key) && value.is_number());
    let unread = unread.map(|(key, _)| format!("{name}.{key}")).collect();
    let reading = CameraReading { unread, ..CameraReading::default() };
    Ok(CalibratedCamera {
        name,
        model,
        frame: Some(frame),
        pose: Some(pose),
        unit: LengthUnit::Millimetre,
        reading,
    })
}

fn pose(stereo: &Map<String, Value>, size: &str) -> Result<CameraPose, String> {
    let need = |key: &str| number(stereo, key).ok_or_else(|| format!("STEREO: {key} is missing"));
    let of_size = |key: &str| {
        let named = format!("{key}_{size}");
        number(stereo, &named).or(number(stereo, key)).ok_or_else(|| format!("STEREO: {named} is missing"))
    };
    let rotation = Vector3::new(of_size("RX")?, of_size("CV")?, of_size("RZ")?);
    let translation = -Vector3::new(need("Baseline")?, of_size("TY")?, of_size("TZ")?);
    Ok(CameraPose { rotation: Rotation3::from_scaled_axis(rotation), translation })
}
