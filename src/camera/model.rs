//! Camera models: calibration matrix and lens.

use nalgebra::{Matrix3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::lens::{Lens, Radial};
use crate::geometry::{Frame, Point, scaling};

/// A camera model: calibration matrix and lens. The centre of the top-left pixel is (0, 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct CameraModel {
    /// Focal lengths in x and y, px.
    focal: [f64; 2],
    /// Principal point, px.
    principal: Point,
    /// Skew: entry (1, 2) of the calibration matrix.
    skew: f64,
    lens: Lens,
    /// Undistorted radius at which the lens folds back.
    fold: f64,
    /// Relative standard deviation of the focal length; 0 for a calibration, infinite if the focal length is
    /// unknown.
    focal_deviation: f64,
}

/// A focal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FocalLength {
    /// The focal length, px.
    pub pixels: f64,
    /// Relative standard deviation of the focal length; 0 if the focal length is known.
    pub deviation: f64,
}

/// A camera model in files.
#[derive(Serialize, Deserialize)]
struct Written {
    /// Calibration matrix as nested rows.
    matrix: [[f64; 3]; 3],
    lens: Lens,
    /// `None` for an unknown focal length.
    #[serde(default = "exact")]
    focal_deviation: Option<f64>,
}

/// Returns the deviation of a calibration.
#[expect(clippy::unnecessary_wraps, reason = "serde asks for the type of the field")]
fn exact() -> Option<f64> {
    Some(0.0)
}

impl From<CameraModel> for Written {
    fn from(camera: CameraModel) -> Self {
        let lens = camera.lens;
        let focal_deviation = camera.focal_deviation();
        Self { matrix: camera.calibration().transpose().data.0, lens, focal_deviation }
    }
}

impl TryFrom<Written> for CameraModel {
    type Error = &'static str;

    fn try_from(Written { matrix, lens, focal_deviation }: Written) -> Result<Self, Self::Error> {
        let calibration = Matrix3::from_fn(|row, column| matrix[row][column]);
        let is_deviation = focal_deviation.is_none_or(|deviation| (0.0..1.0).contains(&deviation));
        let camera = Self::new(&calibration, lens).filter(|_| is_deviation);
        let camera = camera.ok_or("the calibration of a camera is impossible")?;
        Ok(Self { focal_deviation: focal_deviation.unwrap_or(f64::INFINITY), ..camera })
    }
}

impl CameraModel {
    /// Creates a model from an upper triangular calibration matrix and a lens. Returns `None` unless
    /// both focal lengths are positive and all numbers are finite.
    pub fn new(calibration: &Matrix3<f64>, lens: Lens) -> Option<Self> {
        let k = calibration / calibration[(2, 2)];
        let lower = k[(1, 0)].abs() + k[(2, 0)].abs() + k[(2, 1)].abs();
        let is_sound = k.iter().all(|v| v.is_finite()) && lower <= 1e-9 * k.amax();
        let focal = [k[(0, 0)], k[(1, 1)]];
        let (_, derivatives) = lens.distorted(&Vector2::new(1e-3, 1e-3));
        let is_finite = derivatives.iter().all(|v| v.is_finite());
        let is_valid = is_sound && is_finite && focal.iter().all(|f| *f > 0.0);
        let principal = Point::new(k[(0, 2)], k[(1, 2)]);
        let (skew, fold) = (k[(0, 1)], lens.fold());
        is_valid.then_some(Self { focal, principal, skew, lens, fold, focal_deviation: 0.0 })
    }

    /// Returns the camera of a focal length: without distortion, with square pixels, and with the
    /// principal point in the middle of its pictures. `None` unless the focal length is positive and finite,
    /// and its deviation at least 0 and below 1.
    pub fn of_focal_length(focal: FocalLength, frame: Frame) -> Option<Self> {
        let FocalLength { pixels, deviation } = focal;
        let middle = frame.centre();
        let calibration = scaling(pixels, middle.x, middle.y);
        Self::new(&calibration, Lens::IDEAL)?.with_deviation(deviation)
    }

    /// Returns a camera of unknown focal length with radial distortion by the division model. The
    /// centre of distortion is the middle of the pictures. `lambda` belongs to radii in half
    /// diagonals of a picture. `None` unless it is finite and above −1, which would move the
    /// corners to infinity.
    pub fn of_division(lambda: f64, frame: Frame) -> Option<Self> {
        let half = 0.5 * frame.diagonal();
        let camera = Self::of_focal_length(FocalLength { pixels: half, deviation: 0.0 }, frame)?;
        let lens = Lens::perspective(Radial::Division { lambda });
        let camera = Self::new(&camera.calibration(), lens).filter(|_| lambda > -1.0)?;
        Some(Self { focal_deviation: f64::INFINITY, ..camera })
    }

    /// Returns the camera with another focal length. Its pictures without distortion stay the same.
    /// `None` for an impossible focal length, and for a lens whose calibration includes the focal
    /// length.
    pub fn with_focal_length(&self, focal: FocalLength) -> Option<Self> {
        let by = focal.pixels / self.focal[0];
        let lens = match self.lens.radial {
            // The coefficient belongs to radii in focal lengths.
            Radial::Division { lambda } => {
                Lens { radial: Radial::Division { lambda: lambda * by * by }, ..self.lens }
            }
            _ if self.lens.is_ideal() => self.lens,
            _ => return None,
        };
        let calibration = self.calibration() * Matrix3::from_diagonal(&Vector3::new(by, by, 1.0));
        Self::new(&calibration, lens)?.with_deviation(focal.deviation)
    }

    /// Returns the camera with this relative standard deviation of the focal length, `None` for an unknown one.
    pub(super) fn with_deviation_of(self, deviation: Option<f64>) -> Self {
        Self { focal_deviation: deviation.unwrap_or(f64::INFINITY), ..self }
    }

    fn with_deviation(self, focal_deviation: f64) -> Option<Self> {
        (0.0..1.0).contains(&focal_deviation).then_some(Self { focal_deviation, ..self })
    }

    /// Returns the coefficient of the division model for radii in half diagonals of a picture of this size, if
    /// the lens is one of that model.
    pub fn division(&self, frame: Frame) -> Option<f64> {
        let Radial::Division { lambda } = self.lens.radial else { return None };
        Some(lambda * (0.5 * frame.diagonal() / self.focal[0]).powi(2))
    }

    /// Returns the focal length across the image, if it is known or guessed.
    pub fn focal_length(&self) -> Option<FocalLength> {
        Some(FocalLength { pixels: self.focal[0], deviation: self.focal_deviation()? })
    }

    /// Returns the relative standard deviation of the focal length: 0 for a calibration, `None` if the focal
    /// length is unknown.
    pub fn focal_deviation(&self) -> Option<f64> {
        self.focal_deviation.is_finite().then_some(self.focal_deviation)
    }

    /// Returns the calibration matrix `K`.
    pub fn calibration(&self) -> Matrix3<f64> {
        let ([fx, fy], c) = (self.focal, self.principal);
        Matrix3::new(fx, self.skew, c.x, 0.0, fy, c.y, 0.0, 0.0, 1.0)
    }

    /// Returns the lens.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// Returns the pixel of a ray in camera coordinates. `None` behind a perspective camera, and
    /// where the lens folds back.
    pub fn image_from_ray(&self, ray: &Vector3<f64>) -> Option<Point> {
        self.distorted(ray).map(|distorted| self.pixel(&distorted))
    }

    /// Returns the unit ray of a pixel. `None` where the lens has no inverse.
    pub fn ray_from_image(&self, pixel: Point) -> Option<Vector3<f64>> {
        let y = (pixel.y - self.principal.y) / self.focal[1];
        let x = (pixel.x - self.principal.x - self.skew * y) / self.focal[0];
        self.lens.undistorted(&Vector2::new(x, y), self.fold).map(|flat| self.lens.ray(&flat))
    }

    /// Returns the distorted coordinates of a ray.
    fn distorted(&self, ray: &Vector3<f64>) -> Option<Vector2<f64>> {
        let flat = self.lens.flat(ray)?;
        if self.lens.is_ideal() {
            return Some(flat);
        }
        if flat.norm() > self.fold {
            return None;
        }
        let (distorted, derivatives) = self.lens.distorted(&flat);
        (derivatives.determinant() > 0.0).then_some(distorted)
    }

    fn pixel(&self, distorted: &Vector2<f64>) -> Point {
        let [fx, fy] = self.focal;
        let x = fx * distorted.x + self.skew * distorted.y + self.principal.x;
        Point::new(x, fy * distorted.y + self.principal.y)
    }
}
