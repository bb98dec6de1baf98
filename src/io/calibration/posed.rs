//! Poses of the cameras of a calibration.
//!
//! The first of these that the file has is taken: `R` and `T` of the pair, poses of each camera, and the
//! rectification of ROS and OpenCV: with `R1`, `R2` and `P2`, `R = R2ᵀ R1` and
//! `T = R2ᵀ (P2[0,3] / P2[0,0], 0, 0)`.

use nalgebra::{Matrix3, Matrix3x4, Rotation3, Vector3};

use super::CameraPose;
use super::fields::Field;
use super::names::{Direction, Role};
use super::rig::Rig;
use crate::foreign::excerpt;

/// Where poses come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PoseSource {
    /// `R` and `T` of the second camera relative to the first.
    Pair,
    /// A pose for each camera.
    Cameras,
    /// Rotations and projections of the rectified pair.
    Rectification,
}

/// Poses of all cameras.
pub(super) struct Poses {
    pub cameras: Vec<Option<CameraPose>>,
    pub source: Option<PoseSource>,
    pub notes: Vec<String>,
}

/// Returns the poses. MATLAB transposes rotations together with camera matrices.
pub(super) fn poses(rig: &Rig, is_transposed: bool) -> Result<Poses, String> {
    let count = rig.cameras.len();
    let mut notes = Vec::new();
    let turned = |pose: CameraPose| CameraPose { rotation: pose.rotation.inverse(), ..pose };
    if is_transposed && rig.fields.iter().any(|f| f.meaning.role == Role::Rotation && f.numbers().len() == 9)
    {
        notes.push("R is read as transposed too".to_owned());
    }
    let own = |camera: &[String]| -> Result<Option<CameraPose>, String> {
        let pose = rotation_and_translation(rig, camera)?;
        let is_of_rows = rig.field(camera, |role| role == Role::RotationOfRows)?.is_some();
        Ok(pose.map(|pose| if is_transposed && !is_of_rows { turned(pose) } else { pose }))
    };
    // The only camera may have a pose of its own.
    if count > 1 {
        let mut of_pair = match transform(rig, &[], true)? {
            Some(pose) => Some(pose),
            None if rig.cameras.contains(&Vec::new()) => None,
            None => own(&[])?,
        };
        for (word, is_inverse) in [("forward", false), ("backward", true)] {
            let found = own(&[word.to_owned()])?.map(|pose| if is_inverse { inverse(&pose) } else { pose });
            of_pair = match (of_pair, found) {
                (Some(_), Some(_)) => return Err("there are two poses of the pair".into()),
                (of_pair, found) => of_pair.or(found),
            };
        }
        if let Some(pose) = of_pair {
            if count > 2 {
                return Err("there is one R and T, but more than two cameras".into());
            }
            let poses = vec![Some(CameraPose::origin()), Some(pose)];
            return Ok(Poses { cameras: poses, source: Some(PoseSource::Pair), notes });
        }
    }
    let mut poses = Vec::new();
    for camera in &rig.cameras {
        poses.push(match own(camera)? {
            Some(pose) => Some(pose),
            None => transform(rig, camera, false)?,
        });
    }
    if poses.iter().any(Option::is_some) {
        if count == 2 && poses[0].is_none() {
            notes.push("only the second camera has a pose, which is taken as relative to the first".into());
            poses[0] = Some(CameraPose::origin());
        }
        return Ok(Poses { cameras: poses, source: Some(PoseSource::Cameras), notes });
    }
    let poses = rig.cameras.iter().map(|camera| rectified(rig, camera)).collect::<Result<Vec<_>, _>>()?;
    let known = poses.iter().flatten().count();
    if known > 0 && known < count {
        notes.push(
            "only one camera has the rotation and the projection of its rectification, so the pose is unknown"
                .into(),
        );
    }
    let source = (known == count).then_some(PoseSource::Rectification);
    Ok(Poses { cameras: poses, source, notes })
}

fn rotation_and_translation(rig: &Rig, camera: &[String]) -> Result<Option<CameraPose>, String> {
    let is_rotation = |role| matches!(role, Role::Rotation | Role::RotationOfRows);
    let translation = rig.field(camera, |role| role == Role::Translation)?;
    // Without a translation, `R1` is the rotation of a rectified camera.
    let Some(translation) = translation else { return Ok(None) };
    let Some(rotation) = rig.field(camera, is_rotation)? else { return Ok(None) };
    let named = |field: &Field, e: String| format!("{}: {e}", excerpt(&field.name()));
    let t = Vector3::from(Rig::exactly::<3>(translation)?);
    if let [x, y, z] = *rotation.numbers() {
        let rotation = Rotation3::from_scaled_axis(Vector3::new(x, y, z));
        return Ok(Some(CameraPose { rotation, translation: t }));
    }
    let matrix = Matrix3::from_row_slice(&Rig::exactly::<9>(rotation)?);
    let matrix = if rotation.meaning.role == Role::RotationOfRows { matrix.transpose() } else { matrix };
    CameraPose::new(&matrix, t).map(Some).map_err(|e| named(rotation, e))
}

/// Returns the pose of a matrix of rotation and translation, of a camera or of the pair.
fn transform(rig: &Rig, camera: &[String], is_of_pair: bool) -> Result<Option<CameraPose>, String> {
    let is_relative = |direction| match direction {
        Direction::SecondFromFirst | Direction::FirstFromSecond => true,
        // One `[R | t]` beside two cameras is the pose of the second.
        Direction::CameraFromWorld => is_of_pair,
        Direction::WorldFromCamera => false,
    };
    let is_wanted = |role| matches!(role, Role::Transform(direction) if is_relative(direction) == is_of_pair);
    let Some(field) = rig.field(camera, is_wanted)? else { return Ok(None) };
    let Role::Transform(direction) = field.meaning.role else { return Ok(None) };
    let told = |e: String| format!("{}: {e}", excerpt(&field.name()));
    let numbers = field.numbers();
    if numbers.len() < 12 {
        return Err(told(format!("expected 12 or 16 numbers, found {}", numbers.len())));
    }
    let last = &numbers[12..];
    if !last.is_empty() && last != [0.0, 0.0, 0.0, 1.0] {
        return Err(told("the last row is not 0 0 0 1".into()));
    }
    let matrix = Matrix3x4::from_row_slice(&numbers[..12]);
    let rotation: Matrix3<f64> = matrix.fixed_columns::<3>(0).into();
    let pose = CameraPose::new(&rotation, matrix.column(3).into()).map_err(told)?;
    Ok(Some(match direction {
        Direction::CameraFromWorld | Direction::SecondFromFirst => pose,
        Direction::WorldFromCamera | Direction::FirstFromSecond => inverse(&pose),
    }))
}

/// Returns the pose of a camera in the coordinates of the rectified pair: `x = Rᵀ (X + K⁻¹ p)` with the
/// projection `[K | p]`.
fn rectified(rig: &Rig, camera: &[String]) -> Result<Option<CameraPose>, String> {
    let is_rotation = |role| matches!(role, Role::Rectification | Role::Rotation);
    let projection = rig.field(camera, |role| role == Role::Projection)?;
    let (Some(rotation), Some(projection)) = (rig.field(camera, is_rotation)?, projection) else {
        return Ok(None);
    };
    if rotation.numbers().len() != 9 || projection.numbers().len() != 12 {
        return Ok(None);
    }
    let projection = Matrix3x4::from_row_slice(projection.numbers());
    let matrix: Matrix3<f64> = projection.fixed_columns::<3>(0).into();
    let Some(inverse) = matrix.try_inverse() else { return Ok(None) };
    let back = Matrix3::from_row_slice(rotation.numbers()).transpose();
    let pose = CameraPose::new(&back, back * (inverse * projection.column(3)));
    pose.map(Some).map_err(|e| format!("{}: {e}", excerpt(&rotation.name())))
}

fn inverse(pose: &CameraPose) -> CameraPose {
    let rotation = pose.rotation.inverse();
    CameraPose { rotation, translation: -(rotation * pose.translation) }
}

impl CameraPose {
    /// Returns the pose of the first camera of a pair.
    pub(super) fn origin() -> Self {
        Self { rotation: Rotation3::identity(), translation: Vector3::zeros() }
    }

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
