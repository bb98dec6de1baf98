//! Tests with exact cameras, synthetic features of the points that they see, and false matches.

use nalgebra::Point3;
use rand::SeedableRng;

use super::*;
use crate::features::{Feature, FeatureSet};
use crate::geometry::{Camera, Point, seven_point, symmetric_epipolar_distance};

const FRAME: Frame = Frame { width: 768, height: 576 };

struct Scene {
    sets: [FeatureSet; 2],
    matches: Vec<FeatureMatch>,
    exact: Vec<PointPair>,
}

/// Points seen by both cameras, with noise of this σ, and false matches among them. The ratios of
/// right matches are somewhat lower.
fn scene(right: usize, wrong: usize, sigma: f64) -> Scene {
    let (camera1, camera2) = Camera::example_pair();
    let mut random = Pcg64Mcg::seed_from_u64(8);
    let mut scene = Scene { sets: Default::default(), matches: Vec::new(), exact: Vec::new() };
    let point = |random: &mut Pcg64Mcg| {
        let mut between = |a: f64, b: f64| random.random_range(a..b);
        Point3::new(between(-2.0, 2.0), between(-1.5, 1.5), between(4.0, 8.0))
    };
    for k in 0..right + wrong {
        let is_right = k < right;
        let x = point(&mut random);
        let y = if is_right { x } else { point(&mut random) };
        let exact = PointPair { point1: camera1.project(&x).unwrap(), point2: camera2.project(&y).unwrap() };
        let mut gauss = || sigma * ((0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0);
        let mut moved = |p: Point| Point::new(p.x + gauss(), p.y + gauss());
        let pair = PointPair { point1: moved(exact.point1), point2: moved(exact.point2) };
        let ratio = if is_right { random.random_range(0.5..0.95) } else { random.random_range(0.75..1.0) };
        let turn = if is_right { 0.0 } else { random.random_range(0.0..6.0) };
        for (set, (position, orientation)) in
            scene.sets.iter_mut().zip([(pair.point1, 1.0), (pair.point2, 1.0 + turn)])
        {
            let feature = Feature {
                position,
                scale: 2.0,
                orientation,
                shape: nalgebra::Matrix2::identity(),
                response: 10.0,
            };
            let descriptor = std::array::from_fn(|i| ((i * (k + 1) * 7919 + i * i * 31) % 97) as u8);
            set.push(feature, descriptor);
        }
        scene.matches.push(FeatureMatch { feature1: k, feature2: k, pair, ratio });
        if is_right {
            scene.exact.push(exact);
        }
    }
    scene
}

impl Scene {
    fn search(&self, clicks: &[PointPair]) -> Vec<FeatureHypothesis> {
        let evidence = FeatureEvidence {
            sets: [&self.sets[0], &self.sets[1]],
            matches: &self.matches,
            frames: [FRAME; 2],
            clicks,
            click_sigma: 1.0,
        };
        hypotheses_from_features(&evidence, &FeatureParameters::default(), 0)
    }

    fn error(&self, f: &FundamentalMatrix) -> f64 {
        self.exact.iter().map(|p| symmetric_epipolar_distance(f, p)).sum::<f64>() / self.exact.len() as f64
    }
}

#[test]
fn seven_equations_of_points_agree_with_the_seven_point_algorithm() {
    let scene = scene(60, 0, 0.0);
    let units = Units::new([FRAME; 2]);
    for first in 0..50 {
        let pairs: Vec<PointPair> = (0..7).map(|k| scene.exact[(first + 5 * k * k) % 60]).collect();
        let Ok(expected) = seven_point(&pairs) else { continue };
        let equations: Vec<Equation> = pairs.iter().map(|p| point_equation(units.pair(p))).collect();
        let found: Vec<_> = solve_seven(&equations.try_into().unwrap())
            .iter()
            .filter_map(|f| FundamentalMatrix::nearest_rank_two(units.in_pixels(f)))
            .collect();
        assert_eq!(found.len(), expected.len(), "{first}");
        for f in &expected {
            let off = found.iter().map(|g| (g.matrix() - f.matrix()).norm()).fold(1.0, f64::min);
            assert!(off < 1e-5, "{first}: {off}");
        }
    }
}

/// The second equation is the first-order difference between the equations of two points.
#[test]
fn the_equation_of_a_frame_is_the_derivative_of_the_equation_of_a_point() {
    let at = [0.3, -0.2, 0.5, 0.4];
    let (v1, v2) = ([0.6, 0.1], [-0.2, 0.9]);
    let h = 1e-6;
    let moved =
        |s: f64| point_equation([at[0] + s * v1[0], at[1] + s * v1[1], at[2] + s * v2[0], at[3] + s * v2[1]]);
    let expected: Vec<f64> = moved(h).iter().zip(moved(-h)).map(|(a, b)| (a - b) / (2.0 * h)).collect();
    for (found, expected) in frame_equation(at, v1, v2).iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9);
    }
}

#[test]
fn the_score_is_the_sum_over_all_witnesses() {
    let scene = scene(90, 30, 1.0);
    let witnesses: Vec<Witness> = scene
        .matches
        .iter()
        .map(|m| Witness { pair: m.pair, sigmas: [1.0, 0.6], gain: 5.0 * m.ratio, clicked: false })
        .collect();
    let consensus = Consensus::new(Units::new([FRAME, Frame::new(640, 480)]), &witnesses);
    let f = *eight_point(&scene.exact[..20]).unwrap().matrix();
    let expected: f64 =
        witnesses.iter().map(|w| w.gain * (1.0 - (residual(&f, w) / BAND).powi(2)).max(0.0)).sum();
    assert!((consensus.score(&f) / expected - 1.0).abs() < 1e-3, "{} {expected}", consensus.score(&f));
}

#[test]
fn one_right_match_in_five_is_enough_with_any_clicks() {
    let scene = scene(80, 320, 0.5);
    for clicks in [0, 1, 2, 4, 9] {
        let found = scene.search(&scene.exact[..clicks]);
        let error = scene.error(&found[0].fundamental);
        assert!(error < 0.5, "{clicks} clicks: {error}");
        assert!(found.is_sorted_by(|a, b| a.score >= b.score));
    }
}

#[test]
fn eight_clicks_are_enough_and_no_evidence_gives_no_geometry() {
    let empty = Scene { matches: Vec::new(), ..scene(60, 0, 0.0) };
    assert!(empty.search(&[]).is_empty());
    assert!(empty.search(&empty.exact[..2]).is_empty());
    let found = empty.search(&empty.exact[..12]);
    assert!(empty.error(&found[0].fundamental) < 1e-3);
}

#[test]
fn one_wrong_click_of_five_is_outvoted() {
    let scene = scene(120, 200, 0.5);
    let mut clicks = scene.exact[..5].to_vec();
    clicks[2].point2.y += 60.0;
    let found = scene.search(&clicks);
    assert!(scene.error(&found[0].fundamental) < 0.6, "{}", scene.error(&found[0].fundamental));
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let scene = scene(60, 200, 0.5);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| scene.search(&scene.exact[..2]))
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.len(), three.len());
    for (a, b) in one.iter().zip(&three) {
        assert_eq!(a.fundamental, b.fundamental);
        assert_eq!(a.score.to_bits(), b.score.to_bits());
    }
}

#[test]
fn guided_matching_finds_all_matches_within_the_band() {
    // Fewer than 97: the synthetic descriptors repeat beyond.
    let scene = scene(60, 30, 1.0);
    let f = eight_point(&scene.exact).unwrap();
    let evidence = FeatureEvidence {
        sets: [&scene.sets[0], &scene.sets[1]],
        matches: &scene.matches,
        frames: [FRAME; 2],
        clicks: &[],
        click_sigma: 1.0,
    };
    let guided = rematching::guided_matches(&evidence, &f);
    let all = witnesses(&evidence, &scene.matches, &vec![0.0; scene.matches.len()]);
    // The descriptors of a match are equal, so each match near its line is found.
    let expected: Vec<usize> = (0..all.len()).filter(|k| residual(f.matrix(), &all[*k]) < BAND).collect();
    let found: Vec<usize> = guided.iter().filter(|m| m.feature1 == m.feature2).map(|m| m.feature1).collect();
    assert_eq!(found, expected);
    assert!(found.len() >= 56);
}
