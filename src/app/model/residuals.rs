//! Distances of the check pairs from the shown geometry, in words.

use super::Model;
use super::document::Role;
use crate::comparison::median;
use crate::geometry::symmetric_epipolar_distance;

/// Summarises the distances of the check pairs. `None` without any, or without a geometry.
pub fn check_summary(model: &Model) -> Option<String> {
    let shown = model.shown()?;
    let document = &model.document;
    let pairs = document.pairs.iter().enumerate().filter(|(pair, _)| document.role(*pair) == Role::Check);
    let distances = pairs.map(|(_, pair)| symmetric_epipolar_distance(shown.fundamental, pair)).collect();
    Some(format!("Check pairs {}", spread(distances)?))
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
