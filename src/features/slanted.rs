//! Features of a picture as it looks at a slant (after Morel & Yu, "ASIFT: a new framework for fully affine invariant image
//! comparison", SIAM J. Imaging Sciences 2(2), 2009).
//!
//! What a camera sees at a slant is compressed in one direction, and the features of [`super::find_features`], whose frames
//! are turned and scaled only, are not found again there. Here the picture is compressed to half in each of four
//! directions, features are found in what that gives, and their places and frames are told in the picture itself: of two
//! pictures that differ by compressions up to four in any direction, some two views are nearly alike.
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

/// How a picture is looked at for its features.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeatureViews {
    /// As it is.
    Frontal,
    /// As it is, and compressed in several directions, as things look at a slant.
    Slanted,
}

/// Directions of compression, `k · π/4`.
const DIRECTIONS: usize = 4;
/// Pixels of a row of the turned picture that become one of the view.
const COMPRESSION: usize = 2;
/// Smoothing along the row before pixels are dropped: 0.8 √(t² − 1) px for a compression by t (ASIFT, section 4.2).
const SMOOTHING: f64 = 1.385_640_646;
/// The kernel reaches this far, px.
const REACH: usize = 4;

/// A picture compressed in one direction.
struct Slant {
    /// Turns offsets in the picture into offsets in the turned one.
    turn: Rotation2<f64>,
    /// The middle of the picture, and that of the turned picture, px.
    centres: [Point; 2],
    /// Size of the turned picture.
    turned: Frame,
}

impl Slant {
    fn new(frame: Frame, angle: f64) -> Self {
        let turn = Rotation2::new(-angle);
        let (sin, cos) = (angle.sin().abs(), angle.cos().abs());
        let [width, height] = [frame.right(), frame.bottom()];
        let side = |length: f64| (length - 1e-9).ceil() as usize + 1;
        let turned = Frame::new(side(cos * width + sin * height), side(sin * width + cos * height));
        let middle = |frame: Frame| Point::new(0.5 * frame.right(), 0.5 * frame.bottom());
        Self { turn, centres: [middle(frame), middle(turned)], turned }
    }

    /// What the picture looks like.
    fn view(&self, plane: &GrayPlane) -> GrayPlane {
        let weight = |d: usize| (-0.5 * (d as f64 / SMOOTHING).powi(2)).exp();
        let sum = weight(0) + 2.0 * (1..=REACH).map(weight).sum::<f64>();
        let kernel: [f32; REACH + 1] = std::array::from_fn(|d| (weight(d) / sum) as f32);
        let width = self.turned.width;
        let frame = Frame::new(width.div_ceil(COMPRESSION), self.turned.height);
        GrayPlane::from_strips(frame, 1, |v, out| {
            // The border goes on to all sides.
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

    /// The place of a point of the turned picture.
    fn in_picture(&self, point: Point) -> Point {
        self.centres[0] + self.turn.inverse() * (point - self.centres[1])
    }

    /// A feature of the view as one of the picture.
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

/// The features of a picture compressed in each of four directions, at most `most` in all. The same on any number of
/// threads.
pub fn find_slanted_features(plane: &GrayPlane, parameters: &FeatureParameters) -> FeatureSet {
    let frame = plane.frame();
    // Together they may take a few times as long as the picture as it is.
    let (most, largest_octave) = (parameters.most / DIRECTIONS, parameters.largest_octave / 2);
    let parameters = FeatureParameters { most, largest_octave, ..*parameters };
    let mut all = FeatureSet::default();
    // One after the other, each on all threads: of a large picture a view is large, too.
    for k in 0..DIRECTIONS {
        let slant = Slant::new(frame, k as f64 * FRAC_PI_4);
        let mut set = find_features(&slant.view(plane), &parameters);
        for feature in &mut set.features {
            *feature = slant.feature_in_picture(feature);
        }
        set.retain(|feature| frame.contains(feature.position));
        all.append(set);
    }
    all
}
