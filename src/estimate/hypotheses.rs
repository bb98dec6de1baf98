//! Epipole hypotheses: two candidate line pairs give the epipoles, a bisector in each direction gives the map
//! between the pencils (paper, section 5.1, step 2 a–c).

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::bundle::{Angles, Bundle};
use super::candidates::Candidate;
use crate::geometry::{Frame, LinePair, PencilMap, PointPair, area_between_lines};
use crate::similarity::LineSimilarity;

/// A hypothesis at the coarse level.
#[derive(Debug, Clone)]
pub(crate) struct Draft {
    /// The geometry, with κ of the forward map H.
    pub angles: Angles,
    /// κ of the backward map G.
    pub kappa_backward: f64,
    /// Mean epipolar area between `l` and `GH l` over the width of image 1, px of the level.
    pub round_trip: f64,
}

/// Draws `count` different pairs of candidates, cheap ones more often; all of them when there are fewer.
pub(crate) fn draw_pairs(
    candidates: [&[Candidate]; 2],
    count: usize,
    seed: u64,
) -> Vec<(Candidate, Candidate)> {
    let [p, q] = candidates;
    let total = p.len() * q.len();
    if total <= count {
        return p.iter().flat_map(|a| q.iter().map(move |b| (*a, *b))).collect();
    }
    // Weighted sampling without replacement (Efraimidis & Spirakis 2006): the smallest −ln(u)/w win.
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let weights = [weights(p), weights(q)];
    let mut keys: Vec<(f64, usize)> = (0..total)
        .map(|k| {
            let weight = weights[0][k / q.len()] * weights[1][k % q.len()];
            let u: f64 = rng.random_range(f64::MIN_POSITIVE..1.0);
            (-u.ln() / weight, k)
        })
        .collect();
    keys.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0));
    keys.truncate(count);
    keys.sort_by_key(|(_, k)| *k);
    keys.into_iter().map(|(_, k)| (p[k / q.len()], q[k % q.len()])).collect()
}

/// Weight of each candidate: inverse square of its cost in units of the cheapest.
fn weights(candidates: &[Candidate]) -> Vec<f64> {
    let cheapest = candidates.iter().map(|c| f64::from(c.cost)).fold(f64::INFINITY, f64::min).max(1e-9);
    candidates.iter().map(|c| (cheapest / f64::from(c.cost).max(1e-9)).powi(2)).collect()
}

/// The hypothesis of two candidates: `None` when the two lines nearly coincide, when their directions
/// contradict each other, or when no third line pair can be compared.
pub(crate) fn draft(
    similarity: &dyn LineSimilarity,
    pair: &(Candidate, Candidate),
    clicks: [PointPair; 2],
    frames: [Frame; 2],
    third: Option<&PointPair>,
) -> Option<Draft> {
    let (p, q) = pair;
    let angles = Angles { p: p.angles, q: q.angles, kappa: 1.0 };
    let bundle = Bundle::new(&angles, clicks)?;
    if !is_spread(&bundle, &clicks, frames) {
        return None;
    }
    let (forward, backward) = match third {
        Some(pair) => {
            let kappa = bundle.map().kappa_from_point_pair(pair)?;
            (kappa, kappa)
        }
        None => bisector_kappas(similarity, &bundle, &clicks)?,
    };
    let bundle = bundle.with_kappa(forward);
    let round_trip = round_trip_area(&bundle, forward / backward, frames[0]);
    Some(Draft { angles: Angles { kappa: forward, ..angles }, kappa_backward: backward, round_trip })
}

/// Whether each click keeps clear of the other's line, in both images, by 2 % of the image diagonal: nearer
/// than that the epipoles are undetermined.
fn is_spread(bundle: &Bundle, clicks: &[PointPair; 2], frames: [Frame; 2]) -> bool {
    let (p, q): (&LinePair, &LinePair) = (bundle.map().p(), bundle.map().q());
    let [a, b] = clicks;
    let nearest1 = p.line1.distance(b.point1).min(q.line1.distance(a.point1));
    let nearest2 = p.line2.distance(b.point2).min(q.line2.distance(a.point2));
    nearest1 > 0.02 * frames[0].diagonal() && nearest2 > 0.02 * frames[1].diagonal()
}

/// κ of H (bisector in image 1, best line of image 2) and of G (bisector in image 2, best line of image 1).
///
/// The search runs over the sector between the clicks, the only one that points in front of both cameras
/// allow, in steps of 2 px where the line that joins the clicks is crossed.
pub(crate) fn bisector_kappas(
    similarity: &dyn LineSimilarity,
    bundle: &Bundle,
    clicks: &[PointPair; 2],
) -> Option<(f64, f64)> {
    let [a, b] = clicks;
    let map = bundle.map();
    let bisector = PencilMap::bisector1();
    let count = |near: f64, far: f64| (near.max(far) / 2.0).ceil().clamp(4.0, 96.0) as usize;
    let inner = |count: usize| (1..count).map(move |k| k as f64 / count as f64);

    let line1 = map.line1(bisector)?;
    let steps2 = count(map.p().line2.distance(b.point2), map.q().line2.distance(a.point2));
    let forward: Vec<_> = inner(steps2)
        .filter_map(|t| {
            let c2 = map.coordinates2(a.point2 + (b.point2 - a.point2) * t);
            let pair = bundle.anchored(&line1, &map.line2(c2)?)?;
            Some((PencilMap::kappa_from_coordinates(bisector, c2)?, pair))
        })
        .collect();

    let line2 = map.line2(bisector)?;
    let steps1 = count(map.p().line1.distance(b.point1), map.q().line1.distance(a.point1));
    let backward: Vec<_> = inner(steps1)
        .filter_map(|t| {
            let c1 = map.coordinates1(a.point1 + (b.point1 - a.point1) * t);
            let pair = bundle.anchored(&map.line1(c1)?, &line2)?;
            Some((PencilMap::kappa_from_coordinates(c1, bisector)?, pair))
        })
        .collect();

    let best = |choices: Vec<(f64, _)>| {
        let pairs: Vec<_> = choices.iter().map(|(_, pair)| *pair).collect();
        let costs = similarity.pair_costs(&pairs);
        let cheapest = (0..pairs.len()).min_by(|i, j| costs[*i].total_cmp(&costs[*j]))?;
        costs[cheapest].is_finite().then(|| choices[cheapest].0)
    };
    Some((best(forward)?, best(backward)?))
}

/// Mean area between lines of image 1 and where `GH` brings them, over the image width: px. `ratio` is
/// `κ_H / κ_G`; the composite map is `diag(1, ratio)` in the basis of the two line pairs.
pub(crate) fn round_trip_area(bundle: &Bundle, ratio: f64, frame1: Frame) -> f64 {
    let lines = bundle.coordinates_over_image1(frame1, 12);
    let areas: Vec<f64> = lines
        .iter()
        .filter_map(|c| {
            let there = bundle.map().line1(*c)?;
            let back = bundle.map().line1(nalgebra::Vector2::new(c.x, c.y * ratio))?;
            Some(area_between_lines(&there, &back, frame1))
        })
        .collect();
    if areas.is_empty() {
        return f64::INFINITY;
    }
    areas.iter().sum::<f64>() / areas.len() as f64 / frame1.width as f64
}
