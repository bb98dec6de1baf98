//! Temporary files `.epiline-….part` beside their targets.
//!
//! The writer holds a lock, which the system releases when the program ends in any way. A temporary
//! file that can be locked belongs to a killed program and is removed.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;

use tempfile::NamedTempFile;

const PREFIX: &str = ".epiline-";
const SUFFIX: &str = ".part";

/// Temporary file that removes itself unless it replaces its target.
#[derive(Debug)]
pub(super) struct PartFile(NamedTempFile);

impl PartFile {
    /// Creates a file in `folder`; only its owner may read a `private` file.
    pub(super) fn create(folder: &Path, private: bool) -> std::io::Result<Self> {
        const ATTEMPTS: usize = 20;
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // The mode of any new file (subject to the umask), not the private mode of temporary
            // files.
            builder.permissions(std::fs::Permissions::from_mode(if private { 0o600 } else { 0o666 }));
        }
        for _ in 0..ATTEMPTS {
            let file = builder.tempfile_in(folder)?;
            // On file systems without locks, no file is ever considered dead.
            let _ = file.as_file().lock();
            // Another program may have removed the file before the lock was taken.
            if file.path().exists() {
                return Ok(Self(file));
            }
        }
        Err(std::io::Error::other("another program is cleaning the folder"))
    }

    /// Writes `content` and syncs it to the disk.
    pub(super) fn fill(&mut self, content: &[u8]) -> std::io::Result<()> {
        self.0.write_all(content)?;
        self.0.as_file().sync_all()
    }

    /// Copies `content`, and gives up the lock: elsewhere than on Linux it would keep out a database.
    #[cfg(feature = "colmap")]
    pub(super) fn copy(&mut self, content: &mut impl std::io::Read) -> std::io::Result<()> {
        std::io::copy(content, &mut self.0)?;
        self.0.as_file().unlock()
    }

    #[cfg(feature = "colmap")]
    pub(super) fn path(&self) -> &Path {
        self.0.path()
    }

    #[cfg(feature = "colmap")]
    pub(super) fn sync(&self) -> std::io::Result<()> {
        self.0.as_file().sync_all()
    }

    /// Replaces `target` and adopts its permissions, unless the file is `private`.
    pub(super) fn persist(self, target: &Path, private: bool) -> std::io::Result<()> {
        if !private && let Ok(found) = target.metadata() {
            self.0.as_file().set_permissions(found.permissions())?;
        }
        self.0.persist(target)?;
        Ok(())
    }
}

/// Removes temporary files of killed programs from a folder, as far as possible.
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
