//! Corners of one level and their mutual best matches.

use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

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
    /// [`UNKNOWN`], [`UNLIKE`] or [`ALIKE`] for each pair of corners, one row for each corner of image 1.
    /// Geometries that are refined one after the other compare nearly the same pairs, most of them unlike.
    states: Vec<AtomicU8>,
    /// Corners of image 2 that are alike a corner of image 1, with their likeness.
    alike: Vec<Mutex<Vec<(usize, Likeness)>>>,
}

const UNKNOWN: u8 = 0;
/// The correlation is not above the least.
const UNLIKE: u8 = 1;
const ALIKE: u8 = 2;

impl LevelCorners {
    pub fn new(patches: Arc<CornerPatches>) -> Self {
        let (rows, columns) = (patches.points1.len(), patches.points2.len());
        let known = patches.known_look_alikes();
        let state = if known.is_some() { UNLIKE } else { UNKNOWN };
        let states: Vec<AtomicU8> = (0..rows * columns).map(|_| AtomicU8::new(state)).collect();
        let mut alike: Vec<Vec<(usize, Likeness)>> = vec![Vec::new(); rows];
        for (j, found) in known.into_iter().flatten().enumerate() {
            for (i, likeness) in found {
                let i = *i as usize;
                if patches.may_be_alike(i, j, LEAST_CORRELATION) {
                    states[i * columns + j].store(ALIKE, Ordering::Relaxed);
                    alike[i].push((j, *likeness));
                }
            }
        }
        let alike = alike.into_iter().map(Mutex::new).collect();
        Self { places2: Places::new(patches.points2.clone()), states, alike, patches }
    }

    /// Returns the likeness of corner `i` of image 1 and corner `j` of image 2.
    fn likeness(&self, i: usize, j: usize) -> Likeness {
        let state = &self.states[i * self.patches.points2.len() + j];
        // Entries are whole whatever happened to a thread that held the lock.
        let alike = || self.alike[i].lock().unwrap_or_else(PoisonError::into_inner);
        let known = match state.load(Ordering::Acquire) {
            UNLIKE => return Likeness::NONE,
            ALIKE => alike().iter().find(|(other, _)| *other == j).map(|(_, likeness)| *likeness),
            _ => None,
        };
        known.unwrap_or_else(|| {
            let likeness = self.patches.likeness(i, j, LEAST_CORRELATION);
            if likeness == Likeness::NONE {
                state.store(UNLIKE, Ordering::Release);
            } else {
                // Another thread may have added the same.
                alike().push((j, likeness));
                state.store(ALIKE, Ordering::Release);
            }
            likeness
        })
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
    let prior = |j: usize, correlation: f32, others: &[usize], correlations: &[f32]| {
        let elsewhere =
            others.iter().zip(correlations).filter(|(k, _)| (points2[**k] - points2[j]).norm() > ELSEWHERE);
        let likely = |(_, other): (&usize, &f32)| ((other - correlation) / CORRELATION_NOISE).exp();
        1.0 / (1.0 + elsewhere.map(likely).sum::<f32>())
    };
    // The best partner of each point of image 1 with its prior, then of each point of image 2.
    let best1: Vec<Option<(usize, Likeness, f32)>> = points1
        .par_iter()
        .enumerate()
        .map_init(Default::default, |(near, correlations): &mut (Vec<usize>, Vec<f32>), (i, point1)| {
            near.clear();
            correlations.clear();
            find(*point1, near);
            let mut best: Option<(usize, Likeness)> = None;
            for j in near.iter() {
                let likeness = likeness(i, *j);
                correlations.push(likeness.correlation);
                if likeness.correlation > best.map_or(LEAST_CORRELATION, |(_, best)| best.correlation) {
                    best = Some((*j, likeness));
                }
            }
            best.map(|(j, likeness)| (j, likeness, prior(j, likeness.correlation, near, correlations)))
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
