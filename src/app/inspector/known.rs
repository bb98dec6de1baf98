//! What is done with ground truth: opening the pairs of a folder, and random trials.

use std::path::PathBuf;
use std::sync::Arc;

use super::{Inspector, PickPurpose};
use crate::app::command::Command;
use crate::app::document::Trial;
use crate::app::history::Step;
use crate::app::truth::NO_TRUTH;
use crate::evaluate::Protocol;

impl Inspector {
    /// Does what a command about ground truth says; others are not meant here.
    pub(super) fn apply_to_known(&mut self, command: Command) {
        match command {
            Command::OpenFolder(path) => self.open_folder(path),
            Command::BrowseFolder => self.pick(PickPurpose::Folder),
            Command::OpenViews(views) => self.open_views(views),
            Command::StepPair { forward } => self.step_pair(forward),
            Command::ToggleTruth => self.toggle_truth(),
            Command::RandomTrial(protocol) => self.random_trial(protocol),
            _ => {}
        }
    }

    /// Opens the first pair of a folder.
    pub(super) fn open_folder(&mut self, path: PathBuf) {
        self.loader.open_folder(path);
        self.wanted = None;
        self.open_dialog.open = false;
    }

    /// Opens two views of the folder that is open.
    fn open_views(&mut self, views: [usize; 2]) {
        let Some((folder, _)) = self.known.as_ref().and_then(|known| known.folder.as_ref()) else { return };
        if folder.is_pair(views) {
            let open = self.pictures.iter().flatten().cloned().collect();
            self.loader.open_pair(Arc::clone(folder), views, open);
            self.wanted = Some(views);
        }
    }

    /// Opens the pair behind the one that is open, or being opened, or the one before it.
    fn step_pair(&mut self, forward: bool) {
        let Some((folder, shown)) = self.known.as_ref().and_then(|known| known.folder.as_ref()) else {
            return;
        };
        if let Some(views) = folder.neighbour(self.wanted.unwrap_or(*shown), forward) {
            self.open_views(views);
        }
    }

    /// Takes the ground truth into use, or out of it.
    fn toggle_truth(&mut self) {
        let Some(known) = &self.known else {
            self.tell(NO_TRUTH.into());
            return;
        };
        let source = known.source.clone();
        if self.focus.contestant().is_some() {
            // What was compared changes; a choice among it must not come back later by itself.
            self.focus.choose_hypothesis(None);
        }
        self.edit(Step::Single, |document| {
            document.truth = if document.truth.is_some() { None } else { Some(source) };
        });
    }

    /// Puts true matches in place of the pairs that the geometry is estimated from.
    fn random_trial(&mut self, protocol: Protocol) {
        if let Some(reason) = self.scene().no_trial() {
            self.tell(reason.into());
            return;
        }
        let (Some(known), Some(pictures)) = (&self.known, &self.document.pictures) else { return };
        let count = self.document.parameters.method.pairs_needed();
        let frames = pictures.each_ref().map(|picture| picture.frame);
        let trial = Trial { protocol, seed: self.next_seed };
        let Some(drawn) = known.draw(frames, protocol, trial.seed, count) else {
            let why = match protocol {
                Protocol::Paper => "30 px apart",
                _ => "30 px apart and off each other's epipolar lines",
            };
            self.tell(format!("There is no random trial here: no {count} true matches are {why}."));
            return;
        };
        self.next_seed += 1;
        self.edit(Step::Single, |document| document.set_trial(trial, drawn));
    }
}
