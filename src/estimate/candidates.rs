//! Candidate line pairs through one clicked point pair (paper, section 5.1, step 1).

use std::f64::consts::{PI, TAU};

use super::{EstimateError, Monitor, Parameters};
use crate::geometry::{AnchoredLine, Frame, Point, PointPair, pencil_angles};
use crate::similarity::{CostMatrix, LineSimilarity};

/// A pair of lines through a click that may be corresponding epipolar lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Directions of the line in image 1 and in image 2, radians.
    pub angles: [f64; 2],
    /// Cost of the pair, normalised if the parameters say so; lower is more similar.
    pub cost: f32,
}

/// The two pencils through one click, compared line by line.
#[derive(Debug, Clone)]
pub struct PencilComparison {
    /// Directions of the lines examined in image 1, `[0, π)`.
    pub angles1: Vec<f64>,
    /// Directions of the lines examined in image 2, `[0, 2π)`: both senses, since the images may be rotated.
    pub angles2: Vec<f64>,
    /// Lines of the pencils before those without texture were dropped.
    pub lines: [usize; 2],
    /// Cost of each line of image 1 against each of image 2.
    pub costs: CostMatrix,
    /// Mutual best pairs, cheapest first.
    pub candidates: Vec<Candidate>,
}

/// Compares the two pencils through a click at one pyramid level (all coordinates in its pixels).
pub(crate) fn compare_pencils(
    similarity: &dyn LineSimilarity,
    click: &PointPair,
    frames: [Frame; 2],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<PencilComparison, EstimateError> {
    let half_turn =
        |frame: Frame, point: Point| pencil_angles(frame.farthest_corner(point), parameters.line_spacing);
    let all1 = half_turn(frames[0], click.point1);
    let all2: Vec<f64> = {
        let half = half_turn(frames[1], click.point2);
        half.iter().copied().chain(half.iter().map(|a| a + PI)).collect()
    };
    let angles1 = textured(similarity, 0, click.point1, frames[0], &all1, parameters.texture);
    let angles2 = textured(similarity, 1, click.point2, frames[1], &all2, parameters.texture);
    let lines = |point, angles: &[f64]| -> Vec<AnchoredLine> {
        angles.iter().map(|a| AnchoredLine::at_angle(point, *a)).collect()
    };
    let allowed = |i: usize, j: usize| {
        let turn = (angles2[j] - angles1[i]).rem_euclid(TAU);
        turn.min(TAU - turn) <= parameters.rotation + 1e-9
    };
    let costs = similarity.cost_matrix(
        &lines(click.point1, &angles1),
        &lines(click.point2, &angles2),
        &allowed,
        &|| monitor.is_cancelled(),
    );
    monitor.check()?;
    let costs = if parameters.normalise { costs.normalised() } else { costs };
    let mut candidates: Vec<Candidate> = mutual_best(&costs, parameters.mutual)
        .into_iter()
        .map(|(i, j)| Candidate { angles: [angles1[i], angles2[j]], cost: costs.at(i, j) })
        .collect();
    candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ok(PencilComparison { lines: [all1.len(), all2.len() / 2], angles1, angles2, costs, candidates })
}

/// The lines of a pencil that are long enough and cross enough texture.
fn textured(
    similarity: &dyn LineSimilarity,
    image: usize,
    point: Point,
    frame: Frame,
    angles: &[f64],
    fraction: f64,
) -> Vec<f64> {
    let lines: Vec<AnchoredLine> = angles.iter().map(|a| AnchoredLine::at_angle(point, *a)).collect();
    let information = similarity.information(image, &lines);
    let mut sorted = information.clone();
    sorted.sort_by(f64::total_cmp);
    let threshold = sorted.get(sorted.len() / 2).map_or(0.0, |median| median * fraction);
    let shortest = 0.15 * frame.shorter_side();
    angles
        .iter()
        .zip(&lines)
        .zip(&information)
        .filter(|((_, line), value)| {
            let length = frame.clip(&line.line()).map_or(0.0, |s| s.length());
            **value > 0.0 && **value >= threshold && length >= shortest
        })
        .map(|((angle, _), _)| *angle)
        .collect()
}

/// Pairs that are among the `k` cheapest of their row and of their column.
fn mutual_best(costs: &CostMatrix, k: usize) -> Vec<(usize, usize)> {
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
