//! Reading text files and folders, with errors that name the file and the line.

use std::io::Read;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::foreign::{escaped, open_input, reason, shown_path};

/// The largest text file that is read: half a million point pairs with all their digits. What is made of it in memory
/// is a few times as large.
const MOST_BYTES: u64 = 64 << 20;
/// Characters of a sentence about a file; other libraries quote the file as they like.
const MOST_WORDS: usize = 300;

/// Why a file or folder could not be read. Each message is one sentence for the user.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file is missing or may not be read.
    #[error("cannot read {path}: {reason}")]
    Open {
        /// The file or folder.
        path: String,
        /// The system's reason.
        reason: String,
    },
    /// A line does not say what it should.
    #[error("{path}, line {line}: {problem}")]
    Line {
        /// The file.
        path: String,
        /// Number of the line, from 1.
        line: usize,
        /// What was expected and what was found.
        problem: String,
    },
    /// The file or folder as a whole is not what it should be.
    #[error("{path}: {problem}")]
    Content {
        /// The file or folder.
        path: String,
        /// What was expected and what was found.
        problem: String,
    },
}

impl ReadError {
    /// An error about one line of a file, counted from 1.
    pub(super) fn line(path: &Path, line: usize, problem: impl Into<String>) -> Self {
        Self::Line { path: shown_path(path), line, problem: limited(&problem.into()) }
    }

    /// An error about a whole file or folder.
    pub(super) fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content { path: shown_path(path), problem: limited(&problem.into()) }
    }

    fn open(path: &Path, error: &std::io::Error) -> Self {
        Self::Open { path: shown_path(path), reason: reason(error) }
    }
}

/// A sentence that may quote a file: not too long, and without control characters.
pub(super) fn limited(sentence: &str) -> String {
    let mut characters = sentence.chars();
    let mut start: String = characters.by_ref().take(MOST_WORDS).collect();
    if characters.next().is_some() {
        start.push('…');
    }
    escaped(&start)
}

/// The whole of a text file.
pub(super) fn read_text(path: &Path) -> Result<String, ReadError> {
    let input = open_input(path).map_err(|reason| ReadError::Open { path: shown_path(path), reason })?;
    let large = || {
        let problem = format!("the file is larger than {} MiB, too large to be read here", MOST_BYTES >> 20);
        Err(ReadError::content(path, problem))
    };
    if input.size.is_some_and(|size| size > MOST_BYTES) {
        return large();
    }
    let mut bytes = Vec::new();
    // Piped data has no size to ask for.
    let count = input.file.take(MOST_BYTES + 1).read_to_end(&mut bytes);
    if count.map_err(|e| ReadError::open(path, &e))? as u64 > MOST_BYTES {
        return large();
    }
    let text = String::from_utf8(bytes).map_err(|_| ReadError::content(path, "this is not a text file"))?;
    // Spreadsheet programs put a byte order mark in front of the first number.
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// The entries of a folder, sorted, so that nothing depends on the order of the file system.
pub(super) fn read_folder(path: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let entries = std::fs::read_dir(path).map_err(|e| ReadError::open(path, &e))?;
    let mut paths = entries
        .map(|entry| entry.map(|e| e.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e| ReadError::open(path, &e))?;
    paths.sort();
    Ok(paths)
}

/// Endings of files that are opened as images.
pub const IMAGE_EXTENSIONS: [&str; 12] =
    ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "pgm", "ppm", "pnm", "pbm", "pam", "webp"];

/// Whether the name ends like that of an image the program can open.
pub fn has_image_extension(path: &Path) -> bool {
    path.extension()
        .and_then(|e| e.to_str())
        .is_some_and(|e| IMAGE_EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(e)))
}
