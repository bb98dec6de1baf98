//! The corners of one level with their patches, and which of them are each other's best match.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::near_lines::Places;
use crate::geometry::Point;
use crate::image::{
    HALF, PairLevel, Patch, PatchBlock, PatchSampler, RelativeView, Sketch, Warp, correlations, find_corners,
    most_correlations, warps_around,
};

/// Corners an image.
const CORNERS: usize = 1500;
/// Patches that correlate less than this are no match.
pub(super) const LEAST_CORRELATION: f32 = 0.75;

/// Two corners, by their numbers, and the warp under which they look alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Alike {
    pub corner1: u32,
    pub corner2: u32,
    pub warp: u8,
}

/// The corners of a level with their patches: one of each in image 1, those under all warps in image 2.
#[derive(Debug)]
pub(super) struct LevelCorners {
    pub firsts: Vec<(Point, Patch)>,
    sketches1: Vec<Sketch>,
    seconds: Vec<PatchBlock>,
    /// Where those of image 2 are.
    pub places2: Places,
    pub warps: Vec<Warp>,
    /// What is known of each pair of corners, one row for each of image 1: geometries that are refined after each other
    /// look at nearly the same pairs.
    likeness: Vec<AtomicU32>,
}

/// How alike two corners are under the best of all warps, and which one that is.
#[derive(Debug, Clone, Copy)]
struct Likeness {
    correlation: f32,
    warp: u8,
}

impl Likeness {
    /// Of corners that are no match, however alike they are.
    const NONE: Self = Self { correlation: -1.0, warp: 0 };
    /// Bits that hold the number of the warp, in place of the last ones of the correlation.
    const WARP: u32 = 0xf;

    fn best(correlations: &[f32]) -> Self {
        let (mut correlation, mut warp) = (-1.0, 0);
        for (k, value) in correlations.iter().enumerate() {
            if *value > correlation {
                (correlation, warp) = (*value, k as u8);
            }
        }
        Self { correlation, warp }
    }

    /// 0 stands for what is not known; what comes out as 0 is computed again.
    fn packed(self) -> u32 {
        self.correlation.to_bits() & !Self::WARP | u32::from(self.warp)
    }

    fn unpacked(bits: u32) -> Self {
        Self { correlation: f32::from_bits(bits & !Self::WARP), warp: (bits & Self::WARP) as u8 }
    }
}

impl LevelCorners {
    pub fn new(level: &PairLevel, view: RelativeView) -> Self {
        let warps = warps_around(&level.warp(view));
        let find = |image: usize| find_corners(level.planes[image], CORNERS, HALF + 2);
        let (corners1, corners2) = rayon::join(|| find(0), || find(1));
        let sampler = PatchSampler::new(level.planes[0], &Warp::identity());
        let firsts: Vec<(Point, Patch)> =
            corners1.into_iter().filter_map(|point| Some((point, sampler.patch(point)?))).collect();
        let samplers: Vec<PatchSampler> =
            warps.iter().map(|warp| PatchSampler::new(level.planes[1], warp)).collect();
        let block = |point: &Point| PatchBlock::new(samplers.iter().map(|s| s.patch(*point)));
        let seconds: Vec<PatchBlock> = corners2.par_iter().map(block).collect();
        let likeness = (0..firsts.len() * seconds.len()).map(|_| AtomicU32::new(0)).collect();
        let sketches1 = Sketch::of_all(firsts.iter().map(|(_, patch)| patch));
        Self { firsts, sketches1, seconds, places2: Places::new(corners2), warps, likeness }
    }

    /// How alike corner `i` of image 1 and corner `j` of image 2 are, if they may be a match.
    fn likeness(&self, i: usize, j: usize) -> Likeness {
        // Whoever comes first writes the same number.
        let known = &self.likeness[i * self.seconds.len() + j];
        let bits = known.load(Ordering::Relaxed);
        if bits != 0 {
            return Likeness::unpacked(bits);
        }
        let most = most_correlations(&self.sketches1[i], &self.seconds[j]);
        let bits = if most.iter().all(|most| *most <= LEAST_CORRELATION) {
            Likeness::NONE
        } else {
            Likeness::best(&correlations(&self.firsts[i].1, &self.seconds[j])[..self.warps.len()])
        }
        .packed();
        known.store(bits, Ordering::Relaxed);
        Likeness::unpacked(bits)
    }

    /// Mutual best matches of correlations above the least, with these: `find` puts the numbers of the corners of image 2 that
    /// may be the partner of a point of image 1 into an empty list.
    pub fn mutual(&self, find: impl Fn(Point, &mut Vec<usize>) + Sync) -> Vec<(Alike, f32)> {
        // Best partner of each corner of image 1 with its warp, then of each corner of image 2.
        let best1: Vec<Option<(usize, Likeness)>> = self
            .firsts
            .par_iter()
            .enumerate()
            .map_init(Vec::new, |near, (i, (point1, _))| {
                near.clear();
                find(*point1, near);
                let mut best: Option<(usize, Likeness)> = None;
                for j in near {
                    let likeness = self.likeness(i, *j);
                    if likeness.correlation > best.map_or(LEAST_CORRELATION, |(_, best)| best.correlation) {
                        best = Some((*j, likeness));
                    }
                }
                best
            })
            .collect();
        let mut best2: Vec<Option<(usize, Likeness)>> = vec![None; self.seconds.len()];
        for (i, best) in best1.iter().enumerate() {
            if let Some((j, likeness)) = best
                && best2[*j].is_none_or(|(_, best)| likeness.correlation > best.correlation)
            {
                best2[*j] = Some((i, *likeness));
            }
        }
        best2
            .iter()
            .enumerate()
            .filter_map(|(j, best)| {
                let (i, Likeness { correlation, warp }) = (*best)?;
                Some((Alike { corner1: i as u32, corner2: j as u32, warp }, correlation))
            })
            .collect()
    }
}
