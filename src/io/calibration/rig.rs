//! Cameras of a calibration from its named numbers.
//!
//! Numbers of the same role and camera must agree. A camera without a distortion beside numbers that may be
//! one is refused, as are numbers that miss their partner: `k2` without `k1`, `R` without `T`.

use nalgebra::Matrix3;
use serde_json::Value;

use super::fields::{Content, Field, fields};
use super::lens::{Model, is_setting, lens_of, model_of};
use super::names::{Direction, Role, Scalar};
use super::posed::{PoseSource, poses};
use super::{CalibratedCamera, CameraReading, NoCalibration};
use crate::camera::{CameraModel, IMPOSSIBLE, LengthUnit, Lens, calibration};
use crate::foreign::excerpt;
use crate::geometry::Frame;

/// Fields of a file, and the cameras that they name.
pub(super) struct Rig {
    pub fields: Vec<Field>,
    /// Words of each camera, left before right and numbers in order.
    pub cameras: Vec<Vec<String>>,
}

/// Calibration matrix of a camera.
struct Matrix {
    entries: Matrix3<f64>,
    /// Sections of the matrix.
    section: Vec<String>,
    /// Whether the file has the transpose, as MATLAB writes it.
    is_transposed: bool,
}

/// Numbers that differ by less are written with fewer digits: relative.
const SAME: f64 = 1e-6;

/// Returns the cameras of a tree of named numbers.
pub(super) fn cameras(root: &Value) -> Result<Vec<CalibratedCamera>, NoCalibration> {
    let mut rig = Rig { fields: fields(root), cameras: Vec::new() };
    rig.drop_rectified();
    rig.cameras = rig.named_cameras();
    if rig.cameras.is_empty() {
        let unknown = rig.unread(None);
        let unknown = if unknown.is_empty() {
            String::new()
        } else {
            format!(". Not understood: {}", listed(&unknown))
        };
        let expected = "K1, D1, K2, D2 of OpenCV, camera_matrix and dist_coeffs, or cam0 of Kalibr";
        return Err(NoCalibration::NoCamera(format!(
            "no camera calibration found. Known names are {expected}{unknown}"
        )));
    }
    rig.read().map_err(NoCalibration::Wrong)
}

/// Returns the place of a camera by its side or number.
fn rank(camera: &[String]) -> Option<u32> {
    camera.iter().find_map(|word| match word.as_str() {
        "left" => Some(0),
        "right" => Some(1),
        word => word.parse().ok(),
    })
}

/// Joins names, of which there may be many.
pub(super) fn listed(names: &[String]) -> String {
    const MOST: usize = 6;
    let mut shown: Vec<String> = names.iter().take(MOST).map(|name| excerpt(name)).collect();
    if names.len() > MOST {
        shown.push(format!("{} more", names.len() - MOST));
    }
    shown.join(", ")
}

impl Rig {
    fn read(&self) -> Result<Vec<CalibratedCamera>, String> {
        let is_matlab = self.fields.iter().any(|f| matches!(f.meaning.role, Role::Radial));
        let mut found = Vec::new();
        let mut any_transposed = false;
        let mut models = Vec::new();
        for camera in &self.cameras {
            let told = |e: String| format!("{}: {e}", excerpt(&self.name(camera)));
            let matrix = self.matrix(camera).map_err(told)?;
            any_transposed |= matrix.is_transposed;
            models.push((matrix, model_of(self, camera).map_err(told)?));
        }
        let poses = poses(self, any_transposed)?;
        let mut has_lens = Vec::new();
        for ((camera, (matrix, model)), posed) in self.cameras.iter().zip(models).zip(poses.cameras) {
            let name = self.name(camera);
            let told = |e: String| format!("{}: {e}", excerpt(&name));
            let lens = lens_of(self, camera, model).map_err(told)?;
            if !lens.is_given && model != Some(Model::Ideal) {
                self.refuse_hidden_lens(camera, &name, &matrix.section)?;
            }
            has_lens.push(lens.is_given || model == Some(Model::Ideal));
            let mut k = matrix.entries;
            let counts_from_one = is_matlab || matrix.is_transposed;
            if counts_from_one {
                k[(0, 2)] -= 1.0;
                k[(1, 2)] -= 1.0;
            }
            let model_with = |lens: Lens| CameraModel::new(&k, lens).ok_or_else(|| told(IMPOSSIBLE.into()));
            let mut notes = poses.notes.clone();
            notes.extend(lens.note);
            if matrix.is_transposed {
                notes.push("the camera matrix is transposed, as MATLAB writes it".into());
            }
            if counts_from_one {
                notes
                    .push("MATLAB counts pixels from 1, so the principal point is moved by one pixel".into());
            }
            found.push(CalibratedCamera {
                model: model_with(lens.lens)?,
                frame: self.frame(camera, is_matlab).map_err(told)?,
                pose: posed,
                unit: LengthUnit::Calibration,
                reading: CameraReading {
                    unread: self.unread(Some((camera, &matrix.section))),
                    notes,
                    fisheye: lens.fisheye.map(model_with).transpose()?,
                    is_unplaced: self.is_unplaced(camera),
                    ..CameraReading::default()
                },
                name,
            });
        }
        if let Some(without) = has_lens.iter().position(|has| !has)
            && has_lens.contains(&true)
        {
            return Err(format!(
                "{} has no distortion, and another camera of the file has one",
                excerpt(&found[without].name)
            ));
        }
        self.refuse_orphans(poses.source)?;
        Ok(found)
    }

    /// Returns the only field of a role that belongs to a camera.
    ///
    /// # Errors
    /// A clause for the user, if fields of the role differ or cannot be read.
    pub fn field(&self, camera: &[String], is_role: impl Fn(Role) -> bool) -> Result<Option<&Field>, String> {
        let is_wanted = |f: &&Field| is_role(f.meaning.role) && f.meaning.camera == camera;
        // `distortion: plumb_bob` names a model, but `fx` must be a number.
        let has_content =
            |f: &&Field| !matches!(f.content, Content::Word(_)) || matches!(f.meaning.role, Role::Scalar(_));
        let mut fields = self.fields.iter().filter(is_wanted).filter(has_content);
        let Some(first) = fields.next() else { return Ok(None) };
        let is_same = |other: &Field| {
            let [a, b] = [first.numbers(), other.numbers()];
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * (a.abs() + b.abs()))
        };
        if let Some(other) = fields.find(|other| !is_same(other)) {
            return Err(format!("{} and {} differ", excerpt(&first.name()), excerpt(&other.name())));
        }
        match &first.content {
            Content::Broken(problem) => Err(format!("{}: {problem}", excerpt(&first.name()))),
            Content::Word(_) => Err(format!("{}: expected a number", excerpt(&first.name()))),
            _ if first.numbers().iter().all(|v| v.is_finite()) => Ok(Some(first)),
            _ => Err(format!("{}: a number is not finite", excerpt(&first.name()))),
        }
    }

    /// Returns a scalar of a camera.
    pub fn scalar(&self, camera: &[String], scalar: Scalar) -> Result<Option<f64>, String> {
        let field = self.field(camera, |role| role == Role::Scalar(scalar))?;
        Ok(field.and_then(|field| field.numbers().first().copied()))
    }

    /// Returns exactly `N` numbers of a field.
    pub fn exactly<const N: usize>(field: &Field) -> Result<[f64; N], String> {
        let numbers = field.numbers();
        numbers
            .try_into()
            .map_err(|_| format!("{}: expected {N} numbers, found {}", excerpt(&field.name()), numbers.len()))
    }

    /// Takes out the numbers of the rectified pair that stand beside two cameras: ORB-SLAM's `Camera.fx`
    /// beside `LEFT.K` and `RIGHT.K`.
    fn drop_rectified(&mut self) {
        let named = |f: &Field| f.meaning.role == Role::Matrix && !f.meaning.camera.is_empty();
        if self.fields.iter().filter(|f| named(f)).count() < 2 {
            return;
        }
        let is_number = |role| {
            use Scalar::{Focal, FocalX, FocalY, K, P, PrincipalX, PrincipalY};
            matches!(role, Role::Scalar(Focal | FocalX | FocalY | PrincipalX | PrincipalY | K(_) | P(_)))
        };
        for field in &mut self.fields {
            if field.meaning.camera.is_empty() && is_number(field.meaning.role) {
                field.meaning.role = Role::Harmless;
            }
        }
    }

    /// Returns the words of all cameras that have a matrix or focal lengths.
    fn named_cameras(&self) -> Vec<Vec<String>> {
        let mut cameras: Vec<Vec<String>> = Vec::new();
        for field in &self.fields {
            let is_camera = matches!(
                field.meaning.role,
                Role::Matrix
                    | Role::FocalLengths
                    | Role::Scalar(Scalar::Focal | Scalar::FocalX | Scalar::FocalY | Scalar::Foreign)
            );
            if is_camera && !cameras.contains(&field.meaning.camera) {
                cameras.push(field.meaning.camera.clone());
            }
        }
        cameras.sort_by_key(|camera| rank(camera).unwrap_or(u32::MAX));
        cameras
    }

    /// Returns whether a camera of several has no place, or that of another.
    fn is_unplaced(&self, camera: &[String]) -> bool {
        let own = rank(camera);
        let others = self.cameras.iter().filter(|other| *other != camera);
        self.cameras.len() > 1 && (own.is_none() || others.clone().any(|other| rank(other) == own))
    }

    /// Returns the name of a camera for people: that of its section, or `camera 1`.
    fn name(&self, camera: &[String]) -> String {
        let is_own = |f: &&Field| {
            f.meaning.camera == camera
                && matches!(f.meaning.role, Role::Matrix | Role::Scalar(Scalar::FocalX))
        };
        let own = self.fields.iter().find(is_own);
        let sections = own.map_or(&[][..], Field::section);
        let named = self.fields.iter().find_map(|f| {
            let is_name = ["name", "camera_name"].contains(&f.path.last()?.as_str());
            match &f.content {
                Content::Word(name) if is_name && own.is_some() && f.section() == sections => {
                    Some(name.clone())
                }
                _ => None,
            }
        });
        let is_flat = sections.iter().all(|section| section == "camera" || section == "Camera");
        match (named, camera) {
            (Some(name), _) => name,
            (None, []) => "camera".to_owned(),
            (None, [number]) if is_flat && number.parse::<u32>().is_ok() => format!("camera {number}"),
            (None, words) if is_flat => words.join(" "),
            (None, _) => sections.last().cloned().unwrap_or_default(),
        }
    }

    fn matrix(&self, camera: &[String]) -> Result<Matrix, String> {
        use Scalar::{Focal, FocalX, FocalY, Foreign, PrincipalX, PrincipalY, Skew};
        if self.field(camera, |role| role == Role::Scalar(Foreign))?.is_some() {
            return Err("the camera model is not supported, only pinhole and fisheye".into());
        }
        let focal = self.scalar(camera, Focal)?;
        let numbers = [self.scalar(camera, FocalX)?.or(focal), self.scalar(camera, FocalY)?.or(focal)];
        let principal = [self.scalar(camera, PrincipalX)?, self.scalar(camera, PrincipalY)?];
        let of_scalars = match (numbers, principal) {
            ([Some(fx), Some(fy)], [Some(cx), Some(cy)]) => {
                let mut matrix = calibration([fx, fy], [cx, cy]);
                matrix[(0, 1)] = self.scalar(camera, Skew)?.unwrap_or(0.0);
                Some(matrix)
            }
            _ => None,
        };
        let field = self.field(camera, |role| role == Role::Matrix)?;
        let Some(field) = field else {
            let pair = |role| -> Result<Option<[f64; 2]>, String> {
                let field = self.field(camera, |found| found == role)?;
                field
                    .map(|field| match field.numbers() {
                        [one] if role == Role::FocalLengths => Ok([*one; 2]),
                        _ => Self::exactly::<2>(field),
                    })
                    .transpose()
            };
            let of_pairs = pair(Role::FocalLengths)?.zip(pair(Role::PrincipalPoint)?);
            let matrix = of_scalars.or(of_pairs.map(|(focal, principal)| calibration(focal, principal)));
            let matrix = matrix.ok_or("fx, fy, cx and cy must all be given")?;
            return Ok(Matrix { entries: matrix, section: self.section(camera), is_transposed: false });
        };
        let section = field.section().to_vec();
        let written = match field.numbers() {
            [fx, fy, cx, cy] => calibration([*fx, *fy], [*cx, *cy]),
            _ => Matrix3::from_row_slice(&Self::exactly::<9>(field)?),
        };
        // The transpose has the principal point in the last row.
        let is_transposed = written[(0, 2)] == 0.0
            && written[(1, 2)] == 0.0
            && written[(0, 1)] == 0.0
            && written[(2, 0)].abs().min(written[(2, 1)].abs()) > 0.0;
        let matrix = if is_transposed { written.transpose() } else { written };
        if let Some(other) = of_scalars
            && (other - matrix).amax() > SAME * matrix.amax()
        {
            return Err(format!("{} and fx, fy, cx, cy differ", excerpt(&field.name())));
        }
        Ok(Matrix { entries: matrix, section, is_transposed })
    }

    /// Returns the sections of the numbers of a camera without a matrix.
    fn section(&self, camera: &[String]) -> Vec<String> {
        let is_own = |f: &&Field| {
            f.meaning.camera == camera && matches!(f.meaning.role, Role::Scalar(_) | Role::FocalLengths)
        };
        self.fields.iter().find(is_own).map_or_else(Vec::new, |field| field.section().to_vec())
    }

    /// Returns the size of the images of a camera, or of all cameras. MATLAB writes the height first.
    fn frame(&self, camera: &[String], is_matlab: bool) -> Result<Option<Frame>, String> {
        let frame = |sides: [f64; 2]| {
            let is_size = |side: &f64| *side >= 1.0 && *side < 1e6 && side.fract() == 0.0;
            sides.iter().all(is_size).then(|| Frame::new(sides[0] as usize, sides[1] as usize))
        };
        for of in [camera, &[]] {
            if let Some(field) = self.field(of, |role| role == Role::Size)?
                && let [a, b] = *field.numbers()
            {
                return Ok(frame(if is_matlab { [b, a] } else { [a, b] }));
            }
            let sides = [self.scalar(of, Scalar::Width)?, self.scalar(of, Scalar::Height)?];
            match sides {
                [Some(width), Some(height)] => return Ok(frame([width, height])),
                [None, None] => {}
                _ => return Err("the width and the height of the images must both be given".into()),
            }
        }
        Ok(None)
    }

    /// Returns the names of numbers without a meaning, in the sections of a camera or in all.
    fn unread(&self, near: Option<(&[String], &[String])>) -> Vec<String> {
        let is_near = |field: &Field| {
            let Some((camera, section)) = near else { return true };
            let of = field.section_camera();
            let is_inside = || section.starts_with(field.section()) || field.section().starts_with(section);
            let is_of_rig = matches!(field.meaning.role, Role::Transform(_));
            is_of_rig
                || of.is_empty()
                || of == camera
                || matches!(field.content, Content::List(_)) && (is_inside() || !self.cameras.contains(&of))
        };
        let is_unknown = |field: &Field| match field.meaning.role {
            Role::Unknown => !is_setting(&field.setting().0),
            Role::Transform(direction) => {
                let is_of_pair = field.meaning.camera.is_empty() && direction != Direction::WorldFromCamera;
                !is_of_pair && !self.cameras.contains(&field.meaning.camera)
            }
            _ => false,
        };
        let unread = |field: &&Field| !field.numbers().is_empty() && is_unknown(field) && is_near(field);
        self.fields.iter().filter(unread).map(Field::name).collect()
    }

    /// Refuses a camera without distortion beside numbers of an unknown name that may be one.
    fn refuse_hidden_lens(&self, camera: &[String], name: &str, section: &[String]) -> Result<(), String> {
        let may_be_lens = |field: &&Field| {
            let own = field.section();
            let is_near = section.starts_with(own) || own.starts_with(section);
            let has_count = matches!(field.numbers().len(), 4 | 5 | 8 | 12 | 14);
            field.meaning.role == Role::Unknown && has_count && is_near
        };
        let Some(field) = self.fields.iter().find(may_be_lens) else { return Ok(()) };
        let usual = match camera {
            [] => "dist_coeffs".to_owned(),
            words => format!("dist_coeffs_{}", words.join("_")),
        };
        Err(format!(
            "{} has {} numbers and may be the distortion of {}, but its name is not known. Rename it to {usual}, or \
             remove it if it is something else",
            excerpt(&field.name()),
            field.numbers().len(),
            excerpt(name)
        ))
    }

    /// Refuses numbers with a role that belong to no camera.
    fn refuse_orphans(&self, source: Option<PoseSource>) -> Result<(), String> {
        for field in &self.fields {
            let is_lens = matches!(
                field.meaning.role,
                Role::Distortion
                    | Role::Radial
                    | Role::Tangential
                    | Role::Scalar(Scalar::K(_) | Scalar::P(_))
            );
            let is_word = matches!(field.content, Content::Word(_));
            if let (Content::Broken(problem), false) =
                (&field.content, matches!(field.meaning.role, Role::Harmless | Role::Unknown))
            {
                return Err(format!("{}: {problem}", excerpt(&field.name())));
            }
            if is_lens && !is_word && !self.cameras.contains(&field.meaning.camera) {
                return Err(format!("there is {}, but no camera matrix for it", excerpt(&field.name())));
            }
        }
        if source.is_some() {
            return Ok(());
        }
        let of_pose =
            |role: Role| self.fields.iter().find(|f| f.meaning.role == role && !f.numbers().is_empty());
        match (of_pose(Role::Rotation).or(of_pose(Role::RotationOfRows)), of_pose(Role::Translation)) {
            (Some(rotation), Some(translation)) => Err(format!(
                "{} and {} do not belong to the same cameras",
                excerpt(&rotation.name()),
                excerpt(&translation.name())
            )),
            (None, Some(translation)) => {
                Err(format!("there is {}, but no rotation of the cameras", excerpt(&translation.name())))
            }
            (Some(rotation), None) if rotation.meaning.camera.is_empty() && self.cameras.len() > 1 => {
                Err(format!("there is {}, but no translation of the cameras", excerpt(&rotation.name())))
            }
            _ => Ok(()),
        }
    }
}
