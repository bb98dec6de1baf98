//! How far the points are from the geometry shown, in figures and in words.

use super::document::Role;
use super::scene::Scene;
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance, symmetric_epipolar_distance};

/// Distances of one pair from a geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// Mean distance of the two points from each other's epipolar lines, px.
    pub symmetric: f64,
    /// First-order distance of the pair from fitting exactly, px.
    pub sampson: f64,
}

impl Residuals {
    /// Those of a pair.
    pub fn of(f: &FundamentalMatrix, pair: &PointPair) -> Self {
        Self { symmetric: symmetric_epipolar_distance(f, pair), sampson: sampson_distance(f, pair) }
    }
}

/// A line of the summary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SummaryLine {
    /// Which pairs.
    pub name: &'static str,
    /// How many they are and how far off.
    pub value: String,
    /// One sentence about them.
    pub tooltip: &'static str,
}

/// The pairs by what they are for, and the matches of the refinement. Empty while there is no geometry.
pub fn summary(scene: &Scene) -> Vec<SummaryLine> {
    let Some(shown) = scene.shown() else { return Vec::new() };
    let document = scene.document;
    let of_role = |role: Role| -> Vec<f64> {
        let pairs = document.pairs.iter().enumerate().filter(|(pair, _)| document.role(*pair) == role);
        pairs.map(|(_, pair)| symmetric_epipolar_distance(shown.fundamental, pair)).collect()
    };
    let matches = shown.estimate.matches().iter();
    let matches = matches.map(|m| symmetric_epipolar_distance(shown.fundamental, &m.pair)).collect();
    let groups = [
        ("Check pairs", of_role(Role::Check), "Pairs that had no part in the estimate: the honest test."),
        ("Refined matches", matches, "Image patches that the refinement matched along the epipolar lines."),
    ];
    groups
        .into_iter()
        .filter_map(|(name, distances, tooltip)| {
            Some(SummaryLine { name, value: spread(distances)?, tooltip })
        })
        .collect()
}

/// How many distances there are, their root mean square and their median; `None` when there are none.
fn spread(mut distances: Vec<f64>) -> Option<String> {
    distances.retain(|distance| distance.is_finite());
    if distances.is_empty() {
        return None;
    }
    distances.sort_by(f64::total_cmp);
    let count = distances.len();
    let square = distances.iter().map(|d| d * d).sum::<f64>() / count as f64;
    Some(format!("{count}, RMS {:.2} px, median {:.2} px", square.sqrt(), distances[count / 2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_has_count_rms_and_median() {
        assert_eq!(spread(vec![4.0, 0.0, 3.0]).as_deref(), Some("3, RMS 2.89 px, median 3.00 px"));
        assert_eq!(spread(vec![f64::INFINITY]), None);
    }
}
