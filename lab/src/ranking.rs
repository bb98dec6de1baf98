//! Quality of a search: the error of its best hypothesis, and the ranks of this hypothesis and of
//! the truth.

use serde::Serialize;

use super::mean;
use super::{Choice, KnownScene};
use epiline::estimate::Estimate;

/// Search of one trial. Ranks count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RankingRecord {
    /// Number of hypotheses.
    pub hypotheses: usize,
    /// Error of the best hypothesis, px.
    pub best_error: f64,
    /// Rank of the best hypothesis by line validation.
    pub best_rank_by_lines: usize,
    /// Rank of the best hypothesis by patch support; `None` without patches.
    pub best_rank_by_patches: Option<usize>,
    /// Rank of the true geometry by line validation; `None` if its lines are degenerate at the
    /// clicks.
    pub true_rank_by_lines: Option<usize>,
    /// Rank of the true geometry by patch support.
    pub true_rank_by_patches: Option<usize>,
}

impl RankingRecord {
    /// Ranks the hypotheses; `None` without hypotheses.
    pub(super) fn new(scene: &KnownScene, choice: &Choice) -> Option<Self> {
        let all = &choice.generated;
        let error = |h: &Estimate| mean(&scene.distances(h.fundamental()));
        let (best, best_error) = all.iter().map(|h| (h, error(h))).min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        let score = |h: &Estimate| h.line_score().unwrap_or(f64::INFINITY);
        let by_lines = |h: &Estimate| 1 + all.iter().filter(|other| score(other) < score(h)).count();
        let patches = all.iter().any(|h| h.support_score().is_some_and(|score| score > 0.0));
        let by_patches = |h: &Estimate| {
            patches.then(|| 1 + all.iter().filter(|o| o.support_score() > h.support_score()).count())
        };
        Some(Self {
            hypotheses: all.len(),
            best_error,
            best_rank_by_lines: by_lines(best),
            best_rank_by_patches: by_patches(best),
            true_rank_by_lines: choice.truth.as_ref().map(by_lines),
            true_rank_by_patches: choice.truth.as_ref().and_then(by_patches),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::example_scene;
    use epiline::estimate::{Assessment, Construction, LineFigures, PatchSupport};
    use epiline::geometry::FundamentalMatrix;
    use nalgebra::Matrix3;

    #[test]
    fn ranks_count_who_is_better() {
        let scene = example_scene("scene", 40);
        let clicks = [scene.matches[3], scene.matches[17]];
        let hypothesis = |shift: f64, score: f64, support: f64| {
            // True geometry with image 2 shifted.
            let moved = Matrix3::new(1.0, 0.0, -shift, 0.0, 1.0, 0.3 * shift, 0.0, 0.0, 1.0);
            let fundamental =
                FundamentalMatrix::from_rank_two(moved.transpose() * scene.truth.matrix()).unwrap();
            let construction = Construction::of(&fundamental, clicks, 0.0).unwrap();
            let lines = LineFigures { score: Some(score), round_trip_area: Some(0.0), construction };
            let support = PatchSupport { matches: 20, score: support };
            let assessment =
                Assessment { lines: Some(lines), support: Some(support), ..Assessment::default() };
            Estimate { fundamental, origin: None, assessment, trace: None }
        };
        let generated =
            vec![hypothesis(40.0, 0.2, 30.0), hypothesis(-5.0, 0.4, 20.0), hypothesis(90.0, 0.3, 10.0)];
        let choice = Choice { generated, truth: Some(hypothesis(0.0, 0.35, 50.0)) };
        let record = RankingRecord::new(&scene, &choice).unwrap();
        assert!(record.best_error > 0.1 && record.best_error < 6.0, "{}", record.best_error);
        assert_eq!(
            (record.hypotheses, record.best_rank_by_lines, record.best_rank_by_patches),
            (3, 3, Some(2))
        );
        assert_eq!((record.true_rank_by_lines, record.true_rank_by_patches), (Some(3), Some(1)));
        assert!(RankingRecord::new(&scene, &Choice { generated: Vec::new(), truth: None }).is_none());
    }
}
