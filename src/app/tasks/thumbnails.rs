//! Makes small pictures of the images of a folder, visible ones first.

use super::task::{Task, Waiting};
use super::waker::Waker;
use crate::app::model::picture::Overview;
use crate::app::model::thumbnails::{MadeThumbnail, SIDE, ThumbnailQuestion, Thumbnails};
use crate::image::Picture;
use crate::io::first_frame;
use std::sync::Arc;

/// The thread that makes the small pictures.
pub struct Thumbnailing {
    task: Task<ThumbnailQuestion, MadeThumbnail>,
    /// Views of the latest request.
    asked: Vec<usize>,
}

impl Thumbnailing {
    pub fn new(waker: Waker) -> Self {
        let task = Task::new("thumbnails", waker, Waiting::Newest, |question: ThumbnailQuestion, turn| {
            // Other views may be visible now. The current picture is finished anyway.
            turn.give_way();
            for view in question.views {
                if turn.cancel.is_cancelled() {
                    break;
                }
                let path = question.folder.image(view);
                let picture = if path.is_dir() { first_frame(path).ok() } else { Picture::open(path).ok() };
                let thumbnail = picture.map(|picture| Arc::new(Overview::within(&picture, SIDE)));
                turn.tell((Arc::clone(&question.folder), view, thumbnail));
            }
            None
        });
        Self { task, asked: Vec::new() }
    }

    pub fn take(&mut self, thumbnails: &mut Thumbnails) {
        while let Some((_, made)) = self.task.poll() {
            if let Ok(made) = made {
                thumbnails.take(made);
            }
        }
    }

    /// Requests missing pictures of visible views, unless they are being made.
    pub fn follow(&mut self, question: Option<ThumbnailQuestion>) {
        let Some(question) = question else { return };
        if question.views.iter().any(|view| !self.asked.contains(view)) || !self.task.is_busy() {
            self.asked.clone_from(&question.views);
            self.task.ask(question);
        }
    }

    /// Cancels the request, because another folder was opened.
    pub fn forget(&mut self) {
        self.task.forget();
        self.asked.clear();
    }

    pub fn is_busy(&self) -> bool {
        self.task.is_busy()
    }
}
