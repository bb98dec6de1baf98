//! The bisectors of a hypothesis and the round trip they make (paper, section 5.1, step 2 b–c): a bisector in each
//! direction, with its best match in the other image, gives κ twice; for the right epipoles both agree.

use nalgebra::Vector2;
use rayon::prelude::*;

use super::pencil_pair::PencilPair;
use crate::estimate::Monitor;
use crate::geometry::{AnchoredLine, Frame, PencilMap, PointPair, area_between_lines};
use crate::similarity::LineSimilarity;

/// Distance of neighbouring lines tried for a bisector where the line that joins the clicks is crossed, px.
const STEP: f64 = 2.0;
/// Fewest and most steps of a search, so that clicks side by side still give some lines, and far ones not too many.
const STEPS: [f64; 2] = [4.0, 96.0];
/// Lines of image 1 whose round trip is measured.
const ROUND_TRIPS: usize = 12;
/// Hypotheses whose lines are compared at once: enough to fill the vector units, few enough to stop soon.
const AT_ONCE: usize = 128;

/// A line pair that would give κ.
type Trial = (f64, (AnchoredLine, AnchoredLine));

/// κ of H (bisector in image 1, best line of image 2) and of G (bisector in image 2, best line of image 1), of each
/// hypothesis through the clicks; `None` where no line could be compared. Fewer when stopped.
///
/// The search runs over the sector between the clicks, the only one that points in front of both cameras
/// allow, in steps of 2 px where the line that joins the clicks is crossed.
pub(super) fn bisector_kappas(
    similarity: &dyn LineSimilarity,
    hypotheses: &[PencilPair],
    clicks: &[PointPair; 2],
    monitor: &Monitor,
) -> Vec<Option<(f64, f64)>> {
    let mut kappas = Vec::with_capacity(hypotheses.len());
    for few in hypotheses.chunks(AT_ONCE).take_while(|_| !monitor.is_cancelled()) {
        let trials: Vec<Option<[Vec<Trial>; 2]>> =
            few.par_iter().map(|pencils| trials(pencils, clicks)).collect();
        let all: Vec<_> =
            trials.iter().flatten().flatten().flat_map(|list| list.iter().map(|(_, pair)| *pair)).collect();
        let costs = similarity.pair_costs(&all);
        let mut costs = costs.as_slice();
        let mut best = |list: &[Trial]| {
            let (own, rest) = costs.split_at(list.len());
            costs = rest;
            let cheapest = (0..own.len()).min_by(|i, j| own[*i].total_cmp(&own[*j]))?;
            own[cheapest].is_finite().then(|| list[cheapest].0)
        };
        kappas.extend(trials.iter().map(|trials| {
            let [forward, backward] = trials.as_ref()?.each_ref().map(|list| best(list));
            Some((forward?, backward?))
        }));
    }
    kappas
}

/// The line pairs tried for H, and those for G.
fn trials(pencils: &PencilPair, clicks: &[PointPair; 2]) -> Option<[Vec<Trial>; 2]> {
    let [a, b] = clicks;
    let map = pencils.map();
    let bisector = PencilMap::bisector1();
    let inner = |near: f64, far: f64| {
        let count = (near.max(far) / STEP).ceil().clamp(STEPS[0], STEPS[1]) as usize;
        (1..count).map(move |k| k as f64 / count as f64)
    };

    let line1 = map.line1(bisector)?;
    let forward = inner(map.p().line2.distance(b.point2), map.q().line2.distance(a.point2))
        .filter_map(|t| {
            let c2 = map.coordinates2(a.point2 + (b.point2 - a.point2) * t);
            let pair = pencils.anchored(&line1, &map.line2(c2)?)?;
            Some((PencilMap::kappa_from_coordinates(bisector, c2)?, pair))
        })
        .collect();

    let line2 = map.line2(bisector)?;
    let backward = inner(map.p().line1.distance(b.point1), map.q().line1.distance(a.point1))
        .filter_map(|t| {
            let c1 = map.coordinates1(a.point1 + (b.point1 - a.point1) * t);
            let pair = pencils.anchored(&map.line1(c1)?, &line2)?;
            Some((PencilMap::kappa_from_coordinates(c1, bisector)?, pair))
        })
        .collect();
    Some([forward, backward])
}

/// Mean area between lines of image 1 and where `GH` brings them, over the image width: px. `ratio` is
/// `κ_H / κ_G`; the composite map is `diag(1, ratio)` in the basis of the two line pairs.
pub(super) fn round_trip_area(pencils: &PencilPair, ratio: f64, frame1: Frame) -> f64 {
    let lines = pencils.coordinates_over_image1(frame1, ROUND_TRIPS);
    let areas: Vec<f64> = lines
        .iter()
        .filter_map(|c| {
            let there = pencils.map().line1(*c)?;
            let back = pencils.map().line1(Vector2::new(c.x, c.y * ratio))?;
            Some(area_between_lines(&there, &back, frame1))
        })
        .collect();
    if areas.is_empty() {
        return f64::INFINITY;
    }
    areas.iter().sum::<f64>() / areas.len() as f64 / frame1.width as f64
}
