//! Making small pictures of the images of a folder, those in sight first.

use super::task::{Event, Task, Waiting};
use super::waker::Waker;
use crate::app::model::thumbnails::{MadeThumbnail, Thumbnail, ThumbnailQuestion, Thumbnails};
use crate::image::Picture;
use crate::io::first_frame;
use std::sync::Arc;

/// The thread that makes them.
pub struct Thumbnailing {
    task: Task<ThumbnailQuestion, MadeThumbnail>,
    /// The views that were asked for last.
    asked: Vec<usize>,
}

impl Thumbnailing {
    /// Starts the thread.
    pub fn new(waker: Waker) -> Self {
        let task = Task::new("thumbnails", waker, Waiting::Newest, |question: ThumbnailQuestion, turn| {
            // Others may have come into sight: the picture under way is finished all the same.
            turn.give_way();
            for view in question.views {
                if turn.cancel.is_cancelled() {
                    break;
                }
                let path = question.folder.image(view);
                let picture = if path.is_dir() { first_frame(path).ok() } else { Picture::open(path).ok() };
                let thumbnail = picture.map(|picture| Arc::new(Thumbnail::new(&picture)));
                turn.tell((Arc::clone(&question.folder), view, thumbnail));
            }
            None
        });
        Self { task, asked: Vec::new() }
    }

    /// Takes in what was made.
    pub fn take(&mut self, thumbnails: &mut Thumbnails) {
        while let Some((_, event)) = self.task.poll() {
            match event {
                Event::Told(made) | Event::Over(Ok(Some(made))) => thumbnails.take(made),
                Event::Over(_) => self.asked.clear(),
            }
        }
    }

    /// Asks for those in sight that are missing, unless they are being made.
    pub fn follow(&mut self, question: Option<ThumbnailQuestion>) {
        let Some(question) = question else { return };
        if question.views.iter().any(|view| !self.asked.contains(view)) || !self.task.is_busy() {
            self.asked.clone_from(&question.views);
            self.task.ask(question);
        }
    }

    /// Gives up what was asked: another folder is open.
    pub fn forget(&mut self) {
        self.task.forget();
        self.asked.clear();
    }

    /// Whether any are being made.
    pub fn is_busy(&self) -> bool {
        self.task.is_busy()
    }
}
