//! Switching between pairs of a folder: work on the old pair is kept, and work on the new pair
//! restored.

use std::sync::Arc;

use super::Model;
use super::album::{Album, KeptPair, ViewNames, view_names};
use super::document::Document;
use super::open_pair::OpenFolder;
use super::picture::Opened;
use super::session::Work;
use super::truth::KnownTruth;
use crate::camera::CameraModel;
use crate::io::PictureFolder;

impl Work {
    /// Returns the work on all pairs, the open one first. Without a folder there is only one.
    fn pairs(&self) -> impl Iterator<Item = KeptPair> + '_ {
        let views = self.album.as_ref().map_or_else(ViewNames::default, |album| album.open.clone());
        let (document, pins) = (self.document.clone(), self.pins.clone());
        let open = KeptPair { views, document, pins, cameras: self.cameras };
        std::iter::once(open).chain(self.album.iter().flat_map(|album| album.pairs().iter().cloned()))
    }

    /// Returns the numbers of point pairs and of pinned line pairs on all pairs of images.
    pub fn counts(&self) -> (usize, usize) {
        let pins = |kept: &KeptPair| kept.document.pins.len() + kept.pins.len();
        self.pairs().fold((0, 0), |(pairs, all), kept| (pairs + kept.document.pairs.len(), all + pins(&kept)))
    }
}

impl Model {
    fn open_part(&self, views: ViewNames) -> KeptPair {
        let (document, cameras) = (self.document.clone(), self.open.cameras());
        KeptPair { views, document, pins: Vec::new(), cameras }
    }

    /// Replaces the open pictures by the same ones with other lenses. Findings go, as they belong to other
    /// coordinates; the folder, the ground truth and the session stay.
    pub fn see_through(&mut self, pictures: [Opened; 2]) {
        let (folder, known) = (self.open.folder.take(), self.open.known.take());
        let at_first = self.open.cameras_at_first;
        let (album, session) = (self.album.take(), std::mem::take(&mut self.session));
        self.open(pictures, known, false, None);
        (self.open.folder, self.album, self.session) = (folder, album, session);
        self.open.cameras_at_first = at_first;
    }

    /// Returns the cameras of the work on a pair of the folder that is not open.
    pub fn kept_cameras(&self, folder: &PictureFolder, pair: [usize; 2]) -> Option<[CameraModel; 2]> {
        self.album.as_ref()?.kept(&view_names(folder, pair))?.cameras
    }

    /// Switches to another pair of the open folder. Work on the old pair stays in the session, and
    /// work on the new pair is restored.
    pub fn turn_to(&mut self, pictures: [Opened; 2], known: Option<KnownTruth>, (folder, pair): OpenFolder) {
        let mut album = self.album.take().unwrap_or_else(|| Album::new(&folder, pair));
        let before = self.open_part(album.open.clone());
        if before.is_worth_keeping() {
            album.keep(before);
        }
        let session = std::mem::take(&mut self.session);
        let uses_truth = known.is_some();
        self.open(pictures, known, uses_truth, None);
        self.session = session;
        album.open = view_names(&folder, pair);
        if let Some(kept) = album.take_open() {
            self.take_kept(kept);
        }
        self.open.folder = Some((folder, pair));
        self.album = Some(album);
    }

    /// Restores the work on the pair that has just been opened.
    fn take_kept(&mut self, KeptPair { mut document, .. }: KeptPair) {
        if let Some(frames) = self.document.frames() {
            document.keep_within(frames);
        }
        // The truth comes from the folder as read now.
        document.truth = document.truth.and(self.document.truth.take());
        self.document = Document { pictures: self.document.pictures.take(), ..document };
    }

    /// Returns whether the work on all pairs is unchanged. Which pair is open, and the way of looking at it, do not
    /// count.
    pub fn is_same_work(&self, work: &Work) -> bool {
        let is_same_open =
            || self.document.is_same_work(&work.document) && self.open.cameras() == work.cameras;
        let (Some(now), Some(saved)) = (&self.album, &work.album) else {
            let alone = self.album.as_ref().is_none_or(|album| album.pairs().is_empty());
            return alone && is_same_open();
        };
        if now.open == saved.open {
            let same =
                |(one, other): (&KeptPair, &KeptPair)| one.views == other.views && one.is_same_work(other);
            return is_same_open()
                && now.pairs().len() == saved.pairs().len()
                && now.pairs().iter().zip(saved.pairs()).all(same);
        }
        let mut left: Vec<KeptPair> = work.pairs().filter(KeptPair::is_worth_keeping).collect();
        let open = self.open_part(now.open.clone());
        let same =
            std::iter::once(&open).chain(now.pairs()).filter(|kept| kept.is_worth_keeping()).all(|kept| {
                let at = left.iter().position(|other| other.views == kept.views);
                at.is_some_and(|at| left.swap_remove(at).is_same_work(kept))
            });
        same && left.is_empty()
    }

    /// Returns the number of point pairs on a pair of the folder, open or not.
    pub fn points_on(&self, pair: [usize; 2]) -> usize {
        let Some((folder, open)) = self.folder() else { return 0 };
        if pair == open {
            return self.document.pairs.len();
        }
        let kept = self.album.as_ref().and_then(|album| album.kept(&view_names(folder, pair)));
        kept.map_or(0, |kept| kept.document.pairs.len())
    }

    /// Returns the pairs of the folder with work that are not open, by number.
    pub fn kept_pairs(&self) -> Vec<[usize; 2]> {
        let (Some((folder, _)), Some(album)) = (self.folder(), &self.album) else { return Vec::new() };
        album.pairs().iter().filter_map(|kept| folder.pair_named(&kept.views)).collect()
    }

    /// Returns whether pictures belong to the open folder, and not to a folder that was opened
    /// again.
    pub fn is_of_open_folder(&self, folder: Option<&OpenFolder>) -> bool {
        let own = self.open.folder.as_ref().map(|(own, _)| own);
        own.zip(folder).is_some_and(|(own, (other, _))| Arc::ptr_eq(own, other))
    }
}
