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
    folder: PathBuf,
    path: PathBuf,
    /// Held locked.
    lock: File,
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
            // A copy may wait in any slot, but only one free slot is needed.
            if own.is_some() && !path_of(folder, slot).exists() {
                continue;
            }
            match take(folder, slot) {
                Some((path, lock)) if path.exists() => left_behind.push((path, lock)),
                Some(free) => own = Some(free),
                None => {}
            }
        }
        let (path, lock) = own?;
        left_behind.sort_by_key(|(path, _)| std::cmp::Reverse(modified(path)));
        Some(Self { folder: folder.to_owned(), path, lock, left_behind })
    }

    /// Leaves the copy of this window behind, to be offered again, and takes another slot; whether there was one.
    pub fn set_aside(&mut self) -> bool {
        let free = (0..SLOTS)
            .filter(|slot| !path_of(&self.folder, *slot).exists())
            .filter(|slot| path_of(&self.folder, *slot) != self.path)
            .find_map(|slot| take(&self.folder, slot));
        let Some((path, lock)) = free else { return false };
        let left = (std::mem::replace(&mut self.path, path), std::mem::replace(&mut self.lock, lock));
        self.left_behind.insert(0, left);
        true
    }

    /// Where this window keeps its copy.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The copies that were left behind, the newest first.
    pub fn left_behind(&self) -> impl Iterator<Item = &Path> {
        self.left_behind.iter().map(|(path, _)| path.as_path())
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

fn path_of(folder: &Path, slot: usize) -> PathBuf {
    folder.join(format!("unsaved-{slot}.json"))
}

/// The path of a slot and its lock, if nobody else has it.
fn take(folder: &Path, slot: usize) -> Option<(PathBuf, File)> {
    let lock = folder.join(format!("unsaved-{slot}.lock"));
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(lock).ok()?;
    file.try_lock().ok()?;
    Some((path_of(folder, slot), file))
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
        assert_eq!(second.left_behind().next(), None);
        let left = first.path().to_owned();
        drop(first);
        let mut third = Autosave::begin(folder.path()).unwrap();
        assert_eq!(third.left_behind().next(), Some(&*left));
        // While it is being offered nobody else offers it.
        assert_eq!(Autosave::begin(folder.path()).unwrap().left_behind().next(), None);
        third.remove(&left);
        assert!(!left.exists());
        assert_eq!(third.left_behind().next(), None);
    }

    #[test]
    fn a_copy_set_aside_is_offered_and_its_slot_is_not_used_again() {
        let folder = tempfile::tempdir().unwrap();
        let mut window = Autosave::begin(folder.path()).unwrap();
        let first = window.path().to_owned();
        std::fs::write(&first, "work").unwrap();
        assert!(window.set_aside());
        assert_ne!(window.path(), first);
        assert_eq!(window.left_behind().next(), Some(&*first));
        assert!(window.set_aside(), "again");
        assert_ne!(window.path(), first);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("file"), "").unwrap();
        assert!(Autosave::begin(&folder.path().join("file/deep")).is_none());
    }
}
