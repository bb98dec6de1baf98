//! Sessions: everything a person set, what of it is saved, and what opening it again takes.

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use serde::{Deserialize, Serialize};

use super::album::Album;
use super::document::{Document, PointRef, TruthSource};
use super::focus::LineSource;
use super::look::Look;
use super::pane_view::PaneView;
use super::picture::Opened;
use super::sample::SAMPLE_SEQUENCES;
use crate::geometry::Frame;
use crate::io::{ImageReference, ImageSource, SessionFile, relative, resolve};
use crate::synthetic::Sample;

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
    pub views: Option<[PaneView; 2]>,
    /// What is drawn.
    #[serde(default)]
    pub look: Look,
    /// The folder that the pictures are of, with what was set on its other pairs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub album: Option<Album>,
    /// The session that unsaved work belongs to, in the program's own copy of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub belongs_to: Option<PathBuf>,
}

impl Work {
    /// Whether saving one over the other loses nothing that a person made. How it is looked at does not count.
    pub fn is_same_work(&self, document: &Document, pins: impl Iterator<Item = LineSource>) -> bool {
        self.document.is_same_work(document) && pins.eq(self.pins.iter().copied())
    }

    /// The session file of this work on some pictures, to be written at `path`; `None` when a picture is neither a
    /// file nor a sample's.
    pub fn to_session(&self, pictures: &[Opened; 2], path: &Path) -> Option<SessionFile<Self>> {
        let reference = |opened: &Opened| {
            let source = match (&opened.picture.path, &opened.sha256) {
                (Some(file), Some(sha256)) => {
                    ImageSource::File { path: relative(file, path), sha256: sha256.clone() }
                }
                (None, _) if opened.recording.is_some() => {
                    ImageSource::Sample { sample: SAMPLE_SEQUENCES.to_owned() }
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
        if let Some(album) = &mut content.album {
            album.to_session(path);
        }
        Some(SessionFile {
            images: [reference(&pictures[0])?, reference(&pictures[1])?],
            fundamental: None,
            trust: None,
            content,
        })
    }

    /// Brings what a file says into the limits of the images, and paths back to whole ones.
    #[must_use]
    pub fn made_valid(mut self, frames: [Frame; 2], path: &Path) -> Self {
        if let Some(TruthSource::Folder { folder, .. }) = &mut self.document.truth {
            *folder = resolve(&folder.to_string_lossy(), path);
        }
        if let Some(album) = &mut self.album {
            album.make_valid(path);
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

/// A session to open.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OpenSession {
    /// The file.
    pub path: PathBuf,
    /// Images in place of those that the session names.
    pub images: [Option<PathBuf>; 2],
    /// Whether images that have changed are taken as they are.
    pub accepts_changed: bool,
    /// Whether the file is the program's own copy of unsaved work.
    pub recovers: bool,
}

impl From<PathBuf> for OpenSession {
    fn from(path: PathBuf) -> Self {
        Self { path, ..Self::default() }
    }
}

/// What is wrong with an image of a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lost {
    /// There is no such file.
    Missing(PathBuf),
    /// There is a file, but it is not the one that the session was made with.
    Changed(PathBuf),
}

/// A session whose images have to be found first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Relocation {
    /// What was to be opened.
    pub session: OpenSession,
    /// What is wrong with each image.
    pub lost: [Option<Lost>; 2],
}

/// What a session brings besides its pictures.
#[derive(Debug, Clone)]
pub struct Restored {
    /// What was opened.
    pub session: OpenSession,
    /// What was set.
    pub work: Work,
    /// What could not be had, a sentence each.
    pub notes: Vec<String>,
}

/// Which session is open, and what of it is saved.
#[derive(Debug, Clone, Default)]
pub struct SessionState {
    /// The file, once there is one.
    pub path: Option<PathBuf>,
    /// What is in the file, or what was opened.
    pub saved: Option<Work>,
    /// When and how long the file was when it was read or written last.
    pub on_disk: Option<(SystemTime, u64)>,
    /// What is in the program's own copy of unsaved work.
    pub copied: Option<Work>,
    /// When that was written last.
    pub last_copy: Option<Instant>,
}

impl SessionState {
    /// The file that was just read or written is the session's; what is in it.
    pub fn belongs_to(&mut self, path: PathBuf, saved: Work) {
        self.saved = Some(saved);
        self.on_disk = state_on_disk(&path);
        // A path that means the same wherever the program is started.
        self.path = Some(std::path::absolute(&path).unwrap_or(path));
    }

    /// Whether a file is not what this window read or wrote.
    pub fn is_changed_by_others(&self, path: &Path) -> bool {
        let now = state_on_disk(path);
        now.is_some() && now != self.on_disk
    }
}

/// When a file was changed last and how long it is.
fn state_on_disk(path: &Path) -> Option<(SystemTime, u64)> {
    let found = path.metadata().ok()?;
    Some((found.modified().ok()?, found.len()))
}

impl Document {
    /// Whether a person made the same of it. What is selected does not count.
    pub(super) fn is_same_work(&self, other: &Self) -> bool {
        let Self {
            pictures: _,
            pairs,
            excluded,
            checks,
            notes,
            unclicked,
            half,
            parameters,
            offset,
            rectification,
            truth,
            imported,
            selection: _,
            chosen: _,
        } = self;
        *pairs == other.pairs
            && *excluded == other.excluded
            && *checks == other.checks
            && *notes == other.notes
            && *unclicked == other.unclicked
            && *half == other.half
            && *parameters == other.parameters
            && *offset == other.offset
            && *rectification == other.rectification
            && *truth == other.truth
            && *imported == other.imported
    }

    /// Whether there is anything on the images that would be a loss.
    pub fn is_worth_keeping(&self) -> bool {
        !self.pairs.is_empty() || self.half.is_some() || self.imported.is_some()
    }

    /// Keeps points on images of these sizes, and forgets what refers to points that are not there.
    pub(super) fn keep_within(&mut self, frames: [Frame; 2]) {
        self.pairs.truncate(MOST_PAIRS);
        let broken: Vec<_> = (0..self.pairs.len()).filter(|pair| !self.pairs[*pair].is_finite()).collect();
        let selection = self.selection;
        self.remove_all(broken);
        self.selection = selection;
        // What a file says of pairs that are not there.
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
