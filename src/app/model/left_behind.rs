//! Copies of unsaved work that wait to be restored.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::command::SessionCommand;
use super::document::counted;
use super::messages::{MessageAction, dated};
use super::session::{OpenSession, Work};
use crate::io::SessionFile;

/// A copy of unsaved work.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftBehind {
    path: PathBuf,
    /// The work and its images, in one sentence.
    pub text: String,
    pub changed: Option<SystemTime>,
}

impl LeftBehind {
    /// Reads a copy. One that cannot be read, perhaps of a newer version, waits.
    pub fn read(path: &Path) -> Option<Self> {
        let copy = SessionFile::<Work>::read(path).ok()?;
        let (pairs, pins) = (copy.content.count_points(), copy.content.count_pins());
        let lines =
            if pins == 1 { "1 pinned line pair".to_owned() } else { format!("{pins} pinned line pairs") };
        let what = match (pairs, pins) {
            (0, 0) => "Work".to_owned(),
            (0, _) => lines,
            (_, 0) => counted(pairs),
            (_, _) => format!("{} and {lines}", counted(pairs)),
        };
        let were = if pairs + pins < 2 { "was" } else { "were" };
        let [left, right] = &copy.images;
        let images = if left.is_sample() {
            format!("the sample {}", left.name())
        } else {
            format!("{} and {}", left.name(), right.name())
        };
        let changed = path.metadata().and_then(|file| file.modified()).ok();
        Some(Self { path: path.to_owned(), text: format!("{what} on {images} {were} not saved."), changed })
    }

    /// Returns the sentence with the age of the work.
    pub fn told(&self) -> String {
        dated(&self.text, self.changed)
    }

    /// Returns the buttons that restore and delete the work.
    pub fn actions(&self) -> Vec<MessageAction> {
        let session = OpenSession { recovers: true, ..OpenSession::from(self.path.clone()) };
        let delete = SessionCommand::DiscardLeftBehind(self.path.clone());
        vec![
            MessageAction { label: "Restore", command: SessionCommand::Open(session).into() },
            MessageAction { label: "Delete it", command: delete.into() },
        ]
    }
}
