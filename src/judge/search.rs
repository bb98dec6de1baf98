//! Search for the simplest change after which a geometry fits.

use super::calibration::CalibrationChange;
use super::change::{Affected, CameraChange, Change, Mirror, undistorted};
use super::contest::Contest;
use super::significance::significance;
use super::{FittingChange, GivenGeometry, Reference, looks_essential, residuals};
use crate::convention::Reading;
use crate::geometry::{
    Camera, Frame, FundamentalMatrix, Matrix9, PointPair, grid_minimum, median, symmetric_epipolar_distance,
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
/// Difference between the distances of a match after two changes, as a share of the noise, below which the
/// changes have the same effect.
const SAME: f64 = 0.5;
/// Cost of a match that a calibration does not explain: a hundred times the limit away.
const FAR_COST: f64 = 10.6;
/// Places that a change may win because it was fitted: the numbers of a fundamental matrix, which no
/// change exceeds.
const FREEDOM: usize = 7;
/// Largest number of matches on which a change is fitted.
const FEW: usize = 200;

/// A change, with the distances of all matches from the lines after it.
struct Candidate {
    found: FittingChange,
    /// Symmetric epipolar distances of the matches of the reference, px.
    off: Vec<f64>,
}

/// Returns the change that makes the geometry fit within `limit` px; `None` if no change does, and if the
/// images do not show clearly which one is right. A change with more fitted numbers must fit clearly better.
pub(super) fn clearest(given: &GivenGeometry, reference: &Reference, limit: f64) -> Option<FittingChange> {
    let mut all = discrete(given, reference);
    all.extend(fitted(given, reference, limit));
    all.extend(of_calibration(given, reference, limit));
    all.retain(|one| match one.found.change {
        Change::Moved { x, y, .. } => x.hypot(y) < MOST_MOVED * reference.frames[0].longer_side(),
        _ => true,
    });
    let cost = |one: &Candidate| one.found.median * (1.0 + WORTH * one.found.change.parameters() as f64);
    let fits = |one: &&Candidate| one.found.median <= limit;
    let best = all.iter().filter(fits).min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
    let is_clear = all.iter().all(|other| best.is_same(other, reference) || best.is_clear(other, reference));
    let is_determined = reference.has_epipoles || best.found.change.keeps_epipoles();
    (is_clear && is_determined).then_some(best.found)
}

/// Returns whether the witnesses refute a geometry by its own change: clearly more places are explained by the
/// geometry after the change alone than by the geometry as it is alone. The change may be right where the
/// reference is not, for lines that are curves in the images.
pub(super) fn refutes(
    found: &FittingChange,
    given: &GivenGeometry,
    reference: &Reference,
    limit: f64,
) -> Option<bool> {
    let FittingChange { change, fundamental, .. } = found;
    let after = distances(*change, fundamental.as_ref(), given, reference.frames, reference.witnesses)?;
    let votes = reference.witnesses.iter().zip(after).map(|(pair, after)| {
        let before = symmetric_epipolar_distance(&given.fundamental, pair);
        (pair.point1, i32::from(after <= limit) - i32::from(before <= limit))
    });
    Some(Contest::of(votes, reference.frames[0]).first_wins(FREEDOM))
}

/// Returns the distances of matches from the lines of a geometry after a change with this `F`: `None` for a
/// change that moves the matches, because their lines are curves in the images.
fn distances(
    change: Change,
    changed: Option<&FundamentalMatrix>,
    given: &GivenGeometry,
    frames: [Frame; 2],
    matches: &[PointPair],
) -> Option<Vec<f64>> {
    let of = |f: &FundamentalMatrix, pair: PointPair| symmetric_epipolar_distance(f, &pair);
    match change {
        Change::Distortion { k } => {
            let f = &given.fundamental;
            Some(matches.iter().map(|pair| of(f, undistorted(pair, k, frames))).collect())
        }
        Change::Calibration(change) => {
            let calibration = given.calibration.as_ref()?;
            let read = calibration.read(change)?;
            let f = read.fundamental()?;
            let originals = calibration.originals(matches);
            let moved = originals.iter().map(|pair| read.undistorted(pair.as_ref()?));
            Some(moved.map(|pair| pair.map_or(f64::INFINITY, |pair| of(&f, pair))).collect())
        }
        _ => changed.map(|f| matches.iter().map(|pair| of(f, *pair)).collect()),
    }
}

impl Candidate {
    /// Measures a change after which the geometry has this `F`, as in [`distances`].
    fn new(
        change: Change,
        changed: Option<FundamentalMatrix>,
        given: &GivenGeometry,
        reference: &Reference,
    ) -> Option<Self> {
        let off = distances(change, changed.as_ref(), given, reference.frames, reference.matches)?;
        let median = changed.map_or_else(|| median(off.iter().copied()), |f| reference.distance(&f));
        Some(Self { found: FittingChange { change, median, fundamental: changed }, off })
    }

    /// Returns whether both changes are one mistake, or have the same effect to within the noise of the matches.
    fn is_same(&self, other: &Self, reference: &Reference) -> bool {
        if self.found.change.is_like(&other.found.change) {
            return true;
        }
        let apart = self.off.iter().zip(&other.off).map(|(a, b)| (a - b).abs());
        median(apart) <= SAME * residuals(&reference.fundamental, reference.matches).median
    }

    /// Returns whether this change explains the matches clearly better than another: at more places than
    /// chance explains.
    fn is_clear(&self, other: &Self, reference: &Reference) -> bool {
        let vote =
            |((own, its), pair): ((&f64, &f64), &PointPair)| (pair.point1, if own < its { 1 } else { -1 });
        let votes = self.off.iter().zip(&other.off).zip(reference.matches).map(vote);
        let contest = Contest::of(votes, reference.frames[0]);
        let own = self.found.change.parameters();
        contest.first_wins(own.saturating_sub(other.found.change.parameters()))
    }
}

/// Returns the changes without fitted numbers, the more specific ones first.
fn discrete(given: &GivenGeometry, reference: &Reference) -> Vec<Candidate> {
    let GivenGeometry { fundamental, cameras, .. } = given;
    let of_cameras = CameraChange::ALL.into_iter().filter_map(|mistake| {
        let [a, b] = mistake.apply(cameras.as_ref()?)?;
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
    let all = of_cameras.chain(of_pixels);
    all.filter_map(|(change, changed)| Candidate::new(change, Some(changed), given, reference)).collect()
}

/// Returns the mistakes with a stereo calibration.
fn of_calibration(given: &GivenGeometry, reference: &Reference, limit: f64) -> Vec<Candidate> {
    let Some(calibration) = &given.calibration else { return Vec::new() };
    let originals = calibration.originals(reference.matches);
    let few: Vec<PointPair> =
        originals.iter().step_by(originals.len().div_ceil(FEW)).copied().flatten().collect();
    let cost_of = |change: CalibrationChange| {
        let read = calibration.read(change)?;
        let f = read.fundamental()?;
        let cost = |pair: &PointPair| read.undistorted(pair).map_or(FAR_COST, |pair| cost(&f, &pair, limit));
        Some(few.iter().map(cost).sum())
    };
    let resized = |octaves: f64| CalibrationChange::OtherSize { factor: octaves.exp2() };
    let octaves = grid_minimum(
        |octaves| cost_of(resized(octaves)).unwrap_or(f64::INFINITY),
        (-OCTAVES, OCTAVES),
        1.0 / STEPS,
    );
    let changes = [
        CalibrationChange::PicturesExchanged,
        CalibrationChange::EquidistantLens,
        CalibrationChange::RadialLens,
        resized(octaves),
    ];
    let measured = |change| Candidate::new(Change::Calibration(change), None, given, reference);
    changes.into_iter().filter_map(measured).collect()
}

/// Returns the robust cost of a match for a fit within `limit` px.
fn cost(f: &FundamentalMatrix, pair: &PointPair, limit: f64) -> f64 {
    (symmetric_epipolar_distance(f, pair) / (0.5 * limit)).powi(2).ln_1p()
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
fn fitted(given: &GivenGeometry, reference: &Reference, limit: f64) -> Vec<Candidate> {
    let step = reference.matches.len().div_ceil(FEW);
    let few: Vec<PointPair> = reference.matches.iter().step_by(step).copied().collect();
    let (f, frames) = (&given.fundamental, reference.frames);
    let of_change = |change: Change| match change {
        Change::Distortion { k } => {
            few.iter().map(|pair| cost(f, &undistorted(pair, k, frames), limit)).sum()
        }
        _ => change
            .apply(f, frames)
            .map_or(f64::INFINITY, |changed| few.iter().map(|pair| cost(&changed, pair, limit)).sum::<f64>()),
    };
    let octaves = |of: &dyn Fn(f64) -> Change, middle: f64| {
        let cost = |octaves: f64| of_change(of(middle * octaves.exp2()));
        middle * grid_minimum(cost, (-OCTAVES, OCTAVES), 1.0 / STEPS).exp2()
    };
    let mut changes = vec![Change::Distortion {
        k: grid_minimum(|k| of_change(Change::Distortion { k }), (-MOST_BENT, MOST_BENT), BENT_STEP),
    }];
    if looks_essential(f) {
        let essential = |focal: f64| Change::Essential { focal };
        changes.push(essential(octaves(&essential, frames[0].longer_side())));
    }
    for images in Affected::ALL {
        let resized = |factor: f64| Change::Resized { images, factor };
        changes.push(resized(octaves(&resized, 1.0)));
        let focal = |factor: f64| Change::FocalLength { images, factor };
        changes.push(focal(octaves(&focal, 1.0)));
        let moved = |[x, y]: [f64; 2]| Change::Moved { images, x, y };
        let first = MOVE * frames[0].longer_side().max(frames[1].longer_side());
        changes.push(moved(compass(first, |by| of_change(moved(by)))));
    }
    let measured = |change: Change| {
        let changed = change.apply(f, frames);
        Candidate::new(change, changed, given, reference)
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
