//! Matches of many more corners, once the geometry is known to a fraction of a pixel.
//!
//! A narrow band along the lines leaves few places for each corner, so that weak corners can be
//! matched too. The surface around a corner is taken to lie like that of the nearest known match.

use std::collections::HashSet;

use nalgebra::Vector2;
use rayon::prelude::*;

use super::corner_patches::Likeness;
use super::level_corners::mutual_matches;
use super::matches::{LevelMatch, MATCH_SIGMA, RefinedMatch};
use super::near_lines::{Places, is_within};
use crate::geometry::{FundamentalMatrix, Point, PointPair};
use crate::image::{Alignment, HALF, PairLevel, Patch, PatchSampler, Placement, Warp, align, correlation};

/// Corners of each image. With half as many the pose is less precise (`lab/notes.md`); more were not
/// measured.
const CORNERS: usize = 6000;
/// Largest distance of a corner from the line of its partner before alignment, px: both are at whole
/// pixels, and noise moves a corner by about as much again.
const CORNER_ERROR: f64 = 1.5;

/// Corners of a level, found when they are first needed.
#[derive(Debug)]
pub(super) struct DenseCorners {
    corners1: Vec<Point>,
    places2: Places,
    patches2: Vec<Patch>,
}

impl DenseCorners {
    pub fn new(level: &PairLevel) -> Self {
        let corners = |image: usize| level.corners(image, CORNERS, HALF + 1);
        let (corners1, corners2) = rayon::join(|| corners(0), || corners(1));
        let sampler2 = PatchSampler::new(level.planes[1], &Warp::identity());
        let (points2, patches2): (Vec<Point>, Vec<Patch>) =
            corners2.into_iter().filter_map(|p| Some((p, sampler2.patch(p)?))).unzip();
        Self { corners1, places2: Places::new(points2), patches2 }
    }
}

/// Returns `known` with further matches within `band` px of the epipolar lines of `f`, all in
/// pixels of the level.
pub(super) fn densified(
    level: &PairLevel,
    corners: &DenseCorners,
    known: Vec<LevelMatch>,
    f: &FundamentalMatrix,
    band: f64,
) -> Vec<LevelMatch> {
    let DenseCorners { corners1, places2, patches2 } = corners;
    let key = |p: Point| [p.x.to_bits(), p.y.to_bits()];
    let matched: HashSet<[u64; 2]> = known.iter().map(|m| key(m.found.pair.point1)).collect();
    let places: Vec<Vector2<f32>> = known.iter().map(|m| m.found.pair.point1.coords.cast()).collect();
    let (points1, patches1): (Vec<(Point, Warp)>, Vec<Patch>) = corners1
        .par_iter()
        .filter(|p| !matched.contains(&key(**p)))
        .filter_map(|p| {
            let affine = known.get(nearest(&places, *p)?)?.affine;
            let patch = PatchSampler::new(level.planes[0], &affine.try_inverse()?).patch(*p)?;
            Some(((*p, affine), patch))
        })
        .unzip();
    let (points1, affines): (Vec<Point>, Vec<Warp>) = points1.into_iter().unzip();
    let find = places2.mutually_near(f, band.max(CORNER_ERROR));
    let likeness =
        |i: usize, j: usize| Likeness { correlation: correlation(&patches1[i], &patches2[j]), warp: 0 };
    let mutual = mutual_matches([&points1, &places2.points], find, likeness);
    let aligned: Vec<LevelMatch> = mutual
        .par_iter()
        .filter_map(|mutual| {
            let (i, j) = (mutual.alike.corner1 as usize, mutual.alike.corner2 as usize);
            let start = Placement { at: places2.points[j], affine: affines[i] };
            let Placement { at, affine } = align(level.planes, points1[i], start, &Alignment::STRICT)?;
            let found = RefinedMatch {
                pair: PointPair { point1: points1[i], point2: at },
                correlation: mutual.correlation,
            };
            Some(LevelMatch { found, affine, sigma: MATCH_SIGMA, prior: mutual.prior })
        })
        .filter(|m| is_within(f, &m.found.pair, band))
        .collect();
    known.into_iter().chain(aligned).collect()
}

/// Returns the index of the place nearest to a point.
fn nearest(places: &[Vector2<f32>], point: Point) -> Option<usize> {
    let point: Vector2<f32> = point.coords.cast();
    let squared = |place: &Vector2<f32>| (place - point).norm_squared();
    // The minimum alone vectorises.
    let least = places.iter().map(squared).fold(f32::INFINITY, f32::min);
    places.iter().position(|place| squared(place) <= least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::image::PyramidPair;

    #[test]
    fn a_known_geometry_gives_further_matches_to_a_fraction_of_a_pixel() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let pyramids = PyramidPair::new(&plane1, &plane2, 48.0);
        let level = pyramids.level(f64::INFINITY);
        let known: Vec<LevelMatch> = scene
            .pairs(20)
            .into_iter()
            .map(|pair| LevelMatch {
                found: RefinedMatch { pair, correlation: 0.9 },
                affine: Warp::identity(),
                sigma: MATCH_SIGMA,
                prior: 1.0,
            })
            .collect();
        let f = scene.fundamental();
        let corners = DenseCorners::new(&level);
        let found = densified(&level, &corners, known.clone(), &f, 0.5);
        assert_eq!(found[..20], known);
        let further = &found[20..];
        assert!(further.len() > 100, "{}", further.len());
        let mut errors: Vec<f64> = further
            .iter()
            .map(|m| (scene.partner(m.found.pair.point1) - m.found.pair.point2).norm())
            .collect();
        errors.sort_by(f64::total_cmp);
        // Nine of ten are right, to a tenth of a pixel in the middle.
        assert!(errors[errors.len() / 2] < 0.1 && errors[9 * errors.len() / 10] < 1.0, "{errors:?}");
        assert!(further.iter().all(|m| is_within(&f, &m.found.pair, 0.5)));
        assert!(densified(&level, &corners, Vec::new(), &f, 0.5).is_empty(), "no surface to go by");
    }
}
