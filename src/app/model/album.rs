//! Work on the pairs of the open folder. It is kept while another pair is open, and saved with the
//! session.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::document::{Document, LineSource, TruthSource};
use crate::camera::CameraModel;
use crate::io::{PictureFolder, relative, resolve};

/// Names of a left and a right view.
pub type ViewNames = [String; 2];

/// A folder, and the work on its pairs.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Album {
    folder: PathBuf,
    pub open: ViewNames,
    /// Pairs with work that are not open, in the order of their names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pairs: Vec<KeptPair>,
}

/// Work on a pair that is not open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptPair {
    pub views: ViewNames,
    /// Points, parameters and ground truth, without the pictures.
    pub document: Document,
    /// Pinned line pairs of older sessions, oldest first.
    #[serde(default, skip_serializing)]
    pub pins: Vec<LineSource>,
    /// Calibrated cameras of the pictures. All points are then in views without distortion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cameras: Option<[CameraModel; 2]>,
}

impl KeptPair {
    /// Returns whether the pair has any work that would be lost.
    pub fn is_worth_keeping(&self) -> bool {
        self.document.is_worth_keeping(true) || self.cameras.is_some()
    }

    pub fn is_same_work(&self, other: &Self) -> bool {
        self.cameras == other.cameras && self.document.is_same_work(&other.document)
    }
}

impl Album {
    /// Creates an album without work on any pair.
    pub fn new(folder: &PictureFolder, pair: [usize; 2]) -> Self {
        Self { folder: folder.path().to_owned(), open: view_names(folder, pair), pairs: Vec::new() }
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the work on the pairs that are not open.
    pub fn pairs(&self) -> &[KeptPair] {
        &self.pairs
    }

    /// Returns the work on a pair that is not open.
    pub fn kept(&self, views: &ViewNames) -> Option<&KeptPair> {
        Some(&self.pairs[self.find(views)?])
    }

    /// Removes and returns the work on the pair that is open now.
    pub fn take_open(&mut self) -> Option<KeptPair> {
        let at = self.find(&self.open)?;
        Some(self.pairs.remove(at))
    }

    fn find(&self, views: &ViewNames) -> Option<usize> {
        self.pairs.binary_search_by(|kept| kept.views.cmp(views)).ok()
    }

    /// Adds the work on a pair that was open.
    pub fn keep(&mut self, kept: KeptPair) {
        let at = self.pairs.partition_point(|other| other.views < kept.views);
        self.pairs.insert(at, kept);
    }

    /// Converts the album for a session at `path`, with relative paths.
    pub fn to_session(&mut self, path: &Path) {
        self.folder = relative(&self.folder, path).into();
        for kept in &mut self.pairs {
            kept.document.pictures = None;
            if let Some(TruthSource::Folder { folder, .. }) = &mut kept.document.truth {
                *folder = relative(folder, path).into();
            }
        }
    }

    /// Validates an album from a session at `path`.
    pub fn make_valid(&mut self, path: &Path) {
        self.folder = resolve(&self.folder.to_string_lossy(), path);
        let open = self.open.clone();
        self.pairs.retain(|kept| kept.views != open);
        self.pairs.sort_by(|one, other| one.views.cmp(&other.views));
        self.pairs.dedup_by(|one, other| one.views == other.views);
        for kept in &mut self.pairs {
            kept.pins.drain(..).for_each(|pin| kept.document.pin(pin));
            if let Some(TruthSource::Folder { folder, .. }) = &mut kept.document.truth {
                *folder = resolve(&folder.to_string_lossy(), path);
            }
        }
    }
}

pub fn view_names(folder: &PictureFolder, pair: [usize; 2]) -> ViewNames {
    pair.map(|view| folder.names()[view].clone())
}
