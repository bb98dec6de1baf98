//! The rectified pair of the geometry that the window shows, as large as it is worth drawing.
//!
//! While the geometry moves, small pictures follow it ([`DRAFT`]), which takes milliseconds; once it rests, they are
//! drawn as large as is worth looking at ([`SHOWN`]), and that is given up as soon as something newer is wanted.

use std::borrow::Cow;

use super::disparity::DisparityMap;
use crate::app::model::picture::{Opened, Pictures};
use crate::app::model::revision;
use crate::app::model::shared::Shared;
use crate::cancel::CancelFlag;
use crate::estimate::Estimate;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::Picture;
use crate::io::GroundTruth;
use crate::rectify::{Limits, Rectification, RectifyError, RectifyMethod, rectify};

/// Pixels of a rectified picture on the screen, at most.
const SHOWN: Limits = Limits { pixels: 3_000_000 };
/// The same while the geometry moves.
const DRAFT: Limits = Limits { pixels: 200_000 };

/// The matches on which a rectification is measured.
#[derive(Debug, Clone, PartialEq)]
pub enum MatchesAtHand {
    /// Matches that are known.
    True(Shared<GroundTruth>),
    /// Matches that the refinement of a result found.
    Found(Shared<Estimate>),
    /// Pairs that were clicked.
    Clicked(Vec<PointPair>),
}

impl MatchesAtHand {
    /// The pairs of points.
    pub fn pairs(&self) -> Cow<'_, [PointPair]> {
        match self {
            Self::True(truth) => truth.matches.as_slice().into(),
            Self::Found(estimate) => estimate.matches().iter().map(|found| found.pair).collect(),
            Self::Clicked(pairs) => pairs.into(),
        }
    }

    /// What they are called.
    pub fn name(&self) -> &'static str {
        match self {
            Self::True(_) => "true matches",
            Self::Found(_) => "matches of the result",
            Self::Clicked(_) => "clicked pairs",
        }
    }
}

/// What is to be rectified.
#[derive(Debug, Clone, PartialEq)]
pub struct RectifyQuestion {
    /// The pictures.
    pub pictures: Pictures,
    /// The geometry that the window shows.
    pub fundamental: FundamentalMatrix,
    /// What is measured.
    pub matches: MatchesAtHand,
    /// The method that was chosen.
    pub method: RectifyMethod,
    /// Whether another geometry is likely to come at once.
    pub moving: bool,
}

impl RectifyQuestion {
    /// Rectifies as large as `limits` allow.
    pub fn rectification(&self, limits: &Limits) -> Result<Rectification, RectifyError> {
        let frames = self.pictures.each_ref().map(|picture| picture.frame());
        rectify(&self.fundamental, frames, &self.matches.pairs(), self.method, limits)
    }

    /// The pair for the screen; `None` when cancelled.
    pub fn answer(&self, cancel: &CancelFlag) -> Option<Rectified> {
        let outcome = match self.drawn(cancel) {
            Ok(drawn) => Ok(drawn?),
            Err(error) => Err(error),
        };
        Some(Rectified { fundamental: self.fundamental, measured: self.matches.name(), outcome })
    }

    fn drawn(&self, cancel: &CancelFlag) -> Result<Option<DrawnPair>, RectifyError> {
        let full = self.rectification(&Limits::default())?;
        let limits = if self.moving { DRAFT } else { SHOWN };
        let fits = full.size.width * full.size.height <= limits.pixels;
        let shown = if fits { full.clone() } else { self.rectification(&limits)? };
        let Some(pictures) = self.pictures_of(&shown, cancel) else { return Ok(None) };
        // A pair that another one follows at once is not looked at so closely.
        let disparity = if self.moving {
            None
        } else {
            let both = pictures.each_ref().map(|opened| &opened.picture.pixels);
            let known = full.measures.rows.map(|rows| rows.disparity);
            let map = DisparityMap::new(both, full.size.width, known, cancel);
            if cancel.is_cancelled() {
                return Ok(None);
            }
            map.and_then(|map| {
                let picture =
                    Picture::from_pixels("disparity".into(), None, map.picture.clone().into()).ok()?;
                Some((map, Opened::new(picture)))
            })
        };
        Ok(Some(DrawnPair { full, shown, pictures, disparity, number: revision::fresh() }))
    }

    /// Both pictures.
    fn pictures_of(&self, shown: &Rectification, cancel: &CancelFlag) -> Option<[Opened; 2]> {
        let left = shown.warp(0, &self.pictures[0].pixels, cancel)?;
        let right = shown.warp(1, &self.pictures[1].pixels, cancel)?;
        let opened =
            |name: &str, pixels| Picture::from_pixels(name.into(), None, pixels).ok().map(Opened::new);
        Some([opened("left", left)?, opened("right", right)?])
    }
}

/// What became of a geometry.
pub struct Rectified {
    /// The geometry.
    pub fundamental: FundamentalMatrix,
    /// What the measures are of.
    pub measured: &'static str,
    /// The pair, or why there is none.
    pub outcome: Result<DrawnPair, RectifyError>,
}

/// A pair for the screen.
pub struct DrawnPair {
    /// As it would be written, with its measures.
    pub full: Rectification,
    /// As it is drawn, perhaps smaller; places in the pictures are in its pixels.
    pub shown: Rectification,
    /// The left and the right picture.
    pub pictures: [Opened; 2],
    /// How far things are apart in them, with a picture of it; none while the geometry moves, or where nothing matches.
    pub disparity: Option<(DisparityMap, Opened)>,
    /// Another number for each.
    pub number: u64,
}

/// One of the pictures of a [`DrawnPair`] pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RectifiedSheet {
    /// The rectified left image.
    Left,
    /// The rectified right image.
    Right,
    /// Both in one place.
    Both,
    /// How far things are apart.
    Disparity,
}

impl DrawnPair {
    /// Pixels on the screen's pictures for a pixel of those that would be written.
    pub fn reduction(&self) -> f64 {
        self.shown.size.height as f64 / self.full.size.height as f64
    }

    /// By how much the right picture is to be shifted for a point pair to coincide, px of the pictures as they are
    /// written.
    pub fn shift_of(&self, pair: &PointPair) -> Option<f64> {
        let [left, right] = [pair.point1, pair.point2];
        let left = self.shown.maps[0].rectified_from_original(left)?;
        let right = self.shown.maps[1].rectified_from_original(right)?;
        Some((left.x - right.x) / self.reduction())
    }

    /// Size of every picture, px.
    pub fn frame(&self) -> Frame {
        self.shown.size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::sample::sample_pair;

    fn question() -> RectifyQuestion {
        let sample = sample_pair();
        RectifyQuestion {
            pictures: sample.pictures.map(Shared::new),
            fundamental: sample.truth.fundamental,
            matches: MatchesAtHand::True(Shared::new(sample.truth)),
            method: RectifyMethod::Auto,
            moving: false,
        }
    }

    #[test]
    fn a_moving_geometry_gives_small_pictures_and_one_at_rest_large_ones() {
        let pixels = |question: &RectifyQuestion| {
            let rectified = question.answer(&CancelFlag::default()).unwrap();
            assert_eq!(rectified.measured, "true matches");
            let drawn = rectified.outcome.unwrap();
            assert!(drawn.full.size.width >= drawn.shown.size.width);
            assert_eq!(drawn.disparity.is_some(), !question.moving);
            if let Some((map, _)) = &drawn.disparity {
                // What the matches are apart is about what the map says.
                let pairs = question.matches.pairs();
                let near = |pair: &&PointPair| {
                    let at = drawn.shown.maps[0].rectified_from_original(pair.point1).unwrap();
                    let frame = drawn.frame();
                    let found = map.at((at.x + 0.5) / frame.width as f64, (at.y + 0.5) / frame.height as f64);
                    found.is_some_and(|found| (found - drawn.shift_of(pair).unwrap()).abs() < 8.0)
                };
                let right = pairs.iter().filter(near).count();
                assert!(2 * right > pairs.len(), "{right} of {}", pairs.len());
            }
            drawn.frame().width * drawn.frame().height
        };
        let small = pixels(&RectifyQuestion { moving: true, ..question() });
        assert!(small <= DRAFT.pixels, "{small}");
        let large = pixels(&question());
        assert!(large > DRAFT.pixels && large <= SHOWN.pixels, "{large}");
    }

    #[test]
    fn what_was_cancelled_gives_nothing() {
        let cancel = CancelFlag::default();
        cancel.cancel();
        assert!(question().answer(&cancel).is_none());
    }
}
