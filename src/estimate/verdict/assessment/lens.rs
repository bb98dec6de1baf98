//! Test whether one homography with radial distortion explains the matches. Distortion moves points
//! towards the middle of the image or away from it, which looks like the parallax of a camera that
//! moves forward.

use nalgebra::{Matrix3, SMatrix, SVector, Vector2};

use crate::geometry::{Frame, PointPair};

type Normal = SMatrix<f64, 9, 9>;
type Right = SVector<f64, 9>;

/// Widths of the robust cost, in tolerances, one for each step. They shrink by at most a third at a
/// time, so that the fit first gains matches next to those explained by the homography alone.
const WIDTHS: [f64; 12] = [32.0, 24.0, 16.0, 12.0, 8.0, 6.0, 4.0, 3.0, 2.0, 1.5, 1.0, 1.0];
/// Number of examined matches, evenly spread over all. Their share is precise to 2 %.
const LOOKED_AT: usize = 500;

/// Homography with radial distortion: `x2 = p (1 + k |p|²)` with `p = H x1` (Hartley & Zisserman,
/// §7.4, first term). Coordinates are relative to the middle of each image, in units of half its
/// longer side.
struct BentPlane {
    h: Matrix3<f64>,
    k: f64,
}

impl BentPlane {
    /// Maps a point. Also returns the derivatives by the eight numbers of `H` and by `k`.
    fn mapped(&self, x: Vector2<f64>) -> Option<(Vector2<f64>, SMatrix<f64, 2, 9>)> {
        let a = x.push(1.0);
        let q = self.h * a;
        if q.z.abs() < 1e-9 {
            return None;
        }
        let p = q.xy() / q.z;
        let r2 = p.norm_squared();
        let by_p = nalgebra::Matrix2::identity() * (1.0 + self.k * r2) + p * p.transpose() * (2.0 * self.k);
        let mut derivatives = SMatrix::<f64, 2, 9>::zeros();
        for i in 0..8 {
            let (row, column) = (i / 3, i % 3);
            let by_h = match row {
                0 => Vector2::new(a[column], 0.0),
                1 => Vector2::new(0.0, a[column]),
                _ => -p * a[column],
            };
            derivatives.set_column(i, &(by_p * by_h / q.z));
        }
        derivatives.set_column(8, &(p * r2));
        Some((p * (1.0 + self.k * r2), derivatives))
    }
}

/// Returns the share of the matches that a homography with radial distortion explains within
/// `tolerance` px of image 2. The fit starts at the homography `h` of pixels. 0 if it fails.
pub(super) fn share_through_a_lens(
    matches: &[PointPair],
    h: &Matrix3<f64>,
    frames: [Frame; 2],
    tolerance: f64,
) -> f64 {
    let halves = frames.map(|frame| 0.5 * frame.longer_side());
    let middles = frames.map(|frame| frame.centre());
    let step = matches.len().div_ceil(LOOKED_AT).max(1);
    let seen: Vec<[Vector2<f64>; 2]> = matches
        .iter()
        .step_by(step)
        .map(|m| [(m.point1 - middles[0]) / halves[0], (m.point2 - middles[1]) / halves[1]])
        .collect();
    let pixels = |image: usize| {
        let (half, middle) = (halves[image], middles[image]);
        Matrix3::new(half, 0.0, middle.x, 0.0, half, middle.y, 0.0, 0.0, 1.0)
    };
    let Some(to2) = pixels(1).try_inverse() else { return 0.0 };
    let h = to2 * h * pixels(0);
    if h[(2, 2)].abs() < 1e-9 * h.amax() {
        return 0.0;
    }
    let mut bent = BentPlane { h: h / h[(2, 2)], k: 0.0 };
    let tolerance = tolerance / halves[1];
    for width in WIDTHS {
        let (mut normal, mut right) = (Normal::zeros(), Right::zeros());
        for [x1, x2] in &seen {
            let Some((at, derivatives)) = bent.mapped(*x1) else { continue };
            let residual = x2 - at;
            let weight = 1.0 / (1.0 + residual.norm_squared() / (width * tolerance).powi(2));
            normal += derivatives.transpose() * derivatives * weight;
            right += derivatives.transpose() * residual * weight;
        }
        let Some(change) = normal.cholesky().map(|c| c.solve(&right)) else { return 0.0 };
        for i in 0..8 {
            bent.h[(i / 3, i % 3)] += change[i];
        }
        bent.k += change[8];
    }
    let explained =
        |[x1, x2]: &&[Vector2<f64>; 2]| bent.mapped(*x1).is_some_and(|(at, _)| (x2 - at).norm() < tolerance);
    seen.iter().filter(explained).count() as f64 / seen.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::RandomScene;
    use crate::geometry::{homography, transfer_error};

    const FRAME: Frame = Frame { width: 768, height: 576 };

    #[test]
    fn a_plane_through_another_lens_is_explained_and_a_scene_is_not() {
        let turn = Matrix3::new(1.02, -0.05, 12.0, 0.04, 0.99, -8.0, 1e-5, -2e-5, 1.0);
        let bent = |k: f64| -> Vec<PointPair> {
            let mut scene = RandomScene::new(3);
            let points = scene.pairs(200).into_iter().map(|pair| pair.point1);
            points
                .map(|x| {
                    let q = turn * x.to_homogeneous();
                    let d = (nalgebra::Point2::new(q.x / q.z, q.y / q.z) - FRAME.centre()) / 384.0;
                    let point2 = FRAME.centre() + d * ((1.0 + k * d.norm_squared()) * 384.0);
                    PointPair { point1: x, point2 }
                })
                .collect()
        };
        for k in [-0.15, 0.0, 0.08, 0.15] {
            let matches = bent(k);
            let middle: Vec<PointPair> =
                matches.iter().filter(|m| (m.point1 - FRAME.centre()).norm() < 150.0).copied().collect();
            let h = homography(&middle).unwrap();
            let share = share_through_a_lens(&matches, &h, [FRAME; 2], 1.0);
            assert!(share > 0.98, "k {k}: {share}");
        }
        let off = bent(0.15).iter().filter(|m| transfer_error(&turn, m) > 1.0).count();
        assert!(off > 50, "the lens is not needed: {off}");
        let mut scene = RandomScene::new(4);
        let matches = scene.pairs(200);
        let h = homography(&matches).unwrap();
        let share = share_through_a_lens(&matches, &h, [FRAME; 2], 1.0);
        assert!(share < 0.5, "{share}");
    }
}
