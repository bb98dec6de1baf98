//! Guided second click: where in the other image a clicked point may be; a better place for one that was clicked; and where
//! one more click would tell most ([`next_click`]).
//!
//! The surroundings of the click, turned and resized in steps, are correlated with every place of the other
//! image at two small sizes, or with every place near the epipolar line at three sizes when `F` is known. The
//! best places are followed to the full size by affine alignment; their score is the correlation
//!
//! ```text
//!     c = mean over three sizes of  Σ (I1 − Ī1)(I2 − Ī2) / √(Σ (I1 − Ī1)² Σ (I2 − Ī2)²)
//! ```
//!
//! of 11×11 patches at some 1/4, 1/2 and all of the resolution: the wide ones tell repeated things apart, the
//! narrow ones give the place. The best candidate is then searched for in the clicked image, the way back.
//!
//! It is called *clear* when it correlates well, when no competitor — the second place in the other image or the
//! second place on the way back — comes near it, measured by the ratio of mismatches (after Lowe 2004), and
//! when the way back ends at the click. The limits are those of [`SuggestParameters`]; they were set on real
//! pairs so that nearly all clear suggestions are right. `cargo run --release --example measure-suggest` prints
//! the shares.
//!
//! # Pitfalls
//! - Rotation up to 30° and scales from 0.7 to 1.4 are searched around the view of the images that is known or that
//!   their features suggest; what is turned or scaled against the rest of the picture is found only by luck.
//! - At the silhouette of a thing the patches show different backgrounds: the right place may score low.
//! - Matches within 10 px of the border of the other image (at 768 px; 5 px with `F`) are found only by luck:
//!   half of the patch is not in the picture. Clicks at a border are no problem.
//! - A point that is hidden in the other image has no match, but a twin of it may look clear.

mod alignment;
mod correlation;
mod error;
mod next_click;
mod parameters;
mod result;
mod search;
mod template;
#[cfg(all(test, feature = "evaluate"))]
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
use search::{FoundPlace, Quest, SearchView};
use template::Pose;

/// Images smaller than this hold no patch at a reduced size, px.
const SMALLEST_SIDE: usize = 24;
/// Mismatch that says nothing, as noise and interpolation cause it: two perfect places are equals.
const NOISE: f64 = 1e-3;
/// Step between the rotations that are tried, radians.
const ROTATION_STEP: f64 = std::f64::consts::PI / 12.0;
/// Ratio between the scales that are tried.
const SCALE_STEP: f64 = 1.19;

/// What is known of how the two images belong together. Nothing, by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known {
    /// The geometry, from image 1 to image 2 whichever was clicked: then only the epipolar line is searched.
    pub fundamental: Option<FundamentalMatrix>,
    /// How the images are turned and scaled against each other. When that is not known they are taken to be upright, and
    /// where that leaves doubts, as their features suggest.
    pub view: Option<RelativeView>,
}

/// Suggests the match of a point that was clicked in one image, full-size pixels.
///
/// Takes some 20 to 40 ms at 768×576 on two cores, and the first time that features are asked for some tenths of a second
/// more; gives the same result on any number of threads.
pub fn suggest(
    prepared: &PreparedPair,
    point: Point,
    clicked: ClickedImage,
    known: &Known,
    parameters: &SuggestParameters,
) -> Result<Suggestions, SuggestError> {
    check(prepared, point, clicked)?;
    let search = |view| seen(prepared, point, clicked, known.fundamental.as_ref(), view, parameters);
    if let Some(view) = known.view {
        return search(view);
    }
    let upright = search(RelativeView::UPRIGHT);
    let settled = match &upright {
        Ok(found) => found.clear().is_some(),
        Err(error) => *error != SuggestError::NothingAlike { image: clicked.other().number() },
    };
    if settled {
        return upright;
    }
    let view = prepared.view_of_features(known.fundamental.as_ref());
    let Some(turned) = view.filter(|view| *view != RelativeView::UPRIGHT).map(search) else { return upright };
    let correlation = |found: &Result<Suggestions, SuggestError>| {
        found.as_ref().map_or(-1.0, |found| {
            // What is clear is better than what is not.
            found.candidates[0].correlation + f64::from(u8::from(found.clear().is_some()))
        })
    };
    if correlation(&turned) > correlation(&upright) { turned } else { upright }
}

/// [`suggest`] under one view.
fn seen(
    prepared: &PreparedPair,
    point: Point,
    clicked: ClickedImage,
    fundamental: Option<&FundamentalMatrix>,
    view: RelativeView,
    parameters: &SuggestParameters,
) -> Result<Suggestions, SuggestError> {
    let other = clicked.other();
    let line = match fundamental {
        Some(f) => {
            let line = epipolar_line(f, clicked, point).ok_or(SuggestError::AtEpipole)?;
            if prepared.frames()[other.index()].clip(&line).is_none() {
                return Err(SuggestError::LineOutside { image: other.number() });
            }
            Some(line)
        }
        None => None,
    };
    let forth = SearchView::new(prepared, clicked.index(), view);
    if forth.is_flat(point) {
        return Err(SuggestError::Flat);
    }
    let poses = poses(forth.usual_pose(), 2);
    let band = |line: Line| (line, parameters.band.max(0.0));
    let found = forth.candidates(&Quest { at: point, poses: &poses, band: line.map(band) });
    let Some(best) = found.first() else {
        return Err(SuggestError::NothingAlike { image: other.number() });
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
    let verdict = parameters.verdict(best.correlation, ambiguity, return_distance, longer_side);
    let candidates = found
        .iter()
        .take(parameters.candidates.max(1))
        .map(|candidate| suggestion(&forth, point, candidate))
        .collect();
    Ok(Suggestions { candidates, ambiguity, return_distance, verdict })
}

/// How far a refined point may lie from where it was, as a fraction of the longer side of its image.
const REFINED_REACH: f64 = 0.01;

/// Aligns the point in image 2 of a clicked pair to a fraction of a pixel around where it is: the place nearby that looks
/// like the surroundings of the point in image 1. Without a view, the images are taken to be turned and scaled as the
/// surroundings of both points suggest.
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
    let poses = poses(search.usual_pose(), 2);
    let found = search.nearby(pair.point1, pair.point2, reach, &poses);
    found
        .filter(|found| found.correlation >= parameters.least_correlation)
        .map(|found| suggestion(&search, pair.point1, &found))
        .ok_or(SuggestError::NotAligned { image: ClickedImage::Second.number() })
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

/// The epipolar line of a point of the given image, in the other one.
fn epipolar_line(f: &FundamentalMatrix, image: ClickedImage, point: Point) -> Option<Line> {
    match image {
        ClickedImage::First => f.line2_from_point1(point),
        ClickedImage::Second => f.line1_from_point2(point),
    }
}

/// A grid of poses around one, `steps` to either side.
fn poses(around: Pose, steps: i32) -> Vec<Pose> {
    let offsets = || (-steps..=steps).map(f64::from);
    let rotations: Vec<f64> = offsets().map(|k| around.rotation + k * ROTATION_STEP).collect();
    let scales: Vec<f64> = offsets().map(|k| around.scale * SCALE_STEP.powf(k)).collect();
    Pose::grid(&rotations, &scales)
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
