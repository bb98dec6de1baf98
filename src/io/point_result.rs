//! Result of points without pictures, as a file for scripts and as text for people. The JSON has the names of
//! a result of pictures, without the fields of pictures.

use std::fmt::Write;

use serde::Serialize;

use super::geometry_file::{Format, ImageNote};
use super::result_file::{CalibratedFile, Told, camera_warnings, nested};
use super::result_words::matrix_in_words;
use crate::camera::{Baseline, PicturesOf, PoseFit, ViewPair};
use crate::estimate::{
    Determined, EpipoleBearing, PlaneHomography, PointEstimate, Reason, Uncertainty, Verdict,
};
use crate::geometry::{Frame, FundamentalMatrix, PointPair, finite_point, median, sampson_distance};
use crate::presentation::{epipole_in_words, reason_in_words, warning_in_words};

/// Content of a result file of points without pictures. As JSON it is also a geometry file.
#[derive(Serialize)]
pub struct PointResultFile<'a> {
    convention: Vec<String>,
    /// Pictures that the coordinates belong to.
    #[serde(flatten)]
    pictures: PicturesOf,
    /// Fundamental matrix as nested rows, `x2ᵀ F x1 = 0`.
    fundamental: &'a FundamentalMatrix,
    epipole1: [f64; 3],
    epipole2: [f64; 3],
    verdict: Option<Verdict>,
    #[serde(skip_serializing_if = "Option::is_none")]
    determined: Option<Determined>,
    #[serde(skip_serializing_if = "Option::is_none")]
    epipole_bearings: Option<[EpipoleBearing; 2]>,
    reasons: Vec<String>,
    failed_tests: &'a [Reason],
    /// Covariance of the nine entries of `fundamental`, row by row, px.
    #[serde(skip_serializing_if = "Option::is_none")]
    covariance: Option<[[f64; 9]; 9]>,
    /// Half of the right matches have a smaller Sampson distance, px.
    noise: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    homography21: Option<[[f64; 3]; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneHomography>,
    /// Matches that are likelier right than wrong.
    matches: Vec<AgreeingMatch>,
    seed: u64,
    /// Sizes of the images, if they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    images: Option<[ImageNote; 2]>,
    /// Width and height of the extent of the points, in place of the sizes.
    #[serde(skip_serializing_if = "Option::is_none")]
    extents: Option<[Frame; 2]>,
    /// All matches, `x1 y1 x2 y2`.
    given_matches: Vec<[f64; 4]>,
    /// Sampson distance of each match, px.
    given_distances: Vec<f64>,
    /// Probability that each match is right, 0 to 1.
    given_probabilities: &'a [f64],
    #[serde(skip_serializing_if = "Option::is_none")]
    calibrated: Option<CalibratedFile<'a>>,
    warnings: Vec<Told<'a>>,
    version: &'static str,
}

#[derive(Serialize)]
struct AgreeingMatch {
    /// Coordinates `x1 y1 x2 y2`, px.
    pair: [f64; 4],
    /// Sampson distance from the result, px.
    residual: f64,
}

impl<'a> PointResultFile<'a> {
    /// Creates the file of a result of `given` matches. `are_sizes` says whether the sizes of the images are
    /// known.
    pub fn new(found: &'a PointEstimate, given: &[PointPair], are_sizes: bool, seed: u64) -> Self {
        let (estimate, frames) = (&found.estimate, found.frames);
        let fundamental = estimate.fundamental();
        let trust = estimate.assessment.trust.as_ref();
        let plane = estimate.assessment.plane;
        let residual = |pair: &PointPair| sampson_distance(fundamental, pair);
        let agreeing = estimate.matches().iter().map(|m| m.pair);
        let note = |k: usize| ImageNote::new(format!("image {}", k + 1), frames[k]);
        Self {
            convention: Format::Json.convention(),
            pictures: PicturesOf::Original,
            fundamental,
            epipole1: fundamental.epipole1().into(),
            epipole2: fundamental.epipole2().into(),
            verdict: trust.map(|trust| trust.verdict),
            determined: found.determined,
            epipole_bearings: found.bearings,
            reasons: trust.iter().flat_map(|trust| trust.reasons.iter().map(reason_in_words)).collect(),
            failed_tests: trust.map_or(&[], |trust| &trust.reasons),
            covariance: estimate.uncertainty().map(Uncertainty::covariance).map(|c| nested(&c)),
            noise: estimate.assessment.refinement.as_ref().and_then(|refinement| refinement.noise),
            homography21: plane.map(|plane| nested(&plane.homography21)),
            plane,
            matches: agreeing
                .map(|pair| AgreeingMatch { pair: pair.numbers(), residual: residual(&pair) })
                .collect(),
            seed,
            images: are_sizes.then(|| [note(0), note(1)]),
            extents: (!are_sizes).then_some(frames),
            given_matches: given.iter().map(PointPair::numbers).collect(),
            given_distances: given.iter().map(residual).collect(),
            given_probabilities: &found.inlier_probabilities,
            calibrated: None,
            warnings: estimate.assessment.warnings.iter().map(Told::of_result).collect(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// Adds the views without distortion that the result belongs to, and the pose.
    #[must_use]
    pub fn calibrated(
        mut self,
        views: &'a ViewPair,
        pose: Option<&PoseFit>,
        baseline: Option<Baseline>,
    ) -> Self {
        let of = |numbers: &[f64; 4]| PointPair::new(numbers[0], numbers[1], numbers[2], numbers[3]);
        let matches: Vec<PointPair> = self.matches.iter().map(|m| of(&m.pair)).collect();
        self.calibrated = Some(CalibratedFile::new(views, self.fundamental, [&[], &matches], pose, baseline));
        self.warnings.extend(camera_warnings(views));
        self.pictures = PicturesOf::from(Some(views));
        self
    }
}

/// Describes a result of points without pictures in words.
pub fn points_in_words(found: &PointEstimate, given: &[PointPair], are_sizes: bool) -> String {
    let estimate = &found.estimate;
    let fundamental = estimate.fundamental();
    let mut text = String::from("Fundamental matrix F (x2ᵀ F x1 = 0):\n");
    text += &matrix_in_words(fundamental.rows());
    for (k, epipole) in [fundamental.epipole1(), fundamental.epipole2()].iter().enumerate() {
        let place = match finite_point(epipole) {
            Some(p) => format!("({:.2}, {:.2}) px", p.x, p.y),
            None => "infinitely far".to_owned(),
        };
        let bearing = found.bearings.as_ref().map(|bearings| &bearings[k]);
        let interval = epipole_in_words(bearing, found.determined);
        let interval = interval.map_or_else(String::new, |interval| format!("; {interval}"));
        let _ = writeln!(text, "Epipole in image {}: {place}{interval}", k + 1);
    }
    if let Some(trust) = &estimate.assessment.trust {
        let _ = writeln!(text, "Verdict: {}", trust.verdict.label());
        for reason in &trust.reasons {
            let _ = writeln!(text, "  {}", reason_in_words(reason));
        }
    }
    if let Some(plane) = &estimate.assessment.plane {
        let _ = writeln!(
            text,
            "Homography of the plane (x2 ∝ H x1), {:.2} px from {} of the agreeing matches ({:.0} %):",
            plane.residual,
            plane.matches,
            100.0 * plane.share
        );
        text += &matrix_in_words(nested(&plane.homography21));
    }
    for warning in &estimate.assessment.warnings {
        let _ = writeln!(text, "Warning: {}", warning_in_words(warning));
    }
    let agreeing = estimate.matches();
    if !agreeing.is_empty() {
        let off = median(agreeing.iter().map(|m| sampson_distance(fundamental, &m.pair)));
        let _ = writeln!(
            text,
            "Given matches: {} of {} agree, {off:.3} px from their epipolar lines (median)",
            agreeing.len(),
            given.len()
        );
    }
    let matched = estimate.matched_pairs();
    if let Some(deviation) = estimate.uncertainty().and_then(|u| u.median_line2_deviation(&matched)) {
        let _ = writeln!(text, "Standard deviation of the lines at the matches: {deviation:.2} px (median)");
    }
    if !are_sizes {
        let [a, b] = found.frames;
        let _ = writeln!(
            text,
            "Image sizes are unknown. The extents of the points take their place: {}×{} and {}×{} px",
            a.width, a.height, b.width, b.height
        );
    }
    text
}
