//! Fits to points without pictures.

use epiline::estimate::{Match, Monitor, PointsError};
use epiline::study::PointStudy;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::arrays::{Rows, frame_of, pairs_of};
use crate::cameras::GivenCameras;
use crate::errors::{input, no_geometry};
use crate::estimate::{Estimate, Source};
use crate::search::{Threads, watched};

/// Fits a geometry to points without pictures.
#[pyfunction]
#[pyo3(signature = (rows, sigma, confidences, sizes, cameras, seed, remarks))]
pub fn estimate_points(
    py: Python<'_>,
    rows: Rows,
    sigma: Option<PyReadonlyArray1<'_, f64>>,
    confidences: Option<PyReadonlyArray1<'_, f64>>,
    sizes: Option<[[usize; 2]; 2]>,
    cameras: Option<GivenCameras>,
    seed: u64,
    mut remarks: Vec<String>,
) -> PyResult<Estimate> {
    let pairs = pairs_of(py, &rows)?;
    let mut matches: Vec<Match> = pairs.into_iter().map(Match::from).collect();
    for (name, given) in [("sigma", &sigma), ("confidences", &confidences)] {
        if let Some(given) =
            given.as_ref().map(|given| given.as_array().len()).filter(|n| *n != matches.len())
        {
            return Err(input(py, format!("{name} has {given} numbers for {} matches", matches.len())));
        }
    }
    for (k, found) in matches.iter_mut().enumerate() {
        if let Some(sigma) = &sigma {
            found.sigma = sigma.as_array()[k];
        }
        if let Some(confidences) = &confidences {
            found.prior = confidences.as_array()[k];
        }
        let is_right =
            found.sigma > 0.0 && found.sigma.is_finite() && found.prior > 0.0 && found.prior <= 1.0;
        if !is_right {
            return Err(input(
                py,
                format!(
                    "match {} is invalid: sigma is above 0, and a confidence above 0 and at most 1",
                    k + 1
                ),
            ));
        }
    }
    let frames = sizes.map(|sizes| sizes.map(frame_of));
    let of_points = |error: PointsError| match error {
        PointsError::NoGeometry | PointsError::OnePlane => no_geometry(py, error.to_string()),
        _ => input(py, error.to_string()),
    };
    let mut study = PointStudy::of_points(matches, frames).map_err(of_points)?;
    let threads = Threads::of_process();
    let cameras = match cameras {
        Some(cameras) => {
            let frames = frames.ok_or_else(|| input(py, "cameras need the sizes of the images (sizes)"))?;
            let pairs = study.matches().iter().map(|found| found.pair).collect();
            Some(cameras.known(py, &threads, frames, || pairs)?)
        }
        None => None,
    };
    if let Some(cameras) = &cameras {
        study = study.with_views(cameras.views).map_err(|error| input(py, error.to_string()))?;
        remarks.extend(cameras.notes.iter().chain(&cameras.doubts).cloned());
        if study.left_out() > 0 {
            remarks.push(format!(
                "{} matches lie beyond the range of a lens and are left out",
                study.left_out()
            ));
        }
    }
    let point = watched(py, &threads, None, |_: &Monitor| study.solve(seed))?.map_err(of_points)?;
    let given = study.matches().iter().map(|found| found.pair).collect();
    let found = point.estimate.clone();
    let source = Source::Points {
        frames: study.frames(),
        given,
        probabilities: point.inlier_probabilities.clone(),
        point: Box::new(point),
        seed,
    };
    Ok(Estimate::new(found, source, cameras, remarks))
}
