//! Geometry from lines alone, without any point (paper, section 4). Candidates are pairs of similar
//! lines of both images. Two candidates give the epipoles, a third gives the map between the
//! pencils, and the number of agreeing candidates decides.
//!
//! All lines here are in pixels of the size at which they are compared.
//!
//! # Choices that the paper leaves open
//! - "All lines" are a grid over direction and distance from the middle of the image. One step
//!   moves a line by at most the spacing, anywhere in the image.
//! - A line has no anchor that shows the same scene point in both images. Index 0 is the foot of
//!   the middle of the image, and the similarity limits the disparities.
//! - The area between short lines is always small, so with one threshold every geometry would agree
//!   with lines that cut off a corner. The threshold holds for a line as long as the image is wide,
//!   and falls in proportion for shorter ones.
//! - The map is between pencils, so it takes lines through the epipole. A candidate that misses the
//!   epipole is replaced by the pencil's line through its middle, if the area between the two is
//!   below the threshold.

use std::cmp::Reverse;

use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::SHORTEST_LINE;
use super::pencils::{have_texture, mutual_best};
use crate::cancel::CancelFlag;
use crate::estimate::sampling::{Draws, Purpose, Weighted, refitted};
use crate::estimate::{EstimateError, PencilParameters};
use crate::geometry::{
    AnchoredLine, Frame, FundamentalMatrix, HomogeneousPoint, Line, Observation, Point, PointPair, Segment,
    angle_between, area_between_lines, fit_fundamental, line_grid,
};
use crate::similarity::{CostMatrix, ScaledSimilarity};

/// Shortest line, as a share of the shorter side: twice as long as in a pencil, since no click
/// confirms it.
const SHORTEST: f64 = 2.0 * SHORTEST_LINE;
/// Lines of image 1 compared in one batch. A stop is noticed between batches. No result depends on
/// it.
const BATCH: usize = 64;
/// Number of candidates through both epipoles that are tried as the third of a draw. The best one
/// counts. Each costs as much as a hypothesis.
const THIRD: usize = 3;
/// Largest number of candidates examined for a third pair. If few pass through both epipoles, the
/// draw was bad.
const LOOKED_THROUGH: usize = 400;
/// Largest number of candidates examined for a third pair, in multiples of all candidates. It ends
/// the search earlier if there are fewer than 100.
const TIMES_OVER: usize = 4;
/// Number of draws of one task. The streams of random numbers depend on it.
const TASK: usize = 64;
/// Number of candidates on which hypotheses are first counted, evenly spread over all. It
/// determines a share with a standard deviation of at most 2 %.
const COUNTED: usize = 700;
/// Number of hypotheses that are counted on all candidates and refitted. The first counts err by 2
/// % of the candidates, so the best hypothesis need not lead.
const REFITTED: usize = 60;
/// Largest number of rounds of refitting. Rounds end earlier when the agreeing candidates stay the
/// same or become fewer.
const ROUNDS: usize = 6;
/// Distance at which a candidate loses influence on a fit, in units of the permitted area: the
/// candidates that agree keep most of their weight.
const ROBUST: f64 = 1.5;

/// Largest number of lines of image 1 that are noted with their best partners.
const SWEPT: usize = 90;

/// Two lines that may be corresponding epipolar lines, directed alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineCandidate {
    /// The line of image 1.
    pub line1: AnchoredLine,
    /// The line of image 2.
    pub line2: AnchoredLine,
    /// Cost of the pair, normalised if the parameters say so; lower is more similar.
    pub cost: f32,
}

/// Candidates, and the number of lines compared.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct LineCandidates {
    /// Mutual best pairs, cheapest first.
    pub pairs: Vec<LineCandidate>,
    /// Some lines of image 1 with their best partners, at most [`SWEPT`]: of each direction, the line nearest the
    /// middle.
    pub swept: Vec<LineCandidate>,
    /// Number of lines of each image that have texture.
    pub lines: [usize; 2],
}

/// Compares about `count` lines of each image with each other. `rotation` is the approximate
/// rotation of image 2 against image 1, radians.
///
/// With `n` and `m` textured lines, the `2 n m` costs of 4 bytes take 32 MB at 2,000 lines each,
/// and twice that while they are normalised.
pub(in crate::estimate) fn compare_lines(
    level: &ScaledSimilarity,
    count: usize,
    rotation: f64,
    parameters: &PencilParameters,
    cancel: &CancelFlag,
) -> Result<LineCandidates, EstimateError> {
    let similarity = &*level.lines;
    let [lines1, half2] = [0, 1].map(|image| {
        let frame = level.frames[image];
        let lines = line_grid(frame, count);
        let kept = have_texture(similarity, image, frame, &lines, parameters.texture, SHORTEST);
        lines.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(line, _)| line).collect::<Vec<_>>()
    });
    // Lines have no sense, so the lines of image 2 are compared in both.
    let reversed = half2.iter().map(|line| AnchoredLine { direction: -line.direction, ..*line });
    let lines2: Vec<AnchoredLine> = half2.iter().copied().chain(reversed).collect();
    let [angles1, angles2] =
        [&lines1, &lines2].map(|lines| lines.iter().map(AnchoredLine::angle).collect::<Vec<f64>>());
    let mut costs: Vec<f32> = Vec::with_capacity(lines1.len() * lines2.len());
    for (batch, few) in lines1.chunks(BATCH).enumerate() {
        let allowed = |i: usize, j: usize| {
            let turn = angle_between(angles2[j] - angles1[batch * BATCH + i], rotation);
            turn <= parameters.rotation + 1e-9
        };
        let part = similarity.cost_matrix(few, &lines2, &allowed, &|| cancel.is_cancelled());
        cancel.check()?;
        (0..part.rows()).for_each(|row| costs.extend_from_slice(part.row(row)));
    }
    let costs = CostMatrix::new(lines1.len(), lines2.len(), costs);
    let costs = if parameters.normalise { costs.normalised() } else { costs };
    let mut pairs: Vec<LineCandidate> = mutual_best(&costs, parameters.mutual)
        .into_iter()
        .map(|(i, j)| LineCandidate { line1: lines1[i], line2: lines2[j], cost: costs.at(i, j) })
        .collect();
    pairs.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let partner = |i: usize| {
        let finite = (0..costs.columns()).filter(|j| costs.at(i, *j).is_finite());
        let j = finite.min_by(|a, b| costs.at(i, *a).total_cmp(&costs.at(i, *b)))?;
        Some(LineCandidate { line1: lines1[i], line2: lines2[j], cost: costs.at(i, j) })
    };
    let swept = middle_lines(&lines1, level.frames[0]).into_iter().filter_map(partner).collect();
    Ok(LineCandidates { pairs, swept, lines: [lines1.len(), half2.len()] })
}

/// Returns the places of the lines nearest the middle of a frame, one of each direction, evenly thinned. Lines of one
/// direction follow each other.
fn middle_lines(lines: &[AnchoredLine], frame: Frame) -> Vec<usize> {
    let away = |k: &usize| (lines[*k].anchor - frame.centre()).norm();
    let all: Vec<usize> = (0..lines.len()).collect();
    let directions = all.chunk_by(|a, b| lines[*a].direction == lines[*b].direction);
    let nearest: Vec<usize> = directions
        .filter_map(|same| same.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))))
        .collect();
    let kept = nearest.len().min(SWEPT);
    (0..kept).map(|k| nearest[k * nearest.len() / kept]).collect()
}

/// A candidate with its lines and their segments inside the images.
struct Measured {
    lines: [Line; 2],
    segments: [Segment; 2],
}

impl Measured {
    fn new(candidate: &LineCandidate, frames: [Frame; 2]) -> Option<Self> {
        let lines = [candidate.line1.line(), candidate.line2.line()];
        let segments = [frames[0].clip(&lines[0])?, frames[1].clip(&lines[1])?];
        Some(Self { lines, segments })
    }

    fn middles(&self) -> [Point; 2] {
        [self.segments[0].midpoint(), self.segments[1].midpoint()]
    }

    /// Returns the pairs of the ends. Every point of one line corresponds to some point of the
    /// other, so the ends carry all information about `F`.
    fn as_pairs(&self) -> [PointPair; 4] {
        let [a, b] = self.segments;
        [(a.start, b.start), (a.start, b.end), (a.end, b.start), (a.end, b.end)]
            .map(|(point1, point2)| PointPair { point1, point2 })
    }
}

/// Settings of the consensus.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct LineConsensus {
    pub draws: usize,
    /// Largest area between a line and its mapped partner, in px times the width of the image.
    pub area: f64,
    pub seed: u64,
}

/// A geometry with the candidates that agree with it.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct LineGeometry {
    /// The matrix, for pixels of the size at which the lines were compared.
    pub fundamental: FundamentalMatrix,
    /// Indices of the candidates that agree.
    pub agreeing: Vec<usize>,
}

struct Counting<'a> {
    measured: Vec<Measured>,
    sampler: Weighted,
    frames: [Frame; 2],
    how: &'a LineConsensus,
}

/// Returns the geometries with the most agreeing candidates, best first. Of similar geometries,
/// only the best is returned.
pub(in crate::estimate) fn geometries_from_lines(
    candidates: &[LineCandidate],
    frames: [Frame; 2],
    how: &LineConsensus,
    cancel: &CancelFlag,
) -> Result<Vec<LineGeometry>, EstimateError> {
    let counting = Counting::new(candidates, frames, how);
    let draws =
        Draws { seed: how.seed, purpose: Purpose::LineConsensus, first: 0, count: how.draws, task: TASK };
    let mut drawn =
        draws.collect(|random| if cancel.is_cancelled() { None } else { counting.hypothesis(random) });
    cancel.check()?;
    drawn.sort_by_key(|(count, _)| Reverse(*count));
    let mut refitted: Vec<LineGeometry> =
        drawn.par_iter().take(REFITTED).map(|(_, f)| counting.refitted(f)).collect();
    refitted.sort_by_key(|one| Reverse(one.agreeing.len()));
    let mut different: Vec<LineGeometry> = Vec::new();
    for one in refitted {
        let shares = |other: &LineGeometry| {
            let both = one.agreeing.iter().filter(|k| other.agreeing.binary_search(k).is_ok()).count();
            2 * both > one.agreeing.len()
        };
        if !one.agreeing.is_empty() && !different.iter().any(shares) {
            different.push(one);
        }
    }
    Ok(different)
}

impl<'a> Counting<'a> {
    fn new(candidates: &[LineCandidate], frames: [Frame; 2], how: &'a LineConsensus) -> Self {
        let cheapest = candidates.iter().map(|c| f64::from(c.cost)).fold(f64::INFINITY, f64::min).max(1e-9);
        let weighted = |c: &LineCandidate| {
            Some((Measured::new(c, frames)?, (cheapest / f64::from(c.cost).max(1e-9)).powi(2)))
        };
        let (measured, weights): (Vec<Measured>, Vec<f64>) = candidates.iter().filter_map(weighted).unzip();
        Self { measured, sampler: Weighted::new(weights.into_iter()), frames, how }
    }

    fn one(&self, random: &mut Pcg64Mcg) -> Option<&Measured> {
        self.measured.get(self.sampler.draw(random)?)
    }

    /// Returns the best hypothesis of one draw. Two candidates give the epipoles, and a third
    /// through both gives the map.
    fn hypothesis(&self, random: &mut Pcg64Mcg) -> Option<(usize, FundamentalMatrix)> {
        let (p, q) = (self.one(random)?, self.one(random)?);
        let epipoles: [HomogeneousPoint; 2] = [0, 1].map(|i| p.lines[i].intersection(&q.lines[i]));
        let third = (0..self.measured.len() * TIMES_OVER)
            .filter_map(|_| self.one(random))
            .take(LOOKED_THROUGH)
            .filter(|r| (0..2).all(|i| self.is_near(i, &r.lines[i], &epipoles[i], r.middles()[i])))
            .take(THIRD);
        third
            .filter_map(|r| through(p, q, r))
            .map(|f| (self.agreeing_few(&f), f))
            .max_by_key(|(count, _)| *count)
    }

    /// Returns whether a line passes near the epipole: the area to the pencil's line through its
    /// middle is below the threshold.
    fn is_near(&self, image: usize, line: &Line, epipole: &HomogeneousPoint, middle: Point) -> bool {
        let length = self.frames[image].clip(line).map_or(0.0, |segment| segment.length());
        Line::joining(epipole, &middle.to_homogeneous())
            .is_some_and(|own| self.is_same(image, line, length, &own))
    }

    fn is_same(&self, image: usize, line: &Line, length: f64, other: &Line) -> bool {
        let frame = self.frames[image];
        area_between_lines(line, other, frame) < self.how.area * length.min(frame.width as f64)
    }

    /// Returns the candidates that agree with a geometry (paper, section 4.2).
    fn agreeing(&self, f: &FundamentalMatrix) -> Vec<usize> {
        (0..self.measured.len()).filter(|k| self.agrees(f, &self.measured[*k])).collect()
    }

    /// Counts the agreeing candidates among an evenly spread part of all.
    fn agreeing_few(&self, f: &FundamentalMatrix) -> usize {
        let step = self.measured.len().div_ceil(COUNTED).max(1);
        self.measured.iter().step_by(step).filter(|one| self.agrees(f, one)).count()
    }

    fn agrees(&self, f: &FundamentalMatrix, one: &Measured) -> bool {
        let [middle1, middle2] = one.middles();
        let Some(line2) = f.line2_from_point1(middle1) else { return false };
        // Most candidates are far off at their middles. The area is at least half the distance
        // there times the length.
        let [length1, length2] = [0, 1].map(|image| one.segments[image].length());
        if 0.5 * line2.distance(middle2) > self.how.area || !self.is_same(1, &one.lines[1], length2, &line2) {
            return false;
        }
        f.line1_from_point2(middle2).is_some_and(|line1| self.is_same(0, &one.lines[0], length1, &line1))
    }

    /// Fits a geometry to the agreeing candidates, repeatedly while their number does not fall.
    fn refitted(&self, f: &FundamentalMatrix) -> LineGeometry {
        let start = LineGeometry { fundamental: *f, agreeing: self.agreeing(f) };
        let refit = |((_, round), (last, is_settled)): &((usize, usize), (LineGeometry, bool)), _| {
            if *is_settled {
                return None;
            }
            let observations: Vec<Observation> = last
                .agreeing
                .iter()
                .flat_map(|k| self.measured[*k].as_pairs())
                .map(|pair| Observation { pair, sigma: self.how.area })
                .collect();
            let fundamental = fit_fundamental(&last.fundamental, &observations, ROBUST)?.fundamental;
            let agreeing = self.agreeing(&fundamental);
            let is_settled = agreeing == last.agreeing;
            // Of refits with equally many candidates, the last is the best.
            let score = (agreeing.len(), round + 1);
            (agreeing.len() >= last.agreeing.len())
                .then_some((score, (LineGeometry { fundamental, agreeing }, is_settled)))
        };
        let (_, (best, _)) = refitted(((start.agreeing.len(), 0), (start, false)), ROUNDS, refit);
        best
    }
}

/// Returns the geometry of three line pairs. The first two give the epipoles.
fn through(p: &Measured, q: &Measured, r: &Measured) -> Option<FundamentalMatrix> {
    let coordinates = |i: usize| {
        let middle = r.middles()[i];
        [q.lines[i].signed_distance(middle), -p.lines[i].signed_distance(middle)]
    };
    let (c1, c2) = (coordinates(0), coordinates(1));
    let kappa = (c2[1] * c1[0]) / (c2[0] * c1[1]);
    if !kappa.is_finite() || kappa == 0.0 {
        return None;
    }
    let [lines_p, lines_q] = [p, q].map(|pair| pair.lines.map(|line| *line.coefficients()));
    let f = lines_p[1] * lines_q[0].transpose() - lines_q[1] * lines_p[0].transpose() * kappa;
    FundamentalMatrix::from_rank_two(f)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};

    /// Returns corresponding lines of a scene, and twice as many wrong pairs.
    fn candidates(scene: &ExactScene) -> Vec<LineCandidate> {
        let f = scene.fundamental();
        let anchored =
            |line: Line, point: Point| AnchoredLine { anchor: line.foot(point), direction: line.direction() };
        let pairs = scene.pairs(60);
        let of = |k: usize, other: usize, cost: f32| {
            let (a, b) = (pairs[k].point1, pairs[other].point2);
            let line1 = anchored(f.line1_from_point2(pairs[k].point2).unwrap(), a);
            let line2 = anchored(f.line2_from_point1(pairs[other].point1).unwrap(), b);
            LineCandidate { line1, line2, cost }
        };
        (0..60).map(|k| of(k, k, 1.0)).chain((0..120).map(|k| of(k % 60, (k * 7 + 11) % 60, 1.4))).collect()
    }

    fn consensus(seed: u64) -> LineConsensus {
        LineConsensus { draws: 1000, area: 1.0, seed }
    }

    #[test]
    fn one_third_of_correct_line_pairs_is_enough() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let candidates = candidates(&scene);
            let find = || {
                geometries_from_lines(&candidates, [FRAME; 2], &consensus(3), &CancelFlag::default()).unwrap()
            };
            let found = find();
            let error = scene.error(&found[0].fundamental);
            assert!(error < 0.1, "{error} px");
            assert!((0..60).all(|k| found[0].agreeing.contains(&k)));
            assert!(found.is_sorted_by(|a, b| a.agreeing.len() >= b.agreeing.len()));
            assert_eq!(found[0].fundamental, find()[0].fundamental, "the seed decides");
        }
    }

    #[test]
    fn a_sweep_has_one_line_of_each_direction() {
        let all = line_grid(FRAME, 4000);
        let swept = middle_lines(&all, FRAME);
        assert!(swept.len() > 20 && swept.len() <= SWEPT, "{}", swept.len());
        assert!(swept.is_sorted_by(|a, b| all[*a].angle() < all[*b].angle()));
        for k in &swept {
            assert!(all[*k].line().distance(FRAME.centre()) < 1e-6);
        }
        // Without the lines through the middle, their neighbours are nearest.
        let others: Vec<AnchoredLine> =
            all.iter().copied().filter(|line| line.line().distance(FRAME.centre()) > 1e-6).collect();
        assert_eq!(middle_lines(&others, FRAME).len(), swept.len());
        assert!(middle_lines(&[], FRAME).is_empty());
        assert_eq!(middle_lines(&line_grid(FRAME, 100_000), FRAME).len(), SWEPT);
    }

    #[test]
    fn stops_and_missing_candidates_are_handled() {
        let flag = CancelFlag::default();
        let none = geometries_from_lines(&[], [FRAME; 2], &consensus(0), &flag).unwrap();
        assert!(none.is_empty());
        flag.cancel();
        let stopped = geometries_from_lines(&[], [FRAME; 2], &consensus(0), &flag);
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
