//! `epiline rectify`: both images redrawn with corresponding points in the same row.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use image::DynamicImage;

use super::CliError;
use super::arguments::{ImagePair, megapixels, on_threads, threads};
use super::calibration::{CameraArguments, settled, views};
use super::console::{print, tell};
use super::geometry_file::{read_matches, tell_remarks};
use crate::camera::{PicturesOf, ViewPair};
use crate::cancel::CancelFlag;
use crate::foreign::shown_path;
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::image::Picture;
use crate::io::{
    CalibratedCamera, GeometryFile, PictureFormat, RectifiedFiles, RectifiedOptions, StereoPair,
    StereoPairFiles, StereoProgram,
};
use crate::presentation::lenses_in_words;
use crate::rectify::{Distortion, Limits, Rectification, RectifyMethod, rectify, rectify_calibrated};
use crate::study::{Study, StudyError, clicks_in, stereo_pose};

/// Redraw both images so that corresponding points are in the same row
#[derive(Debug, Args)]
pub(super) struct RectifyArguments {
    #[command(flatten)]
    images: ImagePair,
    /// File with the fundamental matrix: a result of estimate, or any other format. Not needed with a
    /// stereo calibration, which tells the pose of the cameras
    #[arg(long, value_name = "FILE", required_unless_present = "calibration")]
    fundamental: Option<PathBuf>,
    #[command(flatten)]
    cameras: CameraArguments,
    /// Folder for the pictures and rectification.json; created if missing
    #[arg(long, value_name = "DIR")]
    output: PathBuf,
    /// Method of rectification
    #[arg(long, value_enum, default_value_t)]
    method: RectifyMethod,
    /// Matches for measuring the row errors, by default the matches of the result
    #[arg(long, value_name = "FILE")]
    matches: Option<PathBuf>,
    /// Write a pair that a stereo program reads, with its calibration: parallel cameras, positive
    /// disparities, pictures of 8 bits
    #[arg(long = "for", value_enum, value_name = "PROGRAM", requires = "known_cameras")]
    program: Option<StereoProgram>,
    /// Format of the pictures
    #[arg(long, value_enum, default_value_t = PictureFormat::default())]
    format: PictureFormat,
    /// Rows between the guide lines of the side-by-side picture, 0 for none
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
    let calibrated = arguments.cameras.calibration.read()?;
    let given = arguments.matches.as_deref().map(read_matches).transpose()?;
    if arguments.cameras.fits_lens() {
        let unknown = "rectify makes no estimate, so it cannot fit the distortion. Give the coefficient that \
                       `epiline estimate --division auto` prints";
        return Err(CliError::Arguments(unknown.into()));
    }
    let is_calibrated = arguments.cameras.is_given();
    let result = arguments.fundamental.as_deref().map(|path| read_result(path, is_calibrated)).transpose()?;
    let (pictures, known) = arguments.images.load()?;
    let given = given.map(|given| given.iter().map(|found| found.pair).collect());
    let mut matches: Vec<PointPair> = given.or(known).unwrap_or_default();
    let study = Study::of_pictures(pictures);
    let (pictures, frames) = (study.pictures(), study.frames());
    let calibrated = arguments.cameras.of_pictures(calibrated, pictures, None)?;
    let calibrated = calibrated.map(|cameras| settled(cameras, &study, None)).transpose()?;
    let mut views = calibrated.as_ref().map(|cameras| views(cameras, frames)).transpose()?;
    if let (Some(views), Some((_, file)), Some(path)) = (&mut views, &result, &arguments.fundamental) {
        *views = of_result(views, &file.pictures, path)?;
    }
    let (fundamental, found) = result
        .map(|(fundamental, file)| {
            let of_views = views.as_ref().and_then(|views| file.geometry_in(views));
            (of_views.unwrap_or(fundamental), file.matches())
        })
        .unzip();
    if let Some(views) = &views {
        matches = clicks_in(views, &matches)?;
    }
    if matches.is_empty() {
        matches = found.unwrap_or_default();
    }
    let pictures_of = PicturesOf::from(views.as_ref());
    let posed = calibrated.zip(views).map(|(cameras, views)| {
        stereo_pose(CalibratedCamera::relative_pose(&cameras), &views, fundamental.as_ref(), &matches)
    });
    let limits = arguments.max_megapixels.map_or_else(Limits::default, |pixels| Limits { pixels });
    let images = pictures.iter().filter_map(|picture| picture.path.as_deref());
    let inputs = images.chain(arguments.fundamental.as_deref()).chain(arguments.matches.as_deref());
    let inputs: Vec<&Path> = inputs.chain(arguments.cameras.calibration.files()).collect();
    if let (Some(program), Some(views)) = (arguments.program, &views) {
        let (pose, baseline) = posed.ok_or(StudyError::NoPose)??;
        let files = StereoPairFiles::prepare(&arguments.output, program, &inputs)?;
        let (made, rig) = rectify_calibrated(&pose, views, &matches, &limits)?;
        let drawn = drawn(&made, pictures, arguments.threads)?;
        let disparities = made.measures.rows.map(|rows| rows.disparity);
        let pair = StereoPair { rig: &rig, views, baseline, disparities };
        // These programs read 8 bits.
        let shown = [0, 1].map(|k| pictures[k].displayed(&drawn[k]));
        files.write(&pair, [&shown[0], &shown[1]])?;
        return print(&stereo_summary(&made, &pair, &files));
    }
    let fundamental = match (fundamental, posed, &views) {
        (Some(fundamental), ..) => fundamental,
        (None, Some(posed), Some(views)) => {
            posed?.0.fundamental(&views.calibrations()).ok_or(StudyError::NoPose)?
        }
        _ => return Err(StudyError::NoPose.into()),
    };
    let options = RectifiedOptions {
        format: arguments.format,
        guide_spacing: arguments.guide_lines,
        maps: arguments.maps,
    };
    let frames = views.as_ref().map_or(frames, ViewPair::frames);
    let mut rectification = rectify(&fundamental, frames, &matches, arguments.method, &limits)?;
    if let Some(views) = &views {
        rectification = rectification.through(&views.views);
    }
    let files = RectifiedFiles::prepare(&arguments.output, options, &inputs)?;
    let drawn = drawn(&rectification, pictures, arguments.threads)?;
    let geometry = (&fundamental, &pictures_of);
    files.write(&rectification, geometry, pictures, [&drawn[0], &drawn[1]], &mut |_| true)?;
    print(&summary(&rectification, &files))
}

/// Draws both rectified pictures.
fn drawn(
    made: &Rectification,
    pictures: [&Picture; 2],
    threads: Option<usize>,
) -> Result<[DynamicImage; 2], CliError> {
    let never = CancelFlag::default();
    // Nothing cancels the drawing.
    on_threads(threads, || [0, 1].map(|k| made.warp(k, &pictures[k].pixels, &never).unwrap_or_default()))
}

/// Reads a result. A result for views without distortion needs a calibration.
fn read_result(path: &Path, is_calibrated: bool) -> Result<(FundamentalMatrix, GeometryFile), CliError> {
    let (fundamental, file) = GeometryFile::read_geometry(path)?;
    tell_remarks(path, &file.remarks);
    if file.pictures.is_undistorted() && !is_calibrated {
        return Err(CliError::Arguments(format!(
            "{} belongs to pictures without distortion ({}). Give the calibration or \
             the distortion that it was made with (--calibration, --division)",
            shown_path(path),
            lenses_in_words(&file.pictures)
        )));
    }
    Ok((fundamental, file))
}

/// Returns the views that a result belongs to, with the given cameras. Refuses a result of other pictures.
fn of_result(views: &ViewPair, of_file: &PicturesOf, path: &Path) -> Result<ViewPair, CliError> {
    let path = shown_path(path);
    let given = PicturesOf::from(Some(views));
    match (of_file, of_file.views()) {
        (PicturesOf::Untold | PicturesOf::Undistorted(None), _) if given.is_undistorted() => {
            tell(format_args!(
                "note: {path} does not tell its lens. It is read as a geometry of the pictures without distortion ({})",
                lenses_in_words(&given)
            ));
            Ok(*views)
        }
        (PicturesOf::Original, _) if given.is_undistorted() => Err(CliError::Arguments(format!(
            "{path} belongs to the pictures as they are, and not to pictures without distortion. Leave out the lens, or \
             give a result that was made with it"
        ))),
        (_, Some(described)) => views.adopting(described).ok_or_else(|| {
            let given = if given.is_undistorted() { lenses_in_words(&given) } else { "no distortion".to_owned() };
            CliError::Arguments(format!(
                "{path} was made with another lens: {}, and the given one has {given}. Give the calibration of the \
                 result",
                lenses_in_words(of_file)
            ))
        }),
        _ => Ok(*views),
    }
}

/// Describes a pair for a stereo program in words.
fn stereo_summary(made: &Rectification, pair: &StereoPair, files: &StereoPairFiles) -> String {
    let mut text = format!("Pictures: {} x {} px\n", made.size.width, made.size.height);
    let k = &pair.rig.calibration;
    let _ = writeln!(
        text,
        "Focal length {:.2} px, principal point ({:.2}, {:.2}) px",
        k[(0, 0)],
        k[(0, 2)],
        k[(1, 2)]
    );
    let _ = match pair.baseline {
        Some(length) => writeln!(text, "Baseline {length} in the unit of the calibration"),
        None => writeln!(text, "Baseline unknown, written as 1: depths are in units of the baseline"),
    };
    if pair.rig.is_exchanged {
        text.push_str("Image 2 was taken from the left of image 1, so it is the left picture\n");
    }
    if let Some(rows) = made.measures.rows {
        let _ = writeln!(text, "Row error of {} matches: {:.3} px on average", rows.matches, rows.mean);
    }
    for path in files.paths() {
        let _ = writeln!(text, "Wrote {}", shown_path(&path));
    }
    text
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
        let _ = writeln!(text, "Warning: {warning}");
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
