//! Covariant local features: points with their own scale and orientation, detected again in a
//! picture that is rotated, scaled or taken from elsewhere.
//!
//! 1. **Detection**: extrema of the difference of Gaussians over position and scale, to a fraction
//!    of a pixel.
//! 2. **Orientation** from the surrounding gradients; several orientations if several are strong.
//! 3. **Description** in that local frame: 4 × 4 histograms of gradients, square-rooted
//!    (`RootSIFT`).
//! 4. **Matching**: mutual nearest neighbours with their ratio, distinctive matches first.
//!
//! # Sources
//! - D. G. Lowe, "Distinctive image features from scale-invariant keypoints", IJCV 60(2), 2004.
//! - R. Arandjelović, A. Zisserman, "Three things everyone should know to improve object
//!   retrieval", CVPR 2012.
//! - I. Rey-Otero, M. Delbracio, "Anatomy of the SIFT method", IPOL 4, 2014.
//!
//! Two differences from Lowe make features depend less on their position between levels and pixels.
//! Gradients are differences over a fixed fraction of the feature's scale, not over one pixel of
//! its octave. Orientation votes are shared by two bins.
//!
//! # Pitfalls
//! - The error of a position is a few tenths of a pixel times half the scale, so large features are
//!   less accurate.
//! - Few features repeat between views that differ by more than about 40° of slant, because the
//!   local frames are similarities, not affine maps. [`find_slanted_features`] detects features of
//!   slanted views, at about three times the cost.

mod descriptor;
mod extrema;
mod matching;
mod neighbours;
mod scale_space;
mod slanted;

use nalgebra::{Matrix2, Rotation2};
use rayon::prelude::*;

use crate::geometry::{Point, Vector};
use crate::image::GrayPlane;
pub use descriptor::Descriptor;
use extrema::{Extremum, find_extrema};
pub(crate) use matching::KnownNeighbours;
pub use matching::{FeatureMatch, match_candidates, match_features, without_repeats};
use scale_space::{INTERVALS, Octave, for_each_octave, sigma_at};
pub use slanted::{FeatureViews, find_slanted_features};

/// Standard deviation of a feature's position, in units of its scale.
pub(crate) const SIGMA_PER_SCALE: f64 = 0.25;

/// An image point with its own size and orientation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Position, px.
    pub position: Point,
    /// Standard deviation of the blob, px.
    pub scale: f64,
    /// Dominant gradient direction, radians from x towards y, 0 ≤ θ < 2π.
    pub orientation: f64,
    /// Compression and stretch of a feature of a slanted view: symmetric, determinant 1. The
    /// identity for a round feature. The local frame is `shape · R(orientation) · scale`.
    pub shape: Matrix2<f64>,
    /// Contrast of the blob: difference of Gaussians, grey levels.
    pub response: f64,
}

impl Feature {
    /// Returns the first axis of the local frame, px.
    pub fn axis(&self) -> Vector {
        let (sin, cos) = self.orientation.sin_cos();
        self.shape * Vector::new(cos, sin) * self.scale
    }

    /// Returns the affine map from offsets around this feature to offsets around a matching feature
    /// of another picture.
    pub fn affine_to(&self, other: &Self) -> Matrix2<f64> {
        // The adjugate inverts a symmetric matrix of determinant 1.
        let shape = &self.shape;
        let inverse = Matrix2::new(shape.m22, -shape.m12, -shape.m12, shape.m11);
        let turn = Rotation2::new(other.orientation - self.orientation);
        other.shape * turn.matrix() * inverse * (other.scale / self.scale)
    }
}

/// Features of one picture with their descriptors, in the order in which they were found:
/// [`find_features`] gives the strongest first, [`find_slanted_features`] one view after another.
#[derive(Debug, Clone, Default)]
pub struct FeatureSet {
    features: Vec<Feature>,
    descriptors: Vec<Descriptor>,
}

impl FeatureSet {
    /// Returns the features, in the order of the descriptors.
    pub fn features(&self) -> &[Feature] {
        &self.features
    }

    /// Returns the descriptor of each feature.
    pub fn descriptors(&self) -> &[Descriptor] {
        &self.descriptors
    }

    /// Returns the number of features.
    pub fn len(&self) -> usize {
        self.features.len()
    }

    /// Returns whether the set is empty.
    pub fn is_empty(&self) -> bool {
        self.features.is_empty()
    }

    /// Keeps the features that satisfy a condition.
    pub(crate) fn retain(&mut self, is_kept: impl Fn(&Feature) -> bool) {
        let kept: Vec<bool> = self.features.iter().map(is_kept).collect();
        let mut flags = kept.iter();
        self.features.retain(|_| *flags.next().unwrap_or(&false));
        let mut flags = kept.iter();
        self.descriptors.retain(|_| *flags.next().unwrap_or(&false));
    }

    /// Keeps the features whose blob shows nothing but picture.
    fn retain_clear(&mut self, plane: &GrayPlane) {
        /// Radius of a blob, in units of its scale.
        const BLOB: f64 = 3.0;
        self.retain(|feature| plane.is_clear(feature.position, BLOB * feature.scale));
    }

    /// Appends the features of another set.
    pub(crate) fn append(&mut self, mut other: Self) {
        self.features.append(&mut other.features);
        self.descriptors.append(&mut other.descriptors);
    }

    pub(crate) fn push(&mut self, feature: Feature, descriptor: Descriptor) {
        self.features.push(feature);
        self.descriptors.push(descriptor);
    }
}

/// Parameters of feature detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureParameters {
    /// Maximum number of features. The strongest are kept.
    pub most: usize,
    /// Minimum difference of Gaussians, grey levels.
    pub contrast: f64,
    /// Maximum ratio of the principal curvatures. Edges exceed it.
    pub edge_ratio: f64,
    /// Maximum number of pixels of the first octave. The first octave has twice the size of the
    /// picture if that is within the limit. Otherwise it has the picture's own size, half of it and
    /// so on. Larger pictures thus take no longer.
    pub largest_octave: usize,
}

impl Default for FeatureParameters {
    fn default() -> Self {
        // Half of Lowe's contrast. Weak features repeat less often, but matches are weighted by
        // their ratio, and more matches yield more correct geometries.
        Self { most: 8000, contrast: 1.8, edge_ratio: 10.0, largest_octave: 4_000_000 }
    }
}

/// Finds the features of a picture, strongest first. The result does not depend on the number of
/// threads.
pub fn find_features(plane: &GrayPlane, parameters: &FeatureParameters) -> FeatureSet {
    let mut octaves: Vec<Octave> = Vec::new();
    let mut extrema: Vec<Extremum> = Vec::new();
    for_each_octave(plane, parameters.largest_octave, |mut octave| {
        extrema.extend(find_extrema(&octave, octaves.len(), parameters.contrast, parameters.edge_ratio));
        // Features are described at the inner levels only.
        octave.levels.truncate(INTERVALS + 1);
        octaves.push(octave);
    });
    // A stable sort keeps the order of equal features.
    extrema.sort_by(|a, b| b.response.total_cmp(&a.response));
    extrema.truncate(parameters.most);
    let described: Vec<Vec<(Feature, Descriptor)>> =
        extrema.par_iter().map(|extremum| described(&octaves[extremum.octave], extremum)).collect();
    let mut set = FeatureSet::default();
    for (feature, descriptor) in described.into_iter().flatten().take(parameters.most) {
        set.push(feature, descriptor);
    }
    set.retain_clear(plane);
    set
}

/// Returns the features at an extremum, one for each orientation.
fn described(octave: &Octave, extremum: &Extremum) -> Vec<(Feature, Descriptor)> {
    let plane = &octave.levels[(extremum.level.round() as usize).clamp(1, INTERVALS)];
    let [x, y] = extremum.position;
    let centre = Point::new(x, y);
    let sigma = sigma_at(extremum.level);
    let describe = |orientation: f64| {
        let frame = Rotation2::new(orientation).matrix() * sigma;
        let feature = Feature {
            position: centre * octave.spacing,
            scale: sigma * octave.spacing,
            orientation,
            shape: Matrix2::identity(),
            response: extremum.response,
        };
        Some((feature, descriptor::describe(plane, centre, &frame)?))
    };
    descriptor::orientations(plane, centre, sigma).into_iter().filter_map(describe).collect()
}

#[cfg(test)]
mod tests;
