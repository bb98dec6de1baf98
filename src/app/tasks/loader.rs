//! Opening off the window's thread.
//!
//! Decoding a large photograph takes a second or more. Each opening runs in a thread of its own; a newer
//! one makes the window forget the older.

use std::path::PathBuf;
use std::sync::Arc;

use super::opening::{
    LoadedPair, OpeningFailure, PairReading, open_folder, open_views, sample, sample_sequences,
};
use super::session_opening::open_session;
use super::task::{Event, Task, Waiting};
use super::waker::Waker;
use crate::app::model::pair_folder::PairFolder;
use crate::app::model::picture::Opened;
use crate::app::model::session::OpenSession;
use crate::cancel::CancelFlag;

/// What the loader is asked for.
#[derive(Clone)]
enum Wanted {
    Sample,
    SampleSequences,
    Files([PathBuf; 2]),
    Folder(PathBuf),
    Views(Arc<PairFolder>, [usize; 2]),
    Session(OpenSession),
}

impl Wanted {
    fn open(self, mut reading: PairReading) -> Result<LoadedPair, OpeningFailure> {
        let found = match self {
            Self::Sample => Ok(sample()),
            Self::SampleSequences => sample_sequences(&reading),
            Self::Files([left, right]) => reading.pair([&left, &right]).map(LoadedPair::of),
            Self::Folder(path) => open_folder(&path, &mut reading),
            Self::Views(folder, views) => open_views(&folder, views, &mut reading),
            Self::Session(session) => open_session(session, &mut reading),
        };
        found.map(|pair| LoadedPair { notes: reading.notes, ..pair })
    }
}

/// The opening under way, if any.
pub struct Loader {
    waker: Waker,
    task: Option<Task<(Wanted, PairReading), Result<LoadedPair, OpeningFailure>>>,
    /// The pictures that were opened last.
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
        self.start(Wanted::Sample);
    }

    /// Opens the built-in sequences.
    pub fn open_sample_sequences(&mut self) {
        self.start(Wanted::SampleSequences);
    }

    /// Opens two pictures, or two sequences.
    pub fn open(&mut self, both: [PathBuf; 2]) {
        self.start(Wanted::Files(both));
    }

    /// Opens the first pair of a folder.
    pub fn open_folder(&mut self, path: PathBuf) {
        self.start(Wanted::Folder(path));
    }

    /// Opens a pair of a folder; what of it is open already is not read again.
    pub fn open_pair(&mut self, folder: Arc<PairFolder>, pair: [usize; 2]) {
        self.start(Wanted::Views(folder, pair));
    }

    /// Opens a session with its pictures.
    pub fn open_session(&mut self, session: OpenSession) {
        self.start(Wanted::Session(session));
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

    fn start(&mut self, wanted: Wanted) {
        // What somebody names is read again, for it may have changed; the views of a folder follow each other fast.
        let open = if matches!(wanted, Wanted::Views(..)) { self.open.clone() } else { Vec::new() };
        // A newer opening does not wait for the older one.
        let mut task = Task::new(
            "open",
            self.waker.clone(),
            Waiting::Newest,
            |(wanted, mut reading): (Wanted, PairReading), turn| {
                reading.cancel = turn.cancel.clone();
                Some(wanted.open(reading))
            },
        );
        let cancel = CancelFlag::default();
        task.ask((wanted, PairReading { cancel, open, notes: Vec::new() }));
        self.task = Some(task);
    }
}
