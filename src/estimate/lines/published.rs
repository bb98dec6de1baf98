//! The search as published (paper, section 5.1): epipoles from two candidate line pairs, κ from a bisector in each
//! direction, the round trip to select, full validation to rank, and refinement of the five numbers on lines.

use rayon::prelude::*;

use super::bisectors::{bisector_kappas, round_trip_area};
use super::refinement::refine_on_lines;
use super::score::line_scores;
use super::{ComparedPencils, Construction, LineFigures, PencilAngles, PencilPair, draw_pairs};
use crate::estimate::result::REPORTED;
use crate::estimate::{Assessment, Estimate, EstimateError, Monitor, Parameters};
use crate::geometry::{Frame, FundamentalMatrix, LinePair, PointPair};
use crate::similarity::{ScaledSimilarity, SimilaritySource};

/// Each click keeps clear of the other's line by this fraction of the image diagonal: nearer than that the epipoles
/// are undetermined.
const CLEAR: f64 = 0.02;
/// Hypotheses that go through full validation at least.
const LEAST_VALIDATED: usize = 10;

/// A hypothesis at the coarse level.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Draft {
    /// The geometry, with κ of the forward map H.
    angles: PencilAngles,
    /// κ of the backward map G.
    kappa_backward: f64,
    /// Mean epipolar area between `l` and `GH l` over the width of image 1, px of the level.
    round_trip: f64,
}

/// The hypotheses of all combinations drawn, those with the smallest round trip first. With a third point pair that
/// gives κ both maps agree by construction.
pub(in crate::estimate) fn propose(
    similarity: &ScaledSimilarity,
    pencils: [&ComparedPencils; 2],
    third: Option<&PointPair>,
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Vec<Draft>, EstimateError> {
    let clicks = pencils.map(|compared| similarity.resized(&compared.click));
    let third = third.map(|pair| similarity.resized(pair));
    let frames = similarity.frames;
    let candidates = pencils.map(|compared| compared.candidates.as_slice());
    let drawn = draw_pairs(candidates, parameters.hypotheses, parameters.seed);
    let spread: Vec<(PencilAngles, PencilPair)> = drawn
        .par_iter()
        .filter_map(|(p, q)| {
            let angles = PencilAngles { p: p.angles, q: q.angles, kappa: 1.0 };
            let pencils = PencilPair::new(&angles, clicks)?;
            is_spread(&pencils, &clicks, frames).then_some((angles, pencils))
        })
        .collect();
    let (angles, pencils): (Vec<PencilAngles>, Vec<PencilPair>) = spread.into_iter().unzip();
    let kappas = match third {
        Some(third) => {
            let of_third = |pencils: &PencilPair| pencils.map().kappa_from_point_pair(&third);
            pencils.iter().map(|pencils| of_third(pencils).map(|kappa| (kappa, kappa))).collect()
        }
        None => bisector_kappas(&*similarity.lines, &pencils, &clicks, monitor),
    };
    monitor.check()?;
    let mut drafts: Vec<Draft> = (angles, pencils, kappas)
        .into_par_iter()
        .filter_map(|(angles, pencils, kappas)| {
            let (forward, backward) = kappas?;
            let pencils = pencils.with_kappa(forward);
            let round_trip = round_trip_area(&pencils, forward / backward, frames[0]);
            let angles = PencilAngles { kappa: forward, ..angles };
            Some(Draft { angles, kappa_backward: backward, round_trip })
        })
        .collect();
    drafts.sort_by(|a, b| a.round_trip.total_cmp(&b.round_trip));
    Ok(drafts)
}

/// How many drafts, the first ones, go through full validation. With a third pair the round trip does not select.
pub(in crate::estimate) fn validated(drafts: &[Draft], has_third: bool, parameters: &Parameters) -> usize {
    let share = (drafts.len() as f64 * parameters.validation.validated).ceil() as usize;
    if has_third { drafts.len() } else { share.max(LEAST_VALIDATED).min(drafts.len()) }
}

/// Whether each click keeps clear of the other's line, in both images.
fn is_spread(pencils: &PencilPair, clicks: &[PointPair; 2], frames: [Frame; 2]) -> bool {
    let (p, q): (&LinePair, &LinePair) = (pencils.map().p(), pencils.map().q());
    let [a, b] = clicks;
    let nearest1 = p.line1.distance(b.point1).min(q.line1.distance(a.point1));
    let nearest2 = p.line2.distance(b.point2).min(q.line2.distance(a.point2));
    nearest1 > CLEAR * frames[0].diagonal() && nearest2 > CLEAR * frames[1].diagonal()
}

/// What full validation leaves.
pub(in crate::estimate) struct Validated {
    /// The best hypotheses, best first, full-size pixels.
    pub hypotheses: Vec<Estimate>,
    /// The five numbers of the best one.
    best: PencilAngles,
}

/// Ranks drafts by the score of their lines over both images. `clicks` are in full-size pixels.
pub(in crate::estimate) fn rank(
    similarity: &ScaledSimilarity,
    drafts: Vec<Draft>,
    clicks: [PointPair; 2],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Validated, EstimateError> {
    let at_level = clicks.map(|click| similarity.resized(&click));
    let (drafts, pencils): (Vec<Draft>, Vec<PencilPair>) =
        drafts.into_iter().filter_map(|d| PencilPair::new(&d.angles, at_level).map(|p| (d, p))).unzip();
    let (lines, kind) = (parameters.validation.lines, parameters.validation.line_score);
    let scores = line_scores(&*similarity.lines, &pencils, similarity.frames, lines, kind, monitor);
    monitor.check()?;
    let mut scored: Vec<(f64, Draft)> =
        scores.into_iter().zip(drafts).filter(|(score, _)| score.is_finite()).collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let hypothesis = |(score, draft): &(f64, Draft)| {
        let construction = Construction::new(&draft.angles, clicks, Some(draft.kappa_backward))?;
        let fundamental = construction.fundamental()?;
        let lines = LineFigures {
            score: Some(*score),
            round_trip_area: Some(draft.round_trip / similarity.scales[0]),
            construction,
        };
        let assessment = Assessment { lines: Some(lines), ..Assessment::default() };
        Some(Estimate { geometry: fundamental.into(), assessment, trace: None })
    };
    let hypotheses: Vec<Estimate> = scored.iter().take(REPORTED).filter_map(hypothesis).collect();
    if hypotheses.is_empty() {
        return Err(EstimateError::NoGeometry);
    }
    Ok(Validated { hypotheses, best: scored[0].1.angles })
}

/// The best hypothesis with its five numbers refined on lines; as it was where they degenerate.
pub(in crate::estimate) fn refine(
    source: &dyn SimilaritySource,
    ranked: &Validated,
    clicks: [PointPair; 2],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<FundamentalMatrix, EstimateError> {
    let angles = refine_on_lines(source, &ranked.best, &clicks, parameters, monitor)?;
    let refined = PencilPair::new(&angles, clicks).and_then(|pencils| pencils.fundamental());
    Ok(refined.unwrap_or(*ranked.hypotheses[0].fundamental()))
}
