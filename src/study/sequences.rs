//! Two sequences of stationary cameras.

use crate::estimate::{Method, Parameters};
use crate::similarity::LineMeasure;

/// Returns the parameters of a search by motion barcodes with this number of clicks. With fewer than two clicks, all
/// lines of both images propose geometries.
#[must_use]
pub fn barcode_parameters(mut parameters: Parameters, clicks: usize) -> Parameters {
    parameters.similarity.measure = LineMeasure::Barcodes;
    parameters.method = if clicks < 2 { Method::LinesAlone } else { Method::TwoPoint };
    parameters
}
