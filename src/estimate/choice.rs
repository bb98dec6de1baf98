//! Which of several refined geometries is the result: what the images say of them, and the clicks where these leave it open.
//!
//! Of refinements the one whose matches weigh most is the right one, on nearly every pair measured. Where another weighs
//! about as much (by less than the margin from which on a verdict calls the advantage clear), the images leave it open, and
//! one that at least two clicks fewer contradict is taken: one click may be a mistake, two do not agree by mistake. A
//! geometry that most of the clicks are far from is none of this scene, whatever chance matches it has.

use super::trust::{CLEAR_MARGIN, CLICK_DEVIATIONS, CLICK_DEVIATIONS_WRONG};
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance};

/// A geometry and how much its refined matches weigh.
pub(super) trait Weighed {
    fn fundamental(&self) -> &FundamentalMatrix;
    fn weight(&self) -> f64;
}

/// What clicks say of geometries.
pub(super) struct ClickedPairs<'a> {
    /// The pairs, full-size pixels.
    pub pairs: &'a [PointPair],
    /// Standard deviation of a click, px.
    pub sigma: f64,
}

impl ClickedPairs<'_> {
    /// How many are farther than so many deviations from their lines.
    fn contradicting(&self, f: &FundamentalMatrix, deviations: f64) -> usize {
        self.pairs.iter().filter(|pair| sampson_distance(f, pair) > deviations * self.sigma).count()
    }

    /// Whether most of them are far from their lines.
    pub fn refuse(&self, f: &FundamentalMatrix) -> bool {
        2 * self.contradicting(f, CLICK_DEVIATIONS_WRONG) > self.pairs.len()
    }
}

/// Clicks that have to speak for a lighter geometry: one may be a mistake.
const SPEAK: usize = 2;

/// The result among several geometries, the first of equals; `None` without any.
pub(super) fn chosen<T: Weighed>(mut all: Vec<T>, clicks: &ClickedPairs) -> Option<T> {
    let weight = |k: &usize| all[*k].weight();
    let lighter = |a: &usize, b: &usize| weight(a).total_cmp(&weight(b)).then(b.cmp(a));
    let heaviest = (0..all.len()).max_by(lighter)?;
    let contradicting = |k: &usize| clicks.contradicting(all[*k].fundamental(), CLICK_DEVIATIONS);
    let against = contradicting(&heaviest);
    let best = (0..all.len())
        .filter(|k| weight(k) >= (1.0 - CLEAR_MARGIN) * weight(&heaviest))
        .filter(|k| contradicting(k) + SPEAK <= against)
        .max_by(|a, b| contradicting(b).cmp(&contradicting(a)).then(lighter(a, b)));
    Some(all.swap_remove(best.unwrap_or(heaviest)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::rows;

    #[derive(Debug, PartialEq)]
    struct Weight(f64, FundamentalMatrix);

    impl Weighed for Weight {
        fn fundamental(&self) -> &FundamentalMatrix {
            &self.1
        }

        fn weight(&self) -> f64 {
            self.0
        }
    }

    /// The shift of the chosen rows among weights with shifts, for clicks that agree with no shift.
    fn shift(all: &[(f64, f64)]) -> Option<f64> {
        let pairs = [10.0, 90.0, 200.0].map(|y| PointPair::new(20.0, y, 30.0, y));
        let clicks = ClickedPairs { pairs: &pairs, sigma: 1.0 };
        let found =
            chosen(all.iter().map(|(weight, shift)| Weight(*weight, rows(*shift))).collect(), &clicks);
        found.and_then(|found| all.iter().map(|(_, shift)| *shift).find(|shift| rows(*shift) == found.1))
    }

    #[test]
    fn the_heaviest_is_the_result_and_of_equals_the_first() {
        assert_eq!(shift(&[(10.0, 1.0), (12.0, 2.0), (12.0, 3.0)]), Some(2.0));
        assert_eq!(shift(&[]), None);
        // Without clicks, too.
        let found = chosen(
            vec![Weight(9.0, rows(50.0)), Weight(8.9, rows(0.0))],
            &ClickedPairs { pairs: &[], sigma: 1.0 },
        );
        assert!(found.unwrap().0 > 8.95);
    }

    #[test]
    fn clicks_decide_where_the_images_do_not() {
        // Sampson distances are shorter by √2.
        assert_eq!(shift(&[(10.0, 9.0), (8.1, 2.0)]), Some(2.0), "within the margin");
        assert_eq!(shift(&[(10.0, 9.0), (8.1, 2.0), (8.3, 1.0)]), Some(1.0), "of several the heaviest");
        assert_eq!(shift(&[(10.0, 9.0), (7.9, 2.0)]), Some(9.0), "beaten by more");
        assert_eq!(shift(&[(10.0, 5.0), (9.0, 0.0)]), Some(5.0), "no click contradicts it");
        assert_eq!(shift(&[(10.0, 9.0), (9.0, 8.0)]), Some(9.0), "both are contradicted");
    }

    #[test]
    fn one_click_may_be_a_mistake() {
        for (mistaken, expected) in [(1, 10.0), (2, 9.0)] {
            let pairs: Vec<PointPair> = (0..5)
                .map(|k| (f64::from(k) * 40.0, if k < mistaken { 9.0 } else { 2.0 }))
                .map(|(y, off)| PointPair::new(20.0, y, 30.0, y + off))
                .collect();
            let clicks = ClickedPairs { pairs: &pairs, sigma: 1.0 };
            let found = chosen(vec![Weight(10.0, rows(0.0)), Weight(9.0, rows(5.0))], &clicks);
            assert!((found.unwrap().0 - expected).abs() < 1e-9, "{mistaken} clicks");
        }
    }

    #[test]
    fn most_of_the_clicks_refuse_what_is_far_from_them() {
        let pairs = [0.0, 0.0, 30.0, 30.0].map(|off| PointPair::new(20.0, 50.0, 30.0, 50.0 + off));
        let refuse = |few: &[PointPair]| ClickedPairs { pairs: few, sigma: 1.0 }.refuse(&rows(0.0));
        assert!(!refuse(&pairs), "half of them");
        assert!(refuse(&pairs[1..]) && !refuse(&[]));
        assert!(!ClickedPairs { pairs: &pairs[1..], sigma: 3.0 }.refuse(&rows(0.0)));
    }
}
