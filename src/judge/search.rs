//! Search for the simplest change after which a geometry fits.

use super::cameras::DecomposedCamera;
use super::change::{Affected, CameraChange, Change, Mirror, undistorted};
use super::significance::significance;
use super::{FittingChange, GivenGeometry, Reference, residuals};
use crate::convention::Reading;
use crate::geometry::{
    Camera, FundamentalMatrix, Matrix9, PointPair, grid_minimum, symmetric_epipolar_distance,
};

/// Share by which each fitted number of a change must lower the distance. A wrong kind of change with
/// one more number often fits a little better.
const WORTH: f64 = 0.3;
/// Range of the factors tried, octaves to either side of 1.
const OCTAVES: f64 = 3.0;
/// Steps per octave. The cost falls towards the right factor only within 4 % of it.
const STEPS: f64 = 16.0;
/// Largest coefficient of distortion tried. At 0.6, corners move by 60 % of their distance from the
/// middle.
const MOST_BENT: f64 = 0.6;
/// Step between coefficients of distortion.
const BENT_STEP: f64 = 0.02;
/// Largest first step of a move, as a share of the longer side.
const MOVE: f64 = 0.25;
/// Longest move, as a share of the longer side: half an image cropped away. A longer move hides another
/// mistake.
const MOST_MOVED: f64 = 0.5;
/// Smallest step of a move, px.
const LAST_MOVE: f64 = 0.02;
/// Largest number of matches on which a change is fitted.
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
    let readings = Reading::of_same_size().filter(|reading| reading.changes() > 0);
    let mut of_pixels: Vec<Change> = readings.map(|reading| Change::Convention { reading }).collect();
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

/// Returns the shifts by half a pixel that no [`Reading`] describes: of one image, or in the opposite
/// direction in both.
fn half_pixels() -> impl Iterator<Item = Change> {
    let one = [Affected::Image1, Affected::Image2]
        .into_iter()
        .flat_map(|images| [0.5, -0.5].map(|offset| Change::HalfPixel { images, offset }));
    one.chain([Change::HalfPixel { images: Affected::Both, offset: -0.5 }])
}

/// Returns the shift by half a pixel after which the geometry differs from the reference by no more
/// than the covariance allows. Such a shift moves lines by less than the usual limit, so only the
/// covariance shows it.
pub(super) fn half_pixel(
    given: &FundamentalMatrix,
    reference: &Reference,
    covariance: &Matrix9,
) -> Option<FittingChange> {
    let reading = Reading { origin: 0.5, ..Reading::AS_READ };
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
