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

use super::support::{FLOOR, Support};
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
    /// Its bracket of ln κ; not a number where the voter has no vote.
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

impl CandidateVotes {
    /// Directions of the candidate's lines.
    pub fn angles(&self) -> [f64; 2] {
        self.candidate.angles
    }
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

    /// The votes for a given κ.
    pub fn count_for(&self, p: &CandidateVotes, q: &CandidateVotes, band: f32, kappa: f64) -> VotedKappa {
        let cosine = p.line2.coefficients().xy().dot(&q.line2.coefficients().xy()) as f32;
        let target = kappa.ln() as f32;
        let votes = (0..self.look_alikes.len())
            .filter(|k| {
                let (a, b) = (p.inverse[*k], q.inverse[*k]);
                let half = band * (a * a + b * b - 2.0 * cosine * a * b).max(0.0).sqrt();
                (p.terms[*k] + q.terms[*k] - target).abs() <= half
            })
            .map(|k| self.look_alikes[k].1)
            .sum();
        VotedKappa { angles: PencilAngles { p: p.candidate.angles, q: q.candidate.angles, kappa }, votes }
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
