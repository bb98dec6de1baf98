//! Features of slanted views of a picture (after Morel & Yu, "ASIFT: a new framework for fully
//! affine invariant image comparison", SIAM J. Imaging Sciences 2(2), 2009).
//!
//! A slanted surface appears compressed in one direction. The features of [`super::find_features`]
//! do not repeat there, because their local frames are similarities. Here the picture is compressed
//! to half in each of four directions. Features are detected in each view, and their positions and
//! frames are mapped back to the picture. Pictures that differ by a compression up to four in any
//! direction then have two similar views.
//!
//! ```text
//!     picture = Rᵀ D⁻¹ view + centre,   R a turn by −φ, D = diag(1/2, 1)
//!     frame   = Rᵀ D⁻¹ · R(θ) σ = S · R(θ + φ) σ,   S = Rᵀ D⁻¹ R symmetric
//! ```

use std::f64::consts::{FRAC_PI_4, SQRT_2, TAU};

use nalgebra::{Matrix2, Rotation2};

use super::{Feature, FeatureParameters, FeatureSet, find_features};
use crate::geometry::{Frame, Point, Vector};
use crate::image::GrayPlane;

/// Views of a picture in which features are detected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeatureViews {
    /// The picture as it is.
    Frontal,
    /// The picture as it is, and the picture compressed in several directions.
    Slanted,
}

/// Number of compression directions, `k · π/4`.
const DIRECTIONS: usize = 4;
/// Compression factor along the rows of the rotated picture.
const COMPRESSION: usize = 2;
/// Smoothing along a row before decimation: 0.8 √(t² − 1) px for a compression by t (ASIFT, section
/// 4.2).
const SMOOTHING: f64 = 1.385_640_646;
/// Radius of the smoothing kernel, px.
const REACH: usize = 4;

/// A view of a picture compressed in one direction.
struct Slant {
    /// Rotation from offsets in the picture to offsets in the rotated picture.
    turn: Rotation2<f64>,
    /// Centres of the picture and of the rotated picture, px.
    centres: [Point; 2],
    /// Size of the rotated picture.
    turned: Frame,
}

impl Slant {
    fn new(frame: Frame, angle: f64) -> Self {
        let turn = Rotation2::new(-angle);
        let (sin, cos) = (angle.sin().abs(), angle.cos().abs());
        let [width, height] = [frame.right(), frame.bottom()];
        let side = |length: f64| (length - 1e-9).ceil() as usize + 1;
        let turned = Frame::new(side(cos * width + sin * height), side(sin * width + cos * height));
        Self { turn, centres: [frame.centre(), turned.centre()], turned }
    }

    /// Returns the compressed view of the picture.
    fn view(&self, plane: &GrayPlane) -> GrayPlane {
        let weight = |d: usize| (-0.5 * (d as f64 / SMOOTHING).powi(2)).exp();
        let sum = weight(0) + 2.0 * (1..=REACH).map(weight).sum::<f64>();
        let kernel: [f32; REACH + 1] = std::array::from_fn(|d| (weight(d) / sum) as f32);
        let width = self.turned.width;
        let frame = Frame::new(width.div_ceil(COMPRESSION), self.turned.height);
        GrayPlane::from_strips(frame, 1, |v, out| {
            // Border pixels repeat on all sides.
            let row: Vec<f32> = (0..width + 2 * REACH)
                .map(|u| plane.sample(self.in_picture(Point::new(u as f64 - REACH as f64, v as f64))))
                .collect();
            for (k, out) in out.iter_mut().enumerate() {
                let at = k * COMPRESSION + REACH;
                *out = kernel[0] * row[at]
                    + (1..=REACH).map(|d| kernel[d] * (row[at - d] + row[at + d])).sum::<f32>();
            }
        })
    }

    /// Maps a point of the rotated picture to the picture.
    fn in_picture(&self, point: Point) -> Point {
        self.centres[0] + self.turn.inverse() * (point - self.centres[1])
    }

    /// Maps a feature of the view to the picture.
    fn feature_in_picture(&self, feature: &Feature) -> Feature {
        let compression = COMPRESSION as f64;
        let stretch = Matrix2::from_diagonal(&Vector::new(compression, 1.0));
        let turn = self.turn.matrix();
        let [x, y] = [compression * feature.position.x, feature.position.y];
        Feature {
            position: self.in_picture(Point::new(x, y)),
            scale: feature.scale * SQRT_2,
            orientation: (feature.orientation - self.turn.angle()).rem_euclid(TAU),
            shape: turn.transpose() * stretch * turn / SQRT_2,
            ..*feature
        }
    }
}

/// Finds the features of a picture compressed in each of four directions, at most `most` in total.
/// The result does not depend on the number of threads.
pub fn find_slanted_features(plane: &GrayPlane, parameters: &FeatureParameters) -> FeatureSet {
    let frame = plane.frame();
    // The limits keep the time of all views together to a few times that of the picture itself.
    let (most, largest_octave) = (parameters.most / DIRECTIONS, parameters.largest_octave / 2);
    let parameters = FeatureParameters { most, largest_octave, ..*parameters };
    let mut all = FeatureSet::default();
    // One view at a time, each on all threads, because views of a large picture are large.
    for k in 0..DIRECTIONS {
        let slant = Slant::new(frame, k as f64 * FRAC_PI_4);
        let mut set = find_features(&slant.view(plane), &parameters);
        for feature in &mut set.features {
            *feature = slant.feature_in_picture(feature);
        }
        set.retain(|feature| frame.contains(feature.position));
        set.retain_clear(plane);
        all.append(set);
    }
    all
}
