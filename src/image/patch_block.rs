//! Correlations of many patches with many others, and upper bounds for them from low-frequency
//! waves.

use std::f64::consts::PI;
use std::sync::LazyLock;

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::patch::{AREA, Patch, SIDE};
use crate::lanes::LANES;

/// Number of rows summed together: as many sums as fit into the registers of most processors.
const AT_ONCE: usize = 6;

/// Up to [`LANES`] patches interleaved pixel by pixel, to correlate one patch with all of them at
/// once.
#[derive(Debug, Clone)]
pub(crate) struct PatchBlock {
    rows: [[f32; LANES]; AREA],
    sketches: SketchBlock,
}

/// The low-frequency content of a patch: its cosine coefficients, and the norm of the remainder.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sketch {
    waves: [f32; WAVES],
    rest: f32,
}

/// Sketches of the patches of a block, interleaved in the same way.
#[derive(Debug, Clone)]
struct SketchBlock {
    waves: [[f32; LANES]; WAVES],
    rest: [f32; LANES],
}

/// Number of waves of a sketch. Up to about three periods across a patch hold nearly all of a
/// corner's content.
const WAVES: usize = 36;

/// The lowest-frequency basis functions of the two-dimensional cosine transform, without the
/// constant, over the pixels of a patch. The functions are orthonormal.
static WAVE_PIXELS: LazyLock<[[f32; AREA]; WAVES]> = LazyLock::new(|| {
    let mut orders: Vec<[usize; 2]> =
        (0..SIDE).flat_map(|v| (0..SIDE).map(move |u| [u, v])).filter(|order| *order != [0, 0]).collect();
    orders.sort_by_key(|[u, v]| (u * u + v * v, *u));
    let along = |order: usize, at: usize| {
        let norm = (if order == 0 { 1.0 } else { 2.0 } / SIDE as f64).sqrt();
        norm * (PI * order as f64 * (at as f64 + 0.5) / SIDE as f64).cos()
    };
    std::array::from_fn(|k| {
        std::array::from_fn(|pixel| {
            let [u, v] = orders[k];
            (along(u, pixel % SIDE) * along(v, pixel / SIDE)) as f32
        })
    })
});

impl PatchBlock {
    /// Places each patch in its lane. An empty lane has zero correlation with every patch.
    pub(crate) fn new(patches: impl IntoIterator<Item = Option<Patch>>) -> Self {
        let mut rows = [[0.0; LANES]; AREA];
        for (lane, patch) in patches.into_iter().take(LANES).enumerate() {
            for (row, value) in rows.iter_mut().zip(patch.iter().flatten()) {
                row[lane] = *value;
            }
        }
        Self { sketches: sketched(&rows, &WAVE_PIXELS), rows }
    }
}

impl Sketch {
    /// Computes the sketches of many patches.
    pub(crate) fn of_all<'p>(patches: impl Iterator<Item = &'p Patch>) -> Vec<Self> {
        let all: Vec<&Patch> = patches.collect();
        let of_some = |some: &[&Patch]| {
            let SketchBlock { waves, rest } =
                PatchBlock::new(some.iter().map(|patch| Some(**patch))).sketches;
            let of_lane = move |lane: usize| Self { waves: waves.map(|wave| wave[lane]), rest: rest[lane] };
            (0..some.len()).map(of_lane)
        };
        all.chunks(LANES).flat_map(of_some).collect()
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx2+fma", "x86_64+avx2+fma", "aarch64+neon"))]
fn sketched(rows: &[[f32; LANES]; AREA], pixels: &[[f32; AREA]; WAVES]) -> SketchBlock {
    let fused = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let mut waves = [[0f32; LANES]; WAVES];
    for (waves, pixels) in waves.chunks_exact_mut(AT_ONCE).zip(pixels.chunks_exact(AT_ONCE)) {
        let pixels: [&[f32; AREA]; AT_ONCE] = std::array::from_fn(|i| &pixels[i]);
        let mut sums = [[0f32; LANES]; AT_ONCE];
        for (k, row) in rows.iter().enumerate() {
            for i in 0..AT_ONCE {
                let pixel = pixels[i][k];
                for lane in 0..LANES {
                    let sum = &mut sums[i][lane];
                    *sum = if fused { pixel.mul_add(row[lane], *sum) } else { pixel * row[lane] + *sum };
                }
            }
        }
        waves.copy_from_slice(&sums);
    }
    // Patches have unit norm; an empty lane has neither norm nor remainder.
    let [mut norm, mut sum] = [[0f32; LANES]; 2];
    for row in rows {
        for lane in 0..LANES {
            norm[lane] += row[lane] * row[lane];
        }
    }
    for wave in &waves {
        for lane in 0..LANES {
            sum[lane] += wave[lane] * wave[lane];
        }
    }
    let mut rest = [0f32; LANES];
    for lane in 0..LANES {
        let left = norm[lane] - sum[lane];
        rest[lane] = (if left > 0.0 { left } else { 0.0 }).sqrt();
    }
    SketchBlock { waves, rest }
}

/// Bound on the rounding error of single precision, with a wide margin.
const ROUNDING: f32 = 1e-4;

/// Collects the indices of the sketches whose patches may correlate with the block above `least`.
///
/// The bound is the correlation of the waves plus the product of the remainders (Cauchy–Schwarz).
/// `found` is cleared first.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
pub(crate) fn may_correlate(sketches: &[Sketch], block: &PatchBlock, least: f32, found: &mut Vec<u32>) {
    // Without the instruction, `mul_add` would be a slow library call.
    let fused = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    found.clear();
    let SketchBlock { waves, rest } = &block.sketches;
    for (chunk, few) in sketches.chunks(AT_ONCE).enumerate() {
        let own: [&Sketch; AT_ONCE] = std::array::from_fn(|i| &few[i.min(few.len() - 1)]);
        let mut sums = [[0f32; LANES]; AT_ONCE];
        for i in 0..AT_ONCE {
            for lane in 0..LANES {
                sums[i][lane] = own[i].rest * rest[lane];
            }
        }
        for (k, wave) in waves.iter().enumerate() {
            for i in 0..AT_ONCE {
                let own = own[i].waves[k];
                for lane in 0..LANES {
                    let sum = &mut sums[i][lane];
                    *sum = if fused { own.mul_add(wave[lane], *sum) } else { own * wave[lane] + *sum };
                }
            }
        }
        for (i, sums) in sums.iter().enumerate().take(few.len()) {
            let mut above = [0u8; LANES];
            for lane in 0..LANES {
                above[lane] = u8::from(sums[lane] > least - ROUNDING);
            }
            if u128::from_le_bytes(above) != 0 {
                found.push((chunk * AT_ONCE + i) as u32);
            }
        }
    }
}

/// Number of partial sums of a correlation, so that no addition waits for the previous one.
const SPLIT: usize = 4;

/// Returns upper bounds for the correlations of a sketch's patch with the patches of a block.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2+fma", "x86_64+avx2+fma", "aarch64+neon"))]
pub(crate) fn most_correlations(sketch: &Sketch, block: &PatchBlock) -> [f32; LANES] {
    let fused = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let SketchBlock { waves, rest } = &block.sketches;
    let mut sums = [[0f32; LANES]; SPLIT];
    for (waves, own) in waves.chunks_exact(SPLIT).zip(sketch.waves.chunks_exact(SPLIT)) {
        for ((wave, own), sums) in waves.iter().zip(own).zip(&mut sums) {
            for (sum, value) in sums.iter_mut().zip(wave) {
                *sum = if fused { own.mul_add(*value, *sum) } else { own * value + *sum };
            }
        }
    }
    let mut most = added(&sums);
    for lane in 0..LANES {
        most[lane] += sketch.rest * rest[lane] + ROUNDING;
    }
    most
}

/// Returns the correlations of a patch with the patches of a block, −1 to 1.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2+fma", "x86_64+avx2+fma", "aarch64+neon"))]
pub(crate) fn correlations(patch: &Patch, block: &PatchBlock) -> [f32; LANES] {
    let fused = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let mut sums = [[0f32; LANES]; SPLIT];
    for (rows, own) in block.rows.chunks(SPLIT).zip(patch.chunks_exact(SPLIT)) {
        for ((row, own), sums) in rows.iter().zip(own).zip(&mut sums) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum = if fused { own.mul_add(*value, *sum) } else { own * value + *sum };
            }
        }
    }
    added(&sums)
}

/// Adds up the partial sums. A loop, because closures passed to the library are not compiled for
/// the instruction set.
#[inline]
fn added(parts: &[[f32; LANES]; SPLIT]) -> [f32; LANES] {
    let mut sums = [0f32; LANES];
    for part in parts {
        for lane in 0..LANES {
            sums[lane] += part[lane];
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::GrayPlane;
    use super::super::patch::tests::plane;
    use super::super::patch::{PatchSampler, Warp, warps_around};
    use super::*;
    use crate::geometry::Point;

    #[test]
    fn correlation_ignores_brightness_and_flat_patches_have_none() {
        let (bright, darker) = (plane(|v| v), plane(|v| 0.5 * v + 3.0));
        let (at, same) = (Point::new(12.0, 13.0), Warp::identity());
        let of = |plane: &GrayPlane| PatchSampler::new(plane, &same).patch(at);
        let (a, b) = (of(&bright).unwrap(), of(&darker).unwrap());
        let block = PatchBlock::new([Some(b), None, Some(a)]);
        let found = correlations(&a, &block);
        assert!([found[0], found[2]].iter().all(|c| (c - 1.0).abs() < 1e-4));
        assert!(found.iter().enumerate().all(|(lane, c)| lane == 0 || lane == 2 || c.abs() < 1e-9));
        assert!(of(&plane(|_| 5.0)).is_none());
    }

    #[test]
    fn all_ways_to_correlate_give_the_same() {
        let plane = plane(|v| v);
        let sampler = |warp: &Warp| PatchSampler::new(&plane, warp);
        let at = |k: usize| Point::new(14.0 + (k % 11) as f64, 13.0 + (k / 3) as f64);
        let few: Vec<Patch> =
            (0..=2 * AT_ONCE).map(|k| sampler(&Warp::identity()).patch(at(k)).unwrap()).collect();
        let turned = warps_around(&Warp::identity())[1..4].to_vec();
        let many: Vec<Vec<Patch>> =
            turned.iter().map(|w| (0..LANES).map(|k| sampler(w).patch(at(k)).unwrap()).collect()).collect();
        let blocks: Vec<PatchBlock> =
            many.iter().map(|list| PatchBlock::new(list.iter().copied().map(Some))).collect();
        let sketches = Sketch::of_all(few.iter());
        let plain = |a: &Patch, b: &Patch| a.iter().zip(b).map(|(x, y)| x * y).sum::<f32>();
        // The threshold is the median of the highest correlations.
        let highest = |a: &Patch, list: &[Patch]| list.iter().map(|b| plain(a, b)).fold(-1.0, f32::max);
        let mut all: Vec<f32> = few.iter().flat_map(|a| many.iter().map(|list| highest(a, list))).collect();
        all.sort_by(f32::total_cmp);
        let least = all[all.len() / 2];
        let mut looked_at = 0;
        for (block, list) in blocks.iter().zip(&many) {
            let mut found = Vec::new();
            may_correlate(&sketches, block, least, &mut found);
            assert!(found.is_sorted());
            looked_at += found.len();
            for (i, (a, sketch)) in few.iter().zip(&sketches).enumerate() {
                let most = most_correlations(sketch, block);
                assert_eq!(found.contains(&(i as u32)), most.iter().any(|most| *most > least));
                assert!(highest(a, list) <= least || found.contains(&(i as u32)));
                for (lane, b) in list.iter().enumerate() {
                    let expected = plain(a, b);
                    assert!((correlations(a, block)[lane] - expected).abs() < 1e-5);
                    // The bound is too high by at most twice the product of the remainders.
                    let rests = sketch.rest * block.sketches.rest[lane];
                    let highest = expected + 2.0 * rests + 2.0 * ROUNDING;
                    assert!((expected..highest).contains(&most[lane]), "{expected} {}", most[lane]);
                }
            }
        }
        assert!(looked_at >= all.len() / 2, "{looked_at}");
    }
}
