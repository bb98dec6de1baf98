//! Score of a fundamental matrix on a pool of matches, fast enough for tens of thousands of matrices.
//!
//! ```text
//!     S(F) = Σ gₘ · max(0, 1 − rₘ² / 9),      gₘ = ln(1 + oₘ · L / (σ √2π))
//! ```
//!
//! `r` is the Sampson distance in units of its own standard deviation,
//! `e / √(σ1² |Fᵀx2|² + σ2² |F x1|²)`. The σ of each image is that of a feature of this scale. `o` are the prior odds of the
//! match. `g` is the log-likelihood of a match that fits exactly, less the log-likelihood of a
//! match anywhere within `L` pixels. The score is a truncated likelihood (MLESAC, Torr & Zisserman
//! 2000).

use multiversion::multiversion;
use nalgebra::Matrix3;

use crate::geometry::{Frame, Point, PointPair, scaling};

/// Residual, in standard deviations, beyond which a match does not count.
pub(in crate::estimate) const BAND: f64 = 3.0;
const LANES: usize = 16;

type Lane = [f32; LANES];

/// Sixteen matches in conditioned coordinates.
#[derive(Debug, Clone, Copy, Default)]
struct WitnessBlock {
    x1: Lane,
    y1: Lane,
    x2: Lane,
    y2: Lane,
    /// Variance of a coordinate in each image.
    variance1: Lane,
    variance2: Lane,
    gain: Lane,
}

/// A match to be explained.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Witness {
    pub pair: PointPair,
    /// Standard deviation of a coordinate in each image, px.
    pub sigmas: [f64; 2],
    /// Weight g above.
    pub gain: f64,
    pub clicked: bool,
}

/// Conditioned coordinates: from the middle of each image, in units of half its longer side.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Units {
    middles: [Point; 2],
    units: [f64; 2],
}

impl Units {
    pub fn new(frames: [Frame; 2]) -> Self {
        Self { middles: frames.map(|frame| frame.centre()), units: frames.map(|f| 0.5 * f.longer_side()) }
    }

    /// Returns a pair in these units.
    pub fn pair(&self, pair: &PointPair) -> [f64; 4] {
        let a = (pair.point1 - self.middles[0]) / self.units[0];
        let b = (pair.point2 - self.middles[1]) / self.units[1];
        [a.x, a.y, b.x, b.y]
    }

    fn to(self, image: usize) -> Matrix3<f64> {
        let (s, m) = (1.0 / self.units[image], self.middles[image]);
        scaling(s, -s * m.x, -s * m.y)
    }

    fn from(self, image: usize) -> Matrix3<f64> {
        let (s, m) = (self.units[image], self.middles[image]);
        scaling(s, m.x, m.y)
    }

    /// Returns the matrix for these units, given one for pixels.
    pub fn conditioned(self, f: &Matrix3<f64>) -> Matrix3<f64> {
        self.from(1).transpose() * f * self.from(0)
    }

    /// Returns the matrix for pixels, given one for these units.
    pub fn in_pixels(self, f: &Matrix3<f64>) -> Matrix3<f64> {
        self.to(1).transpose() * f * self.to(0)
    }

    /// Returns directions in an image in these units.
    pub fn length(&self, image: usize, pixels: f64) -> f64 {
        pixels / self.units[image]
    }
}

/// A pool of witnesses, laid out for vector instructions.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Consensus {
    units: Units,
    blocks: Vec<WitnessBlock>,
}

impl Consensus {
    pub fn new(units: Units, witnesses: &[Witness]) -> Self {
        let blocks = witnesses
            .chunks(LANES)
            .map(|chunk| {
                // Lanes without a match have no gain.
                let mut block = WitnessBlock {
                    variance1: [1.0; LANES],
                    variance2: [1.0; LANES],
                    ..WitnessBlock::default()
                };
                for (k, w) in chunk.iter().enumerate() {
                    let [x1, y1, x2, y2] = units.pair(&w.pair).map(|v| v as f32);
                    (block.x1[k], block.y1[k], block.x2[k], block.y2[k]) = (x1, y1, x2, y2);
                    block.variance1[k] = units.length(0, w.sigmas[0]).powi(2) as f32;
                    block.variance2[k] = units.length(1, w.sigmas[1]).powi(2) as f32;
                    block.gain[k] = w.gain as f32;
                }
                block
            })
            .collect();
        Self { units, blocks }
    }

    /// Returns the score S of a matrix for pixels.
    pub fn score(&self, f: &Matrix3<f64>) -> f64 {
        self.score_conditioned(&self.units.conditioned(f))
    }

    /// Returns the score S of a matrix for conditioned coordinates.
    pub fn score_conditioned(&self, f: &Matrix3<f64>) -> f64 {
        let f = f / f.amax();
        let rows = std::array::from_fn(|k| f[(k / 3, k % 3)] as f32);
        f64::from(score_blocks(&self.blocks, &rows))
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn score_blocks(blocks: &[WitnessBlock], f: &[f32; 9]) -> f32 {
    let mut sums = [0f32; LANES];
    let scale = (1.0 / (BAND * BAND)) as f32;
    for b in blocks {
        for (k, sum) in sums.iter_mut().enumerate() {
            let (x1, y1, x2, y2) = (b.x1[k], b.y1[k], b.x2[k], b.y2[k]);
            let a2 = f[0] * x1 + f[1] * y1 + f[2];
            let b2 = f[3] * x1 + f[4] * y1 + f[5];
            let c2 = f[6] * x1 + f[7] * y1 + f[8];
            let a1 = f[0] * x2 + f[3] * y2 + f[6];
            let b1 = f[1] * x2 + f[4] * y2 + f[7];
            let e = a2 * x2 + b2 * y2 + c2;
            let variance =
                b.variance1[k] * (a1 * a1 + b1 * b1) + b.variance2[k] * (a2 * a2 + b2 * b2) + 1e-20;
            *sum += b.gain[k] * (1.0 - scale * e * e / variance).max(0.0);
        }
    }
    sums.iter().sum()
}

/// Returns the Sampson distance of a pair in standard deviations.
pub(in crate::estimate) fn residual(f: &Matrix3<f64>, witness: &Witness) -> f64 {
    let (x1, x2) = (witness.pair.point1.to_homogeneous(), witness.pair.point2.to_homogeneous());
    let (l2, l1) = (f * x1, f.tr_mul(&x2));
    let [s1, s2] = witness.sigmas;
    let variance = s1 * s1 * l1.xy().norm_squared() + s2 * s2 * l2.xy().norm_squared();
    x2.dot(&l2).abs() / variance.sqrt().max(1e-300)
}
