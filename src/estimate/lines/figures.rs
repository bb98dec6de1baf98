//! What the lines say of a geometry: the figures that a hypothesis is ranked and shown by, whoever proposed it.

use super::bisectors::{bisector_kappas, round_trip_area};
use super::score::line_scores;
use super::{Construction, PencilAngles, PencilPair};
use crate::estimate::{Monitor, ValidationParameters};
use crate::geometry::PointPair;
use crate::similarity::ScaledSimilarity;

/// The lines of a geometry at two clicks, and how well lines match there.
#[derive(Debug, Clone)]
pub struct LineFigures {
    /// Full-validation score, lower is better (paper, section 5.1, step 4): squared grey levels a sample, or that
    /// divided by the cost of mismatched lines, as [`crate::estimate::LineScore`] says. `None` before validation.
    pub score: Option<f64>,
    /// Mean epipolar area between `l` and `GH l`, divided by the image width: px. `None` before G is known.
    pub round_trip_area: Option<f64>,
    /// The lines it is built from, with κ of H and of G.
    pub construction: Construction,
}

/// Figures of a hypothesis whose lines have not been compared.
pub(in crate::estimate) fn unvalidated_figures(
    angles: &PencilAngles,
    clicks: [PointPair; 2],
) -> Option<LineFigures> {
    let construction = Construction::new(angles, clicks, None)?;
    Some(LineFigures { score: None, round_trip_area: None, construction })
}

/// What the figures are computed from.
pub(in crate::estimate) struct LineExaminer<'a> {
    pub similarity: &'a ScaledSimilarity<'a>,
    /// Full-size pixels.
    pub clicks: [PointPair; 2],
    pub parameters: &'a ValidationParameters,
    pub monitor: &'a Monitor<'a>,
}

impl LineExaminer<'_> {
    /// The figures of geometries whose epipolar lines at the clicks have these directions; `None` where they
    /// degenerate, and where the computation was stopped.
    pub fn figures(&self, geometries: &[PencilAngles]) -> Vec<Option<LineFigures>> {
        let ScaledSimilarity { lines: similarity, frames, scales } = self.similarity;
        let clicks = self.clicks.map(|click| self.similarity.resized(&click));
        let pencils: Vec<Option<PencilPair>> =
            geometries.iter().map(|angles| PencilPair::new(angles, clicks)).collect();
        let valid: Vec<PencilPair> = pencils.iter().flatten().cloned().collect();
        let (lines, kind) = (self.parameters.lines, self.parameters.line_score);
        let scores = line_scores(&**similarity, &valid, *frames, lines, kind, self.monitor);
        let kappas = bisector_kappas(&**similarity, &valid, &clicks, self.monitor);
        let mut measured = valid.iter().zip(scores).zip(kappas);
        geometries
            .iter()
            .zip(&pencils)
            .map(|(angles, pencils)| {
                pencils.as_ref()?;
                let ((pencils, score), kappas) = measured.next()?;
                let (forward, backward) = kappas.unwrap_or((angles.kappa, angles.kappa));
                let area = round_trip_area(pencils, forward / backward, frames[0]);
                let directed = PencilAngles { kappa: forward, ..*angles };
                Some(LineFigures {
                    score: Some(score),
                    round_trip_area: Some(area / scales[0]),
                    construction: Construction::new(&directed, self.clicks, Some(backward))?,
                })
            })
            .collect()
    }
}
