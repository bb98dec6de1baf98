//! Corners of both images at one size, with the patches around them.

use rayon::prelude::*;

use super::feature_support::FLOOR;
use crate::estimate::evidence::lazy::Lazy;
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
    look_alikes: Lazy<Vec<Vec<(u32, Likeness)>>>,
}

/// Correlation of two corners under the best warp, and the index of that warp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct Likeness {
    pub correlation: f32,
    pub warp: u8,
}

impl Likeness {
    /// Likeness of corners that do not match. Their correlation is not computed.
    pub(super) const NONE: Self = Self { correlation: -1.0, warp: 0 };

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
        let sketches1 = Sketch::of_all(patches1.iter());
        Self { points1, patches1, sketches1, points2, blocks2, warps, look_alikes: Lazy::default() }
    }

    /// Returns the likeness of corner `i` of image 1 and corner `j` of image 2; [`Likeness::NONE`]
    /// if an upper bound on the correlation is not above `least`.
    pub fn likeness(&self, i: usize, j: usize, least: f32) -> Likeness {
        if self.may_be_alike(i, j, least) { self.exact(i, &self.blocks2[j]) } else { Likeness::NONE }
    }

    /// Returns whether an upper bound on the correlation of two corners is above `least`.
    pub fn may_be_alike(&self, i: usize, j: usize, least: f32) -> bool {
        let mut may_be = false;
        for most in most_correlations(&self.sketches1[i], &self.blocks2[j]) {
            may_be |= most > least;
        }
        may_be
    }

    /// Returns the corners of image 1 that may correlate with each corner of image 2 by more than [`FLOOR`], in
    /// ascending order, with their likeness. All others correlate less.
    pub fn look_alikes(&self) -> &[Vec<(u32, Likeness)>] {
        self.look_alikes.get_or_make(|| {
            let of_corner = |room: &mut Vec<u32>, block: &PatchBlock| {
                may_correlate(&self.sketches1, block, FLOOR, room);
                room.iter().map(|i| (*i, self.exact(*i as usize, block))).collect()
            };
            self.blocks2.par_iter().map_init(Vec::new, of_corner).collect()
        })
    }

    /// Returns [`Self::look_alikes`] if they are known.
    pub fn known_look_alikes(&self) -> Option<&[Vec<(u32, Likeness)>]> {
        self.look_alikes.get().map(Vec::as_slice)
    }

    fn exact(&self, i: usize, block: &PatchBlock) -> Likeness {
        Likeness::best(&correlations(&self.patches1[i], block)[..self.warps.len()])
    }
}
