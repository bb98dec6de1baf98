//! Votes of patches for κ, given one line pair through each click.
//!
//! With `(lp, lp2)` and `(lq, lq2)` fixed, one pair of look-alike corners `(x1, x2)` determines κ:
//!
//! ```text
//!     ln κ = [ln lp2·x2 − ln lp·x1] + [ln lq·x1 − ln lq2·x2]
//! ```
//!
//! Each bracket depends on the line pair of one click alone, so it is computed once per candidate.
//! A combination of two candidates then costs one addition per corner pair, and one histogram.
//! Correct corner pairs agree on one κ; chance pairs spread out. Tens of thousands of combinations
//! take as long as some two thousand bisector searches of the paper.
//!
//! A pair votes only when its points lie on the same side of each click's line in both images, as
//! points in front of both cameras must.

use multiversion::multiversion;

use super::feature_support::FLOOR;
use super::support::Support;
use crate::estimate::evidence::lines::{Candidate, PencilAngles};
use crate::geometry::{Line, PointPair};
use crate::lanes::{LANES, SetLanes};

/// Number of bins of the histogram of ln κ, which covers ±3.5. Beyond, a pencil is squeezed more
/// than thirtyfold.
const BINS: usize = 448;
/// Width of a bin of ln κ: 1.6 %. The error of a corner, 1 px across its line, changes κ by as much
/// 64 px from the line of a click.
const BIN: f32 = 1.0 / 64.0;
/// Largest half width of a vote, in bins: beyond half a unit of ln κ a match does not determine κ.
const WIDEST: f32 = 0.5 / BIN;
const LOWEST: f32 = -(BINS as f32) * BIN / 2.0;

/// Corner pairs that vote, as points with weights.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct KappaVoting {
    blocks: Vec<Voters>,
}

type Lanes = [f32; LANES];

/// Points of a block of voters in both images, and their weights; 0 in empty lanes.
#[derive(Debug, Clone, Copy, Default)]
struct Voters {
    x1: Lanes,
    y1: Lanes,
    x2: Lanes,
    y2: Lanes,
    weight: Lanes,
}

/// Contribution of one candidate line pair to a block of voters.
#[derive(Debug, Clone, Copy)]
struct Terms {
    /// Bracket of ln κ for each voter; NaN without a vote.
    bracket: Lanes,
    /// Inverse distance of the voter's point from the line of image 2, px⁻¹.
    inverse: Lanes,
}

/// Contribution of one candidate line pair to all voters.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct CandidateVotes {
    candidate: Candidate,
    terms: Vec<Terms>,
    line2: Line,
}

/// The κ with most votes for one combination of candidates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct VotedKappa {
    pub angles: PencilAngles,
    pub votes: f32,
}

impl KappaVoting {
    /// Takes the best `per_corner` pairs of each corner of image 1.
    pub fn new(support: &Support, per_corner: usize) -> Self {
        let groups = support.pairs.chunk_by(|a, b| a.corner1 == b.corner1);
        let best = groups.flat_map(|group| group.iter().take(per_corner));
        let weighted = best.map(|m| (support.pair(m), m.correlation - FLOOR));
        Self::of_look_alikes(&weighted.collect::<Vec<_>>())
    }

    fn of_look_alikes(look_alikes: &[(PointPair, f32)]) -> Self {
        let block = |few: &[(PointPair, f32)]| {
            let mut voters = Voters::default();
            for (lane, (PointPair { point1, point2 }, weight)) in few.iter().enumerate() {
                (voters.x1[lane], voters.y1[lane]) = (point1.x as f32, point1.y as f32);
                (voters.x2[lane], voters.y2[lane]) = (point2.x as f32, point2.y as f32);
                voters.weight[lane] = *weight;
            }
            voters
        };
        Self { blocks: look_alikes.chunks(LANES).map(block).collect() }
    }

    /// Prepares a candidate through the click `own`. The other click tells the positive sides of
    /// its lines. `first` tells whether the candidate belongs to the first click; its bracket is
    /// then `ln d2 − ln d1`.
    pub fn candidate_votes(
        &self,
        candidate: &Candidate,
        own: &PointPair,
        other: &PointPair,
        first: bool,
    ) -> CandidateVotes {
        let line1 = Line::through_at_angle(own.point1, candidate.angles[0]).with_positive_side(other.point1);
        let line2 = Line::through_at_angle(own.point2, candidate.angles[1]).with_positive_side(other.point2);
        let coefficients = [line1, line2].map(|line| [0, 1, 2].map(|k| line.coefficients()[k] as f32));
        let terms = terms(&self.blocks, &coefficients, if first { 1.0 } else { -1.0 });
        CandidateVotes { candidate: *candidate, terms, line2 }
    }

    /// Counts the votes of one combination. `band` is the largest distance of a point of image 2
    /// from its epipolar line, px.
    pub fn count(&self, p: &CandidateVotes, q: &CandidateVotes, band: f32) -> VotedKappa {
        let cosine = p.line2.coefficients().xy().dot(&q.line2.coefficients().xy()) as f32;
        let histogram = histogram(&self.blocks, &p.terms, &q.terms, cosine, band);
        let (mut votes, mut running, mut bin) = (0.0, 0.0, BINS / 2);
        let mut width = 0;
        for (k, change) in histogram[..=BINS].iter().enumerate() {
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

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn terms(blocks: &[Voters], [line1, line2]: &[[f32; 3]; 2], sign: f32) -> Vec<Terms> {
    let mut all = Vec::with_capacity(blocks.len());
    for voters in blocks {
        let mut terms = Terms { bracket: [0.0; LANES], inverse: [0.0; LANES] };
        for k in 0..LANES {
            let d1 = line1[0] * voters.x1[k] + line1[1] * voters.y1[k] + line1[2];
            let d2 = line2[0] * voters.x2[k] + line2[1] * voters.y2[k] + line2[2];
            // Within a pixel the distance is mostly error.
            let has_vote = d1 * d2 > 0.0 && d1.abs() >= 1.0 && d2.abs() >= 1.0;
            let ratio = if has_vote { d2 / d1 } else { 1.0 };
            terms.bracket[k] = if has_vote { sign * logarithm(ratio) } else { f32::NAN };
            terms.inverse[k] = if has_vote { 1.0 / d2.abs() } else { 1.0 };
        }
        all.push(terms);
    }
    all
}

/// Returns the natural logarithm of a normal positive number, in a form that compilers vectorise:
/// `ln 2ᵉm = e ln 2 + ln m`. The series of `ln m = 2 artanh((m − 1)/(m + 1))` is good to single
/// precision for m between √½ and √2.
#[inline(always)]
fn logarithm(x: f32) -> f32 {
    // After subtracting the bits of √½, the exponent is correct and the mantissa starts at √½.
    const HALF_ROOT: u32 = 0x3f35_04f3;
    let above = x.to_bits().wrapping_sub(HALF_ROOT);
    let exponent = (above as i32 >> 23) as f32;
    let m = f32::from_bits((above & 0x007f_ffff).wrapping_add(HALF_ROOT));
    let s = (m - 1.0) / (m + 1.0);
    let t = s * s;
    let series = 2.0 + t * (2.0 / 3.0 + t * (2.0 / 5.0 + t * (2.0 / 7.0 + t * (2.0 / 9.0))));
    exponent * std::f32::consts::LN_2 + s * series
}

/// Size of the histogram: all bins and one more, a power of two.
const ROOM: usize = (BINS + 1).next_power_of_two();

/// Returns the changes of the number of votes from bin to bin.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn histogram(blocks: &[Voters], p: &[Terms], q: &[Terms], cosine: f32, band: f32) -> [f32; ROOM] {
    let mut histogram = [0f32; ROOM];
    for (voters, (p, q)) in blocks.iter().zip(p.iter().zip(q)) {
        let mut bins = [[0i32; LANES]; 2];
        let mut votes = [0u8; LANES];
        for k in 0..LANES {
            let middle = (p.bracket[k] + q.bracket[k] - LOWEST) / BIN;
            let (a, b) = (p.inverse[k], q.inverse[k]);
            // Change of ln κ, in bins, for a point of image 2 that moves by `band` across its line.
            let square = a * a + b * b - 2.0 * cosine * a * b;
            let half = band / BIN * (if square > 0.0 { square } else { 0.0 }).sqrt();
            let (low, high) = (middle - half, middle + half);
            // Comparisons with NaN are false, so voters without a vote drop out here. A vote for a
            // seventh of all bins is too vague.
            let counts = low >= 0.0 && high < BINS as f32 && half < WIDEST;
            votes[k] = u8::from(counts);
            bins[0][k] = (if counts { low } else { 0.0 }) as i32;
            bins[1][k] = (if counts { high } else { 0.0 }) as i32;
        }
        for k in SetLanes::of(votes) {
            histogram[bins[0][k] as usize % ROOM] += voters.weight[k];
            histogram[(bins[1][k] + 1) as usize % ROOM] -= voters.weight[k];
        }
    }
    histogram
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::geometry::Point;

    const BAND: f32 = 2.0;
    const WEIGHT: f32 = 0.25;

    fn voting(pairs: &[PointPair]) -> KappaVoting {
        KappaVoting::of_look_alikes(&pairs.iter().map(|pair| (*pair, WEIGHT)).collect::<Vec<_>>())
    }

    /// Returns the votes of two candidates with these directions.
    fn votes(voting: &KappaVoting, clicks: &[PointPair; 2], p: [f64; 2], q: [f64; 2]) -> [CandidateVotes; 2] {
        let candidate = |angles| Candidate { angles, cost: 1.0 };
        [
            voting.candidate_votes(&candidate(p), &clicks[0], &clicks[1], true),
            voting.candidate_votes(&candidate(q), &clicks[1], &clicks[0], false),
        ]
    }

    fn counted(voting: &KappaVoting, clicks: &[PointPair; 2], p: [f64; 2], q: [f64; 2]) -> VotedKappa {
        let [p, q] = votes(voting, clicks, p, q);
        voting.count(&p, &q, BAND)
    }

    /// Returns each voter with the partner of another.
    fn mixed(pairs: &[PointPair]) -> Vec<PointPair> {
        let other = |k: usize| pairs[(k * 7 + 3) % pairs.len()].point2;
        pairs.iter().enumerate().map(|(k, pair)| PointPair { point2: other(k), ..*pair }).collect()
    }

    #[test]
    fn correct_matches_vote_for_the_true_kappa_among_as_many_wrong_ones() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let (truth, clicks, pairs) = (scene.angles(), scene.clicks(), scene.pairs(50));
            let alone = counted(&voting(&pairs), &clicks, truth.p, truth.q);
            assert_eq!((alone.angles.p, alone.angles.q), (truth.p, truth.q));
            // All votes are centred on the truth, and the middle of their common bins is within a
            // bin of it.
            assert!((alone.angles.kappa / truth.kappa).ln().abs() < f64::from(BIN), "{}", alone.angles.kappa);
            // Voters next to a click's line are vague and may not count.
            assert!(alone.votes > 0.8 * 50.0 * WEIGHT && alone.votes < 50.01 * WEIGHT, "{}", alone.votes);
            let both: Vec<PointPair> = pairs.iter().copied().chain(mixed(&pairs)).collect();
            let among = counted(&voting(&both), &clicks, truth.p, truth.q);
            // Wrong votes may shift the plateau within the widths of the votes.
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
        let has_vote = |votes: &CandidateVotes| {
            votes.terms[0].bracket[..5].iter().map(|t| t.is_finite()).collect::<Vec<_>>()
        };
        // Nor do points within a pixel of the line, whose distance is mostly error.
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
    fn votes_that_are_too_wide_do_not_count() {
        let clicks = [PointPair::new(100.0, 50.0, 90.0, 50.0), PointPair::new(200.0, 200.0, 180.0, 200.0)];
        // A point 2.5 px from the line: the band is then some ±0.8 of ln κ, beyond half a unit.
        for (y, expected) in [(52.5, 0.0), (60.0, WEIGHT)] {
            let voting = voting(&[PointPair::new(150.0, y, 140.0, y)]);
            let found = counted(&voting, &clicks, [0.0; 2], [0.0; 2]);
            assert!((found.votes - expected).abs() < 1e-6, "{y}: {}", found.votes);
        }
    }

    #[test]
    fn the_best_look_alikes_of_each_corner_vote_by_their_excess() {
        let corners = [vec![Point::new(10.0, 20.0)], (0..4).map(|k| Point::new(f64::from(k), 0.0)).collect()];
        let alike =
            |corner2, correlation| super::super::look_alikes::Putative { corner1: 0, corner2, correlation };
        let pairs = vec![alike(1, 0.9), alike(2, 0.9), alike(3, 0.8), alike(0, 0.7)];
        let voting = KappaVoting::new(&Support::of_look_alikes(corners, pairs), 3);
        let voters = &voting.blocks[0];
        let excess = |correlation: f32| correlation - FLOOR;
        assert_eq!(voters.x2[..3], [1.0, 2.0, 3.0]);
        assert_eq!(voters.weight[..4], [excess(0.9), excess(0.9), excess(0.8), 0.0]);
    }

    #[test]
    fn logarithms_are_good_to_single_precision() {
        for k in 0..4000 {
            let x = 1e-4 * 1.005f32.powi(k);
            let off = (logarithm(x) - x.ln()).abs();
            assert!(off < 2e-7 * x.ln().abs().max(1.0), "{x}: {off}");
        }
    }
}
