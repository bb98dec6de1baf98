//! Search for the simplest change after which a geometry fits.

use super::cameras::DecomposedCamera;
use super::change::{Affected, CameraChange, Change, Mirror, undistorted};
use super::significance::significance;
use super::{FittingChange, GivenGeometry, Reference, residuals};
use crate::convention::Reading;
use crate::geometry::{
    Camera, FundamentalMatrix, Matrix9, PointPair, grid_minimum, symmetric_epipolar_distance,
};

/// Each fitted number of a change must lower the distance by this share to be worth it: a wrong kind
/// of change with one more number often fits a little better.
const WORTH: f64 = 0.3;
/// Factors that are tried, octaves to either side.
const OCTAVES: f64 = 3.0;
/// Steps in an octave. The cost falls from 4 % beside the right factor on.
const STEPS: f64 = 16.0;
/// Largest coefficient of distortion that is tried: at 0.6, corners move by 60 % of their distance.
const MOST_BENT: f64 = 0.6;
/// Step between coefficients.
const BENT_STEP: f64 = 0.02;
/// Largest first step of a move, as a share of the longer side.
const MOVE: f64 = 0.25;
/// Longest move, as a share of the longer side: half an image cropped away. Any longer move only stands
/// for another mistake.
const MOST_MOVED: f64 = 0.5;
/// Last step of a move, px.
const LAST_MOVE: f64 = 0.02;
/// Largest number of matches for fitting a change.
const FEW: usize = 200;

/// Returns the simplest change that makes the geometry fit within `limit` px; `None` if no change
/// does. A change with more fitted numbers must fit clearly better.
pub(super) fn simplest(given: &GivenGeometry, reference: &Reference, limit: f64) -> Option<FittingChange> {
    let found = discrete(given, reference).into_iter().chain(fitted(given, reference, limit));
    let is_possible = |change: &Change| match change {
        Change::Moved { x, y, .. } => x.hypot(*y) < MOST_MOVED * reference.frames[0].longer_side(),
        _ => true,
    };
    found
        .filter(|found| found.median <= limit && is_possible(&found.change))
        .map(|found| (found.median * (1.0 + WORTH * found.change.parameters() as f64), found))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, found)| found)
}

/// Returns the changes without fitted numbers, the more specific ones first.
fn discrete(given: &GivenGeometry, reference: &Reference) -> Vec<FittingChange> {
    let GivenGeometry { fundamental, cameras } = given;
    let parts =
        cameras.as_ref().and_then(|[a, b]| Some([DecomposedCamera::new(a)?, DecomposedCamera::new(b)?]));
    let of_cameras = CameraChange::ALL.into_iter().filter_map(|mistake| {
        let [a, b] = mistake.apply(parts.as_ref()?);
        let changed = Camera::fundamental(&a.composed()?, &b.composed()?)?;
        Some((Change::Cameras { mistake }, changed))
    });
    let mut of_pixels = Vec::new();
    for origin in [0.0, 0.5, 1.0] {
        for (transposed, axes_exchanged) in [(false, false), (true, false), (false, true), (true, true)] {
            let reading = Reading { transposed, axes_exchanged, origin, scale: 1.0 };
            if reading.changes() > 0 {
                of_pixels.push(Change::Convention { reading });
            }
        }
    }
    for images in Affected::ALL {
        of_pixels.extend(Mirror::ALL.map(|mirror| Change::Mirrored { images, mirror }));
    }
    of_pixels.extend(half_pixels());
    let of_pixels = of_pixels
        .into_iter()
        .filter_map(|change| Some((change, change.apply(fundamental, reference.frames)?)));
    let measured = |(change, changed): (Change, FundamentalMatrix)| FittingChange {
        change,
        median: reference.distance(&changed),
        fundamental: Some(changed),
    };
    of_cameras.chain(of_pixels).map(measured).collect()
}

/// Returns the shifts of the pixel origin that are no reading of the matrix: of one image, or
/// opposite in both.
fn half_pixels() -> impl Iterator<Item = Change> {
    let one = [Affected::Image1, Affected::Image2]
        .into_iter()
        .flat_map(|images| [0.5, -0.5].map(|offset| Change::HalfPixel { images, offset }));
    one.chain([Change::HalfPixel { images: Affected::Both, offset: -0.5 }])
}

/// Returns half a pixel that brings a geometry within the covariance of the reference. Half a pixel moves
/// lines by less than the usual limit, so only the covariance shows it.
pub(super) fn half_pixel(
    given: &FundamentalMatrix,
    reference: &Reference,
    covariance: &Matrix9,
) -> Option<FittingChange> {
    let reading = Reading { transposed: false, axes_exchanged: false, origin: 0.5, scale: 1.0 };
    let measured = |change: Change| {
        let changed = change.apply(given, reference.frames)?;
        let left = significance(&changed, &reference.fundamental, covariance, reference.frames)?;
        let median = reference.distance(&changed);
        (!left.is_significant)
            .then_some((left.chi_square, FittingChange { change, median, fundamental: Some(changed) }))
    };
    let changes = [Change::Convention { reading }].into_iter().chain(half_pixels());
    let best = changes.filter_map(measured).min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, found)| found)
}

/// Returns the changes with one or two fitted numbers.
fn fitted(given: &GivenGeometry, reference: &Reference, limit: f64) -> Vec<FittingChange> {
    let step = reference.matches.len().div_ceil(FEW);
    let few: Vec<PointPair> = reference.matches.iter().step_by(step).copied().collect();
    let (f, frames) = (&given.fundamental, reference.frames);
    let cost = |f: &FundamentalMatrix, pair: &PointPair| {
        (symmetric_epipolar_distance(f, pair) / (0.5 * limit)).powi(2).ln_1p()
    };
    let of_change = |change: Change| match change {
        Change::Distortion { k } => few.iter().map(|pair| cost(f, &undistorted(pair, k, frames))).sum(),
        _ => change
            .apply(f, frames)
            .map_or(f64::INFINITY, |changed| few.iter().map(|pair| cost(&changed, pair)).sum::<f64>()),
    };
    let mut changes = vec![Change::Distortion {
        k: grid_minimum(|k| of_change(Change::Distortion { k }), (-MOST_BENT, MOST_BENT), BENT_STEP),
    }];
    for images in Affected::ALL {
        let octaves = |of: &dyn Fn(f64) -> Change| {
            grid_minimum(|octaves| of_change(of(octaves.exp2())), (-OCTAVES, OCTAVES), 1.0 / STEPS).exp2()
        };
        let resized = |factor: f64| Change::Resized { images, factor };
        changes.push(resized(octaves(&resized)));
        let focal = |factor: f64| Change::FocalLength { images, factor };
        changes.push(focal(octaves(&focal)));
        let moved = |[x, y]: [f64; 2]| Change::Moved { images, x, y };
        let first = MOVE * frames[0].longer_side().max(frames[1].longer_side());
        changes.push(moved(compass(first, |by| of_change(moved(by)))));
    }
    let measured = |change: Change| {
        if let Change::Distortion { k } = change {
            let pairs: Vec<PointPair> =
                reference.matches.iter().map(|pair| undistorted(pair, k, frames)).collect();
            return Some(FittingChange { change, median: residuals(f, &pairs).median, fundamental: None });
        }
        let changed = change.apply(f, frames)?;
        let median = reference.distance(&changed);
        Some(FittingChange { change, median, fundamental: Some(changed) })
    };
    changes.into_iter().filter_map(measured).collect()
}

/// Returns the minimum of a function of two numbers near zero, by a compass search. The search
/// steps in the best of eight directions while a step helps, and halves the step when none does.
fn compass(first: f64, cost: impl Fn([f64; 2]) -> f64) -> [f64; 2] {
    let mut at = [0.0, 0.0];
    let (mut least, mut step) = (cost(at), first);
    while step > LAST_MOVE {
        let around = (0..9).filter(|k| *k != 4).map(|k| {
            let by = [f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0];
            [at[0] + step * by[0], at[1] + step * by[1]]
        });
        let best = around.map(|near| (cost(near), near)).min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((lower, near)) if lower < least => (least, at) = (lower, near),
            _ => step *= 0.5,
        }
    }
    at
}
