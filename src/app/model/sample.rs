//! The built-in pair shown at the start, and the built-in sequences.

use super::picture::Opened;
use super::recording::Recording;
use crate::cancel::CancelFlag;
use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::{GroundTruth, SequenceFile, TruthOrigin};
use crate::motion::{FrameSequence, MotionError};
use crate::synthetic::{BallScene, Sample, ThrownBalls};

/// Name of the built-in sequences in sessions.
pub const SAMPLE_SEQUENCES: &str = "balls";

/// Number of true matches of the built-in sequences.
const MATCHES: usize = 200;

/// Two pictures, and the point pairs that "Show me" places.
pub struct OpenedSample {
    /// The pictures.
    pub pictures: [Picture; 2],
    /// Pairs known to give a good result.
    pub show_me: [PointPair; 2],
    /// The exact geometry. It has the name of the sample.
    pub truth: GroundTruth,
}

/// Loads the default sample.
pub fn sample_pair() -> OpenedSample {
    let name = Sample::default().name().to_owned();
    let sample = Sample::default().load();
    let (fundamental, matches) = (sample.fundamental, sample.matches);
    let truth = GroundTruth { name, fundamental, matches, origin: TruthOrigin::Cameras };
    OpenedSample { pictures: sample.pictures, show_me: sample.show_me, truth }
}

/// Two sequences with their exact geometry.
pub struct SampleRecordings {
    /// First pictures and sequences of both sides.
    pub pictures: [Opened; 2],
    /// The exact geometry. It has the name of the sequences in sessions.
    pub truth: GroundTruth,
}

/// Draws the built-in sequences: balls thrown about in a yard. This takes a second or two.
///
/// # Panics
/// Never: the frames have pixels, and the cameras have different centres. A test opens the scene.
pub fn sample_recordings(cancel: &CancelFlag) -> Result<SampleRecordings, MotionError> {
    let scene = BallScene::new(ThrownBalls::default()).expect("the frames have pixels");
    let fundamental = scene.fundamental().expect("the cameras have different centres");
    let matches = scene.matches(MATCHES);
    let [left, right] = scene.sequences().expect("the cameras see the yard");
    let opened = |sequence: FrameSequence| -> Result<Opened, MotionError> {
        let made = SequenceFile::made(sequence).expect("the frames have pixels");
        Ok(Opened::recorded(made.first, Recording::new(made.sequence, cancel)?))
    };
    let truth =
        GroundTruth { name: SAMPLE_SEQUENCES.to_owned(), fundamental, matches, origin: TruthOrigin::Cameras };
    Ok(SampleRecordings { pictures: [opened(left)?, opened(right)?], truth })
}
