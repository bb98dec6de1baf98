//! Guided matching: features are matched again, only near their epipolar lines. Similar features
//! elsewhere no longer compete.

use multiversion::multiversion;
use rayon::prelude::*;

use super::{FeatureEvidence, sigma};
use crate::estimate::fit::BAND;
use crate::features::{FeatureMatch, match_candidates};
use crate::geometry::FundamentalMatrix;
use crate::lanes::{LANES, SetLanes};

/// Largest ratio of best to second-best distance along the line. It is looser than the usual 0.8,
/// since only features near one line compete.
const LARGEST_RATIO: f64 = 0.85;

/// Sixteen features of image 2, or sixteen groups of them. Lines have unit normals, so single
/// precision is good to 10⁻³ px.
#[derive(Debug, Clone, Copy)]
struct FeatureBlock {
    x: [f32; LANES],
    y: [f32; LANES],
    /// Largest distance of the features of a group from its middle, px.
    reach: [f32; LANES],
    /// Variance of the distance to a line due to the feature's own error, px². For a group, the
    /// largest.
    variance: [f32; LANES],
    /// Squared length of the normal of the feature's line in image 1, `(Fᵀ x2)₁₂`. For a group, the
    /// largest.
    pull: [f32; LANES],
}

impl FeatureBlock {
    /// A block without features: empty lanes are infinitely far.
    const EMPTY: Self = {
        let [nowhere, nothing] = [[f32::INFINITY; LANES], [0.0; LANES]];
        Self { x: nowhere, y: nowhere, reach: nothing, variance: nothing, pull: nothing }
    };

    /// Returns the lanes within the band of a line.
    #[inline]
    fn near(&self, line: [f32; 3], pulled: f32) -> SetLanes {
        let limit = (BAND * BAND) as f32;
        let mut near = [0u8; LANES];
        for (k, near) in near.iter_mut().enumerate() {
            let to_middle = (line[0] * self.x[k] + line[1] * self.y[k] + line[2]).abs();
            let distance = (to_middle - self.reach[k]).max(0.0);
            *near = u8::from(distance * distance < limit * (self.variance[k] + pulled * self.pull[k]));
        }
        SetLanes::of(near)
    }
}

/// Features of image 2 in blocks of neighbours. Most blocks are far from a line and skipped.
struct FeatureMap {
    groups: Vec<FeatureBlock>,
    blocks: Vec<FeatureBlock>,
    /// Indices of the features, block by block.
    order: Vec<usize>,
}

impl FeatureMap {
    fn new(evidence: &FeatureEvidence, f: &FundamentalMatrix) -> Self {
        let (features, frame) = (evidence.sets[1].features(), evidence.frames[1]);
        // Strips are about as high as their blocks are wide.
        let strips = (features.len() as f64 / LANES as f64).sqrt().ceil().max(1.0);
        let strip = |k: &usize| (strips * features[*k].position.y / frame.height as f64) as usize;
        let mut order: Vec<usize> = (0..features.len()).collect();
        order.sort_by(|a, b| {
            let x = |k: &usize| features[*k].position.x;
            strip(a).cmp(&strip(b)).then(x(a).total_cmp(&x(b)))
        });
        let block = |numbers: &[usize]| {
            let mut block = FeatureBlock::EMPTY;
            for (k, number) in numbers.iter().enumerate() {
                let feature = &features[*number];
                (block.x[k], block.y[k]) = (feature.position.x as f32, feature.position.y as f32);
                block.variance[k] = sigma(feature.scale, frame).powi(2) as f32;
                let line1 = f.matrix().tr_mul(&feature.position.to_homogeneous());
                block.pull[k] = line1.xy().norm_squared() as f32;
            }
            block
        };
        let blocks: Vec<_> = order.chunks(LANES).map(block).collect();
        Self::of_blocks(blocks, order)
    }

    fn of_blocks(blocks: Vec<FeatureBlock>, order: Vec<usize>) -> Self {
        let counts = order.chunks(LANES).map(<[usize]>::len);
        let bounds: Vec<_> =
            blocks.iter().zip(counts).map(|(block, count)| Bound::of(block, count)).collect();
        Self { groups: bounds.chunks(LANES).map(Bound::together).collect(), blocks, order }
    }
}

/// Bounds of all features of a block.
#[derive(Clone, Copy)]
struct Bound {
    middle: [f32; 2],
    reach: f32,
    variance: f32,
    pull: f32,
}

impl Bound {
    /// Returns the bound of the first `count` lanes of a block.
    fn of(block: &FeatureBlock, count: usize) -> Self {
        /// Allowance for rounding to single precision, px.
        const SLACK: f32 = 0.01;
        let largest = |values: &[f32]| values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let smallest = |values: &[f32]| values.iter().copied().fold(f32::INFINITY, f32::min);
        let middle = [&block.x[..count], &block.y[..count]].map(|v| 0.5 * (smallest(v) + largest(v)));
        let apart = |k: usize| (block.x[k] - middle[0]).hypot(block.y[k] - middle[1]);
        Self {
            middle,
            reach: (0..count).map(apart).fold(0.0, f32::max) + SLACK,
            variance: largest(&block.variance[..count]),
            pull: largest(&block.pull[..count]),
        }
    }

    fn together(bounds: &[Self]) -> FeatureBlock {
        let mut group = FeatureBlock::EMPTY;
        for (k, bound) in bounds.iter().enumerate() {
            [group.x[k], group.y[k]] = bound.middle;
            (group.reach[k], group.variance[k], group.pull[k]) = (bound.reach, bound.variance, bound.pull);
        }
        group
    }
}

/// Returns the mutual nearest neighbours among the features whose residual is within the band.
pub(super) fn guided_matches(evidence: &FeatureEvidence, f: &FundamentalMatrix) -> Vec<FeatureMatch> {
    let map = FeatureMap::new(evidence, f);
    let features1 = evidence.sets[0].features();
    let candidates: Vec<Vec<usize>> = features1
        .par_iter()
        .map(|a| {
            let line = f.matrix() * a.position.to_homogeneous();
            let length = line.xy().norm();
            let unit = (line / length).map(|v| v as f32);
            let pulled = (sigma(a.scale, evidence.frames[0]) / length).powi(2) as f32;
            if unit.iter().all(|v| v.is_finite()) { near_line(&map, unit.into(), pulled) } else { Vec::new() }
        })
        .collect();
    match_candidates(evidence.sets, &candidates, LARGEST_RATIO)
}

/// Returns the indices of the features near a line with a unit normal, in the order of the map.
/// `pulled` times the pull of a feature is the variance due to the point in image 1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn near_line(map: &FeatureMap, line: [f32; 3], pulled: f32) -> Vec<usize> {
    let mut found = Vec::new();
    for (group, bounds) in map.groups.iter().enumerate() {
        for lane in bounds.near(line, pulled) {
            let block = group * LANES + lane;
            for k in map.blocks[block].near(line, pulled) {
                found.push(map.order[block * LANES + k]);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;

    use super::*;
    use crate::features::{Descriptor, Feature, FeatureSet};
    use crate::geometry::{Frame, Point};

    const FRAME: Frame = Frame { width: 900, height: 600 };

    /// Descriptors do not matter here.
    const ALIKE: Descriptor = [0; size_of::<Descriptor>()];

    /// Features spread over an image.
    fn scattered(count: usize) -> FeatureSet {
        let value = |k: usize, step: f64| (k as f64 * step).fract();
        let mut set = FeatureSet::default();
        for k in 0..count {
            let position = Point::new(900.0 * value(k, 0.618_034), 600.0 * value(k, 0.754_877));
            let scale = 1.5 + 6.0 * value(k, 0.37);
            set.push(
                Feature { position, scale, orientation: 0.0, shape: Matrix2::identity(), response: 10.0 },
                ALIKE,
            );
        }
        set
    }

    #[test]
    fn far_blocks_are_skipped_and_no_near_feature_is_lost() {
        let f = crate::geometry::random_scene::example_fundamental();
        let limit = BAND * BAND;
        for count in [1, 16, 17, 700] {
            let sets = [scattered(count), scattered(count)];
            let evidence = FeatureEvidence {
                sets: sets.each_ref(),
                matches: &[],
                frames: [FRAME; 2],
                clicks: &[],
                click_sigma: 1.0,
            };
            let map = FeatureMap::new(&evidence, &f);
            let (mut near, mut looked_at) = (0, 0);
            for a in sets[0].features().iter().take(40) {
                let line = f.matrix() * a.position.to_homogeneous();
                let length = line.xy().norm();
                let line1_error = (sigma(a.scale, FRAME) / length).powi(2);
                let unit: [f32; 3] = (line / length).map(|v| v as f32).into();
                let pulled = line1_error as f32;
                let found = near_line(&map, unit, pulled);
                for (k, b) in sets[1].features().iter().enumerate() {
                    let to_line = (line.dot(&b.position.to_homogeneous()) / length).powi(2);
                    let pull = f.matrix().tr_mul(&b.position.to_homogeneous()).xy().norm_squared();
                    let share = to_line / (limit * (sigma(b.scale, FRAME).powi(2) + line1_error * pull));
                    // Single precision decides at the edge of the band.
                    assert!(found.contains(&k) == (share < 1.0) || (share - 1.0).abs() < 1e-2, "{share}");
                }
                near += found.len();
                looked_at += map.groups.iter().flat_map(|group| group.near(unit, pulled)).count();
            }
            // A strip is as high as a block is wide, so a line crosses some ten of 44 blocks.
            assert!(count < 700 || near > 100 && 3 * looked_at < 40 * map.blocks.len(), "{near} {looked_at}");
        }
    }
}
