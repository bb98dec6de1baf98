//! Writes the rectified pair at full size, in its own thread.

use std::path::Path;

use super::task::{Task, Waiting};
use super::waker::Waker;
use crate::app::model::rectified::{RectifyOrder, WritingProgress};
use crate::camera::PicturesOf;
use crate::cancel::CancelFlag;
use crate::io::{RectifiedError, RectifiedFiles};
use crate::rectify::Limits;

/// Number of steps before the files: the maps and the two pictures.
const STEPS_BEFORE: usize = 3;

/// Final message of success or failure.
pub type WritingEnd = Result<String, String>;

enum WritingNews {
    Progress(WritingProgress),
    Ended(WritingEnd),
}

/// The writing thread. It writes one pair at a time.
pub struct Writing(Task<RectifyOrder, WritingNews>);

impl Writing {
    pub fn new(waker: Waker) -> Self {
        Self(Task::new("writing", waker, Waiting::Newest, |order: RectifyOrder, turn| {
            let report = |progress| turn.tell(WritingNews::Progress(progress));
            let end = order.write(&turn.cancel, &report);
            // A stop that was asked for is no failure.
            let is_stopped = turn.cancel.is_cancelled();
            Some(WritingNews::Ended(end.or_else(|text| if is_stopped { Ok(text) } else { Err(text) })))
        }))
    }

    /// Starts writing and returns the initial progress; `None` while another pair is being written.
    pub fn begin(&mut self, order: RectifyOrder) -> Option<WritingProgress> {
        if self.0.is_busy() {
            return None;
        }
        self.0.ask(order);
        Some(WritingProgress { done: 0, all: STEPS_BEFORE, what: "Rectifying" })
    }

    pub fn stop(&self) {
        self.0.stop();
    }

    pub fn is_busy(&self) -> bool {
        self.0.is_busy()
    }

    /// Updates the progress and returns the final message, once there is one.
    pub fn take(&mut self, progress: &mut Option<WritingProgress>) -> Option<WritingEnd> {
        let mut ended = None;
        while let Some((_, news)) = self.0.poll() {
            match news {
                Ok(WritingNews::Progress(now)) => *progress = Some(now),
                Ok(WritingNews::Ended(end)) => ended = Some(end),
                Err(panic) => {
                    ended = Some(Err(format!("The rectified pair could not be written: {panic}.")));
                }
            }
        }
        progress.take_if(|_| !self.0.is_busy());
        ended
    }
}

impl RectifyOrder {
    fn write(&self, cancel: &CancelFlag, report: &dyn Fn(WritingProgress)) -> WritingEnd {
        let place = self.folder.display();
        let failed = |error: &dyn std::fmt::Display| {
            format!("The rectified pair was not written: {error}. Correct it, or choose another folder.")
        };
        let stopped = || format!("Writing the rectified pair was stopped. Nothing was written to {place}.");
        // The folder is tried first, so that nobody waits for a folder that is not writable.
        let images: Vec<&Path> =
            self.question.pictures.iter().filter_map(|picture| picture.path.as_deref()).collect();
        let files = RectifiedFiles::prepare(&self.folder, self.options, &images).map_err(|e| failed(&e))?;
        let files = files.with_trust(self.trust.clone());
        let paths = files.paths();
        let all = STEPS_BEFORE + paths.len();
        let step = |done, what| report(WritingProgress { done, all, what });
        let rectification = self
            .question
            .rectification(&Limits::default())
            .map_err(|e| format!("The rectified pair was not written: {e}."))?;
        let (pictures, rectification) = self.question.sources(rectification);
        step(1, "Drawing the left picture");
        let left = rectification.warp(0, &pictures[0].pixels, cancel).ok_or_else(stopped)?;
        step(2, "Drawing the right picture");
        let right = rectification.warp(1, &pictures[1].pixels, cancel).ok_or_else(stopped)?;
        let originals = pictures.each_ref().map(|picture| &**picture);
        let views = self.question.bent.as_ref().map(|(_, views)| views);
        let pictures_of = PicturesOf::from(views);
        let geometry = (&self.question.fundamental, &pictures_of);
        let mut go_on = |file: usize| {
            step(STEPS_BEFORE + file, "Writing the files");
            !cancel.is_cancelled()
        };
        files.write(&rectification, geometry, originals, [&left, &right], &mut go_on).map_err(|error| {
            match error {
                RectifiedError::Cancelled => stopped(),
                error => failed(&error),
            }
        })?;
        let names = paths.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy());
        let names = names.collect::<Vec<_>>().join(", ");
        Ok(format!("The rectified pair is in {place}: {names}."))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::rectified::example;
    use crate::io::{PictureFormat, RectifiedOptions};

    fn order(folder: &Path) -> RectifyOrder {
        let options = RectifiedOptions { format: PictureFormat::Png, guide_spacing: 40, maps: true };
        RectifyOrder { question: example(), folder: folder.to_owned(), options, trust: None }
    }

    #[test]
    fn a_stop_leaves_no_files() {
        let folder = tempfile::tempdir().unwrap();
        let stopped = CancelFlag::default();
        stopped.cancel();
        let into = folder.path().join("empty");
        let text = order(&into).write(&stopped, &|_| {}).unwrap_err();
        assert!(text.contains("stopped"), "{text}");
        assert_eq!(std::fs::read_dir(&into).unwrap().count(), 0);
    }
}
