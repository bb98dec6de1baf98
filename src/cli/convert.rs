//! `epiline convert`: conversion of a geometry to the format and convention of another program.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::console::{print, tell};
use super::geometry_file::{GeometryInput, GeometryOutput};
use crate::foreign::shown_path;
use crate::io::{Format, refuse_clashes};

/// Convert F, cameras, homographies and point pairs between file formats and their conventions
#[derive(Debug, Args)]
pub(super) struct ConvertArguments {
    #[command(flatten)]
    input: GeometryInput,
    /// File to write; - is standard output
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Format of the output, by default from the file extension
    #[arg(long, value_enum)]
    format: Option<Format>,
}

/// Reads the input, writes the output and prints a summary.
pub(super) fn run(arguments: &ConvertArguments) -> Result<(), CliError> {
    let output = GeometryOutput::prepare(&arguments.output, arguments.format)?;
    refuse_clashes(&output.file().into_iter().collect::<Vec<_>>(), &arguments.input.inputs())?;
    let (file, format) = arguments.input.read()?;
    output.write(&file)?;
    let parts: Vec<_> = [
        file.geometry().map(|_| "F".to_owned()),
        file.cameras.map(|_| "two cameras".to_owned()),
        file.homographies.map(|_| "two homographies".to_owned()),
        file.homography21.map(|_| "the homography of a plane".to_owned()),
        (!file.pairs.is_empty()).then(|| format!("{} point pairs", file.pairs.len())),
    ]
    .into_iter()
    .flatten()
    .collect();
    let read = shown_path(arguments.input.path());
    let text = format!("{} from {read} ({}) to {}\n", parts.join(", "), format.label(), output.place());
    if output.is_piped() {
        tell(text.trim_end());
        return Ok(());
    }
    print(&text)
}
