//! What keeps a sequence of frames from having barcodes.

use thiserror::Error;

/// A sequence in which nothing can be compared. Each message is one sentence and says what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MotionError {
    /// Too few frames.
    #[error("{name} has {frames}, at least {least} frames are needed", frames = counted(*found))]
    TooFewFrames {
        /// The sequence.
        name: String,
        /// Frames it has.
        found: usize,
        /// Frames needed.
        least: usize,
    },
    /// A frame is not as large as the first one.
    #[error(
        "frame {frame} of {name} is {width}×{height} px, but the first one is {first_width}×{first_height} px: all frames must be of one size"
    )]
    FrameSize {
        /// The sequence.
        name: String,
        /// Number of the frame, from 0.
        frame: usize,
        /// Width of the frame, px.
        width: usize,
        /// Height of the frame, px.
        height: usize,
        /// Size of the first one, px.
        first_width: usize,
        /// Size of the first one, px.
        first_height: usize,
    },
    /// Nothing moves.
    #[error(
        "nothing moves in {name}: motion barcodes need things that move in front of a camera that stands still"
    )]
    NothingMoves {
        /// The sequence.
        name: String,
    },
    /// Everything moves.
    #[error(
        "{percent} % of the pixels of {name} show something that moves nearly all the time, so that there is no background: something covers most of the picture, or the light flickers"
    )]
    EverythingMoves {
        /// The sequence.
        name: String,
        /// Percent of the pixels.
        percent: u32,
    },
    /// The camera moves.
    #[error(
        "the camera of {name} moves: its background is shifted by {shift:.1} px in half of the frames; motion barcodes need a camera that stands still, or a recording that was stabilised"
    )]
    CameraMoves {
        /// The sequence.
        name: String,
        /// Median shift, px of the frames as they are compared.
        shift: f64,
    },
    /// The sequences have too few frames in common.
    #[error(
        "at an offset of {offset} the sequences have {common} frames in common, at least {least} are needed"
    )]
    NoOverlap {
        /// The offset, frames.
        offset: i32,
        /// Frames in common.
        common: usize,
        /// Frames needed.
        least: usize,
    },
    /// A stop was asked for.
    #[error("the comparison was stopped")]
    Cancelled,
}

impl From<crate::cancel::Cancelled> for MotionError {
    fn from(_: crate::cancel::Cancelled) -> Self {
        Self::Cancelled
    }
}

fn counted(frames: usize) -> String {
    if frames == 1 { "1 frame".into() } else { format!("{frames} frames") }
}
