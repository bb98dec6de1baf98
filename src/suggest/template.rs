//! Templates: the surroundings of a click, rotated and scaled.

use nalgebra::Matrix2;

use crate::geometry::{Point, Vector};
use crate::image::GrayPlane;

/// Minimum standard deviation of a window, grey levels. Below it there is only noise.
pub(super) const LEAST_CONTRAST: f32 = 1.5;
/// Half width of a template, px: 11×11 pixels at every level.
pub(super) const HALF: usize = 5;
pub(super) const SIDE: usize = 2 * HALF + 1;

/// Rotation and scale from the clicked image to the other image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    /// Angle, radians from the x axis to the y axis.
    pub rotation: f64,
    /// Size in the other image over size in the clicked image.
    pub scale: f64,
}

/// Patch with zero mean and unit norm.
pub(super) struct Template {
    pub values: [f32; SIDE * SIDE],
    /// Offset from the middle of the template to the click, px of the other image; zero except near
    /// borders.
    pub offset: Vector,
    pub pose: Pose,
}

impl Pose {
    /// Returns the pose nearest to an affine map.
    pub fn of(affine: &Matrix2<f64>) -> Self {
        let (a, b) = (affine[(0, 0)] + affine[(1, 1)], affine[(1, 0)] - affine[(0, 1)]);
        Self { rotation: b.atan2(a), scale: affine.determinant().abs().sqrt().max(1e-3) }
    }

    /// Returns the pose from the other image to the clicked image.
    pub fn inverse(self) -> Self {
        Self { rotation: -self.rotation, scale: 1.0 / self.scale }
    }

    /// Returns the matrix that maps displacements in the clicked image to the other image.
    pub fn matrix(self) -> Matrix2<f64> {
        let (sin, cos) = self.rotation.sin_cos();
        Matrix2::new(cos, -sin, sin, cos) * self.scale
    }
}

impl Template {
    /// Creates the template around a point of a plane; `None` where the plane is flat.
    ///
    /// Near a border the middle moves inwards until the whole template is inside the image. The
    /// click is then off the middle.
    pub fn new(plane: &GrayPlane, at: Point, pose: Pose) -> Option<Self> {
        let inverse = pose.matrix().try_inverse()?;
        // The corners of a rotated square reach farthest.
        let reach = HALF as f64 * (inverse[(0, 0)].abs() + inverse[(0, 1)].abs());
        let inside = |v: f64, last: f64| if last > 2.0 * reach { v.clamp(reach, last - reach) } else { v };
        let middle = Point::new(inside(at.x, plane.frame().right()), inside(at.y, plane.frame().bottom()));
        let mut values = [0f32; SIDE * SIDE];
        for (k, value) in values.iter_mut().enumerate() {
            let (u, v) = ((k % SIDE) as f64 - HALF as f64, (k / SIDE) as f64 - HALF as f64);
            *value = plane.sample(middle + inverse * Vector::new(u, v));
        }
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        for value in &mut values {
            *value -= mean;
        }
        let norm = values.iter().map(|v| v * v).sum::<f32>().sqrt();
        if norm < LEAST_CONTRAST * SIDE as f32 {
            return None;
        }
        for value in &mut values {
            *value /= norm;
        }
        Some(Self { values, offset: pose.matrix() * (at - middle), pose })
    }
}
