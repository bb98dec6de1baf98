//! Which κ the patches vote for, given one line pair through each click.
//!
//! With `(lp, lp2)` and `(lq, lq2)` fixed, one pair of look-alike corners `(x1, x2)` determines κ:
//!
//! ```text
//!     ln κ = [ln lp2·x2 − ln lp·x1] + [ln lq·x1 − ln lq2·x2]
//! ```
//!
//! Each bracket depends on one click's line pair alone, so it is computed once per candidate; a combination of
//! two candidates costs one addition per corner pair and one histogram. True corner pairs agree on one κ,
//! chance pairs spread out. That makes tens of thousands of combinations affordable where the bisector search
//! of the paper affords some two thousand.
//!
//! A pair votes only when its points lie on the same side of each click's line in both images, as points in
//! front of both cameras must.

use super::feature_support::FLOOR;
use super::support::Support;
use crate::estimate::lines::{Candidate, PencilAngles};
use crate::geometry::{Line, PointPair};

/// Bins of the histogram of ln κ and their width.
const BINS: usize = 448;
const BIN: f32 = 1.0 / 64.0;
/// Widest vote that counts, half of it, in bins.
const WIDEST: f32 = 32.0;
const LOWEST: f32 = -(BINS as f32) * BIN / 2.0;

/// Corner pairs that vote, as points with their weight.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct KappaVoting {
    look_alikes: Vec<(PointPair, f32)>,
}

/// What one candidate line pair contributes to each voter.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct CandidateVotes {
    candidate: Candidate,
    /// Bracket of ln κ for each voter; not a number where it has no vote.
    terms: Vec<f32>,
    /// Inverse distance of the voter's point from the line of image 2, px⁻¹.
    inverse: Vec<f32>,
    line2: Line,
}

/// Working memory of a count.
#[derive(Debug, Default)]
pub(in crate::estimate) struct VoteCount {
    histogram: Vec<f32>,
    middle: Vec<f32>,
    half: Vec<f32>,
}

/// The κ with most votes for one combination of candidates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct VotedKappa {
    pub angles: PencilAngles,
    pub votes: f32,
}

impl KappaVoting {
    /// The best `per_corner` pairs of each corner of image 1.
    pub fn new(support: &Support, per_corner: usize) -> Self {
        let mut look_alikes = Vec::new();
        for group in support.pairs().chunk_by(|a, b| a.corner1 == b.corner1) {
            let mut group: Vec<_> = group.iter().collect();
            group.sort_by(|a, b| b.correlation.total_cmp(&a.correlation).then(a.corner2.cmp(&b.corner2)));
            look_alikes.extend(group.iter().take(per_corner).map(|pair| {
                let point1 = support.corners(0)[pair.corner1 as usize];
                let point2 = support.corners(1)[pair.corner2 as usize];
                (PointPair { point1, point2 }, pair.correlation - FLOOR)
            }));
        }
        Self { look_alikes }
    }

    /// Prepares a candidate through the click `own`; the other click tells the positive sides of its lines.
    /// `first` says whether it is the first click's candidate, whose bracket is `ln d2 − ln d1`.
    pub fn candidate_votes(
        &self,
        candidate: &Candidate,
        own: &PointPair,
        other: &PointPair,
        first: bool,
    ) -> CandidateVotes {
        let line1 = Line::through_at_angle(own.point1, candidate.angles[0]).with_positive_side(other.point1);
        let line2 = Line::through_at_angle(own.point2, candidate.angles[1]).with_positive_side(other.point2);
        let sign = if first { 1.0 } else { -1.0 };
        let (terms, inverse) = self
            .look_alikes
            .iter()
            .map(|(pair, _)| {
                let d1 = line1.signed_distance(pair.point1) as f32;
                let d2 = line2.signed_distance(pair.point2) as f32;
                if d1 * d2 <= 0.0 || d1.abs() < 1.0 || d2.abs() < 1.0 {
                    return (f32::NAN, 1.0);
                }
                (sign * (d2.abs().ln() - d1.abs().ln()), 1.0 / d2.abs())
            })
            .unzip();
        CandidateVotes { candidate: *candidate, terms, inverse, line2 }
    }

    /// Counts the votes of one combination. `band` is how far, in px, a point of image 2 may be from its
    /// epipolar line.
    pub fn count(
        &self,
        p: &CandidateVotes,
        q: &CandidateVotes,
        band: f32,
        counting: &mut VoteCount,
    ) -> VotedKappa {
        let VoteCount { histogram, middle, half } = counting;
        histogram.clear();
        histogram.resize(BINS + 1, 0.0);
        let n = self.look_alikes.len();
        middle.resize(n, 0.0);
        half.resize(n, 0.0);
        let cosine = p.line2.coefficients().xy().dot(&q.line2.coefficients().xy()) as f32;
        // Plain arithmetic first, which the compiler turns into vectors; then the scattered sums.
        for k in 0..n {
            middle[k] = (p.terms[k] + q.terms[k] - LOWEST) / BIN;
            let (a, b) = (p.inverse[k], q.inverse[k]);
            // Change of ln κ, in bins, for a point of image 2 that moves by `band` across its line.
            half[k] = band / BIN * (a * a + b * b - 2.0 * cosine * a * b).max(0.0).sqrt();
        }
        for (k, (_, weight)) in self.look_alikes.iter().enumerate() {
            let (low, high) = (middle[k] - half[k], middle[k] + half[k]);
            // Comparisons with NaN are false: look_alikes without a vote drop out here too. A vote for a seventh of
            // all bins says nothing.
            if low >= 0.0 && high < BINS as f32 && half[k] < WIDEST {
                histogram[low as usize] += weight;
                histogram[high as usize + 1] -= weight;
            }
        }
        let (mut votes, mut running, mut bin) = (0.0, 0.0, BINS / 2);
        let mut width = 0;
        for (k, change) in histogram.iter().enumerate() {
            running += change;
            if running > votes + 1e-4 {
                (votes, bin, width) = (running, k, 1);
            } else if running > votes - 1e-4 && bin + width == k {
                // The middle of a plateau is the best guess.
                width += 1;
            }
        }
        let middle = bin as f32 + width as f32 / 2.0;
        let kappa = f64::from(LOWEST + middle * BIN).exp();
        VotedKappa { angles: PencilAngles { p: p.candidate.angles, q: q.candidate.angles, kappa }, votes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::geometry::Point;

    const BAND: f32 = 2.0;
    const WEIGHT: f32 = 0.25;

    fn voting(pairs: &[PointPair]) -> KappaVoting {
        KappaVoting { look_alikes: pairs.iter().map(|pair| (*pair, WEIGHT)).collect() }
    }

    /// The votes of two candidates with these directions.
    fn votes(voting: &KappaVoting, clicks: &[PointPair; 2], p: [f64; 2], q: [f64; 2]) -> [CandidateVotes; 2] {
        let candidate = |angles| Candidate { angles, cost: 1.0 };
        [
            voting.candidate_votes(&candidate(p), &clicks[0], &clicks[1], true),
            voting.candidate_votes(&candidate(q), &clicks[1], &clicks[0], false),
        ]
    }

    fn counted(voting: &KappaVoting, clicks: &[PointPair; 2], p: [f64; 2], q: [f64; 2]) -> VotedKappa {
        let [p, q] = votes(voting, clicks, p, q);
        voting.count(&p, &q, BAND, &mut VoteCount::default())
    }

    /// Every vote with every other's partner.
    fn mixed(pairs: &[PointPair]) -> Vec<PointPair> {
        let other = |k: usize| pairs[(k * 7 + 3) % pairs.len()].point2;
        pairs.iter().enumerate().map(|(k, pair)| PointPair { point2: other(k), ..*pair }).collect()
    }

    #[test]
    fn true_matches_vote_for_the_true_kappa_among_as_many_wrong_ones() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let (truth, clicks, pairs) = (scene.angles(), scene.clicks(), scene.pairs(50));
            let alone = counted(&voting(&pairs), &clicks, truth.p, truth.q);
            assert_eq!((alone.angles.p, alone.angles.q), (truth.p, truth.q));
            // All votes are centred on the truth, and the middle of the bins they share is within one of it.
            assert!((alone.angles.kappa / truth.kappa).ln().abs() < f64::from(BIN), "{}", alone.angles.kappa);
            // Those next to a click's line say little and may not count.
            assert!(alone.votes > 0.8 * 50.0 * WEIGHT && alone.votes < 50.01 * WEIGHT, "{}", alone.votes);
            let both: Vec<PointPair> = pairs.iter().copied().chain(mixed(&pairs)).collect();
            let among = counted(&voting(&both), &clicks, truth.p, truth.q);
            // Wrong ones may shift the plateau within the widths of the votes.
            assert!((among.angles.kappa / truth.kappa).ln().abs() < 3.0 * f64::from(BIN));
            assert!(among.votes >= alone.votes - 1e-3);
            let wrong = counted(&voting(&pairs), &clicks, [truth.p[0], truth.p[1] + 0.3], truth.q);
            assert!(wrong.votes < 0.8 * alone.votes, "{} {}", wrong.votes, alone.votes);
        }
    }

    #[test]
    fn points_on_opposite_sides_of_a_line_have_no_vote() {
        let clicks = [PointPair::new(100.0, 50.0, 90.0, 50.0), PointPair::new(200.0, 200.0, 180.0, 200.0)];
        let at =
            |y1: f64, y2: f64| PointPair { point1: Point::new(150.0, y1), point2: Point::new(140.0, y2) };
        let pairs = [at(120.0, 120.0), at(120.0, 30.0), at(30.0, 30.0), at(50.5, 120.0), at(120.0, 50.5)];
        let voting = voting(&pairs);
        let [p, q] = votes(&voting, &clicks, [0.0; 2], [0.0; 2]);
        let has_vote = |votes: &CandidateVotes| votes.terms.iter().map(|t| t.is_finite()).collect::<Vec<_>>();
        // Nor have those within a pixel of it, whose distance is mostly error.
        assert_eq!(has_vote(&p), [true, false, true, false, false]);
        assert_eq!(has_vote(&q), [true; 5]);
        let found = counted(&voting, &clicks, [0.0; 2], [0.0; 2]);
        assert!((found.votes - 2.0 * WEIGHT).abs() < 1e-6 && found.angles.kappa.ln().abs() < f64::from(BIN));
    }

    #[test]
    fn kappa_is_the_ratio_of_ratios_of_distances() {
        let clicks = [PointPair::new(100.0, 50.0, 90.0, 40.0), PointPair::new(200.0, 200.0, 180.0, 220.0)];
        for kappa in [2.0, 0.6] {
            // Rows: (d2 from p over d1 from p) over (d2 from q over d1 from q) is κ.
            let pairs: Vec<PointPair> = (0..12)
                .map(|k| {
                    let y1 = 80.0 + 8.0 * f64::from(k);
                    let ratio = kappa * (y1 - 50.0) / (200.0 - y1);
                    PointPair::new(150.0, y1, 140.0, (40.0 + 220.0 * ratio) / (1.0 + ratio))
                })
                .collect();
            let found = counted(&voting(&pairs), &clicks, [0.0; 2], [0.0; 2]);
            assert!((found.votes - 12.0 * WEIGHT).abs() < 1e-6);
            assert!((found.angles.kappa / kappa).ln().abs() < f64::from(BIN), "{}", found.angles.kappa);
        }
    }

    #[test]
    fn votes_that_are_too_wide_say_nothing() {
        let clicks = [PointPair::new(100.0, 50.0, 90.0, 50.0), PointPair::new(200.0, 200.0, 180.0, 200.0)];
        // A point 2.5 px from the line: the band is then some ±0.8 of ln κ, beyond half a unit.
        for (y, expected) in [(52.5, 0.0), (60.0, WEIGHT)] {
            let voting = voting(&[PointPair::new(150.0, y, 140.0, y)]);
            let found = counted(&voting, &clicks, [0.0; 2], [0.0; 2]);
            assert!((found.votes - expected).abs() < 1e-6, "{y}: {}", found.votes);
        }
    }

    #[test]
    fn a_few_look_alikes_of_each_corner_vote_by_their_excess() {
        let corners = [vec![Point::new(10.0, 20.0)], (0..4).map(|k| Point::new(f64::from(k), 0.0)).collect()];
        let alike =
            |corner2, correlation| super::super::support::Putative { corner1: 0, corner2, correlation };
        let pairs = vec![alike(0, 0.7), alike(1, 0.9), alike(2, 0.9), alike(3, 0.8)];
        let voting = KappaVoting::new(&Support::of_look_alikes(corners, pairs), 3);
        let found: Vec<(f64, f32)> = voting.look_alikes.iter().map(|(m, w)| (m.point2.x, *w)).collect();
        let excess = |correlation: f32| correlation - FLOOR;
        assert_eq!(found, [(1.0, excess(0.9)), (2.0, excess(0.9)), (3.0, excess(0.8))]);
    }
}
