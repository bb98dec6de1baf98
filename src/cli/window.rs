//! `epiline [LEFT RIGHT]`: the window.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::arguments::point_pair;
use crate::geometry::PointPair;

/// What the window opens with.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Two images to open; without them the built-in sample opens
    #[arg(value_names = ["LEFT", "RIGHT"], num_args = 0..=2)]
    images: Vec<PathBuf>,
    /// Point pair to place, pixels in the left and in the right image; repeatable
    #[arg(long = "pair", value_name = "X1,Y1,X2,Y2", value_parser = point_pair, allow_hyphen_values = true)]
    pairs: Vec<PointPair>,
}

/// Opens the window and returns when it is closed.
pub(super) fn run(arguments: Arguments) -> Result<(), CliError> {
    let images = match <[PathBuf; 2]>::try_from(arguments.images) {
        Ok(images) => Some(images),
        Err(none) if none.is_empty() => None,
        Err(_) => {
            return Err(CliError::Arguments("two images are needed, LEFT and RIGHT, one was given".into()));
        }
    };
    open(images, arguments.pairs)
}

/// Hands over to the window.
#[cfg(feature = "inspector")]
fn open(images: Option<[PathBuf; 2]>, pairs: Vec<PointPair>) -> Result<(), CliError> {
    use crate::app::{Opening, Start, run};
    let opening = images.map_or(Opening::Sample, |[left, right]| Opening::Files(left, right));
    run(Start { opening, pairs }).map_err(|error| CliError::Window(error.to_string()))
}

/// Without the window there is only the command line.
#[cfg(not(feature = "inspector"))]
fn open(_images: Option<[PathBuf; 2]>, _pairs: Vec<PointPair>) -> Result<(), CliError> {
    Err(CliError::Window(
        "this build has no window; use the commands estimate and evaluate, or build with the feature inspector"
            .into(),
    ))
}
