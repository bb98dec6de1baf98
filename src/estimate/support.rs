//! Patch support: a second witness beside the lines.
//!
//! One-dimensional intensities along a line can be matched wrongly; two-dimensional patches much less often.
//! Corners of both images and the correlation of the patches around them are computed once per image pair;
//! then the support of any `F` is what agrees with it: the mutual best matches among corners within a few
//! pixels of each other's epipolar lines, each counting by how far its correlation exceeds a threshold.

use rayon::prelude::*;

use super::patches::{HALF, Patch, correlate, patch};
use crate::geometry::{FundamentalMatrix, Point, PointPair};
use crate::image::{GrayPlane, find_corners};

/// Correlations below this say nothing.
pub(crate) const FLOOR: f32 = 0.6;

/// Corners of two images and which of their patches look alike.
#[derive(Debug, Clone)]
pub(crate) struct Support {
    corners: [Vec<Point>; 2],
    /// Pairs of corner indices with their correlation, those above [`FLOOR`].
    pairs: Vec<Putative>,
}

/// Two corners whose patches look alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Putative {
    pub corner1: u32,
    pub corner2: u32,
    pub correlation: f32,
}

/// A supporting match and its correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SupportingMatch {
    pub pair: PointPair,
    pub correlation: f32,
}

impl Support {
    /// Finds up to `count` corners an image and compares all their patches.
    pub fn new(planes: [&GrayPlane; 2], count: usize) -> Self {
        let corners = planes.map(|plane| find_corners(plane, count, HALF + 1));
        let patches: [Vec<Option<Patch>>; 2] =
            [0, 1].map(|k| corners[k].iter().map(|c| patch(planes[k], *c)).collect());
        let pairs = patches[0]
            .par_iter()
            .enumerate()
            .flat_map_iter(|(i, a)| {
                let others = &patches[1];
                a.iter().flat_map(move |a| {
                    others.iter().enumerate().filter_map(move |(j, b)| {
                        let correlation = correlate(a, b.as_ref()?);
                        (correlation > FLOOR).then_some(Putative {
                            corner1: i as u32,
                            corner2: j as u32,
                            correlation,
                        })
                    })
                })
            })
            .collect();
        Self { corners, pairs }
    }

    pub fn pairs(&self) -> &[Putative] {
        &self.pairs
    }

    pub fn corners(&self, image: usize) -> &[Point] {
        &self.corners[image]
    }

    /// The mutual best matches within `band` px of each other's epipolar lines.
    pub fn matches(&self, f: &FundamentalMatrix, band: f64) -> Vec<SupportingMatch> {
        let lines2: Vec<_> = self.corners[0].iter().map(|c| f.line2_from_point1(*c)).collect();
        let lines1: Vec<_> = self.corners[1].iter().map(|c| f.line1_from_point2(*c)).collect();
        let mut best1 = vec![(FLOOR, u32::MAX); self.corners[0].len()];
        let mut best2 = vec![(FLOOR, u32::MAX); self.corners[1].len()];
        for pair in &self.pairs {
            let (i, j) = (pair.corner1 as usize, pair.corner2 as usize);
            let (Some(line2), Some(line1)) = (&lines2[i], &lines1[j]) else { continue };
            if line2.distance(self.corners[1][j]) > band || line1.distance(self.corners[0][i]) > band {
                continue;
            }
            if pair.correlation > best1[i].0 {
                best1[i] = (pair.correlation, pair.corner2);
            }
            if pair.correlation > best2[j].0 {
                best2[j] = (pair.correlation, pair.corner1);
            }
        }
        best1
            .iter()
            .enumerate()
            .filter(|(i, (_, j))| *j != u32::MAX && best2[*j as usize].1 == *i as u32)
            .map(|(i, (correlation, j))| SupportingMatch {
                pair: PointPair { point1: self.corners[0][i], point2: self.corners[1][*j as usize] },
                correlation: *correlation,
            })
            .collect()
    }

    /// Sum over the matches of how far their correlation exceeds the floor.
    pub fn score(&self, f: &FundamentalMatrix, band: f64) -> f64 {
        self.matches(f, band).iter().map(|m| f64::from(m.correlation - FLOOR)).sum()
    }
}
