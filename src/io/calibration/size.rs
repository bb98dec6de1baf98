//! Calibrations and the sizes of the pictures that they are for.

use super::CalibratedCamera;
use crate::foreign::excerpt;
use crate::geometry::{Frame, Point};

/// Largest difference between a resized picture and the exact size, px: both sides are rounded.
const ROUNDING: f64 = 1.0;

impl CalibratedCamera {
    /// Checks that an image has the size that the calibration is for.
    ///
    /// # Errors
    /// A clause for the user.
    pub fn check_frame(&self, frame: Frame) -> Result<(), String> {
        let Some(own) = self.frame.filter(|own| *own != frame) else { return Ok(()) };
        let calibration = self.model.calibration();
        let principal = Point::new(calibration[(0, 2)], calibration[(1, 2)]);
        let contradiction = if own.contains(principal) {
            String::new()
        } else {
            let Point { coords: at, .. } = principal;
            format!(
                ". Its principal point ({:.1}, {:.1}) lies outside its own size, so it may be for a third size",
                at.x, at.y
            )
        };
        Err(format!(
            "the calibration of {} is for images of {}×{} px, and this image has {}×{} px{contradiction}",
            excerpt(&self.name),
            own.width,
            own.height,
            frame.width,
            frame.height
        ))
    }

    /// Returns whether an image of this size may be a resized image of the calibration.
    pub fn is_resized_in(&self, frame: Frame) -> bool {
        self.frame.is_some_and(|own| own != frame && is_same_shape(own, frame))
    }

    /// Returns the calibration for images that were resized to another size.
    ///
    /// # Errors
    /// A clause for the user, if the size of the calibration is unknown or of another shape.
    pub fn resized_to(&self, frame: Frame) -> Result<Self, String> {
        let name = excerpt(&self.name);
        let Some(own) = self.frame else {
            return Err(format!("the calibration of {name} does not tell the size of its images"));
        };
        if own == frame || self.reading.other_sizes.iter().any(|camera| camera.frame == Some(frame)) {
            return Ok(self.clone());
        }
        if !is_same_shape(own, frame) {
            let told = self.check_frame(frame).err().unwrap_or_default();
            return Err(format!("{told}. Both sizes differ in shape, so it cannot be scaled"));
        }
        let by =
            [(frame.width, own.width), (frame.height, own.height)].map(|(to, from)| to as f64 / from as f64);
        let impossible = || format!("the calibration of {name} cannot be scaled");
        let model = self.model.resized(by).ok_or_else(impossible)?;
        let mut reading = self.reading.clone();
        reading.fisheye = reading.fisheye.and_then(|fisheye| fisheye.resized(by));
        Ok(Self { model, frame: Some(frame), reading, ..self.clone() })
    }
}

/// Returns whether two sizes differ by one factor, up to the rounding of each side.
fn is_same_shape(own: Frame, other: Frame) -> bool {
    let [w, h, to_w, to_h] = [own.width, own.height, other.width, other.height].map(|side| side as f64);
    let off = (to_w * h - to_h * w).abs();
    off <= ROUNDING * w.max(h).max(to_w).max(to_h)
}

#[cfg(test)]
mod tests {
    use super::super::Calibration;
    use super::*;

    fn camera(width: usize, height: usize, cx: f64, cy: f64) -> CalibratedCamera {
        let text = format!(
            "image_width: {width}\nimage_height: {height}\ncamera_matrix: [[500, 0, {cx}], [0, 505, {cy}], [0, 0, 1]]\n\
             distortion_coefficients: [-0.1, 0.01, 0, 0]\n"
        );
        Calibration::parse(&text).unwrap().cameras.remove(0)
    }

    #[test]
    fn a_calibration_of_another_size_is_told_and_scaled() {
        let whole = camera(640, 480, 320.0, 240.0);
        let half = Frame::new(320, 240);
        assert!(whole.check_frame(half).unwrap_err().contains("640×480"));
        assert!(whole.is_resized_in(half) && !whole.is_resized_in(Frame::new(640, 480)));
        let scaled = whole.resized_to(half).unwrap();
        let k = scaled.model.calibration();
        // Pixel centres: the middle of two pixels 0 and 1 becomes pixel 0.
        assert!((k[(0, 2)] - 159.75).abs() < 1e-9 && (k[(0, 0)] - 250.0).abs() < 1e-9, "{k}");
        assert!(scaled.check_frame(half).is_ok());
        // 1501×1001 halved is 750×500 or 751×501.
        assert!(camera(1501, 1001, 750.0, 500.0).resized_to(Frame::new(751, 501)).is_ok());
        let cropped = whole.resized_to(Frame::new(640, 400)).unwrap_err();
        assert!(cropped.contains("differ in shape"), "{cropped}");
    }

    #[test]
    fn a_calibration_that_contradicts_its_own_size_is_told() {
        let told = camera(320, 240, 634.9, 379.8).check_frame(Frame::new(640, 512)).unwrap_err();
        assert!(told.contains("principal point (634.9, 379.8) lies outside its own size"), "{told}");
    }
}
