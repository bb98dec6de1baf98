//! Grey images of floating-point intensities.

use crate::geometry::{Frame, Point};

/// A grey image, row-major, intensities in grey levels `0 ..= 255` whatever the depth of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct GrayPlane {
    frame: Frame,
    values: Vec<f32>,
}

impl GrayPlane {
    /// A plane from row-major values.
    ///
    /// # Panics
    /// When the number of values is not `width × height`: a programming error.
    pub fn new(frame: Frame, values: Vec<f32>) -> Self {
        assert_eq!(values.len(), frame.width * frame.height, "one value a pixel");
        Self { frame, values }
    }

    /// A plane computed pixel by pixel from `(x, y)`.
    pub fn from_fn(frame: Frame, f: impl Fn(usize, usize) -> f32) -> Self {
        let values = (0..frame.height)
            .flat_map(|y| (0..frame.width).map(move |x| (x, y)))
            .map(|(x, y)| f(x, y))
            .collect();
        Self { frame, values }
    }

    /// Its size.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// All values, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// One row.
    pub fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.frame.width..(y + 1) * self.frame.width]
    }

    /// The value of a pixel.
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.values[y * self.frame.width + x]
    }

    /// Bilinear interpolation; positions outside the sampling rectangle take the nearest border value.
    pub fn sample(&self, p: Point) -> f32 {
        let x = p.x.clamp(0.0, self.frame.right().max(0.0));
        let y = p.y.clamp(0.0, self.frame.bottom().max(0.0));
        let (x0, y0) = (x as usize, y as usize);
        let x1 = (x0 + 1).min(self.frame.width - 1);
        let y1 = (y0 + 1).min(self.frame.height - 1);
        let (fx, fy) = ((x - x0 as f64) as f32, (y - y0 as f64) as f32);
        let top = self.at(x0, y0) * (1.0 - fx) + self.at(x1, y0) * fx;
        let bottom = self.at(x0, y1) * (1.0 - fx) + self.at(x1, y1) * fx;
        top * (1.0 - fy) + bottom * fy
    }

    /// Standard deviation of all values, grey levels: near zero for a flat image.
    pub fn contrast(&self) -> f64 {
        let n = self.values.len().max(1) as f64;
        let mean = self.values.iter().map(|v| f64::from(*v)).sum::<f64>() / n;
        let variance = self.values.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / n;
        variance.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_between_pixel_centres_and_clamps_outside() {
        let plane = GrayPlane::from_fn(Frame::new(3, 2), |x, y| (10 * x + 100 * y) as f32);
        assert!((plane.sample(Point::new(1.5, 0.5)) - 65.0).abs() < 1e-5);
        assert!((plane.sample(Point::new(-4.0, 9.0)) - 100.0).abs() < 1e-5);
        assert!((plane.sample(Point::new(2.0, 1.0)) - 120.0).abs() < 1e-5);
    }
}
