//! Refinement of all seven degrees of freedom at full resolution, on patches matched along the epipolar lines.
//!
//! With `F` known to a few pixels, each corner of image 1 is compared only with the corners of image 2 near its
//! epipolar line. Mutual best matches are moved to sub-pixel positions, `F` is refitted to them with a robust
//! cost, and the same again with a narrower band. The clicks take part with their own uncertainty.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use rayon::prelude::*;
use serde::Serialize;

use super::support::FLOOR;
use crate::estimate::{Monitor, Refinement, Uncertainty};
use crate::geometry::{FundamentalMatrix, Observation, Point, PointPair, fit_fundamental, sampson_distance};
use crate::image::{HALF, PairLevel, Patch, Warp, align, correlate_all, find_corners, patch, warps};

/// A match found along the epipolar lines, full-size pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RefinedMatch {
    /// Where it is, image 2 to a fraction of a pixel.
    pub pair: PointPair,
    /// Correlation of its patches, −1 to 1.
    pub correlation: f32,
}

/// Corners and patches of one level, computed once per image pair.
#[derive(Debug, Default)]
pub(in crate::estimate) struct RefinementLevel {
    features: OnceLock<[Vec<Feature>; 2]>,
    /// Where in image 2 the surroundings of a corner of image 1 fit best, starting at a corner of image 2 under a
    /// warp: the same whatever `F`, and most matches of one refinement are those of the next.
    aligned: Mutex<HashMap<Alike, Option<Point>>>,
}

/// Two features, by their numbers, and the warp under which they look alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Alike {
    feature1: u32,
    feature2: u32,
    warp: u8,
}

/// A corner with its patch under each warp: one in image 1, all of them in image 2.
#[derive(Debug, Clone)]
struct Feature {
    point: Point,
    patches: Vec<Patch>,
    warps: Vec<Warp>,
}

/// Corners an image.
const CORNERS: usize = 1500;
/// Patches that correlate less than this are no match.
const LEAST_CORRELATION: f32 = 0.75;
/// Widths of the band, px of the level, one round each.
const BANDS: [f64; 3] = [4.0, 2.0, 1.2];
/// Standard deviation of a refined match, px of the level.
const MATCH_SIGMA: f64 = 0.3;
/// Standard deviations of a match that its band is wide: a match beyond one of them loses influence in the fit.
const BAND_DEVIATIONS: f64 = 3.0;
/// The same at least, in standard deviations of a match: nearer ones are as good as any.
const LEAST_SCALE: f64 = 1.5;
/// Fewer matches than this determine nothing.
const LEAST_MATCHES: usize = 16;

/// What a refinement found.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Refined {
    pub fundamental: FundamentalMatrix,
    pub refinement: Refinement,
    /// How much speaks for it: summed over the matches, correlation excess times how well the match fits
    /// (1 on the epipolar line, ½ at the deviation of a match, falling with the square of the distance). Of
    /// several refinements the one with most of it is the right one, on nearly every pair measured.
    pub weight: f64,
}

impl RefinementLevel {
    fn features(&self, level: &PairLevel) -> &[Vec<Feature>; 2] {
        self.features.get_or_init(|| {
            let of = |image: usize| -> Vec<Feature> {
                let tried = if image == 0 { vec![Warp::identity()] } else { warps() };
                find_corners(level.planes[image], CORNERS, HALF + 2)
                    .into_par_iter()
                    .filter_map(|point| {
                        let (patches, warps): (Vec<Patch>, Vec<Warp>) = tried
                            .iter()
                            .filter_map(|warp| Some((patch(level.planes[image], point, warp)?, *warp)))
                            .unzip();
                        (!patches.is_empty()).then_some(Feature { point, patches, warps })
                    })
                    .collect()
            };
            let (a, b) = rayon::join(|| of(0), || of(1));
            [a, b]
        })
    }

    /// Refines `f` (full size) at this level; `None` when too few matches support it there. `click_sigma` is in
    /// full-size pixels.
    pub fn refine(
        &self,
        level: &PairLevel,
        f: &FundamentalMatrix,
        clicks: &[PointPair],
        click_sigma: f64,
        monitor: &Monitor,
    ) -> Option<Refined> {
        let [s1, s2] = level.scales;
        let mut current = f.rescaled(s1, s2)?;
        let mut matches = Vec::new();
        let mut covariance = None;
        for band in BANDS {
            if monitor.is_cancelled() {
                return None;
            }
            matches = self.guided_matches(level, &current, band);
            if matches.len() < LEAST_MATCHES {
                return None;
            }
            let observations: Vec<Observation> = matches
                .iter()
                .map(|m| Observation { pair: m.pair, sigma: MATCH_SIGMA })
                .chain(clicks.iter().map(|c| Observation {
                    pair: level.resized(c),
                    // Never below the level's own precision.
                    sigma: (click_sigma * s1).max(MATCH_SIGMA),
                }))
                .collect();
            let scale = (band / BAND_DEVIATIONS / MATCH_SIGMA).max(LEAST_SCALE);
            let fitted = fit_fundamental(&current, &observations, scale)?;
            (current, covariance) = (fitted.fundamental, fitted.covariance);
        }
        matches.retain(|m| sampson_distance(&current, &m.pair) < BANDS[BANDS.len() - 1]);
        let fits =
            |m: &RefinedMatch| 1.0 / (1.0 + (sampson_distance(&current, &m.pair) / MATCH_SIGMA).powi(2));
        let weight = matches.iter().map(|m| f64::from(m.correlation - FLOOR) * fits(m)).sum();
        for m in &mut matches {
            m.pair = m.pair.rescaled([1.0 / s1, 1.0 / s2]);
        }
        Some(Refined {
            fundamental: current.rescaled(1.0 / s1, 1.0 / s2)?,
            refinement: Refinement {
                uncertainty: covariance.map(|c| Uncertainty::new(&current, &c, level.scales)),
                matches,
            },
            weight,
        })
    }

    /// Mutual best matches among corners within `band` px of each other's epipolar lines, sub-pixel positions
    /// in image 2; all in the level's pixels.
    fn guided_matches(&self, level: &PairLevel, f: &FundamentalMatrix, band: f64) -> Vec<RefinedMatch> {
        let [features1, features2] = self.features(level);
        let lines1: Vec<_> = features2.iter().map(|b| f.line1_from_point2(b.point)).collect();
        // Best partner of each corner of image 1 with its warp, then of each corner of image 2.
        let best1: Vec<Option<(usize, usize, f32)>> = features1
            .par_iter()
            .map_init(Vec::new, |correlations, a| {
                let line2 = f.line2_from_point1(a.point)?;
                let mut best = None;
                for (j, b) in features2.iter().enumerate() {
                    if line2.distance(b.point) > band
                        || lines1[j].is_none_or(|line1| line1.distance(a.point) > band)
                    {
                        continue;
                    }
                    correlate_all(&a.patches, &b.patches, correlations);
                    for (warp, correlation) in correlations.iter().enumerate() {
                        if *correlation > best.map_or(LEAST_CORRELATION, |(_, _, c)| c) {
                            best = Some((j, warp, *correlation));
                        }
                    }
                }
                best
            })
            .collect();
        let mut best2: Vec<Option<(usize, usize, f32)>> = vec![None; features2.len()];
        for (i, best) in best1.iter().enumerate() {
            if let Some((j, warp, correlation)) = best
                && best2[*j].is_none_or(|(_, _, c)| *correlation > c)
            {
                best2[*j] = Some((i, *warp, *correlation));
            }
        }
        let mutual: Vec<(Alike, f32)> = best2
            .iter()
            .enumerate()
            .filter_map(|(j, best)| {
                let (i, warp, correlation) = (*best)?;
                Some((Alike { feature1: i as u32, feature2: j as u32, warp: warp as u8 }, correlation))
            })
            .collect();
        let positions = self.positions(level, &mutual);
        mutual
            .iter()
            .zip(positions)
            .filter_map(|((alike, correlation), point2)| {
                let point1 = features1[alike.feature1 as usize].point;
                Some(RefinedMatch { pair: PointPair { point1, point2: point2? }, correlation: *correlation })
            })
            .collect()
    }

    /// Sub-pixel positions in image 2, those not known yet computed in parallel; `None` where the surroundings do
    /// not fit after all.
    fn positions(&self, level: &PairLevel, mutual: &[(Alike, f32)]) -> Vec<Option<Point>> {
        let [features1, features2] = self.features(level);
        let known = |alike: &Alike| self.known().get(alike).copied();
        let fresh: Vec<(Alike, Option<Point>)> = mutual
            .iter()
            .filter(|(alike, _)| known(alike).is_none())
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|(alike, _)| {
                let a = &features1[alike.feature1 as usize];
                let b = &features2[alike.feature2 as usize];
                let found = align(level.planes, a.point, b.point, &b.warps[alike.warp as usize]);
                (*alike, found.map(|(point2, _)| point2))
            })
            .collect();
        let mut known = self.known();
        known.extend(fresh);
        mutual.iter().map(|(alike, _)| known.get(alike).copied().flatten()).collect()
    }

    fn known(&self) -> MutexGuard<'_, HashMap<Alike, Option<Point>>> {
        // Entries are whole whatever happened to a thread that held the lock.
        self.aligned.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
