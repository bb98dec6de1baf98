//! Intensity profiles along lines.

use super::plane::{GrayPlane, interpolate_all};
use crate::geometry::AnchoredLine;
use crate::lanes::LANES;

/// Number of samples taken at once.
const BLOCK: usize = 4 * LANES;

/// Intensities at equidistant points of a line, in grey levels rounded to 8 bits. Index 0 is the
/// anchor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Profile {
    /// Index of the first sample, negative when the line enters the image before its anchor.
    pub first: i32,
    /// Samples in grey levels.
    pub values: Vec<u8>,
}

impl Profile {
    /// Samples a line every `step` px by bilinear interpolation. The profile is empty when the line
    /// misses the image.
    pub fn sample(plane: &GrayPlane, line: &AnchoredLine, step: f64) -> Self {
        let Some((first, last)) = line.index_range(plane.frame(), step) else {
            return Self { first: 0, values: Vec::new() };
        };
        let (right, bottom) = (plane.frame().right() as f32, plane.frame().bottom() as f32);
        // Relative to the first sample, `f32` resolves 1/1000 px over the longest line of the
        // largest image.
        let start = line.point_at(f64::from(first) * step);
        let (x0, y0) = (start.x as f32, start.y as f32);
        let (dx, dy) = ((line.direction.x * step) as f32, (line.direction.y * step) as f32);
        let count = (last - first).saturating_add(1).max(0) as usize;
        let mut values = Vec::with_capacity(count);
        let (mut x, mut y, mut found) = ([0f32; BLOCK], [0f32; BLOCK], [0f32; BLOCK]);
        for block in (0..count).step_by(BLOCK) {
            for k in 0..BLOCK {
                let along = (block + k) as f32;
                x[k] = (x0 + dx * along).clamp(0.0, right);
                y[k] = (y0 + dy * along).clamp(0.0, bottom);
            }
            interpolate_all(plane, &x, &y, &mut found);
            values.extend(found[..BLOCK.min(count - block)].iter().map(|value| (value + 0.5) as u8));
        }
        Self { first, values }
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns whether the line misses the image.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Returns the sample with the given index, if any.
    pub fn get(&self, index: i32) -> Option<u8> {
        let offset = usize::try_from(index.checked_sub(self.first)?).ok()?;
        self.values.get(offset).copied()
    }

    /// Returns the index after the last sample.
    pub fn end(&self) -> i32 {
        self.first + self.values.len() as i32
    }

    /// Returns the mean absolute difference of neighbouring samples in grey levels, a measure of
    /// texture.
    pub fn texture(&self) -> f64 {
        let sum: u32 = self.values.windows(2).map(|w| u32::from(w[0].abs_diff(w[1]))).sum();
        f64::from(sum) / self.values.len().saturating_sub(1).max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Frame, Point};

    #[test]
    fn samples_a_ramp_exactly_with_the_anchor_at_index_zero() {
        let plane = GrayPlane::from_fn(Frame::new(60, 40), |x, y| (2 * x + y) as f32);
        let anchor = Point::new(20.0, 10.0);
        for k in 0..24 {
            let line = AnchoredLine::at_angle(anchor, f64::from(k) * 0.26);
            let profile = Profile::sample(&plane, &line, 1.0);
            assert_eq!(profile.get(0), Some(50));
            for index in profile.first..profile.end() {
                let p = line.point_at(f64::from(index));
                let expected = 2.0 * p.x + p.y;
                let value = f64::from(profile.get(index).unwrap());
                assert!((value - expected).abs() < 0.51, "{value} {expected}");
            }
        }
    }

    #[test]
    fn lines_that_miss_the_image_are_empty() {
        let plane = GrayPlane::from_fn(Frame::new(60, 40), |_, _| 9.0);
        let line = AnchoredLine::at_angle(Point::new(-5.0, -5.0), 2.0);
        assert!(Profile::sample(&plane, &line, 1.0).is_empty());
        let profile = Profile::sample(&plane, &AnchoredLine::at_angle(Point::new(-5.0, 4.0), 0.0), 1.0);
        assert_eq!((profile.first, profile.len()), (5, 60));
        assert!(profile.texture() < 1e-12);
    }
}
