//! Matches of a point, and the similarity of two lines.

use epiline::estimate::Parameters;
use epiline::geometry::{AnchoredLine, Point};
use epiline::similarity::{MatchedLines, SimilarityParameters};
use epiline::study::Study;
use epiline::suggest::{ClickedImage, Known, SuggestParameters};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{fundamental_of, pictures_of};
use crate::errors::{input, no_geometry};
use crate::search::{Threads, watched};

/// A place in the other image that looks like the surroundings of a point.
#[pyclass(frozen, get_all, module = "epiline")]
pub struct Suggestion {
    /// x and y, px.
    pub position: (f64, f64),
    /// Normalised correlation of the surroundings, -1 to 1.
    pub correlation: f64,
    /// Rotation relative to the image of the point, radians.
    pub rotation: f64,
    /// Size relative to the image of the point.
    pub scale: f64,
    /// Whether it is the best one, and the only one that looks right.
    pub is_clear: bool,
}

#[pymethods]
impl Suggestion {
    fn __repr__(&self) -> String {
        let (x, y) = self.position;
        format!("<epiline.Suggestion: ({x:.1}, {y:.1}), correlation {:.2}>", self.correlation)
    }
}

#[pyfunction]
#[pyo3(signature = (image1, image2, at, fundamental, image, threads))]
pub fn suggest(
    py: Python<'_>,
    image1: &Bound<'_, PyAny>,
    image2: &Bound<'_, PyAny>,
    at: [f64; 2],
    fundamental: Option<PyReadonlyArray2<'_, f64>>,
    image: usize,
    threads: Option<usize>,
) -> PyResult<Vec<Suggestion>> {
    let clicked = match image {
        1 => ClickedImage::First,
        2 => ClickedImage::Second,
        _ => return Err(input(py, format!("image is 1 or 2, not {image}"))),
    };
    let threads = Threads::given(py, threads)?;
    let study = Study::of_pictures(pictures_of(image1, image2, &threads)?);
    let fundamental = fundamental.map(|f| fundamental_of(py, &f, Some(study.frames()))).transpose()?;
    let known = Known { fundamental, ..Known::default() };
    let at = Point::new(at[0], at[1]);
    let found =
        watched(py, &threads, None, |_| study.suggest(at, clicked, &known, &SuggestParameters::default()))?;
    let found = found.map_err(|error| {
        let message = error.to_string();
        if error.is_bad_input() { input(py, message) } else { no_geometry(py, message) }
    })?;
    let is_clear = found.clear().is_some();
    let suggestion = |(k, one): (usize, &epiline::suggest::Suggestion)| Suggestion {
        position: (one.position.x, one.position.y),
        correlation: one.correlation,
        rotation: one.rotation,
        scale: one.scale,
        is_clear: is_clear && k == 0,
    };
    Ok(found.candidates.iter().enumerate().map(suggestion).collect())
}

/// Stereo matching along two lines.
#[pyclass(frozen, module = "epiline")]
pub struct LineMatch {
    found: MatchedLines,
}

#[pymethods]
impl LineMatch {
    /// Distance of two samples, px.
    #[getter]
    fn step(&self) -> f64 {
        self.found.step
    }

    /// Total cost C* of the best matching (paper, section 3), squared grey levels.
    #[getter]
    fn cost(&self) -> u64 {
        self.found.warped.matching.cost
    }

    /// Disparity of each sample of profile 1: sample i matches sample i + d of profile 2.
    #[getter]
    fn disparities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_slice(py, &self.found.warped.matching.disparities)
    }

    /// Intensities along line 1.
    #[getter]
    fn profile1<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.found.warped.profile1.values)
    }

    /// Intensities along line 2.
    #[getter]
    fn profile2<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.found.warped.profile2.values)
    }

    /// Index of the first sample of each profile; the anchors have index 0.
    #[getter]
    fn first(&self) -> (i32, i32) {
        (self.found.warped.profile1.first, self.found.warped.profile2.first)
    }

    /// Profile 2 warped onto the samples of profile 1; NaN where the match falls outside image 2.
    #[getter]
    fn warped2<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let values = self.found.warped.warped2.iter().map(|value| value.map_or(f32::NAN, f32::from));
        PyArray1::from_iter(py, values)
    }

    fn __repr__(&self) -> String {
        format!(
            "<epiline.LineMatch: cost {}, {} samples>",
            self.cost(),
            self.found.warped.profile1.values.len()
        )
    }
}

/// Matches two lines, each an anchor `x y` and a direction `dx dy`. The anchors show the same scene point.
#[pyfunction]
pub fn line_similarity(
    py: Python<'_>,
    image1: &Bound<'_, PyAny>,
    image2: &Bound<'_, PyAny>,
    line1: [f64; 4],
    line2: [f64; 4],
) -> PyResult<LineMatch> {
    let threads = Threads::of_process();
    let pictures = pictures_of(image1, image2, &threads)?;
    let line = |[x, y, dx, dy]: [f64; 4]| {
        let is_line = [x, y, dx, dy].iter().all(|v| v.is_finite()) && dx.hypot(dy) > 0.0;
        is_line.then(|| AnchoredLine::at_angle(Point::new(x, y), dy.atan2(dx)))
    };
    let (Some(line1), Some(line2)) = (line(line1), line(line2)) else {
        return Err(input(py, "a line is an anchor x y and a direction dx dy that is not zero"));
    };
    let parameters = Parameters::default();
    for (k, line) in [&line1, &line2].into_iter().enumerate() {
        if line.index_range(pictures[k].frame(), 1.0).is_none() {
            return Err(input(py, format!("line {} does not cross its image", k + 1)));
        }
    }
    let planes = [&pictures[0].gray, &pictures[1].gray];
    let SimilarityParameters { disparity_reach, stereo, .. } = parameters.similarity;
    let found = watched(py, &threads, None, |_| {
        MatchedLines::new(planes, [line1, line2], 1.0, disparity_reach, &stereo)
    })?;
    Ok(LineMatch { found })
}
