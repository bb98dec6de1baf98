//! The built-in pairs, one of them shown at the start, and the built-in sequences.

use super::picture::Opened;
use super::recording::Recording;
use crate::camera::FocalLength;
use crate::cancel::CancelFlag;
use crate::geometry::{Camera, PointPair};
use crate::image::Picture;
use crate::io::{GroundTruth, SequenceFile, TruthOrigin};
use crate::motion::{FrameSequence, MotionError};
use crate::synthetic::{BallScene, Sample, ThrownBalls};

/// Name of the built-in sequences in sessions.
pub const SAMPLE_SEQUENCES: &str = "balls";

/// Number of true matches of the built-in sequences.
const MATCHES: usize = 200;
/// Matches placed by "Show me": far apart, and off each other's epipolar lines.
const SHOW_ME: [usize; 2] = [88, 179];

/// Two pictures or sequences, and the point pairs that "Show me" places.
pub struct OpenedSample {
    /// The pictures, or the first frames of the sequences.
    pub pictures: [Opened; 2],
    /// Pairs known to give a good result.
    pub show_me: [PointPair; 2],
    /// The exact geometry. It has the name of the sample in sessions.
    pub truth: GroundTruth,
}

/// The sample shown at the start. Its camera moves forwards, so the epipoles are in view.
pub const FIRST: Sample = Sample::Alley;

/// Loads a sample. The focal lengths of the first one are known, so its scene opens without a question. The other one
/// is like pictures from elsewhere.
pub fn sample_pair(which: Sample) -> OpenedSample {
    let name = which.name().to_owned();
    let sample = which.load();
    let known = |opened: Opened, camera: &Camera| {
        let focal = camera.calibration().map(|k| FocalLength { pixels: k[(0, 0)], deviation: 0.0 });
        focal.and_then(|focal| opened.clone().with_focal_length(focal)).unwrap_or(opened)
    };
    let [left, right] = sample.pictures.map(Opened::new);
    let pictures = match which {
        FIRST => [known(left, &sample.cameras[0]), known(right, &sample.cameras[1])],
        _ => [left, right],
    };
    let (fundamental, matches) = (sample.fundamental, sample.matches);
    let truth = GroundTruth { name, fundamental, matches, origin: TruthOrigin::Cameras };
    OpenedSample { pictures, show_me: sample.show_me, truth }
}

/// Returns the sample that a picture belongs to, by its name.
pub fn sample_of(picture: &Picture) -> Option<Sample> {
    Sample::from_name(picture.name.rsplit_once('-')?.0)
}

/// Draws the built-in sequences: balls thrown about in a yard. This takes a second or two.
///
/// # Panics
/// Never: the frames have pixels, and the cameras have different centres. A test opens the scene.
pub fn sample_recordings(cancel: &CancelFlag) -> Result<OpenedSample, MotionError> {
    let scene = BallScene::new(ThrownBalls::default()).expect("the frames have pixels");
    let fundamental = scene.fundamental().expect("the cameras have different centres");
    let matches = scene.matches(MATCHES);
    let show_me = SHOW_ME.map(|k| matches[k]);
    let [left, right] = scene.sequences().expect("the cameras see the yard");
    let opened = |sequence: FrameSequence| -> Result<Opened, MotionError> {
        let made = SequenceFile::made(sequence).expect("the frames have pixels");
        Ok(Opened::recorded(made.first, Recording::new(made.sequence, cancel)?))
    };
    let truth =
        GroundTruth { name: SAMPLE_SEQUENCES.to_owned(), fundamental, matches, origin: TruthOrigin::Cameras };
    Ok(OpenedSample { pictures: [opened(left)?, opened(right)?], show_me, truth })
}
