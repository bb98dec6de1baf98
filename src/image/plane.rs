//! Grey images of floating-point intensities.

use std::sync::Arc;

use crate::geometry::{Frame, Point};

/// A grey image, row-major, intensities in grey levels `0 ..= 255` whatever the depth of the file. Copies share the
/// values.
#[derive(Debug, Clone, PartialEq)]
pub struct GrayPlane {
    frame: Frame,
    values: Arc<[f32]>,
}

impl GrayPlane {
    /// A plane from row-major values.
    ///
    /// # Panics
    /// When the number of values is not `width × height`: a programming error.
    pub fn new(frame: Frame, values: Vec<f32>) -> Self {
        Self::shared(frame, values.into())
    }

    /// [`GrayPlane::new`] of values that are shared already.
    pub(super) fn shared(frame: Frame, values: Arc<[f32]>) -> Self {
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

    /// Width and height.
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
        let (right, bottom) = (self.frame.right().max(0.0) as f32, self.frame.bottom().max(0.0) as f32);
        self.interpolate((p.x as f32).clamp(0.0, right), (p.y as f32).clamp(0.0, bottom))
    }

    /// Bilinear interpolation at a position inside the sampling rectangle, for loops that have made sure of it.
    /// `f32` holds 1/1000 px over the largest images.
    #[inline]
    pub(crate) fn interpolate(&self, x: f32, y: f32) -> f32 {
        let Frame { width, height } = self.frame;
        if width < 2 || height < 2 {
            return self.at(x as usize, y as usize);
        }
        // The last column and row interpolate from the cell before them.
        let xi = (x as usize).min(width - 2);
        let yi = (y as usize).min(height - 2);
        let (fx, fy) = (x - xi as f32, y - yi as f32);
        let i = yi * width + xi;
        let (top, below) = (&self.values[i..i + 2], &self.values[i + width..i + width + 2]);
        let a = top[0] + (top[1] - top[0]) * fx;
        let b = below[0] + (below[1] - below[0]) * fx;
        a + (b - a) * fy
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
