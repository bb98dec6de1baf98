//! The rectified pair of the shown geometry, at a size suited to the screen.
//!
//! While the geometry moves, small pictures ([`DRAFT`]) follow it within milliseconds. Once the
//! geometry rests, larger ones ([`SHOWN`]) are drawn. They are cancelled when a newer pair is
//! requested.

use std::borrow::Cow;

use image::RgbaImage;

use super::RectifiedLook;
use crate::app::model::document::Side;
use crate::app::model::pane_view::QuarterTurns;
use crate::app::model::picture::{Opened, Pictures};
use crate::app::model::revision;
use crate::app::model::shared::Shared;
use crate::camera::ViewPair;
use crate::cancel::CancelFlag;
use crate::estimate::Estimate;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::Picture;
use crate::io::GroundTruth;
use crate::rectify::{Limits, Rectification, RectifyError, RectifyMethod, rectify};
use crate::study::DisparityMap;

/// Maximum number of pixels of a rectified picture on the screen.
const SHOWN: Limits = Limits { pixels: 3_000_000 };
/// Maximum number of pixels while the geometry moves.
const DRAFT: Limits = Limits { pixels: 200_000 };

/// Matches for measuring a rectification.
#[derive(Debug, Clone, PartialEq)]
pub enum MatchesAtHand {
    True(Shared<GroundTruth>),
    /// Matches found by the refinement of a result.
    Found(Shared<Estimate>),
    Clicked(Vec<PointPair>),
}

impl MatchesAtHand {
    pub fn pairs(&self) -> Cow<'_, [PointPair]> {
        match self {
            Self::True(truth) => truth.matches.as_slice().into(),
            Self::Found(estimate) => estimate.matches().iter().map(|found| found.pair).collect(),
            Self::Clicked(pairs) => pairs.into(),
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Self::True(_) => "true matches",
            Self::Found(_) => "matches of the result",
            Self::Clicked(_) => "point pairs",
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct RectifyQuestion {
    pub pictures: Pictures,
    pub fundamental: FundamentalMatrix,
    pub matches: MatchesAtHand,
    /// Matches for the range of disparities: the true matches, and the matches of the result or the
    /// clicked pairs.
    pub scene: Vec<MatchesAtHand>,
    pub method: RectifyMethod,
    /// Whether the geometry is moving, so that another request follows soon.
    pub moving: bool,
    /// The pictures with the distortion of their lenses, if `pictures` are views without it.
    pub bent: Option<(Pictures, ViewPair)>,
}

impl RectifyQuestion {
    /// Rectifies at the largest size within `limits`.
    pub fn rectification(&self, limits: &Limits) -> Result<Rectification, RectifyError> {
        let frames = self.pictures.each_ref().map(|picture| picture.frame());
        let mut made = rectify(&self.fundamental, frames, &self.matches.pairs(), self.method, limits)?;
        let scene: Vec<PointPair> =
            self.scene.iter().flat_map(|matches| matches.pairs().into_owned()).collect();
        made.measure_disparities(&scene);
        Ok(made)
    }

    /// Returns the pictures to draw from, with the maps that lead to them.
    pub fn sources(&self, rectification: Rectification) -> (&Pictures, Rectification) {
        match &self.bent {
            Some((pictures, views)) => (pictures, rectification.through(&views.views)),
            None => (&self.pictures, rectification),
        }
    }

    /// Draws the pair for the screen; `None` when cancelled.
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
        // A pair that is replaced at once needs no disparity map.
        let disparity = if self.moving {
            None
        } else {
            let both = pictures.each_ref().map(|opened| opened.picture.displayed(&opened.picture.pixels));
            let known = full.measures.rows.map(|rows| rows.disparity);
            let map =
                DisparityMap::new(both.each_ref().map(|shown| &**shown), full.size.width, known, cancel);
            if cancel.is_cancelled() {
                return Ok(None);
            }
            map.and_then(|map| {
                let map = map.checked_by(&full.placed(&self.matches.pairs()), full.size);
                let picture = Picture::from_pixels("disparity".into(), None, drawn(&map)?.into()).ok()?;
                Some((map, Opened::new(picture)))
            })
        };
        Ok(Some(DrawnPair { full, shown, pictures, disparity, number: revision::fresh() }))
    }

    fn pictures_of(&self, shown: &Rectification, cancel: &CancelFlag) -> Option<[Opened; 2]> {
        let (pictures, maps) = self.sources(shown.clone());
        let [left, right] =
            [maps.warp(0, &pictures[0].pixels, cancel)?, maps.warp(1, &pictures[1].pixels, cancel)?];
        let opened = |k: usize, name: &str, pixels| Opened::new(pictures[k].with_pixels(name.into(), pixels));
        Some([opened(0, "left", left), opened(1, "right", right)])
    }
}

/// Draws disparities by colour: dark for the smallest, transparent without a match.
fn drawn(map: &DisparityMap) -> Option<RgbaImage> {
    let [width, height] = map.size().map(|v| v as u32);
    let color = |share: f32| {
        let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(f64::from(share));
        [r, g, b, 255]
    };
    let pixels = map.shares().flat_map(|share| share.map_or([0; 4], color)).collect();
    RgbaImage::from_raw(width, height, pixels)
}

/// Ratio of height to width from which pictures count as high.
const HIGH: f64 = 1.5;

pub struct Rectified {
    pub fundamental: FundamentalMatrix,
    /// Name of the matches behind the measures.
    pub measured: &'static str,
    /// The pair, or the reason why there is none.
    pub outcome: Result<DrawnPair, RectifyError>,
}

pub struct DrawnPair {
    /// Rectification at full size, as it would be written, with its measures.
    pub full: Rectification,
    /// Rectification as drawn, possibly smaller. Positions in the pictures refer to its pixels.
    pub shown: Rectification,
    pub pictures: [Opened; 2],
    /// Disparity map and its picture. `None` while the geometry moves, and without any match.
    pub disparity: Option<(DisparityMap, Opened)>,
    pub number: u64,
}

/// One of the pictures of a [`DrawnPair`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RectifiedSheet {
    Left,
    Right,
    Disparity,
}

impl RectifiedSheet {
    pub const COUNT: usize = 3;

    /// Returns the side of the picture. The disparity map has the geometry of the left one.
    pub fn side(self) -> Side {
        if self == Self::Right { Side::Right } else { Side::Left }
    }
}

impl DrawnPair {
    /// Returns the number of drawn pixels per written pixel.
    pub fn reduction(&self) -> f64 {
        self.shown.size.height as f64 / self.full.size.height as f64
    }

    /// Returns whether the pictures are much higher than wide: unrolled about an epipole.
    pub fn is_high(&self) -> bool {
        let size = self.full.size;
        size.height as f64 > HIGH * size.width as f64
    }

    /// Returns whether the pictures are shown turned, so that they fill a wide window.
    pub fn is_turned(&self, look: &RectifiedLook) -> bool {
        self.is_high() && !look.as_in_the_file
    }

    /// Returns the word for a row as it lies on the screen.
    pub fn row_name(&self, look: &RectifiedLook) -> &'static str {
        if self.is_turned(look) { "Column" } else { "Row" }
    }

    /// Returns the turn of the pictures on the screen. The epipole is at the top of turned ones.
    pub fn turn(&self, look: &RectifiedLook) -> QuarterTurns {
        QuarterTurns::from(u8::from(self.is_turned(look)))
    }

    /// Returns the shift of the right picture that makes a point pair coincide, px of the written
    /// pictures.
    pub fn shift_of(&self, pair: &PointPair) -> Option<f64> {
        let [left, right] = [pair.point1, pair.point2];
        let left = self.shown.maps[0].rectified_from_original(left)?;
        let right = self.shown.maps[1].rectified_from_original(right)?;
        Some((left.x - right.x) / self.reduction())
    }

    /// Returns the size of every picture, px.
    pub fn frame(&self) -> Frame {
        self.shown.size
    }
}

#[cfg(test)]
pub fn example() -> RectifyQuestion {
    let sample = crate::app::model::sample::sample_pair(crate::synthetic::Sample::Courtyard);
    RectifyQuestion {
        pictures: sample.pictures.map(|opened| opened.picture),
        fundamental: sample.truth.fundamental,
        matches: MatchesAtHand::True(Shared::new(sample.truth)),
        scene: Vec::new(),
        method: RectifyMethod::Auto,
        moving: false,
        bent: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_of_disparities_is_that_of_the_scene_whatever_measures_the_rows() {
        let whole = example();
        let range = |question: &RectifyQuestion| {
            let made = question.rectification(&DRAFT).unwrap();
            made.measures.rows.map(|rows| (rows.matches, rows.disparity.map(f64::to_bits))).unwrap()
        };
        let (all, expected) = range(&whole);
        let one = MatchesAtHand::Clicked(whole.matches.pairs()[..1].to_vec());
        let of_one = RectifyQuestion { matches: one, ..whole.clone() };
        assert_ne!(range(&of_one).1, expected);
        let of_scene = RectifyQuestion { scene: vec![whole.matches.clone()], ..of_one };
        assert_eq!(range(&of_scene), (1, expected));
        assert!(all > 1);
    }

    #[test]
    fn pictures_are_small_while_the_geometry_moves_and_large_at_rest() {
        let pixels = |question: &RectifyQuestion| {
            let rectified = question.answer(&CancelFlag::default()).unwrap();
            assert_eq!(rectified.measured, "true matches");
            let drawn = rectified.outcome.unwrap();
            assert!(drawn.full.size.width >= drawn.shown.size.width);
            assert_eq!(drawn.disparity.is_some(), !question.moving);
            if let Some((map, _)) = &drawn.disparity {
                // The disparities of the matches roughly agree with the map.
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
        let small = pixels(&RectifyQuestion { moving: true, ..example() });
        assert!(small <= DRAFT.pixels, "{small}");
        let large = pixels(&example());
        assert!(large > DRAFT.pixels && large <= SHOWN.pixels, "{large}");
    }
}
