//! Support by matches of covariant features, beside that of corners: each counts where it is near its epipolar lines.

use multiversion::multiversion;

use crate::geometry::{FundamentalMatrix, PointPair};

/// Correlations below this say nothing.
pub(super) const FLOOR: f32 = 0.6;
/// Matches or corners that are looked at together.
pub(super) const LANES: usize = 8;
/// What is added to the band where single precision looks first, px.
const NEAR_SLACK: f64 = 0.1;

/// A supporting match and its correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct SupportingMatch {
    pub pair: PointPair,
    pub correlation: f32,
}

/// A match of covariant features that supports a geometry beside those of corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct FeatureSupport {
    /// Full-size pixels.
    pub pair: PointPair,
    /// Standard deviation of a coordinate, px of image 1.
    pub sigma: f64,
    /// What it is worth, on the scale of correlations of patches.
    pub correlation: f32,
}

impl FeatureSupport {
    /// A match whose descriptors' distance is this share of that to the next best. What is as near to another place says
    /// nothing, as a correlation at the floor; what is unique is worth a correlation of 1.
    pub fn new(pair: PointPair, sigma: f64, ratio: f64) -> Self {
        Self { pair, sigma, correlation: FLOOR + (1.0 - FLOOR) * (1.0 - ratio).clamp(0.0, 1.0) as f32 }
    }
}

/// Matches of features, laid out for the vector units beside what they are.
#[derive(Debug, Clone, Default)]
pub(super) struct FeatureMatches {
    matches: Vec<SupportingMatch>,
    blocks: Vec<FeatureBlock>,
}

/// Positions of some matches in both images.
#[derive(Debug, Clone, Copy)]
struct FeatureBlock {
    x1: [f32; LANES],
    y1: [f32; LANES],
    x2: [f32; LANES],
    y2: [f32; LANES],
}

impl FeatureMatches {
    pub fn new(matches: Vec<SupportingMatch>) -> Self {
        let blocks = matches.chunks(LANES).map(|chunk| {
            // Lanes without a match compare as false.
            let [x1, y1, x2, y2] = [[f32::NAN; LANES]; 4];
            let mut block = FeatureBlock { x1, y1, x2, y2 };
            for (k, SupportingMatch { pair, .. }) in chunk.iter().enumerate() {
                (block.x1[k], block.y1[k]) = (pair.point1.x as f32, pair.point1.y as f32);
                (block.x2[k], block.y2[k]) = (pair.point2.x as f32, pair.point2.y as f32);
            }
            block
        });
        Self { blocks: blocks.collect(), matches }
    }

    /// Those within `band` px of each other's epipolar lines. Nearly all are far from them, which single precision tells:
    /// lines are good to some thousandths of a pixel.
    pub fn within(&self, f: &FundamentalMatrix, band: f64) -> impl Iterator<Item = SupportingMatch> {
        let scaled = f.matrix() / f.matrix().amax();
        let rows = std::array::from_fn(|k| scaled[(k / 3, k % 3)] as f32);
        near_lines(&self.blocks, &rows, (band + NEAR_SLACK) as f32)
            .into_iter()
            .map(|k| self.matches[k])
            .filter(move |m| is_within(f, &m.pair, band))
    }
}

/// Numbers of the matches whose points in image 2 are within `band` px of their lines.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn near_lines(blocks: &[FeatureBlock], f: &[f32; 9], band: f32) -> Vec<usize> {
    let mut found = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        let near: [bool; LANES] = std::array::from_fn(|k| {
            let (x1, y1) = (block.x1[k], block.y1[k]);
            let a = f[0] * x1 + f[1] * y1 + f[2];
            let b = f[3] * x1 + f[4] * y1 + f[5];
            let c = f[6] * x1 + f[7] * y1 + f[8];
            let e = a * block.x2[k] + b * block.y2[k] + c;
            e * e <= band * band * (a * a + b * b)
        });
        if near != [false; LANES] {
            found.extend((0..LANES).filter(|k| near[*k]).map(|k| index * LANES + k));
        }
    }
    found
}

/// Whether both points of a pair are within `band` px of each other's epipolar lines.
pub(super) fn is_within(f: &FundamentalMatrix, pair: &PointPair, band: f64) -> bool {
    f.line2_from_point1(pair.point1).is_some_and(|line| line.distance(pair.point2) <= band)
        && f.line1_from_point2(pair.point2).is_some_and(|line| line.distance(pair.point1) <= band)
}
