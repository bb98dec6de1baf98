//! New hypotheses from the matches that support the best ones so far.
//!
//! A geometry that fits a dominant plane and a few chance matches has almost as much support as the
//! right one, and refitting to its own matches does not change it. Two kinds of samples lead to
//! other geometries:
//!
//! - **small samples** of the pooled matches of the best hypotheses, together with the clicks,
//!   solved by the eight-point algorithm;
//! - **plane and parallax** (Hartley & Zisserman, section 13.3; Chum, Werner & Matas 2005). Given
//!   the homography `H` of the largest plane, every point off the plane gives a line through the
//!   epipole of image 2, `Hx1 × x2`. Two such points determine `F = [e2]× H`.

use std::collections::HashSet;

use nalgebra::{Matrix3, Vector3};
use rand::{Rng, RngExt};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::Proposal;
use super::support::{BAND, DISTINCTIVE, PatchSupport, Support};
use crate::cancel::CancelFlag;
use crate::estimate::fit::largest_plane;
use crate::estimate::sampling::{Draws, Purpose};
use crate::estimate::{EstimateError, Origin, PatchParameters, Resampling};
use crate::geometry::{FundamentalMatrix, PointPair, eight_point, transfer_error};

/// Width of the band of the pool, px: four times the band of support, to include matches slightly
/// off.
const POOL_BAND: f64 = 4.0 * BAND;
/// Number of matches drawn into a sample: with two clicks, the eight of the eight-point algorithm.
const DRAWN: usize = 6;
/// Number of best hypotheses whose largest plane is examined. Each takes another set of samples.
const PLANES: usize = 3;
/// Distance within which a match lies on a plane, px of the level. Corners are found to a pixel in
/// each image.
const ON_PLANE: f64 = 2.0;
/// Distance beyond which a match lies off a plane, px of the level. Twice and more of [`ON_PLANE`],
/// so that errors of corners do not count as parallax.
const OFF_PLANE: f64 = 5.0;
/// Share of the leader's support from which a sample is kept, since polishing adds support. A
/// smaller share measures more samples, a larger one drops some that polishing would raise.
const PROMISING: f64 = 0.4;

/// Settings of one round of samples.
pub(in crate::estimate) struct Drawing<'a> {
    /// Clicks in pixels of the level.
    pub clicks: &'a [PointPair],
    /// Rounds, planes and numbers of samples.
    pub parameters: PatchParameters,
    pub seed: u64,
}

/// Returns the best `count` hypotheses from small samples and from planes, best first, in pixels of
/// the level of `support`.
pub(in crate::estimate) fn resample(
    support: &Support,
    best: &[Proposal],
    count: usize,
    drawing: &Drawing,
    cancel: &CancelFlag,
) -> Result<Vec<Proposal>, EstimateError> {
    let Some(leader) = best.first() else { return Ok(Vec::new()) };
    let Drawing { clicks, parameters, seed } = *drawing;
    let least = PROMISING * leader.support.score;
    // Most samples are wrong, which an upper bound on their support shows.
    let promising = |fundamental: FundamentalMatrix, origin: Origin| {
        let most = support.most(&fundamental);
        (most > least).then_some(Sampled { fundamental, origin, most })
    };
    let draw =
        |kind: u64, origin: Origin, make: &(dyn Fn(&mut Pcg64Mcg) -> Option<FundamentalMatrix> + Sync)| {
            let count = parameters.samples;
            let first = kind * count as u64;
            let draws = Draws { seed, purpose: Purpose::PatchSamples, first, count, task: 1 };
            draws.collect(|rng| if cancel.is_cancelled() { None } else { promising(make(rng)?, origin) })
        };
    let mut found = Vec::new();
    let pool = pooled(support, &best[..best.len().min(parameters.pooled)]);
    // Clicks on corners may be in the pool, too. A sample takes each pair once.
    let others = pool.iter().filter(|pair| !clicks.contains(pair)).count();
    if pool.len() >= 2 * DRAWN && others >= DRAWN {
        found.extend(draw(0, leader.origin.then(Resampling::SupportingMatches), &|rng| {
            sample(&pool, clicks, rng)
        }));
    }
    for (k, hypothesis) in best.iter().take(if parameters.parallax { PLANES } else { 0 }).enumerate() {
        let matches: Vec<PointPair> =
            support.matches(&hypothesis.fundamental, BAND).iter().map(|m| m.pair).collect();
        if let Some((h, _)) = largest_plane(&matches, ON_PLANE, seed) {
            let parallax = Parallax::new(support, h, clicks);
            found.extend(draw(1 + k as u64, hypothesis.origin.then(Resampling::Parallax), &|rng| {
                parallax.sample(rng)
            }));
        }
    }
    cancel.check()?;
    Ok(best_of(&found, support, leader, count))
}

/// A geometry from a sample, and a bound on the score of its support.
struct Sampled {
    fundamental: FundamentalMatrix,
    origin: Origin,
    most: f64,
}

/// Number of samples measured at once, for each one wanted. The search ends when a batch brings
/// nothing better, so small batches may end it too early.
const AT_ONCE: usize = 4;

/// Returns the `count` best of the promising samples, best first. Of equals, the first drawn wins.
///
/// Samples are measured in the order of their bounds. The search ends when no bound reaches the
/// kept samples. It also ends when a batch of four times `count` brings no better sample, since a
/// right geometry has hundreds of similar samples.
fn best_of(samples: &[Sampled], support: &Support, leader: &Proposal, count: usize) -> Vec<Proposal> {
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by(|a, b| samples[*b].most.total_cmp(&samples[*a].most));
    let mut best: Vec<(usize, PatchSupport)> = Vec::new();
    for few in order.chunks(AT_ONCE.saturating_mul(count).max(1)) {
        let is_full = best.len() >= count;
        if is_full && best.last().is_none_or(|(_, last)| last.score > samples[few[0]].most) {
            break;
        }
        let measured: Vec<(usize, PatchSupport)> =
            few.par_iter().map(|k| (*k, support.measure(&samples[*k].fundamental))).collect();
        let last = best.last().map_or(0.0, |(_, last)| last.score);
        let least = if is_full { last } else { PROMISING * leader.support.score };
        let before = best.len();
        best.extend(measured.into_iter().filter(|(_, own)| own.score > least));
        if is_full && best.len() == before {
            break;
        }
        best.sort_by(|(a, of_a), (b, of_b)| of_b.score.total_cmp(&of_a.score).then(a.cmp(b)));
        best.truncate(count);
    }
    let proposal = |(k, support): (usize, PatchSupport)| Proposal {
        origin: samples[k].origin,
        fundamental: samples[k].fundamental,
        support,
        angles: leader.angles,
    };
    best.into_iter().map(proposal).collect()
}

/// Returns the matches of the best hypotheses, each once.
fn pooled(support: &Support, best: &[Proposal]) -> Vec<PointPair> {
    let mut known: HashSet<[u64; 4]> = HashSet::new();
    let matches = best.iter().flat_map(|own| support.matches(&own.fundamental, POOL_BAND));
    let pairs = matches.map(|m| m.pair);
    pairs.filter(|pair| known.insert(pair.numbers().map(f64::to_bits))).collect()
}

fn sample(pool: &[PointPair], clicks: &[PointPair], rng: &mut impl Rng) -> Option<FundamentalMatrix> {
    let mut sample: Vec<PointPair> = clicks.to_vec();
    while sample.len() < DRAWN + clicks.len() {
        let pair = pool[rng.random_range(0..pool.len())];
        if !sample.contains(&pair) {
            sample.push(pair);
        }
    }
    eight_point(&sample).ok()
}

/// A plane, and the lines that matches off the plane give.
struct Parallax {
    homography: Matrix3<f64>,
    /// Lines of image 2 of the look-alikes; a right match's line passes through the epipole.
    lines: Vec<Vector3<f64>>,
    /// Lines of image 2 of the clicks.
    clicks: Vec<Vector3<f64>>,
}

impl Parallax {
    fn new(support: &Support, homography: Matrix3<f64>, clicks: &[PointPair]) -> Self {
        let mut matches: Vec<PointPair> = Vec::new();
        for group in support.pairs.chunk_by(|a, b| a.corner1 == b.corner1) {
            // A corner counts as on the plane if any look-alike lies at its mapped place.
            let off = group.iter().all(|m| transfer_error(&homography, &support.pair(m)) > OFF_PLANE);
            // The best look-alike of a corner comes first.
            if let Some(first) = group.first().filter(|m| off && m.correlation > DISTINCTIVE) {
                matches.push(support.pair(first));
            }
        }
        let clicks: Vec<PointPair> =
            clicks.iter().filter(|c| transfer_error(&homography, c) > OFF_PLANE).copied().collect();
        Self::of_matches(homography, &matches, &clicks)
    }

    /// Returns the plane with the lines of matches and clicks off it.
    fn of_matches(homography: Matrix3<f64>, matches: &[PointPair], clicks: &[PointPair]) -> Self {
        let line = |m: &PointPair| {
            (homography * m.point1.to_homogeneous()).cross(&m.point2.to_homogeneous()).normalize()
        };
        Self {
            homography,
            lines: matches.iter().map(line).collect(),
            clicks: clicks.iter().map(line).collect(),
        }
    }

    /// Returns `F` of two lines. In half of the samples, one line belongs to a click, if one is off
    /// the plane.
    fn sample(&self, rng: &mut impl Rng) -> Option<FundamentalMatrix> {
        let from = |list: &[Vector3<f64>], rng: &mut dyn FnMut(usize) -> usize| {
            (!list.is_empty()).then(|| list[rng(list.len())])
        };
        let mut below = |n: usize| rng.random_range(0..n);
        let first = if below(2) == 0 { from(&self.clicks, &mut below) } else { None };
        let first = first.or_else(|| from(&self.lines, &mut below))?;
        let epipole2 = first.cross(&from(&self.lines, &mut below)?);
        FundamentalMatrix::from_rank_two(epipole2.try_normalize(1e-9)?.cross_matrix() * self.homography)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::estimate::ProposedBy;
    use crate::estimate::exact::ExactScene;
    use crate::geometry::random_scene::example_seen;
    use crate::geometry::{homography, symmetric_epipolar_distance};

    /// Returns the match of the scene point (k, l) at a depth.
    fn seen(k: u32, l: u32, depth: f64) -> PointPair {
        example_seen(f64::from(k) * 0.4 - 1.2, f64::from(l) * 0.3 - 0.8, depth)
    }

    #[test]
    fn a_plane_and_two_matches_off_it_determine_the_geometry() {
        let wall: Vec<PointPair> = (0..36).map(|k| seen(k % 6, k / 6, 6.0)).collect();
        let (homography, on_wall) = largest_plane(&wall, 0.1, 0).unwrap();
        assert_eq!(on_wall, wall.len());
        let (one, other) = (seen(1, 4, 4.0), seen(5, 2, 4.5));
        assert!(transfer_error(&homography, &one) > OFF_PLANE);
        // A sample with one match twice gives nothing; all others give the geometry.
        for clicks in [&[][..], &[other][..]] {
            let parallax = Parallax::of_matches(homography, &[one, other], clicks);
            let mut rng = Pcg64Mcg::seed_from_u64(3);
            let found: Vec<_> = (0..20).filter_map(|_| parallax.sample(&mut rng)).collect();
            assert!((3..20).contains(&found.len()), "{}", found.len());
            for f in found {
                for probe in [seen(3, 3, 3.5), seen(0, 5, 9.0), wall[17]] {
                    assert!(symmetric_epipolar_distance(&f, &probe) < 1e-4);
                }
            }
        }
    }

    #[test]
    fn without_matches_off_the_plane_there_is_nothing_to_draw() {
        let parallax = Parallax::of_matches(Matrix3::identity(), &[], &[]);
        assert!(parallax.sample(&mut Pcg64Mcg::seed_from_u64(0)).is_none());
    }

    /// Returns a scene that is mostly one wall, with matches off the wall, and a geometry that fits
    /// the wall alone.
    fn trap() -> (ExactScene, Support, Proposal) {
        let scene = ExactScene::aside();
        let wall: Vec<PointPair> = (0..60)
            .map(|k| {
                let (x, y) = (f64::from(k % 10) * 0.3 - 1.4, f64::from(k / 10) * 0.35 - 0.9);
                scene.seen(x, y, 6.0 + 0.1 * x)
            })
            .collect();
        let off = (0..16).map(|k| {
            let (x, y) = (f64::from(k % 4) * 0.5 - 0.7, f64::from(k / 4) * 0.4 - 0.5);
            scene.seen(x, y, 4.0 + 0.05 * f64::from(k))
        });
        let all: Vec<_> = wall.iter().copied().chain(off).map(|pair| (pair, 0.9)).collect();
        let support = Support::of_matches(&all);
        // Every epipole fits a plane, so any one serves.
        let h = homography(&wall).unwrap();
        let f = Vector3::new(100.0, -700.0, 1.0).cross_matrix() * h;
        let fundamental = FundamentalMatrix::from_rank_two(f).unwrap();
        let leader = Proposal {
            origin: ProposedBy::Features.into(),
            angles: None,
            support: support.measure(&fundamental),
            fundamental,
        };
        assert!((60..68).contains(&leader.support.matches), "{}", leader.support.matches);
        (scene, support, leader)
    }

    const ON_MATCHES: PatchParameters =
        PatchParameters { resampling: 5, parallax: false, supported: 240, pooled: 6, samples: 1500 };

    fn drawn(support: &Support, leader: &Proposal, drawing: &Drawing) -> Vec<Proposal> {
        resample(support, std::slice::from_ref(leader), usize::MAX, drawing, &CancelFlag::default()).unwrap()
    }

    #[test]
    fn plane_and_parallax_lead_out_of_a_trap() {
        let (scene, support, leader) = trap();
        let clicks = scene.clicks();
        let all = Drawing { clicks: &clicks, parameters: PatchParameters::default(), seed: 1 };
        let found = drawn(&support, &leader, &all);
        assert!(found.is_sorted_by(|a, b| a.support.score >= b.support.score));
        assert!(found.iter().all(|f| f.support.score > PROMISING * leader.support.score));
        assert_eq!(found[0].support.matches, 76);
        // The matches are exact, but the plane is fitted.
        assert!(scene.error(&found[0].fundamental) < 0.5, "{}", scene.error(&found[0].fundamental));
        let without = drawn(&support, &leader, &Drawing { parameters: ON_MATCHES, ..all });
        let right = |list: &[Proposal]| list.iter().filter(|f| scene.error(&f.fundamental) < 0.5).count();
        assert!(right(&found) > 2 * right(&without).max(50), "{} {}", right(&found), right(&without));
    }

    #[test]
    fn small_samples_of_the_pool_use_the_clicks() {
        let scene = ExactScene::aside();
        let matches: Vec<_> = scene.pairs(40).into_iter().map(|pair| (pair, 0.9)).collect();
        let support = Support::of_matches(&matches);
        let fundamental = scene.disturbed(1.5);
        let leader = Proposal {
            origin: ProposedBy::Features.into(),
            angles: Some(scene.angles()),
            support: support.measure(&fundamental),
            fundamental,
        };
        let clicks = scene.clicks();
        let found = drawn(&support, &leader, &Drawing { clicks: &clicks, parameters: ON_MATCHES, seed: 2 });
        // Exact matches: every sample that determines a matrix gives the true one.
        assert!(found.len() > ON_MATCHES.samples / 2 && scene.error(&found[0].fundamental) < 1e-4);
        let pool = pooled(&support, &[leader.clone(), leader]);
        assert!(pool.len() <= 40 && pool.iter().enumerate().all(|(k, m)| !pool[..k].contains(m)));
    }

    #[test]
    fn clicks_on_the_matches_of_the_pool_leave_nothing_to_draw() {
        let scene = ExactScene::aside();
        let pairs = scene.pairs(40);
        let matches: Vec<_> = pairs.iter().map(|pair| (*pair, 0.9)).collect();
        let support = Support::of_matches(&matches);
        let fundamental = scene.fundamental();
        let leader = Proposal {
            origin: ProposedBy::Features.into(),
            angles: None,
            support: support.measure(&fundamental),
            fundamental,
        };
        // One match fewer than a sample takes is left.
        for (clicks, is_empty) in [(&pairs[DRAWN - 1..], true), (&pairs[DRAWN..], false)] {
            let drawing = Drawing { clicks, parameters: ON_MATCHES, seed: 2 };
            assert_eq!(drawn(&support, &leader, &drawing).is_empty(), is_empty, "{} clicks", clicks.len());
        }
    }

    #[test]
    fn the_seed_decides_and_no_hypotheses_give_no_samples() {
        let (scene, support, leader) = trap();
        let clicks = scene.clicks();
        let matrices = |seed: u64| -> Vec<FundamentalMatrix> {
            let drawing = Drawing { clicks: &clicks, parameters: PatchParameters::default(), seed };
            drawn(&support, &leader, &drawing).iter().map(|f| f.fundamental).collect()
        };
        assert!(matrices(1) == matrices(1) && matrices(1) != matrices(2));
        let drawing = Drawing { clicks: &clicks, parameters: PatchParameters::default(), seed: 1 };
        assert!(resample(&support, &[], 9, &drawing, &CancelFlag::default()).unwrap().is_empty());
        let flag = CancelFlag::default();
        flag.cancel();
        let stopped = resample(&support, &[leader], 9, &drawing, &flag);
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
