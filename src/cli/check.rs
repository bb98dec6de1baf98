//! `epiline check`: detection of the convention of a fundamental matrix.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::geometry_file::{GeometryInput, GeometryOutput};
use crate::camera::PicturesOf;
use crate::convention::{ConventionCheck, RankedReading, Reading, check_convention};
use crate::foreign::shown_path;
use crate::geometry::FundamentalMatrix;
use crate::io::{Format, GeometryFile};

/// Find the convention of a fundamental matrix or two cameras, using matches
///
/// Tests the matrix as it is and transposed (which equals exchanged images), with x and y
/// exchanged, with pixels counted from (0, 0), (0.5, 0.5) and (1, 1), and for images of another
/// size. Ranks these readings by the median distance of the matches to their epipolar lines. The
/// exit status is 1 if none fits.
#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    #[command(flatten)]
    input: GeometryInput,
    /// Write F in the convention found, with the matches, in the format of any program; - is
    /// standard output
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Format of the output, by default from the file extension
    #[arg(long, value_enum, requires = "output")]
    format: Option<Format>,
    /// List all readings, not only the best
    #[arg(long)]
    all: bool,
    /// Write all readings as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Content of the JSON file.
#[derive(Serialize)]
struct CheckFile<'a> {
    /// Fundamental matrix in the convention of this program; null if no reading fits.
    fundamental: Option<FundamentalMatrix>,
    /// Pictures that F belongs to.
    #[serde(flatten)]
    pictures: &'a PicturesOf,
    reading: Option<Reading>,
    fits: bool,
    message: &'a str,
    format: Format,
    /// How the file was read.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    remarks: &'a [String],
    #[serde(flatten)]
    check: &'a ConventionCheck,
    version: &'static str,
}

/// Ranks the readings, writes the files and prints the table.
pub(super) fn run(arguments: &CheckArguments) -> Result<(), CliError> {
    let corrected = ("--output", arguments.output.as_deref(), arguments.format);
    let json = arguments.json.as_deref();
    let (output, corrected) = GeometryOutput::prepare_beside(json, corrected, &arguments.input.inputs())?;
    let (file, format) = arguments.input.read()?;
    let Some(given) = file.geometry() else {
        let problem = format!(
            "{}: there is no fundamental matrix in it, nor two cameras",
            shown_path(arguments.input.path())
        );
        return Err(CliError::Arguments(problem));
    };
    let check = check_convention(&given, &file.pairs)?;
    let (best, sentence) = (check.best(), check.sentence());
    let believed = check.fits().then_some(best);
    let result = CheckFile {
        fundamental: believed.map(|b| b.fundamental),
        pictures: &file.pictures,
        reading: believed.map(|b| b.reading),
        fits: check.fits(),
        message: &sentence,
        format,
        remarks: &file.remarks,
        check: &check,
        version: env!("CARGO_PKG_VERSION"),
    };
    let text = table(&check, format, arguments.all);
    if let (Some(corrected), Some(best)) = (&corrected, believed) {
        // Cameras and homographies keep the convention that was read. Only F was checked.
        let file = GeometryFile {
            fundamental: Some(best.fundamental),
            pairs: file.pairs,
            images: file.images,
            ..GeometryFile::of(file.pictures.clone())
        };
        corrected.write(&file)?;
    }
    if corrected.is_some_and(|corrected| corrected.is_piped()) {
        super::console::tell(text.trim_end());
        super::console::tell(&sentence);
    } else if check.fits() {
        output.write(&result, &format!("{text}{sentence}\n"))?;
    } else {
        output.write(&result, &text)?;
    }
    if check.fits() { Ok(()) } else { Err(CliError::NothingFits(sentence)) }
}

fn table(check: &ConventionCheck, format: Format, all: bool) -> String {
    const MOST: usize = 8;
    let mut text = format!("Read as {}, on {} matches:\n", format.label(), check.matches);
    let _ = writeln!(text, "  median, px  within {:.1} px  told apart  reading", check.limit);
    let count = if all { check.readings.len() } else { MOST };
    for ranked in check.readings.iter().take(count) {
        text.push_str(&row(ranked, check.best()));
    }
    // The matrix as read is always listed, even if it ranks low.
    let is_listed = check.readings.iter().take(count).any(|r| r.reading.changes() == 0);
    if let (Some(as_read), false) = (check.as_read(), is_listed) {
        let _ = writeln!(text, "  …");
        text.push_str(&row(as_read, check.best()));
    }
    text
}

fn row(ranked: &RankedReading, best: &RankedReading) -> String {
    let apart = match ranked.told_apart {
        _ if std::ptr::eq(ranked, best) => "",
        true => "yes",
        false => "no",
    };
    format!("{:>12.3}{:>13.0} %{apart:>12}  {}\n", ranked.median, 100.0 * ranked.within, ranked.reading)
}
