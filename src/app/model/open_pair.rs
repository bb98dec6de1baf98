//! All that belongs to one opening of pictures. It is replaced as a whole when others are opened, so that nothing that
//! was found out about two pictures can be shown beside two others.

use std::sync::Arc;

use super::comparison::Comparison;
use super::computation::Computation;
use super::document::{Document, Side};
use super::focus::Focus;
use super::inspection::Inspection;
use super::messages::LastDone;
use super::pair_folder::PairFolder;
use super::picture::{Opened, Pictures};
use super::point_table::PointOrder;
use super::recording::Player;
use super::rectified::{Rectified, Viewing};
use super::suggesting::Suggested;
use super::tones::{Tones, TonesCommand};
use super::truth::KnownTruth;
use crate::estimate::Estimate;
use crate::geometry::{Point, PointPair};
use crate::suggest::NextClick;

/// A folder, and which of its pairs is open.
pub type OpenFolder = (Arc<PairFolder>, [usize; 2]);

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

/// The pictures that are open, with everything that was found out about them and chosen on them.
#[derive(Default)]
pub struct OpenPair {
    /// The pictures, once there are any.
    pub pictures: Option<[Opened; 2]>,
    /// Point pairs for "Show me", when there are any.
    pub show_me: Option<[PointPair; 2]>,
    /// What is known about the pictures, whether or not it is in use.
    pub known: Option<KnownTruth>,
    /// The folder that they are of, and which of its pairs they are.
    pub folder: Option<OpenFolder>,
    /// What was done last, for the status bar.
    pub done: LastDone,
    /// Where the estimate stands.
    pub computation: Computation,
    /// The imported geometry, in the form of a result that nobody computed.
    pub imported: Option<Estimate>,
    /// The result beside other methods and the truth; while another is awaited, the comparison before.
    pub comparison: Option<Comparison>,
    /// The intensities along the inspected line pair; while others are being matched, of the lines before.
    pub inspection: Option<Inspection>,
    /// Where the second click of a pair may belong, once that is known.
    pub suggestion: Option<Suggested>,
    /// Where one more pair would tell most, once that is known, if it is anywhere.
    pub next_click: Option<Option<NextClick>>,
    /// The rectified pair, while something shows it; while another is being made, the one before.
    pub rectified: Option<Rectified>,
    /// What part of the rectified pair is shown.
    pub viewing: Viewing,
    /// What is pointed at and what is chosen, here or in another part of the window.
    pub focus: Focus,
    /// How bright and dark the pictures are shown.
    pub tones: Tones,
    /// Which frames are shown, where they are sequences.
    pub player: Player,
    /// The order of the list of point pairs.
    pub points: PointOrder,
    /// The position under the cursor: written in one frame, read in the next.
    pub hover: Option<Hover>,
    /// The document right after a click placed a point, for a second click to take it back.
    pub placed: Option<Document>,
    /// The result that the chosen hypothesis belongs to.
    revision: u64,
}

impl OpenPair {
    /// Two pictures, with what is known about them beforehand.
    pub fn new(pictures: [Opened; 2], known: Option<KnownTruth>, show_me: Option<[PointPair; 2]>) -> Self {
        Self { pictures: Some(pictures), known, show_me, ..Self::default() }
    }

    /// The pixels of both.
    pub fn pictures(&self) -> Option<Pictures> {
        Some(self.pictures.as_ref()?.each_ref().map(|opened| opened.picture.clone()))
    }

    /// Shows the pictures brighter, darker or in other colours.
    pub fn adjust_tones(&mut self, command: TonesCommand) {
        let pictures = self.pictures();
        self.tones.apply(command, pictures.as_ref());
    }

    /// Forgets the hypothesis that was chosen when its result is gone: its number belongs to one result.
    pub fn follow_result(&mut self) {
        if self.revision != self.computation.revision() {
            self.revision = self.computation.revision();
            self.focus.forget_hypothesis();
        }
    }

    /// Brings the imported geometry in line with the document.
    pub fn follow_imported(&mut self, document: &Document) {
        let wanted = document.imported.as_ref().map(|imported| imported.fundamental);
        if wanted != self.imported.as_ref().map(|estimate| *estimate.fundamental()) {
            self.imported = wanted.map(Estimate::from);
        }
    }
}
