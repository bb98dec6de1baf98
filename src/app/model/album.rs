//! The pairs of the folder that is open: what was set on each is kept while another one is looked at, and saved with
//! the session.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Model;
use super::document::{Document, TruthSource};
use super::focus::LineSource;
use super::open_pair::OpenFolder;
use super::pair_folder::PairFolder;
use super::picture::Opened;
use super::session::Work;
use super::truth::KnownTruth;
use crate::io::{relative, resolve};

/// The names of a left and a right view.
pub type ViewNames = [String; 2];

/// A folder, and what was set on its pairs.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Album {
    /// The folder.
    folder: PathBuf,
    /// The pair that is open.
    open: ViewNames,
    /// Those that are not and on which something was set, in the order of their names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pairs: Vec<KeptPair>,
}

/// What was set on a pair that is not open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptPair {
    /// Which pair it is.
    pub views: ViewNames,
    /// Points, parameters, ground truth; without the pictures.
    pub document: Document,
    /// The pinned line pairs, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<LineSource>,
}

impl KeptPair {
    fn is_worth_keeping(&self) -> bool {
        self.document.is_worth_keeping() || !self.pins.is_empty()
    }

    fn is_same_work(&self, other: &Self) -> bool {
        self.document.is_same_work(&other.document) && self.pins == other.pins
    }
}

impl Album {
    /// Nothing was set on any pair of a folder yet.
    pub fn new(folder: &PairFolder, pair: [usize; 2]) -> Self {
        Self { folder: folder.path().to_owned(), open: view_names(folder, pair), pairs: Vec::new() }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The pair that is open, in the folder as it is now.
    pub fn pair_in(&self, folder: &PairFolder) -> Option<[usize; 2]> {
        let number = |name: &String| folder.names().iter().position(|other| other == name);
        let pair = [number(&self.open[0])?, number(&self.open[1])?];
        folder.is_pair(pair).then_some(pair)
    }

    /// What was set on the pairs that are not open.
    pub fn pairs(&self) -> &[KeptPair] {
        &self.pairs
    }

    /// How many point pairs there are on a pair that is not open.
    pub fn points_on(&self, views: [&str; 2]) -> usize {
        self.find(views).map_or(0, |at| self.pairs[at].document.pairs.len())
    }

    fn find(&self, [left, right]: [&str; 2]) -> Option<usize> {
        let order = |kept: &KeptPair| [kept.views[0].as_str(), &kept.views[1]].cmp(&[left, right]);
        self.pairs.binary_search_by(order).ok()
    }

    fn keep(&mut self, kept: KeptPair) {
        let at = self.pairs.partition_point(|other| other.views < kept.views);
        self.pairs.insert(at, kept);
    }

    /// As it is written into a session at `path`.
    pub fn to_session(&mut self, path: &Path) {
        self.folder = relative(&self.folder, path).into();
        for kept in &mut self.pairs {
            kept.document.pictures = None;
            if let Some(TruthSource::Folder { folder, .. }) = &mut kept.document.truth {
                *folder = relative(folder, path).into();
            }
        }
    }

    /// Brings what a session at `path` says into order.
    pub fn make_valid(&mut self, path: &Path) {
        self.folder = resolve(&self.folder.to_string_lossy(), path);
        let open = self.open.clone();
        self.pairs.retain(|kept| kept.views != open);
        self.pairs.sort_by(|one, other| one.views.cmp(&other.views));
        self.pairs.dedup_by(|one, other| one.views == other.views);
        for kept in &mut self.pairs {
            if let Some(TruthSource::Folder { folder, .. }) = &mut kept.document.truth {
                *folder = resolve(&folder.to_string_lossy(), path);
            }
        }
    }
}

impl Work {
    /// All that is set on any pair: on the one that is open first. Without a folder that is the only one.
    fn pairs(&self) -> impl Iterator<Item = KeptPair> + '_ {
        let views = self.album.as_ref().map_or_else(ViewNames::default, |album| album.open.clone());
        let open = KeptPair { views, document: self.document.clone(), pins: self.pins.clone() };
        std::iter::once(open).chain(self.album.iter().flat_map(|album| album.pairs.iter().cloned()))
    }

    /// How many point pairs there are on all pairs of images.
    pub fn count_points(&self) -> usize {
        self.pairs().map(|kept| kept.document.pairs.len()).sum()
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
        if let Some(at) = album.find([&album.open[0], &album.open[1]]) {
            let kept = album.pairs.remove(at);
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
            let alone = self.album.as_ref().is_none_or(|album| album.pairs.is_empty());
            return alone && work.is_same_work(&self.document, self.pins());
        };
        if now.open == saved.open {
            let same =
                |(one, other): (&KeptPair, &KeptPair)| one.views == other.views && one.is_same_work(other);
            return work.is_same_work(&self.document, self.pins())
                && now.pairs.len() == saved.pairs.len()
                && now.pairs.iter().zip(&saved.pairs).all(same);
        }
        let mut left: Vec<KeptPair> = work.pairs().filter(KeptPair::is_worth_keeping).collect();
        let open = self.open_part(now.open.clone());
        let same =
            std::iter::once(&open).chain(&now.pairs).filter(|kept| kept.is_worth_keeping()).all(|kept| {
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
            album.pairs.iter().filter_map(|kept| Some([number(&kept.views[0])?, number(&kept.views[1])?]));
        pairs.filter(|pair| folder.is_pair(*pair)).collect()
    }

    /// Whether pictures are of the folder that is open, and not of one that was opened anew.
    pub fn is_of_open_folder(&self, folder: Option<&OpenFolder>) -> bool {
        let own = self.open.folder.as_ref().map(|(own, _)| own);
        own.zip(folder).is_some_and(|(own, (other, _))| Arc::ptr_eq(own, other))
    }
}

fn view_names(folder: &PairFolder, pair: [usize; 2]) -> ViewNames {
    pair.map(|view| folder.names()[view].clone())
}
