//! Proposals: lines propose, patches decide.
//!
//! 1. Many combinations of candidate line pairs are scored by the κ votes of look-alike corners.
//! 2. The best are thinned so that no two are near-copies, and scored by exact patch support.
//!
//! [`super::rank`] refits those with most support, and [`super::resampling`] draws further
//! hypotheses from their matches.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::support::{BAND, PatchSupport, SupportLevel};
use super::voting::{CandidateVotes, KappaVoting, VotedKappa};
use crate::cancel::CancelFlag;
use crate::estimate::EstimateError;
use crate::estimate::evidence::lines::{
    Candidate, LineFigures, PencilAngles, PencilPair, of_line_pairs, unvalidated_figures,
};
use crate::estimate::{Origin, Proposed};
use crate::geometry::{FundamentalMatrix, PointPair};

/// Hypothesis at one level.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Proposal {
    pub origin: Origin,
    /// Lines through two clicks, and κ: those of `origin`, or lines from which the search for lines of the matrix
    /// starts. `None` without two clicks.
    pub angles: Option<PencilAngles>,
    /// The matrix, in pixels of the level.
    pub fundamental: FundamentalMatrix,
    /// Support at the level.
    pub support: PatchSupport,
}

/// A proposal in full-size pixels.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Hypothesis {
    pub origin: Origin,
    pub fundamental: FundamentalMatrix,
    /// Figures of the lines through two clicks, if there are two.
    pub lines: Option<LineFigures>,
    /// Support at the level where it was proposed.
    pub support: PatchSupport,
}

impl Proposal {
    /// Sorts proposals by support, best first. Equals keep their order.
    pub fn sort(list: &mut [Self]) {
        list.sort_by(|a, b| b.support.score.total_cmp(&a.support.score));
    }

    /// Returns a matrix in full-size pixels as a proposal of a level. `turn` is the approximate
    /// rotation of image 2 against image 1, radians. Returns `None` if there are clicks and the
    /// lines at the clicks degenerate.
    pub fn of(
        proposed: &Proposed,
        clicks: Option<&[PointPair; 2]>,
        turn: f64,
        level: &SupportLevel,
    ) -> Option<Self> {
        let Proposed { fundamental: f, origin } = proposed;
        let fundamental = f.rescaled(level.scales)?;
        let support = level.support.measure(&fundamental);
        let angles = clicks.map_or(Some(None), |clicks| PencilAngles::of(f, clicks, turn).map(Some))?;
        Some(Self { origin: *origin, angles, fundamental, support })
    }

    /// Returns the hypothesis before its lines are compared. `clicks` are in full-size pixels;
    /// `scales` are the scales of the level.
    pub fn unvalidated(&self, scales: [f64; 2], clicks: [PointPair; 2]) -> Option<Hypothesis> {
        let lines =
            self.angles.map_or(Some(None), |angles| unvalidated_figures(&angles, clicks).map(Some))?;
        let (origin, support) = (self.origin, self.support);
        Some(Hypothesis { origin, fundamental: self.full_size(scales)?, lines, support })
    }

    pub fn full_size(&self, scales: [f64; 2]) -> Option<FundamentalMatrix> {
        self.fundamental.rescaled(scales.map(f64::recip))
    }

    /// Returns the matrix in full-size pixels, with its origin. `scales` are the scales of the level.
    pub fn proposed(&self, scales: [f64; 2]) -> Option<Proposed> {
        Some(Proposed { fundamental: self.full_size(scales)?, origin: self.origin })
    }
}

/// Number of combinations kept before thinning, for each one whose exact support is computed. Many
/// are copies, so fewer may leave places empty.
const THINNING: usize = 12;
/// Difference of directions, radians, and of ln κ, below which combinations are copies of each
/// other. A rotation by this angle moves a line by 2 px, the band of support, at some 70 px from
/// the click.
const COPY: f64 = 0.03;

/// Scores combinations of `candidates` by votes and exact support. Returns the best `supported`, best first. All
/// clicks are in full-size pixels.
pub(in crate::estimate) fn propose(
    coarse: &SupportLevel,
    voting: &KappaVoting,
    candidates: [&[Candidate]; 2],
    drawn: &[(Candidate, Candidate)],
    clicks: &[PointPair; 2],
    supported: usize,
    cancel: &CancelFlag,
) -> Result<Vec<Proposal>, EstimateError> {
    let clicks = clicks.each_ref().map(|click| click.rescaled(coarse.scales));
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
        .map(|(p, q)| {
            if cancel.is_cancelled() {
                return None;
            }
            Some(voting.count(votes_of(p, &votes_p), votes_of(q, &votes_q), BAND as f32))
        })
        .flatten()
        .collect();
    cancel.check()?;
    voted.sort_by(|a, b| b.votes.total_cmp(&a.votes));
    voted.truncate(THINNING * supported);
    let mut proposals: Vec<Proposal> = thinned(&voted, supported)
        .par_iter()
        .filter_map(|voted| {
            let fundamental = PencilPair::new(&voted.angles, clicks)?.fundamental()?;
            Some(Proposal {
                origin: of_line_pairs(&voted.angles, candidates),
                angles: Some(voted.angles),
                fundamental,
                support: coarse.support.measure(&fundamental),
            })
        })
        .collect();
    cancel.check()?;
    Proposal::sort(&mut proposals);
    Ok(proposals)
}

fn by_directions(a: &Candidate, b: &Candidate) -> Ordering {
    a.angles[0].total_cmp(&b.angles[0]).then(a.angles[1].total_cmp(&b.angles[1]))
}

/// Returns the votes of a candidate in a list sorted by directions.
fn votes_of<'a>(
    candidate: &Candidate,
    (list, votes): &'a (Vec<Candidate>, Vec<CandidateVotes>),
) -> &'a CandidateVotes {
    &votes[list.partition_point(|other| by_directions(other, candidate).is_lt())]
}

/// Returns the best of a list sorted by votes, without near-copies of better ones.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::ProposedBy;
    use crate::estimate::evidence::patches::support::Support;
    use crate::estimate::exact::ExactScene;

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

    #[test]
    fn a_copy_is_near_in_all_five_numbers() {
        let first = PencilAngles { p: [0.1, 0.2], q: [0.3, 0.4], kappa: 2.0 };
        let moved = |by: f64| {
            let PencilAngles { p: [a, b], q: [c, d], kappa } = first;
            [
                PencilAngles { p: [a + by, b], ..first },
                PencilAngles { p: [a, b - by], ..first },
                PencilAngles { q: [c - by, d], ..first },
                PencilAngles { q: [c, d + by], ..first },
                PencilAngles { kappa: kappa * by.exp(), ..first },
            ]
        };
        for (by, kept) in [(0.99 * COPY, 1), (1.01 * COPY, 2)] {
            for angles in moved(by) {
                let voted = [first, angles].map(|angles| VotedKappa { angles, votes: 1.0 });
                assert_eq!(thinned(&voted, 10).len(), kept, "{angles:?}");
            }
        }
    }

    /// Proposes from exact matches at half size and candidates that include the true directions.
    fn proposed(scene: &ExactScene, cancel: &CancelFlag) -> Result<Vec<Proposal>, EstimateError> {
        let matches: Vec<_> = scene.pairs(60).iter().map(|m| (m.rescaled([0.5; 2]), 0.9)).collect();
        let coarse = SupportLevel { scales: [0.5; 2], support: Support::of_matches(&matches) };
        let voting = KappaVoting::new(&coarse.support, 3);
        let truth = scene.angles();
        let turns = [-0.4, -0.2, 0.2, 0.0, 0.4];
        let of = |angles: [f64; 2], turn: f64| Candidate { angles: [angles[0], angles[1] + turn], cost: 1.0 };
        let [p, q] = [truth.p, truth.q].map(|angles| turns.map(|turn| of(angles, turn)));
        let drawn: Vec<(Candidate, Candidate)> =
            p.iter().flat_map(|a| q.iter().map(move |b| (*a, *b))).collect();
        propose(&coarse, &voting, [&p, &q], &drawn, &scene.clicks(), 240, cancel)
    }

    #[test]
    fn the_combination_with_most_support_comes_first() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let found = proposed(&scene, &CancelFlag::default()).unwrap();
            assert!(found.len() > 5 && found.is_sorted_by(|a, b| a.support.score >= b.support.score));
            let (best, truth) = (&found[0], scene.angles());
            assert_eq!(best.angles.map(|angles| (angles.p, angles.q)), Some((truth.p, truth.q)));
            assert_eq!(best.origin, Origin::from(ProposedBy::LinePairs { ranks: [4, 4] }));
            assert!(best.support.matches > 55 && best.support.score > 1.5 * found[1].support.score);
            // κ is exact to a bin of the votes, 1.6 %: about a pixel for lines some hundred pixels
            // apart.
            let error = scene.error(&best.full_size([0.5; 2]).unwrap());
            assert!(error < 1.5, "{error} px");
        }
    }

    #[test]
    fn a_stopped_search_proposes_nothing() {
        let flag = CancelFlag::default();
        flag.cancel();
        let stopped = proposed(&ExactScene::aside(), &flag);
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
