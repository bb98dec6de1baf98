//! Calibrations in trees of named values: OpenCV, ROS, Kalibr, caliscope, anipose.

use nalgebra::{Matrix3, Matrix4, Rotation3, Vector3};
use serde_json::{Map, Value};

use super::super::number::finite_number;
use super::{CalibratedCamera, CameraPose};
use crate::camera::{CameraModel, IMPOSSIBLE, LengthUnit, Lens, calibration};
use crate::foreign::excerpt;
use crate::geometry::Frame;

type Object = Map<String, Value>;

/// Names of a calibration matrix. `#` stands for the number of the camera, or for nothing.
const MATRIX: [&str; 9] =
    ["K#", "M#", "cameraMatrix#", "camera_matrix#", "camera_matrix_#", "intrinsic#", "matrix", "K_#", "mtx#"];
/// Names of distortion coefficients.
const COEFFICIENTS: [&str; 9] = [
    "D#",
    "distCoeffs#",
    "dist_coeffs#",
    "distortion_coefficients#",
    "distortion_coefficients",
    "distortion#",
    "distortions",
    "D_#",
    "dist#",
];
const ROTATION: [&str; 2] = ["R", "rotation"];
const TRANSLATION: [&str; 3] = ["T", "translation", "t"];

pub(super) fn cameras(root: &Value) -> Result<Vec<CalibratedCamera>, String> {
    let root = root.as_object().ok_or("there are no named values in it")?;
    // The section of caliscope holds the cameras by number.
    let root = root.get("cameras").and_then(Value::as_object).unwrap_or(root);
    if let Some(kalibr) = kalibr(root)? {
        return Ok(kalibr);
    }
    if let Some(stereo) = stereo(root)? {
        return Ok(stereo);
    }
    if let Some(camera) = single("camera", root)? {
        return Ok(vec![camera]);
    }
    let mut found = Vec::new();
    for (name, value) in root {
        if let Some(object) = value.as_object() {
            let name = object.get("name").and_then(Value::as_str).unwrap_or(name);
            found.extend(single(name, object)?);
        }
    }
    if found.is_empty() {
        let expected = "K1, D1, K2, D2 of OpenCV, cam0 of Kalibr, or sections with matrix and distortions";
        return Err(format!("no camera calibration found. Known names are {expected}"));
    }
    Ok(found)
}

/// Reads a stereo calibration of OpenCV: camera 1 at the origin, camera 2 at `R`, `T`.
fn stereo(root: &Object) -> Result<Option<Vec<CalibratedCamera>>, String> {
    let (Some(_), Some(_)) = (field(root, &MATRIX, "1"), field(root, &MATRIX, "2")) else { return Ok(None) };
    let pose2 = pose(root)?;
    let origin = CameraPose { rotation: Rotation3::identity(), translation: Vector3::zeros() };
    let poses = [pose2.map(|_| origin), pose2];
    let mut cameras = Vec::new();
    for (number, pose) in ["1", "2"].into_iter().zip(poses) {
        if let Some(camera) = camera(&format!("camera {number}"), root, number)? {
            cameras.push(CalibratedCamera { pose, ..camera });
        }
    }
    Ok(Some(cameras))
}

/// Reads one camera without a number, with its pose if there is any.
fn single(name: &str, object: &Object) -> Result<Option<CalibratedCamera>, String> {
    let Some(camera) = camera(name, object, "")? else { return Ok(None) };
    Ok(Some(CalibratedCamera { pose: pose(object)?, ..camera }))
}

fn camera(name: &str, object: &Object, number: &str) -> Result<Option<CalibratedCamera>, String> {
    let told = |e: String| format!("{}: {e}", excerpt(name));
    let Some(value) = field(object, &MATRIX, number) else { return Ok(None) };
    let matrix = exactly::<9>(value).map_err(told)?;
    let coefficients = field(object, &COEFFICIENTS, number).map(numbers).transpose().map_err(told)?;
    let coefficients = coefficients.unwrap_or_default();
    let lens = if is_fisheye(object) { fisheye(&coefficients) } else { Lens::from_opencv(&coefficients) };
    let model = CameraModel::new(&Matrix3::from_row_slice(&matrix), lens.map_err(told)?);
    let model = model.ok_or_else(|| told(IMPOSSIBLE.into()))?;
    let (name, frame) = (name.to_owned(), frame(object));
    let unit = LengthUnit::Calibration;
    Ok(Some(CalibratedCamera { name, model, frame, pose: None, unit }))
}

fn is_fisheye(object: &Object) -> bool {
    let is_set = |value: &Value| match value {
        Value::Bool(set) => *set,
        Value::Number(number) => number.as_f64() == Some(1.0),
        Value::String(word) => ["1", "true", "yes"].contains(&word.as_str()),
        _ => false,
    };
    let model = object.get("distortion_model").and_then(Value::as_str);
    object.get("fisheye").is_some_and(is_set)
        || model.is_some_and(|m| ["equidistant", "fisheye"].contains(&m))
}

fn fisheye(coefficients: &[f64]) -> Result<Lens, String> {
    if coefficients.len() > 4 && coefficients[4..].iter().any(|k| *k != 0.0) {
        return Err(format!("a fisheye lens has 4 coefficients, found {}", coefficients.len()));
    }
    Ok(Lens::equidistant(coefficients))
}

/// Returns the size of the images.
fn frame(object: &Object) -> Option<Frame> {
    let list = ["size", "resolution", "imageSize", "image_size"].iter().find_map(|name| object.get(*name));
    if let Some(Ok([width, height])) = list.map(exactly::<2>) {
        return Some(Frame::new(width as usize, height as usize));
    }
    let side = |names: [&str; 2]| names.iter().find_map(|name| object.get(*name)?.as_f64());
    match (side(["image_width", "width"]), side(["image_height", "height"])) {
        (Some(width), Some(height)) => Some(Frame::new(width as usize, height as usize)),
        _ => None,
    }
}

/// Returns the pose. The rotation is a matrix or a rotation vector.
fn pose(object: &Object) -> Result<Option<CameraPose>, String> {
    let (Some(rotation), Some(translation)) = (field(object, &ROTATION, ""), field(object, &TRANSLATION, ""))
    else {
        return Ok(None);
    };
    let told = |name: &'static str| move |e: String| format!("{name}: {e}");
    let translation = Vector3::from(exactly::<3>(translation).map_err(told("translation"))?);
    let numbers = numbers(rotation).map_err(told("rotation"))?;
    if let [x, y, z] = numbers[..] {
        let rotation = Rotation3::from_scaled_axis(Vector3::new(x, y, z));
        return Ok(Some(CameraPose { rotation, translation }));
    }
    let rotation = Matrix3::from_row_slice(&exactly::<9>(rotation).map_err(told("rotation"))?);
    CameraPose::new(&rotation, translation).map(Some)
}

/// Reads a camera chain of Kalibr: `cam0`, `cam1`, …
fn kalibr(root: &Object) -> Result<Option<Vec<CalibratedCamera>>, String> {
    let entry = |k: usize| root.get(&format!("cam{k}")).and_then(Value::as_object);
    if entry(0).is_none_or(|camera| !camera.contains_key("intrinsics")) {
        return Ok(None);
    }
    let mut cameras = Vec::new();
    let mut from_first = Some(Matrix4::identity());
    for k in 0.. {
        let Some(object) = entry(k) else { break };
        let name = format!("cam{k}");
        let told = |e: String| format!("{name}: {e}");
        let model = kalibr_model(object).map_err(told)?;
        let matrix = |name: &str| -> Result<Option<Matrix4<f64>>, String> {
            let Some(value) = object.get(name) else { return Ok(None) };
            let numbers = exactly::<16>(value).map_err(|e| format!("{name}: {e}"))?;
            Ok(Some(Matrix4::from_row_slice(&numbers)))
        };
        // From the camera before, or through the inertial unit.
        let chain = matrix("T_cn_cnm1").map_err(told)?;
        let imu = matrix("T_cam_imu").map_err(told)?;
        let to_imu = matrix("T_imu_cam").map_err(told)?.and_then(Matrix4::try_inverse);
        from_first = match (chain, from_first) {
            (Some(step), Some(before)) if k > 0 => Some(step * before),
            (None, _) if k > 0 => None,
            (_, before) => before,
        };
        let pose = from_first.filter(|_| k > 0 || chain_follows(root)).or(imu).or(to_imu);
        let pose = pose
            .map(|m| {
                let rotation: Matrix3<f64> = m.fixed_view::<3, 3>(0, 0).into();
                CameraPose::new(&rotation, m.fixed_view::<3, 1>(0, 3).into()).map_err(told)
            })
            .transpose()?;
        let frame = frame(object);
        let unit = LengthUnit::Metre;
        cameras.push(CalibratedCamera { name, model, frame, pose, unit });
    }
    Ok(Some(cameras))
}

/// Returns whether the second camera of a chain is placed relative to the first.
fn chain_follows(root: &Object) -> bool {
    root.get("cam1").is_some_and(|camera| camera.get("T_cn_cnm1").is_some())
}

fn kalibr_model(object: &Object) -> Result<CameraModel, String> {
    let word = |name: &str| object.get(name).and_then(Value::as_str).unwrap_or("");
    let model = word("camera_model");
    if !matches!(model, "pinhole" | "") {
        return Err(format!("the camera model {} is not supported, only pinhole", excerpt(model)));
    }
    let [fx, fy, cx, cy] = exactly::<4>(object.get("intrinsics").unwrap_or(&Value::Null))?;
    let coefficients = object.get("distortion_coeffs").map(numbers).transpose()?.unwrap_or_default();
    let lens = match word("distortion_model") {
        "radtan" | "plumb_bob" => Lens::from_opencv(&coefficients)?,
        "equidistant" => fisheye(&coefficients)?,
        "fov" => match coefficients[..] {
            [omega] => Lens::perspective(crate::camera::Radial::FieldOfView { omega }),
            _ => return Err("the distortion model fov has one coefficient".into()),
        },
        "none" | "" if coefficients.iter().all(|k| *k == 0.0) => Lens::IDEAL,
        other => return Err(format!("the distortion model {} is not supported", excerpt(other))),
    };
    CameraModel::new(&calibration([fx, fy], [cx, cy]), lens).ok_or_else(|| IMPOSSIBLE.into())
}

impl CameraPose {
    /// Creates a pose from a matrix that is a rotation up to rounding.
    pub(super) fn new(rotation: &Matrix3<f64>, translation: Vector3<f64>) -> Result<Self, String> {
        let off = (rotation * rotation.transpose() - Matrix3::identity()).norm();
        let is_finite = translation.iter().all(|v| v.is_finite());
        if off > 1e-3 || rotation.determinant() < 0.0 || !off.is_finite() || !is_finite {
            return Err("the rotation of the pose is not a rotation matrix".into());
        }
        let rotation = Rotation3::from_matrix_eps(rotation, 1e-14, 100, Rotation3::identity());
        Ok(Self { rotation, translation })
    }
}

/// Returns the first named value; `#` in a name is replaced by `number`.
fn field<'a>(object: &'a Object, names: &[&str], number: &str) -> Option<&'a Value> {
    names.iter().find_map(|name| object.get(&name.replace('#', number)))
}

/// Reads a list of a known number of numbers.
fn exactly<const N: usize>(value: &Value) -> Result<[f64; N], String> {
    let numbers = numbers(value)?;
    let found = numbers.len();
    numbers.try_into().map_err(|_| format!("expected {N} numbers, found {found}"))
}

/// Returns all numbers of nested lists, or of a matrix of OpenCV or ROS.
fn numbers(value: &Value) -> Result<Vec<f64>, String> {
    match value {
        Value::Array(items) => Ok(items.iter().map(numbers).collect::<Result<Vec<_>, _>>()?.concat()),
        Value::Object(matrix) => match matrix.get("data") {
            Some(data) => numbers(data),
            None => Err("expected numbers".into()),
        },
        Value::Number(number) => Ok(vec![number.as_f64().unwrap_or(f64::NAN)]),
        Value::String(word) => Ok(vec![finite_number(word)?]),
        Value::Null => Ok(Vec::new()),
        Value::Bool(_) => Err("expected numbers".into()),
    }
}
