//! The rectified pair of the geometry that the window shows, as large as it is worth drawing.
//!
//! While the geometry moves, small pictures follow it ([`DRAFT`]), which takes milliseconds; once it rests, they are
//! drawn as large as is worth looking at ([`SHOWN`]), and that is given up as soon as something newer is wanted.

use crate::app::model::picture::{Opened, Pictures};
use crate::app::model::revision;
use crate::app::model::shared::Shared;
use crate::cancel::CancelFlag;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::Picture;
use crate::io::GroundTruth;
use crate::rectify::{Limits, Rectification, RectifyError, RectifyMethod, anaglyph, rectify};

/// Pixels of a rectified picture on the screen, at most.
const SHOWN: Limits = Limits { pixels: 3_000_000 };
/// The same while the geometry moves.
const DRAFT: Limits = Limits { pixels: 200_000 };

/// The matches on which a rectification is measured.
#[derive(Debug, Clone, PartialEq)]
pub enum MatchesAtHand {
    /// Those that are known.
    True(Shared<GroundTruth>),
    /// Those that the refinement found.
    Found(Vec<PointPair>),
    /// Those that were clicked.
    Clicked(Vec<PointPair>),
}

impl MatchesAtHand {
    /// The pairs of points.
    pub fn pairs(&self) -> &[PointPair] {
        match self {
            Self::True(truth) => &truth.matches,
            Self::Found(pairs) | Self::Clicked(pairs) => pairs,
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
        rectify(&self.fundamental, frames, self.matches.pairs(), self.method, limits)
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
        Ok(self.pictures_of(&shown, cancel).map(|pictures| DrawnPair {
            full,
            shown,
            pictures,
            number: revision::fresh(),
        }))
    }

    /// Both pictures, and the anaglyph of them.
    fn pictures_of(&self, shown: &Rectification, cancel: &CancelFlag) -> Option<[Opened; 3]> {
        let left = shown.warp(0, &self.pictures[0].pixels, cancel)?;
        let right = shown.warp(1, &self.pictures[1].pixels, cancel)?;
        let both = anaglyph([&left, &right]).into();
        let opened =
            |name: &str, pixels| Picture::from_pixels(name.into(), None, pixels).ok().map(Opened::new);
        Some([opened("left", left)?, opened("right", right)?, opened("anaglyph", both)?])
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
    /// The pictures, in the order of [`Sheet`].
    pub pictures: [Opened; 3],
    /// Another number for each.
    pub number: u64,
}

/// One of the pictures of a [`DrawnPair`] pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sheet {
    /// The rectified left image.
    Left,
    /// The rectified right image.
    Right,
    /// Both in red and cyan.
    Anaglyph,
}

impl DrawnPair {
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
