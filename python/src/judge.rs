//! Judgements of a geometry from elsewhere, and of rectified pictures.

use std::path::PathBuf;

use epiline::estimate::{EstimateError, Match, Monitor, Parameters};
use epiline::geometry::{Camera, FundamentalMatrix, Matrix9};
use epiline::io::CalibratedCamera;
use epiline::judge::{
    FEWEST_MATCHES, Finding, GivenCalibration, GivenGeometry, LIMIT, ROW_LIMIT, judge_rows,
};
use epiline::presentation::{judgement_in_words, pose_difference_in_words, rows_in_words};
use epiline::study::{Question, ShownGeometry, Study, matches_in};
use nalgebra::Matrix3x4;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::arrays::{self, covariance_of, fundamental_of, pictures_of};
use crate::cameras::{GivenCameras, KnownCameras};
use crate::errors::{input, of_estimate};
use crate::estimate::given_of;
use crate::search::{Threads, watched};

/// What the pictures say about a geometry.
#[pyclass(frozen, module = "epiline")]
pub struct Judgement {
    /// "fits", "does-not-fit" or "undecided".
    #[pyo3(get)]
    finding: &'static str,
    /// The judgement in sentences.
    #[pyo3(get)]
    message: String,
    reference: FundamentalMatrix,
    corrected: Option<FundamentalMatrix>,
    /// Verdict on the geometry that the images show; `None` for given matches.
    #[pyo3(get)]
    reference_verdict: Option<&'static str>,
    /// How the file of a calibration was read, and doubts about it, in sentences.
    #[pyo3(get)]
    remarks: Vec<String>,
    record: Value,
}

#[pymethods]
impl Judgement {
    /// Whether the geometry fits; `None` if the images do not tell.
    #[getter]
    fn fits(&self) -> Option<bool> {
        match self.finding {
            "undecided" => None,
            finding => Some(finding == "fits"),
        }
    }

    /// Matrix of shape (3, 3) that the images or the matches show. With the file of a calibration, it belongs to the
    /// images without distortion.
    #[getter]
    fn reference<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::matrix3(py, self.reference.matrix())
    }

    /// The judged matrix after the change that makes it fit, of shape (3, 3), if there is one.
    #[getter]
    fn corrected<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        Some(arrays::matrix3(py, self.corrected.as_ref()?.matrix()))
    }

    /// Return all figures of the judgement as JSON.
    fn to_json(&self) -> String {
        format!("{:#}", self.record)
    }

    fn __repr__(&self) -> String {
        format!("<epiline.Judgement: {}>", self.finding)
    }
}

/// Cameras to judge: projection matrices, or one or two files of a calibration.
#[derive(FromPyObject)]
pub enum JudgedCameras<'py> {
    // First, as the extraction of arrays ends at a sequence of another length.
    Files(Vec<PathBuf>),
    Projections([PyReadonlyArray2<'py, f64>; 2]),
}

/// A failed search for the geometry of the pictures or of the matches.
enum Failure {
    Search(EstimateError),
    Matches(String),
}

impl Failure {
    fn raised(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Search(error) => of_estimate(py, &error),
            Self::Matches(problem) => input(py, problem),
        }
    }
}

#[pyfunction]
#[pyo3(signature = (image1, image2, fundamental, cameras, matches, covariance, rectified, limit, seed, threads, progress))]
pub fn judge(
    py: Python<'_>,
    image1: &Bound<'_, PyAny>,
    image2: &Bound<'_, PyAny>,
    fundamental: Option<PyReadonlyArray2<'_, f64>>,
    cameras: Option<JudgedCameras<'_>>,
    matches: Option<&Bound<'_, PyDict>>,
    covariance: Option<PyReadonlyArray2<'_, f64>>,
    rectified: bool,
    limit: Option<f64>,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Judgement> {
    let judged = usize::from(fundamental.is_some()) + usize::from(cameras.is_some()) + usize::from(rectified);
    if judged != 1 {
        return Err(input(py, "give one geometry to judge: F, cameras or rectified=True"));
    }
    if limit.is_some_and(|limit| !(limit > 0.0 && limit.is_finite())) {
        return Err(input(py, "limit is a number of pixels above 0"));
    }
    let own: Option<Matrix9> = covariance.map(|numbers| covariance_of(py, &numbers)).transpose()?;
    if own.is_some() && fundamental.is_none() {
        return Err(input(py, "a covariance belongs to F"));
    }
    let (mut given_matches, _) = given_of(py, matches)?;
    let threads = Threads::given(py, threads)?;
    let mut study = Study::of_pictures(pictures_of(image1, image2, &threads)?);
    let mut remarks = Vec::new();
    let given = match (fundamental, cameras) {
        (Some(matrix), _) => Some(GivenGeometry::from(fundamental_of(py, &matrix, Some(study.frames()))?)),
        (None, Some(JudgedCameras::Projections(cameras))) => Some(of_cameras(py, &cameras)?),
        (None, Some(JudgedCameras::Files(files))) => {
            let (geometry, known) = of_files(py, files, &study, given_matches.as_deref(), &threads)?;
            given_matches = given_matches
                .map(|matches| matches_in(&known.views, &matches))
                .transpose()
                .map_err(|error| input(py, error.to_string()))?;
            // The cameras are judged, so they take no part in the search.
            study = study.with_views(known.views).drawn_in(None);
            remarks = known.notes.into_iter().chain(known.doubts).collect();
            Some(geometry)
        }
        (None, None) => None,
    };
    let frames = study.frames();
    let search = |seed: u64, monitor: &Monitor| {
        if let Some(matches) = &given_matches {
            let problem = |error| Failure::Matches(format!("the matches cannot be used: {error}"));
            return ShownGeometry::of_matches(matches, frames, seed).map_err(problem);
        }
        let parameters = Parameters { seed, ..Parameters::default() };
        let question = Question { clicks: &[], given: None, parameters: &parameters };
        study.solve(&question, monitor).map(|found| ShownGeometry::from(&found)).map_err(Failure::Search)
    };
    let work = |monitor: &Monitor| {
        let shown = search(seed, monitor)?;
        let found = match &given {
            Some(given) => {
                let again = || search(seed.wrapping_add(1), monitor);
                let found = shown.judged((given, own.as_ref()), frames, limit.unwrap_or(LIMIT), again)?;
                found.map(|found| {
                    let corrected = found.change.as_ref().and_then(|change| change.fundamental);
                    let mut record = serde_json::to_value(&found).unwrap_or_default();
                    let mut words = judgement_in_words(&found);
                    let calibration = given.calibration.as_ref();
                    let compared = calibration.and_then(|known| shown.compared_pose(&found, known));
                    if let Some(compared) = &compared {
                        let difference = compared.difference.as_ref();
                        words = format!("{words}\n{}", pose_difference_in_words(difference));
                        record["pose_difference"] = serde_json::to_value(difference).unwrap_or_default();
                    }
                    (found.finding, words, record, corrected)
                })
            }
            None => judge_rows(&shown.rows(), frames[1], limit.unwrap_or(ROW_LIMIT)).map(|found| {
                let finding = match (found.is_aligned, found.doubt) {
                    (true, _) => Finding::Fits,
                    (false, None) => Finding::DoesNotFit,
                    (false, Some(_)) => Finding::Undecided,
                };
                let record = serde_json::to_value(found).unwrap_or_default();
                (finding, rows_in_words(&found), record, None)
            }),
        };
        Ok::<_, Failure>((shown, found))
    };
    let (shown, found) = watched(py, &threads, progress, work)?.map_err(|failure| failure.raised(py))?;
    let (finding, message, record, corrected) = found.ok_or_else(|| {
        let count = shown.matches.len();
        input(py, format!("there are only {count} matches, and a judgement needs {FEWEST_MATCHES}. Give matches of your own"))
    })?;
    let finding = match finding {
        Finding::Fits => "fits",
        Finding::DoesNotFit => "does-not-fit",
        Finding::Undecided => "undecided",
    };
    let reference_verdict = shown.verdict.map(epiline::estimate::Verdict::label);
    Ok(Judgement {
        finding,
        message,
        reference: shown.fundamental,
        corrected,
        reference_verdict,
        remarks,
        record,
    })
}

/// Returns the geometry of the files of a calibration in views without distortion, with its cameras.
fn of_files(
    py: Python<'_>,
    files: Vec<PathBuf>,
    study: &Study,
    matches: Option<&[Match]>,
    threads: &Threads,
) -> PyResult<(GivenGeometry, KnownCameras)> {
    let pairs = || match matches {
        Some(given) => given.iter().map(|found| found.pair).collect(),
        None => study.putative_pairs(),
    };
    let known = GivenCameras::Files(files).known(py, threads, study.frames(), pairs)?;
    let calibration = known.pose.map(|pose| GivenCalibration { pose, views: known.views });
    let geometry = calibration.and_then(|calibration| calibration.geometry()).ok_or_else(|| {
        let told = CalibratedCamera::without_pose(&known.notes);
        input(py, format!("{told} To judge a matrix, give F"))
    })?;
    Ok((geometry, known))
}

/// Returns the geometry of two projection matrices.
fn of_cameras(py: Python<'_>, cameras: &[PyReadonlyArray2<'_, f64>; 2]) -> PyResult<GivenGeometry> {
    let mut both = Vec::new();
    for (k, matrix) in cameras.iter().enumerate() {
        let matrix = matrix.as_array();
        let camera = (matrix.shape() == [3, 4])
            .then(|| Matrix3x4::from_fn(|row, column| matrix[[row, column]]))
            .and_then(Camera::from_matrix);
        both.push(camera.ok_or_else(|| {
            input(py, format!("camera {} is no projection matrix of 3×4 finite numbers and rank 3", k + 1))
        })?);
    }
    let cameras = [both[0], both[1]];
    let fundamental = Camera::fundamental(&cameras[0], &cameras[1])
        .ok_or_else(|| input(py, "the cameras have the same centre, so they have no epipolar geometry"))?;
    Ok(GivenGeometry { cameras: Some(cameras), ..fundamental.into() })
}
