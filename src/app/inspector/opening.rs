//! Opening of pictures, folders and other files, named or dropped on the window.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Inspector;
use crate::app::model::album::Album;
use crate::app::model::document::{Imported, TruthSource};
use crate::app::model::history::{History, LensChange, LensStep};
use crate::app::model::messages::MessageKind;
use crate::app::model::picture::Opened;
use crate::app::model::session::{OpenSession, SessionOwner, has_session_extension};
use crate::app::model::truth::KnownTruth;
use crate::app::model::{Document, Model, Side, StageId};
use crate::app::tasks::{LoadedPair, Opening, OpeningFailure, Wanted};
use crate::app::view::{FocalDialog, OpenDialog, RelocateDialog};
use crate::camera::FocalLength;
use crate::geometry::PointPair;
use crate::io::{CalibratedCamera, PairOrigin, is_importable, is_sequence};
use crate::study::assumed_camera;

impl Inspector {
    /// Shows newly opened pictures, or a message.
    pub(super) fn take_pictures(&mut self, ctx: &egui::Context) {
        let Some(result) = self.tasks.loader.poll() else { return };
        match result {
            Ok(mut pair) => {
                self.view.dialogs.open.open = false;
                let notes = std::mem::take(&mut pair.notes);
                self.show_pictures(ctx, pair);
                self.model.messages.remark(notes);
            }
            Err(failure) => {
                self.start_pairs.clear();
                self.model.imports.clear();
                self.model.wanted = None;
                match failure {
                    OpeningFailure::Text(text) => self.refuse(text),
                    OpeningFailure::NoSession { path, problem } => self.import_instead(&path, problem),
                    OpeningFailure::Relocate(relocation) => {
                        self.view.dialogs.open.open = false;
                        self.view.dialogs.relocate = Some(RelocateDialog::new(*relocation));
                    }
                }
            }
        }
    }

    /// Shows why something cannot be opened. An open dialog shows the message and keeps its text.
    pub(super) fn refuse(&mut self, text: String) {
        let dialog = &mut self.view.dialogs.open;
        if dialog.open {
            dialog.refuse(text);
        } else {
            self.model.messages.tell(text);
        }
    }

    /// Starts over with other pictures.
    fn show_pictures(&mut self, ctx: &egui::Context, pair: LoadedPair) {
        if let Some(change) = &pair.lens {
            return self.take_over(ctx, pair.pictures, change);
        }
        // Another pair of the same folder belongs to the same session.
        let turns = pair.restored.is_none() && self.model.is_of_open_folder(pair.folder.as_ref());
        // What went wrong before was about the other pictures.
        self.model.messages.settle(MessageKind::Problem);
        let set_aside = !turns && self.set_aside();
        self.note_recent(&pair);
        self.replace_pictures(ctx, &pair.pictures);
        let is_of_file = |known: &KnownTruth| matches!(known.source, TruthSource::Folder { .. });
        let is_new = pair.restored.is_none() && pair.folder.is_none();
        let lies_beside = is_new && pair.known.as_ref().is_some_and(is_of_file);
        match pair.folder {
            Some(folder) if turns => {
                self.model.turn_to(pair.pictures, pair.known, folder);
                self.start_pairs.clear();
                return;
            }
            folder => {
                self.model.open(pair.pictures, pair.known, pair.uses_truth, pair.show_me);
                if lies_beside {
                    self.model
                        .open
                        .done
                        .tell("Ground truth lies beside the pictures: press G to compare with it");
                }
                // Other pictures have no rectified pair yet.
                self.model.look.stage = StageId::Pictures;
                self.model.album = folder.as_ref().map(|(folder, views)| Album::new(folder, *views));
                self.model.open.folder = folder;
            }
        }
        let pairs = std::mem::take(&mut self.start_pairs);
        let pairs: Vec<PointPair> = pairs.iter().filter_map(|pair| self.model.open.points_of(pair)).collect();
        let document = &mut self.model.document;
        let (inside, outside): (Vec<_>, Vec<_>) = pairs.into_iter().partition(|pair| document.contains(pair));
        document.set_pairs(inside, PairOrigin::Imported);
        self.tell_of_pairs_outside(outside.len());
        if let Some(restored) = pair.restored {
            self.restore(*restored);
        }
        if set_aside {
            self.offer_left_behind();
        }
    }

    /// Opens the pictures in the other order, with the same points. The folder and its other pairs belong to
    /// the old order.
    pub(super) fn swap_images(&mut self, ctx: &egui::Context) {
        if !self.model.document.is_of_files() {
            return;
        }
        let before = self.model.document.clone();
        self.model.document = before.clone().swapped();
        self.model.history = std::mem::take(&mut self.model.history).swapped();
        self.model.history.record(before, &self.model.document, None);
        self.exchange_pictures(ctx);
        self.model.open.done.tell("Swapped the images. Undo goes back.");
    }

    /// Undoes a step, or redoes one.
    pub(super) fn travel(&mut self, ctx: &egui::Context, back: bool) {
        if let Some(change) = self.model.history.next_lens(back) {
            return self.change_lens(change);
        }
        let before = self.model.document.clone();
        self.model.travel(back);
        if self.model.document.is_swapped(&before) {
            self.exchange_pictures(ctx);
        }
        self.view.let_go();
    }

    /// Opens the pictures in the order of the document.
    fn exchange_pictures(&mut self, ctx: &egui::Context) {
        let Some([left, right]) = self.model.open.pictures.clone() else { return };
        let pictures = [right, left];
        let set_aside = self.model.album.is_some() && self.set_aside();
        self.replace_pictures(ctx, &pictures);
        let document = std::mem::take(&mut self.model.document);
        let history = std::mem::take(&mut self.model.history);
        self.model.open(pictures, None, false, None);
        (self.model.document, self.model.history) = (document, history);
        if set_aside {
            self.offer_left_behind();
        }
    }

    /// Shows other pictures, or other lenses of the same ones, and forgets what was asked about the earlier ones.
    fn replace_pictures(&mut self, ctx: &egui::Context, pictures: &[Opened; 2]) {
        for (pane, opened) in self.view.panes.iter_mut().zip(pictures) {
            pane.set_picture(ctx, opened);
        }
        self.tasks.forget_pair();
        self.view.dialogs.reading = None;
    }

    /// Continues a document with another lens of its pictures. Points stay where they are in the pictures. A pose of
    /// the calibration becomes the imported geometry.
    fn take_over(&mut self, ctx: &egui::Context, pictures: [Opened; 2], change: &LensChange) {
        let Some([left, right]) = self.model.open.pictures.clone() else { return };
        self.replace_pictures(ctx, &pictures);
        let before = std::mem::take(&mut self.model.document);
        let cameras = self.model.open.cameras();
        let mut past = std::mem::take(&mut self.model.history);
        let here =
            |history: History, before: &Document| LensStep { document: before.clone(), history, cameras };
        let crossed =
            change.travels.and_then(|back| past.cross_lens(back, here(History::default(), &before)));
        self.model.see_through(pictures);
        // Such a message may ask for this change.
        self.model.messages.settle(MessageKind::Problem);
        let Model { open, document, .. } = &mut self.model;
        let (count, had_imported) = (before.pairs.len(), before.imported.is_some());
        let pictures = document.pictures.take();
        if let Some(crossed) = crossed {
            *document = Document { pictures, ..crossed };
            open.done.tell(if change.travels == Some(true) { "Undone" } else { "Redone" });
            self.model.history = past;
            return;
        }
        *document = Document { pictures, ..before.clone() }.placed(|points| {
            let (point1, point2) = (left.pixel(points.point1)?, right.pixel(points.point2)?);
            open.points_of(&PointPair { point1, point2 })
        });
        document.imported = open.views().zip(change.pose).and_then(|(views, pose)| {
            let fundamental = pose.fundamental(&views.calibrations())?;
            let reading = "pose of the calibration".to_owned();
            let (cameras, file) = (views.posed(&pose), change.name.clone()?);
            Some(Imported { fundamental, cameras, file, reading, check: None })
        });
        let judged = if document.imported.is_some() { ". Compare judges its pose" } else { "" };
        open.done.tell(match (&change.name, &change.cameras) {
            (Some(name), _) => format!("Lens calibrated by {name}{judged}"),
            (None, Some(_)) => "Lens distortion corrected. Epipolar lines are curves now".to_owned(),
            (None, None) => "Lens correction removed. The pictures are taken as they are".to_owned(),
        });
        if had_imported && document.imported.is_none() {
            let text =
                "The imported geometry belongs to the other lens, and was removed. Undo brings it back.";
            self.model.messages.tell(text);
        }
        self.model.history.change_lens(here(past, &before));
        let outside = count - self.model.document.pairs.len();
        self.tell_of_pairs_outside(outside);
    }

    fn tell_of_pairs_outside(&mut self, count: usize) {
        if count > 0 {
            self.model.messages.tell(format!(
                "Left out because outside the images: {count} of the point pairs. Click these points instead."
            ));
        }
    }

    /// Undoes the distortion of the open pictures by the calibration of a file.
    pub(super) fn calibrate(&mut self, name: &str, cameras: &[CalibratedCamera; 2]) {
        let Some(pictures) = &self.model.open.pictures else { return };
        if pictures.iter().any(|opened| opened.recording.is_some()) {
            self.refuse(format!("{name} is a calibration, which sequences cannot use. Nothing was changed."));
            return;
        }
        self.change_lens(LensChange {
            name: Some(name.to_owned()),
            cameras: Some(cameras.each_ref().map(|camera| camera.model)),
            pose: CalibratedCamera::relative_pose(cameras).map(|(pose, _)| pose),
            travels: None,
        });
        let notes = CalibratedCamera::notes_of(cameras);
        self.model.messages.remark(notes.iter().map(|note| format!("{name}: {note}")).collect());
    }

    /// Undoes the distortion of the lens that was fitted to the matches.
    pub(super) fn use_lens(&mut self) {
        let Some((lens, pictures)) = self.model.offered_lens().zip(self.model.open.pictures.as_ref()) else {
            return;
        };
        let guessed = |opened: &Opened| opened.lens.as_ref()?.view.camera().focal_length();
        let camera = |k: usize| {
            assumed_camera(Some(lens.lambdas[k]), guessed(&pictures[k]), pictures[k].shown().frame())
        };
        let Some(cameras) = camera(0).zip(camera(1)).map(Into::into) else { return };
        self.change_lens(LensChange { cameras: Some(cameras), ..LensChange::default() });
    }

    pub(super) fn change_lens(&mut self, change: LensChange) {
        let Some(pictures) = self.model.open.pictures.clone() else { return };
        self.open(Wanted::Calibrated(Box::new((pictures, change))));
    }

    /// Opens the dialog for focal lengths, unless a calibration undoes the distortion of a lens.
    pub(super) fn ask_for_focal_lengths(&mut self) {
        let Some(pictures) = &self.model.open.pictures else { return };
        if !self.model.open.takes_focal_lengths() {
            self.refuse("The calibration of these pictures tells their focal lengths.".to_owned());
            return;
        }
        if pictures.iter().any(|opened| opened.recording.is_some()) {
            self.refuse("Sequences have no 3-D points. Open two pictures for them.".to_owned());
            return;
        }
        let used = pictures.each_ref().map(|opened| opened.lens.as_ref()?.view.camera().focal_length());
        let guesses = pictures.each_ref().map(|opened| opened.focal_guess);
        let widths = pictures.each_ref().map(|opened| opened.shown().frame().width);
        self.view.dialogs.focal = Some(FocalDialog::new(used, guesses, widths));
    }

    /// Gives the open pictures focal lengths, and shows the scene once there is one.
    pub(super) fn set_focal_lengths(&mut self, lengths: [FocalLength; 2]) {
        self.view.dialogs.focal = None;
        self.model.open.set_focal_lengths(lengths);
        self.model.look.stage = StageId::Scene;
        self.model.open.done.tell("Focal lengths set");
    }

    /// Adds the opened files to the recent ones. The built-in pair and copies of unsaved work are
    /// offered elsewhere.
    fn note_recent(&mut self, pair: &LoadedPair) {
        let recents = &mut self.model.recents;
        if let Some(restored) = &pair.restored {
            if restored.session.owner == SessionOwner::Person {
                recents.note(&[&restored.session.path]);
            }
        } else if let Some(folder) = pair.folder.as_ref().and_then(|(folder, _)| folder.image(0).parent()) {
            recents.note(&[folder]);
        } else if let [Some(left), Some(right)] =
            pair.pictures.each_ref().map(|opened| opened.picture.path.as_deref())
        {
            recents.note(&[left, right]);
        }
    }

    /// Starts opening pictures, in place of those being opened.
    pub(super) fn open(&mut self, wanted: Wanted) {
        self.tasks.loader.open(wanted);
        self.model.wanted = None;
    }

    /// Handles a dropped or chosen file. A first image waits in the dialog for a second one. A
    /// folder opens at once, unless the dialog has a sequence that waits for another.
    pub(super) fn offer(&mut self, path: &Path) {
        let waits =
            |dialog: &OpenDialog| dialog.open && dialog.waiting().is_some_and(|path| is_sequence(&path));
        if path.is_dir() && !waits(&self.view.dialogs.open) {
            self.open_folder(path.to_owned());
        } else if let Some(dialog) = &mut self.view.dialogs.relocate {
            dialog.offer_dropped(path);
        } else if has_session_extension(path) {
            self.open_session(path.to_owned().into());
        } else if is_importable(path) {
            self.import(vec![path.to_owned()]);
        } else if let Some([left, right]) = self.view.dialogs.open.offer(path, None) {
            self.open_files(vec![left, right]);
        }
    }

    /// Opens files: images, a folder, a session, or files to import.
    pub(super) fn open_files(&mut self, paths: Vec<PathBuf>) {
        if let [folder] = &paths[..]
            && folder.is_dir()
        {
            self.open_folder(folder.clone());
            return;
        }
        if let Some(session) = paths.iter().find(|path| has_session_extension(path)) {
            self.open_session(session.clone().into());
            return;
        }
        let is_imported = |path: &PathBuf| is_importable(path) && !path.is_dir();
        let (imports, images): (Vec<_>, Vec<_>) = paths.into_iter().partition(is_imported);
        if imports.is_empty() {
            if let [left, right] = &images[..] {
                self.open(Wanted::Opening(Opening::Files(left.clone(), right.clone())));
            } else {
                let missing = self.view.dialogs.open.missing().unwrap_or(Side::Right).name();
                let absent = images.iter().find(|path| !path.exists());
                let problem = absent.map_or_else(
                    || format!("The {missing} image is missing"),
                    |path| format!("{} does not exist", path.display()),
                );
                self.refuse(format!("{problem}. Nothing was opened. Name both images."));
            }
        } else {
            self.import(imports);
            for image in &images {
                self.offer(image);
            }
        }
    }

    pub(super) fn open_folder(&mut self, path: PathBuf) {
        self.open(Wanted::Opening(Opening::Folder(path)));
    }

    pub(super) fn open_session(&mut self, session: OpenSession) {
        self.open(Wanted::Opening(Opening::Session(session)));
        self.view.dialogs.relocate = None;
    }

    pub(super) fn open_views(&mut self, views: [usize; 2]) {
        let Some((folder, _)) = &self.model.open.folder else { return };
        if folder.is_pair(views) {
            let folder = Arc::clone(folder);
            let cameras = self.model.kept_cameras(&folder, views).map(Box::new);
            self.open(Wanted::Views(folder, views, cameras));
            self.model.wanted = Some(views);
        }
    }

    /// Opens the pair next to the one that is open or being opened.
    pub(super) fn step_pair(&mut self, forward: bool) {
        let Some((folder, shown)) = self.model.folder() else { return };
        if let Some(views) = folder.neighbour(self.model.wanted.unwrap_or(shown), forward) {
            self.open_views(views);
        }
    }

    /// Turns the use of the ground truth on or off.
    pub(super) fn toggle_truth(&mut self) {
        let Some(known) = self.model.open.known() else {
            let text = self.model.open.why_no_truth();
            self.model.messages.tell(text);
            return;
        };
        let source = known.source.clone();
        if self.model.open.focus.contestant().is_some() {
            // The comparison changes, and an old selection must not come back later.
            self.model.open.focus.choose_hypothesis(None);
        }
        self.model.edit(|document| {
            document.truth = if document.truth.is_some() { None } else { Some(source) };
        });
    }

    /// Opens or imports the files dropped since the last frame.
    pub(super) fn take_dropped(&mut self, ctx: &egui::Context) {
        let files = ctx.input(|input| {
            input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect::<Vec<_>>()
        });
        // A session names its own images. So a JSON file dropped with images can only be a
        // geometry.
        let has_images = files.iter().any(|path| !is_importable(path));
        let (imports, files): (Vec<_>, Vec<_>) = files
            .into_iter()
            .partition(|path| is_importable(path) && (has_images || !has_session_extension(path)));
        match <[PathBuf; 2]>::try_from(files) {
            Ok(both) => self.open_files(both.into()),
            Err(files) => files.iter().take(2).for_each(|file| self.offer(file)),
        }
        self.import(imports);
    }
}
