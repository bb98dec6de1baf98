//! Computations and dialogs of the window, which tests can replace.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::app::model::computation::EstimateRequest;
use crate::app::model::document::Side;
use crate::app::model::picture::Pictures;
use crate::app::model::recording::Synchronised;
use crate::app::model::suggesting::{
    LensQuestion, PairsQuestion, RepairOutcome, RepairQuestion, SuggestQuestion, Suggested,
};
use crate::cancel::CancelFlag;
use crate::estimate::{DivisionFit, Estimate, EstimateError, Monitor};
use crate::io::{IMAGE_EXTENSIONS, VIDEO_EXTENSIONS};
use crate::motion::MotionError;
use crate::presentation::sentence;
use crate::study::{PlaceFound, Question, Study};
use crate::suggest::{ClickedImage, NextClick};

/// Searches for a geometry. Tests replace the estimator of this library.
pub type EstimateFn = dyn FnMut(&EstimateRequest, &Monitor) -> Result<Estimate, EstimateError> + Send;

/// Refits the best supported of the earlier geometries of these pictures to moved points, within
/// milliseconds.
pub type FollowFn = dyn FnMut(&EstimateRequest, &[&Estimate]) -> Option<Estimate> + Send;

/// Prepares data that depends on the pictures only.
pub type PrepareFn = dyn FnMut(&Pictures, &CancelFlag) + Send;

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
    pub next_click: Box<AnswerFn<PairsQuestion, Option<NextClick>>>,
    /// Distortion of the lens, within some tenths of a second.
    pub lens: Box<AnswerFn<LensQuestion, Option<DivisionFit>>>,
    /// Matches of the pairs along their lines, within some hundredths of a second for each.
    pub places: Box<AnswerFn<PairsQuestion, Vec<PlaceFound>>>,
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
        let searching = StudyCache::default();
        let [preparing, following, suggesting, advising, straightening, checking, repairing] =
            std::array::from_fn(|_| searching.clone());
        Self {
            prepare: Box::new(move |pictures, cancel| preparing.get(pictures).make_ready(cancel)),
            estimate: Box::new(move |request, monitor| {
                let EstimateRequest { pairs, given, parameters, .. } = request;
                let given = given.as_ref().map(|given| given.as_slice());
                // The import has told if the matches agree on no geometry.
                let question = Question { clicks: pairs, given, parameters };
                searching.get_for(request)?.solve(&question, monitor)
            }),
            follow: Box::new(move |request, starts| {
                following.get_for(request).ok()?.follow(starts, &request.pairs, &request.parameters)
            }),
            suggest: Box::new(move |SuggestQuestion { pictures, half, found, placed }| {
                let clicked = match half.side {
                    Side::Left => ClickedImage::First,
                    Side::Right => ClickedImage::Second,
                };
                suggesting.get(pictures).suggest_by(found.as_deref(), placed, half.point, clicked)
            }),
            next_click: Box::new(move |question| {
                advising.get(&question.pictures).next_click(&question.found, &question.pairs)
            }),
            lens: Box::new(move |question| straightening.get(&question.pictures).find_lens(&question.found)),
            places: Box::new(move |question| {
                checking.get(&question.pictures).places(&question.pairs, &question.found)
            }),
            repair: Box::new(move |RepairQuestion { pictures, points, found, .. }| {
                let repaired = repairing.get(pictures).repaired(points, found.as_deref());
                repaired.map_err(|error| sentence(&error.to_string()))
            }),
            pick_file: Arc::new(pick_file),
            pick_folder: Arc::new(pick_folder),
            pick_save: Arc::new(pick_save),
            copies: None,
        }
    }
}

/// The study of the open pictures. It is kept between requests and shared by the threads, so that moving a point
/// costs little.
#[derive(Clone, Default)]
struct StudyCache(Arc<Mutex<Option<KeptStudy>>>);

struct KeptStudy {
    pictures: Pictures,
    recordings: Option<Synchronised>,
    study: Study,
}

impl StudyCache {
    fn get(&self, pictures: &Pictures) -> Study {
        self.get_or_make(pictures, None, || Study::of_pictures(pictures.clone()))
    }

    /// Returns the study of the pictures and sequences of an estimate, in their views.
    fn get_for(&self, request: &EstimateRequest) -> Result<Study, MotionError> {
        let EstimateRequest { pictures, recordings, views, .. } = request;
        let Some(recordings) = recordings else { return Ok(self.get(pictures).drawn_in(*views)) };
        let silhouettes = recordings.overlapping()?;
        let make = || Study::of_pictures(pictures.clone()).with_silhouettes(silhouettes);
        Ok(self.get_or_make(pictures, Some(recordings), make))
    }

    /// Returns the kept study if it is the right one, or makes another.
    fn get_or_make(
        &self,
        pictures: &Pictures,
        recordings: Option<&Synchronised>,
        make: impl FnOnce() -> Study,
    ) -> Study {
        // A panic of a thread that held the lock leaves the old study, which is valid.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_right =
            |kept: &KeptStudy| kept.pictures == *pictures && kept.recordings.as_ref() == recordings;
        if let Some(kept) = kept.as_ref().filter(|kept| is_right(kept)) {
            return kept.study.clone();
        }
        let study = make();
        let (pictures, recordings) = (pictures.clone(), recordings.cloned());
        *kept = Some(KeptStudy { pictures, recordings, study: study.clone() });
        study
    }
}

fn pick_file() -> Option<PathBuf> {
    let others = ["json", "txt", "csv", "tsv", "dat", "yml", "yaml", "npz", "P"];
    let dialog = rfd::FileDialog::new().set_title("Open a file").add_filter("Images", &IMAGE_EXTENSIONS);
    let dialog = dialog.add_filter("Sequences of frames", &VIDEO_EXTENSIONS);
    dialog
        .add_filter("Sessions, point pairs, matches, matrices", &others)
        .add_filter("Databases of COLMAP", &["db"])
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
