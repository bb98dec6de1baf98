//! The built-in pair that the window opens on.

use crate::geometry::PointPair;
use crate::image::{LoadError, Picture};

/// Two pictures and two point pairs that "Show me" places.
pub struct SamplePair {
    /// The pictures.
    pub pictures: [Picture; 2],
    /// Pairs known to give a good result.
    pub show_me: [PointPair; 2],
}

/// Renders the built-in pair: a floor and two boxes, seen by a camera that moves sideways.
pub fn sample_pair() -> Result<SamplePair, LoadError> {
    let picture = |name: &str, shift: f64| {
        let pixels = image::GrayImage::from_fn(768, 576, |x, y| {
            image::Luma([shade(f64::from(x), f64::from(y), shift)])
        });
        Picture::from_pixels(name.to_owned(), None, pixels.into())
    };
    Ok(SamplePair {
        pictures: [picture("sample left", 0.0)?, picture("sample right", 1.0)?],
        show_me: [PointPair::new(220.0, 160.0, 172.0, 160.0), PointPair::new(520.0, 430.0, 425.0, 430.0)],
    })
}

/// Brightness of a pixel when the camera has moved sideways by `shift`.
fn shade(x: f64, y: f64, shift: f64) -> u8 {
    let disparity = if (140.0..300.0).contains(&(x + 48.0 * shift)) && (100.0..330.0).contains(&y) {
        48.0
    } else if (440.0..640.0).contains(&(x + 95.0 * shift)) && (330.0..500.0).contains(&y) {
        95.0
    } else {
        18.0 + 30.0 * (y / 576.0)
    };
    let (u, v) = ((x + disparity * shift) / 11.0, y / 11.0);
    let blocks =
        ((u / 3.0).floor() * 12.9898 + (v / 3.0).floor() * 78.233 + disparity.floor()).sin() * 43758.5;
    let waves = (u * 0.9).sin() + (v * 1.3).cos() + (0.6 * u + 0.8 * v).sin();
    (120.0 + 70.0 * (blocks - blocks.floor() - 0.5) + 18.0 * waves).clamp(0.0, 255.0) as u8
}
