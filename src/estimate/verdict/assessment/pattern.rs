//! Whether the matches are off their lines in a pattern: by the same distance over whole parts of the image.
//!
//! Matches of a rigid scene are off their lines by what finding them leaves open, each for itself. Where the images are
//! bent against each other, or F only comes near to what they show, neighbours are off alike. With the distances `d` of
//! matches from their lines, to one side or the other, and the mean over neighbours `i, j`,
//!
//! ```text
//!     c = E[dᵢ dⱼ] / E[dᵢ²]
//! ```
//!
//! is the share of their variance that is a pattern (the spatial autocorrelation of Moran 1950), and the root of
//! `E[dᵢ dⱼ]` its size.

use crate::estimate::verdict::trust::ResidualPattern;
use crate::geometry::{FundamentalMatrix, PointPair};

/// Neighbours are at least this far from each other, as a fraction of the longer side, so that their patches share
/// hardly a pixel, and at most so far.
const APART: [f64; 2] = [0.015, 0.05];
/// Matches whose neighbours are examined, evenly spread over all: the share is known to a few per
/// cent.
const LOOKED_AT: usize = 500;

/// What neighbouring matches are off their lines alike; `side` is the longer side of image 1, px.
pub(super) fn residual_pattern(
    matches: &[PointPair],
    f: &FundamentalMatrix,
    side: f64,
) -> Option<ResidualPattern> {
    let off = |m: &PointPair| Some((m.point1, f.line2_from_point1(m.point1)?.signed_distance(m.point2)));
    let off: Vec<_> = matches.iter().filter_map(off).collect();
    let (mut together, mut alone, mut count) = (0.0, 0.0, 0_usize);
    for (point, distance) in off.iter().step_by(off.len().div_ceil(LOOKED_AT).max(1)) {
        for (other, its) in &off {
            let apart = (other - point).norm() / side;
            if apart > APART[0] && apart < APART[1] {
                together += distance * its;
                alone += distance * distance;
                count += 1;
            }
        }
    }
    (alone > 0.0).then(|| ResidualPattern {
        share: (together / alone).max(0.0),
        size: (together / count as f64).max(0.0).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::rows;

    /// Matches over the image, `off(x, y)` px off their rows.
    fn found(off: impl Fn(f64, f64) -> f64) -> ResidualPattern {
        let places = (0..900_u32).map(|k| (f64::from(k % 30) * 24.0, f64::from(k / 30) * 18.0));
        let matches: Vec<PointPair> =
            places.map(|(x, y)| PointPair::new(x, y, x + 10.0, y + off(x, y))).collect();
        residual_pattern(&matches, &rows(0.0), 768.0).unwrap()
    }

    #[test]
    fn waves_are_a_pattern_and_noise_is_none() {
        let wave = found(|x, y| 0.6 * (0.02 * y + 1.0).sin() * (0.01 * x).cos());
        assert!(wave.share > 0.8, "{wave:?}");
        assert!((wave.size - 0.3).abs() < 0.06, "{wave:?}");
        // Whatever differs from place to place.
        let noise = found(|x, y| 0.6 * (12.9898 * x + 78.233 * y).sin());
        assert!(noise.share < 0.1, "{noise:?}");
        assert!((found(|_, _| 0.5).size - 0.5).abs() < 1e-9);
    }

    #[test]
    fn without_neighbours_there_is_nothing_to_tell() {
        let far = [PointPair::new(0.0, 0.0, 1.0, 1.0), PointPair::new(500.0, 0.0, 501.0, 1.0)];
        assert!(residual_pattern(&far, &rows(0.0), 768.0).is_none());
        assert!(residual_pattern(&[], &rows(0.0), 768.0).is_none());
    }
}
