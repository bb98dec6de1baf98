//! The built-in pair that the window opens on, and the built-in sequences.

use super::picture::Opened;
use super::recording::Recording;
use crate::cancel::CancelFlag;
use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::{GroundTruth, SequenceFile, TruthOrigin};
use crate::motion::{FrameSequence, MotionError};
use crate::synthetic::{BallScene, Sample, ThrownBalls};

/// What the built-in sequences are called in sessions.
pub const SAMPLE_SEQUENCES: &str = "balls";

/// True matches of the built-in sequences.
const MATCHES: usize = 200;
/// The matches among them that "Show me" places: far apart, and off each other's epipolar lines.
const SHOW_ME: [usize; 2] = [88, 179];

/// Two pictures and two point pairs that "Show me" places.
pub struct OpenedSample {
    /// The pictures.
    pub pictures: [Picture; 2],
    /// Pairs known to give a good result.
    pub show_me: [PointPair; 2],
    /// The exact geometry, named as the sample is.
    pub truth: GroundTruth,
}

/// The default one of the samples.
pub fn sample_pair() -> OpenedSample {
    let name = Sample::default().name().to_owned();
    let sample = Sample::default().load();
    let (fundamental, matches) = (sample.fundamental, sample.matches);
    let truth = GroundTruth { name, fundamental, matches, origin: TruthOrigin::Cameras };
    OpenedSample { pictures: sample.pictures, show_me: sample.show_me, truth }
}

/// Two sequences with their exact geometry, named as they are in sessions.
pub struct SampleRecordings {
    /// What is seen first, and the sequences.
    pub pictures: [Opened; 2],
    /// Pairs known to give a good result.
    pub show_me: [PointPair; 2],
    /// The geometry.
    pub truth: GroundTruth,
}

/// The built-in sequences: balls thrown about in a yard. They are drawn here, which takes a second or two.
///
/// # Panics
/// Never: its frames have pixels, and its cameras different centres; a test opens it.
pub fn sample_recordings(cancel: &CancelFlag) -> Result<SampleRecordings, MotionError> {
    let scene = BallScene::new(ThrownBalls::default()).expect("its frames have pixels");
    let fundamental = scene.fundamental().expect("its cameras have different centres");
    let matches = scene.matches(MATCHES);
    let show_me = SHOW_ME.map(|k| matches[k]);
    let [left, right] = scene.sequences().expect("its cameras see the yard");
    let opened = |sequence: FrameSequence| -> Result<Opened, MotionError> {
        let made = SequenceFile::made(sequence).expect("its frames have pixels");
        Ok(Opened::recorded(made.first, Recording::new(made.sequence, cancel)?))
    };
    let truth =
        GroundTruth { name: SAMPLE_SEQUENCES.to_owned(), fundamental, matches, origin: TruthOrigin::Cameras };
    Ok(SampleRecordings { pictures: [opened(left)?, opened(right)?], show_me, truth })
}
