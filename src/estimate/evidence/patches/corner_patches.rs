//! Corners of both images at one size, with the patches around them.

use rayon::prelude::*;

use crate::geometry::Point;
use crate::image::{
    GrayPlane, HALF, PairLevel, Patch, PatchBlock, PatchSampler, Sketch, Warp, correlations, may_correlate,
    most_correlations,
};

/// Corners of two images with their patches: one patch for each corner of image 1, one under each
/// warp for each corner of image 2.
#[derive(Debug)]
pub(in crate::estimate) struct CornerPatches {
    /// Corners of image 1 whose surroundings are not flat.
    pub points1: Vec<Point>,
    patches1: Vec<Patch>,
    sketches1: Vec<Sketch>,
    pub points2: Vec<Point>,
    blocks2: Vec<PatchBlock>,
    pub warps: Vec<Warp>,
}

/// Correlation of two corners under the best warp, and the index of that warp.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Likeness {
    pub correlation: f32,
    pub warp: u8,
}

impl Likeness {
    /// Likeness of corners that do not match. Their correlation is not computed.
    const NONE: Self = Self { correlation: -1.0, warp: 0 };

    fn best(correlations: &[f32]) -> Self {
        let mut best = Self::NONE;
        for (warp, correlation) in (0..).zip(correlations) {
            if *correlation > best.correlation {
                best = Self { correlation: *correlation, warp };
            }
        }
        best
    }
}

impl CornerPatches {
    /// Finds up to `count` corners in each image and samples their patches.
    pub fn new(level: &PairLevel, count: usize, warps: Vec<Warp>) -> Self {
        let find = |image: usize| level.corners(image, count, HALF + 1);
        let (corners1, points2) = rayon::join(|| find(0), || find(1));
        Self::around(level.planes, corners1, points2, warps)
    }

    /// Samples the patches around these corners.
    pub fn around(
        planes: [&GrayPlane; 2],
        corners1: Vec<Point>,
        points2: Vec<Point>,
        warps: Vec<Warp>,
    ) -> Self {
        let sampler = PatchSampler::new(planes[0], &Warp::identity());
        let (points1, patches1): (Vec<Point>, Vec<Patch>) =
            corners1.into_iter().filter_map(|point| Some((point, sampler.patch(point)?))).unzip();
        let samplers: Vec<PatchSampler> =
            warps.iter().map(|warp| PatchSampler::new(planes[1], warp)).collect();
        let block = |point: &Point| PatchBlock::new(samplers.iter().map(|s| s.patch(*point)));
        let blocks2 = points2.par_iter().map(block).collect();
        Self { sketches1: Sketch::of_all(patches1.iter()), points1, patches1, points2, blocks2, warps }
    }

    /// Returns the likeness of corner `i` of image 1 and corner `j` of image 2; [`Likeness::NONE`]
    /// if an upper bound on the correlation is not above `least`.
    pub fn likeness(&self, i: usize, j: usize, least: f32) -> Likeness {
        let block = &self.blocks2[j];
        let mut may_be = false;
        for most in most_correlations(&self.sketches1[i], block) {
            may_be |= most > least;
        }
        if may_be { self.exact(i, block) } else { Likeness::NONE }
    }

    /// Returns the corners of image 1 that correlate with corner `j` of image 2 by more than
    /// `least`, in ascending order, with their correlations. `room` is a buffer for candidates.
    pub fn alike(&self, j: usize, least: f32, room: &mut Vec<u32>) -> Vec<(u32, f32)> {
        let block = &self.blocks2[j];
        may_correlate(&self.sketches1, block, least, room);
        let of_corner = |i: &u32| (*i, self.exact(*i as usize, block).correlation);
        room.iter().map(of_corner).filter(|(_, correlation)| *correlation > least).collect()
    }

    fn exact(&self, i: usize, block: &PatchBlock) -> Likeness {
        Likeness::best(&correlations(&self.patches1[i], block)[..self.warps.len()])
    }
}
