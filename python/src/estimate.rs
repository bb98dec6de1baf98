//! Results of searches and of fits to points.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use epiline::camera::{PicturesOf, PoseFit};
use epiline::estimate::{
    Estimate as Found, Match, Method, Monitor, Parameters, PointEstimate, Preset, Uncertainty,
};
use epiline::geometry::{Frame, Point, PointPair, Segment, fan, sampson_distance};
use epiline::image::Picture;
use epiline::internals::app::model::session::Work;
use epiline::internals::cli::with_parameter;
use epiline::io::{ImageNote, PointResultFile, ResultFile, SessionFile, points_in_words, result_in_words};
use epiline::presentation::reason_in_words;
use epiline::study::{PoseOutcome, Question, Study, StudyError, clicks_in, matches_in};
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::{self, Rows, matches_of, pairs_of, pictures_of};
use crate::cameras::{GivenCameras, KnownCameras};
use crate::errors::{input, no_geometry, of_estimate};
use crate::search::{Threads, watched};

/// Given matches of a search: a dictionary of arrays with the names of matchers.
pub fn given_of(
    py: Python<'_>,
    matches: Option<&Bound<'_, PyDict>>,
) -> PyResult<(Option<Vec<Match>>, Vec<String>)> {
    let read = matches.map(|arrays| matches_of(py, arrays)).transpose()?;
    let (given, remarks) = read.unzip();
    Ok((given, remarks.unwrap_or_default()))
}

/// Both ends of a segment, x and y, px.
type Ends = [[f64; 2]; 2];

/// Pictures or points that a result rests on.
pub enum Source {
    Pictures {
        study: Box<Study>,
        /// The pictures with their distortion.
        originals: [Arc<Picture>; 2],
        clicks: Vec<PointPair>,
        given: Vec<Match>,
        parameters: Box<Parameters>,
        /// Time offset of two sequences.
        offset: Option<i32>,
    },
    Points {
        frames: Option<[Frame; 2]>,
        given: Vec<PointPair>,
        probabilities: Vec<f64>,
        point: Box<PointEstimate>,
        seed: u64,
    },
}

/// A geometry with its evidence and its verdict.
#[pyclass(frozen, module = "epiline")]
pub struct Estimate {
    found: Found,
    source: Source,
    cameras: Option<KnownCameras>,
    pose: Option<PoseOutcome>,
    remarks: Vec<String>,
    /// The result as JSON, made at the first request.
    json: Mutex<Option<String>>,
}

impl Estimate {
    pub fn new(found: Found, source: Source, cameras: Option<KnownCameras>, remarks: Vec<String>) -> Self {
        let pose = cameras.as_ref().map(|cameras| PoseOutcome::new(&found, &cameras.views));
        Self { found, source, cameras, pose, remarks, json: Mutex::default() }
    }

    fn pictures_of(&self) -> PicturesOf {
        PicturesOf::from(self.cameras.as_ref().map(|cameras| &cameras.views))
    }

    fn matches(&self) -> Vec<PointPair> {
        self.found.matched_pairs()
    }

    /// Returns the pose that the matches determine.
    fn determined_pose(&self) -> Option<&PoseFit> {
        self.pose.as_ref().and_then(PoseOutcome::determined)
    }

    fn written(&self) -> Result<String, serde_json::Error> {
        let pose = self.pose.as_ref().and_then(PoseOutcome::fit);
        match &self.source {
            Source::Pictures { study, clicks, given, parameters, offset, .. } => {
                let images = study.pictures().map(ImageNote::from);
                let pictures_of = self.pictures_of();
                let mut file = ResultFile::new(&self.found, clicks, &images, parameters, &pictures_of)
                    .at_offset(*offset);
                if !given.is_empty() {
                    let given: Vec<PointPair> = given.iter().map(|found| found.pair).collect();
                    file = file.with_given(&given);
                }
                if let Some(cameras) = &self.cameras {
                    file = file.with_notes(&cameras.notes).calibrated(&cameras.views, pose, cameras.baseline);
                }
                serde_json::to_string_pretty(&file)
            }
            Source::Points { frames, given, point, seed, .. } => {
                let mut file = PointResultFile::new(point, given, frames.is_some(), *seed);
                if let Some(cameras) = &self.cameras {
                    file = file.calibrated(&cameras.views, pose, cameras.baseline);
                }
                serde_json::to_string_pretty(&file)
            }
        }
    }
}

#[pymethods]
impl Estimate {
    /// Fundamental matrix of shape (3, 3), norm 1: `x2.T @ F @ x1 == 0`.
    #[getter(F)]
    fn fundamental<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::matrix3(py, self.found.fundamental().matrix())
    }

    /// Covariance of the nine entries of `F`, row by row, of shape (9, 9). `None` if the matches are too few.
    ///
    /// Neighbouring matches of pictures share their errors, so the matches of each of 3 × 3 regions of image 1 count as
    /// one. In a simulation with independent errors the deviations are too large: 2 times for 30 matches, 7 times for
    /// 200 and 10 times for 1,000.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let covariance = self.found.uncertainty().map(Uncertainty::covariance)?;
        Some(arrays::matrix_rows(py, 9, |row, column| covariance[(row, column)]))
    }

    /// Epipoles of image 1 and image 2 in homogeneous coordinates, of shape (2, 3), unit length.
    #[getter]
    fn epipoles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::epipoles(py, self.found.fundamental())
    }

    /// "reliable", "doubtful", "unreliable" or "different scenes". `None` if the result was not judged.
    #[getter]
    fn verdict(&self) -> Option<&'static str> {
        self.found.assessment.trust.as_ref().map(|trust| trust.verdict.label())
    }

    /// Probability that the lines are within 1 % of the longer side near the matches. `None` without images.
    #[getter]
    fn probability(&self) -> Option<f64> {
        match &self.source {
            Source::Pictures { .. } => self.found.assessment.probability_within_one_percent(),
            Source::Points { .. } => None,
        }
    }

    /// Why the result is not reliable, in sentences.
    #[getter]
    fn reasons(&self) -> Vec<String> {
        self.found.assessment.trust.iter().flat_map(|trust| &trust.reasons).map(reason_in_words).collect()
    }

    /// What the matches determine: "everything", "epipole-directions", "near-matches" or "lines".
    #[getter]
    fn determined(&self) -> Option<String> {
        let determined = match &self.source {
            Source::Pictures { study, .. } => self.found.determined(study.frames()),
            Source::Points { point, .. } => point.determined,
        };
        serde_json::to_value(determined?).ok()?.as_str().map(str::to_owned)
    }

    /// Matches that agree with `F`, in image 1, px, of shape (N, 2).
    #[getter]
    fn points1<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::points(py, self.matches().into_iter().map(|pair| pair.point1))
    }

    /// Matches that agree with `F`, in image 2, px, of shape (N, 2).
    #[getter]
    fn points2<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::points(py, self.matches().into_iter().map(|pair| pair.point2))
    }

    /// Sampson distances of the matches, px, of shape (N,).
    #[getter]
    fn residuals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let f = self.found.fundamental();
        PyArray1::from_iter(py, self.matches().iter().map(|pair| sampson_distance(f, pair)))
    }

    /// Whether each given match is likelier right than wrong, of shape (M,). `None` for images.
    #[getter]
    fn inliers<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<bool>>> {
        let Source::Points { probabilities, .. } = &self.source else { return None };
        Some(PyArray1::from_iter(py, probabilities.iter().map(|right| *right > 0.5)))
    }

    /// Probability that each given match is right, of shape (M,). `None` for images.
    #[getter]
    fn inlier_probabilities<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let Source::Points { probabilities, .. } = &self.source else { return None };
        Some(PyArray1::from_slice(py, probabilities))
    }

    /// Homography of shape (3, 3), `x2 ~ H @ x1`, if only a plane or a rotation of the camera is certain.
    #[getter]
    fn homography<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        Some(arrays::matrix3(py, &self.found.assessment.plane.as_ref()?.homography21))
    }

    /// Clearly different geometries of the search, the best first, of shape (K, 3, 3).
    #[getter]
    fn hypotheses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        let matrices = self.found.hypotheses().iter().flat_map(|other| other.fundamental().rows().concat());
        arrays::array3(py, matrices.collect())
    }

    /// Essential matrix of shape (3, 3). `None` without cameras, or if the matches do not determine the pose.
    #[getter(E)]
    fn essential<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        Some(arrays::matrix3(py, &self.determined_pose()?.pose.essential()))
    }

    /// Rotation of shape (3, 3): `X2 = R @ X1 + t`. Known even if the camera only turned.
    #[getter(R)]
    fn rotation<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let (PoseOutcome::Determined(fit) | PoseOutcome::OnlyTurned(fit)) = self.pose.as_ref()? else {
            return None;
        };
        Some(arrays::matrix3(py, fit.pose.rotation.matrix()))
    }

    /// Translation of length 1, of shape (3,). `None` if the matches do not determine it.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        Some(PyArray1::from_slice(py, self.determined_pose()?.pose.translation.as_slice()))
    }

    /// Covariance of a small turn after `R`, radians, and of `t`, of shape (6, 6), rank 5.
    #[getter]
    fn pose_covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let covariance = self.determined_pose()?.covariance()?;
        Some(arrays::matrix_rows(py, 6, |row, column| covariance[(row, column)]))
    }

    /// Time offset of two sequences: frame k of the first and frame k + offset of the second are simultaneous. `None` for
    /// pictures and points.
    #[getter]
    fn offset(&self) -> Option<i32> {
        match &self.source {
            Source::Pictures { offset, .. } => *offset,
            Source::Points { .. } => None,
        }
    }

    /// Whether points and `F` belong to the images without distortion.
    #[getter]
    fn is_undistorted(&self) -> bool {
        self.pictures_of().is_undistorted()
    }

    /// What was read of given matches and what was left out, in clauses.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.remarks.clone()
    }

    /// Writes the question of the result into a folder, as a session that the window opens. Returns its path.
    fn _hand_over(&self, py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
        let Source::Pictures { originals, clicks, given, parameters, offset, .. } = &self.source else {
            return Err(input(py, "the result is of points without images, so there is nothing to show"));
        };
        if offset.is_some() && originals.iter().any(|picture| picture.path.is_none()) {
            let problem = "the window opens sequences as folders or videos, and these are arrays. Write the frames to files";
            return Err(input(py, problem));
        }
        let cameras =
            self.cameras.as_ref().map(|known| known.views.views.each_ref().map(|view| *view.camera()));
        let question = Question { clicks, given: Some(given), parameters };
        let work = Work::of_question(&question, cameras, offset.unwrap_or(0));
        let pictures = originals.each_ref().map(AsRef::as_ref);
        py.detach(|| SessionFile::hand_over(pictures, work, &folder))
            .map_err(|error| input(py, error.to_string()))
    }

    /// Returns the pictures of the result as bytes of height × width × RGB, for drawings.
    fn _pictures<'py>(&self, py: Python<'py>) -> Option<Vec<(usize, usize, Bound<'py, PyBytes>)>> {
        let Source::Pictures { study, .. } = &self.source else { return None };
        let drawn = |picture: &Picture| {
            let pixels = picture.displayed(&picture.pixels).to_rgb8();
            (pixels.height() as usize, pixels.width() as usize, PyBytes::new(py, pixels.as_raw()))
        };
        Some(study.pictures().map(drawn).into())
    }

    /// Returns evenly spaced corresponding lines of the images, for drawings: the number, and both ends x, y of the part
    /// in each image, px. The number stands at the second end.
    fn _lines(&self) -> Vec<(usize, [Option<Ends>; 2])> {
        let Source::Pictures { study, .. } = &self.source else { return Vec::new() };
        let at = |point: Point| [point.x, point.y];
        let ends = |part: Segment| [at(part.start), at(part.end)];
        let lines = fan::numbered(self.found.fundamental(), study.frames(), &self.matches());
        lines.into_iter().map(|one| (one.number, one.parts.map(|part| part.map(ends)))).collect()
    }

    /// Return the result as JSON, as `epiline estimate --json` writes it.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| {
            let mut kept = self.json.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            if let Some(text) = &*kept {
                return Ok(text.clone());
            }
            let text = self.written()?;
            *kept = Some(text.clone());
            Ok(text)
        })
        .map_err(|error: serde_json::Error| no_geometry(py, error.to_string()))
    }

    /// Return the result as text, as `epiline estimate` prints it.
    fn summary(&self) -> String {
        match &self.source {
            Source::Pictures { study, .. } => {
                result_in_words(&self.found, &study.pictures().map(ImageNote::from), &self.pictures_of())
            }
            Source::Points { frames, given, point, .. } => points_in_words(point, given, frames.is_some()),
        }
    }

    fn __repr__(&self) -> String {
        let verdict = self.verdict().unwrap_or("not judged");
        format!("<epiline.Estimate: {verdict}, {} matches>", self.found.matches().len())
    }

    /// Draw the images, numbered lines, matches and the verdict with matplotlib. Return the axes.
    #[pyo3(signature = (ax=None))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("epiline._views")?.getattr("plot")?.call1((slf, ax))
    }

    /// Open the window on the result, in a process of its own. The window makes the search again, from the same images,
    /// clicks, given matches, cameras and parameters. Images given as arrays are temporary files as long as the window is
    /// open, so a session saved there does not find them later. For that, give paths.
    fn show(slf: &Bound<'_, Self>) -> PyResult<()> {
        slf.py().import("epiline._views")?.getattr("show")?.call1((slf,)).map(|_| ())
    }

    fn _repr_png_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("epiline._views")?.getattr("png")?.call1((slf,))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("epiline._views")?.getattr("html")?.call1((slf,))
    }
}

/// Returns the parameters of a preset with changes, `name=value`.
pub fn parameters_of(py: Python<'_>, preset: &str, changes: &[String]) -> PyResult<Parameters> {
    let found = [Preset::Robust, Preset::Paper].into_iter().find(|known| {
        serde_json::to_value(known).ok().and_then(|name| Some(name.as_str()? == preset)).unwrap_or(false)
    });
    let preset =
        found.ok_or_else(|| input(py, format!("the preset is \"robust\" or \"paper\", not {preset:?}")))?;
    let changed = |parameters: Parameters, change: &String| {
        with_parameter(&parameters, change)
            .map_err(|problem| input(py, format!("the parameter {change}: {problem}")))
    };
    changes.iter().try_fold(Parameters::from(preset), changed)
}

/// Searches for the geometry of two pictures.
#[pyfunction]
#[pyo3(signature = (image1, image2, pairs, matches, cameras, preset, seed, threads, changes, progress))]
pub fn estimate(
    py: Python<'_>,
    image1: &Bound<'_, PyAny>,
    image2: &Bound<'_, PyAny>,
    pairs: Option<Rows>,
    matches: Option<&Bound<'_, PyDict>>,
    cameras: Option<GivenCameras>,
    preset: &str,
    seed: u64,
    threads: Option<usize>,
    changes: Vec<String>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Estimate> {
    let threads = Threads::given(py, threads)?;
    let mut parameters = parameters_of(py, preset, &changes)?;
    parameters.seed = seed;
    let mut clicks = pairs.map(|rows| pairs_of(py, &rows)).transpose()?.unwrap_or_default();
    let (mut given, mut remarks) = given_of(py, matches)?;
    parameters.method = Method::usual(clicks.len(), parameters.search);
    let originals = pictures_of(image1, image2, &threads)?.map(Arc::new);
    let mut study = Study::of_pictures(originals.clone());
    let of_study = |error: StudyError| input(py, error.to_string());
    let cameras = match cameras {
        Some(cameras) => {
            let pairs = || match &given {
                Some(given) => given.iter().map(|found| found.pair).collect(),
                None => study.putative_pairs(),
            };
            Some(cameras.known(py, &threads, study.frames(), pairs)?)
        }
        None => None,
    };
    if let Some(KnownCameras { views, notes, doubts, .. }) = &cameras {
        clicks = clicks_in(views, &clicks).map_err(of_study)?;
        given = given.map(|given| matches_in(views, &given)).transpose().map_err(of_study)?;
        study = py.detach(|| threads.run(|| study.with_views(*views)));
        remarks.extend(notes.iter().chain(doubts).cloned());
    }
    let solve = |monitor: &Monitor| {
        let question = Question { clicks: &clicks, given: given.as_deref(), parameters: &parameters };
        let unused = study.check_given(&question).err();
        (unused, study.solve(&question, monitor))
    };
    let (unused, found) = watched(py, &threads, progress, solve)?;
    let found = found.map_err(|error| of_estimate(py, &error))?;
    remarks.extend(unused.map(|error| format!("the matches are not used: {error}")));
    let source = Source::Pictures {
        study: Box::new(study),
        originals,
        clicks,
        given: given.unwrap_or_default(),
        parameters: Box::new(parameters),
        offset: None,
    };
    Ok(Estimate::new(found, source, cameras, remarks))
}
