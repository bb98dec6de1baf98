//! Proposals: line similarity proposes, patches dispose.
//!
//! 1. Many combinations of candidate line pairs are scored by the κ votes of look-alike corners.
//! 2. The best, thinned so that no two are near-copies, are scored by exact patch support.
//!
//! [`super::rank`] refits those with most support; what their matches lead to is looked for by [`super::resampling`].

use std::cmp::Ordering;

use rayon::prelude::*;

use super::support::{BAND, SupportLevel};
use super::voting::{CandidateVotes, KappaVoting, VoteCount, VotedKappa};
use crate::estimate::lines::{Candidate, PencilAngles, PencilPair, unvalidated_figures};
use crate::estimate::result::REPORTED;
use crate::estimate::{Assessment, Estimate, EstimateError, Monitor, PatchSupport};
use crate::geometry::{FundamentalMatrix, PointPair};

/// A hypothesis at one level.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Proposal {
    /// The line pairs and κ it was proposed with.
    pub angles: PencilAngles,
    /// Its matrix, in pixels of the level.
    pub fundamental: FundamentalMatrix,
    /// What agrees with it at the level.
    pub support: PatchSupport,
}

impl Proposal {
    /// Brings those with most support to the front; equals keep their order.
    pub fn sort(list: &mut [Self]) {
        list.sort_by(|a, b| b.support.score.total_cmp(&a.support.score));
    }

    /// Its matrix in full-size pixels.
    pub fn full_size(&self, scales: [f64; 2]) -> Option<FundamentalMatrix> {
        self.fundamental.rescaled(1.0 / scales[0], 1.0 / scales[1])
    }
}

/// Combinations whose exact support is computed.
const EXACT: usize = 240;
/// Combinations kept for thinning, for each one that is scored exactly.
const THINNING: usize = 12;
/// Combinations whose directions differ by less than this, radians, and whose κ by less than this factor, are copies of
/// each other: a line turned by it moves by 2 px, the width of the support band, within some 70 px of the click.
const COPY: f64 = 0.03;

/// Scores combinations by votes and exact support; best first. All clicks are in full-size pixels.
pub(in crate::estimate) fn propose(
    coarse: &SupportLevel,
    voting: &KappaVoting,
    drawn: &[(Candidate, Candidate)],
    clicks: &[PointPair; 2],
    third: Option<&PointPair>,
    monitor: &Monitor,
) -> Result<Vec<Proposal>, EstimateError> {
    let clicks = clicks.each_ref().map(|click| click.rescaled(coarse.scales));
    let third = third.map(|pair| pair.rescaled(coarse.scales));
    let [p, q] = &clicks;
    let prepare = |mut list: Vec<Candidate>, own: &PointPair, other: &PointPair, first: bool| {
        list.sort_by(by_directions);
        list.dedup();
        let votes: Vec<CandidateVotes> =
            list.par_iter().map(|c| voting.candidate_votes(c, own, other, first)).collect();
        (list, votes)
    };
    let votes_p = prepare(drawn.iter().map(|(p, _)| *p).collect(), p, q, true);
    let votes_q = prepare(drawn.iter().map(|(_, q)| *q).collect(), q, p, false);
    let mut voted: Vec<VotedKappa> = drawn
        .par_iter()
        .map_init(VoteCount::default, |counting, (p, q)| {
            if monitor.is_cancelled() {
                return None;
            }
            let (p, q) = (votes_of(p, &votes_p), votes_of(q, &votes_q));
            match &third {
                None => Some(voting.count(p, q, BAND as f32, counting)),
                Some(pair) => {
                    let angles = PencilAngles { p: p.angles(), q: q.angles(), kappa: 1.0 };
                    let kappa = PencilPair::new(&angles, clicks)?.map().kappa_from_point_pair(pair)?;
                    (kappa > 0.0).then(|| voting.count_for(p, q, BAND as f32, kappa))
                }
            }
        })
        .flatten()
        .collect();
    monitor.check()?;
    voted.sort_by(|a, b| b.votes.total_cmp(&a.votes));
    voted.truncate(THINNING * EXACT);
    let mut proposals: Vec<Proposal> = thinned(&voted, EXACT)
        .par_iter()
        .filter_map(|voted| {
            let fundamental = PencilPair::new(&voted.angles, clicks)?.fundamental()?;
            Some(Proposal {
                angles: voted.angles,
                fundamental,
                support: coarse.support.measure(&fundamental),
            })
        })
        .collect();
    monitor.check()?;
    Proposal::sort(&mut proposals);
    Ok(proposals)
}

fn by_directions(a: &Candidate, b: &Candidate) -> Ordering {
    a.angles[0].total_cmp(&b.angles[0]).then(a.angles[1].total_cmp(&b.angles[1]))
}

/// Those of a candidate in a list sorted by directions.
fn votes_of<'a>(
    candidate: &Candidate,
    (list, votes): &'a (Vec<Candidate>, Vec<CandidateVotes>),
) -> &'a CandidateVotes {
    &votes[list.partition_point(|other| by_directions(other, candidate).is_lt())]
}

/// The best ones of a list sorted by votes, none nearly the same as one before it.
fn thinned(voted: &[VotedKappa], count: usize) -> Vec<VotedKappa> {
    let near = |a: f64, b: f64| (a - b).abs() < COPY;
    let is_copy = |a: &PencilAngles, b: &PencilAngles| {
        (0..2).all(|i| near(a.p[i], b.p[i]) && near(a.q[i], b.q[i])) && near(a.kappa.ln(), b.kappa.ln())
    };
    let mut kept: Vec<VotedKappa> = Vec::with_capacity(count);
    for candidate in voted {
        if kept.len() == count {
            break;
        }
        if !kept.iter().any(|k| is_copy(&k.angles, &candidate.angles)) {
            kept.push(*candidate);
        }
    }
    kept
}

/// The best proposals in full-size pixels before their lines are compared, to draw at once. `clicks` are in full-size
/// pixels, `scales` those of the level.
pub(in crate::estimate) fn unvalidated(
    proposals: &[Proposal],
    scales: [f64; 2],
    clicks: [PointPair; 2],
) -> Vec<Estimate> {
    let hypothesis = |proposal: &Proposal| {
        let assessment = Assessment {
            lines: Some(unvalidated_figures(&proposal.angles, clicks)?),
            support: Some(proposal.support),
            ..Assessment::default()
        };
        Some(Estimate { geometry: proposal.full_size(scales)?.into(), assessment, trace: None })
    };
    proposals.iter().take(REPORTED).filter_map(hypothesis).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_copies_of_better_combinations_are_left_out() {
        let voted = |turn: f64, kappa: f64, votes: f32| VotedKappa {
            angles: PencilAngles { p: [0.1 + turn, 0.2], q: [0.3, 0.4], kappa },
            votes,
        };
        let all = [voted(0.0, 1.0, 9.0), voted(0.02, 1.01, 8.0), voted(0.04, 1.0, 7.0), voted(0.0, 1.2, 6.0)];
        let kept: Vec<f32> = thinned(&all, 10).iter().map(|voted| voted.votes).collect();
        assert_eq!(kept, [9.0, 7.0, 6.0]);
        assert_eq!(thinned(&all, 1).len(), 1);
    }
}
