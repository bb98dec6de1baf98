//! The program's own copies of unsaved work, and finding those that a crash left behind.
//!
//! Each running window owns a slot of the folder, by a lock that the system releases however the program ends. A slot
//! that nobody holds but that has a copy in it belongs to a program that ended without saving.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

/// Windows that can keep copies at the same time.
const SLOTS: usize = 32;

/// A slot of the folder, held as long as this lives.
pub struct Autosave {
    path: PathBuf,
    /// Held locked.
    _lock: File,
    /// Copies that were left behind, with their locks, so that no other window offers them meanwhile.
    left_behind: Vec<(PathBuf, File)>,
}

impl Autosave {
    /// Takes a slot of the folder and finds what was left behind in others; `None` when the folder cannot be used,
    /// which is no reason not to work.
    pub fn begin(folder: &Path) -> Option<Self> {
        std::fs::create_dir_all(folder).ok()?;
        let mut own = None;
        let mut left_behind = Vec::new();
        for slot in 0..SLOTS {
            let path = folder.join(format!("unsaved-{slot}.json"));
            let lock = folder.join(format!("unsaved-{slot}.lock"));
            // A copy may wait in any slot, but only one free slot is needed.
            if own.is_some() && !path.exists() {
                continue;
            }
            let Ok(file) = OpenOptions::new().create(true).truncate(false).write(true).open(lock) else {
                continue;
            };
            if file.try_lock().is_err() {
                continue;
            }
            if path.exists() {
                left_behind.push((path, file));
            } else {
                own = Some((path, file));
            }
        }
        let (path, lock) = own?;
        left_behind.sort_by_key(|(path, _)| std::cmp::Reverse(modified(path)));
        Some(Self { path, _lock: lock, left_behind })
    }

    /// Where this window keeps its copy.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The newest copy that was left behind.
    pub fn newest_left_behind(&self) -> Option<&Path> {
        self.left_behind.first().map(|(path, _)| path.as_path())
    }

    /// The copy was taken over or is not wanted: removes it.
    pub fn remove(&mut self, path: &Path) {
        if let Some(at) = self.left_behind.iter().position(|(other, _)| other == path) {
            let (path, _lock) = self.left_behind.remove(at);
            // One that cannot be removed is offered again.
            let _ = std::fs::remove_file(path);
        }
    }
}

fn modified(path: &Path) -> Option<std::time::SystemTime> {
    path.metadata().and_then(|found| found.modified()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_window_has_its_own_slot_and_finds_what_others_left() {
        let folder = tempfile::tempdir().unwrap();
        let first = Autosave::begin(folder.path()).unwrap();
        std::fs::write(first.path(), "work").unwrap();
        // Its owner still runs: nobody else's business.
        let second = Autosave::begin(folder.path()).unwrap();
        assert_ne!(first.path(), second.path());
        assert_eq!(second.newest_left_behind(), None);
        let left = first.path().to_owned();
        drop(first);
        let mut third = Autosave::begin(folder.path()).unwrap();
        assert_eq!(third.newest_left_behind(), Some(&*left));
        // While it is being offered nobody else offers it.
        assert_eq!(Autosave::begin(folder.path()).unwrap().newest_left_behind(), None);
        third.remove(&left);
        assert!(!left.exists());
        assert_eq!(third.newest_left_behind(), None);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("file"), "").unwrap();
        assert!(Autosave::begin(&folder.path().join("file/deep")).is_none());
    }
}
