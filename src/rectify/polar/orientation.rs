//! Corresponding half lines, and the rows made of them.
//!
//! For points in front of both cameras, `e2 × x2 ∼ s · F x1` with one sign `s` for the whole pair
//! (oriented epipolar geometry: Laveau & Faugeras 1996; Chum, Werner & Matas 2004).
//! `Line::direction` of `s · F x1` then points from the epipole to the match.

use super::half_pencil::{HalfPencil, direction, near};
use crate::geometry::{FundamentalMatrix, Line, PointPair};

/// Number of samples of a pencil for the orientation.
const SAMPLES: usize = 64;

/// Sign of `F` as a map of half lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Orientation {
    reversed: bool,
    pub(super) assumed: bool,
}

impl Orientation {
    /// Finds the orientation: from the matches if there are any, otherwise from the position of the
    /// images. With an epipole inside an image, half lines are assumed to turn by less than 90°.
    pub(super) fn find(f: &FundamentalMatrix, pencils: [&HalfPencil; 2], matches: &[PointPair]) -> Self {
        let [pencil1, pencil2] = pencils;
        let votes: i64 = matches
            .iter()
            .filter_map(|m| {
                let along = f.line2_from_point1(m.point1)?.direction();
                let outwards = along.dot(&(m.point2 - pencil2.epipole));
                Some(if outwards < 0.0 { -1 } else { 1 })
            })
            .sum();
        if votes != 0 {
            return Self { reversed: votes < 0, assumed: false };
        }
        let assumed = pencil1.inside || pencil2.inside;
        let [low, high] = pencil1.range();
        let agreement: f64 = (0..SAMPLES)
            .map(|k| low + (high - low) * (k as f64 + 0.5) / SAMPLES as f64)
            .filter_map(|angle| {
                let along = f.line2_from_point1(pencil1.point(angle))?.direction();
                // From outside, the half lines face the image. From inside, both halves of a line
                // are in the image.
                let expected = if assumed { angle } else { pencil2.middle };
                Some(along.dot(&direction(expected)))
            })
            .sum();
        Self { reversed: agreement < 0.0, assumed }
    }

    pub(super) fn lines<'a>(
        self,
        f: &'a FundamentalMatrix,
        pencil1: &'a HalfPencil,
        pencil2: &'a HalfPencil,
    ) -> HalfLines<'a> {
        HalfLines { f, pencils: [pencil1, pencil2], reversed: self.reversed }
    }
}

/// Corresponding half lines of both images.
pub(super) struct HalfLines<'a> {
    f: &'a FundamentalMatrix,
    pencils: [&'a HalfPencil; 2],
    reversed: bool,
}

impl HalfLines<'_> {
    /// Returns the half line in image 2 corresponding to `angle1`; `None` where `F` gives no line.
    fn angle2_from_angle1(&self, angle1: f64) -> Option<f64> {
        let line = self.f.line2_from_point1(self.pencils[0].point(angle1))?;
        let line = if self.reversed { line.reversed() } else { line };
        Some(self.pencils[1].angle_of_line(&line))
    }

    /// Returns the half line in image 1 corresponding to `angle2`.
    fn angle1_from_angle2(&self, angle2: f64) -> Option<f64> {
        let line: Line = self.f.line1_from_point2(self.pencils[1].point(angle2))?;
        let candidates = [line, line.reversed()].map(|l| self.pencils[0].angle_of_line(&l));
        candidates
            .into_iter()
            .filter_map(|angle1| Some((angle1, (self.angle2_from_angle1(angle1)? - angle2).cos())))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(angle1, _)| angle1)
    }

    /// Returns the range of angles in image 1 whose half lines cross both images.
    pub(super) fn common_range(&self) -> Option<[f64; 2]> {
        let range1 = self.pencils[0].range();
        if self.pencils[1].inside {
            return Some(range1);
        }
        let range2 = self.pencils[1].range();
        let at = |share: f64| self.angle1_from_angle2(range2[0] + (range2[1] - range2[0]) * share);
        // From outside, an image spans less than half a turn, and so does its range in the other
        // image. The middle decides which way round the ends are joined.
        let middle = at(0.5)?;
        let ends = [near(at(0.0)?, middle), near(at(1.0)?, middle)];
        let seen = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        if self.pencils[0].inside {
            return Some(seen);
        }
        let common = [range1[0].max(seen[0]), range1[1].min(seen[1])];
        (common[0] < common[1]).then_some(common)
    }

    /// Returns pairs of corresponding angles over `range`. Neighbouring half lines are at most
    /// `step` px apart at their far ends.
    pub(super) fn rows(&self, range: [f64; 2], step: f64) -> Vec<[f64; 2]> {
        let Some(first) = self.angle2_from_angle1(range[0]) else { return Vec::new() };
        let mut rows = vec![[range[0], first]];
        let mut angle1 = range[0];
        let mut angle2 = first;
        // Turn of image 2 per turn of image 1, from the last step. It changes slowly.
        let mut rate = 0.0;
        while angle1 < range[1] {
            let longest2 = step / self.pencils[1].far_end(angle2);
            let mut ahead = (step / self.pencils[0].far_end(angle1)).min(longest2 / rate);
            let mut next = None;
            for _ in 0..60 {
                let candidate = angle1 + ahead;
                let Some(there) = self.angle2_from_angle1(candidate).map(|a| near(a, angle2)) else { break };
                let taken = (there - angle2).abs();
                if taken <= longest2 * 1.001 {
                    next = Some((candidate, there));
                    rate = taken / ahead;
                    break;
                }
                ahead *= longest2 / taken;
            }
            // If no step is small enough, F jumps here and the picture ends.
            let Some((candidate, there)) = next else { break };
            if candidate <= angle1 || candidate > range[1] {
                break;
            }
            (angle1, angle2) = (candidate, there);
            rows.push([angle1, angle2]);
        }
        rows
    }
}
