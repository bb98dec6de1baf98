//! What moves in front of a camera that stands still: frames, silhouettes, and the motion barcodes of lines (paper,
//! section 2.3).
//!
//! A [`FrameSequence`] holds the frames, [`Silhouettes`] say which pixels of which frame show something that moves, and a
//! [`Barcode`] says in which frames a line is crossed by that: what two corresponding epipolar lines have in common,
//! however different the scene looks from the two places. [`find_offset`] finds how far two recordings are shifted
//! against each other.
//!
//! Nothing here reads a file.

mod background;
mod barcode;
mod error;
mod frame_motion;
mod offset;
mod sequence;
mod silhouettes;

pub use background::BackgroundParameters;
pub use barcode::{Barcode, FEWEST_CHANGES};
pub use error::MotionError;
pub use offset::{MOST_OFFSET, OffsetAgreement, find_offset};
pub use sequence::{FEWEST_FRAMES, FrameSequence, LONGEST_SIDE};
pub use silhouettes::{Silhouettes, common_frames};
