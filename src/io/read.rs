//! Reading of text files and folders, with errors that name the file and the line.

use std::io::Read;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::foreign::{escaped, open_input, reason, shown_path};

/// Largest text file that is read, bytes: half a million point pairs with all digits. Memory use is
/// a few times the size.
const MOST_BYTES: u64 = 64 << 20;
/// Maximum length of an error message, characters. Other libraries quote any amount of the file.
const MOST_WORDS: usize = 300;

/// Reason why a file or folder cannot be read. The message is shown to the user.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file is missing or not readable.
    #[error("cannot read {path}: {reason}")]
    Open {
        /// File or folder.
        path: String,
        /// Reason given by the system.
        reason: String,
    },
    /// A line is invalid.
    #[error("{path}, line {line}: {problem}")]
    Line {
        /// Path of the file.
        path: String,
        /// Line number, from 1.
        line: usize,
        /// Expected and found content.
        problem: String,
    },
    /// The file or folder as a whole is invalid.
    #[error("{path}: {problem}")]
    Content {
        /// File or folder.
        path: String,
        /// Expected and found content.
        problem: String,
    },
}

impl ReadError {
    /// Creates an error about one line, counted from 1.
    pub(super) fn line(path: &Path, line: usize, problem: impl Into<String>) -> Self {
        Self::Line { path: shown_path(path), line, problem: limited(&problem.into()) }
    }

    /// Creates an error about a whole file or folder.
    pub(super) fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content { path: shown_path(path), problem: limited(&problem.into()) }
    }

    fn open(path: &Path, error: &std::io::Error) -> Self {
        Self::Open { path: shown_path(path), reason: reason(error) }
    }
}

/// Shortens a message that may quote a file, and escapes its control characters.
pub(super) fn limited(sentence: &str) -> String {
    let mut characters = sentence.chars();
    let mut start: String = characters.by_ref().take(MOST_WORDS).collect();
    if characters.next().is_some() {
        start.push('…');
    }
    escaped(&start)
}

/// Reads a whole text file.
pub(super) fn read_text(path: &Path) -> Result<String, ReadError> {
    text_of(path, read_bytes(path)?)
}

/// Returns the text of a file's bytes.
pub(super) fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String, ReadError> {
    let text = String::from_utf8(bytes).map_err(|_| ReadError::content(path, "this is not a text file"))?;
    // Spreadsheet programs write a byte order mark before the first number.
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Reads a whole file up to the limit for text files.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    let input = open_input(path).map_err(|reason| ReadError::Open { path: shown_path(path), reason })?;
    let large = || {
        let problem = format!("the file is larger than {} MiB, the limit", MOST_BYTES >> 20);
        Err(ReadError::content(path, problem))
    };
    if input.size.is_some_and(|size| size > MOST_BYTES) {
        return large();
    }
    let mut bytes = Vec::new();
    // A pipe has no known size.
    let count = input.file.take(MOST_BYTES + 1).read_to_end(&mut bytes);
    if count.map_err(|e| ReadError::open(path, &e))? as u64 > MOST_BYTES {
        return large();
    }
    Ok(bytes)
}

/// Returns the entries of a folder, sorted to be independent of the file system.
pub(super) fn read_folder(path: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let entries = std::fs::read_dir(path).map_err(|e| ReadError::open(path, &e))?;
    let mut paths = entries
        .map(|entry| entry.map(|e| e.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e| ReadError::open(path, &e))?;
    paths.sort();
    Ok(paths)
}

/// Extensions of files that are opened as images.
pub const IMAGE_EXTENSIONS: [&str; 12] =
    ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "pgm", "ppm", "pnm", "pbm", "pam", "webp"];

/// Returns whether the extension is one of [`IMAGE_EXTENSIONS`], ignoring case.
pub fn has_image_extension(path: &Path) -> bool {
    path.extension()
        .and_then(|e| e.to_str())
        .is_some_and(|e| IMAGE_EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(e)))
}
