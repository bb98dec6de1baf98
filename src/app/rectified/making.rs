//! The rectified pair of the geometry that the window shows, made in a thread of its own.
//!
//! While the geometry moves, small pictures follow it ([`DRAFT`]), which takes milliseconds; once it rests, they are
//! drawn as large as is worth looking at ([`SHOWN`]), and that is given up as soon as something newer is wanted.

use std::cell::RefCell;
use std::sync::Arc;

use crate::app::background::Latest;
use crate::app::loader::Opened;
use crate::app::panes::PictureTexture;
use crate::app::waker::Waker;
use crate::cancel::CancelFlag;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::Picture;
use crate::io::GroundTruth;
use crate::rectify::{Limits, Method, Rectification, RectifyError, anaglyph, rectify};

/// Pixels of a rectified picture on the screen, at most.
const SHOWN: Limits = Limits { pixels: 3_000_000 };
/// The same while the geometry moves.
const DRAFT: Limits = Limits { pixels: 200_000 };

/// The matches on which a rectification is measured.
#[derive(Clone)]
pub enum Matches {
    /// Those that are known.
    True(Arc<GroundTruth>),
    /// Those that the refinement found.
    Found(Vec<PointPair>),
    /// Those that were clicked.
    Clicked(Vec<PointPair>),
}

impl Matches {
    /// They themselves.
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

impl PartialEq for Matches {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::True(a), Self::True(b)) => Arc::ptr_eq(a, b),
            (Self::Found(a), Self::Found(b)) | (Self::Clicked(a), Self::Clicked(b)) => a == b,
            _ => false,
        }
    }
}

/// What is to be rectified.
#[derive(Clone)]
pub struct Question {
    /// The pictures.
    pub pictures: [Arc<Picture>; 2],
    /// The geometry that the window shows.
    pub fundamental: FundamentalMatrix,
    /// What is measured.
    pub matches: Matches,
    /// The method that was chosen.
    pub method: Method,
    /// Whether another geometry is likely to come at once.
    pub moving: bool,
}

impl PartialEq for Question {
    fn eq(&self, other: &Self) -> bool {
        let same = |k: usize| Arc::ptr_eq(&self.pictures[k], &other.pictures[k]);
        same(0)
            && same(1)
            && self.fundamental == other.fundamental
            && self.matches == other.matches
            && self.method == other.method
            && self.moving == other.moving
    }
}

impl Question {
    /// Rectifies as large as `limits` allow.
    pub fn rectification(&self, limits: &Limits) -> Result<Rectification, RectifyError> {
        let frames = self.pictures.each_ref().map(|picture| picture.frame());
        rectify(&self.fundamental, frames, self.matches.pairs(), self.method, limits)
    }

    /// The pair for the screen; `None` when cancelled.
    fn answer(&self, cancel: &CancelFlag) -> Option<Rectified> {
        let outcome = match self.drawn(cancel) {
            Ok(drawn) => Ok(drawn?),
            Err(error) => Err(error),
        };
        Some(Rectified { fundamental: self.fundamental, measured: self.matches.name(), outcome })
    }

    fn drawn(&self, cancel: &CancelFlag) -> Result<Option<Drawn>, RectifyError> {
        let full = self.rectification(&Limits::default())?;
        let limits = if self.moving { DRAFT } else { SHOWN };
        let fits = full.size.width * full.size.height <= limits.pixels;
        let shown = if fits { full.clone() } else { self.rectification(&limits)? };
        Ok(self.pictures_of(&shown, cancel).map(|pictures| Drawn {
            full,
            shown,
            pictures,
            textures: RefCell::default(),
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
    pub outcome: Result<Drawn, RectifyError>,
}

/// A pair for the screen.
pub struct Drawn {
    /// As it would be written, with its measures.
    pub full: Rectification,
    /// As it is drawn, perhaps smaller; places in the pictures are in its pixels.
    pub shown: Rectification,
    pictures: [Opened; 3],
    /// Uploaded when first drawn. Nothing but a cache, so drawing may fill it.
    textures: RefCell<[Option<PictureTexture>; 3]>,
}

/// One of the pictures of a [`Drawn`] pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sheet {
    /// The rectified left image.
    Left,
    /// The rectified right image.
    Right,
    /// Both in red and cyan.
    Anaglyph,
}

impl Drawn {
    /// Size of every picture, px.
    pub fn frame(&self) -> Frame {
        self.shown.size
    }

    /// Lets `draw` draw one of the pictures.
    pub fn with_texture(&self, ctx: &egui::Context, sheet: Sheet, draw: impl FnOnce(&mut PictureTexture)) {
        let opened = &self.pictures[sheet as usize];
        let mut textures = self.textures.borrow_mut();
        draw(
            textures[sheet as usize].get_or_insert_with(|| {
                PictureTexture::new(ctx, Arc::clone(&opened.picture), &opened.overview)
            }),
        );
    }
}

/// The thread that rectifies, and its latest answer.
pub struct Rectifying {
    thread: Latest<(Question, CancelFlag), Rectified>,
    asked: Option<Question>,
    /// Stops what is being drawn at full size.
    cancel: CancelFlag,
    latest: Option<Rectified>,
}

impl Rectifying {
    /// Starts the thread.
    pub fn new(waker: Waker) -> Self {
        let answer = |(question, cancel): (Question, CancelFlag)| question.answer(&cancel);
        let thread = Latest::new("rectification", waker, answer);
        Self { thread, asked: None, cancel: CancelFlag::default(), latest: None }
    }

    /// Asks when the question is another one than before; without a question there is nothing to show.
    pub fn follow(&mut self, question: Option<Question>) {
        if question == self.asked {
            return;
        }
        // Small pictures are finished, or a drag, which asks in every frame, would show none.
        if self.asked.as_ref().is_some_and(|asked| !asked.moving) {
            self.cancel.cancel();
        }
        self.asked.clone_from(&question);
        let Some(question) = question else {
            self.forget();
            return;
        };
        self.cancel = CancelFlag::default();
        self.thread.ask((question, self.cancel.clone()));
    }

    /// Drops what is known: nothing shows it, or the pictures are others.
    pub fn forget(&mut self) {
        self.cancel.cancel();
        self.thread.forget();
        (self.asked, self.latest) = (None, None);
    }

    /// Takes in what the thread has made.
    pub fn take_news(&mut self) {
        if let Some(rectified) = self.thread.poll() {
            self.latest = Some(rectified);
        }
    }

    /// The latest answer; while another is awaited, the one before.
    pub fn latest(&self) -> Option<&Rectified> {
        self.latest.as_ref()
    }

    /// Whether an answer is awaited.
    pub fn is_busy(&self) -> bool {
        self.thread.is_busy()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::sample::sample_pair;
    use std::time::{Duration, Instant};

    fn question() -> Question {
        let sample = sample_pair();
        Question {
            pictures: sample.pictures.map(Arc::new),
            fundamental: sample.truth.fundamental,
            matches: Matches::True(Arc::new(sample.truth)),
            method: Method::Auto,
            moving: false,
        }
    }

    fn wait(rectifying: &mut Rectifying) {
        let start = Instant::now();
        while rectifying.is_busy() {
            assert!(start.elapsed() < Duration::from_secs(20), "no answer");
            std::thread::sleep(Duration::from_millis(1));
            rectifying.take_news();
        }
    }

    #[test]
    fn a_moving_geometry_gives_small_pictures_and_one_at_rest_large_ones() {
        let mut rectifying = Rectifying::new(Waker::default());
        let pixels = |rectifying: &Rectifying| {
            let drawn = rectifying.latest().unwrap().outcome.as_ref().unwrap();
            assert!(drawn.full.size.width >= drawn.shown.size.width);
            drawn.frame().width * drawn.frame().height
        };
        rectifying.follow(Some(Question { moving: true, ..question() }));
        wait(&mut rectifying);
        let small = pixels(&rectifying);
        assert!(small <= DRAFT.pixels, "{small}");
        rectifying.follow(Some(question()));
        wait(&mut rectifying);
        let large = pixels(&rectifying);
        assert!(large > DRAFT.pixels && large <= SHOWN.pixels, "{large}");
        assert_eq!(rectifying.latest().unwrap().measured, "true matches");
    }

    #[test]
    fn only_the_newest_question_is_answered_in_the_end() {
        let mut rectifying = Rectifying::new(Waker::default());
        let first = question();
        let methods = [Method::Planar, Method::Auto, Method::Planar, Method::Polar];
        for method in methods {
            rectifying.follow(Some(Question { method, ..first.clone() }));
        }
        wait(&mut rectifying);
        let drawn = rectifying.latest().unwrap().outcome.as_ref().unwrap();
        assert_eq!(drawn.full.method, Method::Polar);
        rectifying.follow(None);
        assert!(rectifying.latest().is_none() && !rectifying.is_busy());
    }

    #[test]
    fn what_was_cancelled_gives_nothing() {
        let cancel = CancelFlag::default();
        cancel.cancel();
        assert!(question().answer(&cancel).is_none());
    }
}
