//! The drawing of one moment.

use crate::app::model::document::{LineSource, Side};
use crate::app::model::focus::{Replayed, Target};
use crate::app::model::ids::MethodStep;
use crate::geometry::{HomogeneousPoint, Line, Point, PointPair};

/// Meaning of a mark, for its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Something of a point pair, by its number.
    Pair(usize),
    /// Not checked yet: candidates, hypotheses, matches.
    Unchecked,
    /// The one looked at.
    Lit,
    RoundTrip,
    /// The result, in the colour of its verdict.
    Verdict,
}

/// Part of the drawing over the pictures.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A line in each picture.
    Lines { lines: [Option<Line>; 2], width: f32, dashed: bool },
    /// A dot in each picture, an arrow at the edge if it is outside. `drop` is its size, times the usual.
    Dots { at: [HomogeneousPoint; 2], drop: f32 },
    /// A ring that grows about a dot: `share` of its way.
    Ripple { at: [HomogeneousPoint; 2], share: f32 },
    /// A match: a dot in each picture, and a stroke to the place of its partner.
    Stroke { pair: PointPair, has_stroke: bool },
    /// An area of the left picture.
    Area(Vec<Point>),
    /// A text beside a place of one picture.
    Note { side: Side, at: Point, text: String },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    pub shape: Shape,
    pub ink: Ink,
    /// Opacity, 0 to 1.
    pub opacity: f32,
    /// The thing that the mark belongs to, if it can be pointed at.
    pub target: Option<Target>,
}

/// A figure of the step, in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    pub name: String,
    pub value: String,
}

/// Part of the matrix of a pencil that is filled already.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filled {
    /// Number of the pencil, 0 or 1.
    pub pencil: usize,
    /// Number of rows, lines of the left picture, that have been compared.
    pub rows: usize,
}

/// Barcodes of a line pair, as far as they have grown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grown {
    /// The line, by its place in the sweep; `None` for the pair that is held.
    pub line: Option<usize>,
    /// Number of frames whose bits are shown.
    pub frames: usize,
    /// Number of lines of the sweep that are shown.
    pub swept: usize,
}

/// A racing hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub struct Racer {
    pub name: String,
    /// Place in the record.
    pub place: usize,
    pub support: f64,
    /// Support at the end.
    pub at_end: f64,
    /// Place from the top. It is between two numbers while two hypotheses change places.
    pub row: f64,
}

/// The drawing of one moment, with the figures beside it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Moment {
    pub step: MethodStep,
    /// How much farther away than usual the pictures are shown, 1 or more.
    pub zoom: f64,
    /// Marks over the pictures, from bottom to top.
    pub marks: Vec<Mark>,
    pub figures: Vec<Figure>,
    /// Line pair whose profiles are shown, if any.
    pub lines: Option<LineSource>,
    /// Hypothesis of the result whose lines are drawn, by its place in the list, if it was kept.
    pub kept: Option<usize>,
    /// How far the right curve has slid to its place in the warped profile, 0 to 1.
    pub slide: f64,
    pub filled: Option<Filled>,
    /// Frames that the pictures show, left and right, if they run.
    pub frames: Option<[usize; 2]>,
    /// Number of silhouettes that have piled up in each picture.
    pub piled: Option<[usize; 2]>,
    pub grown: Option<Grown>,
    /// Candidates whose crossing is shown, places in their lists.
    pub crossed: Option<[usize; 2]>,
    pub race: Vec<Racer>,
    /// Gap that is shown, px.
    pub gap: Option<f64>,
}

impl Moment {
    /// Returns the moment of a step, without any marks.
    pub(super) fn empty(step: MethodStep) -> Self {
        Self { step, zoom: 1.0, slide: 1.0, ..Self::default() }
    }

    pub(super) fn add(&mut self, shape: Shape, ink: Ink, opacity: f64) {
        self.add_of(None, shape, ink, opacity);
    }

    /// Adds a mark of a part of the record that can be pointed at.
    pub(super) fn add_part(&mut self, part: Replayed, shape: Shape, ink: Ink, opacity: f64) {
        self.add_of(Some(Target::Replayed(part)), shape, ink, opacity);
    }

    pub(super) fn add_of(&mut self, target: Option<Target>, shape: Shape, ink: Ink, opacity: f64) {
        if opacity > 0.0 {
            self.marks.push(Mark { shape, ink, opacity: opacity.min(1.0) as f32, target });
        }
    }

    pub(super) fn tell(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.figures.push(Figure { name: name.into(), value: value.into() });
    }
}
