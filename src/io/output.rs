//! Atomic output: files are written completely or not at all.
//!
//! The content goes to a temporary file in the same folder, which then replaces the target in one
//! step. A reader never sees a partial file, and a failure keeps the old file.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::part_file::{PartFile, remove_dead_parts};
use crate::foreign::{reason, shown_path};

/// Reason why a file cannot be written, one sentence.
#[derive(Debug, Error)]
#[error("cannot write {path}: {reason}")]
pub struct WriteError {
    path: String,
    reason: String,
}

impl WriteError {
    pub(super) fn new(path: &Path, reason: impl Into<String>) -> Self {
        Self { path: shown_path(path), reason: reason.into() }
    }
}

/// Destination that was found writable.
#[derive(Debug, Clone)]
pub struct OutputFile {
    path: PathBuf,
    /// Whether only the owner may read the file.
    private: bool,
}

/// Complete temporary file beside its target.
#[derive(Debug)]
pub(super) struct StagedFile {
    target: OutputFile,
    /// Temporary file with the whole content.
    pub(super) part: PartFile,
}

impl OutputFile {
    /// Checks that a file can be written, before a long computation. Leaves no file behind, and
    /// removes temporary files of killed programs from the folder.
    pub fn prepare(path: &Path) -> Result<Self, WriteError> {
        Self::prepare_as(path, false)
    }

    /// Prepares a file that only its owner may read, even if it replaces a public file.
    pub fn prepare_private(path: &Path) -> Result<Self, WriteError> {
        Self::prepare_as(path, true)
    }

    fn prepare_as(path: &Path, private: bool) -> Result<Self, WriteError> {
        let failed = |reason: &str| WriteError::new(path, reason);
        if path.as_os_str().is_empty() {
            return Err(failed("the file has no name"));
        }
        let found = path.metadata();
        if found.is_err() && path.symlink_metadata().is_ok_and(|link| link.is_symlink()) {
            return Err(failed("it is a link that leads nowhere"));
        }
        // The file behind a symbolic link is replaced, not the link.
        let path_behind = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        match found {
            Ok(found) if found.is_dir() => return Err(failed("it is a folder")),
            Ok(found) if !found.is_file() => {
                return Err(failed("it is a pipe or a device. Name a file, or - for standard output"));
            }
            Ok(found) if found.permissions().readonly() => return Err(failed("it is write-protected")),
            _ => {}
        }
        let output = Self { path: path_behind, private };
        let folder = folder_of(&output.path);
        match folder.metadata() {
            Ok(found) if !found.is_dir() => {
                return Err(failed(&format!("{} is not a folder", shown_path(folder))));
            }
            Ok(_) => {}
            Err(_) => return Err(failed(&format!("there is no folder {}", shown_path(folder)))),
        }
        remove_dead_parts(folder);
        PartFile::create(folder, private).map_err(|e| {
            failed(&format!("the folder {} is not writable ({})", shown_path(folder), reason(&e)))
        })?;
        Ok(output)
    }

    /// Returns the path, with symbolic links resolved.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the whole content. A replaced file keeps its permissions.
    pub fn write(&self, content: &[u8]) -> Result<(), WriteError> {
        self.stage(content)?.put()
    }

    /// Writes the whole content to a temporary file. The target is unchanged until
    /// [`StagedFile::put`].
    pub(super) fn stage(&self, content: &[u8]) -> Result<StagedFile, WriteError> {
        self.stage_by(|part| part.fill(content))
    }

    /// Copies a stream to a temporary file, which can be changed before [`StagedFile::put`].
    #[cfg(feature = "colmap")]
    pub(super) fn stage_from(&self, content: &mut impl std::io::Read) -> Result<StagedFile, WriteError> {
        self.stage_by(|part| part.copy(content))
    }

    fn stage_by(
        &self,
        fill: impl FnOnce(&mut PartFile) -> std::io::Result<()>,
    ) -> Result<StagedFile, WriteError> {
        let part = PartFile::create(folder_of(&self.path), self.private).and_then(|mut part| {
            fill(&mut part)?;
            Ok(part)
        });
        let part = part.map_err(|e| WriteError::new(&self.path, reason(&e)))?;
        Ok(StagedFile { target: self.clone(), part })
    }
}

/// Returns the folder of a file, `.` for a name alone.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

impl StagedFile {
    /// Replaces the target.
    pub(super) fn put(self) -> Result<(), WriteError> {
        let Self { target, part } = self;
        part.persist(&target.path, target.private).map_err(|e| WriteError::new(&target.path, reason(&e)))
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
    fn links_keep_pointing() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("target.json");
        let link = folder.path().join("link.json");
        std::fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        OutputFile::prepare(&link).unwrap().write(b"new").unwrap();
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(std::fs::read(&target).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_stay_and_private_files_are_private() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o777;
        let path = folder.path().join("result.json");
        for kept in [0o600, 0o640, 0o604] {
            std::fs::write(&path, "old").unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(kept)).unwrap();
            OutputFile::prepare(&path).unwrap().write(b"new").unwrap();
            assert_eq!((mode(&path), &std::fs::read(&path).unwrap()[..]), (kept, &b"new"[..]));
        }
        OutputFile::prepare_private(&path).unwrap().write(b"work").unwrap();
        assert_eq!(mode(&path), 0o600);
    }
}
