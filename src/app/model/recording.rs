//! Two sequences in place of two pictures: frames, silhouettes, time offset and visible frames.

use std::sync::Arc;

use super::shared::Shared;
use crate::cancel::CancelFlag;
use crate::geometry::AnchoredLine;
use crate::motion::{
    BackgroundParameters, Barcode, FrameSequence, MotionError, OffsetAgreement, Silhouettes, common_frames,
};

/// Largest number of frames in a [`Pile`].
const PILED: usize = 32;
/// Longest side of the silhouettes of a [`Pile`], px.
const PILE_SIDE: usize = 320;

#[derive(Debug)]
pub struct Recording {
    pub sequence: FrameSequence,
    /// Moving parts of the frames.
    pub silhouettes: Silhouettes,
    pub pile: Pile,
}

/// Silhouettes of some frames, small, for an overview of the motion.
#[derive(Debug)]
pub struct Pile {
    /// Numbers of the frames, evenly spread.
    frames: Vec<usize>,
    pub silhouettes: Silhouettes,
}

impl Pile {
    fn of(silhouettes: &Silhouettes) -> Self {
        let kept = silhouettes.len().min(PILED);
        let frames: Vec<usize> = (0..kept).map(|k| k * silhouettes.len() / kept).collect();
        let mut few = silhouettes.at_times(&frames);
        while few.size().width.max(few.size().height) > PILE_SIDE {
            few = few.halved();
        }
        Self { frames, silhouettes: few }
    }

    /// Returns the number of silhouettes up to a frame.
    pub fn until(&self, frame: usize) -> usize {
        self.frames.partition_point(|own| *own <= frame)
    }
}

impl Recording {
    /// Finds the silhouettes of a sequence. This takes a while.
    pub fn new(sequence: FrameSequence, cancel: &CancelFlag) -> Result<Self, MotionError> {
        let silhouettes = Silhouettes::new(&sequence, &BackgroundParameters::default(), cancel)?;
        let pile = Pile::of(&silhouettes);
        Ok(Self { sequence, silhouettes, pile })
    }
}

/// The sequences of the left and the right camera.
pub type Recordings = [Shared<Recording>; 2];

/// Two sequences with their time offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Synchronised {
    pub recordings: Recordings,
    /// Frame `k` of the left sequence belongs with frame `k + offset` of the right one.
    pub offset: i32,
}

impl Synchronised {
    /// Returns the silhouettes of the frames that both sequences have.
    pub fn overlapping(&self) -> Result<[Arc<Silhouettes>; 2], MotionError> {
        let [left, right] = self.recordings.each_ref().map(|recording| &recording.silhouettes);
        Ok(Silhouettes::overlapping([left, right], self.offset)?.map(Arc::new))
    }

    /// Returns the first common frame of each sequence, and the number of common frames.
    pub(super) fn in_common(&self) -> ([usize; 2], usize) {
        common_frames(self.recordings.each_ref().map(|recording| recording.sequence.len()), self.offset)
    }

    /// Returns the barcodes of two lines, given in full-size pixels.
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

/// Barcodes of the inspected line pair, over the frames that both sequences have.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectedBarcodes {
    /// First frame, by its number in the left sequence.
    pub first: usize,
    pub barcodes: [Barcode; 2],
}

impl InspectedBarcodes {
    /// Returns the normalised cross-correlation; `None` if a barcode is nearly constant.
    pub fn correlation(&self) -> Option<f64> {
        let [left, right] = &self.barcodes;
        left.correlation(right)
    }
}

/// A command about the open sequences.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlayerCommand {
    TogglePlay,
    /// Move forward by a number of frames, or back.
    Step(i32),
    /// Show this frame of the left sequence, and the matching frame of the right one.
    Seek(usize),
    /// Exchange the player and the timeline of the search, which have one place.
    Exchange,
    ToggleSilhouettes,
    /// Set the time offset: frame `k` of the left sequence belongs with frame `k + offset` of the
    /// right one.
    SetOffset(i32),
    FindOffset,
}

/// Visible frames, and their appearance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Player {
    /// Whether the timeline of the search is in the place of the player.
    pub gives_way: bool,
    /// Frame of the left sequence; fractional during playback.
    pub(super) position: f64,
    pub playing: bool,
    pub silhouettes: bool,
}

/// Two sequences, and the time offsets at which they agree, best first, or the reason why there are none.
pub type OffsetFound = (Recordings, Result<Vec<OffsetAgreement>, MotionError>);

/// Returns a small sequence with moving objects.
#[cfg(test)]
#[expect(clippy::missing_panics_doc, reason = "for tests")]
pub fn example(frames: usize) -> Recording {
    use crate::geometry::Frame;
    use crate::synthetic::{BallScene, ThrownBalls};
    let thrown = ThrownBalls { frame: Frame::new(160, 120), frames, noise: 1.0, ..ThrownBalls::default() };
    let [left, _] = BallScene::new(thrown).unwrap().sequences().unwrap();
    Recording::new(left, &CancelFlag::default()).unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pile_has_the_silhouettes_of_some_frames() {
        let recording = example(70);
        let pile = &recording.pile;
        assert_eq!((pile.silhouettes.len(), pile.frames[0], pile.frames[31]), (PILED, 0, 67));
        assert_eq!(pile.silhouettes.mask(5), recording.silhouettes.mask(pile.frames[5]), "small already");
        assert_eq!([0, 1, 2, 69].map(|frame| pile.until(frame)), [1, 1, 2, PILED]);
        assert_eq!(example(20).pile.frames.len(), 20);
    }
}
