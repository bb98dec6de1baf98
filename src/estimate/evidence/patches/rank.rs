//! Ranking of proposals by patch support: refits at two sizes, and resampling of their matches.

use rayon::prelude::*;

use super::polish::{COARSE, FINE, polish};
use super::resampling::{Drawing, resample};
use super::support::{BAND, Support, SupportLevel};
use super::{Hypothesis, Proposal};
use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::{LineExaminer, LineFigures, PencilAngles};
use crate::estimate::{EstimateError, Parameters};
use crate::geometry::{PointPair, symmetric_epipolar_distance};

/// Growth of the best support below which resampling ends. Each further round takes as long as the
/// one before.
const SETTLED: f64 = 1.01;

/// Polishes proposals at the coarse and the fine level and resamples their matches. Returns all,
/// best first, in pixels of the fine level. `clicks` are all clicks that take part in fits,
/// full-size pixels.
pub(in crate::estimate) fn rank(
    coarse: &SupportLevel,
    fine: &SupportLevel,
    proposals: &[Proposal],
    clicks: &[PointPair],
    parameters: &Parameters,
    cancel: &CancelFlag,
) -> Result<Vec<Proposal>, EstimateError> {
    let polished = polish(coarse, proposals, &COARSE, clicks, parameters.click_sigma, cancel)?;
    let ratios = [fine.scales[0] / coarse.scales[0], fine.scales[1] / coarse.scales[1]];
    let at_fine = |proposal: &Proposal| {
        let fundamental = proposal.fundamental.rescaled(ratios)?;
        let support = fine.support.measure(&fundamental);
        Some(Proposal { fundamental, support, ..proposal.clone() })
    };
    let starts: Vec<Proposal> = polished.par_iter().filter_map(at_fine).collect();
    let proposed: Vec<Proposal> = proposals.par_iter().filter_map(at_fine).collect();
    rank_fine(fine, starts, proposed, clicks, parameters, cancel)
}

/// Polishes the starts and resamples the matches of the best. Returns these and the other
/// proposals, best first. All are in pixels of the level, `clicks` in full-size pixels.
pub(in crate::estimate) fn rank_fine(
    fine: &SupportLevel,
    mut starts: Vec<Proposal>,
    proposed: Vec<Proposal>,
    clicks: &[PointPair],
    parameters: &Parameters,
    cancel: &CancelFlag,
) -> Result<Vec<Proposal>, EstimateError> {
    Proposal::sort(&mut starts);
    let polish_fine =
        |starts: &[Proposal]| polish(fine, starts, &FINE, clicks, parameters.click_sigma, cancel);
    let mut ranked = polish_fine(&starts)?;
    // The other starts and proposals stay in the list: they include the runners-up.
    ranked.extend(starts.drain(starts.len().min(FINE.count)..));
    ranked.extend(proposed);
    let at_level: Vec<PointPair> = clicks.iter().map(|click| click.rescaled(fine.scales)).collect();
    for round in 0..parameters.patches.resampling as u64 {
        Proposal::sort(&mut ranked);
        let before = ranked.first().map_or(0.0, |leader| leader.support.score);
        let drawing = Drawing {
            clicks: &at_level,
            parameters: parameters.patches,
            // Rounds must differ, with any seed.
            seed: parameters.seed.wrapping_mul(64).wrapping_add(round),
        };
        let polished = polish_fine(&resample(&fine.support, &ranked, FINE.count, &drawing, cancel)?)?;
        let after = polished.first().map_or(0.0, |best| best.support.score);
        ranked.extend(polished);
        if after < SETTLED * before {
            break;
        }
    }
    Proposal::sort(&mut ranked);
    Ok(ranked)
}

/// Number of matches of a hypothesis, evenly spread, on which it is compared with other hypotheses.
/// A share near the limit of a fifth is thus known to 5 %.
const COMPARED: usize = 60;
/// Distance, px of the level, within which a line passes a match: the band of support, and the
/// error of a corner.
const NEAR: f64 = 3.0;

/// Returns the best `count` different hypotheses of a ranked list. A hypothesis that explains more
/// than four fifths of the matches of a better one is left out. Geometries that agree wherever the
/// scene is are the same to the user.
pub(in crate::estimate) fn different(support: &Support, ranked: &[Proposal], count: usize) -> Vec<Proposal> {
    let compared = |proposal: &Proposal| -> Vec<PointPair> {
        let matches = support.matches(&proposal.fundamental, BAND);
        let step = matches.len().div_ceil(COMPARED).max(1);
        matches.iter().step_by(step).map(|m| m.pair).collect()
    };
    let explains = |candidate: &Proposal, matches: &[PointPair]| {
        let far = |m: &&PointPair| symmetric_epipolar_distance(&candidate.fundamental, m) > NEAR;
        5 * matches.iter().filter(far).count() < matches.len()
    };
    let mut kept: Vec<(Proposal, Vec<PointPair>)> = Vec::new();
    for candidate in ranked {
        if kept.len() == count {
            break;
        }
        if !kept.iter().any(|(_, matches)| explains(candidate, matches)) {
            kept.push((candidate.clone(), compared(candidate)));
        }
    }
    kept.into_iter().map(|(proposal, _)| proposal).collect()
}

/// Returns proposals of the fine level as hypotheses in full-size pixels, in the same order. With
/// an examiner, they include the figures of the lines through two clicks.
pub(in crate::estimate) fn hypotheses(
    examiner: Option<&LineExaminer>,
    proposals: &[Proposal],
    fine: &SupportLevel,
) -> Vec<Hypothesis> {
    let full_size = |proposal: &Proposal, lines: Option<LineFigures>| {
        let fundamental = proposal.full_size(fine.scales)?;
        Some(Hypothesis { origin: proposal.origin, fundamental, lines, support: proposal.support })
    };
    let Some(examiner) = examiner else {
        return proposals.iter().filter_map(|proposal| full_size(proposal, None)).collect();
    };
    let own = examiner.clicks.map(|click| click.rescaled(fine.scales));
    // κ of the supporting matches.
    let directed = |proposal: &Proposal| {
        let angles = proposal.angles?;
        let matches = fine.support.matches(&proposal.fundamental, BAND);
        let pairs = matches.iter().map(|m| m.pair);
        Some(PencilAngles::nearest(&proposal.fundamental, &own, &angles, pairs).unwrap_or(angles))
    };
    let (with_lines, angles): (Vec<&Proposal>, Vec<PencilAngles>) =
        proposals.par_iter().filter_map(|proposal| Some((proposal, directed(proposal)?))).unzip();
    with_lines
        .into_iter()
        .zip(examiner.figures(&angles))
        .filter_map(|(proposal, lines)| full_size(proposal, Some(lines?)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Preset;
    use crate::estimate::exact::{ExactScene, ExactSource, rows};
    use crate::estimate::{Proposed, ProposedBy};
    use crate::geometry::FundamentalMatrix;
    use nalgebra::Matrix3;

    fn proposal(support: &Support, fundamental: FundamentalMatrix) -> Proposal {
        Proposal {
            origin: ProposedBy::Features.into(),
            angles: None,
            support: support.measure(&fundamental),
            fundamental,
        }
    }

    /// Returns matches on rows at these heights.
    fn on_rows(heights: impl Iterator<Item = f64>, shift: f64) -> Vec<(PointPair, f32)> {
        heights.enumerate().map(|(k, y)| (PointPair::new(9.0 * k as f64, y, 200.0, y + shift), 0.9)).collect()
    }

    #[test]
    fn a_hypothesis_that_explains_four_fifths_of_a_better_one_is_left_out() {
        // Lines 10 % farther down in image 2: 3 px off at about 30 px.
        let zoomed = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.1, 0.0);
        let zoomed = FundamentalMatrix::from_rank_two(zoomed).unwrap();
        for (far, kept) in [(3, 1), (4, 2), (10, 2)] {
            let heights = (0..20).map(|k| if k < 20 - far { f64::from(k) } else { 60.0 + f64::from(k) });
            let support = Support::of_matches(&on_rows(heights, 0.0));
            let ranked = [rows(0.0), zoomed].map(|f| proposal(&support, f));
            assert_eq!(ranked[0].support.matches, 20);
            assert_eq!(different(&support, &ranked, 9).len(), kept, "{far} of 20 are far");
        }
    }

    #[test]
    fn different_geometries_keep_their_order_up_to_a_count() {
        let mut matches = on_rows((0..30).map(|k| 3.0 * f64::from(k)), 0.0);
        matches.extend(on_rows((0..20).map(|k| 3.0 * f64::from(k)), 50.0));
        matches.extend(on_rows((0..10).map(|k| 3.0 * f64::from(k)), 100.0));
        let support = Support::of_matches(&matches);
        // 2.9 and 3.1 px from the first: about the distance that counts as different.
        let shifts = [0.0, NEAR - 0.1, 50.0, NEAR + 0.1, 51.0, 100.0];
        let ranked = shifts.map(|shift| proposal(&support, rows(shift)));
        let kept = |count: usize| -> Vec<FundamentalMatrix> {
            different(&support, &ranked, count).iter().map(|proposal| proposal.fundamental).collect()
        };
        assert_eq!(kept(9), [0.0, 50.0, NEAR + 0.1, 100.0].map(rows));
        assert_eq!(kept(2), [0.0, 50.0].map(rows));
        assert!(different(&support, &[], 9).is_empty());
    }

    /// Returns exact matches at half and at full size, with as many wrong look-alikes.
    fn levels(scene: &ExactScene) -> [SupportLevel; 2] {
        let pairs = scene.pairs(60);
        [0.5, 1.0].map(|scale| {
            let at = |k: usize| pairs[k % 60].rescaled([scale; 2]);
            let wrong = (0..60).map(|k| (PointPair { point2: at(k * 11 + 5).point2, ..at(k) }, 0.65));
            let all: Vec<_> = (0..60).map(|k| (at(k), 0.9)).chain(wrong).collect();
            SupportLevel { scales: [scale; 2], support: Support::of_matches(&all) }
        })
    }

    #[test]
    fn the_geometry_near_the_truth_ends_first() {
        let scene = ExactScene::aside();
        let [coarse, fine] = &levels(&scene);
        let parameters = Parameters { seed: 3, ..Parameters::default() };
        let near = scene.disturbed(2.0).rescaled([0.5; 2]).unwrap();
        let proposals: Vec<Proposal> =
            [rows(0.0), near, rows(-7.0)].map(|f| proposal(&coarse.support, f)).into();
        let cancel = CancelFlag::default();
        let ranked = || super::rank(coarse, fine, &proposals, &scene.clicks(), &parameters, &cancel).unwrap();
        let first = ranked();
        assert!(first.is_sorted_by(|a, b| a.support.score >= b.support.score));
        let error = scene.error(&first[0].fundamental);
        assert!(error < 0.1 && first[0].support.matches >= 60, "{error} px");
        let matrices = |list: &[Proposal]| list.iter().map(|p| p.fundamental).collect::<Vec<_>>();
        assert_eq!(matrices(&first), matrices(&ranked()), "the seed decides");
    }

    #[test]
    fn proposals_become_hypotheses_in_full_size_with_figures_of_their_lines() {
        let scene = ExactScene::aside();
        let fine = &levels(&scene)[0];
        let (source, cancel) = (ExactSource(scene.fundamental()), CancelFlag::default());
        let parameters = Parameters::from(Preset::Paper);
        let examiner = LineExaminer::new(&source, scene.clicks(), &parameters, &cancel);
        let truth = scene.fundamental().rescaled([0.5; 2]).unwrap();
        let wrong = scene.disturbed(6.0).rescaled([0.5; 2]).unwrap();
        let proposals =
            [wrong, truth].map(|f| Proposal { angles: Some(scene.angles()), ..proposal(&fine.support, f) });
        let found = super::hypotheses(Some(&examiner), &proposals, fine);
        assert_eq!(found.len(), 2);
        assert!((found[1].fundamental.matrix() - scene.fundamental().matrix()).norm() < 1e-9);
        for (hypothesis, proposal) in found.iter().zip(&proposals) {
            assert_eq!(hypothesis.support, proposal.support);
        }
        let scores: Vec<f64> =
            found.iter().filter_map(|hypothesis| hypothesis.lines.as_ref()?.score).collect();
        assert!(scores[1] < 1e-2 && scores[0] > 10.0 * scores[1], "{scores:?}");
        // Without two clicks there are only patches.
        let proposed = |f| Proposed::by(ProposedBy::Features, f);
        let unclicked =
            [wrong, truth].map(|f| Proposal::of(&proposed(f.rescaled([2.0; 2])?), None, 0.0, fine));
        let unclicked = unclicked.map(|proposal| proposal.filter(|p| p.angles.is_none()).unwrap());
        let without_lines = super::hypotheses(None, &unclicked, fine);
        assert!(without_lines.iter().all(|hypothesis| hypothesis.lines.is_none()));
        for (without, with) in without_lines.iter().zip(&found) {
            assert_eq!(without.support.matches, with.support.matches);
            assert!((without.fundamental.matrix() - with.fundamental.matrix()).norm() < 1e-9);
        }
    }
}
