//! `epiline convert`: conversion of a geometry to the format and convention of another program.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::console::{print, tell};
use super::geometry_file::{GeometryInput, GeometryOutput};
use crate::camera::PicturesOf;
use crate::foreign::{excerpt, shown_path};
use crate::io::{Format, OutputFile, refuse_clashes};
use crate::presentation::lenses_in_words;

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
    /// Database of COLMAP. The output is a copy with the points, the matches and the geometry added
    /// (.db), or a list of the matches at its keypoints for COLMAP to import (.txt)
    #[arg(long, value_name = "FILE", conflicts_with = "format")]
    database: Option<PathBuf>,
    /// Names of both images in the database, by default the names in the result
    #[arg(long, num_args = 2, value_names = ["LEFT", "RIGHT"], requires = "database")]
    names: Option<Vec<String>>,
}

/// Reads the input, writes the output and prints a summary.
pub(super) fn run(arguments: &ConvertArguments) -> Result<(), CliError> {
    if let Some(database) = &arguments.database {
        return to_colmap(arguments, database);
    }
    let output = GeometryOutput::prepare(&arguments.output, arguments.format)?;
    refuse_clashes(output.file().as_slice(), &arguments.input.inputs())?;
    let (file, format) = arguments.input.read()?;
    output.write(&file)?;
    let parts = [
        file.geometry().map(|_| "F".to_owned()),
        file.cameras.map(|_| "two cameras".to_owned()),
        file.homographies.map(|_| "two homographies".to_owned()),
        file.homography21.map(|_| "the homography of a plane".to_owned()),
        (!file.pairs.is_empty()).then(|| format!("{} point pairs", file.pairs.len())),
    ];
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    let read = shown_path(arguments.input.path());
    let pictures = match &file.pictures {
        PicturesOf::Untold | PicturesOf::Original => String::new(),
        undistorted @ PicturesOf::Undistorted(_) => {
            format!(", all of pictures without distortion ({})", lenses_in_words(undistorted))
        }
    };
    let text =
        format!("{}{pictures} from {read} ({}) to {}\n", parts.join(", "), format.label(), output.place());
    if output.is_piped() {
        tell(text.trim_end());
        return Ok(());
    }
    print(&text)
}

/// Adds the input to a copy of a database, or writes its list of matches.
fn to_colmap(arguments: &ConvertArguments, database: &Path) -> Result<(), CliError> {
    let extension = arguments.output.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let is_list = match extension.as_deref() {
        Some("db") => false,
        Some("txt") => true,
        _ => {
            let problem =
                "with --database the output is a copy of the database (.db) or a list of matches (.txt)";
            return Err(CliError::Arguments(problem.into()));
        }
    };
    let output = OutputFile::prepare(&arguments.output)?;
    let inputs: Vec<&Path> = arguments.input.inputs().into_iter().chain([database]).collect();
    refuse_clashes(&[output.path()], &inputs)?;
    let (file, _) = arguments.input.read()?;
    let names = match arguments.names.as_deref() {
        Some([left, right]) => Some([left.as_str(), right.as_str()]),
        _ => None,
    };
    let pair = if is_list {
        file.write_colmap_matches(names, database, &output)?
    } else {
        file.add_to_colmap(names, database, &output)?
    };
    let mut text = format!("{pair}, to {}\n", shown_path(output.path()));
    if !is_list {
        let [left, right] = pair.names.each_ref().map(|name| excerpt(name));
        let [first, second] = pair.keypoints;
        let _ = writeln!(text, "New keypoints: {first} in {left}, {second} in {right}");
    }
    print(&text)
}
