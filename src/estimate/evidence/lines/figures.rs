//! Scores of a geometry by its lines. Hypotheses are ranked by the scores and shown with them.

use super::bisectors::{bisector_kappas, round_trip_area};
use super::score::line_scores;
use super::{Construction, PencilAngles, PencilPair};
use crate::cancel::CancelFlag;
use crate::estimate::{Parameters, ValidationParameters};
use crate::geometry::PointPair;
use crate::similarity::{ScaledSimilarity, SimilaritySource};

/// Lines of a geometry at two clicks, and how well lines match there.
#[derive(Debug, Clone)]
pub struct LineFigures {
    /// Full-validation score (paper, section 5.1, step 4); lower is better. Squared grey levels per
    /// sample, or their ratio to the cost of mismatched lines, see [`crate::estimate::LineScore`].
    /// `None` before validation.
    pub score: Option<f64>,
    /// Mean epipolar area between `l` and `GH l`, divided by the image width, px. `None` before G
    /// is known.
    pub round_trip_area: Option<f64>,
    /// Lines of the construction, with κ of H and of G.
    pub construction: Construction,
}

/// Returns the figures of a hypothesis whose lines were not compared.
pub(in crate::estimate) fn unvalidated_figures(
    angles: &PencilAngles,
    clicks: [PointPair; 2],
) -> Option<LineFigures> {
    let construction = Construction::new(angles, clicks, None)?;
    Some(LineFigures { score: None, round_trip_area: None, construction })
}

/// Input from which the figures are computed.
pub(in crate::estimate) struct LineExaminer<'a> {
    similarity: ScaledSimilarity<'a>,
    /// The clicks, full-size pixels.
    pub clicks: [PointPair; 2],
    parameters: &'a ValidationParameters,
    cancel: &'a CancelFlag,
}

impl<'a> LineExaminer<'a> {
    /// Creates an examiner at the size where pencils are compared. The clicks are in full-size
    /// pixels.
    pub fn new(
        source: &'a dyn SimilaritySource,
        clicks: [PointPair; 2],
        parameters: &'a Parameters,
        cancel: &'a CancelFlag,
    ) -> Self {
        let similarity = source.at(parameters.pencils.coarse_side);
        Self { similarity, clicks, parameters: &parameters.validation, cancel }
    }

    /// Returns the figures of geometries with these directions at the clicks. They are `None` where
    /// the geometry degenerates, and for the rest when stopped.
    pub fn figures(&self, geometries: &[PencilAngles]) -> Vec<Option<LineFigures>> {
        let ScaledSimilarity { lines: similarity, frames, scales } = &self.similarity;
        let clicks = self.clicks.map(|click| self.similarity.resized(&click));
        let pencils: Vec<Option<PencilPair>> =
            geometries.iter().map(|angles| PencilPair::new(angles, clicks)).collect();
        let valid: Vec<PencilPair> = pencils.iter().flatten().cloned().collect();
        let (lines, kind) = (self.parameters.lines, self.parameters.line_score);
        let scores = line_scores(&**similarity, &valid, *frames, lines, kind, self.cancel);
        let kappas = bisector_kappas(&**similarity, &valid, &clicks, self.cancel);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Preset;
    use crate::estimate::exact::{ExactScene, ExactSource};
    use crate::geometry::FundamentalMatrix;

    fn figures(
        f: FundamentalMatrix,
        clicks: [PointPair; 2],
        side: f64,
        of: &[PencilAngles],
    ) -> Vec<Option<LineFigures>> {
        let (source, cancel) = (ExactSource(f), CancelFlag::default());
        let mut parameters = Parameters::from(Preset::Paper);
        parameters.pencils.coarse_side = side;
        LineExaminer::new(&source, clicks, &parameters, &cancel).figures(of)
    }

    #[test]
    fn figures_keep_their_order_and_degenerate_geometries_have_none() {
        let scene = ExactScene::aside();
        let truth = scene.angles();
        let reversed = PencilAngles { q: [truth.q[0], truth.q[1] + std::f64::consts::PI], ..truth };
        let turned = PencilAngles { p: [truth.p[0], truth.p[1] + 0.3], ..truth };
        let found = figures(scene.fundamental(), scene.clicks(), 320.0, &[reversed, turned, truth]);
        let [None, Some(turned), Some(right)] = found.as_slice() else { panic!("{found:?}") };
        assert!(right.score.unwrap() < 1e-3 && turned.score.unwrap() > 0.1);
        assert!(right.round_trip_area.unwrap() < 0.5 * turned.round_trip_area.unwrap());
    }

    #[test]
    fn figures_are_in_full_size_pixels_at_every_size() {
        let scene = ExactScene::aside();
        let (truth, clicks) = (scene.angles(), scene.clicks());
        let turned = PencilAngles { p: [truth.p[0], truth.p[1] + 0.3], ..truth };
        for side in [320.0, 160.0] {
            let found = figures(scene.fundamental(), clicks, side, &[truth, turned]);
            for (figures, angles) in found.iter().zip([truth, turned]) {
                let LineFigures { round_trip_area: area, construction, .. } = figures.as_ref().unwrap();
                for (pair, click) in [(construction.p(), clicks[0]), (construction.q(), clicks[1])] {
                    let off = pair.line1.distance(click.point1).max(pair.line2.distance(click.point2));
                    assert!(off < 1e-9, "the lines pass through the clicks in full size");
                }
                assert!((construction.turn() - (angles.p[1] - angles.p[0])).abs() < 1e-12);
                // The area over the width is a length, so it is compared with the area at full
                // size.
                let frame = crate::estimate::exact::FRAME;
                let pencils = PencilPair::new(&angles, clicks).unwrap();
                let forward = construction.kappa_line2_from_line1();
                let ratio = forward / construction.kappa_line1_from_line2().unwrap();
                let expected = round_trip_area(&pencils, ratio, frame);
                // Pixel centres, not corners, bound the sampled part: half a pixel of 160 at the
                // ends.
                let area = area.unwrap();
                assert!((area - expected).abs() < 0.02 * expected + 1e-9, "{area} {expected} at {side}");
            }
            let right = found[0].as_ref().unwrap();
            // Both bisectors were searched in steps of 2 px of the level.
            let kappa = right.construction.kappa_line2_from_line1();
            assert!((kappa / truth.kappa).ln().abs() < 0.1 && kappa.to_bits() != truth.kappa.to_bits());
        }
    }

    #[test]
    fn before_validation_there_are_no_scores() {
        let scene = ExactScene::aside();
        let figures = unvalidated_figures(&scene.angles(), scene.clicks()).unwrap();
        assert!(figures.score.is_none() && figures.round_trip_area.is_none());
        assert!(figures.construction.kappa_line1_from_line2().is_none());
        assert!((figures.construction.kappa_line2_from_line1() - scene.angles().kappa).abs() < 1e-12);
    }
}
