//! Destination of results: a file, checked before the work, or standard output.

use std::path::Path;

use serde::Serialize;

use super::CliError;
use super::console::{print, tell};
use crate::io::OutputFile;

/// Destination of a command's JSON and of its text for people.
#[derive(Debug)]
pub enum Output {
    /// Text to standard output, no JSON.
    Text,
    /// Text to standard output, JSON to a file.
    File(OutputFile),
    /// JSON to standard output, so the text goes to standard error.
    Piped,
}

impl Output {
    /// Prepares the output for the value of `--json`. Fails if the file cannot be written.
    pub fn prepare(json: Option<&Path>) -> Result<Self, CliError> {
        Ok(match json {
            None => Self::Text,
            Some(path) if path == Path::new("-") => Self::Piped,
            Some(path) => Self::File(OutputFile::prepare(path)?),
        })
    }

    /// Returns the JSON file, if there is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(file) => Some(file.path()),
            Self::Text | Self::Piped => None,
        }
    }

    /// Writes JSON and text. The file comes first, because the reader of standard output may close
    /// early.
    pub fn write(&self, json: &impl Serialize, text: &str) -> Result<(), CliError> {
        let mut content =
            serde_json::to_string_pretty(json).map_err(|e| CliError::StandardOutput(e.to_string()))?;
        content.push('\n');
        match self {
            Self::Text => print(text),
            Self::File(file) => {
                file.write(content.as_bytes())?;
                print(text)
            }
            Self::Piped => {
                tell(text.trim_end());
                print(&content)
            }
        }
    }
}
