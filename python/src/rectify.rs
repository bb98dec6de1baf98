//! Rectification of pictures by a fundamental matrix.

use epiline::geometry::{FundamentalMatrix, Point, PointPair};
use epiline::rectify::{
    Limits, Rectification as Made, RectifyMethod, StereoRig, rectify as rectified, rectify_calibrated,
};
use epiline::study::stereo_pose;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{self, Rows, frame_of, fundamental_of, pairs_of};
use crate::cameras::{GivenCameras, KnownCameras};
use crate::errors::input;
use crate::search::{Threads, watched};

/// Maps that bring matching points into the same row.
#[pyclass(frozen, module = "epiline")]
pub struct Rectification {
    made: Made,
    rig: Option<StereoRig>,
}

#[pymethods]
impl Rectification {
    /// "planar" or "polar".
    #[getter]
    fn method(&self) -> &'static str {
        self.made.method.name()
    }

    /// Why the method was chosen.
    #[getter]
    fn reason(&self) -> &str {
        &self.made.reason
    }

    /// Height and width of both rectified pictures.
    #[getter]
    fn size(&self) -> [usize; 2] {
        [self.made.size.height, self.made.size.width]
    }

    /// Factor by which the limit on pixels reduced the pictures; 1 without reduction.
    #[getter]
    fn scale(&self) -> f64 {
        self.made.scale
    }

    /// Warnings, in sentences.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.made.warnings.iter().map(ToString::to_string).collect()
    }

    /// Homography of shape (3, 3), rectified from original pixels of image 1. `None` for polar maps.
    #[getter(H1)]
    fn h1<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        Some(arrays::matrix3(py, self.made.maps[0].homography()?))
    }

    /// Homography of shape (3, 3), rectified from original pixels of image 2. `None` for polar maps.
    #[getter(H2)]
    fn h2<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        Some(arrays::matrix3(py, self.made.maps[1].homography()?))
    }

    /// Matrix of shape (4, 4) for `cv2.reprojectImageTo3D`, with a baseline of length 1 and the left picture first. `None` without cameras.
    #[getter(Q)]
    fn q<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        let k = self.rig.as_ref()?.calibration;
        let (focal, x, y) = (k[(0, 0)], k[(0, 2)], k[(1, 2)]);
        let rows = [1.0, 0.0, 0.0, -x, 0.0, 1.0, 0.0, -y, 0.0, 0.0, 0.0, focal, 0.0, 0.0, 1.0, 0.0];
        Some(arrays::array2(py, rows.to_vec(), 4))
    }

    /// Whether camera 2 is the left one. `None` without cameras.
    #[getter]
    fn is_exchanged(&self) -> Option<bool> {
        Some(self.rig.as_ref()?.is_exchanged)
    }

    /// Least and largest disparity of the matches, px. `None` without matches.
    #[getter]
    fn disparities(&self) -> Option<[f64; 2]> {
        Some(self.made.measures.rows?.disparity)
    }

    /// Returns the places of the pixels of a rectified picture in its original, for `cv2.remap`.
    fn maps<'py>(&self, py: Python<'py>, image: usize) -> PyResult<[Bound<'py, PyArray2<f32>>; 2]> {
        if !(1..=2).contains(&image) {
            return Err(input(py, format!("image is 1 or 2, not {image}")));
        }
        let (map, size) = (&self.made.maps[image - 1], self.made.size);
        let [xs, ys] = py.detach(|| {
            let mut both = [Vec::with_capacity(size.width * size.height), Vec::new()];
            both[1].reserve(size.width * size.height);
            for y in 0..size.height {
                for x in 0..size.width {
                    // A place outside the original has the colour of the border.
                    let place = map.original_from_rectified(Point::new(x as f64, y as f64));
                    let place = place.unwrap_or(Point::new(-1e4, -1e4));
                    both[0].push(place.x as f32);
                    both[1].push(place.y as f32);
                }
            }
            both
        });
        Ok([arrays::array2(py, xs, size.width), arrays::array2(py, ys, size.width)])
    }

    fn __repr__(&self) -> String {
        let size = self.made.size;
        format!("<epiline.Rectification: {}, {}×{} px>", self.made.method.name(), size.width, size.height)
    }
}

/// Rectifies pictures of two sizes, each height and width.
#[pyfunction]
#[pyo3(signature = (fundamental, size1, size2, matches, cameras, method, max_pixels))]
pub fn rectify(
    py: Python<'_>,
    fundamental: PyReadonlyArray2<'_, f64>,
    size1: [usize; 2],
    size2: [usize; 2],
    matches: Option<Rows<'_>>,
    cameras: Option<GivenCameras<'_>>,
    method: &str,
    max_pixels: Option<usize>,
) -> PyResult<Rectification> {
    let frames = [size1, size2].map(frame_of);
    let f: FundamentalMatrix = fundamental_of(py, &fundamental, Some(frames))?;
    let pairs: Vec<PointPair> = matches.map(|rows| pairs_of(py, &rows)).transpose()?.unwrap_or_default();
    let known = RectifyMethod::ALL.into_iter().find(|known| known.name() == method);
    let method = known.ok_or_else(|| {
        let names = RectifyMethod::ALL.map(RectifyMethod::name).join(", ");
        input(py, format!("method is one of {names}, not {method:?}"))
    })?;
    let limits = max_pixels.map_or_else(Limits::default, |pixels| Limits { pixels });
    let threads = Threads::of_process();
    let known = cameras.map(|cameras| cameras.known(py, &threads, frames, || pairs.clone())).transpose()?;
    let made = match &known {
        Some(KnownCameras { views, .. }) => {
            let (pose, _) =
                stereo_pose(None, views, Some(&f), &pairs).map_err(|error| input(py, error.to_string()))?;
            let made = watched(py, &threads, None, |_| rectify_calibrated(&pose, views, &pairs, &limits))?;
            made.map(|(made, rig)| Rectification { made, rig: Some(rig) })
        }
        None => watched(py, &threads, None, |_| rectified(&f, frames, &pairs, method, &limits))?
            .map(|made| Rectification { made, rig: None }),
    };
    made.map_err(|error| input(py, error.to_string()))
}
