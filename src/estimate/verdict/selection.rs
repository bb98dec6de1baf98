//! Selection of the result among refined geometries: by the weight of their matches, and by the
//! clicks if weights do not decide.
//!
//! Weights do not decide if they differ by less than the clear margin of a verdict. Neither do they
//! if the difference is within the scatter of the weights. Then a geometry is selected that at
//! least two clicks fewer contradict. One click may be a mistake; two mistakes seldom agree. A
//! geometry that is far from most of the clicks does not belong to the scene, even if matches
//! support it by chance.

use crate::estimate::Proposed;
use crate::estimate::evidence::patches::Refined;
use crate::estimate::evidence::viewed::SearchInput;
use crate::estimate::verdict::constants::{
    CHANCE_DEVIATIONS, CLEAR_MARGIN, CLICK_DEVIATIONS, CLICK_DEVIATIONS_WRONG, OVERRULING_CLICKS,
};
use crate::geometry::{FundamentalMatrix, Observation, PointPair, sampson_distance};

/// Geometry with the weight of its refined matches, and the standard deviation of the weight by chance.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Weighed {
    pub fundamental: FundamentalMatrix,
    pub weight: f64,
    pub deviation: f64,
}

impl From<&Refined> for Weighed {
    fn from(refined: &Refined) -> Self {
        let Refined { fundamental, weight, weight_deviation: deviation, .. } = *refined;
        Self { fundamental, weight, deviation }
    }
}

/// Clicked pairs that take part in fits, as evidence for or against geometries. Full-size pixels.
pub(in crate::estimate) struct ClickedPairs(pub Vec<Observation>);

impl ClickedPairs {
    pub fn new(pairs: &[PointPair], sigma: f64) -> Self {
        Self(pairs.iter().map(|pair| Observation { pair: *pair, sigma }).collect())
    }

    pub fn of(input: SearchInput) -> Self {
        Self::new(&input.clicks.observed(), input.parameters.click_sigma)
    }

    /// Returns the number of pairs farther than `deviations` standard deviations from their lines.
    fn contradicting(&self, f: &FundamentalMatrix, deviations: f64) -> usize {
        self.0.iter().filter(|click| sampson_distance(f, &click.pair) > deviations * click.sigma).count()
    }

    /// Returns whether at least two pairs contradict a refined geometry.
    pub fn speak_against(&self, f: &FundamentalMatrix) -> bool {
        self.contradicting(f, CLICK_DEVIATIONS) >= OVERRULING_CLICKS
    }

    /// Returns whether at least two pairs fewer contradict a refined geometry than another.
    pub fn prefer(&self, f: &FundamentalMatrix, other: &FundamentalMatrix) -> bool {
        self.contradicting(f, CLICK_DEVIATIONS) + OVERRULING_CLICKS
            <= self.contradicting(other, CLICK_DEVIATIONS)
    }

    /// Returns the unrefined geometries that the pairs prefer to a refined one: at least two pairs
    /// fewer are far from their lines. Without a refined geometry, returns all geometries that the
    /// pairs do not refuse. Geometries with the fewest far pairs come first; ties keep their order.
    pub fn preferred(&self, all: &[Proposed], refined: Option<&FundamentalMatrix>) -> Vec<Proposed> {
        let against = refined.map(|f| self.contradicting(f, CLICK_DEVIATIONS));
        let far = |f: &FundamentalMatrix| self.contradicting(f, CLICK_DEVIATIONS_WRONG);
        let is_preferred = |start: &&Proposed| match against {
            Some(against) => far(&start.fundamental) + OVERRULING_CLICKS <= against,
            None => !self.refuse(&start.fundamental),
        };
        let mut preferred: Vec<Proposed> = all.iter().filter(is_preferred).copied().collect();
        preferred.sort_by_cached_key(|start| far(&start.fundamental));
        preferred
    }

    /// Returns whether most of the pairs are far from their lines.
    pub fn refuse(&self, f: &FundamentalMatrix) -> bool {
        2 * self.contradicting(f, CLICK_DEVIATIONS_WRONG) > self.0.len()
    }
}

/// Returns the index of the selected geometry, the first among equals. `None` without geometries.
pub(in crate::estimate) fn select(
    all: impl IntoIterator<Item = impl Into<Weighed>>,
    clicks: &ClickedPairs,
) -> Option<usize> {
    let all: Vec<Weighed> = all.into_iter().map(Into::into).collect();
    let weight = |k: &usize| all[*k].weight;
    let lighter = |a: &usize, b: &usize| weight(a).total_cmp(&weight(b)).then(b.cmp(a));
    let heaviest = (0..all.len()).max_by(lighter)?;
    let contradicting = |k: &usize| clicks.contradicting(&all[*k].fundamental, CLICK_DEVIATIONS);
    let against = contradicting(&heaviest);
    // Treats the two sets of matches as independent.
    let scatter = |k: &usize| CHANCE_DEVIATIONS * all[*k].deviation.hypot(all[heaviest].deviation);
    let open = |k: &usize| scatter(k).max(CLEAR_MARGIN * weight(&heaviest));
    let best = (0..all.len())
        .filter(|k| weight(&heaviest) - weight(k) <= open(k))
        .filter(|k| contradicting(k) + OVERRULING_CLICKS <= against)
        .max_by(|a, b| contradicting(b).cmp(&contradicting(a)).then(lighter(a, b)));
    best.or(Some(heaviest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::ProposedBy;
    use crate::estimate::exact::rows;

    /// Returns the selected shift among `(weight, shift of the rows)`. All weights have this
    /// deviation.
    fn among(all: &[(f64, f64)], deviation: f64, pairs: &[PointPair]) -> Option<f64> {
        let rival =
            |(weight, shift): &(f64, f64)| Weighed { weight: *weight, deviation, fundamental: rows(*shift) };
        select(all.iter().map(rival), &ClickedPairs::new(pairs, 1.0)).map(|k| all[k].1)
    }

    /// Returns the selected shift for clicks that fit the shift 0, and weights of small deviation.
    fn shift(all: &[(f64, f64)]) -> Option<f64> {
        among(all, 0.5, &[10.0, 90.0, 200.0].map(|y| PointPair::new(20.0, y, 30.0, y)))
    }

    #[test]
    fn the_heaviest_is_the_result_and_of_equals_the_first() {
        assert_eq!(shift(&[(10.0, 1.0), (12.0, 2.0), (12.0, 3.0)]), Some(2.0));
        assert_eq!(shift(&[]), None);
        // Without clicks, too.
        assert_eq!(among(&[(9.0, 50.0), (8.9, 0.0)], 0.5, &[]), Some(50.0));
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
    fn weights_of_few_matches_leave_more_to_the_clicks() {
        let pairs = [10.0, 90.0].map(|y| PointPair::new(20.0, y, 30.0, y));
        // The difference is 4. Its deviation is √2 times the deviation of each weight.
        for (deviation, expected) in [(1.4, 9.0), (1.5, 0.0)] {
            let found = among(&[(10.0, 9.0), (6.0, 0.0)], deviation, &pairs);
            assert_eq!(found, Some(expected), "{deviation}");
        }
    }

    fn preferred(
        clicks: &ClickedPairs,
        all: &[FundamentalMatrix],
        refined: Option<&FundamentalMatrix>,
    ) -> Vec<FundamentalMatrix> {
        let start = |f: &FundamentalMatrix| Proposed::by(ProposedBy::Features, *f);
        let starts: Vec<Proposed> = all.iter().map(start).collect();
        clicks.preferred(&starts, refined).iter().map(|start| start.fundamental).collect()
    }

    #[test]
    fn geometries_preferred_by_clicks_are_found_at_any_rank() {
        let pairs = [10.0, 60.0, 90.0, 200.0].map(|y| PointPair::new(20.0, y, 30.0, y));
        let clicks = ClickedPairs::new(&pairs, 1.0);
        assert!(clicks.speak_against(&rows(9.0)) && !clicks.speak_against(&rows(3.0)));
        let one_off = [pairs[0], PointPair::new(20.0, 50.0, 30.0, 70.0)];
        let doubtful = ClickedPairs::new(&one_off, 1.0);
        assert!(!doubtful.speak_against(&rows(0.0)), "one may be a mistake");
        // Before refinement a geometry may be off by more than after it.
        let ranked = [40.0, 10.0, 30.0, 0.0].map(rows);
        assert_eq!(preferred(&clicks, &ranked, Some(&rows(9.0))), [rows(10.0), rows(0.0)]);
        assert_eq!(preferred(&clicks, &ranked, Some(&rows(1.0))), []);
        assert_eq!(preferred(&clicks, &ranked, None), [rows(10.0), rows(0.0)]);
        // Geometries with the fewest far clicks come first.
        let mixed = [0.0, 0.0, 0.0, 30.0].map(|off| PointPair::new(20.0, 50.0, 30.0, 50.0 + off));
        let mixed = ClickedPairs::new(&mixed, 1.0);
        assert_eq!(preferred(&mixed, &[rows(30.0), rows(0.0)], Some(&rows(60.0))), [rows(0.0)]);
    }

    #[test]
    fn one_click_may_be_a_mistake() {
        for (mistaken, expected) in [(1, 0.0), (2, 5.0)] {
            let pairs: Vec<PointPair> = (0..5)
                .map(|k| (f64::from(k) * 40.0, if k < mistaken { 9.0 } else { 2.0 }))
                .map(|(y, off)| PointPair::new(20.0, y, 30.0, y + off))
                .collect();
            let found = among(&[(10.0, 0.0), (9.0, 5.0)], 0.5, &pairs);
            assert_eq!(found, Some(expected), "{mistaken} clicks");
        }
    }

    #[test]
    fn a_geometry_far_from_most_clicks_is_refused() {
        let pairs = [0.0, 0.0, 30.0, 30.0].map(|off| PointPair::new(20.0, 50.0, 30.0, 50.0 + off));
        let refuse = |few: &[PointPair]| ClickedPairs::new(few, 1.0).refuse(&rows(0.0));
        assert!(!refuse(&pairs), "half of them");
        assert!(refuse(&pairs[1..]) && !refuse(&[]));
        assert!(!ClickedPairs::new(&pairs[1..], 3.0).refuse(&rows(0.0)));
    }
}
