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
use super::truth::Known;
use super::waker::Waker;
use super::worker::panic_text;
use crate::geometry::PointPair;
use crate::image::{LoadError, Picture};
use crate::io::TruthFolder;

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
}

/// One picture ready to be shown.
#[derive(Clone)]
pub struct Opened {
    /// Its pixels.
    pub picture: Arc<Picture>,
    /// A reduced copy for the screen.
    pub overview: Arc<Overview>,
}

impl Opened {
    /// A picture with its reduced copy.
    pub fn new(picture: Picture) -> Self {
        let overview = Arc::new(Overview::new(&picture));
        Self { picture: Arc::new(picture), overview }
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
}

/// The opening under way, if any.
pub struct Loader {
    waker: Waker,
    under_way: Option<Receiver<Result<Pair, String>>>,
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
        self.start(|| {
            let sample = sample_pair();
            let source = TruthSource::Sample(sample.truth.name.clone());
            Ok(Pair {
                pictures: sample.pictures.map(Opened::new),
                show_me: Some(sample.show_me),
                known: Some(Known { truth: Arc::new(sample.truth), source, folder: None }),
                // Who learns the program is not shown the answer before the question.
                uses_truth: false,
            })
        });
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
            let pictures = opened.try_into().map_err(|_| "two pictures are needed".to_owned())?;
            Ok(Pair { pictures, show_me: None, known: None, uses_truth: false })
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

    /// The end of the opening under way, once it is there.
    pub fn poll(&mut self) -> Option<Result<Pair, String>> {
        let result = match self.under_way.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Err("The images could not be opened.".to_owned()),
            Ok(result) => result,
        };
        self.under_way = None;
        Some(result)
    }

    fn start(&mut self, open: impl FnOnce() -> Result<Pair, String> + Send + 'static) {
        let (sender, receiver) = channel();
        let waker = self.waker.clone();
        let thread = std::thread::Builder::new().name("open".into()).spawn(move || {
            let result = catch_unwind(AssertUnwindSafe(open)).unwrap_or_else(|payload| {
                Err(format!("The image could not be opened: {}.", panic_text(payload.as_ref())))
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
fn failure(side: Side, error: &LoadError) -> String {
    format!("The {} image: {error}. Nothing was changed; check the file, or open another one.", side.name())
}

/// What happened with a folder and what to do.
fn unchanged(error: &str) -> String {
    format!("The folder could not be opened: {error}. Nothing was changed; correct it, or open another one.")
}

fn open_pair(folder: &Arc<TruthFolder>, pair: [usize; 2], open: &[Opened]) -> Result<Pair, String> {
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
    Ok(Pair { pictures, show_me: None, known: Some(known), uses_truth: true })
}
