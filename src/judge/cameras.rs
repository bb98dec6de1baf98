//! Cameras taken apart into calibration and pose.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::geometry::Camera;

/// A camera `K [R | t]` (Hartley & Zisserman, §6.2.4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DecomposedCamera {
    /// Upper triangular, the last entry 1.
    pub calibration: Matrix3<f64>,
    pub rotation: Matrix3<f64>,
    pub translation: Vector3<f64>,
}

impl DecomposedCamera {
    /// Takes a camera apart. `None` for a camera at infinity.
    pub fn new(camera: &Camera) -> Option<Self> {
        let p = camera.matrix();
        let m: Matrix3<f64> = p.fixed_columns::<3>(0).into();
        // RQ decomposition: QR of the rows in reverse order.
        let reverse = Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0);
        let qr = (reverse * m).transpose().qr();
        let mut k = reverse * qr.r().transpose() * reverse;
        let mut r = reverse * qr.q().transpose();
        for n in 0..3 {
            if k[(n, n)] < 0.0 {
                k.column_mut(n).neg_mut();
                r.row_mut(n).neg_mut();
            }
        }
        let scale = k[(2, 2)];
        if (0..3).any(|n| k[(n, n)] < 1e-12 * k.amax()) {
            return None;
        }
        // A projection matrix has no sign; a rotation has.
        let sign = r.determinant().signum();
        let translation = k.try_inverse()? * p.column(3) * sign;
        Some(Self { calibration: k / scale, rotation: r * sign, translation })
    }

    /// Takes apart a camera whose calibration matrix is transposed, `Kᵀ [R | t]`. `None` for a camera at
    /// infinity.
    pub fn of_transposed(camera: &Camera) -> Option<Self> {
        let p = camera.matrix();
        let m: Matrix3<f64> = p.fixed_columns::<3>(0).into();
        // A lower triangular matrix before a rotation: QR of the transpose.
        let qr = m.transpose().qr();
        let (mut k, mut rotation) = (qr.r(), qr.q().transpose());
        for n in 0..3 {
            if k[(n, n)] < 0.0 {
                k.row_mut(n).neg_mut();
                rotation.row_mut(n).neg_mut();
            }
        }
        let scale = k[(2, 2)];
        if (0..3).any(|n| k[(n, n)] < 1e-12 * k.amax()) {
            return None;
        }
        let sign = rotation.determinant().signum();
        let translation = k.transpose().try_inverse()? * p.column(3) * sign;
        Some(Self { calibration: k / scale, rotation: rotation * sign, translation })
    }

    /// Returns the projection matrix.
    pub fn composed(&self) -> Option<Camera> {
        Camera::posed(&self.calibration, &self.rotation, &self.translation)
    }
}

/// Corrects a rotation whose quaternion was read with its real part first, although it is last.
pub(super) fn with_real_part_last(rotation: &Matrix3<f64>) -> Matrix3<f64> {
    let read = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation));
    let [a, b, c, d] = [read.w, read.i, read.j, read.k];
    UnitQuaternion::from_quaternion(Quaternion::new(d, a, b, c)).to_rotation_matrix().into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_taken_apart_and_put_together_is_the_same() {
        let (camera1, camera2) = Camera::example_pair();
        for camera in [camera1, camera2] {
            let parts = DecomposedCamera::new(&camera).unwrap();
            assert!((parts.rotation.determinant() - 1.0).abs() < 1e-12);
            assert!((parts.rotation * parts.rotation.transpose() - Matrix3::identity()).norm() < 1e-12);
            assert!(parts.calibration[(0, 0)] > 0.0 && parts.calibration[(1, 0)].abs() < 1e-9);
            let [a, b] = [*camera.matrix(), *parts.composed().unwrap().matrix()].map(|m| m / m.norm());
            assert!((a - b).norm().min((a + b).norm()) < 1e-12);
        }
    }

    #[test]
    fn a_camera_with_its_calibration_transposed_is_mended() {
        let (camera, _) = Camera::example_pair();
        let DecomposedCamera { calibration, rotation, translation } = DecomposedCamera::new(&camera).unwrap();
        let wrong = Camera::posed(&calibration.transpose(), &rotation, &translation).unwrap();
        let mended = DecomposedCamera::of_transposed(&wrong).unwrap();
        assert!((mended.calibration - calibration).norm() < 1e-9 * calibration.norm());
        assert!((mended.rotation - rotation).norm() < 1e-9);
        assert!((mended.translation - translation).norm() < 1e-9);
    }

    #[test]
    fn a_quaternion_with_its_real_part_last_is_read_right() {
        let right = UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1);
        // A program that expects the real part first reads (x, y, z, w) as (w, x, y, z).
        let misread = UnitQuaternion::from_quaternion(Quaternion::new(right.i, right.j, right.k, right.w));
        let mended = with_real_part_last(&misread.to_rotation_matrix().into_inner());
        assert!((mended - right.to_rotation_matrix().into_inner()).norm() < 1e-12);
    }
}
