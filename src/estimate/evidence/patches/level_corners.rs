//! Corners of one level and their mutual best matches.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::corner_patches::{CornerPatches, Likeness};
use super::near_lines::Places;
use crate::geometry::Point;
use crate::image::HALF;

/// Least correlation of matched patches at full size. It is lower than for aligned patches, since
/// these stand at whole pixels.
pub(super) const LEAST_CORRELATION: f32 = 0.75;

/// Indices of two corners, and the warp under which they look alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Alike {
    pub corner1: u32,
    pub corner2: u32,
    pub warp: u8,
}

/// Two corners that are each other's best match.
#[derive(Debug, Clone, Copy)]
pub(super) struct MutualMatch {
    pub alike: Alike,
    pub correlation: f32,
    /// Probability that this is the right match among similar places: ½ for two equal ones.
    pub prior: f32,
}

/// Distance, px, below which two corners show the same place: half a patch.
pub(super) const ELSEWHERE: f64 = HALF as f64;
/// Noise of the correlation of a right match. Fitted to facades by eye: of matches whose best
/// competitor correlates less by 0.02, 0.1 and 0.2, about 40, 80 and 85 % are right.
pub(super) const CORRELATION_NOISE: f32 = 0.05;

/// Corners of a level, and the likeness of each pair once it is computed.
#[derive(Debug)]
pub(super) struct LevelCorners {
    pub patches: Arc<CornerPatches>,
    /// Places of the corners of image 2.
    pub places2: Places,
    /// Known likeness of each pair of corners, one row for each corner of image 1. Geometries that
    /// are refined one after the other compare nearly the same pairs.
    likeness: Vec<AtomicU32>,
}

/// Low bits of the correlation, replaced by the index of the warp.
const WARP: u32 = 0xf;

/// Packs a likeness into bits. 0 means unknown; a likeness that packs to 0 is computed again.
fn packed(likeness: Likeness) -> u32 {
    likeness.correlation.to_bits() & !WARP | u32::from(likeness.warp)
}

fn unpacked(bits: u32) -> Likeness {
    Likeness { correlation: f32::from_bits(bits & !WARP), warp: (bits & WARP) as u8 }
}

impl LevelCorners {
    pub fn new(patches: Arc<CornerPatches>) -> Self {
        let pairs = patches.points1.len() * patches.points2.len();
        let likeness = (0..pairs).map(|_| AtomicU32::new(0)).collect();
        Self { places2: Places::new(patches.points2.clone()), patches, likeness }
    }

    /// Returns the likeness of corner `i` of image 1 and corner `j` of image 2.
    fn likeness(&self, i: usize, j: usize) -> Likeness {
        // All threads would write the same number.
        let known = &self.likeness[i * self.patches.points2.len() + j];
        let mut bits = known.load(Ordering::Relaxed);
        if bits == 0 {
            bits = packed(self.patches.likeness(i, j, LEAST_CORRELATION));
            known.store(bits, Ordering::Relaxed);
        }
        unpacked(bits)
    }

    /// Returns the mutual best matches whose correlation exceeds the least. `find` fills an empty
    /// list with the indices of the corners of image 2 that may match a point of image 1.
    pub fn mutual(&self, find: impl Fn(Point, &mut Vec<usize>) + Sync) -> Vec<MutualMatch> {
        let points = [&self.patches.points1, &self.places2.points].map(Vec::as_slice);
        mutual_matches(points, find, |i, j| self.likeness(i, j))
    }
}

/// Returns the mutual best matches among points of two images, as [`LevelCorners::mutual`] does.
/// `likeness` compares a point of image 1 with one of image 2, both by index.
pub(super) fn mutual_matches(
    [points1, points2]: [&[Point]; 2],
    find: impl Fn(Point, &mut Vec<usize>) + Sync,
    likeness: impl Fn(usize, usize) -> Likeness + Sync,
) -> Vec<MutualMatch> {
    // Probability that point `j` is the partner rather than one of the others. Points are likelier
    // the higher they correlate.
    let prior = |i: usize, j: usize, correlation: f32, others: &[usize]| {
        let elsewhere = others.iter().filter(|k| (points2[**k] - points2[j]).norm() > ELSEWHERE);
        let likely = |k: &usize| ((likeness(i, *k).correlation - correlation) / CORRELATION_NOISE).exp();
        1.0 / (1.0 + elsewhere.map(likely).sum::<f32>())
    };
    // The best partner of each point of image 1 with its prior, then of each point of image 2.
    let best1: Vec<Option<(usize, Likeness, f32)>> = points1
        .par_iter()
        .enumerate()
        .map_init(Vec::new, |near, (i, point1)| {
            near.clear();
            find(*point1, near);
            let mut best: Option<(usize, Likeness)> = None;
            for j in near.iter() {
                let likeness = likeness(i, *j);
                if likeness.correlation > best.map_or(LEAST_CORRELATION, |(_, best)| best.correlation) {
                    best = Some((*j, likeness));
                }
            }
            best.map(|(j, likeness)| (j, likeness, prior(i, j, likeness.correlation, near)))
        })
        .collect();
    let mut best2: Vec<Option<(usize, Likeness, f32)>> = vec![None; points2.len()];
    for (i, best) in best1.iter().enumerate() {
        if let Some((j, likeness, prior)) = best
            && best2[*j].is_none_or(|(_, best, _)| likeness.correlation > best.correlation)
        {
            best2[*j] = Some((i, *likeness, *prior));
        }
    }
    best2
        .iter()
        .enumerate()
        .filter_map(|(j, best)| {
            let (i, Likeness { correlation, warp }, prior) = (*best)?;
            let alike = Alike { corner1: i as u32, corner2: j as u32, warp };
            Some(MutualMatch { alike, correlation, prior })
        })
        .collect()
}
