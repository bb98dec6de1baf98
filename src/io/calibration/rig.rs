//! Named numbers of a calibration, asked for by role and camera. Numbers of the same role and camera must agree.

use super::fields::{Content, Field};
use super::names::{Role, Scalar};
use crate::foreign::excerpt;

/// Fields of a file, and the cameras that they name.
pub(super) struct Rig {
    pub fields: Vec<Field>,
    /// Words of each camera, left before right and numbers in order.
    pub cameras: Vec<Vec<String>>,
}

/// Numbers that differ by less are written with fewer digits: relative.
pub(super) const SAME: f64 = 1e-6;

impl Rig {
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
}
