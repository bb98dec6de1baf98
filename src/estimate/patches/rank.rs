//! Ranking proposals by patch support: refitted at two sizes, with what resampling their matches adds.

use rayon::prelude::*;

use super::Proposal;
use super::polish::{COARSE, FINE, polish};
use super::resampling::{Drawing, resample};
use super::support::{BAND, Support, SupportLevel};
use crate::estimate::lines::{LineExaminer, PencilAngles};
use crate::estimate::{Assessment, Estimate, EstimateError, Monitor, Parameters};
use crate::geometry::{PointPair, symmetric_epipolar_distance};

/// Growth of the best support in a round of resampling below which it is the last one.
const SETTLED: f64 = 1.01;

/// The proposals polished at the coarse and the fine level, with what resampling their matches adds; best first, in
/// pixels of the fine level. `clicks` are all that take part in fits, full-size pixels.
pub(in crate::estimate) fn rank(
    coarse: &SupportLevel,
    fine: &SupportLevel,
    proposals: &[Proposal],
    clicks: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Vec<Proposal>, EstimateError> {
    let polished = polish(coarse, proposals, &COARSE, clicks, parameters.click_sigma, monitor)?;
    let ratios = [fine.scales[0] / coarse.scales[0], fine.scales[1] / coarse.scales[1]];
    let at_fine = |proposal: &Proposal| {
        let fundamental = proposal.fundamental.rescaled(ratios[0], ratios[1])?;
        let support = fine.support.measure(&fundamental);
        Some(Proposal { fundamental, support, angles: proposal.angles })
    };
    let mut starts: Vec<Proposal> = polished.par_iter().filter_map(at_fine).collect();
    Proposal::sort(&mut starts);
    let polish_fine =
        |starts: &[Proposal]| polish(fine, starts, &FINE, clicks, parameters.click_sigma, monitor);
    let mut ranked = polish_fine(&starts)?;
    // The rest stay in the list as they are, and so does what was proposed: among them are the runners-up.
    ranked.extend(starts.drain(starts.len().min(FINE.count)..));
    let proposed: Vec<Proposal> = proposals.par_iter().filter_map(at_fine).collect();
    ranked.extend(proposed);
    let at_level: Vec<PointPair> = clicks.iter().map(|click| click.rescaled(fine.scales)).collect();
    for round in 0..parameters.patches.resampling as u64 {
        Proposal::sort(&mut ranked);
        let before = ranked.first().map_or(0.0, |leader| leader.support.score);
        let drawing = Drawing {
            clicks: &at_level,
            parallax: parameters.patches.parallax,
            // Rounds must not repeat each other, with any seed.
            seed: parameters.seed.wrapping_mul(64).wrapping_add(round),
        };
        let polished = polish_fine(&resample(&fine.support, &ranked, &drawing, monitor)?)?;
        let after = polished.first().map_or(0.0, |best| best.support.score);
        ranked.extend(polished);
        if after < SETTLED * before {
            break;
        }
    }
    Proposal::sort(&mut ranked);
    Ok(ranked)
}

/// Matches of a hypothesis that others are compared on.
const COMPARED: usize = 60;
/// A hypothesis that passes within this distance of most of them says nothing new, px of the level: what the band of
/// support and the width of a corner leave open.
const NEAR: f64 = 3.0;

/// The best `count` hypotheses of a ranked list that say something new: whoever explains four fifths of the
/// matches of a better one is left out. Geometries that agree wherever the scene is are the same to the user.
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

/// Proposals of the fine level as hypotheses in full-size pixels, with what the lines say of them; their order stays.
pub(in crate::estimate) fn hypotheses(
    examiner: &LineExaminer,
    proposals: &[Proposal],
    fine: &SupportLevel,
) -> Vec<Estimate> {
    let own = examiner.clicks.map(|click| click.rescaled(fine.scales));
    // κ where the scene is.
    let angles: Vec<PencilAngles> = proposals
        .par_iter()
        .map(|proposal| {
            let matches = fine.support.matches(&proposal.fundamental, BAND);
            let pairs = matches.iter().map(|m| m.pair);
            PencilAngles::nearest(&proposal.fundamental, &own, &proposal.angles, pairs)
                .unwrap_or(proposal.angles)
        })
        .collect();
    proposals
        .iter()
        .zip(examiner.figures(&angles))
        .filter_map(|(proposal, lines)| {
            let assessment =
                Assessment { lines: Some(lines?), support: Some(proposal.support), ..Assessment::default() };
            Some(Estimate { geometry: proposal.full_size(fine.scales)?.into(), assessment, trace: None })
        })
        .collect()
}
