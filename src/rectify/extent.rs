//! Sizes of rectified pictures under the pixel limit.

use super::RectifyError;
use crate::geometry::Frame;

/// Longest side of a picture, px. Most programs do not open longer ones.
const LONGEST_SIDE: f64 = 60_000.0;

/// Interval of numbers from `low` to `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Range {
    /// Returns the range of `values`; its length is 0 when there are none.
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        values.fold(Self { low: f64::INFINITY, high: f64::NEG_INFINITY }, |r, v| Self {
            low: r.low.min(v),
            high: r.high.max(v),
        })
    }

    pub(super) fn length(&self) -> f64 {
        (self.high - self.low).max(0.0)
    }

    /// Returns the intersection of two ranges, `None` if it is empty.
    pub(super) fn common(&self, other: &Self) -> Option<Self> {
        let common = Self { low: self.low.max(other.low), high: self.high.min(other.high) };
        (common.low < common.high).then_some(common)
    }
}

/// Distance from the first to the last pixel centre of a picture, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Extent {
    /// Returns the largest size of at most `limit` pixels and the factor of reduction (1: full
    /// size).
    pub(super) fn limited(self, limit: usize) -> Result<(Frame, f64), RectifyError> {
        if !(self.width.is_finite() && self.height.is_finite()) {
            return Err(RectifyError::NoCommonPlane);
        }
        // A picture has one pixel more than steps. Counting this pixel keeps the factor on the safe
        // side.
        let (width, height) = (self.width + 1.0, self.height + 1.0);
        let mut factor = (limit as f64 / (width * height)).sqrt().min(1.0);
        factor = factor.min(LONGEST_SIDE / width).min(LONGEST_SIDE / height);
        let pixels = |length: f64| (length * factor + 1e-6).floor() as usize + 1;
        let mut frame = Frame::new(pixels(self.width), pixels(self.height));
        while frame.width * frame.height > limit {
            let longer = if frame.width > frame.height { &mut frame.width } else { &mut frame.height };
            *longer -= 1;
        }
        if frame.width < 2 || frame.height < 2 {
            return Err(RectifyError::Limit(limit));
        }
        Ok((frame, factor))
    }
}
