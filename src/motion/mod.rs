//! Moving objects in front of a static camera: frames, silhouettes, and the motion barcodes of
//! lines (paper, section 2.3).
//!
//! A [`FrameSequence`] holds the frames; [`Silhouettes`] mark the moving pixels of each frame. A
//! [`Barcode`] marks the frames in which moving objects cross a line. Corresponding epipolar lines
//! have similar barcodes, however different the views. [`find_offset`] estimates the time offset of
//! two recordings.
//!
//! This module reads no files.

mod background;
mod barcode;
mod error;
mod frame_motion;
mod offset;
mod sequence;
mod silhouettes;

pub use background::BackgroundParameters;
pub use barcode::Barcode;
pub use error::MotionError;
pub use offset::{MOST_OFFSET, OffsetAgreement, clear_offset, find_offset};
pub use sequence::{FEWEST_FRAMES, FrameSequence, LONGEST_SIDE};
pub use silhouettes::{Silhouettes, common_frames};
