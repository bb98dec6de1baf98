//! Reading of text files and folders, with errors that name the file and the line.

use std::fs::DirEntry;
use std::io::Read;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::foreign::{escaped, open_input, reason, shown_path};

/// Largest text file that is read, bytes: half a million point pairs with all digits. Memory use is
/// a few times the size.
const MOST_BYTES: u64 = 64 << 20;
/// Maximum length of an error message, characters. Other libraries quote any amount of the file.
const MOST_WORDS: usize = 300;

/// Reason why a file or folder cannot be read, one sentence.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct ReadError(String);

impl ReadError {
    /// Creates an error about one line, counted from 1.
    pub(super) fn line(path: &Path, line: usize, problem: impl Into<String>) -> Self {
        Self(format!("{}, line {line}: {}", shown_path(path), limited(&problem.into())))
    }

    /// Creates an error about a whole file or folder.
    pub(super) fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self(format!("{}: {}", shown_path(path), limited(&problem.into())))
    }

    /// Creates an error about a file or folder that is missing or not readable.
    pub(super) fn open(path: &Path, reason: &str) -> Self {
        Self(format!("cannot read {}: {reason}", shown_path(path)))
    }
}

/// Error in the content of a file, one clause.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{problem}")]
pub struct Problem {
    /// Line number from 1, if known.
    pub line: Option<usize>,
    /// Expected and found content.
    pub problem: String,
}

impl Problem {
    pub(super) fn whole(problem: impl Into<String>) -> Self {
        Self { line: None, problem: problem.into() }
    }

    pub(super) fn at(line: usize, problem: impl Into<String>) -> Self {
        Self { line: Some(line), problem: problem.into() }
    }

    /// Adds the name of the file.
    pub(super) fn of_file(self, path: &Path) -> ReadError {
        match self.line {
            Some(line) => ReadError::line(path, line, self.problem),
            None => ReadError::content(path, self.problem),
        }
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
    let input = open_input(path).map_err(|reason| ReadError::open(path, &reason))?;
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
    if count.map_err(|e| ReadError::open(path, &reason(&e)))? as u64 > MOST_BYTES {
        return large();
    }
    Ok(bytes)
}

/// Returns the entries of a folder, sorted to be independent of the file system.
pub(super) fn read_folder(path: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let entries = std::fs::read_dir(path).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let entries = entries.map_err(|e| ReadError::open(path, &reason(&e)))?;
    let mut paths: Vec<PathBuf> = entries.iter().map(DirEntry::path).collect();
    paths.sort();
    Ok(paths)
}

/// Extensions of files that are opened as images.
pub const IMAGE_EXTENSIONS: [&str; 12] =
    ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "pgm", "ppm", "pnm", "pbm", "pam", "webp"];

/// Returns whether the extension is one of [`IMAGE_EXTENSIONS`], ignoring case.
pub fn has_image_extension(path: &Path) -> bool {
    has_extension(path, &IMAGE_EXTENSIONS)
}

/// Returns whether the extension is one of those given, ignoring case.
pub fn has_extension(path: &Path, known: &[&str]) -> bool {
    let extension = path.extension().and_then(|e| e.to_str());
    extension.is_some_and(|e| known.iter().any(|known| known.eq_ignore_ascii_case(e)))
}
