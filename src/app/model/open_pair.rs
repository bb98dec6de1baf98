//! State that belongs to one opening of pictures. Opening others replaces it as a whole, so no
//! finding is ever shown beside the wrong pictures.

use std::sync::Arc;

use super::comparison::Comparison;
use super::computation::Computation;
use super::crosshair::Crosshair;
use super::document::{Document, Side};
use super::focus::Focus;
use super::inspection::Inspection;
use super::messages::LastDone;
use super::picture::{Opened, Pictures};
use super::recording::Player;
use super::rectified::{Rectified, Viewing};
use super::replay::Replay;
use super::scene::Scene;
use super::suggesting::{LensQuestion, PairsQuestion, Suggested};
use super::truth::{KnownTruth, NO_TRUTH};
use crate::camera::{CameraModel, FocalLength, Orbit, PicturesOf, ViewPair};
use crate::estimate::{DivisionFit, Estimate};
use crate::geometry::{Frame, Point, PointPair};
use crate::image::Rendition;
use crate::io::PictureFolder;
use crate::study::{PlaceFound, Study};
use crate::suggest::NextClick;

/// A folder, and the numbers of the two views that are open.
pub type OpenFolder = (Arc<PictureFolder>, [usize; 2]);

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hover {
    pub side: Side,
    /// Position in the image, px. During a drag, the position of the dragged point.
    pub point: Point,
    pub dragging: bool,
}

/// The open pictures, with all findings about them and selections on them.
#[derive(Default)]
pub struct OpenPair {
    pub pictures: Option<[Opened; 2]>,
    /// Point pairs for "Show me", if the pictures have any.
    pub show_me: Option<[PointPair; 2]>,
    /// Ground truth of the pictures as they are.
    pub(super) known: Option<KnownTruth>,
    /// Cameras with which the pictures were opened.
    pub cameras_at_first: Option<[CameraModel; 2]>,
    /// Folder of the pictures, and their numbers in it.
    pub folder: Option<OpenFolder>,
    /// The last action, for the status bar.
    pub done: LastDone,
    /// Progress and result of the estimate.
    pub computation: Computation,
    /// The course of the search, as far as it is shown.
    pub replay: Replay,
    /// The imported geometry as an estimate without a search.
    pub imported: Option<Estimate>,
    /// Comparison of the result with other methods and the truth. The old comparison stays until
    /// the new one arrives.
    pub comparison: Option<Comparison>,
    /// Intensities along the inspected line pair. The old ones stay until the new lines are
    /// matched.
    pub inspection: Option<Inspection>,
    /// Suggested places for the second click of a pair, once known.
    pub suggestion: Option<Suggested>,
    /// Most useful place for one more pair, once known. The inner `None`: no place stands out.
    pub next_click: Option<Option<NextClick>>,
    /// Lens that explains the matches clearly better than one result without it, once sought. The inner
    /// `None`: there is no such lens.
    pub lens: Option<(LensQuestion, Option<DivisionFit>)>,
    /// Places of the matches of the pairs, once sought for one result.
    pub places: Option<(PairsQuestion, Vec<PlaceFound>)>,
    /// The rectified pair, while it is visible. The old one stays until the new one is made.
    pub rectified: Option<Rectified>,
    /// Visible part of the rectified pair.
    pub viewing: Viewing,
    /// Relative pose and scene points of the result, once computed. The inner `None`: the matches do not
    /// determine a pose.
    pub scene: Option<Option<Scene>>,
    /// View of the scene; `None` shows all of it.
    pub orbit: Option<Orbit>,
    /// Hovered and selected things, in all parts of the window.
    pub focus: Focus,
    /// Black and white of both pictures on the screen, if they are stretched.
    pub stretched: Option<[Rendition; 2]>,
    /// Visible frames of sequences.
    pub player: Player,
    /// Position of the cursor: written in one frame, read in the next.
    pub hover: Option<Hover>,
    pub crosshair: Option<Crosshair>,
    /// Whether the pictures are shown without bars and dock.
    pub alone: bool,
    /// Whether the lines of the present result are drawn although it is unreliable.
    pub lines_anyway: bool,
    /// Document after a click placed a point, so that a double click can take the point back.
    pub placed: Option<Document>,
    /// Revision of the result that the selected hypothesis belongs to.
    revision: u64,
}

impl OpenPair {
    /// Creates the state of two pictures, with their ground truth and sample points.
    pub fn new(pictures: [Opened; 2], known: Option<KnownTruth>, show_me: Option<[PointPair; 2]>) -> Self {
        Self { pictures: Some(pictures), known, show_me, ..Self::default() }
    }

    /// Returns the ground truth of the pictures, whether or not it is in use. It belongs to the pictures as they
    /// are, so there is none for views without their distortion.
    pub fn known(&self) -> Option<&KnownTruth> {
        self.known.as_ref().filter(|_| self.undistorted().is_none())
    }

    /// Explains why there is no ground truth to compare with.
    pub fn why_no_truth(&self) -> &'static str {
        match self.known {
            Some(_) => {
                "The ground truth belongs to the pictures as they are. Remove the lens correction to compare with it."
            }
            None => NO_TRUTH,
        }
    }

    pub fn pictures(&self) -> Option<Pictures> {
        Some(self.pictures.as_ref()?.each_ref().map(|opened| opened.picture.clone()))
    }

    /// Returns a pair of places in the pictures on the screen as points of the window's coordinates.
    pub fn points_of(&self, pixels: &PointPair) -> Option<PointPair> {
        let Some([left, right]) = &self.pictures else { return Some(*pixels) };
        Some(PointPair { point1: left.point(pixels.point1)?, point2: right.point(pixels.point2)? })
    }

    /// Returns a point of the window's coordinates as a place in the picture on the screen.
    pub fn pixel(&self, side: Side, point: Point) -> Point {
        let opened = self.pictures.as_ref().map(|pictures| &pictures[side.index()]);
        opened.and_then(|opened| opened.pixel(point)).unwrap_or(point)
    }

    /// Returns a pair of points of the window's coordinates as places in the pictures on the screen.
    pub fn pixels_of(&self, points: &PointPair) -> PointPair {
        PointPair {
            point1: self.pixel(Side::Left, points.point1),
            point2: self.pixel(Side::Right, points.point2),
        }
    }

    /// Returns the point of the window's coordinates of a place in the picture on the screen.
    pub fn point(&self, side: Side, pixel: Point) -> Option<Point> {
        let Some(pictures) = &self.pictures else { return Some(pixel) };
        pictures[side.index()].point(pixel)
    }

    pub fn shown_frame(&self, side: Side) -> Option<Frame> {
        Some(self.pictures.as_ref()?[side.index()].shown().frame())
    }

    /// Returns the views without distortion, if the coordinates of the window differ from the pixels.
    pub fn undistorted(&self) -> Option<ViewPair> {
        self.views().filter(ViewPair::is_undistorted)
    }

    /// Returns the pictures that the coordinates of the window belong to.
    pub fn pictures_of(&self) -> PicturesOf {
        PicturesOf::from(self.views().as_ref())
    }

    /// Returns the views without distortion, if both pictures have a calibrated camera.
    pub fn views(&self) -> Option<ViewPair> {
        let [left, right] = self.pictures.as_ref()?.each_ref().map(|opened| opened.lens.as_ref());
        Some(ViewPair { views: [left?.view, right?.view] })
    }

    /// Returns the calibrated cameras of the pictures, if both have one.
    pub fn cameras(&self) -> Option<[CameraModel; 2]> {
        let [left, right] = self.pictures.as_ref()?.each_ref().map(|opened| opened.lens.as_ref());
        Some([*left?.view.camera(), *right?.view.camera()])
    }

    /// Returns the coefficients of the distortion that is corrected without a calibration.
    pub fn corrected_lens(&self) -> Option<[f64; 2]> {
        let [left, right] = self.pictures.as_ref()?.each_ref().map(|opened| {
            let lens = opened.lens.as_ref()?;
            lens.view.camera().division(lens.original.frame())
        });
        Some([left?, right?])
    }

    /// Returns the views whose cameras take part in a search.
    pub fn searched_views(&self) -> Option<ViewPair> {
        self.views().filter(Study::searches_with)
    }

    /// Returns the views of cameras with focal lengths, which a pose needs.
    pub fn posed_views(&self) -> Option<ViewPair> {
        self.views().filter(ViewPair::has_focal_lengths)
    }

    /// Returns whether focal lengths can be given: no calibration includes them.
    pub fn takes_focal_lengths(&self) -> bool {
        self.pictures.is_some() && (self.undistorted().is_none() || self.corrected_lens().is_some())
    }

    /// Gives the pictures their focal lengths. All coordinates stay. Guessed lengths leave the result, too; known
    /// ones take part in the search.
    pub fn set_focal_lengths(&mut self, lengths: [FocalLength; 2]) {
        let Some(pictures) = self.pictures.clone().filter(|_| self.takes_focal_lengths()) else { return };
        let mut lengths = lengths.into_iter();
        let [left, right] = pictures.map(|opened| opened.with_focal_length(lengths.next()?));
        self.pictures = left.zip(right).map(Into::into).or(self.pictures.take());
    }

    /// Stretches both pictures on the screen, each over its own range, or shows them as in their files.
    pub fn toggle_stretch(&mut self) {
        let pictures = self.pictures().filter(|_| self.stretched.is_none());
        self.stretched = pictures.map(|pictures| pictures.map(|picture| Rendition::stretched(&picture)));
    }

    /// Returns how a picture appears on the screen.
    pub fn rendition(&self, side: Side) -> Rendition {
        self.stretched.map_or_else(Rendition::default, |stretched| stretched[side.index()])
    }

    /// Deselects the hypothesis and hides the lines of an unreliable geometry when the result is replaced. Both
    /// belong to one result.
    pub fn follow_result(&mut self) {
        if self.revision != self.computation.revision() {
            self.revision = self.computation.revision();
            self.focus.forget_hypothesis();
            self.lines_anyway = false;
        }
    }

    /// Updates the imported geometry from the document.
    pub fn follow_imported(&mut self, document: &Document) {
        let wanted = document.imported.as_ref().map(|imported| imported.fundamental);
        if wanted != self.imported.as_ref().map(|estimate| *estimate.fundamental()) {
            self.imported = wanted.map(Estimate::from);
        }
    }
}
