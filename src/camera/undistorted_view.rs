//! The picture that a camera would take without the distortion of its lens.

use nalgebra::{Matrix3, Vector2, Vector3};
use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};

use super::lens::Lens;
use super::model::{CameraModel, FocalLength};
use super::names::calibration;
use crate::geometry::{Frame, Point};

/// A view without distortion from the place of a camera: epipolar curves are straight lines in it.
///
/// The view keeps the scale of the original at the principal point, and covers the original as far
/// as its pixels are stretched at most three times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UndistortedView {
    camera: CameraModel,
    original: Frame,
    calibration: Matrix3<f64>,
    inverse: Matrix3<f64>,
    frame: Frame,
}

/// Largest stretch along the radius. Beyond it the view has many pixels and little content. Fisheye
/// lenses reach it 55° from the axis; a chosen value.
const MOST_STRETCH: f64 = 3.0;
/// Samples along each side of the outline.
const SAMPLES: u32 = 64;
/// Largest number of pixels of the view, in multiples of the original: larger views are reduced.
/// Usual lenses need 1.1 to 1.7.
const MOST_PIXELS: f64 = 2.0;

/// Largest distance between the places of a pixel by two lenses that count as the same, px. A coefficient
/// rounded to four digits moves the corners of a picture of 20 megapixels by 0.2 px.
const SAME_PLACE: f64 = 0.5;
/// Steps along each side of the pixels that are compared.
const GRID: u32 = 8;

impl UndistortedView {
    /// Plans the view of a camera with pictures of the size `original`. A camera without distortion
    /// keeps its pictures as they are.
    ///
    /// Returns `None` if the lens has no inverse at the principal point, or for an image of less than
    /// 2×2 px.
    pub fn new(camera: &CameraModel, original: Frame) -> Option<Self> {
        if original.width < 2 || original.height < 2 {
            return None;
        }
        let own = camera.calibration();
        if camera.lens().is_ideal() {
            let inverse = own.try_inverse()?;
            return Some(Self { camera: *camera, original, calibration: own, inverse, frame: original });
        }
        let centre = Point::new(own[(0, 2)], own[(1, 2)]);
        let scale = [own[(0, 0)], own[(1, 1)]];
        let at = |p: Point| {
            let ray = camera.ray_from_image(p).filter(|ray| ray.z > 0.0)?;
            Some([scale[0] * ray.x / ray.z, scale[1] * ray.y / ray.z])
        };
        at(centre)?;
        let mut reach = [[0.0f64; 2]; 2];
        for outline in outline(original) {
            // The farthest place towards the outline that is not stretched too much.
            let place = |share: f64| at(centre + (outline - centre) * share);
            let distance = |[x, y]: [f64; 2]| x.hypot(y);
            let length = (outline - centre).norm();
            let mut last = [0.0; 2];
            for step in 1..=SAMPLES {
                let Some(next) = place(f64::from(step) / f64::from(SAMPLES)) else { break };
                if distance(next) - distance(last) > MOST_STRETCH * length / f64::from(SAMPLES) {
                    break;
                }
                last = next;
            }
            for (k, value) in last.into_iter().enumerate() {
                reach[k] = [reach[k][0].min(value), reach[k][1].max(value)];
            }
        }
        let [width, height] = reach.map(|[low, high]| high.ceil() - low.floor() + 1.0);
        let most = MOST_PIXELS * (original.width * original.height) as f64;
        let shrunk = (most / (width * height)).sqrt().min(1.0);
        let side = |length: f64| ((length * shrunk) as usize).max(2);
        let frame = Frame::new(side(width), side(height));
        let calibration = calibration(
            scale.map(|focal| focal * shrunk),
            [-reach[0][0].floor() * shrunk, -reach[1][0].floor() * shrunk],
        );
        let inverse = calibration.try_inverse()?;
        Some(Self { camera: *camera, original, calibration, inverse, frame })
    }

    /// Returns a view that a file describes: its calibration matrix and its size, and the camera and the size
    /// of its pictures. `None` for a matrix without an inverse or an image of less than 2×2 px.
    pub fn described(
        camera: CameraModel,
        original: Frame,
        calibration: Matrix3<f64>,
        frame: Frame,
    ) -> Option<Self> {
        let is_sound = [original, frame].iter().all(|frame| frame.width > 1 && frame.height > 1);
        let is_camera = CameraModel::new(&calibration, Lens::IDEAL).is_some();
        let inverse = calibration.try_inverse().filter(|_| is_sound && is_camera)?;
        Some(Self { camera, original, calibration, inverse, frame })
    }

    /// Returns the same view, by a camera with another focal length. `None` as for
    /// [`CameraModel::with_focal_length`].
    #[must_use]
    pub fn with_focal_length(&self, focal: FocalLength) -> Option<Self> {
        let camera = self.camera.with_focal_length(focal)?;
        let by = camera.calibration()[(0, 0)] / self.camera.calibration()[(0, 0)];
        let calibration = self.calibration * Matrix3::from_diagonal(&Vector3::new(by, by, 1.0));
        Some(Self { camera, calibration, inverse: calibration.try_inverse()?, ..*self })
    }

    /// Returns the camera of the original pictures.
    pub fn camera(&self) -> &CameraModel {
        &self.camera
    }

    /// Returns the size of the original pictures.
    pub fn original(&self) -> Frame {
        self.original
    }

    /// Returns the size of the view.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// Returns the calibration matrix of the view.
    pub fn calibration(&self) -> &Matrix3<f64> {
        &self.calibration
    }

    /// Returns whether the view is the original itself.
    pub fn is_original(&self) -> bool {
        self.camera.lens().is_ideal()
    }

    /// Returns the place in the original picture of a point of the view.
    pub fn original_from_undistorted(&self, point: Point) -> Option<Point> {
        if self.is_original() {
            return Some(point);
        }
        self.camera.image_from_ray(&(self.inverse * Vector3::new(point.x, point.y, 1.0)))
    }

    /// Returns the place in the view of a point of the original picture. The place may lie outside
    /// the frame of the view.
    pub fn undistorted_from_original(&self, point: Point) -> Option<Point> {
        if self.is_original() {
            return Some(point);
        }
        let ray = self.camera.ray_from_image(point).filter(|ray| ray.z > 0.0)?;
        crate::geometry::finite_point(&(self.calibration * ray))
    }

    /// Returns a view that a file describes, seen by the camera of this view. `None` if the camera has another
    /// lens or other pictures than the described one.
    pub(super) fn adopting(&self, described: &Self) -> Option<Self> {
        let (right, bottom) = (self.original.right(), self.original.bottom());
        let shares = (0..=GRID).map(|k| f64::from(k) / f64::from(GRID));
        let mut places =
            shares.clone().flat_map(|s| shares.clone().map(move |t| Point::new(s * right, t * bottom)));
        // Without distortion, at the scale of the picture.
        let flat = |view: &Self, place: Point| {
            let ray = view.camera.ray_from_image(place).filter(|ray| ray.z > 0.0)?;
            let own = view.camera.calibration();
            Some(Vector2::new(own[(0, 0)] * ray.x / ray.z, own[(1, 1)] * ray.y / ray.z))
        };
        let is_near = |place: Point| match [self, described].map(|view| flat(view, place)) {
            [Some(own), Some(other)] => (own - other).norm() < SAME_PLACE,
            [None, None] => true,
            _ => false,
        };
        if self.original != described.original || !places.all(is_near) {
            return None;
        }
        // The same view belongs to a camera of any focal length.
        let by = self.camera.calibration()[(0, 0)] / described.camera.calibration()[(0, 0)];
        let calibration = described.calibration * Matrix3::from_diagonal(&Vector3::new(by, by, 1.0));
        Self::described(self.camera, self.original, calibration, described.frame)
    }

    /// Returns the place in the original picture whose value a pixel of the view takes. Outside the
    /// picture, the nearest pixel of its border is taken: a black edge would have false corners.
    pub fn source_of(&self, point: Point) -> Option<Point> {
        let original = self.original_from_undistorted(point)?;
        let (right, bottom) = (self.original.right(), self.original.bottom());
        Some(Point::new(original.x.clamp(0.0, right), original.y.clamp(0.0, bottom)))
    }
}

impl Serialize for UndistortedView {
    /// Writes the calibration matrix as nested rows, the size, the size and the camera of the original with
    /// the name and the coefficients of its lens model, and the relative standard deviation of a guessed focal
    /// length.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows = |m: &Matrix3<f64>| m.transpose().data.0;
        let (model, coefficients) = self.camera.lens().named();
        let original_matrix = self.camera.calibration();
        let mut state = serializer.serialize_struct("UndistortedView", 12)?;
        state.serialize_field("model", model.name())?;
        state.serialize_field("coefficients", &coefficients)?;
        state.serialize_field("centre", &[original_matrix[(0, 2)], original_matrix[(1, 2)]])?;
        state.serialize_field("matrix", &rows(&self.calibration))?;
        state.serialize_field("width", &self.frame.width)?;
        state.serialize_field("height", &self.frame.height)?;
        state.serialize_field("original_width", &self.original.width)?;
        state.serialize_field("original_height", &self.original.height)?;
        state.serialize_field("original_matrix", &rows(&original_matrix))?;
        state.serialize_field("lens", self.camera.lens())?;
        state.serialize_field("is_original", &self.is_original())?;
        state.serialize_field("focal_deviation", &self.camera.focal_deviation())?;
        state.end()
    }
}

/// Returns points along the border of an image.
fn outline(frame: Frame) -> impl Iterator<Item = Point> {
    let (right, bottom) = (frame.right(), frame.bottom());
    (0..SAMPLES).map(|k| f64::from(k) / f64::from(SAMPLES)).flat_map(move |t| {
        [
            Point::new(t * right, 0.0),
            Point::new(right, t * bottom),
            Point::new(right - t * right, bottom),
            Point::new(0.0, bottom - t * bottom),
        ]
    })
}
