//! Refits of proposals to their own supporting matches, with a shrinking band.

use rayon::prelude::*;

use super::Proposal;
use super::support::SupportLevel;
use crate::cancel::CancelFlag;
use crate::estimate::EstimateError;
use crate::geometry::{FundamentalMatrix, Observation, PointPair, fit_fundamental};

/// Settings for the proposals of one level.
pub(super) struct Polishing {
    /// Number of proposals that are refitted.
    pub count: usize,
    /// Widths of the band, px of the level, one for each refit.
    pub bands: &'static [f64],
}

/// Settings at the coarse level. The first band is three bands of support, since proposals are some
/// pixels off. The last is the error of a corner.
pub(super) const COARSE: Polishing = Polishing { count: 40, bands: &[6.0, 4.0, 2.5, 1.5, 1.5] };
/// Settings at the fine level. Fewer proposals and fits than at the coarse level, since each takes
/// longer and starts nearer.
pub(super) const FINE: Polishing = Polishing { count: 24, bands: &[6.0, 3.0, 1.5] };

/// Width of a band over the distance at which a match loses influence on the fit. At the edge of
/// the band a tenth of the weight is left.
const BAND_DEVIATIONS: f64 = 3.0;
/// Least standard deviation of a click, px of the level. A level cannot show a more precise click,
/// so a click must not outweigh the corners.
pub(in crate::estimate) const LEAST_CLICK_SIGMA: f64 = 0.5;
/// Difference between matrices of norm 1 below which they are the same geometry: rounding.
const SAME: f64 = 1e-9;

/// Refits the best proposals to their supporting matches. Returns them by support, best first,
/// without near-copies. The clicks (full size, with their standard deviation) take part.
pub(super) fn polish(
    level: &SupportLevel,
    proposals: &[Proposal],
    how: &Polishing,
    clicks: &[PointPair],
    click_sigma: f64,
    cancel: &CancelFlag,
) -> Result<Vec<Proposal>, EstimateError> {
    let sigma = (click_sigma * level.scales[0]).max(LEAST_CLICK_SIGMA);
    let clicks: Vec<Observation> =
        clicks.iter().map(|click| Observation { pair: click.rescaled(level.scales), sigma }).collect();
    let mut polished: Vec<Proposal> = proposals
        .par_iter()
        .take(how.count)
        .map(|start| {
            if cancel.is_cancelled() {
                return start.clone();
            }
            let fundamental = climb(level, &start.fundamental, how.bands, &clicks);
            let support = level.support.measure(&fundamental);
            let is_better = support.score > start.support.score;
            if is_better { Proposal { fundamental, support, ..start.clone() } } else { start.clone() }
        })
        .collect();
    cancel.check()?;
    Proposal::sort(&mut polished);
    polished.dedup_by(|b, a| (a.fundamental.matrix() - b.fundamental.matrix()).norm() < SAME);
    Ok(polished)
}

fn climb(
    level: &SupportLevel,
    start: &FundamentalMatrix,
    bands: &[f64],
    clicks: &[Observation],
) -> FundamentalMatrix {
    let mut f = *start;
    for band in bands {
        let matches = level.support.matches(&f, *band);
        let observations: Vec<Observation> = matches
            .iter()
            .map(|m| Observation { pair: m.pair, sigma: 1.0 })
            .chain(clicks.iter().copied())
            .collect();
        match fit_fundamental(&f, &observations, band / BAND_DEVIATIONS) {
            Some(result) => f = result.fundamental,
            None => break,
        }
    }
    f
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::ProposedBy;
    use crate::estimate::evidence::patches::support::Support;
    use crate::estimate::exact::{ExactScene, rows};

    /// Returns true matches and a third as many wrong ones.
    fn level(scene: &ExactScene) -> SupportLevel {
        let pairs = scene.pairs(60);
        let wrong = (0..20).map(|k| PointPair { point2: pairs[(k * 11 + 5) % 60].point2, ..pairs[k] });
        let all: Vec<_> = pairs.iter().map(|m| (*m, 0.9)).chain(wrong.map(|m| (m, 0.65))).collect();
        SupportLevel { scales: [1.0; 2], support: Support::of_matches(&all) }
    }

    fn start(scene: &ExactScene, level: &SupportLevel, fundamental: FundamentalMatrix) -> Proposal {
        Proposal {
            origin: ProposedBy::Features.into(),
            angles: Some(scene.angles()),
            support: level.support.measure(&fundamental),
            fundamental,
        }
    }

    fn polished(
        level: &SupportLevel,
        starts: &[Proposal],
        clicks: &[PointPair],
        click_sigma: f64,
    ) -> Vec<Proposal> {
        polish(level, starts, &COARSE, clicks, click_sigma, &CancelFlag::default()).unwrap()
    }

    #[test]
    fn a_geometry_some_pixels_off_climbs_to_its_matches() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let level = level(&scene);
            let begin = start(&scene, &level, scene.disturbed(1.5));
            let before = scene.error(&begin.fundamental);
            assert!(before > 1.0, "{before} px");
            let found = polished(&level, std::slice::from_ref(&begin), &scene.clicks(), 1.0);
            // A few wrong matches within the last band of 1.5 px cause a small error.
            let after = scene.error(&found[0].fundamental);
            assert!(after < 0.1, "{before} px before, {after} px after");
            assert!(found[0].support.matches >= 58 && found[0].support.score > begin.support.score);
        }
    }

    #[test]
    fn equal_results_are_merged_and_the_best_comes_first() {
        let scene = ExactScene::aside();
        let level = level(&scene);
        let hopeless = start(&scene, &level, rows(1000.0));
        let starts = [
            hopeless.clone(),
            start(&scene, &level, scene.disturbed(1.0)),
            start(&scene, &level, scene.disturbed(-1.0)),
        ];
        let found = polished(&level, &starts, &scene.clicks(), 1.0);
        assert_eq!(found.len(), 2);
        assert!(found[0].support.score > 10.0);
        assert_eq!(found[1].fundamental, hopeless.fundamental, "without matches the geometry stays");
        let first = Polishing { count: 1, ..COARSE };
        let of_one = polish(&level, &starts, &first, &scene.clicks(), 1.0, &CancelFlag::default()).unwrap();
        assert_eq!(of_one.len(), 1);
    }

    #[test]
    fn a_geometry_is_kept_when_refitting_loses_support() {
        let scene = ExactScene::aside();
        let level = level(&scene);
        // More support than any refit can reach.
        let mut best = start(&scene, &level, scene.disturbed(1.0));
        best.support.score = 1e3;
        let found = polished(&level, std::slice::from_ref(&best), &scene.clicks(), 1.0);
        assert_eq!(found[0].fundamental, best.fundamental);
    }

    #[test]
    fn clicks_are_no_more_precise_than_the_level() {
        let scene = ExactScene::aside();
        let level = level(&scene);
        let starts = [start(&scene, &level, scene.disturbed(1.5))];
        let [p, q] = scene.clicks();
        let off = [PointPair { point2: p.point2 + nalgebra::Vector2::new(0.0, 3.0), ..p }, q];
        let with = |sigma: f64| polished(&level, &starts, &off, sigma)[0].fundamental;
        assert_eq!(with(1e-3), with(LEAST_CLICK_SIGMA));
        let [firm, loose] = [with(1e-3), with(50.0)].map(|f| scene.error(&f));
        assert!(loose < firm && firm < 1.0, "{loose} {firm}");
    }

    #[test]
    fn a_stop_is_an_error() {
        let scene = ExactScene::aside();
        let level = level(&scene);
        let starts = [start(&scene, &level, scene.disturbed(0.5))];
        let flag = CancelFlag::default();
        flag.cancel();
        let stopped = polish(&level, &starts, &COARSE, &[], 1.0, &flag);
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
