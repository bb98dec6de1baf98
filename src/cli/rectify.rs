//! `epiline rectify`: both images redrawn with corresponding points in the same row.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::arguments::{ImagePair, megapixels, on_threads, threads};
use super::console::print;
use crate::cancel::CancelFlag;
use crate::foreign::shown_path;
use crate::io::{PictureFormat, RectifiedFiles, RectifiedOptions, read_fundamental, read_point_pairs};
use crate::rectify::{Distortion, Limits, Rectification, RectifyMethod, rectify};

/// Redraw both images so that corresponding points are in the same row
#[derive(Debug, Args)]
pub(super) struct RectifyArguments {
    #[command(flatten)]
    images: ImagePair,
    /// File with the fundamental matrix: a result of estimate, or any other format
    #[arg(long, value_name = "FILE")]
    fundamental: PathBuf,
    /// Folder for the pictures and rectification.json; created if missing
    #[arg(long, value_name = "DIR")]
    output: PathBuf,
    /// Method of rectification
    #[arg(long, value_enum, default_value_t)]
    method: RectifyMethod,
    /// Matches for measuring the row errors: a file of rows x1 y1 x2 y2
    #[arg(long, value_name = "FILE")]
    matches: Option<PathBuf>,
    /// Format of the pictures
    #[arg(long, value_enum, default_value_t = PictureFormat::default())]
    format: PictureFormat,
    /// Rows between the guide lines of the stacked picture, 0 for none
    #[arg(long, value_name = "ROWS", default_value_t = 40)]
    guide_lines: usize,
    /// Also write the original position of each rectified pixel, as npy arrays for cv2.remap
    #[arg(long)]
    maps: bool,
    /// Maximum size of a rectified picture, millions of pixels; larger ones are reduced
    #[arg(long, value_name = "MP", value_parser = megapixels)]
    max_megapixels: Option<usize>,
    /// Number of threads, by default one per core
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
}

/// Rectifies the images, writes the folder and prints a summary.
pub(super) fn run(arguments: &RectifyArguments) -> Result<(), CliError> {
    let options = RectifiedOptions {
        format: arguments.format,
        guide_spacing: arguments.guide_lines,
        maps: arguments.maps,
    };
    let fundamental = read_fundamental(&arguments.fundamental)?;
    let given = arguments.matches.as_deref().map(read_point_pairs).transpose()?;
    let (pictures, known) = arguments.images.load()?;
    let matches = given.or(known).unwrap_or_default();
    let limits = arguments.max_megapixels.map_or_else(Limits::default, |pixels| Limits { pixels });
    let frames = [pictures[0].frame(), pictures[1].frame()];
    let rectification = rectify(&fundamental, frames, &matches, arguments.method, &limits)?;
    let images = pictures.iter().filter_map(|picture| picture.path.as_deref());
    let inputs: Vec<&Path> =
        images.chain([arguments.fundamental.as_path()]).chain(arguments.matches.as_deref()).collect();
    let files = RectifiedFiles::prepare(&arguments.output, options, &inputs)?;
    let drawn = on_threads(arguments.threads, || {
        let never = CancelFlag::default();
        [0, 1].map(|k| rectification.warp(k, &pictures[k].pixels, &never))
    })?;
    if let [Some(left), Some(right)] = &drawn {
        let originals = [&pictures[0], &pictures[1]];
        files.write(&rectification, &fundamental, originals, [left, right], &mut |_| true)?;
    }
    print(&summary(&rectification, &files))
}

/// Describes a rectification in words.
fn summary(r: &Rectification, files: &RectifiedFiles) -> String {
    let mut text = format!("Method: {}, because {}\n", r.method.name(), r.reason);
    let _ = writeln!(text, "Pictures: {} x {} px", r.size.width, r.size.height);
    if let Some(rows) = r.measures.rows {
        let _ = write!(
            text,
            "Row error of {} matches: {:.3} px on average, {:.3} px at most; disparity {:.0} to {:.0} px",
            rows.matches, rows.mean, rows.max, rows.disparity[0], rows.disparity[1]
        );
        if rows.far_off > 0 {
            let _ = write!(text, " without {} outliers", rows.far_off);
        }
        text.push('\n');
    }
    for (name, distortion) in ["Left", "Right"].iter().zip(&r.measures.distortion) {
        let _ = writeln!(text, "{name}: {}", shape(distortion));
    }
    for warning in &r.warnings {
        let _ = writeln!(text, "Beware: {warning}");
    }
    for path in files.paths() {
        let _ = writeln!(text, "Wrote {}", shown_path(&path));
    }
    text
}

/// Describes the distortion of a picture.
fn shape(d: &Distortion) -> String {
    let mut parts = Vec::new();
    if let Some(angle) = d.orthogonality {
        parts.push(format!("middle lines at {angle:.1} degrees"));
    }
    if let Some(ratio) = d.aspect_ratio {
        parts.push(format!("diagonals 1 : {ratio:.3}"));
    }
    for (share, what) in
        [(d.cut, "cut off"), (d.shrunk, "below half size"), (d.stretched, "above twice size")]
    {
        parts.push(format!("{:.1} % of the area {what}", 100.0 * share));
    }
    parts.join(", ")
}
