//! Files in the making, `.epiline-….part` beside what they will become.
//!
//! Whoever writes one holds a lock on it, which the system releases however the program ends: one that can be locked by
//! another belongs to a program that was killed, and is removed.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;

use tempfile::NamedTempFile;

const PREFIX: &str = ".epiline-";
const SUFFIX: &str = ".part";

/// A new file that removes itself unless it takes the place of another one.
#[derive(Debug)]
pub(super) struct PartFile(NamedTempFile);

impl PartFile {
    /// A file in that folder; `private` ones only its owner may read.
    pub(super) fn create(folder: &Path, private: bool) -> std::io::Result<Self> {
        const ATTEMPTS: usize = 20;
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Like any new file (the user's mask still applies), not the private mode of temporary ones.
            builder.permissions(std::fs::Permissions::from_mode(if private { 0o600 } else { 0o666 }));
        }
        for _ in 0..ATTEMPTS {
            let file = builder.tempfile_in(folder)?;
            // Where files cannot be locked nobody takes another's for dead either.
            let _ = file.as_file().lock();
            // Before the lock was there another program may have taken it for dead.
            if file.path().exists() {
                return Ok(Self(file));
            }
        }
        Err(std::io::Error::other("the folder is being cleaned by another program"))
    }

    /// Writes all of it, down to the disk.
    pub(super) fn fill(&mut self, content: &[u8]) -> std::io::Result<()> {
        self.0.write_all(content)?;
        self.0.as_file().sync_all()
    }

    /// Takes the place of `target`, and its permissions unless it is `private`.
    pub(super) fn persist(self, target: &Path, private: bool) -> std::io::Result<()> {
        if !private && let Ok(found) = target.metadata() {
            self.0.as_file().set_permissions(found.permissions())?;
        }
        self.0.persist(target)?;
        Ok(())
    }
}

/// Removes what programs that were killed left in a folder. What cannot be removed stays.
pub(super) fn remove_dead_parts(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_part = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        if is_part && entry.file_type().is_ok_and(|kind| kind.is_file()) && is_dead(&entry.path()) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

fn is_dead(path: &Path) -> bool {
    let open: std::io::Result<File> = OpenOptions::new().read(true).open(path);
    open.is_ok_and(|file| file.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_the_dead_are_removed_and_those_of_the_living_stay() {
        let folder = tempfile::tempdir().unwrap();
        let dead = folder.path().join(".epiline-dead.part");
        let other = folder.path().join(".epiline-other.txt");
        for path in [&dead, &other] {
            std::fs::write(path, "half").unwrap();
        }
        let mut alive = PartFile::create(folder.path(), false).unwrap();
        remove_dead_parts(folder.path());
        assert!(!dead.exists() && other.exists());
        alive.fill(b"whole").unwrap();
        alive.persist(&folder.path().join("result"), false).unwrap();
        assert_eq!(std::fs::read(folder.path().join("result")).unwrap(), b"whole");
    }
}
