//! Opening pictures off the window's thread.
//!
//! Decoding a large photograph takes a second or more. Each opening runs in a thread of its own; a newer
//! one makes the window forget the older.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::opening;
use super::task::{Event, Task, Waiting};
use super::waker::Waker;
use crate::app::model::document::{Side, TruthSource};
use crate::app::model::open_pair::OpenFolder;
use crate::app::model::pair_folder::PairFolder;
use crate::app::model::picture::Opened;
use crate::app::model::sample::sample_pair;
use crate::app::model::session::{OpenSession, Relocation, Restored};
use crate::app::model::shared::Shared;
use crate::app::model::truth::KnownTruth;
use crate::geometry::PointPair;
use crate::image::{LoadError, Picture};

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
    /// The images of a session have to be found first.
    Relocate(Box<Relocation>),
}

impl LoadedPair {
    /// Two pictures of which nothing else is known.
    pub fn of(pictures: [Opened; 2]) -> Self {
        Self { pictures, show_me: None, known: None, folder: None, uses_truth: false, restored: None }
    }
}

type Open = Box<dyn FnOnce() -> Result<LoadedPair, OpeningFailure> + Send>;

/// The opening under way, if any.
pub struct Loader {
    waker: Waker,
    task: Option<Task<Open, Result<LoadedPair, OpeningFailure>>>,
    /// The pictures that were opened last: they are not read again.
    open: Vec<Opened>,
}

impl Loader {
    /// Nothing to open yet.
    pub fn new(waker: Waker) -> Self {
        Self { waker, task: None, open: Vec::new() }
    }

    /// Whether pictures are being opened.
    pub fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Opens the built-in pair.
    pub fn open_sample(&mut self) {
        self.start(|| Ok(sample()));
    }

    /// Opens two pictures.
    pub fn open(&mut self, [left, right]: [PathBuf; 2]) {
        self.start(move || {
            Ok(LoadedPair::of([picture(&left, Side::Left, &[])?, picture(&right, Side::Right, &[])?]))
        });
    }

    /// Opens the first pair of a folder.
    pub fn open_folder(&mut self, path: PathBuf) {
        self.start(move || {
            let folder = PairFolder::open(&path).map_err(|problem| unchanged(&problem))?;
            open_pair(&Arc::new(folder), [0, 1], &[])
        });
    }

    /// Opens a pair of a folder; what of it is open already is not read again.
    pub fn open_pair(&mut self, folder: Arc<PairFolder>, pair: [usize; 2]) {
        let open = self.open.clone();
        self.start(move || open_pair(&folder, pair, &open));
    }

    /// Opens a session with its pictures.
    pub fn open_session(&mut self, session: OpenSession) {
        self.start(move || opening::open(session));
    }

    /// The end of the opening under way, once it is there.
    pub fn poll(&mut self) -> Option<Result<LoadedPair, OpeningFailure>> {
        let (_, event) = self.task.as_mut()?.poll()?;
        self.task = None;
        let result = match event {
            Event::Told(result) | Event::Over(Ok(Some(result))) => result,
            Event::Over(Ok(None)) => Err(OpeningFailure::Text("The images could not be opened.".to_owned())),
            Event::Over(Err(panic)) => {
                Err(OpeningFailure::Text(format!("The image could not be opened: {panic}.")))
            }
        };
        if let Ok(pair) = &result {
            self.open = pair.pictures.to_vec();
        }
        Some(result)
    }

    fn start(&mut self, open: impl FnOnce() -> Result<LoadedPair, OpeningFailure> + Send + 'static) {
        // A newer opening does not wait for the older one.
        let mut task = Task::new("open", self.waker.clone(), Waiting::Newest, |open: Open, _| Some(open()));
        task.ask(Box::new(open));
        self.task = Some(task);
    }
}

/// A picture of a file, unless it is among those that are open.
pub fn picture(path: &Path, side: Side, open: &[Opened]) -> Result<Opened, OpeningFailure> {
    let same = open.iter().find(|opened| opened.picture.path.as_deref() == Some(path));
    same.map_or_else(
        || Picture::open(path).map(Opened::new).map_err(|error| failure(side, &error)),
        |opened| Ok(opened.clone()),
    )
}

/// What happened and what to do.
fn failure(side: Side, error: &LoadError) -> OpeningFailure {
    let side = side.name();
    OpeningFailure::Text(format!(
        "The {side} image: {error}. Nothing was changed; check the file, or open another one."
    ))
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

fn open_pair(
    folder: &Arc<PairFolder>,
    pair: [usize; 2],
    open: &[Opened],
) -> Result<LoadedPair, OpeningFailure> {
    let view = |k: usize, side: Side| picture(folder.image(pair[k]), side, open);
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
