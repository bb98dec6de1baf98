//! The frames of a static camera.

use std::fmt;

use super::MotionError;
use crate::geometry::Frame;
use crate::image::GrayPlane;

/// Minimum number of frames. Fewer frames cannot tell lines apart.
pub const FEWEST_FRAMES: usize = 16;
/// Longer side at which frames are kept, px. Silhouettes need no finer resolution, and 300 frames
/// take 92 MB.
pub const LONGEST_SIDE: usize = 640;

/// Grey frames of one size, reduced to [`LONGEST_SIDE`].
#[derive(Clone, PartialEq)]
pub struct FrameSequence {
    name: String,
    full_size: Frame,
    size: Frame,
    frames: Vec<Vec<u8>>,
}

/// Omits the pixels, of which there are millions.
impl fmt::Debug for FrameSequence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, size, full_size, frames } = self;
        let mut shown = f.debug_struct("FrameSequence");
        shown.field("name", name).field("size", size).field("full_size", full_size);
        shown.field("frames", &frames.len()).finish()
    }
}

impl FrameSequence {
    /// Creates an empty sequence. The name appears in messages.
    pub fn new(name: impl Into<String>) -> Self {
        let nothing = Frame::new(0, 0);
        Self { name: name.into(), full_size: nothing, size: nothing, frames: Vec::new() }
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// Fails when the size differs from that of the first frame.
    pub fn push(&mut self, plane: &GrayPlane) -> Result<(), MotionError> {
        let frame = plane.frame();
        if self.frames.is_empty() {
            self.full_size = frame;
            self.size = reduced(frame);
        } else if frame != self.full_size {
            let (name, number) = (self.name.clone(), self.frames.len());
            return Err(MotionError::FrameSize {
                name,
                frame: number,
                width: frame.width,
                height: frame.height,
                first_width: self.full_size.width,
                first_height: self.full_size.height,
            });
        }
        self.frames.push(resampled(plane, self.size));
        Ok(())
    }

    /// Repeats the last frame in place of a missing frame, so that later frames keep their times.
    pub fn repeat_last(&mut self) {
        if let Some(last) = self.frames.last().cloned() {
            self.frames.push(last);
        }
    }

    /// Returns the name for messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Returns whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Returns the size of the frames as kept, px.
    pub fn size(&self) -> Frame {
        self.size
    }

    /// Returns the size of the frames as recorded, px.
    pub fn full_size(&self) -> Frame {
        self.full_size
    }

    /// Returns the grey levels of a frame as kept, row by row.
    ///
    /// # Panics
    /// Panics if there is no such frame.
    pub fn frame(&self, number: usize) -> &[u8] {
        &self.frames[number]
    }
}

/// Returns the size at which frames are kept.
fn reduced(full: Frame) -> Frame {
    let longer = full.width.max(full.height);
    if longer <= LONGEST_SIDE {
        return full;
    }
    let side = |length: usize| (length * LONGEST_SIDE).div_ceil(longer).max(1);
    Frame::new(side(full.width), side(full.height))
}

/// Averages the plane over the area of each pixel of the smaller size.
fn resampled(plane: &GrayPlane, size: Frame) -> Vec<u8> {
    let full = plane.frame();
    if full == size {
        return plane.values().iter().map(|v| v.round().clamp(0.0, 255.0) as u8).collect();
    }
    let bounds = |k: usize, of: usize, from: usize| (k * from / of, ((k + 1) * from).div_ceil(of).min(from));
    let mut values = Vec::with_capacity(size.width * size.height);
    for y in 0..size.height {
        let (top, bottom) = bounds(y, size.height, full.height);
        for x in 0..size.width {
            let (left, right) = bounds(x, size.width, full.width);
            let sum: f32 = (top..bottom).map(|row| plane.row(row)[left..right].iter().sum::<f32>()).sum();
            let mean = sum / ((bottom - top) * (right - left)) as f32;
            values.push(mean.round().clamp(0.0, 255.0) as u8);
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_of_one_size_and_large_ones_are_reduced() {
        let mut sequence = FrameSequence::new("left");
        let plane = GrayPlane::from_fn(Frame::new(1280, 720), |x, _| (x / 8) as f32);
        sequence.push(&plane).unwrap();
        assert_eq!((sequence.size(), sequence.full_size()), (Frame::new(640, 360), plane.frame()));
        assert_eq!(sequence.frame(0)[320], 80);
        let other = GrayPlane::from_fn(Frame::new(640, 360), |_, _| 0.0);
        let told = sequence.push(&other).unwrap_err().to_string();
        assert_eq!(
            told,
            "frame 1 of left is 640×360 px, but the first frame is 1280×720 px. All frames must have the same size"
        );
        sequence.repeat_last();
        assert_eq!(sequence.len(), 2);
        assert_eq!(sequence.frame(0), sequence.frame(1));
    }
}
