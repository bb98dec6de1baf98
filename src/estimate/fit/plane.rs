//! Largest plane among matches. If one plane or a rotation of the camera explains all matches, a
//! homography maps them all, and every epipole fits (Hartley & Zisserman, §11.9.2).

use nalgebra::Matrix3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::estimate::sampling::{Draws, Purpose, refitted};
use crate::geometry::{PointPair, homography};

/// Number of samples. Among 300, at least one has four matches of a plane that holds a third of
/// all, with a probability of 97 %.
const SAMPLES: usize = 300;
/// Number of rounds of refitting to the matches within the tolerance. The best round counts, so
/// more rounds lose nothing but time.
const REFITS: usize = 3;
/// Number of matches for sampling and scoring, evenly chosen from all: enough to know the share of
/// a plane to 5 %.
const LOOKED_AT: usize = 400;

/// Fewest matches examined. A refit needs more than this number. Twice the four that determine a
/// homography, which any four fit.
const FEWEST: usize = 8;

/// Returns the homography with most matches within `tolerance` px in image 2, and their number.
/// Returns `None` for fewer than eight matches.
pub(in crate::estimate) fn largest_plane(
    matches: &[PointPair],
    tolerance: f64,
    seed: u64,
) -> Option<(Matrix3<f64>, usize)> {
    if matches.len() < FEWEST {
        return None;
    }
    let few: Vec<PointPair> = if matches.len() > LOOKED_AT {
        (0..LOOKED_AT).map(|k| matches[k * matches.len() / LOOKED_AT]).collect()
    } else {
        matches.to_vec()
    };
    let from_sample = |random: &mut Pcg64Mcg| -> Option<(Matrix3<f64>, usize)> {
        let sample: [PointPair; 4] = std::array::from_fn(|_| few[random.random_range(0..few.len())]);
        Some(largest_of_refits(homography(&sample)?, &few, tolerance))
    };
    let draws = Draws { seed, purpose: Purpose::PlaneSamples, first: 0, count: SAMPLES, task: 1 };
    // The first of the best.
    let best = draws.collect(from_sample).into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    Some(if few.len() < matches.len() { largest_of_refits(best.0, matches, tolerance) } else { best })
}

/// Refits the homography `h` repeatedly to the matches that follow it. Returns the homography with
/// most matches.
fn largest_of_refits(h: Matrix3<f64>, matches: &[PointPair], tolerance: f64) -> (Matrix3<f64>, usize) {
    let counted = |h: Matrix3<f64>| {
        let on_plane: Vec<PointPair> =
            matches.iter().filter(|m| is_on_plane(&h, m, tolerance)).copied().collect();
        (on_plane.len(), (h, on_plane))
    };
    let refit = |(most, (_, on_plane)): &(usize, (Matrix3<f64>, Vec<PointPair>)), _| {
        (*most > FEWEST).then(|| homography(on_plane)).flatten().map(counted)
    };
    let (most, (h, _)) = refitted(counted(h), REFITS, refit);
    (h, most)
}

/// Returns whether [`transfer_error`](crate::geometry::transfer_error) is below a tolerance,
/// without a division or a root.
fn is_on_plane(h: &Matrix3<f64>, pair: &PointPair, tolerance: f64) -> bool {
    let mapped = h * pair.point1.to_homogeneous();
    let off = mapped.xy() - pair.point2.coords * mapped.z;
    off.norm_squared() < (tolerance * mapped.z).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{RandomScene, example_seen};
    use crate::geometry::transfer_error;

    fn scene(depth: impl Fn(f64) -> f64) -> Vec<PointPair> {
        let seen = |t: f64| example_seen((t * 0.9).sin() * 2.0, (t * 1.7).cos() * 1.5, depth(t));
        (0..80).map(|k| seen(f64::from(k))).collect()
    }

    #[test]
    fn a_plane_is_recognised_and_depth_is_not() {
        let plane = scene(|t| 5.0 + 0.3 * (t * 0.9).sin());
        let share = |matches: &[PointPair]| {
            largest_plane(matches, 1.0, 0).map_or(0.0, |(_, most)| most as f64 / matches.len() as f64)
        };
        assert!(share(&plane) > 0.99);
        let deep = scene(|t| 5.0 + 2.0 * (t * 2.3).sin());
        assert!(share(&deep) < 0.5);
        assert!(share(&plane[..4]) < 0.01, "too few matches");
    }

    #[test]
    fn all_matches_of_a_plane_are_found_with_any_seed() {
        let mut random = RandomScene::new(4);
        let (wall, elsewhere) = (random.planar_pairs(40), random.pairs(25));
        let all: Vec<PointPair> = elsewhere.iter().chain(&wall).copied().collect();
        let truth = homography(&wall).unwrap();
        // Some of the other matches lie near the plane by chance.
        let on_wall = all.iter().filter(|m| transfer_error(&truth, m) < 0.5).count();
        assert!((40..46).contains(&on_wall), "{on_wall}");
        for seed in 0..5 {
            let (h, most) = largest_plane(&all, 0.5, seed).unwrap();
            assert_eq!(most, on_wall, "seed {seed}");
            assert!(wall.iter().all(|m| transfer_error(&h, m) < 0.5), "seed {seed}");
        }
        assert!(largest_plane(&wall[..7], 0.5, 0).is_none() && largest_plane(&wall[..8], 0.5, 0).is_some());
    }

    #[test]
    fn the_tolerance_limits_the_matches_of_a_plane() {
        let mut random = RandomScene::new(8);
        let wall = random.planar_pairs(60);
        let noisy = random.disturbed(&wall, 1.0);
        // The transfer error contains the noise of both images: √2 px in each coordinate. One in
        // 500 exceeds 5 px.
        let [loose, tight] =
            [5.0, 0.5].map(|tolerance| largest_plane(&noisy, tolerance, 0).map_or(0, |(_, most)| most));
        assert!(loose > 57 && tight < 30, "{loose} {tight} of 60");
    }
}
