//! The pairs of the folder that is open: what was set on each is kept while another one is looked at, and saved with
//! the session.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::document::{Document, TruthSource};
use super::focus::LineSource;
use super::pair_folder::PairFolder;
use crate::io::{relative, resolve};

/// The names of a left and a right view.
pub type ViewNames = [String; 2];

/// A folder, and what was set on its pairs.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Album {
    /// The folder.
    folder: PathBuf,
    /// The pair that is open.
    pub open: ViewNames,
    /// Pairs that are not open and on which something was set, in the order of their names.
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
    /// Whether there is anything on it that would be a loss.
    pub fn is_worth_keeping(&self) -> bool {
        self.document.is_worth_keeping() || !self.pins.is_empty()
    }

    /// Whether a person made the same of it.
    pub fn is_same_work(&self, other: &Self) -> bool {
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

    /// Hands out what was set on the pair that is open now, if anything.
    pub fn take_open(&mut self) -> Option<KeptPair> {
        let at = self.find([&self.open[0], &self.open[1]])?;
        Some(self.pairs.remove(at))
    }

    fn find(&self, [left, right]: [&str; 2]) -> Option<usize> {
        let order = |kept: &KeptPair| [kept.views[0].as_str(), &kept.views[1]].cmp(&[left, right]);
        self.pairs.binary_search_by(order).ok()
    }

    /// Takes in what was set on a pair that was open.
    pub fn keep(&mut self, kept: KeptPair) {
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

/// The names of a pair of a folder.
pub fn view_names(folder: &PairFolder, pair: [usize; 2]) -> ViewNames {
    pair.map(|view| folder.names()[view].clone())
}
