//! The program's own copies of unsaved work, and copies left behind by a crash.
//!
//! Each running window owns a slot of the folder. The system releases the lock of a slot however
//! the program ends. A free slot with a copy belongs to a program that ended without saving.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::foreign::{reason, shown_path};

/// Maximum number of waiting copies. All of them are read and listed. The oldest are removed first.
const MOST_LEFT_BEHIND: usize = 16;
/// Number of slots: for the waiting copies, and for sixteen windows at the same time.
const SLOTS: usize = MOST_LEFT_BEHIND + 16;
/// Maximum age of waiting copies.
const LONGEST: Duration = Duration::from_hours(90 * 24);

/// A slot of the folder, held as long as this value lives.
pub struct Autosave {
    folder: PathBuf,
    path: PathBuf,
    lock: File,
    /// Copies left behind, newest first. Their locks keep other windows from offering them.
    left_behind: Vec<(PathBuf, File)>,
    /// Whether the last copy failed, and the user knows.
    pub is_failing: bool,
}

impl Autosave {
    /// Takes a slot of the folder and finds copies left behind. Removes old copies, so that slots
    /// remain free. The error says why the folder cannot be used; the program works without copies
    /// then.
    pub fn begin(folder: &Path) -> Result<Self, String> {
        let failed = |error: std::io::Error| format!("{}: {}", shown_path(folder), reason(&error));
        make_private(folder).map_err(failed)?;
        let mut left_behind: Vec<(PathBuf, File)> = (0..SLOTS)
            .filter(|slot| path_of(folder, *slot).exists())
            .filter_map(|slot| take(folder, slot).ok().flatten())
            .filter(|(path, _)| path.exists())
            .collect();
        left_behind.sort_by_key(|(path, _)| std::cmp::Reverse(modified(path)));
        let left_behind = pruned(left_behind, SystemTime::now());
        let (path, lock) = free_slot(folder).map_err(failed)?;
        Ok(Self { folder: folder.to_owned(), path, lock, left_behind, is_failing: false })
    }

    /// Leaves the copy of this window behind and takes another slot. Returns whether a slot was
    /// free.
    pub fn set_aside(&mut self) -> bool {
        let Ok((path, lock)) = free_slot(&self.folder) else { return false };
        let left = (std::mem::replace(&mut self.path, path), std::mem::replace(&mut self.lock, lock));
        self.left_behind.insert(0, left);
        self.left_behind = pruned(std::mem::take(&mut self.left_behind), SystemTime::now());
        true
    }

    /// Returns the path for the copy of this window.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the copies left behind, newest first.
    pub fn left_behind(&self) -> impl Iterator<Item = &Path> {
        self.left_behind.iter().map(|(path, _)| path.as_path())
    }

    /// Removes a copy that was restored or discarded.
    pub fn remove(&mut self, path: &Path) {
        if let Some(at) = self.left_behind.iter().position(|(other, _)| other == path) {
            let (path, _lock) = self.left_behind.remove(at);
            // A copy that cannot be removed is offered again.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Removes copies beyond the maximum number and age, and returns the others.
fn pruned(copies: Vec<(PathBuf, File)>, now: SystemTime) -> Vec<(PathBuf, File)> {
    let is_old = |path: &Path| {
        let age = modified(path).and_then(|then| now.duration_since(then).ok());
        age.is_some_and(|age| age > LONGEST)
    };
    let mut kept = Vec::new();
    for (path, lock) in copies {
        // A copy that cannot be removed is kept.
        if (kept.len() < MOST_LEFT_BEHIND && !is_old(&path)) || std::fs::remove_file(&path).is_err() {
            kept.push((path, lock));
        }
    }
    kept
}

fn path_of(folder: &Path, slot: usize) -> PathBuf {
    folder.join(format!("unsaved-{slot}.json"))
}

/// Returns a slot without owner and without a copy.
fn free_slot(folder: &Path) -> std::io::Result<(PathBuf, File)> {
    for slot in (0..SLOTS).filter(|slot| !path_of(folder, *slot).exists()) {
        if let Some(free) = take(folder, slot)? {
            return Ok(free);
        }
    }
    Err(std::io::Error::other(format!("all {SLOTS} places for copies are taken")))
}

/// Locks a slot and returns its path and lock; `None` if another window holds it.
fn take(folder: &Path, slot: usize) -> std::io::Result<Option<(PathBuf, File)>> {
    let lock = folder.join(format!("unsaved-{slot}.lock"));
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(lock)?;
    match file.try_lock() {
        Ok(()) => Ok(Some((path_of(folder, slot), file))),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Creates the folder, readable by its owner only.
fn make_private(folder: &Path) -> std::io::Result<()> {
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::DirBuilderExt;
        builder.mode(0o700);
    }
    builder.create(folder)
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().and_then(|found| found.modified()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_window_has_its_own_slot_and_finds_copies_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let first = Autosave::begin(folder.path()).unwrap();
        std::fs::write(first.path(), "work").unwrap();
        // The owner of this copy still runs.
        let second = Autosave::begin(folder.path()).unwrap();
        assert_ne!(first.path(), second.path());
        assert_eq!(second.left_behind().next(), None);
        let left = first.path().to_owned();
        drop(first);
        let mut third = Autosave::begin(folder.path()).unwrap();
        assert_eq!(third.left_behind().next(), Some(&*left));
        // A copy that is being offered is not offered by another window.
        assert_eq!(Autosave::begin(folder.path()).unwrap().left_behind().next(), None);
        third.remove(&left);
        assert!(!left.exists());
        assert_eq!(third.left_behind().next(), None);
    }

    #[test]
    fn an_unusable_folder_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("file"), "").unwrap();
        let problem = Autosave::begin(&folder.path().join("file/deep")).err().unwrap();
        assert!(problem.contains("file/deep: it is not a folder"), "{problem}");
    }

    #[test]
    fn there_is_always_room_for_one_more_copy() {
        let folder = tempfile::tempdir().unwrap();
        for slot in 0..SLOTS {
            std::fs::write(path_of(folder.path(), slot), format!("work {slot}")).unwrap();
        }
        let mut window = Autosave::begin(folder.path()).unwrap();
        assert_eq!(window.left_behind().count(), MOST_LEFT_BEHIND);
        for _ in 0..100 {
            std::fs::write(window.path(), "more").unwrap();
            assert!(window.set_aside());
        }
        assert_eq!(window.left_behind().count(), MOST_LEFT_BEHIND);
        assert_eq!(std::fs::read(window.left_behind().next().unwrap()).unwrap(), b"more");
        let files = std::fs::read_dir(folder.path())
            .unwrap()
            .flatten()
            .filter(|entry| entry.path().extension().is_some_and(|extension| extension == "json"));
        assert_eq!(files.count(), MOST_LEFT_BEHIND);
    }

    #[test]
    fn old_copies_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        for slot in [0, 1] {
            std::fs::write(path_of(folder.path(), slot), "work").unwrap();
        }
        let old = File::options().write(true).open(path_of(folder.path(), 0)).unwrap();
        old.set_modified(SystemTime::now() - 2 * LONGEST).unwrap();
        let window = Autosave::begin(folder.path()).unwrap();
        let left: Vec<_> = window.left_behind().collect();
        assert_eq!(left, [path_of(folder.path(), 1)]);
    }
}
