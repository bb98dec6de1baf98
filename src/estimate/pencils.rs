//! The compared pencils of an estimate, as lines in full-size pixels.

use std::sync::Arc;

use super::candidates::{Candidate, PencilComparison};
use crate::geometry::{AnchoredLine, PointPair};
use crate::similarity::CostMatrix;

/// The two pencils through one click with the cost of each line of image 1 (a row) against each of image 2 (a
/// column). Directions do not depend on the size of the images, so the lines are given in full-size pixels,
/// though they were compared at a small size.
#[derive(Debug, Clone)]
pub struct ComparedPencils {
    click: PointPair,
    comparison: Arc<PencilComparison>,
}

impl ComparedPencils {
    /// Pencils through a click in full-size pixels.
    pub fn new(click: PointPair, comparison: impl Into<Arc<PencilComparison>>) -> Self {
        Self { click, comparison: comparison.into() }
    }

    /// The click they pass through, full-size pixels.
    pub fn click(&self) -> &PointPair {
        &self.click
    }

    /// Directions of the rows, radians in `[0, π)`, ascending.
    pub fn angles1(&self) -> &[f64] {
        &self.comparison.angles1
    }

    /// Directions of the columns, radians in `[0, 2π)`, ascending: both senses.
    pub fn angles2(&self) -> &[f64] {
        &self.comparison.angles2
    }

    /// Lines of each pencil before those without texture were dropped, evenly spread over half a turn.
    pub fn lines_before(&self) -> [usize; 2] {
        self.comparison.lines
    }

    /// The costs; infinite where two lines were not compared.
    pub fn costs(&self) -> &CostMatrix {
        &self.comparison.costs
    }

    /// The mutual best pairs, cheapest first.
    pub fn candidates(&self) -> &[Candidate] {
        &self.comparison.candidates
    }

    /// Row and column of a candidate.
    pub fn cell(&self, candidate: &Candidate) -> Option<[usize; 2]> {
        self.cell_at(candidate.angles)
    }

    /// Row and column of the lines with exactly these directions.
    pub fn cell_at(&self, angles: [f64; 2]) -> Option<[usize; 2]> {
        let find = |all: &[f64], angle: f64| all.binary_search_by(|a| a.total_cmp(&angle)).ok();
        Some([find(self.angles1(), angles[0])?, find(self.angles2(), angles[1])?])
    }

    /// Directions of the lines of a cell, radians; `None` outside the matrix.
    pub fn angles(&self, row: usize, column: usize) -> Option<[f64; 2]> {
        Some([*self.angles1().get(row)?, *self.angles2().get(column)?])
    }

    /// The two lines of a cell, anchored at the click, full-size pixels; `None` outside the matrix.
    pub fn lines(&self, row: usize, column: usize) -> Option<[AnchoredLine; 2]> {
        Some(lines_at(&self.click, self.angles(row, column)?))
    }
}

/// The lines through a click with the given directions, anchored at it.
pub fn lines_at(click: &PointPair, angles: [f64; 2]) -> [AnchoredLine; 2] {
    [AnchoredLine::at_angle(click.point1, angles[0]), AnchoredLine::at_angle(click.point2, angles[1])]
}
