//! Camera chains of Kalibr: `cam0`, `cam1`, …

use nalgebra::{Matrix3, Matrix4};
use serde_json::{Map, Value};

use super::fields::{Content, fields};
use super::lens::fisheye;
use super::names::Role;
use super::{CalibratedCamera, CameraPose, CameraReading};
use crate::camera::{CameraModel, IMPOSSIBLE, LengthUnit, Lens, Radial, calibration};
use crate::foreign::excerpt;
use crate::geometry::Frame;

type Object = Map<String, Value>;

/// Names that Kalibr writes.
const KNOWN: [&str; 11] = [
    "camera_model",
    "intrinsics",
    "distortion_model",
    "distortion_coeffs",
    "resolution",
    "T_cn_cnm1",
    "T_cam_imu",
    "T_imu_cam",
    "cam_overlaps",
    "rostopic",
    "timeshift_cam_imu",
];

/// Reads a camera chain. `None` for another file.
pub(super) fn kalibr(root: &Value) -> Result<Option<Vec<CalibratedCamera>>, String> {
    let Some(root) = root.as_object() else { return Ok(None) };
    let entry = |k: usize| root.get(&format!("cam{k}")).and_then(Value::as_object);
    // Lists of four numbers and the names of models: `cam0: { K: … }` is another file.
    let is_chain = |camera: &Object| camera.contains_key("intrinsics") && camera.contains_key("camera_model");
    if !entry(0).is_some_and(is_chain) {
        return Ok(None);
    }
    let mut cameras = Vec::new();
    let mut from_first = Some(Matrix4::identity());
    for k in 0.. {
        let Some(object) = entry(k) else { break };
        let name = format!("cam{k}");
        let told = |e: String| format!("{name}: {e}");
        let model = model(object).map_err(told)?;
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
        let size = object.get("resolution").map(exactly::<2>).transpose().map_err(told)?;
        cameras.push(CalibratedCamera {
            frame: size.map(|[width, height]| Frame::new(width as usize, height as usize)),
            reading: CameraReading { unread: unread(&name, object), ..CameraReading::default() },
            unit: LengthUnit::Metre,
            name,
            model,
            pose,
        });
    }
    // Another section with a camera is one that the chain misses.
    let is_chained = |name: &String| cameras.iter().any(|camera| camera.name == *name);
    let others: Object =
        root.iter().filter(|(name, _)| !is_chained(name)).map(|(n, v)| (n.clone(), v.clone())).collect();
    let others = fields(&Value::Object(others));
    if let Some(field) = others.iter().find(|field| field.meaning.role == Role::Matrix) {
        return Err(format!("{} belongs to no camera of the chain cam0, cam1, …", excerpt(&field.name())));
    }
    let others = others.iter().filter(|f| f.meaning.role == Role::Unknown && f.numbers().len() > 1);
    let others: Vec<String> = others.map(super::fields::Field::name).collect();
    if let Some(first) = cameras.first_mut() {
        first.reading.unread.extend(others);
    }
    Ok(Some(cameras))
}

/// Returns the names of numbers that Kalibr does not write.
fn unread(camera: &str, object: &Object) -> Vec<String> {
    let others: Object = object
        .iter()
        .filter(|(name, _)| !KNOWN.contains(&name.as_str()))
        .map(|(n, v)| (n.clone(), v.clone()))
        .collect();
    let fields = fields(&Value::Object(others));
    let fields = fields.iter().filter(|f| f.meaning.role != Role::Harmless && !f.numbers().is_empty());
    fields.map(|field| format!("{camera}.{}", field.name())).collect()
}

/// Returns whether the second camera of a chain is placed relative to the first.
fn chain_follows(root: &Object) -> bool {
    root.get("cam1").is_some_and(|camera| camera.get("T_cn_cnm1").is_some())
}

fn model(object: &Object) -> Result<CameraModel, String> {
    let word = |name: &str| object.get(name).and_then(Value::as_str).unwrap_or("");
    let model = word("camera_model");
    if model != "pinhole" {
        return Err(format!("the camera model {} is not supported, only pinhole", excerpt(model)));
    }
    let [fx, fy, cx, cy] = exactly::<4>(object.get("intrinsics").unwrap_or(&Value::Null))?;
    let coefficients = object.get("distortion_coeffs").map(numbers).transpose()?;
    let Some(coefficients) = coefficients else {
        return Err("distortion_coeffs is missing".into());
    };
    let lens = match word("distortion_model") {
        "radtan" | "plumb_bob" | "radial-tangential" => Lens::from_opencv(&coefficients)?,
        "equidistant" => fisheye(&coefficients)?,
        "fov" => match coefficients[..] {
            [omega] => Lens::perspective(Radial::FieldOfView { omega }),
            _ => return Err("the distortion model fov has one coefficient".into()),
        },
        "none" | "" if coefficients.iter().all(|k| *k == 0.0) => Lens::IDEAL,
        other => return Err(format!("the distortion model {} is not supported", excerpt(other))),
    };
    CameraModel::new(&calibration([fx, fy], [cx, cy]), lens).ok_or_else(|| IMPOSSIBLE.into())
}

fn exactly<const N: usize>(value: &Value) -> Result<[f64; N], String> {
    let numbers = numbers(value)?;
    let found = numbers.len();
    numbers.try_into().map_err(|_| format!("expected {N} numbers, found {found}"))
}

/// Returns all numbers of nested lists, or of a matrix of OpenCV.
fn numbers(value: &Value) -> Result<Vec<f64>, String> {
    let wrapped = Value::Object(Object::from_iter([("data".to_owned(), value.clone())]));
    match fields(&wrapped).into_iter().next().map(|field| field.content) {
        Some(Content::List(numbers)) => Ok(numbers),
        Some(Content::Broken(problem)) => Err(problem),
        _ => Err("expected numbers".into()),
    }
}
