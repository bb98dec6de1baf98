//! Settings of a sub-pixel alignment.

use std::ops::Range;

use super::patch::HALF;

/// Largest half side of an aligned patch, px.
pub(super) const LARGEST: usize = 10;

/// Settings of an alignment.
#[derive(Debug)]
pub(crate) struct Alignment {
    /// Pixels of the patch on each side of its centre.
    pub(super) half: usize,
    pub(super) iterations: usize,
    /// Convergence threshold: a shorter step ends the iteration, px.
    pub(super) settled: f64,
    /// Whether a patch that has not converged is rejected.
    pub(super) must_settle: bool,
    /// Largest accepted distance from the start, px.
    pub(super) largest_move: f64,
    /// Accepted determinants of the affine map; `None` accepts all.
    pub(super) determinants: Option<Range<f64>>,
    /// Minimum fraction of the samples inside both images; samples outside, or where there is no
    /// picture, are ignored. `None` keeps all samples and repeats the border intensities outside.
    pub(super) least_inside: Option<f64>,
    pub(super) hold: Hold,
    /// Grey level subtracted from the intensities. `unit` is the unit of offsets from the centre,
    /// px. Both condition the equations.
    pub(super) middle: f64,
    pub(super) unit: f64,
}

/// Regularisation of the affine map.
#[derive(Debug)]
pub(super) enum Hold {
    /// Penalty on each step of the affine map, squared grey levels.
    Step(f64),
    /// Penalty on the distance from the start, as a fraction of the sum of squared image gradients.
    Start(f64),
}

impl Alignment {
    /// Settings for pairs of similar corners, from starts within about a pixel. The patch is larger than
    /// the compared one, because the error of a position falls with the side of the patch.
    pub(crate) const STRICT: Self = Self {
        half: LARGEST,
        iterations: 25,
        settled: 0.01,
        must_settle: true,
        largest_move: 1.5,
        determinants: Some(0.2..4.0),
        least_inside: None,
        // About the texture of one grey level per pixel over a whole patch.
        hold: Hold::Step(500.0),
        middle: 0.0,
        unit: HALF as f64,
    };

    /// Settings for any place of an image, borders included, from starts found at a coarser level.
    pub(crate) const LENIENT: Self = Self {
        half: HALF,
        iterations: 8,
        settled: 0.02,
        must_settle: false,
        largest_move: 2.5,
        determinants: None,
        least_inside: Some(LEAST_INSIDE),
        hold: Hold::Start(0.1),
        middle: 128.0,
        unit: 1.0,
    };
}

/// Minimum fraction of a patch inside the image. A patch in the corner of an image is a little more
/// than a quarter inside.
pub(crate) const LEAST_INSIDE: f64 = 0.25;
