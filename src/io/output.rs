//! Atomic output: files are written completely or not at all.
//!
//! The content goes to a temporary file in the same folder, which then replaces the target in one
//! step. A reader never sees a partial file, and a failure keeps the old file.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use thiserror::Error;

use super::part_file::{PartFile, remove_dead_parts};
use crate::foreign::{is_named_pipe, reason, shown_path};

/// Longest time without progress on a pipe.
const PATIENCE: Duration = Duration::from_secs(30);

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
    kind: DestinationKind,
}

#[derive(Debug, Clone)]
enum DestinationKind {
    /// Regular file, replaced as a whole. Only its owner may read a private file.
    File { private: bool },
    /// Device, written in place. Replacing a device by a file would be a surprise.
    Device,
    /// Pipe with a reader. It is kept open, or the reader would see its end.
    Pipe(Arc<File>),
}

/// Complete temporary file beside its target.
#[derive(Debug)]
pub(super) struct StagedFile {
    target: OutputFile,
    /// Temporary file; `None` if the content went directly to a device or a pipe.
    part: Option<PartFile>,
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
        let kind = match found {
            Ok(found) if found.is_dir() => return Err(failed("it is a folder")),
            Ok(found) if found.permissions().readonly() => return Err(failed("it is write-protected")),
            Ok(found) if found.is_file() => DestinationKind::File { private },
            Ok(_) if is_named_pipe(path) => {
                let pipe = open_pipe(path).map_err(|e| match e.kind() {
                    ErrorKind::PermissionDenied => failed(&reason(&e)),
                    _ => failed("nobody reads from this pipe"),
                })?;
                DestinationKind::Pipe(Arc::new(pipe))
            }
            Ok(found) if is_block_device(&found) => return Err(failed("it is a disk")),
            Ok(_) => DestinationKind::Device,
            Err(_) => DestinationKind::File { private },
        };
        let is_file = matches!(kind, DestinationKind::File { .. });
        let output = Self { path: path_behind, kind };
        if is_file {
            let folder = output.folder();
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
        }
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
        let part = match &self.kind {
            DestinationKind::File { private } => {
                PartFile::create(self.folder(), *private).and_then(|mut part| {
                    part.fill(content)?;
                    Ok(Some(part))
                })
            }
            DestinationKind::Device => self.write_through(content).map(|()| None),
            DestinationKind::Pipe(pipe) => write_to_pipe(pipe, content).map(|()| None),
        };
        let part = part.map_err(|e| WriteError::new(&self.path, reason(&e)))?;
        Ok(StagedFile { target: self.clone(), part })
    }

    fn write_through(&self, content: &[u8]) -> std::io::Result<()> {
        let mut file = std::fs::OpenOptions::new().write(true).open(&self.path)?;
        file.write_all(content)?;
        file.flush()
    }

    fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }
}

impl StagedFile {
    /// Replaces the target.
    pub(super) fn put(self) -> Result<(), WriteError> {
        let Some(part) = self.part else { return Ok(()) };
        let private = matches!(self.target.kind, DestinationKind::File { private: true });
        part.persist(&self.target.path, private).map_err(|e| WriteError::new(&self.target.path, reason(&e)))
    }
}

/// Opens a pipe for writing. Fails without a reader.
#[cfg(unix)]
fn open_pipe(path: &Path) -> std::io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    std::fs::OpenOptions::new().write(true).custom_flags(libc::O_NONBLOCK).open(path)
}

#[cfg(not(unix))]
fn open_pipe(path: &Path) -> std::io::Result<File> {
    std::fs::OpenOptions::new().write(true).open(path)
}

/// Writes at the reader's pace, and fails when the reader stops.
fn write_to_pipe(mut pipe: &File, content: &[u8]) -> std::io::Result<()> {
    let mut rest = content;
    let mut moved = Instant::now();
    while !rest.is_empty() {
        match pipe.write(rest) {
            Ok(count) => {
                rest = &rest[count..];
                moved = Instant::now();
            }
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(e) if e.kind() == ErrorKind::WouldBlock && moved.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(5));
            }
            Err(e) if e.kind() == ErrorKind::WouldBlock => {
                return Err(std::io::Error::other("nobody reads from this pipe any longer"));
            }
            Err(e) => return Err(e),
        }
    }
    Ok(())
}

#[cfg(unix)]
fn is_block_device(found: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_block_device()
}

#[cfg(not(unix))]
fn is_block_device(_found: &std::fs::Metadata) -> bool {
    false
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

    #[cfg(unix)]
    #[test]
    fn links_into_nothing_and_pipes_without_a_reader_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for (name, target) in [("dangling", "nothing"), ("circle", "circle")] {
            let link = folder.path().join(name);
            std::os::unix::fs::symlink(target, &link).unwrap();
            let message = OutputFile::prepare(&link).unwrap_err().to_string();
            assert!(message.ends_with("it is a link that leads nowhere"), "{message}");
        }
        assert_eq!(names(folder.path()), ["circle", "dangling"]);
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let message = OutputFile::prepare(&pipe).unwrap_err().to_string();
        assert!(message.ends_with("nobody reads from this pipe"), "{message}");
        // A reader gets everything, more than a pipe buffers.
        let copy = folder.path().join("copy");
        let mut reader = std::process::Command::new("cat")
            .arg(&pipe)
            .stdout(File::create(&copy).unwrap())
            .spawn()
            .unwrap();
        let content = vec![b'x'; 1 << 20];
        let output = (0..500).find_map(|_| {
            std::thread::sleep(Duration::from_millis(10));
            OutputFile::prepare(&pipe).ok()
        });
        output.unwrap().write(&content).unwrap();
        assert!(reader.wait().unwrap().success());
        assert_eq!(std::fs::read(&copy).unwrap(), content);
    }
}
