//! Sizes of rectified pictures and their limit.

use super::RectifyError;
use crate::geometry::Frame;

/// No picture is wider or higher than this, px: more than most programs open.
const LONGEST_SIDE: f64 = 60_000.0;

/// Range of numbers, from low to high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Range {
    /// The range of some numbers; empty when there are none.
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        values.fold(Self { low: f64::INFINITY, high: f64::NEG_INFINITY }, |r, v| Self {
            low: r.low.min(v),
            high: r.high.max(v),
        })
    }

    pub(super) fn length(&self) -> f64 {
        (self.high - self.low).max(0.0)
    }

    /// What two ranges share.
    pub(super) fn common(&self, other: &Self) -> Option<Self> {
        let common = Self { low: self.low.max(other.low), high: self.high.min(other.high) };
        (common.low < common.high).then_some(common)
    }
}

/// Range from the first to the last pixel centre of a picture, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Extent {
    /// The size of a picture of at most `limit` pixels, and by which factor it is smaller than wanted (1: as wanted).
    pub(super) fn limited(self, limit: usize) -> Result<(Frame, f64), RectifyError> {
        if !(self.width.is_finite() && self.height.is_finite()) {
            return Err(RectifyError::NoCommonPlane);
        }
        // One pixel more than steps; the factor found is kept on the safe side by counting that pixel in.
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
            return Err(RectifyError::Limit { limit });
        }
        Ok((frame, factor))
    }
}
