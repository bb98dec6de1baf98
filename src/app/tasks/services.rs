//! What the window gets done by others, so that tests can put something else in their place.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::app::model::computation::EstimateRequest;
use crate::app::model::document::Side;
use crate::app::model::picture::Pictures;
use crate::app::model::recording::Synchronised;
use crate::app::model::suggesting::{
    NextClickQuestion, Repair, RepairOutcome, RepairQuestion, SuggestQuestion, Suggested,
};
use crate::app::model::verdict::capitalised;
use crate::cancel::CancelFlag;
use crate::estimate::{Estimate, EstimateError, Monitor, PreparedPair, estimate_prepared, follow};
use crate::io::{IMAGE_EXTENSIONS, VIDEO_EXTENSIONS};
use crate::motion::MotionError;
use crate::suggest::{
    ClickedImage, Known, NextClick, Rival, SuggestError, SuggestParameters, next_click, refine, suggest,
    view_at,
};

/// The search for a geometry: the estimator of this library, or something that stands in for it.
pub type EstimateFn = dyn FnMut(&EstimateRequest, &Monitor) -> Result<Estimate, EstimateError> + Send;

/// Refits the most supported of some earlier geometries of the same pictures to moved points, in milliseconds.
pub type FollowFn = dyn FnMut(&EstimateRequest, &[&Estimate]) -> Option<Estimate> + Send;

/// Makes ready what depends on the pictures alone, before anybody has clicked.
pub type PrepareFn = dyn FnMut(&Pictures, &CancelFlag) + Send;

/// Suggests the match of a first click, in some hundredths of a second.
pub type SuggestFn = dyn FnMut(&SuggestQuestion) -> Suggested + Send;

/// Finds the place where one more pair would tell most, in some milliseconds.
pub type NextClickFn = dyn FnMut(&NextClickQuestion) -> Option<NextClick> + Send;

/// Looks for a better place for a pair, in some hundredths of a second.
pub type RepairFn = dyn FnMut(&RepairQuestion) -> RepairOutcome + Send;

/// Asks for a path with a dialog of the system, and returns when that is closed.
pub type PickFn = dyn Fn() -> Option<PathBuf> + Send + Sync;

/// Asks with a dialog of the system where to write a file, for which it suggests a path.
pub type SavePickFn = dyn Fn(&Path) -> Option<PathBuf> + Send + Sync;

/// The computations and the system's dialogs.
pub struct Services {
    /// What is done as soon as pictures are open.
    pub prepare: Box<PrepareFn>,
    /// The search for a geometry.
    pub estimate: Box<EstimateFn>,
    /// What is shown while the search goes on.
    pub follow: Box<FollowFn>,
    /// What is offered for the second click of a pair.
    pub suggest: Box<SuggestFn>,
    /// Where one more pair would tell most.
    pub next_click: Box<NextClickFn>,
    /// A better place for a pair that was placed.
    pub repair: Box<RepairFn>,
    /// The system's dialog for choosing a file; `None` when it was cancelled or could not open.
    pub pick_file: Arc<PickFn>,
    /// The system's dialog for choosing a folder; `None` as for a file.
    pub pick_folder: Arc<PickFn>,
    /// The system's dialog for choosing where to save or export; `None` as for a file.
    pub pick_save: Arc<SavePickFn>,
    /// The folder for the program's own copies of unsaved work; none keeps no copies.
    pub copies: Option<PathBuf>,
}

impl Default for Services {
    fn default() -> Self {
        let searching = PreparedCache::default();
        let [preparing, following, suggesting, advising, repairing] =
            std::array::from_fn(|_| searching.clone());
        Self {
            prepare: Box::new(move |pictures, cancel| preparing.get(pictures).make_ready(cancel)),
            estimate: Box::new(move |request, monitor| {
                let prepared = searching.get_with(&request.pictures, request.recordings.as_ref())?;
                estimate_prepared(&prepared, &request.pairs, &request.parameters, monitor)
            }),
            follow: Box::new(move |request, starts| {
                // Patches follow, and barcodes have none.
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
                let view = question.known.view.or_else(|| view_at(&prepared, &question.placed));
                let known = Known { view, ..question.known };
                suggest(&prepared, question.half.point, clicked, &known, &SuggestParameters::default())
            }),
            next_click: Box::new(move |question| {
                let prepared = advising.get(&question.pictures);
                let found = &question.found;
                next_click(&prepared, found.fundamental(), &Rival::of(found), &question.placed)
            }),
            repair: Box::new(move |question| repaired(&repairing.get(&question.pictures), question)),
            pick_file: Arc::new(pick_file),
            pick_folder: Arc::new(pick_folder),
            pick_save: Arc::new(pick_save),
            copies: None,
        }
    }
}

/// Where the right point of a pair belongs.
fn repaired(prepared: &PreparedPair, question: &RepairQuestion) -> RepairOutcome {
    let RepairQuestion { points, how, known, .. } = question;
    let parameters = SuggestParameters::default();
    let told = |error: SuggestError| capitalised(&error.to_string());
    match how {
        Repair::Refine => {
            refine(prepared, points, known.view, &parameters).map(|found| found.position).map_err(told)
        }
        Repair::Rematch => {
            let found =
                suggest(prepared, points.point1, ClickedImage::First, known, &parameters).map_err(told)?;
            found.clear().map(|clear| clear.position).ok_or_else(|| found.verdict.to_string())
        }
    }
}

/// What depends on the pictures alone, kept from one request to the next and shared by the threads, so that
/// moving a point costs only what depends on the point.
#[derive(Clone, Default)]
struct PreparedCache(Arc<Mutex<Option<CachedPair>>>);

struct CachedPair {
    pictures: Pictures,
    recordings: Option<Synchronised>,
    prepared: Arc<PreparedPair>,
}

impl PreparedCache {
    fn get(&self, pictures: &Pictures) -> Arc<PreparedPair> {
        self.get_or(pictures, None, |prepared| prepared)
    }

    /// The pictures with what moves in front of them.
    fn get_with(
        &self,
        pictures: &Pictures,
        recordings: Option<&Synchronised>,
    ) -> Result<Arc<PreparedPair>, MotionError> {
        let Some(recordings) = recordings else { return Ok(self.get(pictures)) };
        let silhouettes = recordings.overlapping()?;
        Ok(self.get_or(pictures, Some(recordings), |prepared| prepared.with_silhouettes(silhouettes)))
    }

    /// What is kept, or else what is made by `completed`.
    fn get_or(
        &self,
        pictures: &Pictures,
        recordings: Option<&Synchronised>,
        completed: impl FnOnce(PreparedPair) -> PreparedPair,
    ) -> Arc<PreparedPair> {
        // A panic while preparing leaves the old pair in place, which is sound.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = kept.as_ref()
            && kept.pictures == *pictures
            && kept.recordings.as_ref() == recordings
        {
            return Arc::clone(&kept.prepared);
        }
        let [image1, image2] = pictures;
        let prepared = Arc::new(completed(PreparedPair::new(&image1.gray, &image2.gray)));
        *kept = Some(CachedPair {
            pictures: pictures.clone(),
            recordings: recordings.cloned(),
            prepared: Arc::clone(&prepared),
        });
        prepared
    }
}

fn pick_file() -> Option<PathBuf> {
    let others = ["json", "txt", "csv", "tsv", "dat", "yml", "yaml", "P"];
    let dialog = rfd::FileDialog::new().set_title("Open a file").add_filter("Images", &IMAGE_EXTENSIONS);
    let dialog = dialog.add_filter("Sequences of frames", &VIDEO_EXTENSIONS);
    dialog.add_filter("Sessions, point pairs, matrices", &others).add_filter("All files", &["*"]).pick_file()
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
