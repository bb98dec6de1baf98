//! Sessions: saving what a person set, opening it again, and keeping it through a crash.

mod autosave;
mod command;
mod opening;
mod saver;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::document::{Document, PointRef, TruthSource};
use super::focus::LineSource;
use super::loader::Opened;
use super::look::Look;
use super::panes::View;
use crate::geometry::Frame;
use crate::io::{ImageReference, ImageSource, SessionFile, relative, resolve};
use crate::synthetic::Sample;

pub use autosave::Autosave;
pub use command::SessionCommand;
pub use opening::{Lost, OpenSession, Relocation, Restored, open};
pub use saver::{Job, Saver, Written};

/// Pairs of a session that are taken, far more than anybody clicks: each is drawn, and listed.
const MOST_PAIRS: usize = 1000;

/// Everything a person set on a pair of images, as it is saved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Points, parameters, ground truth; without the pictures, which the session names itself.
    pub document: Document,
    /// The pinned line pairs, the oldest first.
    #[serde(default)]
    pub pins: Vec<LineSource>,
    /// What part of each image is shown.
    #[serde(default)]
    pub views: Option<[View; 2]>,
    /// What is drawn.
    #[serde(default)]
    pub look: Look,
    /// The session that unsaved work belongs to, in the program's own copy of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub belongs_to: Option<PathBuf>,
}

impl Work {
    /// Whether saving one over the other loses nothing that a person made. How it is looked at does not count.
    pub fn is_same_work(&self, other: &Self) -> bool {
        let made = |work: &Self| Document { selection: None, pictures: None, ..work.document.clone() };
        self.pins == other.pins && made(self) == made(other)
    }

    /// Whether there is anything that would be a loss. A random trial can be drawn again.
    pub fn is_worth_keeping(&self) -> bool {
        let drawn =
            if self.document.trial.is_some() { self.document.parameters.method.pairs_needed() } else { 0 };
        self.document.pairs.len() > drawn
            || self.document.half.is_some()
            || self.document.imported.is_some()
            || !self.pins.is_empty()
    }

    /// The session file of this work on some pictures, to be written at `path`; `None` when a picture is neither a
    /// file nor a sample's.
    pub fn to_session(&self, pictures: &[Opened; 2], path: &Path) -> Option<SessionFile<Self>> {
        let reference = |opened: &Opened| {
            let source = match (&opened.picture.path, &opened.sha256) {
                (Some(file), Some(sha256)) => {
                    ImageSource::File { path: relative(file, path), sha256: sha256.clone() }
                }
                (None, _) => ImageSource::Sample { sample: Sample::default().name().to_owned() },
                (Some(_), None) => return None,
            };
            Some(ImageReference { source, frame: opened.picture.frame() })
        };
        let mut content = self.clone();
        content.document.pictures = None;
        if let Some(TruthSource::Folder { folder, .. }) = &mut content.document.truth {
            *folder = relative(folder, path).into();
        }
        Some(SessionFile {
            images: [reference(&pictures[0])?, reference(&pictures[1])?],
            fundamental: None,
            content,
        })
    }

    /// Brings what a file says into the limits of the images, and paths back to whole ones.
    fn made_valid(mut self, frames: [Frame; 2], path: &Path) -> Self {
        if let Some(TruthSource::Folder { folder, .. }) = &mut self.document.truth {
            *folder = resolve(&folder.to_string_lossy(), path);
        }
        self.document.keep_within(frames);
        self.views =
            self.views.map(|[left, right]| [left.made_valid(frames[0]), right.made_valid(frames[1])]);
        let pairs = self.document.pairs.len();
        self.pins.retain(|pin| match pin {
            LineSource::Pair(pair) | LineSource::Pencil { pair, .. } => *pair < pairs,
            LineSource::Through { point, .. } => point.iter().all(|v| v.is_finite()),
        });
        self
    }
}

impl Document {
    /// Keeps points on images of these sizes, and forgets what refers to points that are not there.
    fn keep_within(&mut self, frames: [Frame; 2]) {
        self.pairs.truncate(MOST_PAIRS);
        self.pairs.retain(crate::geometry::PointPair::is_finite);
        for pair in &mut self.pairs {
            pair.point1 = frames[0].nearest(pair.point1);
            pair.point2 = frames[1].nearest(pair.point2);
        }
        if let Some(half) = &mut self.half {
            half.point = frames[half.side.index()].nearest(half.point);
        }
        self.excluded.retain(|pair| *pair < self.pairs.len());
        self.selection = self.selection.filter(|at: &PointRef| self.point(*at).is_some());
    }
}

/// A name for a new session: beside the left image, called after both.
pub fn suggested_path(pictures: &[Opened; 2]) -> PathBuf {
    let stem = |opened: &Opened| {
        let name = Path::new(&opened.picture.name);
        name.file_stem().map_or_else(|| "image".to_owned(), |stem| stem.to_string_lossy().into_owned())
    };
    let folder = pictures[0].picture.path.as_deref().and_then(Path::parent).map(Path::to_owned);
    let folder = folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
    folder.join(format!("{}-{}.json", stem(&pictures[0]), stem(&pictures[1])))
}

/// Whether a file may be a session, by its name.
pub fn has_session_extension(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}
