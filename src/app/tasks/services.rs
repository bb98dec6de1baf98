//! Computations and dialogs of the window, which tests can replace.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::app::model::computation::EstimateRequest;
use crate::app::model::document::Side;
use crate::app::model::picture::Pictures;
use crate::app::model::recording::Synchronised;
use crate::app::model::shared::Shared;
use crate::app::model::suggesting::{
    LensQuestion, NextClickQuestion, PlaceFound, PlacesQuestion, RepairOutcome, RepairQuestion,
    SuggestQuestion, Suggested,
};
use crate::app::model::verdict::sentence;
use crate::cancel::CancelFlag;
use crate::estimate::{
    DivisionFit, Estimate, EstimateError, Match, Monitor, PreparedPair, estimate_prepared, find_lens, follow,
};
use crate::geometry::{Point, PointPair};
use crate::image::RelativeView;
use crate::io::{IMAGE_EXTENSIONS, VIDEO_EXTENSIONS};
use crate::motion::MotionError;
use crate::suggest::{
    ClickedImage, Known, NextClick, Rival, SuggestParameters, next_click, refine, suggest, view_at,
};

/// Distance from the match, as a share of the longer side, from which a pair counts as misplaced along its
/// line. Measurements of suggestions count a larger distance from the truth as wrong.
const SLID: f64 = 0.01;

/// Searches for a geometry. Tests replace the estimator of this library.
pub type EstimateFn = dyn FnMut(&EstimateRequest, &Monitor) -> Result<Estimate, EstimateError> + Send;

/// Refits the best supported of the earlier geometries of these pictures to moved points, within
/// milliseconds.
pub type FollowFn = dyn FnMut(&EstimateRequest, &[&Estimate]) -> Option<Estimate> + Send;

/// Prepares data that depends on the pictures only.
pub type PrepareFn = dyn FnMut(&Pictures, &CancelFlag) + Send;

/// A computation that answers questions.
pub type AnswerFn<Q, A> = dyn FnMut(&Q) -> A + Send;

/// Asks for a path with a dialog of the system, and returns when the dialog is closed.
pub type PickFn = dyn Fn() -> Option<PathBuf> + Send + Sync;

/// Asks for a path to write to, with a dialog of the system that suggests a path.
pub type SavePickFn = dyn Fn(&Path) -> Option<PathBuf> + Send + Sync;

pub struct Services {
    /// Preparation of data that depends on the pictures only, as soon as they are open.
    pub prepare: Box<PrepareFn>,
    pub estimate: Box<EstimateFn>,
    /// Refit to moved points while the search goes on.
    pub follow: Box<FollowFn>,
    /// Suggestion for the second click of a pair, within some hundredths of a second.
    pub suggest: Box<AnswerFn<SuggestQuestion, Suggested>>,
    /// Most useful place for one more pair, within milliseconds.
    pub next_click: Box<AnswerFn<NextClickQuestion, Option<NextClick>>>,
    /// Distortion of the lens, within some tenths of a second.
    pub lens: Box<AnswerFn<LensQuestion, Option<DivisionFit>>>,
    /// Matches of the pairs along their lines, within some hundredths of a second for each.
    pub places: Box<AnswerFn<PlacesQuestion, Vec<PlaceFound>>>,
    /// Better place for a placed pair, within some hundredths of a second.
    pub repair: Box<AnswerFn<RepairQuestion, RepairOutcome>>,
    /// System dialog for a file; `None` when cancelled or unable to open.
    pub pick_file: Arc<PickFn>,
    /// System dialog for a folder; `None` when cancelled or unable to open.
    pub pick_folder: Arc<PickFn>,
    /// System dialog for a path to write to; `None` when cancelled or unable to open.
    pub pick_save: Arc<SavePickFn>,
    /// Folder for the program's own copies of unsaved work; `None` keeps no copies.
    pub copies: Option<PathBuf>,
}

impl Default for Services {
    fn default() -> Self {
        let searching = PreparedCache::default();
        let [preparing, following, suggesting, advising, straightening, checking, repairing] =
            std::array::from_fn(|_| searching.clone());
        Self {
            prepare: Box::new(move |pictures, cancel| preparing.get(pictures).make_ready(cancel)),
            estimate: Box::new(move |request, monitor| {
                let prepared = searching.get_for(request)?;
                estimate_prepared(&prepared, &request.pairs, &request.parameters, monitor)
            }),
            follow: Box::new(move |request, starts| {
                // The refit uses patches; sequences are compared by barcodes.
                if request.recordings.is_some() {
                    return None;
                }
                let prepared = following.get(&request.pictures);
                follow(&prepared, starts.iter().copied(), &request.pairs, &request.parameters)
            }),
            suggest: Box::new(move |question| {
                let prepared = suggesting.get(&question.pictures);
                let clicked = match question.half.side {
                    Side::Left => ClickedImage::First,
                    Side::Right => ClickedImage::Second,
                };
                let view = || view_at(&prepared, &question.placed);
                let at = question.half.point;
                suggested(&prepared, at, clicked, question.found.as_deref(), view)
            }),
            next_click: Box::new(move |question| {
                let prepared = advising.get(&question.pictures);
                let found = &question.found;
                let matches: Vec<_> = found.matches().iter().map(|found| found.pair).collect();
                next_click(&prepared, found.fundamental(), &Rival::of(found), &question.placed, &matches)
            }),
            lens: Box::new(move |question| {
                find_lens(&straightening.get(&question.pictures), &question.found)
            }),
            places: Box::new(move |question| places(&checking.get(&question.pictures), question)),
            repair: Box::new(move |question| repaired(&repairing.get(&question.pictures), question)),
            pick_file: Arc::new(pick_file),
            pick_folder: Arc::new(pick_folder),
            pick_save: Arc::new(pick_save),
            copies: None,
        }
    }
}

/// Suggests matches of a point with the geometry, the view and the matches of a result. Without a result,
/// `view` may tell how the images are turned.
fn suggested(
    prepared: &PreparedPair,
    at: Point,
    clicked: ClickedImage,
    found: Option<&Estimate>,
    view: impl FnOnce() -> Option<RelativeView>,
) -> Suggested {
    let matches: Vec<PointPair> =
        found.iter().flat_map(|found| found.matches()).map(|found| found.pair).collect();
    let fundamental = found.map(|found| *found.fundamental());
    let known = Known { fundamental, view: found.map(Estimate::view).or_else(view), matches: &matches };
    suggest(prepared, at, clicked, &known, &SuggestParameters::default())
}

/// Looks for the matches of pairs along their epipolar lines.
fn places(prepared: &PreparedPair, question: &PlacesQuestion) -> Vec<PlaceFound> {
    let least = SLID * prepared.frames()[1].longer_side();
    let view = Some(question.found.view());
    let check = |pair: &PointPair| {
        let found = suggested(prepared, pair.point1, ClickedImage::First, Some(&question.found), || None);
        let place = found.ok().and_then(|found| Some(found.clear()?.position));
        let is_there = place.is_some_and(|place| (place - pair.point2).norm() <= least);
        // At the border of two surfaces, each has its own match. The pair may be of the other one.
        let is_alike = || refine(prepared, pair, view, &SuggestParameters::default()).is_ok();
        PlaceFound { pair: *pair, place, is_confirmed: is_there || is_alike() }
    };
    question.pairs.iter().map(check).collect()
}

/// Returns a better place for the right point of a pair, near its present place.
fn repaired(prepared: &PreparedPair, RepairQuestion { points, found, .. }: &RepairQuestion) -> RepairOutcome {
    let view = found.as_deref().map(Estimate::view);
    let refined = refine(prepared, points, view, &SuggestParameters::default());
    refined.map(|found| found.position).map_err(|error| sentence(&error.to_string()))
}

/// Data that depends on the pictures only. It is kept between requests and shared by the threads,
/// so that moving a point costs little.
#[derive(Clone, Default)]
struct PreparedCache(Arc<Mutex<Option<CachedPair>>>);

struct CachedPair {
    pictures: Pictures,
    recordings: Option<Synchronised>,
    /// Matches from elsewhere, and the seed of their fit.
    given: Option<(Shared<Vec<Match>>, u64)>,
    prepared: Arc<PreparedPair>,
}

impl PreparedCache {
    /// Returns the prepared pictures, with or without matches from elsewhere.
    fn get(&self, pictures: &Pictures) -> Arc<PreparedPair> {
        let is_right = |kept: &CachedPair| kept.pictures == *pictures && kept.recordings.is_none();
        self.get_or(is_right, || CachedPair {
            pictures: pictures.clone(),
            recordings: None,
            given: None,
            prepared: Arc::new(prepare(pictures)),
        })
    }

    /// Returns the prepared pictures of an estimate, with the silhouettes of its sequences and its matches
    /// from elsewhere.
    fn get_for(&self, request: &EstimateRequest) -> Result<Arc<PreparedPair>, MotionError> {
        let EstimateRequest { pictures, recordings, given, parameters, .. } = request;
        let silhouettes = recordings.as_ref().map(Synchronised::overlapping).transpose()?;
        let given = given.as_ref().map(|given| (given.clone(), parameters.seed));
        let is_right = |kept: &CachedPair| {
            kept.pictures == *pictures && kept.recordings == *recordings && kept.given == given
        };
        Ok(self.get_or(is_right, || {
            let mut prepared = prepare(pictures);
            if let Some((matches, seed)) = &given {
                // The import has told if they agree on no geometry.
                let _ = prepared.add_matches(matches, *seed);
            }
            if let Some(silhouettes) = silhouettes {
                prepared = prepared.with_silhouettes(silhouettes);
            }
            let (pictures, recordings) = (pictures.clone(), recordings.clone());
            CachedPair { pictures, recordings, given: given.clone(), prepared: Arc::new(prepared) }
        }))
    }

    /// Returns the kept pair if it is the right one, or makes another.
    fn get_or(
        &self,
        is_right: impl Fn(&CachedPair) -> bool,
        make: impl FnOnce() -> CachedPair,
    ) -> Arc<PreparedPair> {
        // A panic during preparation leaves the old pair, which is valid.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = kept.as_ref().filter(|kept| is_right(kept)) {
            return Arc::clone(&kept.prepared);
        }
        let made = make();
        let prepared = Arc::clone(&made.prepared);
        *kept = Some(made);
        prepared
    }
}

fn prepare([image1, image2]: &Pictures) -> PreparedPair {
    PreparedPair::new(&image1.gray, &image2.gray)
}

fn pick_file() -> Option<PathBuf> {
    let others = ["json", "txt", "csv", "tsv", "dat", "yml", "yaml", "npz", "P"];
    let dialog = rfd::FileDialog::new().set_title("Open a file").add_filter("Images", &IMAGE_EXTENSIONS);
    let dialog = dialog.add_filter("Sequences of frames", &VIDEO_EXTENSIONS);
    dialog
        .add_filter("Sessions, point pairs, matches, matrices", &others)
        .add_filter("All files", &["*"])
        .pick_file()
}

fn pick_folder() -> Option<PathBuf> {
    rfd::FileDialog::new().set_title("Choose a folder").pick_folder()
}

fn pick_save(suggested: &Path) -> Option<PathBuf> {
    let mut dialog = rfd::FileDialog::new().set_title("Save as");
    if let Some(name) = suggested.file_name() {
        dialog = dialog.set_file_name(name.to_string_lossy());
    }
    if let Some(folder) = suggested.parent().filter(|folder| folder.is_dir()) {
        dialog = dialog.set_directory(folder);
    }
    dialog.save_file()
}
