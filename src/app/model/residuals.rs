//! Distances between the points and the shown geometry, in figures and words.

use super::Model;
use super::document::Role;
use crate::comparison::median;
use crate::geometry::symmetric_epipolar_distance;

/// A line of the summary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SummaryLine {
    /// Name of the group of pairs.
    pub name: &'static str,
    /// Number of pairs and their distances.
    pub value: String,
    /// Explanation of the group.
    pub tooltip: &'static str,
}

/// Summarises the distances of check pairs and refined matches. Empty without a geometry.
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
        ("Check pairs", of_role(Role::Check), "Pairs not used in the estimate: an independent test."),
        ("Refined matches", matches, "Image patches matched along the epipolar lines by the refinement."),
    ];
    groups
        .into_iter()
        .filter_map(|(name, distances, tooltip)| {
            Some(SummaryLine { name, value: spread(distances)?, tooltip })
        })
        .collect()
}

/// Describes distances by number, root mean square and median; `None` without distances.
fn spread(mut distances: Vec<f64>) -> Option<String> {
    distances.retain(|distance| distance.is_finite());
    if distances.is_empty() {
        return None;
    }
    let count = distances.len();
    let square = distances.iter().map(|d| d * d).sum::<f64>() / count as f64;
    Some(format!("{count}, RMS {:.2} px, median {:.2} px", square.sqrt(), median(&distances)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_has_count_rms_and_median() {
        assert_eq!(spread(vec![4.0, 0.0, 3.0]).as_deref(), Some("3, RMS 2.89 px, median 3.00 px"));
        let even = spread(vec![4.0, 0.0, 3.0, 1.0]);
        assert_eq!(even.as_deref(), Some("4, RMS 2.55 px, median 2.00 px"), "as in the comparison");
        assert_eq!(spread(vec![f64::INFINITY]), None);
    }
}
