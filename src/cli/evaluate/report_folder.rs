//! Folder of a report, checked before the work and filled at the end.

use std::path::{Path, PathBuf};

use crate::cli::CliError;
use crate::foreign::{reason, shown_path};
use crate::io::OutputFile;
use crate::publish::{Publication, html, markdown};

/// Name of the folder of figures beside the Markdown file.
const FIGURES: &str = "figures";

/// Folder that was found writable.
#[derive(Debug)]
pub(super) struct ReportFolder {
    html: OutputFile,
    markdown: OutputFile,
    figures: PathBuf,
}

impl ReportFolder {
    /// Creates the folder and its folder of figures if missing.
    pub(super) fn prepare(folder: &Path) -> Result<Self, CliError> {
        let figures = folder.join(FIGURES);
        std::fs::create_dir_all(&figures).map_err(|error| CliError::Folder {
            path: shown_path(&figures),
            reason: match error.kind() {
                std::io::ErrorKind::AlreadyExists | std::io::ErrorKind::NotADirectory => {
                    "there is a file with the name of this folder or of a parent folder".to_owned()
                }
                std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
                _ => reason(&error),
            },
        })?;
        // The names of the figures are not known yet. One test file checks the folder.
        OutputFile::prepare(&figures.join("figure.svg"))?;
        Ok(Self {
            html: OutputFile::prepare(&folder.join("report.html"))?,
            markdown: OutputFile::prepare(&folder.join("report.md"))?,
            figures,
        })
    }

    /// Returns the files whose names are known in advance.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        [self.html.path(), self.markdown.path()].into_iter()
    }

    /// Writes the page, the figures, and last the Markdown file that refers to them.
    pub(super) fn write(&self, document: &Publication) -> Result<(), CliError> {
        self.html.write(html(document).as_bytes())?;
        let files = markdown(document, FIGURES);
        for (name, content) in &files.figures {
            OutputFile::prepare(&self.figures.join(name))?.write(content.as_bytes())?;
        }
        self.markdown.write(files.text.as_bytes())?;
        Ok(())
    }
}
