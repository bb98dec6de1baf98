//! Pinhole cameras as 3×4 projection matrices.

use nalgebra::{Matrix3, Matrix3x4, Point3, Vector3, Vector4};
use serde::{Deserialize, Serialize};

use super::{FundamentalMatrix, Point, scaling};

/// A projection matrix `P`: `x ∝ P (X, 1)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Matrix3x4<f64>", into = "Matrix3x4<f64>")]
pub struct Camera(Matrix3x4<f64>);

impl Camera {
    /// Creates a camera from a projection matrix. Returns `None` when the matrix is not finite or
    /// has rank below 3, which leaves the centre undefined.
    pub fn from_matrix(matrix: Matrix3x4<f64>) -> Option<Self> {
        let camera = Self(matrix);
        (matrix.iter().all(|v| v.is_finite()) && camera.centre().norm() > 0.0).then_some(camera)
    }

    /// Creates a camera at `position` that looks at `target`, with the image's y axis pointing away
    /// from `up`. Focal length and principal point are in pixels. Returns `None` when the camera
    /// looks along `up`.
    pub fn looking_at(
        position: Point3<f64>,
        target: Point3<f64>,
        up: Vector3<f64>,
        focal: f64,
        principal: Point,
    ) -> Option<Self> {
        let forward = (target - position).try_normalize(1e-12)?;
        let right = forward.cross(&up).try_normalize(1e-12)?;
        let down = forward.cross(&right);
        let rotation = Matrix3::from_rows(&[right.transpose(), down.transpose(), forward.transpose()]);
        let intrinsic = scaling(focal, principal.x, principal.y);
        let m = intrinsic * rotation;
        let t = m * -position.coords;
        Self::from_matrix(Matrix3x4::from_columns(&[
            m.column(0).into_owned(),
            m.column(1).into_owned(),
            m.column(2).into_owned(),
            t,
        ]))
    }

    /// Creates the camera `K [R | t]`. Returns `None` like [`Camera::from_matrix`].
    pub fn posed(
        calibration: &Matrix3<f64>,
        rotation: &Matrix3<f64>,
        translation: &Vector3<f64>,
    ) -> Option<Self> {
        let mut pose = Matrix3x4::zeros();
        pose.fixed_columns_mut::<3>(0).copy_from(rotation);
        pose.set_column(3, translation);
        Self::from_matrix(calibration * pose)
    }

    /// Returns the projection matrix `P`.
    pub fn matrix(&self) -> &Matrix3x4<f64> {
        &self.0
    }

    /// Returns the camera centre as a homogeneous 3-D point (`P C = 0`), from the four 3×3 minors.
    pub fn centre(&self) -> Vector4<f64> {
        let minor = |skip: usize| {
            let columns: Vec<_> = (0..4).filter(|c| *c != skip).collect();
            Matrix3::from_fn(|r, c| self.0[(r, columns[c])]).determinant()
        };
        Vector4::new(minor(0), -minor(1), minor(2), -minor(3))
    }

    /// Returns the calibration matrix `K` of `P = K [R | t]`, upper triangular with a positive diagonal that
    /// ends in 1. `None` if the left 3×3 part of `P` is singular.
    pub fn calibration(&self) -> Option<Matrix3<f64>> {
        let m = self.0.fixed_columns::<3>(0);
        // K Kᵀ = M Mᵀ. With rows and columns in reverse order, Cholesky's lower triangle becomes an upper one.
        let reversed = |m: Matrix3<f64>| Matrix3::from_fn(|row, column| m[(2 - row, 2 - column)]);
        let upper = reversed(reversed(m * m.transpose()).cholesky()?.l());
        Some(upper / upper[(2, 2)])
    }

    /// Projects a scene point into the image, px. Returns `None` for points in the camera's focal
    /// plane.
    pub fn project(&self, point: &Point3<f64>) -> Option<Point> {
        super::finite_point(&(self.0 * point.to_homogeneous()))
    }

    /// Returns the fundamental matrix of two cameras, `F = [e2]× P2 P1⁺` with `e2 = P2 C1` (Hartley
    /// & Zisserman, eq. 9.1). Returns `None` when the centres coincide.
    pub fn fundamental(camera1: &Self, camera2: &Self) -> Option<FundamentalMatrix> {
        let e2 = camera2.0 * camera1.centre();
        let inverse1 = camera1.0.pseudo_inverse(0.0).ok()?;
        FundamentalMatrix::from_rank_two(e2.cross_matrix() * camera2.0 * inverse1)
    }

    /// Returns two cameras in general position for tests.
    #[cfg(test)]
    pub(crate) fn example_pair() -> (Self, Self) {
        let camera = |x: f64, y: f64, z: f64| {
            Self::looking_at(
                Point3::new(x, y, z),
                Point3::new(0.1, 0.0, 6.0),
                Vector3::new(0.0, -1.0, 0.05),
                800.0,
                Point::new(383.5, 287.5),
            )
            .unwrap()
        };
        (camera(-0.4, 0.0, 0.0), camera(0.7, -0.2, 0.4))
    }
}

impl TryFrom<Matrix3x4<f64>> for Camera {
    type Error = &'static str;

    fn try_from(matrix: Matrix3x4<f64>) -> Result<Self, Self::Error> {
        Self::from_matrix(matrix).ok_or("a projection matrix has no centre")
    }
}

impl From<Camera> for Matrix3x4<f64> {
    fn from(camera: Camera) -> Self {
        camera.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{example_fundamental, example_seen};
    use crate::geometry::symmetric_epipolar_distance;

    #[test]
    fn fundamental_fits_every_projected_point() {
        let f = example_fundamental();
        for k in 0..50 {
            let t = f64::from(k);
            let pair = example_seen((t * 0.7).sin() * 2.0, (t * 1.3).cos(), 4.0 + (t * 0.31).sin() * 2.0);
            assert!(symmetric_epipolar_distance(&f, &pair) < 1e-8);
        }
    }

    #[test]
    fn looks_at_its_target_with_y_down() {
        let camera = Camera::looking_at(
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(0.0, 0.0, 5.0),
            Vector3::new(0.0, -1.0, 0.0),
            500.0,
            Point::new(320.0, 240.0),
        )
        .unwrap();
        let centre = camera.project(&Point3::new(0.0, 0.0, 9.0)).unwrap();
        assert!((centre - Point::new(320.0, 240.0)).norm() < 1e-9);
        let off = camera.project(&Point3::new(1.0, 2.0, 10.0)).unwrap();
        assert!((off - Point::new(370.0, 340.0)).norm() < 1e-9);
    }

    #[test]
    fn same_centre_has_no_fundamental() {
        let (camera, _) = Camera::example_pair();
        // e2 = P C vanishes only up to rounding, so the test checks that no NaN reaches the caller.
        if let Some(f) = Camera::fundamental(&camera, &camera) {
            assert!(!f.matrix().iter().any(|v| v.is_nan()));
        }
    }
}
