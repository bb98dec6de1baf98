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
#[cfg(feature = "inspector")]
pub(super) fn run(arguments: WindowArguments) -> Result<(), CliError> {
    use crate::app::{Opening, Start};
    let WindowArguments { images, sequences, pairs, imports } = arguments;
    let opening = match &images[..] {
        [] if sequences => Opening::SampleSequences,
        [] => Opening::default(),
        [left, right] => Opening::Files(left.clone(), right.clone()),
        [folder] if folder.is_dir() => Opening::Folder(folder.clone()),
        [file] if file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) => {
            Opening::Session(file.clone().into())
        }
        _ => {
            let problem = "one file was given that is not a session (.json). Give two images LEFT and RIGHT, a session, or \
                 one folder of images";
            return Err(CliError::Arguments(problem.into()));
        }
    };
    crate::app::run(Start { opening, pairs, imports }).map_err(|error| CliError::Window(error.to_string()))
}

/// Reports that this build has no window.
#[cfg(not(feature = "inspector"))]
pub(super) fn run(_: WindowArguments) -> Result<(), CliError> {
    Err(CliError::Window(
        "this build has no window. Use the command estimate, or build with the feature inspector".into(),
    ))
}
