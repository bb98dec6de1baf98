//! Writing the rectified pair at full size, in a thread of its own.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::Question;
use crate::app::waker::Waker;
use crate::app::worker::panic_text;
use crate::cancel::CancelFlag;
use crate::io::{RectifiedError, RectifiedFiles, RectifiedOptions};
use crate::rectify::Limits;

/// Steps before the files: the maps, and the two pictures.
const STEPS_BEFORE: usize = 3;

/// What is to be written, and where.
#[derive(Clone)]
pub struct Order {
    /// The pair and its geometry.
    pub question: Question,
    /// The folder; made if missing.
    pub folder: PathBuf,
    /// What is written beside the pictures.
    pub options: RectifiedOptions,
}

/// How far it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Steps that are done.
    pub done: usize,
    /// All steps.
    pub all: usize,
    /// What is being done.
    pub what: &'static str,
}

/// How it ended: what to tell the user, be it good or bad.
pub type Ending = Result<String, String>;

enum News {
    Progress(Progress),
    Ended(Ending),
}

struct UnderWay {
    news: Receiver<News>,
    cancel: CancelFlag,
    progress: Progress,
}

/// What is being written, one pair at a time.
pub struct Writing {
    waker: Waker,
    under_way: Option<UnderWay>,
}

impl Writing {
    /// Nothing under way.
    pub fn new(waker: Waker) -> Self {
        Self { waker, under_way: None }
    }

    /// Begins, unless another pair is being written; says whether it has begun.
    pub fn begin(&mut self, order: Order) -> bool {
        if self.under_way.is_some() {
            return false;
        }
        let (sender, news) = channel();
        let cancel = CancelFlag::default();
        let (flag, waker) = (cancel.clone(), self.waker.clone());
        let thread = std::thread::Builder::new().name("writing".into()).spawn(move || {
            let report = |step: News| {
                // Nobody listens any more when the window has closed.
                let _ = sender.send(step);
                waker.wake();
            };
            let written = catch_unwind(AssertUnwindSafe(|| order.write(&flag, &report)));
            let ending = written.unwrap_or_else(|payload| {
                Err(format!("The rectified pair could not be written: {}.", panic_text(payload.as_ref())))
            });
            report(News::Ended(ending));
        });
        // Without a thread the sender is gone, which `poll` reports.
        drop(thread);
        let progress = Progress { done: 0, all: STEPS_BEFORE, what: "Rectifying" };
        self.under_way = Some(UnderWay { news, cancel, progress });
        true
    }

    /// Asks it to stop.
    pub fn stop(&self) {
        if let Some(under_way) = &self.under_way {
            under_way.cancel.cancel();
        }
    }

    /// How far it is, while it goes on.
    pub fn progress(&self) -> Option<Progress> {
        self.under_way.as_ref().map(|under_way| under_way.progress)
    }

    /// Takes in news; how it ended, when it has.
    pub fn poll(&mut self) -> Option<Ending> {
        let under_way = self.under_way.as_mut()?;
        let ending = loop {
            match under_way.news.try_recv() {
                Ok(News::Progress(progress)) => under_way.progress = progress,
                Ok(News::Ended(ending)) => break ending,
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    break Err("The rectified pair could not be written: there is no thread for it.".into());
                }
            }
        };
        self.under_way = None;
        Some(ending)
    }
}

impl Order {
    /// Rectifies, draws and writes.
    fn write(&self, cancel: &CancelFlag, report: &dyn Fn(News)) -> Ending {
        let place = self.folder.display();
        let failed = |error: &dyn std::fmt::Display| {
            format!("The rectified pair was not written: {error}. Correct it, or choose another folder.")
        };
        let stopped = || format!("Writing the rectified pair was stopped. Nothing was written to {place}.");
        // Before the work, so that nobody waits for a folder that cannot be written.
        let images: Vec<&Path> =
            self.question.pictures.iter().filter_map(|picture| picture.path.as_deref()).collect();
        let files = RectifiedFiles::prepare(&self.folder, self.options, &images).map_err(|e| failed(&e))?;
        let paths = files.paths();
        let all = STEPS_BEFORE + paths.len();
        let step = |done, what| report(News::Progress(Progress { done, all, what }));
        let rectification = self
            .question
            .rectification(&Limits::default())
            .map_err(|e| format!("The rectified pair was not written: {e}."))?;
        let pictures = &self.question.pictures;
        step(1, "Drawing the left picture");
        let left = rectification.warp(0, &pictures[0].pixels, cancel).ok_or_else(stopped)?;
        step(2, "Drawing the right picture");
        let right = rectification.warp(1, &pictures[1].pixels, cancel).ok_or_else(stopped)?;
        let originals = pictures.each_ref().map(AsRef::as_ref);
        let mut go_on = |file: usize| {
            step(STEPS_BEFORE + file, "Writing the files");
            !cancel.is_cancelled()
        };
        files
            .write(&rectification, &self.question.fundamental, originals, [&left, &right], &mut go_on)
            .map_err(|error| match error {
                RectifiedError::Cancelled => {
                    format!("Writing the rectified pair was stopped. What was written before is in {place}.")
                }
                error => failed(&error),
            })?;
        let names = paths.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy());
        let names = names.collect::<Vec<_>>().join(", ");
        Ok(format!("The rectified pair is in {place}: {names}."))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::rectified::Matches;
    use crate::app::sample::sample_pair;
    use crate::io::PictureFormat;
    use crate::rectify::Method;
    use std::path::Path;
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    fn order(folder: &Path) -> Order {
        let sample = sample_pair();
        Order {
            question: Question {
                pictures: sample.pictures.map(Arc::new),
                fundamental: sample.truth.fundamental,
                matches: Matches::True(Arc::new(sample.truth)),
                method: Method::Auto,
                moving: false,
            },
            folder: folder.to_owned(),
            options: RectifiedOptions { format: PictureFormat::Png, guide_spacing: 40, maps: true },
        }
    }

    fn wait(writing: &mut Writing) -> Ending {
        let start = Instant::now();
        loop {
            if let Some(ending) = writing.poll() {
                return ending;
            }
            assert!(start.elapsed() < Duration::from_mins(1), "it does not end");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn everything_is_written_at_full_size_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let into = folder.path().join("new/pair");
        let mut writing = Writing::new(Waker::default());
        assert!(writing.begin(order(&into)));
        assert!(!writing.begin(order(&into)), "one at a time");
        assert!(writing.progress().is_some());
        let text = wait(&mut writing).unwrap();
        assert!(writing.progress().is_none());
        for name in
            ["left.png", "right.png", "stacked.png", "left-map.npy", "right-map.npy", "rectification.json"]
        {
            assert!(into.join(name).is_file() && text.contains(name), "{name} in {text}");
        }
        let full = order(&into).question.rectification(&Limits::default()).unwrap();
        let (width, height) = image::image_dimensions(into.join("left.png")).unwrap();
        assert_eq!([width as usize, height as usize], [full.size.width, full.size.height]);
    }

    #[test]
    fn a_folder_that_is_a_file_is_a_sentence_and_a_stop_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "in the way").unwrap();
        let mut writing = Writing::new(Waker::default());
        writing.begin(order(&file));
        let text = wait(&mut writing).unwrap_err();
        assert!(text.contains("there is a file of that name") && text.ends_with("another folder."), "{text}");

        let stopped = CancelFlag::default();
        stopped.cancel();
        let into = folder.path().join("empty");
        let text = order(&into).write(&stopped, &|_| {}).unwrap_err();
        assert!(text.contains("stopped"), "{text}");
        assert_eq!(std::fs::read_dir(&into).unwrap().count(), 0);
    }
}
