//! `epiline suggest`: the match of a point clicked in one image.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::arguments::{ImagePair, on_threads, pixels, point, threads};
use super::geometry_file::read_geometry;
use super::output::Output;
use crate::camera::PicturesOf;
use crate::geometry::{FundamentalMatrix, Point};
use crate::io::refuse_clashes;
use crate::study::Study;
use crate::suggest::{ClickedImage, Known, SuggestParameters, Suggestions};

/// Suggest the match of a point in the other image
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct SuggestArguments {
    #[command(flatten)]
    images: ImagePair,
    /// Coordinates of the point, pixels
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    at: Point,
    /// Image that contains the point
    #[arg(long = "in", value_enum, default_value_t = ClickedImage::First, value_name = "IMAGE")]
    clicked: ClickedImage,
    /// File with a fundamental matrix, to search along the epipolar line: nine numbers, a result of
    /// estimate (its matches help, too), or any other format
    #[arg(long, value_name = "FILE")]
    fundamental: Option<PathBuf>,
    /// Half width of the band searched around the epipolar line, pixels
    #[arg(long, value_name = "PX", value_parser = pixels, requires = "fundamental", default_value_t = SuggestParameters::default().band)]
    band: f64,
    /// Number of threads, by default one per core
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
    /// Write the result as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Suggests matches, writes the JSON file and prints the candidates.
pub(super) fn run(arguments: &SuggestArguments) -> Result<(), CliError> {
    let output = Output::prepare(arguments.json.as_deref())?;
    let inputs: Vec<&Path> = arguments.images.files().chain(arguments.fundamental.as_deref()).collect();
    refuse_clashes(output.file().as_slice(), &inputs)?;
    let file = arguments.fundamental.as_deref().map(read_geometry).transpose()?;
    let (fundamental, matches) = file.map(|(fundamental, file)| (fundamental, file.found)).unzip();
    let matches = matches.unwrap_or_default();
    let study = Study::of_pictures(arguments.images.load()?.0);
    let parameters = SuggestParameters { band: arguments.band, ..SuggestParameters::default() };
    let clicked = arguments.clicked;
    let found = on_threads(arguments.threads, || {
        let known = Known { fundamental, view: None, matches: &matches };
        study.suggest(arguments.at, clicked, &known, &parameters)
    })??;
    let result = SuggestionFile {
        at: arguments.at,
        side: if clicked == ClickedImage::First { "left" } else { "right" },
        fundamental,
        pictures: PicturesOf::ORIGINAL,
        clear: found.clear().is_some(),
        message: found.verdict.to_string(),
        suggestions: &found,
        images: study.pictures().map(|picture| picture.name.as_str()),
        parameters: &parameters,
        version: env!("CARGO_PKG_VERSION"),
    };
    output.write(&result, &table(&found, arguments.at, clicked))
}

/// Content of the JSON file. Positions are `[x, y]` in px, angles in radians.
#[derive(Serialize)]
struct SuggestionFile<'a> {
    at: Point,
    #[serde(rename = "in")]
    side: &'static str,
    fundamental: Option<FundamentalMatrix>,
    /// Pictures that all coordinates belong to.
    pictures: &'static str,
    clear: bool,
    message: String,
    #[serde(flatten)]
    suggestions: &'a Suggestions,
    images: [&'a str; 2],
    parameters: &'a SuggestParameters,
    version: &'static str,
}

/// Formats the candidates as a table.
fn table(found: &Suggestions, at: Point, clicked: ClickedImage) -> String {
    let other = 3 - clicked.number();
    let mut text =
        format!("Match of ({}, {}) px of image {} in image {other}:\n", at.x, at.y, clicked.number());
    text.push_str("      x, px     y, px  correlation  turned by  scaled by\n");
    for candidate in &found.candidates {
        let _ = writeln!(
            text,
            " {:>10.2}{:>10.2}{:>13.3}{:>10.1}°{:>11.2}",
            candidate.position.x,
            candidate.position.y,
            candidate.correlation,
            candidate.rotation.to_degrees(),
            candidate.scale
        );
    }
    let _ = writeln!(text, "{}", found.verdict);
    let _ =
        writeln!(text, "Ambiguity: {:.2} (0: no rival, 1: another place fits equally well)", found.ambiguity);
    let _ = match found.return_distance {
        Some(distance) => writeln!(text, "Reverse search: ends {distance:.2} px from the point"),
        None => writeln!(text, "Reverse search: no match found"),
    };
    text
}
