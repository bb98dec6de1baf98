//! Residuals of a point pair under a fundamental matrix.

use super::{FundamentalMatrix, Line, PointPair};

/// Returns the mean distance of both points to the epipolar lines of their partners, px. The
/// distance is infinite when a point is an epipole, which has no epipolar line.
pub fn symmetric_epipolar_distance(f: &FundamentalMatrix, pair: &PointPair) -> f64 {
    match (f.line2_from_point1(pair.point1), f.line1_from_point2(pair.point2)) {
        (Some(line2), Some(line1)) => 0.5 * (line2.distance(pair.point2) + line1.distance(pair.point1)),
        _ => f64::INFINITY,
    }
}

/// Returns the first-order distance of the pair to the manifold `x2ᵀ F x1 = 0`, px: the square root
/// of the Sampson error (Hartley & Zisserman, eq. 11.9).
pub fn sampson_distance(f: &FundamentalMatrix, pair: &PointPair) -> f64 {
    let l2 = f.matrix() * pair.point1.to_homogeneous();
    let l1 = f.matrix().tr_mul(&pair.point2.to_homogeneous());
    algebraic_residual(f, pair).abs() / (l2.xy().norm_squared() + l1.xy().norm_squared()).sqrt()
}

/// Returns the signed residual `x2ᵀ F x1`, which has no geometric unit: it depends on the norm of
/// `F`, here 1.
pub fn algebraic_residual(f: &FundamentalMatrix, pair: &PointPair) -> f64 {
    pair.point2.to_homogeneous().dot(&(f.matrix() * pair.point1.to_homogeneous()))
}

/// Returns the separation of two pairs across their epipolar lines, in image 1 and in image 2, px.
/// The separation is the smaller distance from one pair's point to the other pair's line.
///
/// At a small separation, both pairs share one epipolar line, and the epipole's position along the
/// line is undetermined. The separation is 0 when a point is an epipole.
pub fn apart_across_lines(f: &FundamentalMatrix, p: &PointPair, q: &PointPair) -> [f64; 2] {
    let far = |line: Option<Line>, point| line.map_or(0.0, |l| l.distance(point));
    [
        far(f.line1_from_point2(p.point2), q.point1).min(far(f.line1_from_point2(q.point2), p.point1)),
        far(f.line2_from_point1(p.point1), q.point2).min(far(f.line2_from_point1(q.point1), p.point2)),
    ]
}

/// Returns the median of some values: the greater of the middle two for an even number, 0 without
/// values.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{RandomScene, rows};

    #[test]
    fn rows_measure_vertical_differences() {
        let pair = PointPair::new(10.0, 20.0, 30.0, 23.0);
        let f = rows(0.0);
        assert!((symmetric_epipolar_distance(&f, &pair) - 3.0).abs() < 1e-12);
        // Both points move half way: 3/√2.
        assert!((sampson_distance(&f, &pair) - 3.0 / 2f64.sqrt()).abs() < 1e-12);
        assert!((algebraic_residual(&f, &pair).abs() - 3.0 / 2f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn pairs_are_as_far_apart_as_the_nearer_of_their_lines() {
        let (p, q) = (PointPair::new(10.0, 20.0, 30.0, 23.0), PointPair::new(400.0, 25.0, 7.0, 24.0));
        // Epipolar lines are rows: 25 is 2 px from 23, 20 is 4 px from 24.
        for apart in [apart_across_lines(&rows(0.0), &p, &q), apart_across_lines(&rows(0.0), &q, &p)] {
            assert!(apart.iter().all(|distance| (distance - 2.0).abs() < 1e-12), "{apart:?}");
        }
    }

    #[test]
    fn the_sampson_distance_of_noisy_points_is_the_noise() {
        let mut scene = RandomScene::new(3);
        let f = scene.fundamental();
        let exact = scene.pairs(2000);
        let noisy = scene.disturbed(&exact, 0.5);
        let rms = |of: fn(&FundamentalMatrix, &PointPair) -> f64, pairs: &[PointPair]| {
            (pairs.iter().map(|p| of(&f, p).powi(2)).sum::<f64>() / pairs.len() as f64).sqrt()
        };
        // One of the four dimensions of a pair is across the manifold. The deviation of 2000 values
        // is σ to 1.6 %.
        let sampson = rms(sampson_distance, &noisy);
        assert!((sampson - 0.5).abs() < 0.025, "{sampson}");
        // Each distance to a line holds the noise of both points.
        let symmetric = rms(symmetric_epipolar_distance, &noisy);
        assert!(symmetric > 1.2 * sampson && symmetric < 2.0 * sampson, "{symmetric}");
        for measure in [sampson_distance, symmetric_epipolar_distance, algebraic_residual] {
            assert!(rms(measure, &exact) < 1e-8 && rms(measure, &noisy) > 1e-5);
        }
    }
}
