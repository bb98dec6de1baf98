//! Signs that a calibration belongs to other pictures.

use serde::Serialize;

use super::model::CameraModel;
use crate::geometry::{Frame, Point};

/// Sign that a calibration belongs to other pictures than those of a given size. Lengths are in px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum CameraDoubt {
    /// The principal point is outside the picture, or far from its middle. `larger` is the ratio of the size
    /// whose middle it would be to the size of the picture, if it is the same in both directions.
    PrincipalPoint { x: f64, y: f64, width: usize, height: usize, is_outside: bool, larger: Option<f64> },
    /// The lens folds back inside the picture: this share of the picture, 0 to 1, shows no ray.
    Folds { share: f64 },
}

/// Largest ratio of the principal point to the middle of the picture, along each axis, of ordinary
/// calibrations: an eighth of the size beside the middle. Real lenses and sensors stay within some 5 %;
/// sensible changes of size are larger.
const LARGEST_RATIO: f64 = 1.25;
/// Ratio of the offset from the middle to half of the size beyond which a principal point along one axis
/// alone is far from the middle. Pictures cut out of larger ones reach it; shifted sensors do not.
const FAR: f64 = 0.5;
/// Places along each side of the picture at which the lens is examined.
const SAMPLES: u32 = 16;

impl CameraModel {
    /// Returns signs that the camera does not belong to pictures of this size. They are no proof: a picture
    /// may be cut out of a larger one.
    pub fn doubts(&self, frame: Frame) -> Vec<CameraDoubt> {
        [self.doubt_of_principal_point(frame), self.doubt_of_fold(frame)].into_iter().flatten().collect()
    }

    fn doubt_of_principal_point(&self, frame: Frame) -> Option<CameraDoubt> {
        let k = self.calibration();
        let principal = Point::new(k[(0, 2)], k[(1, 2)]);
        let Frame { width, height } = frame;
        // Pixel centres are whole numbers, so the middle of a picture is half of its size from −½.
        let ratios = [(principal.x, width), (principal.y, height)]
            .map(|(at, size)| 2.0 * (at + 0.5) / size.max(1) as f64);
        let [x, y] = ratios;
        let is_outside = !frame.contains(principal);
        let is_same_way = ratios.iter().all(|r| *r > LARGEST_RATIO)
            || ratios.iter().all(|r| *r > 0.0 && *r < 1.0 / LARGEST_RATIO);
        let is_same = is_same_way && x / y < LARGEST_RATIO && y / x < LARGEST_RATIO;
        let is_far = ratios.iter().any(|r| (r - 1.0).abs() > FAR);
        (is_outside || is_same || is_far).then_some(CameraDoubt::PrincipalPoint {
            x: principal.x,
            y: principal.y,
            width,
            height,
            is_outside,
            larger: is_same.then(|| (x * y).sqrt()),
        })
    }

    fn doubt_of_fold(&self, frame: Frame) -> Option<CameraDoubt> {
        if self.lens().is_ideal() {
            return None;
        }
        let at = |k: u32, last: f64| last * f64::from(k) / f64::from(SAMPLES - 1);
        let places = (0..SAMPLES * SAMPLES)
            .map(|k| Point::new(at(k % SAMPLES, frame.right()), at(k / SAMPLES, frame.bottom())));
        let without = places.filter(|place| self.ray_from_image(*place).is_none()).count();
        (without > 0).then(|| CameraDoubt::Folds { share: without as f64 / f64::from(SAMPLES * SAMPLES) })
    }

    /// Returns the camera of the same pictures resized along each axis (new size over old size).
    pub fn resized(&self, by: [f64; 2]) -> Option<Self> {
        let resizing = nalgebra::Matrix3::new(
            by[0],
            0.0,
            0.5 * by[0] - 0.5,
            0.0,
            by[1],
            0.5 * by[1] - 0.5,
            0.0,
            0.0,
            1.0,
        );
        let camera = Self::new(&(resizing * self.calibration()), *self.lens())?;
        Some(camera.with_deviation_of(self.focal_deviation()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Lens, Radial, calibration};

    const FRAME: Frame = Frame { width: 640, height: 480 };

    fn camera(focal: f64, centre: [f64; 2], coefficients: &[f64]) -> CameraModel {
        let lens = Lens::perspective(Radial::polynomial(coefficients));
        CameraModel::new(&calibration([focal; 2], centre), lens).unwrap()
    }

    #[test]
    fn a_principal_point_of_another_size_is_told_and_an_ordinary_one_is_not() {
        let doubts = |x, y| camera(500.0, [x, y], &[]).doubts(FRAME);
        assert_eq!(doubts(319.5, 239.5), []);
        assert_eq!(doubts(350.0, 215.0), []);
        let larger = |x, y| match doubts(x, y)[..] {
            [CameraDoubt::PrincipalPoint { larger, is_outside, .. }] => (larger, is_outside),
            _ => panic!("{x} {y}"),
        };
        let (by, is_outside) = larger(639.5, 479.5);
        assert!((by.unwrap() - 2.0).abs() < 1e-9 && !is_outside);
        let (by, is_outside) = larger(159.5, 119.5);
        assert!((by.unwrap() - 0.5).abs() < 1e-9 && !is_outside);
        assert_eq!(larger(319.5, 500.0), (None, true));
        assert_eq!(larger(-20.0, 239.5), (None, true));
        assert_eq!(larger(550.0, 239.5), (None, false));
    }

    #[test]
    fn a_lens_that_folds_back_inside_the_picture_is_told() {
        // The distorted radius r − 0.5 r³ is largest at r = 0.82, where it is 0.54 of the focal length.
        assert_eq!(camera(500.0, [319.5, 239.5], &[-0.1]).doubts(FRAME), []);
        let found = camera(500.0, [319.5, 239.5], &[-0.5]).doubts(FRAME);
        assert!(
            matches!(found[..], [CameraDoubt::Folds { share }] if (0.1..0.6).contains(&share)),
            "{found:?}"
        );
    }

    #[test]
    fn a_resized_camera_sees_the_same_rays() {
        let whole = camera(500.0, [322.0, 236.0], &[-0.1, 0.01]);
        let half = whole.resized([0.5; 2]).unwrap();
        let ray = nalgebra::Vector3::new(0.2, -0.1, 1.0);
        let [a, b] = [&whole, &half].map(|camera| camera.image_from_ray(&ray).unwrap());
        assert!((crate::geometry::rescaled(a, 0.5) - b).norm() < 1e-9);
    }
}
