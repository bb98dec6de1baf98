//! Candidate line pairs through one clicked point pair (paper, section 5.1, step 1).

use std::f64::consts::PI;

use super::SHORTEST_LINE;
use crate::cancel::CancelFlag;
use crate::estimate::{EstimateError, PencilParameters};
use crate::geometry::{AnchoredLine, Frame, Point, PointPair, angle_between, median, pencil_angles};
use crate::similarity::{CostMatrix, LineSimilarity, SimilaritySource};

/// A pair of lines through a click that may be corresponding epipolar lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Directions of the line in image 1 and in image 2, radians.
    pub angles: [f64; 2],
    /// Cost of the pair, normalised if the parameters say so; lower is more similar.
    pub cost: f32,
}

/// Two pencils through one click, compared line by line: the cost of each line of image 1 (a row)
/// against each line of image 2 (a column).
///
/// The lines are given in full-size pixels, though they were compared at a small size. Directions
/// do not depend on the size.
#[derive(Debug, Clone)]
pub struct ComparedPencils {
    /// The click, full-size pixels.
    pub click: PointPair,
    /// Directions of the rows, radians in `[0, π)`, ascending.
    pub angles1: Vec<f64>,
    /// Directions of the columns, radians in `[0, 2π)`, ascending. Each line has both senses, since
    /// the images may be rotated.
    pub angles2: Vec<f64>,
    /// Number of lines of each pencil before untextured lines were dropped, evenly spread over half
    /// a turn.
    pub lines_before: [usize; 2],
    /// Costs of the line pairs, infinite where two lines were not compared.
    pub costs: CostMatrix,
    /// Mutual best pairs, cheapest first.
    pub candidates: Vec<Candidate>,
}

impl ComparedPencils {
    /// Compares the two pencils through a click, full-size pixels.
    pub(crate) fn new(
        source: &dyn SimilaritySource,
        click: &PointPair,
        parameters: &PencilParameters,
        cancel: &CancelFlag,
    ) -> Result<Self, EstimateError> {
        let level = source.at(parameters.coarse_side);
        let (similarity, frames, at) = (&*level.lines, level.frames, level.resized(click));
        let half_turn =
            |frame: Frame, point: Point| pencil_angles(frame.farthest_corner(point), parameters.line_spacing);
        let all1 = half_turn(frames[0], at.point1);
        let half2 = half_turn(frames[1], at.point2);
        let all2: Vec<f64> = half2.iter().copied().chain(half2.iter().map(|a| a + PI)).collect();
        let angles1 = textured(similarity, 0, at.point1, frames[0], &all1, parameters.texture);
        let angles2 = textured(similarity, 1, at.point2, frames[1], &all2, parameters.texture);
        let lines = |point, angles: &[f64]| -> Vec<AnchoredLine> {
            angles.iter().map(|a| AnchoredLine::at_angle(point, *a)).collect()
        };
        let allowed = |i: usize, j: usize| {
            let turn = angle_between(angles2[j] - angles1[i], source.rotation());
            // Directions are multiples of a step, so a rotation may equal the limit but for
            // rounding.
            turn <= parameters.rotation + 1e-9
        };
        let (lines1, lines2) = (lines(at.point1, &angles1), lines(at.point2, &angles2));
        let costs = similarity.cost_matrix(&lines1, &lines2, &allowed, &|| cancel.is_cancelled());
        cancel.check()?;
        let costs = if parameters.normalise { costs.normalised() } else { costs };
        let best = mutual_best(&costs, parameters.mutual);
        let mut candidates: Vec<Candidate> = best
            .into_iter()
            .map(|(i, j)| Candidate { angles: [angles1[i], angles2[j]], cost: costs.at(i, j) })
            .collect();
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let lines_before = [all1.len(), half2.len()];
        Ok(Self { click: *click, angles1, angles2, lines_before, costs, candidates })
    }

    /// Returns the row and column of a candidate.
    pub fn cell(&self, candidate: &Candidate) -> Option<[usize; 2]> {
        self.cell_at(candidate.angles)
    }

    /// Returns the row and column of the lines with exactly these directions.
    pub fn cell_at(&self, angles: [f64; 2]) -> Option<[usize; 2]> {
        let find = |all: &[f64], angle: f64| all.binary_search_by(|a| a.total_cmp(&angle)).ok();
        Some([find(&self.angles1, angles[0])?, find(&self.angles2, angles[1])?])
    }

    /// Returns the directions of the lines of a cell, radians; `None` outside the matrix.
    pub fn angles(&self, row: usize, column: usize) -> Option<[f64; 2]> {
        Some([*self.angles1.get(row)?, *self.angles2.get(column)?])
    }

    /// Returns the two lines of a cell, anchored at the click, full-size pixels; `None` outside the
    /// matrix.
    pub fn lines(&self, row: usize, column: usize) -> Option<[AnchoredLine; 2]> {
        Some(lines_at(&self.click, self.angles(row, column)?))
    }

    /// Returns the number of lines compared in each image, regardless of their sense.
    pub fn lines_compared(&self) -> [usize; 2] {
        [self.angles1.len(), self.angles2.len() / 2]
    }
}

#[cfg(test)]
impl ComparedPencils {
    /// Returns pencils of `lines_before` lines of which `textured` have texture, with as many
    /// candidates.
    pub(crate) fn of_so_many(click: PointPair, textured: usize, lines_before: usize) -> Self {
        let angles: Vec<f64> = (0..textured).map(|k| 0.01 * k as f64).collect();
        let candidates = angles.iter().map(|a| Candidate { angles: [*a; 2], cost: 0.5 }).collect();
        Self {
            click,
            angles2: angles.iter().copied().chain(angles.iter().map(|a| a + PI)).collect(),
            angles1: angles,
            lines_before: [lines_before; 2],
            costs: CostMatrix::new(textured, 2 * textured, vec![0.5; 2 * textured * textured]),
            candidates,
        }
    }
}

/// Returns the lines through a click with the given directions, anchored at the click.
pub fn lines_at(click: &PointPair, angles: [f64; 2]) -> [AnchoredLine; 2] {
    [AnchoredLine::at_angle(click.point1, angles[0]), AnchoredLine::at_angle(click.point2, angles[1])]
}

/// Returns the directions of the lines that are long enough and cross enough texture.
fn textured(
    similarity: &dyn LineSimilarity,
    image: usize,
    point: Point,
    frame: Frame,
    angles: &[f64],
    fraction: f64,
) -> Vec<f64> {
    let lines: Vec<AnchoredLine> = angles.iter().map(|a| AnchoredLine::at_angle(point, *a)).collect();
    let kept = have_texture(similarity, image, frame, &lines, fraction, SHORTEST_LINE);
    angles.iter().zip(kept).filter(|(_, kept)| *kept).map(|(angle, _)| *angle).collect()
}

/// Returns which lines are kept: textured by at least a fraction of the median, and at least as
/// long as `shortest` times the shorter side.
pub(super) fn have_texture(
    similarity: &dyn LineSimilarity,
    image: usize,
    frame: Frame,
    lines: &[AnchoredLine],
    fraction: f64,
    shortest: f64,
) -> Vec<bool> {
    let information = similarity.information(image, lines);
    let threshold = median(information.iter().copied()) * fraction;
    let shortest = shortest * frame.shorter_side();
    let is_kept = |(line, value): (&AnchoredLine, f64)| {
        let length = frame.clip(&line.line()).map_or(0.0, |s| s.length());
        value > 0.0 && value >= threshold && length >= shortest
    };
    lines.iter().zip(information).map(is_kept).collect()
}

/// Returns the pairs that are among the `k` cheapest of their row and of their column.
pub(super) fn mutual_best(costs: &CostMatrix, k: usize) -> Vec<(usize, usize)> {
    let kth = |values: &mut Vec<f32>| -> f32 {
        values.retain(|v| v.is_finite());
        if values.is_empty() {
            return f32::NEG_INFINITY;
        }
        let k = (k - 1).min(values.len() - 1);
        *values.select_nth_unstable_by(k, f32::total_cmp).1
    };
    let rows: Vec<f32> = (0..costs.rows()).map(|r| kth(&mut costs.row(r).to_vec())).collect();
    let columns: Vec<f32> =
        (0..costs.columns()).map(|c| kth(&mut (0..costs.rows()).map(|r| costs.at(r, c)).collect())).collect();
    (0..costs.rows())
        .flat_map(|r| (0..costs.columns()).map(move |c| (r, c)))
        .filter(|(r, c)| costs.at(*r, *c) <= rows[*r].min(columns[*c]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mutual_best_pairs_are_best_both_ways() {
        let inf = f32::INFINITY;
        let costs = CostMatrix::new(3, 3, vec![1.0, 5.0, inf, 2.0, 3.0, 9.0, inf, 4.0, 8.0]);
        assert_eq!(mutual_best(&costs, 1), vec![(0, 0)]);
        let two = mutual_best(&costs, 2);
        assert!(two.contains(&(0, 0)) && two.contains(&(1, 0)) && two.contains(&(1, 1)));
        assert!(two.contains(&(2, 1)) && !two.contains(&(0, 1)));
    }
}
