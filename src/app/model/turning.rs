//! Going from one pair of a folder to another: what was set on the one before is kept, what was set on the next comes
//! back.

use std::sync::Arc;

use super::Model;
use super::album::{Album, KeptPair, ViewNames, view_names};
use super::document::Document;
use super::open_pair::OpenFolder;
use super::picture::Opened;
use super::session::Work;
use super::truth::KnownTruth;

impl Work {
    /// All that is set on any pair: on the one that is open first. Without a folder that is the only one.
    fn pairs(&self) -> impl Iterator<Item = KeptPair> + '_ {
        let views = self.album.as_ref().map_or_else(ViewNames::default, |album| album.open.clone());
        let open = KeptPair { views, document: self.document.clone(), pins: self.pins.clone() };
        std::iter::once(open).chain(self.album.iter().flat_map(|album| album.pairs().iter().cloned()))
    }

    /// How many point pairs there are on all pairs of images.
    pub fn count_points(&self) -> usize {
        self.pairs().map(|kept| kept.document.pairs.len()).sum()
    }

    /// How many line pairs are pinned on all pairs of images.
    pub fn count_pins(&self) -> usize {
        self.pairs().map(|kept| kept.pins.len()).sum()
    }
}

impl Model {
    /// What is set on the pair that is open.
    fn open_part(&self, views: ViewNames) -> KeptPair {
        KeptPair { views, document: self.document.clone(), pins: self.pins().collect() }
    }

    /// Goes on to another pair of the folder that is open: what was set on the one before stays in the session, and
    /// what was set on this one comes back.
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

    /// Takes on what was set on the pair that has just been opened.
    fn take_kept(&mut self, KeptPair { mut document, pins, .. }: KeptPair) {
        let pictures = self.document.pictures.take();
        if let Some(pictures) = &pictures {
            document.keep_within(pictures.each_ref().map(|picture| picture.frame));
        }
        // Where it is known again it is that of the folder as it is now.
        document.truth = document.truth.and(self.document.truth.take());
        self.document = Document { pictures, ..document };
        for pin in pins {
            self.open.focus.pin(pin);
        }
    }

    /// Whether a person has made nothing since, on any pair. Which one is open does not count.
    pub fn is_same_work(&self, work: &Work) -> bool {
        let (Some(now), Some(saved)) = (&self.album, &work.album) else {
            let alone = self.album.as_ref().is_none_or(|album| album.pairs().is_empty());
            return alone && work.is_same_work(&self.document, self.pins());
        };
        if now.open == saved.open {
            let same =
                |(one, other): (&KeptPair, &KeptPair)| one.views == other.views && one.is_same_work(other);
            return work.is_same_work(&self.document, self.pins())
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

    /// How many point pairs were placed on a pair of the folder, be it open or not.
    pub fn points_on(&self, pair: [usize; 2]) -> usize {
        let Some((folder, open)) = self.folder() else { return 0 };
        if pair == open {
            return self.document.pairs.len();
        }
        let names = folder.names();
        let names = pair.map(|view| names.get(view).map_or("", String::as_str));
        self.album.as_ref().map_or(0, |album| album.points_on(names))
    }

    /// The pairs of the folder on which something was set and that are not open, by their numbers.
    pub fn kept_pairs(&self) -> Vec<[usize; 2]> {
        let (Some((folder, _)), Some(album)) = (self.folder(), &self.album) else { return Vec::new() };
        let number = |name: &String| folder.names().iter().position(|other| other == name);
        let pairs =
            album.pairs().iter().filter_map(|kept| Some([number(&kept.views[0])?, number(&kept.views[1])?]));
        pairs.filter(|pair| folder.is_pair(*pair)).collect()
    }

    /// Whether pictures are of the folder that is open, and not of one that was opened anew.
    pub fn is_of_open_folder(&self, folder: Option<&OpenFolder>) -> bool {
        let own = self.open.folder.as_ref().map(|(own, _)| own);
        own.zip(folder).is_some_and(|(own, (other, _))| Arc::ptr_eq(own, other))
    }
}
