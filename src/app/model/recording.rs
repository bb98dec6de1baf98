//! Two sequences in place of two pictures: their frames and what moves in them, how they lie in time, which frames are
//! shown.

use std::sync::Arc;

use super::shared::Shared;
use crate::cancel::CancelFlag;
use crate::geometry::AnchoredLine;
use crate::motion::{
    BackgroundParameters, Barcode, FrameSequence, MotionError, OffsetAgreement, Silhouettes, common_frames,
};

/// The sequence of one camera.
#[derive(Debug)]
pub struct Recording {
    /// The frames.
    pub sequence: FrameSequence,
    /// What moves in them.
    pub silhouettes: Silhouettes,
}

impl Recording {
    /// Tells what moves in a sequence. Takes a while.
    pub fn new(sequence: FrameSequence, cancel: &CancelFlag) -> Result<Self, MotionError> {
        let silhouettes = Silhouettes::new(&sequence, &BackgroundParameters::default(), cancel)?;
        Ok(Self { sequence, silhouettes })
    }
}

/// The sequences of the left and the right camera.
pub type Recordings = [Shared<Recording>; 2];

/// Two sequences, and how they lie in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Synchronised {
    /// The sequences.
    pub recordings: Recordings,
    /// Frame `k` of the left one was taken together with frame `k + offset` of the right one.
    pub offset: i32,
}

impl Synchronised {
    /// What moves in the frames that both have.
    pub fn overlapping(&self) -> Result<[Arc<Silhouettes>; 2], MotionError> {
        let [left, right] = self.recordings.each_ref().map(|recording| &recording.silhouettes);
        Ok(Silhouettes::overlapping([left, right], self.offset)?.map(Arc::new))
    }

    /// The first frame in common of either sequence, and how many there are.
    pub(super) fn in_common(&self) -> ([usize; 2], usize) {
        common_frames(self.recordings.each_ref().map(|recording| recording.sequence.len()), self.offset)
    }

    /// The barcodes of two lines, full-size pixels.
    pub fn barcodes(&self, lines: &[AnchoredLine; 2]) -> InspectedBarcodes {
        let (first, count) = self.in_common();
        let barcode = |k: usize| {
            let silhouettes = &self.recordings[k].silhouettes;
            let scale = silhouettes.full_size().width as f64 / silhouettes.size().width as f64;
            silhouettes.barcode(&lines[k], scale).part(first[k], count)
        };
        InspectedBarcodes { first: first[0], barcodes: [barcode(0), barcode(1)] }
    }
}

/// The barcodes of the inspected line pair, in the frames that both sequences have.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectedBarcodes {
    /// The frame of the left sequence that they begin with.
    pub first: usize,
    /// Barcodes of the left and the right line.
    pub barcodes: [Barcode; 2],
}

impl InspectedBarcodes {
    /// Their normalised cross-correlation; `None` where one of them is nearly constant.
    pub fn correlation(&self) -> Option<f64> {
        let [left, right] = &self.barcodes;
        left.correlation(right)
    }
}

/// Something to do with the sequences that are open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlayerCommand {
    /// Play them, or pause.
    TogglePlay,
    /// Go so many frames on, or back.
    Step(i32),
    /// Show this frame of the left sequence, and the one of the right sequence that goes with it.
    Seek(usize),
    /// Show what moves, or not.
    ToggleSilhouettes,
    /// Shift the right sequence in time: frame `k` of the left one goes with frame `k` plus this of the right one.
    SetOffset(i32),
    /// Find out how the sequences are shifted in time.
    FindOffset,
}

/// Which frames are shown, and how.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Player {
    /// The frame of the left sequence; between two of them while they are played.
    pub(super) position: f64,
    /// Whether they are being played.
    pub playing: bool,
    /// Whether what moves is marked.
    pub silhouettes: bool,
}

/// The offsets at which two sequences agree, best first.
#[derive(Debug)]
pub struct OffsetFound {
    /// The sequences.
    pub recordings: Recordings,
    /// What was found.
    pub outcome: Result<Vec<OffsetAgreement>, MotionError>,
}

/// A small sequence with something that moves.
#[cfg(test)]
#[expect(clippy::missing_panics_doc, reason = "for tests")]
pub fn example(frames: usize) -> Recording {
    use crate::geometry::Frame;
    use crate::synthetic::{BallScene, ThrownBalls};
    let thrown = ThrownBalls { frame: Frame::new(160, 120), frames, noise: 1.0, ..ThrownBalls::default() };
    let [left, _] = BallScene::new(thrown).unwrap().sequences().unwrap();
    Recording::new(left, &CancelFlag::default()).unwrap()
}
