//! Rays, and the rays of a camera's pixels.

use nalgebra::{Matrix3, Point3, Vector3};

use epiline::geometry::{Camera, Point};

/// A half line in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, m.
    pub origin: Point3<f64>,
    /// Unit direction.
    pub direction: Vector3<f64>,
}

impl Ray {
    /// The point at distance `t`, m.
    pub fn at(&self, t: f64) -> Point3<f64> {
        self.origin + self.direction * t
    }
}

/// A camera turned around: from pixels to rays.
///
/// With `P = [M | t]` the pixel `x` is seen along `M⁻¹ x` (Hartley & Zisserman, eq. 6.14); the sign of
/// `det M` picks the half in front.
#[derive(Debug, Clone, Copy)]
pub struct Eye {
    centre: Point3<f64>,
    direction_from_pixel: Matrix3<f64>,
    pixel_angle: f64,
}

impl Eye {
    /// `None` for a camera whose centre is at infinity.
    pub fn new(camera: &Camera) -> Option<Self> {
        let centre = Point3::from_homogeneous(camera.centre())?;
        let m = camera.matrix().fixed_columns::<3>(0).into_owned();
        let inverse = m.try_inverse()? * m.determinant().signum();
        let pixel_angle = inverse.column(0).norm() * m.row(2).norm();
        Some(Self { centre, direction_from_pixel: inverse, pixel_angle })
    }

    /// The camera centre.
    pub fn centre(&self) -> Point3<f64> {
        self.centre
    }

    /// The ray seen at a pixel position.
    pub fn ray(&self, p: Point) -> Ray {
        let direction = (self.direction_from_pixel * p.to_homogeneous()).normalize();
        Ray { origin: self.centre, direction }
    }

    /// Angle between neighbouring pixels at the principal point, radians.
    pub fn pixel_angle(&self) -> f64 {
        self.pixel_angle
    }

    /// Whether a scene point lies in front of a camera.
    pub fn sees_in_front(camera: &Camera, point: &Point3<f64>) -> bool {
        let m = camera.matrix().fixed_columns::<3>(0).into_owned();
        (camera.matrix() * point.to_homogeneous()).z * m.determinant() > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ray_of_a_projected_point_passes_through_it() {
        let camera = Camera::looking_at(
            Point3::new(-0.4, 0.0, 0.0),
            Point3::new(0.1, 0.0, 6.0),
            Vector3::new(0.0, -1.0, 0.05),
            800.0,
            Point::new(383.5, 287.5),
        )
        .unwrap();
        let eye = Eye::new(&camera).unwrap();
        for k in 0..20 {
            let t = f64::from(k);
            let x = Point3::new(t.sin(), (2.0 * t).cos(), 5.0 + (3.0 * t).sin());
            let ray = eye.ray(camera.project(&x).unwrap());
            let along = (x - eye.centre()).dot(&ray.direction);
            assert!(along > 0.0 && Eye::sees_in_front(&camera, &x));
            assert!((ray.at(along) - x).norm() < 1e-9);
        }
        assert!((eye.pixel_angle() - 1.0 / 800.0).abs() < 1e-9);
    }
}
