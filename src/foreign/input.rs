//! Opening an input file, whatever its path leads to.

use std::fs::{File, Metadata};
use std::io::ErrorKind;
use std::path::Path;

/// A file opened for reading.
#[derive(Debug)]
pub struct Input {
    /// Open handle, positioned at the start.
    pub file: File,
    /// Size in bytes; `None` for piped data, which has no size and cannot be read twice.
    pub size: Option<u64>,
}

/// Opens a regular file, or data piped into the program (`/dev/stdin`, `/dev/fd/N`).
///
/// # Errors
/// A clause for the user. Named pipes and devices are refused, because reading them could block
/// forever.
pub fn open_input(path: &Path) -> Result<Input, String> {
    let found = path.metadata().map_err(|e| why_not(path, &e))?;
    let size = if found.is_file() {
        Some(found.len())
    } else if found.is_dir() {
        return Err("it is a folder, not a file".into());
    } else if !is_pipe(&found) {
        return Err("it is a device, not a file or piped data".into());
    } else if is_piped_into_us(path) {
        None
    } else {
        // Another program may never open the other end.
        let sentence = "it is a named pipe, which may never end. Pipe the data into the program, with /dev/stdin as the \
                        name";
        return Err(sentence.into());
    };
    let file = File::open(path).map_err(|e| why_not(path, &e))?;
    Ok(Input { file, size })
}

/// Returns why nothing can be read at a path.
fn why_not(path: &Path, error: &std::io::Error) -> String {
    let is_link = path.symlink_metadata().is_ok_and(|found| found.is_symlink());
    match error.kind() {
        ErrorKind::PermissionDenied => reason(error),
        _ if is_link => "it is a link that leads nowhere".into(),
        ErrorKind::NotFound => "there is no such file".into(),
        _ => reason(error),
    }
}

/// Returns the system's reason in plain words, without its error number.
pub fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file or folder".into(),
        ErrorKind::PermissionDenied => "permission was denied".into(),
        ErrorKind::NotADirectory => "it is not a folder".into(),
        ErrorKind::IsADirectory => "it is a folder, not a file".into(),
        ErrorKind::StorageFull => "there is no space left".into(),
        ErrorKind::QuotaExceeded => "the disk quota of this user is used up".into(),
        ErrorKind::FileTooLarge => "the file would be larger than is allowed".into(),
        ErrorKind::ReadOnlyFilesystem => "the disk is write-protected".into(),
        ErrorKind::InvalidFilename => "the name is too long or has characters that are not allowed".into(),
        ErrorKind::BrokenPipe => "the program that reads it has ended".into(),
        ErrorKind::OutOfMemory => "there is not enough memory".into(),
        _ => {
            let text = error.to_string();
            // Anything behind the number is a path internal to the program.
            let words = text.split(" (os error").next().unwrap_or(&text);
            let mut characters = words.chars();
            let first = characters.next().map(|c| c.to_ascii_lowercase());
            super::escaped(&first.into_iter().chain(characters).collect::<String>())
        }
    }
}

/// Returns whether a pipe is one that the shell made for this program: it has no path in the file
/// system.
fn is_piped_into_us(path: &Path) -> bool {
    match path.canonicalize() {
        Ok(real) => ["/dev/fd", "/proc"].iter().any(|folder| real.starts_with(folder)),
        Err(_) => true,
    }
}

#[cfg(unix)]
fn is_pipe(found: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_pipe(_found: &Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(path: &Path) -> String {
        open_input(path).unwrap_err()
    }

    #[test]
    fn files_open_and_folders_and_nothing_do_not() {
        let folder = std::env::temp_dir();
        assert!(refused(&folder).contains("it is a folder"));
        assert_eq!(refused(&folder.join("no such thing")), "there is no such file");
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        assert!(open_input(&own).unwrap().size.is_some_and(|size| size > 0));
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_links_into_nothing_are_told() {
        assert!(refused(Path::new("/dev/zero")).contains("it is a device"));
        let folder = std::env::temp_dir().join(format!("epiline-links-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for (name, target) in [("dangling", "nothing"), ("circle", "circle")] {
            let link = folder.join(name);
            std::os::unix::fs::symlink(target, &link).unwrap();
            assert_eq!(refused(&link), "it is a link that leads nowhere");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn reasons_have_no_numbers_and_no_hidden_paths() {
        let error = std::io::Error::other("Strange thing (os error 27) at path \".x.part\"");
        assert_eq!(reason(&error), "strange thing");
    }
}
