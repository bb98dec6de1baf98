//! `epiline [LEFT RIGHT | SESSION.json | DIR]`: the window.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::arguments::point_pair;
use crate::geometry::PointPair;

/// Content to open in the window.
#[derive(Debug, Args)]
pub(super) struct WindowArguments {
    /// Two images, two sequences (folders of frames or videos), a session (.json), or a folder of
    /// images, with or without ground truth; by default the built-in sample
    #[arg(value_names = ["LEFT", "RIGHT"], num_args = 0..=2)]
    images: Vec<PathBuf>,
    /// Open the built-in sequences: thrown balls seen by two stationary cameras
    #[arg(long, conflicts_with = "images")]
    sequences: bool,
    /// Point pair to place, pixels in the left and in the right image; repeatable
    #[arg(long = "pair", value_name = "X1,Y1,X2,Y2", value_parser = point_pair, allow_hyphen_values = true)]
    pairs: Vec<PointPair>,
    /// File to import, with point pairs, F or two cameras (.P, given one after the other);
    /// repeatable
    #[arg(long = "import", value_name = "FILE")]
    imports: Vec<PathBuf>,
}

/// Opens the window and returns when it is closed.
pub(super) fn run(arguments: WindowArguments) -> Result<(), CliError> {
    let what = match &arguments.images[..] {
        [] if arguments.sequences => WindowContent::SampleSequences,
        [] => WindowContent::Sample,
        [left, right] => WindowContent::Images(left.clone(), right.clone()),
        [folder] if folder.is_dir() => WindowContent::Folder(folder.clone()),
        [file] if file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) => {
            WindowContent::Session(file.clone())
        }
        _ => {
            let problem = "one file was given that is not a session (.json). Give two images LEFT and RIGHT, a session, or \
                 one folder of images";
            return Err(CliError::Arguments(problem.into()));
        }
    };
    open(what, arguments.pairs, arguments.imports)
}

/// Content of the window at the start.
#[cfg_attr(not(feature = "inspector"), expect(dead_code, reason = "there is no window to tell"))]
enum WindowContent {
    Sample,
    SampleSequences,
    Images(PathBuf, PathBuf),
    Folder(PathBuf),
    Session(PathBuf),
}

#[cfg(feature = "inspector")]
fn open(what: WindowContent, pairs: Vec<PointPair>, imports: Vec<PathBuf>) -> Result<(), CliError> {
    use crate::app::{Opening, Start, run};
    let opening = match what {
        WindowContent::Sample => Opening::Sample,
        WindowContent::SampleSequences => Opening::SampleSequences,
        WindowContent::Images(left, right) => Opening::Files(left, right),
        WindowContent::Folder(folder) => Opening::Folder(folder),
        WindowContent::Session(file) => Opening::Session(file),
    };
    run(Start { opening, pairs, imports }).map_err(|error| CliError::Window(error.to_string()))
}

/// Reports that this build has no window.
#[cfg(not(feature = "inspector"))]
fn open(_what: WindowContent, _pairs: Vec<PointPair>, _imports: Vec<PathBuf>) -> Result<(), CliError> {
    Err(CliError::Window(
        "this build has no window. Use the command estimate, or build with the feature inspector".into(),
    ))
}
