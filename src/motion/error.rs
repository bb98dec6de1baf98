//! Errors of computing motion barcodes.

use thiserror::Error;

/// The reason why a sequence has no usable barcodes. Each message is one sentence and suggests a
/// remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MotionError {
    /// The sequence has too few frames.
    #[error("{name} has {frames}, but at least {least} frames are needed", frames = counted(*found))]
    TooFewFrames { name: String, found: usize, least: usize },
    /// The size of a frame, numbered from 0, differs from the size of the first frame.
    #[error(
        "frame {frame} of {name} is {width}×{height} px, but the first frame is {first_width}×{first_height} px. All frames must have the same size"
    )]
    FrameSize {
        name: String,
        frame: usize,
        width: usize,
        height: usize,
        first_width: usize,
        first_height: usize,
    },
    /// Hardly any pixel moves in the sequence of this name.
    #[error("nothing moves in {0}. Motion barcodes need objects that move in front of a stationary camera")]
    NothingMoves(String),
    /// More than half of the pixels move, so there is no background.
    #[error(
        "{percent} % of the pixels of {name} change nearly all the time, so no background is visible. Something covers most of the picture, or the light flickers"
    )]
    EverythingMoves { name: String, percent: u32 },
    /// The camera is not static: the median shift, px of the compared frames.
    #[error(
        "the camera of {name} moves: the background is shifted by {shift:.1} px in half of the frames. Motion barcodes need a stationary camera or a stabilised recording"
    )]
    CameraMoves { name: String, shift: f64 },
    /// The sequences have too few frames in common at this offset of the second one.
    #[error(
        "at the offset {offset} the sequences have {common} frames in common, but at least {least} are needed"
    )]
    NoOverlap { offset: i32, common: usize, least: usize },
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
