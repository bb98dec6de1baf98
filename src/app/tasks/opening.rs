//! What can be opened, and how pictures, the built-in pair and the pairs of a folder are.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::app::model::document::{Side, TruthSource};
use crate::app::model::open_pair::OpenFolder;
use crate::app::model::pair_folder::PairFolder;
use crate::app::model::picture::Opened;
use crate::app::model::sample::sample_pair;
use crate::app::model::session::{Relocation, Restored};
use crate::app::model::shared::Shared;
use crate::app::model::truth::KnownTruth;
use crate::geometry::PointPair;
use crate::image::{LoadError, LoadOptions, Picture};

/// What to open.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Opening {
    /// The built-in pair.
    #[default]
    Sample,
    /// Two files, left and right.
    Files(PathBuf, PathBuf),
    /// The first pair of a folder.
    Folder(PathBuf),
    /// A session.
    Session(PathBuf),
}

/// What an opening gives.
pub struct LoadedPair {
    /// The two pictures.
    pub pictures: [Opened; 2],
    /// Point pairs for "Show me", when there are any.
    pub show_me: Option<[PointPair; 2]>,
    /// What is known about them, if anything.
    pub known: Option<KnownTruth>,
    /// The folder that the pictures are of.
    pub folder: Option<OpenFolder>,
    /// Whether what is known is to be used from the start.
    pub uses_truth: bool,
    /// What a session brings.
    pub restored: Option<Box<Restored>>,
    /// What a person has to know about the pictures, a sentence or two each.
    pub notes: Vec<String>,
}

/// Why nothing was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OpeningFailure {
    /// What happened and what to do.
    Text(String),
    /// A file that was to be a session is something else.
    NoSession {
        /// The file.
        path: PathBuf,
        /// That it is no session.
        problem: String,
    },
    /// A picture is damaged, and some of it can be read: what happened and what to do.
    Damaged(String),
    /// The images of a session have to be found first.
    Relocate(Box<Relocation>),
}

impl LoadedPair {
    /// Two pictures of which nothing else is known.
    pub fn of(pictures: [Opened; 2]) -> Self {
        Self {
            pictures,
            show_me: None,
            known: None,
            folder: None,
            uses_truth: false,
            restored: None,
            notes: Vec::new(),
        }
    }
}

/// How the pictures of one opening are read, and what there is to tell about them.
#[derive(Default)]
pub struct Reading {
    /// Pictures that are open and not read again.
    pub open: Vec<Opened>,
    /// Whether damaged pictures are read as far as they go.
    pub accepts_damaged: bool,
    /// What a person has to know about the pictures.
    pub notes: Vec<String>,
}

impl Reading {
    /// The picture of a file.
    pub fn picture(&mut self, path: &Path, side: Side) -> Result<Opened, OpeningFailure> {
        if let Some(same) = self.open.iter().find(|opened| opened.picture.path.as_deref() == Some(path)) {
            return Ok(same.clone());
        }
        let name = side.name();
        let read = match Picture::open(path) {
            Err(LoadError::Damaged { path: shown, reason, in_part: true }) => {
                let problem = format!("The {name} image {shown} is damaged or incomplete: {reason}.");
                if !self.accepts_damaged {
                    return Err(OpeningFailure::Damaged(format!(
                        "{problem} Nothing was changed; get it anew, or open it anyway: what is missing will be black or grey."
                    )));
                }
                self.notes.push(format!(
                    "{problem} What could be read of it is shown; what is missing is black or grey: place no points there."
                ));
                let options = LoadOptions::from_environment();
                options.and_then(|options| {
                    Picture::open_with(path, LoadOptions { accept_damaged: true, ..options })
                })
            }
            read => read,
        };
        read.map(Opened::new).map_err(|error| {
            OpeningFailure::Text(format!(
                "The {name} image: {error}. Nothing was changed; check the file, or open another one."
            ))
        })
    }
}

/// What happened with a folder and what to do.
fn unchanged(error: &str) -> OpeningFailure {
    OpeningFailure::Text(format!(
        "The folder could not be opened: {error}. Nothing was changed; correct it, or open another one."
    ))
}

/// The built-in pair.
pub fn sample() -> LoadedPair {
    let sample = sample_pair();
    let source = TruthSource::Sample(sample.truth.name.clone());
    let known = Some(KnownTruth { truth: Shared::new(sample.truth), source });
    // Who learns the program is not shown the answer before the question: the truth is not used at once.
    LoadedPair { show_me: Some(sample.show_me), known, ..LoadedPair::of(sample.pictures.map(Opened::new)) }
}

/// The first pair of a folder.
pub fn open_folder(path: &Path, reading: &mut Reading) -> Result<LoadedPair, OpeningFailure> {
    let folder = PairFolder::open(path).map_err(|problem| unchanged(&problem))?;
    open_views(&Arc::new(folder), [0, 1], reading)
}

/// Two views of a folder.
pub fn open_views(
    folder: &Arc<PairFolder>,
    pair: [usize; 2],
    reading: &mut Reading,
) -> Result<LoadedPair, OpeningFailure> {
    let mut view = |k: usize, side: Side| reading.picture(folder.image(pair[k]), side);
    let pictures = [view(0, Side::Left)?, view(1, Side::Right)?];
    let opened = LoadedPair { folder: Some((Arc::clone(folder), pair)), ..LoadedPair::of(pictures) };
    let Some(known) = folder.known() else { return Ok(opened) };
    let truth = known.truth(pair).map_err(|error| unchanged(&error.to_string()))?;
    let views = pair.map(|view| known.names()[view].clone());
    let source = TruthSource::Folder { folder: known.path().to_owned(), views };
    Ok(LoadedPair {
        known: Some(KnownTruth { truth: Shared::new(truth), source }),
        uses_truth: true,
        ..opened
    })
}
