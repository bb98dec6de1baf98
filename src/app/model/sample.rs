//! The built-in pair that the window opens on.

use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::{GroundTruth, TruthOrigin};
use crate::synthetic::Sample;

/// Two pictures and two point pairs that "Show me" places.
pub struct SamplePair {
    /// The pictures.
    pub pictures: [Picture; 2],
    /// Pairs known to give a good result.
    pub show_me: [PointPair; 2],
    /// Its exact geometry, named as the sample is.
    pub truth: GroundTruth,
}

/// The default one of the samples.
pub fn sample_pair() -> SamplePair {
    let name = Sample::default().name().to_owned();
    let sample = Sample::default().load();
    let (fundamental, matches) = (sample.fundamental, sample.matches);
    let truth = GroundTruth { name, fundamental, matches, origin: TruthOrigin::Cameras };
    SamplePair { pictures: sample.pictures, show_me: sample.show_me, truth }
}
