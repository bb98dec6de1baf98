//! Stand-in for the estimator in tests: immediate, and exact for the first two pairs.

use std::sync::{Arc, LazyLock};

use nalgebra::{Matrix3, Vector3};

use super::model::computation::EstimateRequest;
use super::model::shared::Shared;
use crate::estimate::{
    Assessment, Clicks, Construction, Estimate, EstimateError, Event, EventKind, LineFigures, Monitor,
    Parameters, Progress, Refinement, SearchPlan, SearchTrace, Stage,
};
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::image::Picture;

/// Returns the estimate, after reporting it as a preliminary result.
pub fn estimate(request: &EstimateRequest, monitor: &Monitor) -> Result<Estimate, EstimateError> {
    let result = result(&request.pairs, &request.parameters).ok_or(EstimateError::NoGeometry)?;
    monitor.report(Progress::Happened(Event { seconds: 0.0, kind: EventKind::Began(Stage::Pencils) }));
    monitor.report(Progress::Preliminary(Box::new(result.clone())));
    monitor.cancel().check()?;
    Ok(result)
}

/// Returns `F = [e2]× T`, which both pairs fit exactly. `T` is the translation from `p1` to `p2`;
/// `e2` lies on the line through `q2` and `T q1`.
pub fn result(pairs: &[PointPair], parameters: &Parameters) -> Option<Estimate> {
    let [p, q, ..] = pairs else { return None };
    let t = p.point2 - p.point1;
    let shift = Matrix3::new(1.0, 0.0, t.x, 0.0, 1.0, t.y, 0.0, 0.0, 1.0);
    let line = q.point2.to_homogeneous().cross(&(shift * q.point1.to_homogeneous()));
    let e2 = line.cross(&Vector3::new(0.0, 1.0, -100.0));
    let e2 = e2.try_normalize(1e-9).unwrap_or_else(Vector3::x);
    let fundamental = FundamentalMatrix::from_rank_two(e2.cross_matrix() * shift)?;
    let clicks = [*p, *q];
    let lines = Construction::of(&fundamental, clicks, 0.0).map(|construction| LineFigures {
        score: Some(0.25),
        round_trip_area: Some(0.5),
        construction,
    });
    let refinement =
        Some(Refinement { matches: Vec::new(), uncertainty: None, noise: None, is_posed: false });
    let assessment = Assessment { lines, margin: Some(0.4), refinement, ..Assessment::default() };
    let trace = SearchTrace {
        clicks: Clicks::for_plan(pairs, SearchPlan::of(parameters, pairs.len())),
        preset: parameters.preset,
        seed: parameters.seed,
        first_seconds: 0.01,
        seconds: 0.02,
        ..SearchTrace::default()
    };
    Some(Estimate { fundamental, origin: None, assessment, trace: Some(Arc::new(trace)) })
}

/// Returns a request whose first point has the given x.
pub fn request(x: f64) -> EstimateRequest {
    // All requests share one picture, as pictures are compared by identity.
    static PICTURE: LazyLock<Shared<Picture>> = LazyLock::new(|| {
        let pixels = image::DynamicImage::new_luma8(32, 24);
        Shared::new(Picture::from_pixels("test".into(), None, pixels).expect("has pixels"))
    });
    EstimateRequest {
        pictures: [PICTURE.clone(), PICTURE.clone()],
        recordings: None,
        views: None,
        given: None,
        pairs: vec![PointPair::new(x, 5.0, x + 1.0, 6.0), PointPair::new(20.0, 15.0, 22.0, 15.0)],
        parameters: Parameters::default(),
    }
}
