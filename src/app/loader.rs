//! Opening pictures off the window's thread.
//!
//! Decoding a large photograph takes a second or more. Each opening runs in a thread of its own; a newer
//! one makes the window forget the older.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::document::{Side, TruthSource};
use super::panes::Overview;
use super::sample::sample_pair;
use super::session::{self, OpenSession, Relocation, Restored};
use super::truth::Known;
use super::waker::Waker;
use super::worker::panic_text;
use crate::geometry::PointPair;
use crate::image::{LoadError, Picture};
use crate::io::{TruthFolder, sha256_of};

/// What to open.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Opening {
    /// The built-in pair.
    #[default]
    Sample,
    /// Two files, left and right.
    Files(PathBuf, PathBuf),
    /// The first pair of a folder whose geometry is known.
    Folder(PathBuf),
    /// A session.
    Session(PathBuf),
}

/// One picture ready to be shown.
#[derive(Clone)]
pub struct Opened {
    /// Its pixels.
    pub picture: Arc<Picture>,
    /// A reduced copy for the screen.
    pub overview: Arc<Overview>,
    /// Of the bytes of its file, hexadecimal; `None` without a file.
    pub sha256: Option<String>,
}

impl Opened {
    /// Prepares a picture for the screen. Takes a while.
    pub fn new(picture: Picture) -> Self {
        let overview = Arc::new(Overview::new(&picture));
        let sha256 = picture.path.as_deref().and_then(|path| sha256_of(path).ok());
        Self { picture: Arc::new(picture), overview, sha256 }
    }
}

/// A picture to be opened, or one that stays open.
#[derive(Clone)]
pub enum Source {
    /// A file.
    File(PathBuf),
    /// The picture that is open now.
    Keep(Opened),
}

/// What an opening gives.
pub struct Pair {
    /// The two pictures.
    pub pictures: [Opened; 2],
    /// Point pairs for "Show me", when there are any.
    pub show_me: Option<[PointPair; 2]>,
    /// What is known about them, if anything.
    pub known: Option<Known>,
    /// Whether what is known is to be used from the start.
    pub uses_truth: bool,
    /// What a session brings.
    pub restored: Option<Box<Restored>>,
}

/// Why nothing was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
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

/// The opening under way, if any.
pub struct Loader {
    waker: Waker,
    under_way: Option<Receiver<Result<Pair, Failure>>>,
}

impl Loader {
    /// Nothing to open yet.
    pub fn new(waker: Waker) -> Self {
        Self { waker, under_way: None }
    }

    /// Whether pictures are being opened.
    pub fn is_busy(&self) -> bool {
        self.under_way.is_some()
    }

    /// Opens the built-in pair.
    pub fn open_sample(&mut self) {
        self.start(|| Ok(sample()));
    }

    /// Opens two pictures.
    pub fn open(&mut self, sources: [Source; 2]) {
        self.start(|| {
            let mut opened = Vec::with_capacity(2);
            for (source, side) in sources.into_iter().zip(Side::BOTH) {
                opened.push(match source {
                    Source::Keep(opened) => opened,
                    Source::File(path) => {
                        let opened = Picture::open(&path).map(Opened::new);
                        opened.map_err(|error| failure(side, &error))?
                    }
                });
            }
            let pictures =
                opened.try_into().map_err(|_| Failure::Text("two pictures are needed".to_owned()))?;
            Ok(Pair { pictures, show_me: None, known: None, uses_truth: false, restored: None })
        });
    }

    /// Opens the first pair of a folder whose geometry is known.
    pub fn open_folder(&mut self, path: PathBuf) {
        self.start(move || {
            let folder = TruthFolder::open(&path).map_err(|error| unchanged(&error.to_string()))?;
            open_pair(&Arc::new(folder), [0, 1], &[])
        });
    }

    /// Opens a pair of a folder; what of it is `open` already is not read again.
    pub fn open_pair(&mut self, folder: Arc<TruthFolder>, pair: [usize; 2], open: Vec<Opened>) {
        self.start(move || open_pair(&folder, pair, &open));
    }

    /// Opens a session with its pictures.
    pub fn open_session(&mut self, session: OpenSession) {
        self.start(move || session::open(session));
    }

    /// The end of the opening under way, once it is there.
    pub fn poll(&mut self) -> Option<Result<Pair, Failure>> {
        let result = match self.under_way.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => {
                Err(Failure::Text("The images could not be opened.".to_owned()))
            }
            Ok(result) => result,
        };
        self.under_way = None;
        Some(result)
    }

    fn start(&mut self, open: impl FnOnce() -> Result<Pair, Failure> + Send + 'static) {
        let (sender, receiver) = channel();
        let waker = self.waker.clone();
        let thread = std::thread::Builder::new().name("open".into()).spawn(move || {
            let result = catch_unwind(AssertUnwindSafe(open)).unwrap_or_else(|payload| {
                let text = panic_text(payload.as_ref());
                Err(Failure::Text(format!("The image could not be opened: {text}.")))
            });
            // A newer opening has dropped the receiver: then nobody wants this one.
            let _ = sender.send(result);
            waker.wake();
        });
        // Without a thread the sender is gone, which `poll` reports.
        drop(thread);
        self.under_way = Some(receiver);
    }
}

/// What happened and what to do.
pub fn failure(side: Side, error: &LoadError) -> Failure {
    let side = side.name();
    Failure::Text(format!(
        "The {side} image: {error}. Nothing was changed; check the file, or open another one."
    ))
}

/// What happened with a folder and what to do.
fn unchanged(error: &str) -> Failure {
    Failure::Text(format!(
        "The folder could not be opened: {error}. Nothing was changed; correct it, or open another one."
    ))
}

/// The built-in pair.
pub fn sample() -> Pair {
    let sample = sample_pair();
    let source = TruthSource::Sample(sample.truth.name.clone());
    Pair {
        pictures: sample.pictures.map(Opened::new),
        show_me: Some(sample.show_me),
        known: Some(Known { truth: Arc::new(sample.truth), source, folder: None }),
        // Who learns the program is not shown the answer before the question.
        uses_truth: false,
        restored: None,
    }
}

fn open_pair(folder: &Arc<TruthFolder>, pair: [usize; 2], open: &[Opened]) -> Result<Pair, Failure> {
    let truth = folder.truth(pair).map_err(|error| unchanged(&error.to_string()))?;
    let picture = |view: usize, side: Side| {
        let path: &Path = folder.image(view);
        let same = open.iter().find(|opened| opened.picture.path.as_deref() == Some(path));
        same.map_or_else(
            || Picture::open(path).map(Opened::new).map_err(|error| failure(side, &error)),
            |opened| Ok(opened.clone()),
        )
    };
    let pictures = [picture(pair[0], Side::Left)?, picture(pair[1], Side::Right)?];
    let views = pair.map(|view| folder.names()[view].clone());
    let source = TruthSource::Folder { folder: folder.path().to_owned(), views };
    let known = Known { truth: Arc::new(truth), source, folder: Some((Arc::clone(folder), pair)) };
    Ok(Pair { pictures, show_me: None, known: Some(known), uses_truth: true, restored: None })
}
