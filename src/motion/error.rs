//! Errors of computing motion barcodes.

use thiserror::Error;

/// The reason why a sequence has no usable barcodes. Each message is one sentence and suggests a
/// remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MotionError {
    /// The sequence has too few frames.
    #[error("{name} has {frames}, but at least {least} frames are needed", frames = counted(*found))]
    TooFewFrames {
        /// Name of the sequence.
        name: String,
        /// Number of frames found.
        found: usize,
        /// Number of frames needed.
        least: usize,
    },
    /// The size of a frame differs from the size of the first frame.
    #[error(
        "frame {frame} of {name} is {width}×{height} px, but the first frame is {first_width}×{first_height} px. All frames must have the same size"
    )]
    FrameSize {
        /// Name of the sequence.
        name: String,
        /// Number of the frame, from 0.
        frame: usize,
        /// Width of the frame, px.
        width: usize,
        /// Height of the frame, px.
        height: usize,
        /// Width of the first frame, px.
        first_width: usize,
        /// Height of the first frame, px.
        first_height: usize,
    },
    /// Hardly any pixel moves in the sequence of this name.
    #[error("nothing moves in {0}. Motion barcodes need objects that move in front of a stationary camera")]
    NothingMoves(String),
    /// More than half of the pixels move, so there is no background.
    #[error(
        "{percent} % of the pixels of {name} change nearly all the time, so no background is visible. Something covers most of the picture, or the light flickers"
    )]
    EverythingMoves {
        /// Name of the sequence.
        name: String,
        /// Percentage of moving pixels.
        percent: u32,
    },
    /// The camera is not static.
    #[error(
        "the camera of {name} moves: the background is shifted by {shift:.1} px in half of the frames. Motion barcodes need a stationary camera or a stabilised recording"
    )]
    CameraMoves {
        /// Name of the sequence.
        name: String,
        /// Median shift, px of the compared frames.
        shift: f64,
    },
    /// The sequences have too few frames in common.
    #[error(
        "at the offset {offset} the sequences have {common} frames in common, but at least {least} are needed"
    )]
    NoOverlap {
        /// Offset of the second sequence, frames.
        offset: i32,
        /// Number of frames in common.
        common: usize,
        /// Number of frames needed.
        least: usize,
    },
    /// The computation was cancelled.
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
