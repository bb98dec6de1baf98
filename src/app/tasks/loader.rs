//! Opens pictures outside the thread of the window.
//!
//! Decoding a large photograph can take more than a second. Each opening has its own thread. The
//! window ignores an opening that was overtaken by a newer one.

use std::sync::Arc;

use super::opening::{
    LoadedPair, Opening, OpeningFailure, PairReading, calibrated, open_files, open_folder, open_views,
    sample, sample_sequences,
};
use super::session_opening::open_session;
use super::task::{Task, Waiting};
use super::waker::Waker;
use crate::app::model::history::LensChange;
use crate::app::model::picture::Opened;
use crate::camera::CameraModel;
use crate::cancel::CancelFlag;
use crate::io::PictureFolder;
use crate::presentation::camera_doubts;

#[derive(Clone)]
pub enum Wanted {
    /// Something that the user, or the command line, names.
    Opening(Opening),
    /// Two views of a folder, with the cameras of the work on them. Images that are already open are not read again.
    Views(Arc<PictureFolder>, [usize; 2], Option<Box<[CameraModel; 2]>>),
    /// Open pictures, with their calibrated cameras.
    Calibrated(Box<([Opened; 2], LensChange)>),
}

impl Wanted {
    fn open(self, mut reading: PairReading) -> Result<LoadedPair, OpeningFailure> {
        let found = match self {
            Self::Opening(Opening::Sample(which)) => Ok(sample(which)),
            Self::Opening(Opening::SampleSequences) => sample_sequences(&reading),
            Self::Opening(Opening::Files(left, right)) => open_files([&left, &right], &mut reading),
            Self::Opening(Opening::Folder(path)) => open_folder(&path, &mut reading),
            Self::Opening(Opening::Session(session)) => open_session(session, &mut reading),
            Self::Views(folder, views, cameras) => {
                let pair = open_views(&folder, views, &mut reading)?;
                Ok(LoadedPair { pictures: calibrated(pair.pictures, cameras.as_deref())?, ..pair })
            }
            Self::Calibrated(both) => {
                let (pictures, change) = *both;
                if let Some(cameras) = &change.cameras {
                    let frames = pictures.each_ref().map(|opened| opened.shown().frame());
                    let doubts = camera_doubts([0, 1].map(|k| (&cameras[k], frames[k])));
                    reading.notes.extend(doubts.into_iter().map(|(_, message)| message));
                }
                let pictures = calibrated(pictures, change.cameras.as_ref());
                pictures.map(|pictures| LoadedPair { lens: Some(change), ..LoadedPair::of(pictures) })
            }
        };
        found.map(|pair| LoadedPair { notes: reading.notes, ..pair })
    }
}

pub struct Loader {
    waker: Waker,
    task: Option<Task<(Wanted, PairReading), Result<LoadedPair, OpeningFailure>>>,
    /// The pictures opened last.
    open: Vec<Opened>,
}

impl Loader {
    pub fn new(waker: Waker) -> Self {
        Self { waker, task: None, open: Vec::new() }
    }

    pub fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Returns the result of the running opening, once it has ended.
    pub fn poll(&mut self) -> Option<Result<LoadedPair, OpeningFailure>> {
        let (_, result) = self.task.as_mut()?.poll()?;
        self.task = None;
        let failed = |panic| OpeningFailure::Text(format!("The images could not be opened: {panic}."));
        let result = result.map_err(failed).flatten();
        if let Ok(pair) = &result {
            // A calibration belongs to this pair alone.
            self.open = pair.pictures.iter().cloned().map(Opened::without_calibration).collect();
        }
        Some(result)
    }

    pub fn open(&mut self, wanted: Wanted) {
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
