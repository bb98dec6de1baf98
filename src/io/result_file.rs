//! Result of an estimate as a file for scripts.

use nalgebra::SMatrix;
use serde::Serialize;

use super::geometry_file::{Format, ImageNote, PairLabel, TrustNote};
use crate::camera::{Baseline, CameraDoubt, PicturesOf, PoseFit, UndistortedView, ViewPair};
use crate::estimate::{
    BarcodeFigures, Case, Determined, EpipoleBearing, Estimate, LineBands, LineEvidence, Method, Origin,
    Parameters, PatchSupport, PlaneHomography, Preset, Reason, SearchCounts, StageTiming, Warning,
};
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance, symmetric_epipolar_distance};
use crate::presentation::{camera_doubts, pictures_in_words, reason_in_words, warning_in_words};

/// Content of a result file. As JSON it is also a geometry file ([`Format::Json`]).
#[derive(Serialize)]
pub struct ResultFile<'a> {
    /// Convention of the numbers.
    convention: Vec<String>,
    /// Pictures that the coordinates belong to. `calibrated` has the views without distortion.
    pictures: Option<&'static str>,
    /// What the geometry is.
    geometry: &'static str,
    /// Fundamental matrix as nested rows, `x2ᵀ F x1 = 0`.
    fundamental: &'a FundamentalMatrix,
    epipole1: [f64; 3],
    epipole2: [f64; 3],
    score: Option<f64>,
    round_trip_area: Option<f64>,
    margin: Option<f64>,
    refined_margin: Option<f64>,
    support: Option<PatchSupport>,
    /// Evidence of motion barcodes, if sequences were compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    barcodes: Option<BarcodeFigures>,
    /// Frame offset: frame `k` of the first sequence and frame `k + frame_offset` of the second are
    /// simultaneous.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame_offset: Option<i32>,
    /// Outcome of the tests, or the word of the window.
    verdict: Option<serde_json::Value>,
    /// The verdict in words, with the reasons that a person is told.
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict_in_words: Option<String>,
    /// Probability that the lines are within 1 % of the longer side.
    #[serde(skip_serializing_if = "Option::is_none")]
    probability_within_one_percent: Option<f64>,
    /// Evidence from which the probability follows.
    #[serde(skip_serializing_if = "Option::is_none")]
    line_evidence: Option<LineEvidence>,
    /// Part of the geometry that the matches determine.
    #[serde(skip_serializing_if = "Option::is_none")]
    determined: Option<Determined>,
    /// Direction and distance of both epipoles, with 95 % intervals.
    #[serde(skip_serializing_if = "Option::is_none")]
    epipole_bearings: Option<[EpipoleBearing; 2]>,
    /// Half widths of the 95 % bands of lines all over the pictures, px.
    #[serde(skip_serializing_if = "Option::is_none")]
    line_bands: Option<LineBands>,
    reasons: Vec<String>,
    /// Failed tests with their figures, in the order of `reasons`.
    failed_tests: &'a [Reason],
    /// Figures that the verdict rests on.
    #[serde(skip_serializing_if = "Option::is_none")]
    figures: Option<&'a Case>,
    /// Covariance of the nine entries of `fundamental`, row by row, px.
    #[serde(skip_serializing_if = "Option::is_none")]
    covariance: Option<[[f64; 9]; 9]>,
    /// Half of the right matches have a smaller Sampson distance, px.
    #[serde(skip_serializing_if = "Option::is_none")]
    noise: Option<f64>,
    /// Homography as nested rows, `x2 ∝ H x1`, if the verdict says that only a plane is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    homography21: Option<[[f64; 3]; 3]>,
    /// Fit of this homography.
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneHomography>,
    /// Data from which the geometry was proposed, before its refinement.
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<Origin>,
    refined: bool,
    matches: Vec<MatchFile>,
    method: Method,
    preset: Preset,
    seed: u64,
    seconds: Option<f64>,
    first_seconds: Option<f64>,
    timings: &'a [StageTiming],
    counts: Option<&'a SearchCounts>,
    warnings: Vec<Told<'a>>,
    images: &'a [ImageNote; 2],
    /// Given pairs, `x1 y1 x2 y2`.
    pairs: Vec<[f64; 4]>,
    /// Symmetric epipolar distance of every pair given, px.
    pair_distances: Vec<f64>,
    /// Matches from elsewhere, `x1 y1 x2 y2`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    given_matches: Vec<[f64; 4]>,
    /// Sampson distance of each match from elsewhere, px.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    given_distances: Vec<f64>,
    /// Matches used in place of clicks, `x1 y1 x2 y2`.
    chosen: Vec<[f64; 4]>,
    /// Names of the pairs, if known; empty for a pair without a name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pair_names: Vec<String>,
    /// Origins of the pairs, if known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pair_origins: Vec<&'static str>,
    /// Cameras and pose, if a calibration was given. All other coordinates then belong to the views
    /// without distortion.
    #[serde(skip_serializing_if = "Option::is_none")]
    calibrated: Option<CalibratedFile<'a>>,
    /// How the calibration was read, and the numbers of it that were not understood.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    calibration_notes: &'a [String],
    parameters: &'a Parameters,
    version: &'static str,
}

/// Cameras of a result, and their relative pose.
#[derive(Serialize)]
pub(super) struct CalibratedFile<'a> {
    /// View without distortion of each image, with the lens of its camera.
    views: &'a [UndistortedView; 2],
    /// Given pairs in the pictures as they are, `x1 y1 x2 y2`; null beyond the range of a lens.
    original_pairs: Vec<Option<[f64; 4]>>,
    /// Matches in the pictures as they are, `x1 y1 x2 y2`, in the order of `matches`; null beyond the range
    /// of a lens.
    original_matches: Vec<Option<[f64; 4]>>,
    /// Mean distance of each match from its epipolar curves in the pictures as they are, px.
    curve_distances: Vec<Option<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pose: Option<PoseFile>,
    /// Distance between the cameras, if the calibration tells it.
    #[serde(skip_serializing_if = "Option::is_none")]
    baseline: Option<Baseline>,
}

/// Relative pose, `x2 = R x1 + t` with the length of `t` 1.
#[derive(Serialize)]
struct PoseFile {
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    /// `[t]× R`.
    essential: [[f64; 3]; 3],
    /// Fundamental matrix of the pose, between the views.
    fundamental: FundamentalMatrix,
    /// Angle of the rotation, radians.
    angle: f64,
    /// Median angle between the rays of a match, radians.
    parallax: f64,
    matches: usize,
    in_front: usize,
    /// Half of the matches have a smaller Sampson distance, px.
    noise: f64,
    /// Standard deviation of the rotation, radians.
    rotation_deviation: Option<f64>,
    /// Standard deviation of the direction of `t`, radians.
    translation_deviation: Option<f64>,
    /// Covariance of the rotation vector of a small turn after `R`, and of `t`.
    covariance: Option<[[f64; 6]; 6]>,
}

/// Match used by the refinement.
#[derive(Serialize)]
struct MatchFile {
    /// Coordinates `x1 y1 x2 y2`, px.
    pair: [f64; 4],
    /// Correlation of the two patches, −1 to 1.
    correlation: f32,
    /// Sampson distance from the result, px.
    residual: f64,
}

/// Warning with its message.
#[derive(Serialize)]
pub(super) struct Told<'a> {
    message: String,
    #[serde(flatten)]
    warning: AnyWarning<'a>,
}

impl<'a> Told<'a> {
    pub(super) fn of_result(warning: &'a Warning) -> Self {
        Self { message: warning_in_words(warning), warning: AnyWarning::Result(warning) }
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum AnyWarning<'a> {
    Result(&'a Warning),
    Camera(CameraDoubt),
}

/// Returns the doubts about the cameras of views.
pub(super) fn camera_warnings<'a>(views: &ViewPair) -> impl Iterator<Item = Told<'a>> {
    let doubts = camera_doubts(views.views.each_ref().map(|view| (view.camera(), view.original())));
    doubts.into_iter().map(|(doubt, message)| Told { message, warning: AnyWarning::Camera(doubt) })
}

impl<'a> ResultFile<'a> {
    /// Gives the verdict in the words of the window. A partly reliable result has passed all tests, so its reasons
    /// belong to none.
    #[must_use]
    pub fn told(mut self, note: &TrustNote) -> Self {
        self.verdict_in_words = Some(note.in_words());
        if self.failed_tests.is_empty() {
            (self.verdict, self.reasons) = (Some(note.verdict.clone().into()), note.reasons.clone());
        }
        self
    }

    /// Creates the file of a result for coordinates of these pictures. `pairs` may contain more pairs than the
    /// estimate used.
    pub fn new(
        found: &'a Estimate,
        pairs: &[PointPair],
        images: &'a [ImageNote; 2],
        parameters: &'a Parameters,
        pictures: &PicturesOf,
    ) -> Self {
        let (assessment, trace) = (&found.assessment, found.trace.as_deref());
        let trust = assessment.trust.as_ref();
        let refinement = assessment.refinement.as_ref();
        let frames = images.each_ref().map(|image| image.frame);
        Self {
            convention: [Format::Json.convention(), pictures_in_words(pictures, 0.0)].concat(),
            pictures: pictures.name(),
            geometry: TrustNote::RESULT,
            fundamental: found.fundamental(),
            epipole1: found.fundamental().epipole1().into(),
            epipole2: found.fundamental().epipole2().into(),
            score: found.line_score(),
            round_trip_area: assessment.lines.as_ref().and_then(|lines| lines.round_trip_area),
            margin: assessment.margin,
            refined_margin: assessment.refined_margin,
            support: assessment.support,
            barcodes: assessment.barcodes,
            frame_offset: None,
            verdict: trust.and_then(|t| serde_json::to_value(t.verdict).ok()),
            verdict_in_words: TrustNote::of(found, frames).map(|note| note.in_words()),
            probability_within_one_percent: assessment.probability_within_one_percent(),
            line_evidence: assessment.line_evidence,
            determined: found.determined(frames),
            epipole_bearings: found.epipole_bearings(frames),
            line_bands: found.line_bands(frames),
            reasons: trust.iter().flat_map(|t| t.reasons.iter().map(reason_in_words)).collect(),
            failed_tests: trust.map_or(&[], |t| &t.reasons),
            figures: assessment.case.as_deref(),
            covariance: refinement
                .and_then(|r| r.uncertainty.as_ref())
                .map(|uncertainty| nested(&uncertainty.covariance())),
            noise: refinement.and_then(|r| r.noise),
            homography21: assessment.plane.map(|plane| nested(&plane.homography21)),
            plane: assessment.plane,
            origin: found.origin,
            refined: found.is_refined(),
            matches: found
                .matches()
                .iter()
                .map(|m| MatchFile {
                    pair: m.pair.numbers(),
                    correlation: m.correlation,
                    residual: sampson_distance(found.fundamental(), &m.pair),
                })
                .collect(),
            method: parameters.method,
            preset: parameters.preset,
            seed: parameters.seed,
            seconds: trace.map(|t| t.seconds),
            first_seconds: trace.map(|t| t.first_seconds),
            timings: trace.map_or(&[], |t| &t.timings),
            counts: trace.map(|t| &t.counts),
            warnings: assessment.warnings.iter().map(Told::of_result).collect(),
            images,
            pairs: pairs.iter().map(PointPair::numbers).collect(),
            pair_distances: pairs
                .iter()
                .map(|p| symmetric_epipolar_distance(found.fundamental(), p))
                .collect(),
            given_matches: Vec::new(),
            given_distances: Vec::new(),
            chosen: trace
                .map_or_else(Vec::new, |t| t.clicks.chosen().iter().map(PointPair::numbers).collect()),
            pair_names: Vec::new(),
            pair_origins: Vec::new(),
            calibrated: None,
            calibration_notes: &[],
            parameters,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// Adds the time offset between the sequences.
    #[must_use]
    pub fn at_offset(mut self, offset: Option<i32>) -> Self {
        self.frame_offset = offset;
        self
    }

    /// Adds matches from elsewhere, with their distances from the result.
    #[must_use]
    pub fn with_given(mut self, matches: &[PointPair]) -> Self {
        self.given_distances = matches.iter().map(|pair| sampson_distance(self.fundamental, pair)).collect();
        self.given_matches = matches.iter().map(PointPair::numbers).collect();
        self
    }

    /// Adds the views without distortion that the result belongs to, the pose, and the known
    /// distance between the cameras.
    #[must_use]
    pub fn calibrated(
        mut self,
        views: &'a ViewPair,
        pose: Option<&PoseFit>,
        baseline: Option<Baseline>,
    ) -> Self {
        let pairs: Vec<PointPair> = self.pairs.iter().map(from_numbers).collect();
        let matches: Vec<PointPair> = self.matches.iter().map(|found| from_numbers(&found.pair)).collect();
        self.calibrated =
            Some(CalibratedFile::new(views, self.fundamental, [&pairs, &matches], pose, baseline));
        self.warnings.extend(camera_warnings(views));
        self
    }

    /// Adds sentences about how the calibration was read.
    #[must_use]
    pub fn with_notes(mut self, notes: &'a [String]) -> Self {
        self.calibration_notes = notes;
        self
    }

    /// Adds the names and origins of the pairs, in their order.
    #[must_use]
    pub fn labelled(mut self, labels: &[PairLabel]) -> Self {
        self.pair_names = labels.iter().map(|label| label.name.clone()).collect();
        self.pair_origins = labels.iter().map(|label| label.origin.name()).collect();
        self
    }
}

impl<'a> CalibratedFile<'a> {
    /// Creates the calibrated part of a result with these pairs and matches in the views.
    pub(super) fn new(
        views: &'a ViewPair,
        fundamental: &FundamentalMatrix,
        [pairs, matches]: [&[PointPair]; 2],
        pose: Option<&PoseFit>,
        baseline: Option<Baseline>,
    ) -> Self {
        let original = |pair: &PointPair| views.original_from_undistorted(pair).map(|pair| pair.numbers());
        Self {
            original_pairs: pairs.iter().map(original).collect(),
            original_matches: matches.iter().map(original).collect(),
            curve_distances: matches
                .iter()
                .map(|pair| views.distance_from_curves(fundamental, pair))
                .collect(),
            views: &views.views,
            pose: pose.map(PoseFile::new),
            baseline,
        }
    }
}

impl PoseFile {
    fn new(fit: &PoseFit) -> Self {
        let PoseFit { pose, fundamental, noise, matches, in_front, parallax, uncertainty } = fit;
        Self {
            rotation: nested(pose.rotation.matrix()),
            translation: pose.translation.into(),
            essential: nested(&pose.essential()),
            fundamental: *fundamental,
            angle: pose.angle(),
            parallax: *parallax,
            matches: *matches,
            in_front: *in_front,
            noise: *noise,
            rotation_deviation: uncertainty.map(|u| u.rotation),
            translation_deviation: uncertainty.map(|u| u.translation),
            covariance: fit.covariance().map(|covariance| nested(&covariance)),
        }
    }
}

fn from_numbers([x1, y1, x2, y2]: &[f64; 4]) -> PointPair {
    PointPair::new(*x1, *y1, *x2, *y2)
}

/// Returns the rows of a matrix.
pub(super) fn nested<const N: usize>(matrix: &SMatrix<f64, N, N>) -> [[f64; N]; N] {
    matrix.transpose().data.0
}
