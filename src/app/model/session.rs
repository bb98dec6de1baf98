//! Sessions: saved work, and the state of saving and opening.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use serde::{Deserialize, Serialize};

use super::album::Album;
use super::document::{Document, Given, LineSource, PINS, PointRef, TruthSource};
use super::look::Look;
use super::pane_view::PaneView;
use super::picture::Opened;
use super::sample::{SAMPLE_SEQUENCES, sample_of};
use crate::camera::{CameraModel, PicturesOf};
use crate::estimate::Method;
use crate::geometry::Frame;
use crate::io::{ImageReference, ImageSource, SessionFile, has_extension, relative, resolve};
use crate::study::Question;

/// Maximum number of pairs of a session, far more than anybody clicks. Each is drawn and listed.
const MOST_PAIRS: usize = 1000;

/// Work of a person on a pair of images, in the form for saving.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Points, parameters and ground truth. The session itself names the pictures.
    pub document: Document,
    /// Pinned line pairs of older sessions, oldest first.
    #[serde(default, skip_serializing)]
    pub pins: Vec<LineSource>,
    /// Visible part of each image.
    #[serde(default)]
    pub views: Option<[PaneView; 2]>,
    /// Visible overlays, tabs and panels.
    #[serde(default)]
    pub look: Look,
    /// Folder of the pictures, with the work on its other pairs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub album: Option<Album>,
    /// Calibrated cameras of the pictures. All points are then in views without distortion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cameras: Option<[CameraModel; 2]>,
    /// Session file that this unsaved work belongs to. Only in the program's own copies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub belongs_to: Option<PathBuf>,
}

impl Work {
    /// Returns the work of a search that another program asked for. All points are in the views of `cameras`.
    pub fn of_question(question: &Question, cameras: Option<[CameraModel; 2]>, offset: i32) -> Self {
        let given = question.given.filter(|given| !given.is_empty());
        let document = Document {
            pairs: question.clicks.to_vec(),
            unclicked: question.clicks.len() < Method::TwoPoint.pairs_needed(),
            parameters: question.parameters.clone(),
            offset,
            given: given.map(|given| Given::new("the calling program".to_owned(), given.to_vec())),
            ..Document::default()
        };
        Self { document, cameras, ..Self::default() }
    }

    /// Returns the session file of this work, for writing at `path`. `None` if a picture is neither
    /// a file nor part of a sample.
    pub fn to_session(&self, pictures: &[Opened; 2], path: &Path) -> Option<SessionFile<Self>> {
        let reference = |opened: &Opened| {
            let source = match (&opened.picture.path, &opened.sha256) {
                (Some(file), Some(sha256)) => {
                    ImageSource::File { path: relative(file, path), sha256: sha256.clone() }
                }
                (None, _) if opened.recording.is_some() => {
                    ImageSource::Sample { sample: SAMPLE_SEQUENCES.to_owned() }
                }
                (None, _) => ImageSource::Sample { sample: sample_of(opened.shown())?.name().to_owned() },
                (Some(_), None) => return None,
            };
            Some(ImageReference { source, frame: opened.shown().frame() })
        };
        let mut content = self.clone();
        content.document.pictures = None;
        if let Some(TruthSource::Folder { folder, .. }) = &mut content.document.truth {
            *folder = relative(folder, path).into();
        }
        if let Some(album) = &mut content.album {
            album.to_session(path);
        }
        Some(SessionFile {
            images: [reference(&pictures[0])?, reference(&pictures[1])?],
            fundamental: None,
            pictures: PicturesOf::Untold,
            trust: None,
            content,
        })
    }

    /// Validates work from a file: points within the images, and absolute paths.
    #[must_use]
    pub fn made_valid(mut self, frames: [Frame; 2], path: &Path) -> Self {
        if let Some(TruthSource::Folder { folder, .. }) = &mut self.document.truth {
            *folder = resolve(&folder.to_string_lossy(), path);
        }
        if let Some(album) = &mut self.album {
            album.make_valid(path);
        }
        self.pins.drain(..).for_each(|pin| self.document.pin(pin));
        self.document.keep_within(frames);
        self.views =
            self.views.map(|[left, right]| [left.made_valid(frames[0]), right.made_valid(frames[1])]);
        self
    }
}

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OpenSession {
    pub path: PathBuf,
    /// Images that replace the images named by the session.
    pub images: [Option<PathBuf>; 2],
    pub accepts_changed: bool,
    pub owner: SessionOwner,
}

/// Owner of a session file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SessionOwner {
    /// A person, who saved it.
    #[default]
    Person,
    /// This program: a copy of unsaved work.
    Autosave,
    /// Another program, which hands its question over and removes the file.
    Caller,
}

impl From<PathBuf> for OpenSession {
    fn from(path: PathBuf) -> Self {
        Self { path, ..Self::default() }
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lost {
    /// The file does not exist.
    Missing(PathBuf),
    /// The file exists, but its content differs from the image of the session.
    Changed(PathBuf),
}

/// A session with images that the user must find.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Relocation {
    pub session: OpenSession,
    pub lost: [Option<Lost>; 2],
}

/// Contents of a session besides its pictures.
#[derive(Debug, Clone)]
pub struct Restored {
    pub session: OpenSession,
    pub work: Work,
    /// Parts that could not be restored, one sentence each.
    pub notes: Vec<String>,
}

#[derive(Debug, Clone, Default)]
pub struct SessionState {
    /// Path of the session file, once there is one.
    pub path: Option<PathBuf>,
    /// Work in the file, as last saved or opened.
    pub saved: Option<Work>,
    /// Modification time and length of the file when it was last read or written.
    pub on_disk: Option<(SystemTime, u64)>,
    /// Work in the program's own copy.
    pub copied: Option<Work>,
    pub last_copy: Option<Instant>,
}

impl SessionState {
    /// Sets the session file, after it was read or written, and the work in it.
    pub fn belongs_to(&mut self, path: PathBuf, saved: Work) {
        self.saved = Some(saved);
        self.on_disk = state_on_disk(&path);
        // An absolute path stays valid wherever the program is started.
        self.path = Some(std::path::absolute(&path).unwrap_or(path));
    }

    /// Returns whether the file changed since this window read or wrote it.
    pub fn is_changed_by_others(&self, path: &Path) -> bool {
        let now = state_on_disk(path);
        now.is_some() && now != self.on_disk
    }
}

/// Returns modification time and length of a file.
fn state_on_disk(path: &Path) -> Option<(SystemTime, u64)> {
    let found = path.metadata().ok()?;
    Some((found.modified().ok()?, found.len()))
}

impl Document {
    /// Returns whether two documents have the same work. Selections do not count.
    pub(super) fn is_same_work(&self, other: &Self) -> bool {
        let work =
            |document: &Self| Self { pictures: None, selection: None, inspected: None, ..document.clone() };
        work(self) == work(other)
    }

    /// Returns whether the document has work that would be lost. A session has no results, so a search without clicks
    /// is none, except as one `of_an_album`: there it tells which pairs were looked at.
    pub fn is_worth_keeping(&self, of_an_album: bool) -> bool {
        let has_points = !self.pairs.is_empty() || self.half.is_some() || !self.pins.is_empty();
        has_points || (self.unclicked && of_an_album) || self.imported.is_some() || self.given.is_some()
    }

    /// Moves points into images of these sizes, and removes references to missing points.
    pub(super) fn keep_within(&mut self, frames: [Frame; 2]) {
        self.pairs.truncate(MOST_PAIRS);
        let broken: Vec<_> = (0..self.pairs.len()).filter(|pair| !self.pairs[*pair].is_finite()).collect();
        let selection = self.selection;
        self.remove_all(broken);
        self.selection = selection;
        // A file may contain notes about missing pairs.
        self.notes.retain(|pair, _| *pair < self.pairs.len());
        for pair in &mut self.pairs {
            pair.point1 = frames[0].nearest(pair.point1);
            pair.point2 = frames[1].nearest(pair.point2);
        }
        if let Some(half) = &mut self.half {
            half.point = frames[half.side.index()].nearest(half.point);
        }
        for numbers in [&mut self.excluded, &mut self.checks] {
            numbers.retain(|pair| *pair < self.pairs.len());
        }
        self.selection = self.selection.filter(|at: &PointRef| self.point(*at).is_some());
        let (pairs, mut numbers) = (self.pairs.len(), BTreeSet::new());
        self.pins.retain(|pin| pin.number < PINS && numbers.insert(pin.number) && pin.source.is_of(pairs));
    }
}

/// Returns a path for a new session: beside the left image, named after both images.
pub fn suggested_path(pictures: &[Opened; 2]) -> PathBuf {
    let stem = |opened: &Opened| {
        let name = Path::new(&opened.picture.name);
        name.file_stem().map_or_else(|| "image".to_owned(), |stem| stem.to_string_lossy().into_owned())
    };
    let folder = pictures[0].picture.path.as_deref().and_then(Path::parent).map(Path::to_owned);
    let folder = folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
    folder.join(format!("{}-{}.json", stem(&pictures[0]), stem(&pictures[1])))
}

/// Returns whether a file may be a session, by its extension.
pub fn has_session_extension(path: &Path) -> bool {
    has_extension(path, &["json"])
}
