//! Bisectors of a hypothesis and their round trip (paper, section 5.1, step 2 b–c). A bisector in
//! each direction, with its best match in the other image, gives κ. For the right epipoles the two
//! values agree.

use nalgebra::Vector2;
use rayon::prelude::*;

use super::pencil_pair::PencilPair;
use crate::cancel::CancelFlag;
use crate::geometry::{AnchoredLine, Frame, PencilMap, PointPair, area_between_lines};
use crate::similarity::LineSimilarity;

/// Spacing of the lines tried for a bisector, px on the line that joins the clicks. A bisector is
/// thus found to 1 px.
const STEP: f64 = 2.0;
/// Fewest and most lines tried for a bisector, for close and for distant clicks. The most bounds
/// the time. Clicks more than 192 px apart get wider spaces.
const STEPS: [f64; 2] = [4.0, 96.0];
/// Number of lines of image 1 whose round trip is measured. Their mean area only decides which
/// hypotheses are validated.
const ROUND_TRIPS: usize = 12;
/// Number of hypotheses whose lines are compared in one call. A stop is noticed between calls. No
/// result depends on it.
const AT_ONCE: usize = 128;

/// A line pair with the κ that it gives.
type TriedPair = (f64, (AnchoredLine, AnchoredLine));

/// Returns κ of H and of G for each hypothesis through the clicks. H comes from the bisector in
/// image 1 and its best line of image 2, G from the bisector in image 2. The result is `None` where
/// no line could be compared. When stopped, returns fewer.
///
/// The search runs over the sector between the clicks, the only one possible for points in front of
/// both cameras. Neighbouring lines are about 2 px apart on the line that joins the clicks.
pub(in crate::estimate) fn bisector_kappas(
    similarity: &dyn LineSimilarity,
    hypotheses: &[PencilPair],
    clicks: &[PointPair; 2],
    cancel: &CancelFlag,
) -> Vec<Option<(f64, f64)>> {
    let mut kappas = Vec::with_capacity(hypotheses.len());
    for few in hypotheses.chunks(AT_ONCE).take_while(|_| !cancel.is_cancelled()) {
        let trials: Vec<Option<[Vec<TriedPair>; 2]>> =
            few.par_iter().map(|pencils| trials(pencils, clicks)).collect();
        let all: Vec<_> =
            trials.iter().flatten().flatten().flat_map(|list| list.iter().map(|(_, pair)| *pair)).collect();
        let costs = similarity.pair_costs(&all);
        let mut costs = costs.as_slice();
        let mut best = |list: &[TriedPair]| {
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

/// Returns the line pairs tried for H and for G.
fn trials(pencils: &PencilPair, clicks: &[PointPair; 2]) -> Option<[Vec<TriedPair>; 2]> {
    let [a, b] = clicks;
    let map = pencils.map;
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

/// Returns the mean area between lines of image 1 and their images under `GH`, divided by the image
/// width, px. `ratio` is `κ_H / κ_G`: the composite map is `diag(1, ratio)` in the basis of the two
/// line pairs.
pub(in crate::estimate) fn round_trip_area(pencils: &PencilPair, ratio: f64, frame1: Frame) -> f64 {
    let lines = pencils.coordinates_over_image1(frame1, ROUND_TRIPS);
    let areas: Vec<f64> = lines
        .iter()
        .filter_map(|c| {
            let there = pencils.map.line1(*c)?;
            let back = pencils.map.line1(Vector2::new(c.x, c.y * ratio))?;
            Some(area_between_lines(&there, &back, frame1))
        })
        .collect();
    if areas.is_empty() {
        return f64::INFINITY;
    }
    areas.iter().sum::<f64>() / areas.len() as f64 / frame1.width as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::evidence::lines::PencilAngles;
    use crate::estimate::exact::{ExactScene, FRAME, LinesBy, exact_lines};
    use crate::geometry::{FundamentalMatrix, Line, Point};

    /// Returns both κ for exact lines.
    fn kappas(
        f: FundamentalMatrix,
        hypotheses: &[PencilPair],
        clicks: &[PointPair; 2],
    ) -> Vec<Option<(f64, f64)>> {
        bisector_kappas(&exact_lines(f, [FRAME; 2]), hypotheses, clicks, &CancelFlag::default())
    }

    /// Returns the true pencils with κ = 1, the lines of the first click turned in image 2.
    fn hypotheses(scene: &ExactScene, turns: &[f64]) -> Vec<PencilPair> {
        let of = |turn: &f64| {
            let angles = scene.angles();
            let p = [angles.p[0], angles.p[1] + turn];
            PencilPair::new(&PencilAngles { p, kappa: 1.0, ..angles }, scene.clicks()).unwrap()
        };
        turns.iter().map(of).collect()
    }

    /// Returns the intersection of a line with the line that joins two points.
    fn crossing(line: &Line, a: Point, b: Point) -> Point {
        let (da, db) = (line.signed_distance(a), line.signed_distance(b));
        assert!(da * db < 0.0, "between the clicks");
        a + (b - a) * (da / (da - db))
    }

    #[test]
    fn both_bisectors_find_the_true_line_to_a_step() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let (f, clicks) = (scene.fundamental(), scene.clicks());
            let [a, b] = clicks;
            let pencils = &hypotheses(&scene, &[0.0])[0];
            let (forward, backward) = kappas(f, std::slice::from_ref(pencils), &clicks)[0].unwrap();
            let bisector = PencilMap::bisector1();
            let line1 = pencils.map.line1(bisector).unwrap();
            let true2 = f.line2_from_point1(crossing(&line1, a.point1, b.point1)).unwrap();
            let found2 = pencils.with_kappa(forward).map.line2_from_line1(bisector).unwrap();
            let off2 = crossing(&true2, a.point2, b.point2) - crossing(&found2, a.point2, b.point2);
            let line2 = pencils.map.line2(bisector).unwrap();
            let true1 = f.line1_from_point2(crossing(&line2, a.point2, b.point2)).unwrap();
            let found1 = pencils.with_kappa(backward).map.line1_from_line2(bisector).unwrap();
            let off1 = crossing(&true1, a.point1, b.point1) - crossing(&found1, a.point1, b.point1);
            // Half a step and some more: the area between lines grows unevenly to the two sides.
            let step = |join: f64, near: f64, far: f64| join / (near.max(far) / STEP).ceil();
            let [p, q] = [*pencils.map.p(), *pencils.map.q()];
            let join = [(b.point1 - a.point1).norm(), (b.point2 - a.point2).norm()];
            let step1 = step(join[0], p.line1.distance(b.point1), q.line1.distance(a.point1));
            let step2 = step(join[1], p.line2.distance(b.point2), q.line2.distance(a.point2));
            assert!(off1.norm() < 0.7 * step1, "{off1} px in steps of {step1} px");
            assert!(off2.norm() < 0.7 * step2, "{off2} px in steps of {step2} px");
        }
    }

    #[test]
    fn round_trips_of_wrong_epipoles_have_larger_areas() {
        let scene = ExactScene::aside();
        let all = hypotheses(&scene, &[0.0, 0.25, -0.25, 0.5, -0.5]);
        let kappas = kappas(scene.fundamental(), &all, &scene.clicks());
        let areas: Vec<f64> = all
            .iter()
            .zip(kappas)
            .map(|(pencils, kappas)| {
                let (forward, backward) = kappas.unwrap();
                round_trip_area(&pencils.with_kappa(forward), forward / backward, FRAME)
            })
            .collect();
        // The steps of both searches cause an error of a pixel or two.
        assert!(areas[0] < 2.0, "{areas:?}");
        assert!(areas[1..].iter().all(|area| *area > 2.0 * areas[0]), "{areas:?}");
    }

    #[test]
    fn hypotheses_are_independent_of_each_other() {
        let scene = ExactScene::aside();
        let turns: Vec<f64> = (0..AT_ONCE + 30).map(|k| 0.1 * (k % 5) as f64).collect();
        let all = hypotheses(&scene, &turns);
        let kappas = kappas(scene.fundamental(), &all, &scene.clicks());
        assert_eq!(kappas.len(), all.len());
        for (k, found) in kappas.iter().enumerate() {
            assert_eq!(*found, kappas[k % 5], "hypothesis {k}");
        }
        assert!((0..5).all(|k| (k + 1..5).all(|j| kappas[k] != kappas[j])));
    }

    #[test]
    fn without_comparable_lines_there_is_no_kappa() {
        let scene = ExactScene::aside();
        let (all, clicks) = (hypotheses(&scene, &[0.0, 0.1, 0.2]), scene.clicks());
        // All lines through the second hypothesis' epipole in image 2 count as outside.
        let map = &all[1].map;
        let epipole2 = map.p().line2.intersection(&map.q().line2).normalize();
        let similarity = LinesBy(|_: &AnchoredLine, line2: &AnchoredLine| {
            if line2.line().coefficients().dot(&epipole2).abs() < 1e-9 { f32::INFINITY } else { 1.0 }
        });
        let found = bisector_kappas(&similarity, &all, &clicks, &CancelFlag::default());
        assert_eq!(found.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false, true]);
        let flag = CancelFlag::default();
        flag.cancel();
        assert_eq!(bisector_kappas(&similarity, &all, &clicks, &flag), []);
    }

    #[test]
    fn the_round_trip_area_is_the_area_between_the_lines() {
        // Rows: the line at y comes back at y′ with (q − y)(y′ − p) = ratio (y − p)(q − y′).
        let (p, q, ratio) = (60.0, 180.0, 1.5);
        let clicks = [PointPair::new(100.0, p, 80.0, p), PointPair::new(200.0, q, 190.0, q)];
        let angles = PencilAngles { p: [0.0; 2], q: [0.0; 2], kappa: 1.0 };
        let pencils = PencilPair::new(&angles, clicks).unwrap();
        assert!(round_trip_area(&pencils, 1.0, FRAME) < 1e-9);
        let lines = pencils.coordinates_over_image1(FRAME, ROUND_TRIPS);
        let moved = lines.iter().map(|c| {
            let y = pencils.map.line1(*c).unwrap().foot(FRAME.centre()).y;
            let back = (p * (q - y) + ratio * q * (y - p)) / (q - y + ratio * (y - p));
            (back.clamp(0.0, FRAME.bottom()) - y).abs()
        });
        let expected = moved.sum::<f64>() / lines.len() as f64 * FRAME.right() / FRAME.width as f64;
        let area = round_trip_area(&pencils, ratio, FRAME);
        assert!(expected > 5.0 && (area / expected - 1.0).abs() < 1e-6, "{area} {expected}");
    }
}
