//! Output files that are either complete or not there.
//!
//! The content goes to a temporary file in the same folder, which then takes the place of the target in one
//! step. A reader never sees half a file, and a failure leaves an older file as it was.

use std::io::Write;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::read::reason;

/// Why a file could not be written, one sentence.
#[derive(Debug, Error)]
#[error("cannot write {path}: {reason}")]
pub struct WriteError {
    /// The file.
    path: String,
    /// Why.
    reason: String,
}

impl WriteError {
    pub(super) fn new(path: &Path, reason: impl Into<String>) -> Self {
        Self { path: path.display().to_string(), reason: reason.into() }
    }
}

/// A place for output that was found writable.
#[derive(Debug, Clone)]
pub struct OutputFile {
    path: PathBuf,
    /// Devices and pipes are written through: replacing them by a file would be a surprise.
    special: bool,
}

impl OutputFile {
    /// Checks, before a long computation, that the file can be written. Nothing is left behind.
    pub fn prepare(path: &Path) -> Result<Self, WriteError> {
        let failed = |reason: &str| WriteError::new(path, reason);
        if path.as_os_str().is_empty() {
            return Err(failed("the file has no name"));
        }
        // Behind a symbolic link it is the file it points to that is replaced, not the link.
        let path_behind = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let special = match path_behind.metadata() {
            Ok(found) if found.is_dir() => return Err(failed("it is a folder")),
            Ok(found) if found.permissions().readonly() => return Err(failed("it is write-protected")),
            Ok(found) => !found.is_file(),
            Err(_) => false,
        };
        let output = Self { path: path_behind, special };
        if !special {
            let folder = output.folder();
            match folder.metadata() {
                Ok(found) if !found.is_dir() => {
                    return Err(failed(&format!("{} is not a folder", folder.display())));
                }
                Ok(_) => {}
                Err(_) => return Err(failed(&format!("there is no folder {}", folder.display()))),
            }
            output.temporary().map_err(|e| {
                failed(&format!("the folder {} is not writable ({})", folder.display(), reason(&e)))
            })?;
        }
        Ok(output)
    }

    /// Where it will be, behind symbolic links.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the whole content at once.
    pub fn write(&self, content: &[u8]) -> Result<(), WriteError> {
        if self.special { self.write_through(content) } else { self.replace(content) }
            .map_err(|e| WriteError::new(&self.path, reason(&e)))
    }

    fn write_through(&self, content: &[u8]) -> std::io::Result<()> {
        let mut file = std::fs::OpenOptions::new().write(true).open(&self.path)?;
        file.write_all(content)?;
        file.flush()
    }

    fn replace(&self, content: &[u8]) -> std::io::Result<()> {
        let mut file = self.temporary()?;
        file.write_all(content)?;
        file.as_file().sync_all()?;
        file.persist(&self.path)?;
        Ok(())
    }

    fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// A new file beside the target that removes itself unless it takes the target's place.
    fn temporary(&self) -> std::io::Result<tempfile::NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".epiline-").suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Like any new file (the user's mask still applies), not the private mode of temporary ones.
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        builder.tempfile_in(self.folder())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn checking_leaves_nothing_and_writing_leaves_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        let output = OutputFile::prepare(&path).unwrap();
        assert!(names(folder.path()).is_empty());
        output.write(b"first").unwrap();
        output.write(b"second").unwrap();
        assert_eq!(names(folder.path()), ["result.json"]);
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
    }

    #[test]
    fn folders_missing_folders_and_files_as_folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "x").unwrap();
        for (path, expected) in [
            (folder.path().to_owned(), "it is a folder"),
            (folder.path().join("missing/result.json"), "there is no folder"),
            (file.join("result.json"), "is not a folder"),
            (PathBuf::new(), "has no name"),
        ] {
            let message = OutputFile::prepare(&path).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn a_failure_at_the_end_leaves_the_older_file_alone() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        std::fs::create_dir(&inner).unwrap();
        let output = OutputFile::prepare(&inner.join("result.json")).unwrap();
        std::fs::remove_dir(&inner).unwrap();
        let message = output.write(b"late").unwrap_err().to_string();
        assert!(message.starts_with("cannot write"), "{message}");
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn write_protected_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept.json");
        std::fs::write(&path, "kept").unwrap();
        let mut permissions = path.metadata().unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&path, permissions).unwrap();
        assert!(OutputFile::prepare(&path).unwrap_err().to_string().contains("write-protected"));
    }

    #[cfg(unix)]
    #[test]
    fn links_keep_pointing_and_devices_stay_devices() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("target.json");
        let link = folder.path().join("link.json");
        std::fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        OutputFile::prepare(&link).unwrap().write(b"new").unwrap();
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(std::fs::read(&target).unwrap(), b"new");

        OutputFile::prepare(Path::new("/dev/null")).unwrap().write(b"gone").unwrap();
        assert!(Path::new("/dev/null").metadata().unwrap().file_type().is_char_device());
    }
}
