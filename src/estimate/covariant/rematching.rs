//! Matching again along epipolar lines: what looks alike elsewhere in the picture no longer matters.

use multiversion::multiversion;
use rayon::prelude::*;

use super::consensus::BAND;
use super::{FeatureEvidence, sigma};
use crate::features::{FeatureMatch, FeatureSet, match_candidates};
use crate::geometry::FundamentalMatrix;
use crate::lanes::{LANES, SetLanes};

/// Largest ratio of the distance to the best to that to the second best near the line.
const LARGEST_RATIO: f64 = 0.85;

/// Sixteen features of image 2, single precision: lines have unit normals, so that is 10⁻³ px.
#[derive(Debug, Clone, Copy)]
struct FeatureBlock {
    x: [f32; LANES],
    y: [f32; LANES],
    /// Variance of the distance to a line, by the feature's own error, px².
    variance: [f32; LANES],
    /// Squared length of the normal of its line in image 1, `(Fᵀ x2)₁₂`.
    pull: [f32; LANES],
}

/// Mutual nearest neighbours among the features whose residual is within the band.
pub(super) fn guided_matches(evidence: &FeatureEvidence, f: &FundamentalMatrix) -> Vec<FeatureMatch> {
    let [features1, features2] = evidence.sets.map(FeatureSet::features);
    let blocks: Vec<FeatureBlock> = features2
        .chunks(LANES)
        .map(|chunk| {
            // Lanes without a feature are nowhere.
            let [x, y] = [[f32::INFINITY; LANES]; 2];
            let mut block = FeatureBlock { x, y, variance: [0.0; LANES], pull: [0.0; LANES] };
            for (k, b) in chunk.iter().enumerate() {
                (block.x[k], block.y[k]) = (b.position.x as f32, b.position.y as f32);
                block.variance[k] = sigma(b.scale, evidence.frames[1]).powi(2) as f32;
                let line1 = f.matrix().tr_mul(&b.position.to_homogeneous());
                block.pull[k] = line1.xy().norm_squared() as f32;
            }
            block
        })
        .collect();
    let candidates: Vec<Vec<usize>> = features1
        .par_iter()
        .map(|a| {
            let line = f.matrix() * a.position.to_homogeneous();
            let length = line.xy().norm();
            let unit = (line / length).map(|v| v as f32);
            let pulled = (sigma(a.scale, evidence.frames[0]) / length).powi(2) as f32;
            if unit.iter().all(|v| v.is_finite()) {
                near_line(&blocks, unit.into(), pulled)
            } else {
                Vec::new()
            }
        })
        .collect();
    match_candidates(evidence.sets, &candidates, LARGEST_RATIO)
}

/// Indices of the features near a line with a unit normal; `pulled` times a feature's pull is the variance that the point
/// in image 1 brings.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn near_line(blocks: &[FeatureBlock], line: [f32; 3], pulled: f32) -> Vec<usize> {
    let limit = (BAND * BAND) as f32;
    let mut found = Vec::new();
    for (index, b) in blocks.iter().enumerate() {
        let mut near = [0u8; LANES];
        for (k, near) in near.iter_mut().enumerate() {
            let distance = line[0] * b.x[k] + line[1] * b.y[k] + line[2];
            *near = u8::from(distance * distance < limit * (b.variance[k] + pulled * b.pull[k]));
        }
        for lane in SetLanes::of(near) {
            found.push(index * LANES + lane);
        }
    }
    found
}
