//! Arguments of `epiline estimate`.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{ImagePair, point_pair, size, threads};
use super::calibration::CameraArguments;
use super::overrides::Overrides;
use super::result_output::ResultArguments;
use crate::estimate::{Method, Preset};
use crate::geometry::{Frame, PointPair};

/// Estimate the fundamental matrix of two images from point pairs, or from none
#[derive(Debug, Args)]
#[command(
    allow_negative_numbers = true,
    mut_arg("left", |left| left.index(1).required_unless_present_any(["sample", "matches"])),
    mut_arg("right", |right| right.index(2))
)]
pub(super) struct EstimateArguments {
    #[command(flatten)]
    pub(super) images: ImagePair,
    /// Point pair: the same scene point in both images, pixels; repeatable. Two pairs are enough;
    /// without any, F is found from the images alone (the preset paper takes none, two or three)
    #[arg(long = "pair", value_name = "X1,Y1,X2,Y2", value_parser = point_pair, allow_hyphen_values = true)]
    pub(super) pairs: Vec<PointPair>,
    /// Preset of the parameters
    #[arg(long, value_enum, default_value_t)]
    pub(super) preset: Preset,
    /// Method of estimation, by default chosen by the number of point pairs. The method lines
    /// compares all lines of both images and needs no pair
    #[arg(long, value_enum)]
    pub(super) method: Option<Method>,
    /// Random seed, by default 0; the same seed gives the same F
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Number of threads, by default one per core
    #[arg(long, value_parser = threads)]
    pub(super) threads: Option<usize>,
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with = "method",
        help = "Matches of another program: text, JSON, or .npz with the names of matchers. Their geometry \
                competes with the program's own, the images judge both, and the final fit uses these matches \
                too. With --set given_alone=true, F is fitted to these matches alone. Without images, F \
                is fitted to the matches, and nothing but the matches judges it"
    )]
    pub(super) matches: Option<PathBuf>,
    /// Sizes of the images, for matches without images: one for both or one for each
    #[arg(
        long, value_name = "WIDTHxHEIGHT", num_args = 1..=2, value_parser = size, requires = "matches",
        conflicts_with_all = ["left", "sample"]
    )]
    pub(super) sizes: Option<Vec<Frame>>,
    #[command(flatten)]
    pub(super) cameras: CameraArguments,
    /// Draw both pictures without the distortion of their lens into a folder, with the geometry that belongs
    /// to them: left.png, right.png and geometry.json. It needs --calibration or --division
    #[arg(long, value_name = "DIR")]
    pub(super) undistorted: Option<PathBuf>,
    #[command(flatten)]
    pub(super) result: ResultArguments,
    #[command(flatten)]
    pub(super) overrides: Overrides,
}
