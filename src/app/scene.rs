//! What panes and panels may look at: the whole state, read-only.

use super::comparison::{Comparison, Contestant};
use super::computation::{Computation, Freshness};
use super::document::{Document, Side};
use super::focus::{Focus, LineSource, Pin};
use super::inspection::Inspection;
use super::look::{Look, Tool};
use super::panels::Message;
use super::rectified::{self, Rectified, Viewing};
use super::suggesting::Suggested;
use super::theme;
use super::truth::{Known, NO_TRUTH};
use crate::estimate::{Construction, Estimate, lines_at};
use crate::geometry::{AnchoredLine, FundamentalMatrix, Line, Point, PointPair};
use crate::io::{GroundTruth, TruthFolder};

/// A position under the cursor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hover {
    /// The image under the cursor.
    pub side: Side,
    /// Where in it, px; the point that is being dragged, if one is.
    pub point: Point,
    /// Whether a point is being dragged.
    pub dragging: bool,
}

/// The state as it is drawn. Panes and panels read it and return commands.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// What is edited.
    pub document: &'a Document,
    /// Where the estimate stands.
    pub computation: &'a Computation,
    /// What is pointed at and what is chosen, here or in another part of the window.
    pub focus: &'a Focus,
    /// The position under the cursor: written in one frame, read in the next.
    pub hover: Option<Hover>,
    /// The intensities along the inspected line pair; while others are being matched, of the lines before.
    pub inspection: Option<&'a Inspection>,
    /// What is known about the pictures, whether or not it is in use.
    pub known: Option<&'a Known>,
    /// The imported geometry, in the form of a result that nobody computed.
    pub imported: Option<&'a Estimate>,
    /// The result beside other methods and the truth; while another is awaited, the comparison before.
    pub comparison: Option<&'a Comparison>,
    /// The rectified pair, while something shows it; while another is being made, the one before.
    pub rectified: Option<&'a Rectified>,
    /// Whether another rectified pair is being made.
    pub rectifying: bool,
    /// What part of the rectified pair is shown.
    pub viewing: Viewing,
    /// How far the writing of a rectified pair is, while it goes on.
    pub writing: Option<rectified::Progress>,
    /// Which overlays are shown, in the order of their list.
    pub overlays: &'a [bool],
    /// The other choices about what is drawn.
    pub look: &'a Look,
    /// What a click in an image does.
    pub tool: Tool,
    /// Where the second click of a pair may belong, once that is known.
    pub suggestion: Option<&'a Suggested>,
    /// The tab of the bottom panel; none when it is folded away.
    pub tab: Option<usize>,
    /// Whether pictures are being opened.
    pub loading: bool,
    /// Whether "Show me" has something to place.
    pub has_sample_points: bool,
    /// Whether there is something to undo, and to redo.
    pub can_undo_redo: [bool; 2],
    /// What was done last with files, for the status bar.
    pub done: Option<&'a str>,
    /// What the user was told and has not dismissed.
    pub messages: &'a [Message],
}

/// The geometry that the whole window shows: the hypothesis, the other method's or the imported one that was chosen,
/// or else the result; without a result, the imported one.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// Its matrix.
    pub fundamental: &'a FundamentalMatrix,
    /// The hypothesis, with its place in the list, if one was chosen.
    pub hypothesis: Option<(usize, &'a Estimate)>,
    /// Whose it is, if one of another method or the true one was chosen.
    pub contestant: Option<Contestant>,
    /// The result it belongs to; of an imported one without a result, itself.
    pub estimate: &'a Estimate,
    /// How that relates to the points as they are now.
    pub freshness: Freshness,
}

/// A line pair that is looked at closely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inspected {
    /// Where it comes from.
    pub source: LineSource,
    /// The line of each image, directed alike and anchored at nearly the same scene point.
    pub lines: [AnchoredLine; 2],
    /// Its colour everywhere.
    pub color: egui::Color32,
}

impl<'a> Scene<'a> {
    /// The geometry that is shown; everything that draws or measures goes by it.
    pub fn shown(&self) -> Option<Shown<'a>> {
        let own = self.computation.result();
        let chosen = self.focus.contestant() == Some(Contestant::Imported);
        let imported = self.imported.filter(|_| chosen || own.is_none());
        let (estimate, freshness) = own.or(imported.map(|imported| (imported, Freshness::Final)))?;
        let hypothesis = self.focus.hypothesis().and_then(|k| Some((k, estimate.hypotheses().get(k)?)));
        let compared = self.focus.contestant().zip(self.comparison);
        let compared = compared.and_then(|(contestant, c)| Some((contestant, c.fundamental(contestant)?)));
        let compared = compared
            .filter(|(contestant, _)| *contestant != Contestant::Imported)
            .or(imported.map(|imported| (Contestant::Imported, imported.fundamental())));
        let fundamental = match (hypothesis, compared) {
            (Some((_, hypothesis)), _) => hypothesis.fundamental(),
            (None, Some((_, fundamental))) => fundamental,
            (None, None) => estimate.fundamental(),
        };
        let contestant = compared.map(|(contestant, _)| contestant);
        Some(Shown { fundamental, hypothesis, contestant, estimate, freshness })
    }

    /// The folder whose pairs are offered, and which of them is open.
    pub fn folder(&self) -> Option<(&'a TruthFolder, [usize; 2])> {
        self.known?.folder.as_ref().map(|(folder, pair)| (folder.as_ref(), *pair))
    }

    /// Why no random trial can be drawn, if that is so.
    pub fn no_trial(&self) -> Option<&'static str> {
        match (self.known, &self.document.truth) {
            (None, _) => Some(NO_TRUTH),
            (Some(_), None) => {
                Some("A random trial clicks true matches: switch the ground truth on first (G).")
            }
            (Some(_), Some(_)) => None,
        }
    }

    /// Whether something else than the result was chosen to be shown.
    pub fn shows_another(&self) -> bool {
        self.focus.hypothesis().is_some() || self.focus.contestant().is_some()
    }

    /// Whether there is a result to go back to from the geometry that is shown.
    pub fn has_result(&self) -> bool {
        self.computation.result().is_some()
    }

    /// The ground truth in use.
    pub fn truth(&self) -> Option<&'a GroundTruth> {
        self.document.truth.as_ref()?;
        self.known.map(|known| known.truth.as_ref())
    }

    /// The lines that the geometry shown is built from: those of the hypothesis that was chosen, or else of the
    /// result, or of the best hypothesis while there is none. Other methods build from points.
    pub fn construction(&self) -> Option<&'a Construction> {
        self.shown().filter(|shown| shown.contestant.is_none())?;
        self.own_construction()
    }

    /// [`Scene::construction`] of the estimate, also while the geometry of another method is shown.
    fn own_construction(&self) -> Option<&'a Construction> {
        let shown = self.shown()?;
        let estimate = shown.hypothesis.map_or(shown.estimate, |(_, hypothesis)| hypothesis);
        estimate.assessment.lines.as_ref().map(|lines| &lines.construction)
    }

    /// The lines of a source under the geometry shown; `None` while there are none.
    pub fn lines(&self, source: LineSource) -> Option<[AnchoredLine; 2]> {
        match source {
            LineSource::Pencil { pair, angles } => {
                self.document.pairs.get(pair).map(|click| lines_at(click, angles))
            }
            LineSource::Pair(pair) => {
                let PointPair { point1, point2 } = *self.document.pairs.get(pair)?;
                let f = self.shown()?.fundamental;
                self.corresponding(&f.line1_from_point2(point2)?, &f.line2_from_point1(point1)?)
            }
            LineSource::Through { side: Side::Left, point } => {
                let f = self.shown()?.fundamental;
                let line1 = Line::joining(&f.epipole1(), &point.to_homogeneous())?;
                self.corresponding(&line1, &f.line2_from_point1(point)?)
            }
            LineSource::Through { side: Side::Right, point } => {
                let f = self.shown()?.fundamental;
                let line2 = Line::joining(&f.epipole2(), &point.to_homogeneous())?;
                self.corresponding(&f.line1_from_point2(point)?, &line2)
            }
        }
    }

    /// Two epipolar lines of the geometry shown, directed alike.
    fn corresponding(&self, line1: &Line, line2: &Line) -> Option<[AnchoredLine; 2]> {
        let turn = self
            .own_construction()
            .map(Construction::turn)
            .or_else(|| self.computation.searched().map(Estimate::turn))
            .unwrap_or(0.0);
        let f = self.shown()?.fundamental;
        let used = self.document.used_pairs().and_then(|pairs| pairs.first_chunk::<2>().copied());
        let own = Construction::of(f, used.or_else(|| self.stand_in_clicks(f))?, turn)?;
        own.corresponding(line1, line2).map(|(line1, line2)| [line1, line2])
    }

    /// Pairs that fit a geometry of which nobody clicked any: two places of the left image and the nearest points of
    /// their epipolar lines, as if the cameras had hardly moved. They only tell which ends of two lines belong
    /// together and from where to count along them.
    fn stand_in_clicks(&self, f: &FundamentalMatrix) -> Option<[PointPair; 2]> {
        let [upper, _, lower, _] = self.document.frame(Side::Left)?.corners();
        let pair = |share: f64| {
            let point1 = upper + (lower - upper) * share;
            Some(PointPair { point1, point2: f.line2_from_point1(point1)?.foot(point1) })
        };
        Some([pair(0.3)?, pair(0.65)?])
    }

    /// The second point that Enter places: the suggested match, if it is clear.
    pub fn accepted_suggestion(&self) -> Option<(Side, Point)> {
        let half = self.document.half?;
        let clear = self.suggestion?.as_ref().ok()?.clear()?;
        Some((half.side.other(), clear.position))
    }

    /// The pinned line pairs, the oldest first.
    pub fn pinned(&self) -> impl Iterator<Item = Inspected> + '_ {
        self.focus.pins().iter().filter_map(|pin: &Pin| {
            Some(Inspected { source: pin.source, lines: self.lines(pin.source)?, color: pin.color })
        })
    }

    /// The line pair that is looked at closely: the pinned one that was chosen, or else the one through the first
    /// click.
    pub fn inspected(&self) -> Option<Inspected> {
        let (source, color) = match self.focus.inspected() {
            Some(pin) => (pin.source, pin.color),
            None => (LineSource::Pair(self.document.used().next()?), theme::INSPECTED),
        };
        Some(Inspected { source, lines: self.lines(source)?, color })
    }
}
