//! Copies of unsaved work that wait to be restored.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::command::SessionCommand;
use super::document::counted;
use super::messages::MessageAction;
use super::session::{OpenSession, SessionOwner, Work};
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
        let (pairs, pins) = copy.content.counts();
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
        let age = self.changed.and_then(|changed| changed.elapsed().ok());
        age.map_or_else(|| self.text.clone(), |age| format!("{} Last changed {}.", self.text, ago(age)))
    }

    /// Returns the buttons that restore and delete the work.
    pub fn actions(&self) -> Vec<MessageAction> {
        let session = OpenSession { owner: SessionOwner::Autosave, ..OpenSession::from(self.path.clone()) };
        let delete = SessionCommand::DiscardLeftBehind(self.path.clone());
        vec![
            MessageAction { label: "Restore", command: SessionCommand::Open(session).into() },
            MessageAction { label: "Delete it", command: delete.into() },
        ]
    }
}

/// Describes a time in the past.
fn ago(age: Duration) -> String {
    let minutes = age.as_secs() / 60;
    let (count, unit) = match minutes {
        0 => return "less than a minute ago".to_owned(),
        1..60 => (minutes, "minute"),
        60..1440 => (minutes / 60, "hour"),
        _ => (minutes / 1440, "day"),
    };
    format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_told_in_the_largest_unit_and_grow() {
        let minutes = |count: u64| Duration::from_secs(60 * count);
        for (count, words) in [
            (0, "less than a minute ago"),
            (1, "1 minute ago"),
            (59, "59 minutes ago"),
            (60, "1 hour ago"),
            (47 * 60, "1 day ago"),
            (72 * 60, "3 days ago"),
        ] {
            assert_eq!(ago(minutes(count)), words);
        }
    }
}
