//! Geometry of point pairs alone, without pictures.
//!
//! [`estimate_points`] fits `F` to matches, many of which may be wrong, and judges it by the matches. With 14
//! agreeing matches or more, the noise is estimated too
//! ([`estimate_fundamental`](crate::estimate::estimate_fundamental)); with fewer, or where no 14 agree, the geometry
//! that chance explains least is taken (`fit/few`). For known cameras, `F` is the fundamental matrix of a relative
//! pose, unless the matches contradict the calibration.
//!
//! Coordinates are pixels. Without the sizes of the images, the extent of the points takes their place: it
//! conditions the equations, and says what is near and what is far. `F` itself does not depend on it.

use std::collections::{HashMap, HashSet};

use nalgebra::Matrix3;
use thiserror::Error;

use super::Warning;
use super::evidence::patches::{RefinedMatch, Refinement};
use super::fit::{EpipoleBearing, MEDIAN, Match, MatchFit, Model, Uncertainty, fit_matches, largest_plane};
use super::verdict::assessment::PointEvidence;
use super::verdict::result::{Assessment, Determined, Estimate};
use crate::geometry::{Frame, FundamentalMatrix, Matrix9, Point, PointPair, Vector, image_in_words};

/// Geometry of point pairs, without pictures.
#[derive(Debug, Clone)]
pub struct PointEstimate {
    /// The geometry with its assessment, in the coordinates of the points. Its matches are those that are
    /// likelier right than wrong.
    pub estimate: Estimate,
    /// Probability that each match is right, 0 to 1, in the order of the matches.
    pub inlier_probabilities: Vec<f64>,
    /// Sizes of the images, as given or as the extent of the points.
    pub frames: [Frame; 2],
    /// Part of the geometry that the matches determine. `None` without a covariance, and if chance explains the
    /// agreement.
    pub determined: Option<Determined>,
    /// Positions of the epipoles, seen from the middle of each image or of the extent of its points.
    pub bearings: Option<[EpipoleBearing; 2]>,
}

/// Reason why points gave no geometry. Matches and images are numbered from 1.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PointsError {
    /// Too few different matches.
    #[error(
        "at least {needed} different matches are needed, and there are {found}. One fewer fits several geometries, and nothing tells which is right. Add matches"
    )]
    TooFew { found: usize, needed: usize },
    /// A match has a coordinate that is NaN or infinite.
    #[error("match {0} has a coordinate that is not a finite number. Leave it out")]
    NotFinite(usize),
    /// The points of an image lie within a few pixels.
    #[error(
        "all points of {side} lie within {extent:.3} px, so F is not determined. If the coordinates are divided by the focal length or the image size, give pixels",
        side = image_in_words(*image)
    )]
    Tiny { image: usize, extent: f64 },
    /// The points of an image lie on one line.
    #[error(
        "the points of {} lie on one line, to within the error of a match, so F is not determined. Add matches beside the line",
        image_in_words(*.0)
    )]
    OneLine(usize),
    /// A point lies outside an image of a given size.
    #[error(
        "match {number} lies outside {side}, which is {width}×{height} px: ({x}, {y}). Check the sizes, and the order of the columns",
        side = image_in_words(*image)
    )]
    Outside { number: usize, image: usize, x: f64, y: f64, width: usize, height: usize },
    /// One homography maps all matches, exactly.
    #[error(
        "all points lie on one plane, or the camera only turned: a homography maps them all, so every epipole fits. Add matches off the plane"
    )]
    OnePlane,
    /// No geometry fits the matches.
    #[error(
        "no epipolar geometry fits enough of the matches. Check that each line has x1 y1 x2 y2 of one scene point"
    )]
    NoGeometry,
}

/// Smallest extent of points in pixels: the smallest image that is accepted. Normalised coordinates lie
/// within 1 or a few.
const LEAST_EXTENT: f64 = 32.0;
/// Distance of points from a line within which they do not show that they are off it, px: the usual error
/// of a match.
const LINE: f64 = 1.0;
/// Distance of a point beyond its image that differences between conventions of pixels explain, px.
const BEYOND: f64 = 1.0;
/// Smallest standard deviation of a match that a test of planes assumes, as a share of the longer side: what
/// the correction of a lens leaves.
const LEAST_SIGMA: f64 = 5e-5;
/// Fewest agreeing matches that show whether points lie on a line: seven, the degrees of freedom of F.
const FREEDOM: usize = 7;

/// Fits a fundamental matrix to matches and judges it, without pictures.
///
/// `frames` are the sizes of the images, if they are known. `calibrations` are the calibration matrices of known
/// cameras, for points without distortion. The same matches and seed give the same result on any number of threads.
/// The verdict is never reliable, since nothing confirms that the points of a match show the same scene point.
///
/// # Errors
/// [`PointsError`] for points that cannot determine a geometry.
pub fn estimate_points(
    matches: &[Match],
    frames: Option<[Frame; 2]>,
    calibrations: Option<[Matrix3<f64>; 2]>,
    seed: u64,
) -> Result<PointEstimate, PointsError> {
    if let Some(wrong) = matches.iter().position(|m| !m.pair.is_finite()) {
        return Err(PointsError::NotFinite(wrong + 1));
    }
    let (distinct, places) = distinct(matches);
    let needed = Model::of(calibrations).unknowns() + 1;
    if distinct.len() < needed {
        return Err(PointsError::TooFew { found: distinct.len(), needed });
    }
    let extent = Extent::of(matches, frames)?;
    let local: Vec<Match> = distinct.iter().map(|m| extent.local(m)).collect();
    let calibrations = calibrations.map(|known| extent.local_calibrations(known));
    let fit = fit_matches(&local, extent.frames, calibrations, seed);
    let fit: MatchFit = fit.map_err(|_| no_geometry(&local, seed))?;
    let agreeing = fit.agreeing(&local);
    for image in 0..2 {
        let points: Vec<Point> = agreeing.iter().map(|pair| of_image(pair, image)).collect();
        if points.len() >= FREEDOM && off_line(&points) < LINE {
            return Err(PointsError::OneLine(image + 1));
        }
    }
    let model = if fit.is_posed { Model::of(calibrations) } else { Model::Free };
    let (trust, margin, plane) = PointEvidence {
        matches: &local,
        agreeing: &agreeing,
        agreement: fit.agreement,
        rival: rival(&local, &agreeing, extent.frames, model, seed),
        fundamental: &fit.fundamental,
        uncertainty: fit.uncertainty.as_ref(),
        calibrations: model.calibrations().copied(),
        sigma: (std::f64::consts::SQRT_2 * fit.noise.scale / MEDIAN)
            .max(LEAST_SIGMA * extent.frames[0].longer_side()),
        frames: extent.frames,
        seed,
    }
    .judge();
    let agreement = fit.agreement;
    let is_chance = !agreement.is_no_chance();
    let refinement = Refinement {
        matches: agreeing.iter().map(|pair| RefinedMatch { pair: *pair, correlation: 0.0 }).collect(),
        uncertainty: fit.uncertainty,
        noise: Some(fit.noise.scale),
        is_posed: fit.is_posed,
    };
    let is_contradicted = calibrations.is_some() && !fit.is_posed;
    let assessment = Assessment {
        refinement: Some(refinement),
        warnings: is_contradicted.then_some(Warning::CalibrationContradicted).into_iter().collect(),
        margin,
        trust: Some(trust),
        plane,
        of_given: true,
        ..Assessment::default()
    };
    let estimate = Estimate { fundamental: fit.fundamental, origin: None, assessment, trace: None };
    Ok(PointEstimate {
        determined: estimate.determined(extent.frames).filter(|_| !is_chance),
        bearings: estimate.epipole_bearings(extent.frames).filter(|_| !is_chance),
        inlier_probabilities: places.iter().map(|k| fit.inlier_probabilities[*k]).collect(),
        frames: extent.frames,
        estimate: extent.back(estimate).ok_or(PointsError::NoGeometry)?,
    })
}

/// Returns the reason why matches gave no geometry: exact matches of a plane leave the equations dependent.
fn no_geometry(matches: &[Match], seed: u64) -> PointsError {
    let pairs: Vec<PointPair> = matches.iter().map(|m| m.pair).collect();
    match largest_plane(&pairs, LINE, seed) {
        Some((_, most)) if most == pairs.len() => PointsError::OnePlane,
        _ => PointsError::NoGeometry,
    }
}

/// Checks that matches lie in images of these sizes.
///
/// # Errors
/// [`PointsError::Outside`] for the first match that does not, beyond differences between conventions of pixels.
pub fn check_inside(matches: &[Match], frames: [Frame; 2]) -> Result<(), PointsError> {
    for (image, frame) in frames.into_iter().enumerate() {
        let is_beyond = |v: f64, last: f64| v < -0.5 - BEYOND || v > last + 0.5 + BEYOND;
        for (k, m) in matches.iter().enumerate() {
            let point = of_image(&m.pair, image);
            if is_beyond(point.x, frame.right()) || is_beyond(point.y, frame.bottom()) {
                let (Point { coords: at, .. }, Frame { width, height }) = (point, frame);
                let (number, image, x, y) = (k + 1, image + 1, at.x, at.y);
                return Err(PointsError::Outside { number, image, x, y, width, height });
            }
        }
    }
    Ok(())
}

/// Returns the number of all matches that agree on another geometry, if those that do not agree on the first one do
/// so beyond chance.
fn rival(
    matches: &[Match],
    agreeing: &[PointPair],
    frames: [Frame; 2],
    model: Model,
    seed: u64,
) -> Option<usize> {
    let agreeing: HashSet<[u64; 4]> = agreeing.iter().map(|pair| pair.numbers().map(f64::to_bits)).collect();
    let is_other = |m: &&Match| !agreeing.contains(&m.pair.numbers().map(f64::to_bits));
    let others: Vec<Match> = matches.iter().filter(is_other).copied().collect();
    let rival = fit_matches(&others, frames, model.calibrations().copied(), seed).ok()?;
    let of_all = || model.agreement(&rival.fundamental, matches, frames).agreeing;
    rival.agreement.is_no_chance().then(of_all)
}

/// Returns the different matches, and the number of each match among them. A repeated match shows no more
/// than one.
fn distinct(matches: &[Match]) -> (Vec<Match>, Vec<usize>) {
    let mut known = HashMap::new();
    let mut distinct = Vec::new();
    let place = |m: &Match| {
        *known.entry(m.pair.numbers().map(f64::to_bits)).or_insert_with(|| {
            distinct.push(*m);
            distinct.len() - 1
        })
    };
    let places = matches.iter().map(place).collect();
    (distinct, places)
}

/// Rectangles of both images in which the points lie.
struct Extent {
    /// Upper left corners in the coordinates of the points; zero for given sizes.
    corners: [Vector; 2],
    frames: [Frame; 2],
}

impl Extent {
    /// Returns the given sizes, or the extent of the points. Fails if the points determine no geometry.
    fn of(matches: &[Match], frames: Option<[Frame; 2]>) -> Result<Self, PointsError> {
        let mut extent = Self { corners: [Vector::zeros(); 2], frames: [Frame::new(1, 1); 2] };
        for image in 0..2 {
            let points: Vec<Point> = matches.iter().map(|m| of_image(&m.pair, image)).collect();
            let range = |of: fn(&Point) -> f64| {
                let values = points.iter().map(of);
                values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
            };
            let [x, y] = [range(|p| p.x), range(|p| p.y)];
            let longer = (x[1] - x[0]).max(y[1] - y[0]);
            if longer < LEAST_EXTENT {
                return Err(PointsError::Tiny { image: image + 1, extent: longer });
            }
            if off_line(&points) < LINE {
                return Err(PointsError::OneLine(image + 1));
            }
            if let Some(frames) = frames {
                extent.frames[image] = frames[image];
            } else {
                extent.corners[image] = Vector::new(x[0].floor(), y[0].floor());
                let side = |[low, high]: [f64; 2]| (high - low.floor()).ceil().max(LEAST_EXTENT) as usize + 1;
                extent.frames[image] = Frame::new(side(x), side(y));
            }
        }
        Ok(extent)
    }

    fn local(&self, m: &Match) -> Match {
        let PointPair { point1, point2 } = m.pair;
        let pair = PointPair { point1: point1 - self.corners[0], point2: point2 - self.corners[1] };
        Match { pair, ..*m }
    }

    /// Returns calibration matrices for the coordinates of the rectangles.
    fn local_calibrations(&self, calibrations: [Matrix3<f64>; 2]) -> [Matrix3<f64>; 2] {
        [0, 1].map(|k| shifted(-self.corners[k]) * calibrations[k])
    }

    /// Returns a geometry of the rectangles in the coordinates of the points.
    fn back(&self, mut local: Estimate) -> Option<Estimate> {
        let [to1, to2] = self.corners.map(|corner| shifted(-corner));
        let moved = to2.transpose() * local.fundamental.matrix() * to1;
        let fundamental = FundamentalMatrix::from_rank_two(moved)?;
        if let Some(refinement) = &mut local.assessment.refinement {
            let by_entries =
                Matrix9::from_fn(|to, from| to2[(from / 3, to / 3)] * to1[(from % 3, to % 3)] / moved.norm());
            let moved = |u: &Uncertainty| by_entries * u.covariance() * by_entries.transpose();
            refinement.uncertainty =
                refinement.uncertainty.as_ref().map(|u| Uncertainty::new(&fundamental, &moved(u), [1.0; 2]));
            for found in &mut refinement.matches {
                let PointPair { point1, point2 } = found.pair;
                found.pair = PointPair { point1: point1 + self.corners[0], point2: point2 + self.corners[1] };
            }
        }
        if let Some(plane) = &mut local.assessment.plane {
            let h = shifted(self.corners[1]) * plane.homography21 * to1;
            let divisor = if h[(2, 2)].abs() > 1e-9 * h.norm() { h[(2, 2)] } else { h.norm() };
            plane.homography21 = h / divisor;
        }
        Some(Estimate { fundamental, ..local })
    }
}

/// Returns the matrix that moves points by a vector.
fn shifted(by: Vector) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, by.x, 0.0, 1.0, by.y, 0.0, 0.0, 1.0)
}

/// Returns the point of a pair in image 0 or 1.
fn of_image(pair: &PointPair, image: usize) -> Point {
    if image == 0 { pair.point1 } else { pair.point2 }
}

/// Returns the root mean square distance of points from their best line, px.
fn off_line(points: &[Point]) -> f64 {
    let count = points.len().max(1) as f64;
    let middle = points.iter().map(|p| p.coords).sum::<Vector>() / count;
    let spread: nalgebra::Matrix2<f64> =
        points.iter().map(|p| (p.coords - middle) * (p.coords - middle).transpose()).sum();
    (spread.symmetric_eigenvalues().min().max(0.0) / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::estimate::{Reason, Verdict};
    use crate::geometry::random_scene::RandomScene;
    use crate::geometry::sampson_distance;

    fn noisy(pairs: &[PointPair], sigma: f64, seed: u64) -> Vec<Match> {
        RandomScene::new(seed).disturbed(pairs, sigma).into_iter().map(Match::from).collect()
    }

    fn reasons(found: &PointEstimate) -> &[Reason] {
        &found.estimate.assessment.trust.as_ref().unwrap().reasons
    }

    #[test]
    fn many_points_give_the_geometry_and_the_limits_of_the_claim() {
        let scene = ExactScene::aside();
        let matches = noisy(&scene.pairs(200), 0.2, 3);
        for frames in [None, Some([FRAME; 2])] {
            let found = estimate_points(&matches, frames, None, 0).unwrap();
            assert!(scene.error(&found.estimate.fundamental) < 0.5);
            assert!(matches!(reasons(&found)[0], Reason::PointsAlone { matches: 200, .. }), "{found:?}");
            assert_eq!(found.estimate.assessment.trust.as_ref().unwrap().verdict, Verdict::Doubtful);
            assert_eq!(found.inlier_probabilities.len(), 200);
            assert!(found.determined.is_some());
        }
    }

    #[test]
    fn the_origin_of_the_points_changes_nothing() {
        let scene = ExactScene::aside();
        let matches = noisy(&scene.pairs(60), 0.1, 3);
        let far = |m: &Match| Match {
            pair: PointPair {
                point1: m.pair.point1 + Vector::new(3000.0, -200.0),
                point2: m.pair.point2 + Vector::new(-40.0, 900.0),
            },
            ..*m
        };
        let there: Vec<Match> = matches.iter().map(far).collect();
        let [here, there_found] = [&matches, &there].map(|all| estimate_points(all, None, None, 0).unwrap());
        for (a, b) in matches.iter().zip(&there) {
            let [near, shifted] = [(&here, a), (&there_found, b)].map(|(found, m)| {
                let u = found.estimate.uncertainty().unwrap();
                let deviation = u.line2_deviation(m.pair.point1, m.pair.point2).unwrap();
                (sampson_distance(&found.estimate.fundamental, &m.pair), deviation)
            });
            assert!(
                (near.0 - shifted.0).abs() < 1e-5 && (near.1 / shifted.1 - 1.0).abs() < 1e-3,
                "{near:?} {shifted:?}"
            );
        }
    }

    #[test]
    fn points_that_determine_no_geometry_are_told() {
        let scene = ExactScene::aside();
        let all: Vec<Match> = scene.pairs(20).into_iter().map(Match::from).collect();
        let error = |matches: &[Match]| estimate_points(matches, None, None, 0).unwrap_err();
        assert_eq!(error(&all[..7]), PointsError::TooFew { found: 7, needed: 8 });
        assert_eq!(error(&[all[0]; 30]), PointsError::TooFew { found: 1, needed: 8 });
        let mut broken = all.clone();
        broken[4].pair.point2.y = f64::NAN;
        assert_eq!(error(&broken), PointsError::NotFinite(5));
        let on_line: Vec<Match> = (0..20)
            .map(|k| {
                let x = 20.0 * f64::from(k);
                PointPair { point2: all[k as usize].pair.point2, ..PointPair::new(x, 0.5 * x, 0.0, 0.0) }
                    .into()
            })
            .collect();
        assert_eq!(error(&on_line), PointsError::OneLine(1));
        let small = |m: &Match| {
            let PointPair { point1, point2 } = m.pair;
            Match { pair: PointPair { point1: point1 / 500.0, point2: point2 / 500.0 }, ..*m }
        };
        assert!(matches!(
            error(&all.iter().map(small).collect::<Vec<_>>()),
            PointsError::Tiny { image: 1, .. }
        ));
        assert_eq!(check_inside(&all, [FRAME; 2]), Ok(()));
        let outside = check_inside(&all, [Frame::new(100, 100), FRAME]).unwrap_err();
        assert!(matches!(outside, PointsError::Outside { image: 1, .. }), "{outside}");
    }

    #[test]
    fn points_on_a_plane_leave_the_epipole_open() {
        let plane = RandomScene::new(4).planar_pairs(40);
        let exact: Vec<Match> = plane.iter().map(|pair| Match::from(*pair)).collect();
        if let Err(error) = estimate_points(&exact, None, None, 0) {
            assert_eq!(error, PointsError::OnePlane);
        }
        for (count, sigma) in [(11, 0.1), (40, 0.1)] {
            let found = estimate_points(&noisy(&plane[..count], sigma, 2), None, None, 0).unwrap();
            assert!(found.estimate.says_one_plane(), "{count} {sigma}: {:?}", reasons(&found));
            let plane = found.estimate.assessment.plane.unwrap();
            assert!(plane.residual < 1.0, "{plane:?}");
        }
    }

    #[test]
    fn wrong_matches_are_unreliable() {
        let mut random = RandomScene::new(9);
        let points = random.pairs(120);
        let wrong =
            points.chunks_exact(2).map(|two| PointPair { point1: two[0].point1, point2: two[1].point2 });
        for count in [9, 11, 20, 60] {
            let some: Vec<Match> = wrong.clone().take(count).map(Match::from).collect();
            let found = estimate_points(&some, None, None, 0).unwrap();
            assert_eq!(
                found.estimate.assessment.trust.as_ref().unwrap().verdict,
                Verdict::Unreliable,
                "{count}"
            );
            assert!(matches!(reasons(&found)[0], Reason::PointsByChance { .. }));
        }
    }

    #[test]
    fn two_motions_are_ambiguous() {
        let [one, other] = [ExactScene::aside(), ExactScene::moved([0.3, 0.02, 0.3])];
        let mut all = noisy(&one.pairs(60), 0.1, 1);
        all.extend(noisy(&other.pairs(55), 0.1, 2));
        let found = estimate_points(&all, None, None, 0).unwrap();
        assert!(
            reasons(&found).iter().any(|r| matches!(r, Reason::Ambiguous { .. })),
            "{:?}",
            reasons(&found)
        );
    }

    #[test]
    fn known_cameras_give_a_pose_where_a_plane_leaves_the_fundamental_matrix_open() {
        let k = Matrix3::new(800.0, 0.0, 383.5, 0.0, 800.0, 287.5, 0.0, 0.0, 1.0);
        let frames = Some([Frame::new(768, 576); 2]);
        let mut right = 0;
        for seed in 0..10 {
            let mut scene = RandomScene::new(seed);
            let mut all = scene.planar_pairs(12);
            let others = scene.pairs(12);
            all.extend(&others[..3]);
            let found = estimate_points(&noisy(&all, 0.2, seed), frames, Some([k; 2]), 0).unwrap();
            assert!(found.estimate.assessment.refinement.as_ref().unwrap().is_posed);
            let off = others.iter().map(|pair| sampson_distance(&found.estimate.fundamental, pair));
            right += usize::from(crate::geometry::median(off) < 2.0);
        }
        assert!(right >= 9, "{right} of 10");
    }

    #[test]
    fn a_wrong_focal_length_leaves_the_geometry_of_the_points() {
        let scene = ExactScene::aside();
        let matches = noisy(&scene.pairs(200), 0.1, 3);
        let k = |focal: f64| Matrix3::new(focal, 0.0, 159.5, 0.0, focal, 119.5, 0.0, 0.0, 1.0);
        let found = |known| estimate_points(&matches, Some([FRAME; 2]), known, 0).unwrap();
        let wrong = found(Some([k(300.0), k(900.0)]));
        assert_eq!(wrong.estimate.assessment.warnings, [Warning::CalibrationContradicted]);
        assert!(!wrong.estimate.assessment.refinement.as_ref().unwrap().is_posed);
        assert_eq!(wrong.estimate.fundamental, found(None).estimate.fundamental);
    }

    #[test]
    fn six_points_of_known_cameras_are_enough() {
        let k = Matrix3::new(800.0, 0.0, 383.5, 0.0, 800.0, 287.5, 0.0, 0.0, 1.0);
        let frames = Some([Frame::new(768, 576); 2]);
        let pairs = RandomScene::new(5).pairs(30);
        let six = noisy(&pairs[..6], 0.1, 1);
        let found = estimate_points(&six, frames, Some([k; 2]), 0).unwrap();
        let off = pairs.iter().map(|pair| sampson_distance(&found.estimate.fundamental, pair));
        assert!(crate::geometry::median(off) < 3.0);
        let error = estimate_points(&six[..5], frames, Some([k; 2]), 0).unwrap_err();
        assert_eq!(error, PointsError::TooFew { found: 5, needed: 6 });
    }
}
