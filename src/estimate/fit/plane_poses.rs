//! The two poses of a plane. The matches of a plane have two essential matrices (Hartley & Zisserman, §13.5; Faugeras &
//! Lustman 1988).

use nalgebra::Matrix3;

use super::plane::largest_plane;
use crate::camera::RelativePose;
use crate::geometry::{
    FundamentalMatrix, PointPair, point_equation, sampson_distance, solve_five, transfer_error,
};

/// Number of samples of five matches on the plane. Each has both solutions, up to noise.
const SAMPLES: usize = 24;
/// Least share of the matches on the plane that its other solution explains.
const EXPLAINED: f64 = 0.9;
/// Angle between two directions of a baseline beyond which they differ, radians: 5°, within which poses are usually
/// counted as right.
const DIFFERENT: f64 = 0.087;

/// Returns the other solution of the largest plane of `matches`, in pixels. `None` if there is none whose direction
/// differs from that of `pose`, or none with scene points in front of both cameras. `tolerance` is the largest error of
/// a right match, px.
pub(in crate::estimate) fn other_pose(
    pose: &RelativePose,
    calibrations: &[Matrix3<f64>; 2],
    matches: &[PointPair],
    tolerance: f64,
    seed: u64,
) -> Option<FundamentalMatrix> {
    let (h, _) = largest_plane(matches, tolerance, seed)?;
    let on_plane: Vec<PointPair> =
        matches.iter().filter(|m| transfer_error(&h, m) < tolerance).copied().collect();
    let inverses = [calibrations[0].try_inverse()?, calibrations[1].try_inverse()?];
    if on_plane.len() < 5 {
        return None;
    }
    let equations: Vec<_> = on_plane
        .iter()
        .map(|m| {
            let [a, b] = [inverses[0] * m.point1.to_homogeneous(), inverses[1] * m.point2.to_homogeneous()];
            point_equation([a.x / a.z, a.y / a.z, b.x / b.z, b.y / b.z])
        })
        .collect();
    let explains = |f: &FundamentalMatrix, m: &PointPair| sampson_distance(f, m) < tolerance;
    let share = |some: usize| some as f64 / on_plane.len() as f64;
    let mut best: Option<(f64, FundamentalMatrix)> = None;
    for sample in 0..SAMPLES {
        // One match of each fifth.
        let index = |fifth: usize| (fifth * SAMPLES + sample) * equations.len() / (5 * SAMPLES);
        for e in solve_five(&std::array::from_fn(|fifth| equations[index(fifth)])) {
            let matrix = inverses[1].transpose() * e * inverses[0];
            let Some(f) = FundamentalMatrix::from_rank_two(matrix) else { continue };
            let explained = share(on_plane.iter().filter(|m| explains(&f, m)).count());
            if explained < EXPLAINED || best.as_ref().is_some_and(|(most, _)| *most >= explained) {
                continue;
            }
            let Some(other) = RelativePose::from_fundamental(&f, calibrations, &on_plane) else {
                continue;
            };
            let seen = other.scene_points(calibrations, &on_plane);
            let is_in_front = share(seen.iter().flatten().count()) > 0.5;
            let apart = other.translation.angle(&pose.translation);
            if is_in_front && apart > DIFFERENT {
                best = Some((explained, f));
            }
        }
    }
    best.map(|(_, other)| other)
}
