//! The drawing of one moment.

use crate::app::model::document::Side;
use crate::app::model::focus::LineSource;
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

/// A racing hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub struct Racer {
    pub name: String,
    pub support: f64,
    /// Support at the end.
    pub at_end: f64,
    /// Place from the top. It is between two numbers while two hypotheses change places.
    pub row: f64,
}

/// The drawing of one moment, with the figures beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    pub step: MethodStep,
    /// How much farther away than usual the pictures are shown, 1 or more.
    pub zoom: f64,
    /// Marks over the pictures, from bottom to top.
    pub marks: Vec<Mark>,
    pub figures: Vec<Figure>,
    /// Line pair whose profiles are shown, if any.
    pub lines: Option<LineSource>,
    /// How far the right curve has slid to its place in the warped profile, 0 to 1.
    pub slide: f64,
    pub filled: Option<Filled>,
    /// Candidates whose crossing is shown, places in their lists.
    pub crossed: Option<[usize; 2]>,
    pub race: Vec<Racer>,
    /// Gap that is shown, px.
    pub gap: Option<f64>,
}

impl Moment {
    /// Returns the moment of a step, without any marks.
    pub(super) fn empty(step: MethodStep) -> Self {
        Self {
            step,
            zoom: 1.0,
            marks: Vec::new(),
            figures: Vec::new(),
            lines: None,
            slide: 1.0,
            filled: None,
            crossed: None,
            race: Vec::new(),
            gap: None,
        }
    }

    pub(super) fn add(&mut self, shape: Shape, ink: Ink, opacity: f64) {
        if opacity > 0.0 {
            self.marks.push(Mark { shape, ink, opacity: opacity.min(1.0) as f32 });
        }
    }

    pub(super) fn tell(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.figures.push(Figure { name: name.into(), value: value.into() });
    }
}
