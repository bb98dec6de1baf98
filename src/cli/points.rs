//! `epiline estimate --matches FILE` without images.

use std::path::Path;

use super::CliError;
use super::arguments::on_threads;
use super::calibration::{settled_by, views};
use super::console::tell;
use super::estimate_arguments::EstimateArguments;
use super::geometry_file::read_matches;
use super::result_output::{relative_pose_in_words, with_views};
use crate::camera::PicturesOf;
use crate::estimate::{PointEstimate, Preset, Uncertainty};
use crate::geometry::{Frame, PointPair};
use crate::io::{
    CalibratedCamera, GeometryFile, ImageNote, PairLabel, PairOrigin, PointResultFile, TrustNote,
    points_in_words,
};
use crate::study::{PointStudy, PoseOutcome};

/// Colour of a scene point without a picture.
const GREY: [u8; 3] = [128; 3];

/// Fits F to matches alone, writes the files and prints the summary.
pub(super) fn run(arguments: &EstimateArguments, path: &Path) -> Result<(), CliError> {
    refuse_pictures(arguments)?;
    let cameras = &arguments.cameras;
    let inputs: Vec<&Path> = cameras.calibration.files().chain([path]).collect();
    let output = arguments.result.prepare(&inputs)?;
    let calibrated = cameras.calibration.read()?;
    let given = read_matches(path)?;
    let sizes = match arguments.sizes.as_deref() {
        Some([both]) => Some([*both; 2]),
        Some([left, right]) => Some([*left, *right]),
        _ => None,
    };
    let known = sizes.or_else(|| sizes_of(calibrated.as_ref()?));
    let mut study = PointStudy::of_points(given, known)?;
    let mut of_cameras = None;
    if cameras.is_given() {
        let unknown = "the sizes of the images are needed for the cameras. Give them (--sizes WIDTHxHEIGHT)";
        let known = known.ok_or_else(|| CliError::Arguments(unknown.into()))?;
        let found = cameras.of_frames(calibrated, known, [None; 2], None)?;
        let pairs = || study.matches().iter().map(|m| m.pair).collect();
        of_cameras = found.map(|found| settled_by(found, known, pairs)).transpose()?;
    }
    let baseline = of_cameras.as_ref().and_then(CalibratedCamera::baseline);
    if let Some((cameras, known)) = of_cameras.zip(known) {
        study = study.with_views(views(&cameras, known)?)?;
        let (left_out, all) = (study.left_out(), study.matches().len() + study.left_out());
        if left_out > 0 {
            tell(format_args!(
                "warning: {left_out} of {all} matches lie beyond the range of a lens and are left out"
            ));
        }
    }
    let (frames, views) = (study.frames(), study.views());
    let seed = arguments.seed.unwrap_or_default();
    let found = on_threads(arguments.threads, || study.solve(seed))??;
    let pairs: Vec<PointPair> = study.matches().iter().map(|m| m.pair).collect();
    let mut result = PointResultFile::new(&found, &pairs, frames.is_some(), seed);
    let mut words = points_in_words(&found, &pairs, frames.is_some());
    let matched = found.estimate.matched_pairs();
    let pose = views.map(|views| PoseOutcome::new(&found.estimate, views));
    if let Some((views, pose)) = views.zip(pose.as_ref()) {
        result = result.calibrated(views, pose.fit(), baseline);
        words += &relative_pose_in_words(pose);
        if views.is_undistorted() {
            words += "All coordinates belong to the views without distortion\n";
        }
    }
    let determined = pose.as_ref().and_then(PoseOutcome::determined);
    output.write_points(&result, &words, found.estimate.says_one_plane(), || {
        let file = exported(&found, &pairs, frames, PicturesOf::from(views));
        let Some(views) = views else { return file };
        with_views(file, views, determined, baseline, &matched, |_| GREY)
    })
}

/// Refuses options that need images.
fn refuse_pictures(arguments: &EstimateArguments) -> Result<(), CliError> {
    let needs = [
        (
            !arguments.pairs.is_empty(),
            "--pair adds a click to the images. Add the pair to the file of the matches",
        ),
        (
            !arguments.overrides.is_default()
                || arguments.method.is_some()
                || arguments.preset != Preset::default(),
            "--preset, --method, --refine and --set change the search in the images. Leave them out",
        ),
        (arguments.cameras.fits_lens(), "--division auto fits the lens to the images. Give a coefficient"),
        (arguments.undistorted.is_some(), "--undistorted draws the images. Leave it out"),
        (
            arguments.cameras.asks_for_exif(),
            "--focal-length exif reads a photograph. Give a number of pixels",
        ),
    ];
    match needs.into_iter().find(|(is_given, _)| *is_given) {
        Some((_, advice)) => {
            Err(CliError::Arguments(format!("there are no images: {advice}, or give both images")))
        }
        None => Ok(()),
    }
}

/// Returns the sizes that a calibration tells.
fn sizes_of(cameras: &[CalibratedCamera; 2]) -> Option<[Frame; 2]> {
    Some([cameras[0].frame?, cameras[1].frame?])
}

/// Returns the content of the export.
fn exported(
    found: &PointEstimate,
    pairs: &[PointPair],
    sizes: Option<[Frame; 2]>,
    pictures: PicturesOf,
) -> GeometryFile {
    let estimate = &found.estimate;
    let label = || PairLabel { origin: PairOrigin::Imported, ..PairLabel::default() };
    let note = |frames: [Frame; 2]| [0, 1].map(|k| ImageNote::new(format!("image {}", k + 1), frames[k]));
    GeometryFile {
        fundamental: Some(*estimate.fundamental()),
        pairs: pairs.to_vec(),
        labels: pairs.iter().map(|_| label()).collect(),
        trust: estimate.assessment.trust.as_ref().map(TrustNote::from),
        images: sizes.map(note),
        homography21: estimate.assessment.plane.map(|plane| plane.homography21),
        covariance: estimate.uncertainty().map(Uncertainty::covariance),
        ..GeometryFile::of(pictures)
    }
}
