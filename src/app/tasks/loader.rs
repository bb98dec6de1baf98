//! Opens pictures outside the thread of the window.
//!
//! Decoding a large photograph can take more than a second. Each opening has its own thread. The
//! window ignores an opening that was overtaken by a newer one.

use std::path::PathBuf;
use std::sync::Arc;

use super::opening::{
    LoadedPair, OpeningFailure, PairReading, calibrated, open_folder, open_views, sample, sample_sequences,
};
use super::session_opening::open_session;
use super::task::{Event, Task, Waiting};
use super::waker::Waker;
use crate::app::model::pair_folder::PairFolder;
use crate::app::model::picture::Opened;
use crate::app::model::session::OpenSession;
use crate::camera::CameraModel;
use crate::cancel::CancelFlag;

/// Request to the loader.
#[derive(Clone)]
enum Wanted {
    Sample,
    SampleSequences,
    Files([PathBuf; 2]),
    Folder(PathBuf),
    Views(Arc<PairFolder>, [usize; 2]),
    Session(OpenSession),
    Calibrated(Box<([Opened; 2], [CameraModel; 2])>),
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
            Self::Calibrated(both) => {
                let (pictures, cameras) = *both;
                calibrated(pictures, &cameras)
                    .map(|pictures| LoadedPair { is_calibrated: true, ..LoadedPair::of(pictures) })
            }
        };
        found.map(|pair| LoadedPair { notes: reading.notes, ..pair })
    }
}

/// The running opening, if any.
pub struct Loader {
    waker: Waker,
    task: Option<Task<(Wanted, PairReading), Result<LoadedPair, OpeningFailure>>>,
    /// The pictures opened last.
    open: Vec<Opened>,
}

impl Loader {
    /// Creates an idle loader.
    pub fn new(waker: Waker) -> Self {
        Self { waker, task: None, open: Vec::new() }
    }

    /// Returns whether pictures are being opened.
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

    /// Opens a pair of a folder. Images that are already open are not read again.
    pub fn open_pair(&mut self, folder: Arc<PairFolder>, pair: [usize; 2]) {
        self.start(Wanted::Views(folder, pair));
    }

    /// Opens a session with its pictures.
    pub fn open_session(&mut self, session: OpenSession) {
        self.start(Wanted::Session(session));
    }

    /// Gives open pictures their calibrated cameras.
    pub fn calibrate(&mut self, pictures: [Opened; 2], cameras: &[CameraModel; 2]) {
        self.start(Wanted::Calibrated(Box::new((pictures, *cameras))));
    }

    /// Returns the result of the running opening, once it has ended.
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
            // A calibration belongs to this pair alone.
            self.open = pair.pictures.iter().cloned().map(Opened::without_calibration).collect();
        }
        Some(result)
    }

    fn start(&mut self, wanted: Wanted) {
        // The views of a folder are changed fast, so open images are reused. Files named by the
        // user are read again, as they may have changed.
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
