//! Pattern of residuals: whether neighbouring matches are off their lines by the same distance.
//!
//! In a rigid scene, matches are off their lines by independent errors. If a lens bends one image
//! against the other, or if F is only approximate, neighbours are off by nearly the same distance.
//! Let `d` be the signed distances of matches from their lines. With means over neighbours `i, j`,
//!
//! ```text
//!     c = E[dᵢ dⱼ] / E[dᵢ²]
//! ```
//!
//! is the share of the variance that neighbours have in common (the spatial autocorrelation of
//! Moran 1950). The root of `E[dᵢ dⱼ]` is its size.

use serde::Serialize;

use crate::geometry::{FundamentalMatrix, PointPair};

/// Smallest and largest distance between neighbours, as shares of the longer side. Patches of
/// nearer matches have pixels in common.
const APART: [f64; 2] = [0.015, 0.05];
/// Number of matches whose neighbours are examined, evenly spread over all. The share is precise to
/// a few per cent.
const LOOKED_AT: usize = 500;

/// Part of the residuals that neighbouring matches have in common.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct ResidualPattern {
    /// Share of the variance that is common to neighbours, 0 to 1.
    pub share: f64,
    /// Root mean square of the common part, px.
    pub size: f64,
}

/// Returns the common part of the residuals of neighbours. `side` is the longer side of image
/// 1, px. `None` without neighbours.
pub(in crate::estimate) fn residual_pattern(
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

    /// Returns the pattern of matches over the image that are `off(x, y)` px off their rows.
    fn found(off: impl Fn(f64, f64) -> f64) -> ResidualPattern {
        let places = (0..900_u32).map(|k| (f64::from(k % 30) * 24.0, f64::from(k / 30) * 18.0));
        let matches: Vec<PointPair> =
            places.map(|(x, y)| PointPair::new(x, y, x + 10.0, y + off(x, y))).collect();
        residual_pattern(&matches, &rows(0.0), 768.0).unwrap()
    }

    #[test]
    fn waves_are_a_pattern_and_noise_is_not() {
        let wave = found(|x, y| 0.6 * (0.02 * y + 1.0).sin() * (0.01 * x).cos());
        assert!(wave.share > 0.8, "{wave:?}");
        assert!((wave.size - 0.3).abs() < 0.06, "{wave:?}");
        // Distances that differ from place to place.
        let noise = found(|x, y| 0.6 * (12.9898 * x + 78.233 * y).sin());
        assert!(noise.share < 0.1, "{noise:?}");
        assert!((found(|_, _| 0.5).size - 0.5).abs() < 1e-9);
    }

    #[test]
    fn without_neighbours_there_is_no_pattern() {
        let far = [PointPair::new(0.0, 0.0, 1.0, 1.0), PointPair::new(500.0, 0.0, 501.0, 1.0)];
        assert!(residual_pattern(&far, &rows(0.0), 768.0).is_none());
        assert!(residual_pattern(&[], &rows(0.0), 768.0).is_none());
    }
}
