//! The built-in pair that the window opens on.

use crate::geometry::PointPair;
use crate::image::Picture;
use crate::synthetic::Sample;

/// Two pictures and two point pairs that "Show me" places.
pub struct SamplePair {
    /// The pictures.
    pub pictures: [Picture; 2],
    /// Pairs known to give a good result.
    pub show_me: [PointPair; 2],
}

/// The default one of the samples.
pub fn sample_pair() -> SamplePair {
    let sample = Sample::default().load();
    SamplePair { pictures: sample.pictures, show_me: sample.show_me }
}
