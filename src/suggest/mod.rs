//! Guided clicking: the match of a clicked point ([`suggest`]), the refinement of a clicked pair
//! ([`refine`]) and the most informative next click ([`next_click`]).
//!
//! The patch around the click is rotated and scaled in steps. Each version is correlated with every
//! position of the other image at two reduced sizes. With a known `F`, only positions near the
//! epipolar line are searched, at three sizes. Affine alignment follows the best positions to the
//! full size. The score is the correlation
//!
//! ```text
//!     c = mean over three sizes of  Σ (I1 − Ī1)(I2 − Ī2) / √(Σ (I1 − Ī1)² Σ (I2 − Ī2)²)
//! ```
//!
//! of 11×11 patches at about 1/4, 1/2 and all of the resolution. The wide patches distinguish
//! repeated structure; the narrow patches localise. A reverse search then looks for the best
//! candidate's match in the clicked image.
//!
//! A suggestion is *clear* under three conditions. Its correlation is high. No competitor comes
//! near, measured by the ratio of mismatches (after Lowe 2004); competitors are the second-best
//! position in the other image and of the reverse search. And the reverse search ends at the click.
//! With the matches of a result, it is also clear at the place where the nearest of them expect it.
//! [`SuggestParameters`] holds the limits, set on real pairs so that nearly all clear suggestions
//! are right. `cargo run --release -p epiline-lab --example measure-suggest` prints the fractions.
//!
//! # Pitfalls
//! - Rotations up to 30° and scales from 0.7 to 1.4 are searched, relative to the known view or the
//!   view estimated from features. Objects turned or scaled beyond that are found only by luck.
//! - At an occluding contour the patches show different backgrounds: the correct match may score
//!   low.
//! - Matches within 10 px of the border of the other image (at 768 px; 5 px with `F`) are found
//!   only by luck, because half of the patch is outside. Clicks at a border are no problem.
//! - A point occluded in the other image has no match, but a similar place may look clear.

mod alignment;
mod correlation;
mod error;
mod expected;
mod next_click;
mod parameters;
mod result;
mod search;
mod template;
#[cfg(all(test, feature = "pictures"))]
mod tests;
mod view;

pub use error::SuggestError;
pub use next_click::{NextClick, Rival, next_click};
pub use parameters::SuggestParameters;
pub use result::{Clarity, ClickedImage, Suggestion, Suggestions};
pub use view::view_at;

use crate::estimate::PreparedPair;
use crate::geometry::{FundamentalMatrix, Line, Point, PointPair};
use crate::image::RelativeView;
use expected::Expected;
use search::{FoundPlace, Quest, SearchView};
use template::Pose;

/// Smallest permitted image side, px. Smaller images hold no patch at the reduced sizes.
const SMALLEST_SIDE: usize = 24;
/// Mismatch `1 − c` caused by noise and interpolation. It keeps the ratio of two perfect matches at
/// 1.
const NOISE: f64 = 1e-3;
/// Step between searched rotations, radians.
const ROTATION_STEP: f64 = std::f64::consts::PI / 12.0;
/// Minimum correlation of a clear suggestion at the place that its neighbours expect. It is low,
/// because surfaces turned away look less alike and few wrong places lie there.
const EXPECTED_CORRELATION: f64 = 0.6;
/// Ratio between searched scales.
const SCALE_STEP: f64 = 1.19;

/// Known relations between the two images; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known<'a> {
    /// Fundamental matrix from image 1 to image 2, whichever was clicked. With it, only the
    /// epipolar line is searched.
    pub fundamental: Option<FundamentalMatrix>,
    /// Relative rotation and scale of the images. Without it the search starts upright, and tries
    /// the view estimated from features if no match is clear.
    pub view: Option<RelativeView>,
    /// Matches of a result. The place that the nearest ones expect decides between candidates that look
    /// alike.
    pub matches: &'a [PointPair],
}

/// Suggests matches of a point clicked in one image, in full-size pixels.
///
/// Takes 20 to 40 ms at 768×576 on two cores; the first use of features adds some tenths of a
/// second. The result does not depend on the number of threads.
pub fn suggest(
    prepared: &PreparedPair,
    point: Point,
    clicked: ClickedImage,
    known: &Known,
    parameters: &SuggestParameters,
) -> Result<Suggestions, SuggestError> {
    check(prepared, point, clicked)?;
    let search = |view| seen(prepared, point, clicked, known, view, parameters);
    if let Some(view) = known.view {
        return search(view);
    }
    let upright = search(RelativeView::UPRIGHT);
    let settled = match &upright {
        Ok(found) => found.clear().is_some(),
        Err(error) => *error != SuggestError::NothingAlike(clicked.other().number()),
    };
    if settled {
        return upright;
    }
    let view = prepared.view_of_features(known.fundamental.as_ref());
    let Some(turned) = view.filter(|view| *view != RelativeView::UPRIGHT).map(search) else { return upright };
    let correlation = |found: &Result<Suggestions, SuggestError>| {
        found.as_ref().map_or(-1.0, |found| {
            // A clear suggestion beats every unclear one.
            found.candidates[0].correlation + f64::from(u8::from(found.clear().is_some()))
        })
    };
    if correlation(&turned) > correlation(&upright) { turned } else { upright }
}

/// Runs [`suggest`] under one view.
fn seen(
    prepared: &PreparedPair,
    point: Point,
    clicked: ClickedImage,
    known: &Known,
    view: RelativeView,
    parameters: &SuggestParameters,
) -> Result<Suggestions, SuggestError> {
    let other = clicked.other();
    let fundamental = known.fundamental.as_ref();
    let line = |f| {
        let line = epipolar_line(f, clicked, point).ok_or(SuggestError::AtEpipole)?;
        let is_visible = prepared.frames()[other.index()].clip(&line).is_some();
        if is_visible { Ok(line) } else { Err(SuggestError::LineOutside(other.number())) }
    };
    let line = fundamental.map(line).transpose()?;
    let forth = SearchView::new(prepared, clicked.index(), view);
    if forth.is_flat(point) {
        return Err(SuggestError::Flat);
    }
    let poses = poses(forth.usual, 2);
    let band = |line: Line| (line, parameters.band.max(0.0));
    let mut found = forth.candidates(&Quest { at: point, poses: &poses, band: line.map(band) });
    let side = prepared.frames()[other.index()].longer_side();
    let expected = Expected::of(known.matches, point, clicked, side, forth.resolution());
    let is_expected = |candidate: &FoundPlace| {
        candidate.correlation >= EXPECTED_CORRELATION
            && expected.is_some_and(|place| (candidate.placement.at - place.at).norm() <= place.reach)
    };
    // The order is stable, so the best comes first among those that are expected.
    found.sort_by_key(|candidate| !is_expected(candidate));
    let Some(best) = found.first() else {
        return Err(SuggestError::NothingAlike(other.number()));
    };

    let way_back = SearchView::new(prepared, other.index(), view);
    let at = best.placement.at;
    let back_line = fundamental.and_then(|f| epipolar_line(f, other, at));
    let turned_back = Pose::of(&best.placement.affine).inverse();
    let quest =
        Quest { at, poses: &self::poses(way_back.level_pose(turned_back), 1), band: back_line.map(band) };
    let back = way_back.candidates(&quest);

    let competitor = found.get(1).into_iter().chain(back.get(1)).map(|c| c.correlation).fold(0.0, f64::max);
    let mismatch = |correlation: f64| 1.0 - correlation + NOISE;
    let ambiguity = (mismatch(best.correlation) / mismatch(competitor)).clamp(0.0, 1.0);
    let return_distance = back.first().map(|b| (b.placement.at - point).norm());
    let longer_side = prepared.frames()[clicked.index()].longer_side();
    let verdict = if is_expected(best) {
        Clarity::Clear
    } else {
        parameters.verdict(best.correlation, ambiguity, return_distance, longer_side)
    };
    let candidates = found
        .iter()
        .take(parameters.candidates.max(1))
        .map(|candidate| suggestion(&forth, point, candidate))
        .collect();
    Ok(Suggestions { candidates, ambiguity, return_distance, verdict })
}

/// Maximum displacement by [`refine`], as a fraction of the longer side of the image.
const REFINED_REACH: f64 = 0.01;

/// Refines a clicked pair to subpixel accuracy. The point in image 2 moves to the nearby position
/// that looks most like the surroundings of the point in image 1. Without a view, the relative
/// rotation and scale are estimated from the surroundings of both points.
pub fn refine(
    prepared: &PreparedPair,
    pair: &PointPair,
    view: Option<RelativeView>,
    parameters: &SuggestParameters,
) -> Result<Suggestion, SuggestError> {
    for (point, image) in [(pair.point1, ClickedImage::First), (pair.point2, ClickedImage::Second)] {
        check(prepared, point, image)?;
    }
    let view = view.or_else(|| view_at(prepared, &[*pair])).unwrap_or(RelativeView::UPRIGHT);
    let search = SearchView::new(prepared, ClickedImage::First.index(), view);
    if search.is_flat(pair.point1) {
        return Err(SuggestError::Flat);
    }
    let reach = REFINED_REACH * prepared.frames()[ClickedImage::Second.index()].longer_side();
    let poses = poses(search.usual, 2);
    let found = search.nearby(pair.point1, pair.point2, reach, &poses);
    found
        .filter(|found| found.correlation >= parameters.least_correlation)
        .map(|found| suggestion(&search, pair.point1, &found))
        .ok_or(SuggestError::NotAligned(ClickedImage::Second.number()))
}

fn check(prepared: &PreparedPair, point: Point, clicked: ClickedImage) -> Result<(), SuggestError> {
    if !point.iter().all(|v| v.is_finite()) {
        return Err(SuggestError::NotFinite);
    }
    for (k, frame) in prepared.frames().iter().enumerate() {
        let (width, height) = (frame.width, frame.height);
        if width.min(height) < SMALLEST_SIDE {
            return Err(SuggestError::TooSmall { image: k + 1, width, height, smallest: SMALLEST_SIDE });
        }
    }
    let frame = prepared.frames()[clicked.index()];
    if !frame.contains(point) {
        let (image, width, height) = (clicked.number(), frame.width, frame.height);
        return Err(SuggestError::Outside { image, x: point.x, y: point.y, width, height });
    }
    Ok(())
}

fn epipolar_line(f: &FundamentalMatrix, image: ClickedImage, point: Point) -> Option<Line> {
    match image {
        ClickedImage::First => f.line2_from_point1(point),
        ClickedImage::Second => f.line1_from_point2(point),
    }
}

/// Returns a grid of poses around one, `steps` to either side.
fn poses(around: Pose, steps: i32) -> Vec<Pose> {
    let offsets = || (-steps..=steps).map(f64::from);
    let rotated = |k: f64| {
        let rotation = around.rotation + k * ROTATION_STEP;
        offsets().map(move |k| Pose { rotation, scale: around.scale * SCALE_STEP.powf(k) })
    };
    offsets().flat_map(rotated).collect()
}

fn suggestion(view: &SearchView, point: Point, candidate: &FoundPlace) -> Suggestion {
    let placement = view.finished(point, candidate);
    let pose = Pose::of(&placement.affine);
    Suggestion {
        position: placement.at,
        correlation: candidate.correlation,
        rotation: pose.rotation,
        scale: pose.scale,
    }
}
