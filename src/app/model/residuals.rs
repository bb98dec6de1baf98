//! How far the points are from the geometry shown, in figures and in words.

use super::Model;
use super::document::Role;
use crate::geometry::symmetric_epipolar_distance;

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
pub fn summary(model: &Model) -> Vec<SummaryLine> {
    let Some(shown) = model.shown() else { return Vec::new() };
    let document = &model.document;
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
