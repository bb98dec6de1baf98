//! Steps of the published search (paper, section 5.1). Two candidate line pairs give the epipoles,
//! and a bisector in each direction gives κ. Hypotheses are selected by round trip, ranked by full
//! validation, and refined on lines.

use rayon::prelude::*;

use super::refinement::refine_on_lines;
use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::{
    ComparedPencils, Construction, LineFigures, PencilAngles, PencilPair, bisector_kappas, draw_pairs,
    line_scores, of_line_pairs, round_trip_area,
};
use crate::estimate::{EstimateError, Origin, Parameters, Proposed};
use crate::geometry::{Frame, FundamentalMatrix, LinePair, PointPair};
use crate::similarity::{ScaledSimilarity, SimilaritySource};

/// Smallest distance of a click from the line of the other, as a share of the image diagonal.
/// Nearer clicks do not determine the epipoles: across the image, an error of a click would be
/// fifty times as large.
const CLEAR: f64 = 0.02;
/// Smallest number of fully validated hypotheses, if there are as many. A share of few hypotheses
/// would leave the decision to their round trips.
const LEAST_VALIDATED: usize = 10;

/// Hypothesis at the coarse level.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Draft {
    origin: Origin,
    /// Geometry, with κ of the forward map H.
    angles: PencilAngles,
    /// κ of the backward map G.
    kappa_backward: f64,
    /// Mean epipolar area between `l` and `GH l` over the width of image 1, px of the level.
    round_trip: f64,
}

/// Returns the hypotheses of all drawn combinations, smallest round trip first. A third point pair
/// gives the same κ to both maps.
pub(in crate::estimate) fn propose(
    similarity: &ScaledSimilarity,
    pencils: [&ComparedPencils; 2],
    third: Option<&PointPair>,
    parameters: &Parameters,
    cancel: &CancelFlag,
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
            let of_third = |pencils: &PencilPair| pencils.map.kappa_from_point_pair(&third);
            pencils.iter().map(|pencils| of_third(pencils).map(|kappa| (kappa, kappa))).collect()
        }
        None => bisector_kappas(&*similarity.lines, &pencils, &clicks, cancel),
    };
    cancel.check()?;
    let mut drafts: Vec<Draft> = (angles, pencils, kappas)
        .into_par_iter()
        .filter_map(|(angles, pencils, kappas)| {
            let (forward, backward) = kappas?;
            let pencils = pencils.with_kappa(forward);
            let round_trip = round_trip_area(&pencils, forward / backward, frames[0]);
            let angles = PencilAngles { kappa: forward, ..angles };
            let origin = of_line_pairs(&angles, candidates);
            Some(Draft { origin, angles, kappa_backward: backward, round_trip })
        })
        .collect();
    drafts.sort_by(|a, b| a.round_trip.total_cmp(&b.round_trip));
    Ok(drafts)
}

/// Returns the number of leading drafts for full validation. With a third pair, the round trip is 0
/// and does not select.
pub(in crate::estimate) fn validated(drafts: &[Draft], has_third: bool, parameters: &Parameters) -> usize {
    let share = (drafts.len() as f64 * parameters.validation.validated).ceil() as usize;
    if has_third { drafts.len() } else { share.max(LEAST_VALIDATED).min(drafts.len()) }
}

/// Returns whether each click is far enough from the line of the other in both images.
fn is_spread(pencils: &PencilPair, clicks: &[PointPair; 2], frames: [Frame; 2]) -> bool {
    let (p, q): (&LinePair, &LinePair) = (pencils.map.p(), pencils.map.q());
    let [a, b] = clicks;
    let nearest1 = p.line1.distance(b.point1).min(q.line1.distance(a.point1));
    let nearest2 = p.line2.distance(b.point2).min(q.line2.distance(a.point2));
    nearest1 > CLEAR * frames[0].diagonal() && nearest2 > CLEAR * frames[1].diagonal()
}

/// Result of full validation.
pub(in crate::estimate) struct Validated {
    /// Best hypotheses with their figures, best first, full-size pixels.
    pub hypotheses: Vec<(Proposed, LineFigures)>,
    /// Five numbers of the best hypothesis.
    best: PencilAngles,
}

/// Ranks drafts by the score of their lines over both images, and keeps the best `count`. `clicks`
/// are in full-size pixels.
pub(in crate::estimate) fn rank(
    similarity: &ScaledSimilarity,
    drafts: Vec<Draft>,
    clicks: [PointPair; 2],
    count: usize,
    parameters: &Parameters,
    cancel: &CancelFlag,
) -> Result<Validated, EstimateError> {
    let at_level = clicks.map(|click| similarity.resized(&click));
    let (drafts, pencils): (Vec<Draft>, Vec<PencilPair>) =
        drafts.into_iter().filter_map(|d| PencilPair::new(&d.angles, at_level).map(|p| (d, p))).unzip();
    let (lines, kind) = (parameters.validation.lines, parameters.validation.line_score);
    let scores = line_scores(&*similarity.lines, &pencils, similarity.frames, lines, kind, cancel);
    cancel.check()?;
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
        Some((Proposed { fundamental, origin: draft.origin }, lines))
    };
    let hypotheses: Vec<_> = scored.iter().take(count).filter_map(hypothesis).collect();
    if hypotheses.is_empty() {
        return Err(EstimateError::NoGeometry);
    }
    Ok(Validated { hypotheses, best: scored[0].1.angles })
}

/// Refines the five numbers of the best hypothesis on lines. Returns it unchanged if they
/// degenerate.
pub(in crate::estimate) fn refine(
    source: &dyn SimilaritySource,
    ranked: &Validated,
    clicks: [PointPair; 2],
    parameters: &Parameters,
    cancel: &CancelFlag,
) -> Result<FundamentalMatrix, EstimateError> {
    let angles = refine_on_lines(source, &ranked.best, &clicks, parameters, cancel)?;
    let refined = PencilPair::new(&angles, clicks).and_then(|pencils| pencils.fundamental());
    Ok(refined.unwrap_or(ranked.hypotheses[0].0.fundamental))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::ProposedBy;
    use crate::estimate::evidence::lines::Candidate;
    use crate::estimate::exact::{ExactScene, ExactSource};
    use crate::estimate::{LineScore, PencilParameters, Preset, ValidationParameters};
    use crate::geometry::symmetric_epipolar_distance;

    /// Returns pencils compared on exact lines. Their candidates are some of the nearest lines.
    fn compared(scene: &ExactScene, parameters: &Parameters) -> [ComparedPencils; 2] {
        let source = ExactSource(scene.fundamental());
        scene.clicks().map(|click| {
            ComparedPencils::new(&source, &click, &parameters.pencils, &CancelFlag::default()).unwrap()
        })
    }

    fn parameters() -> Parameters {
        let paper = Parameters::from(Preset::Paper);
        // Exact lines have few mutual best pairs.
        let pencils = PencilParameters { mutual: 5, ..paper.pencils };
        Parameters { hypotheses: 200, pencils, ..paper }
    }

    #[test]
    fn on_exact_lines_the_search_finds_the_geometry() {
        let scene = ExactScene::aside();
        let (parameters, cancel) = (parameters(), CancelFlag::default());
        let source = ExactSource(scene.fundamental());
        let similarity = source.at(parameters.pencils.coarse_side);
        let pencils = compared(&scene, &parameters);
        let drafts = propose(&similarity, pencils.each_ref(), None, &parameters, &cancel).unwrap();
        assert!(drafts.is_sorted_by(|a, b| a.round_trip <= b.round_trip));
        assert!(drafts.len() > 5, "{} drafts", drafts.len());
        let ranked = rank(&similarity, drafts, scene.clicks(), 60, &parameters, &cancel).unwrap();
        let scores: Vec<f64> = ranked.hypotheses.iter().filter_map(|(_, lines)| lines.score).collect();
        assert!(scores.len() == ranked.hypotheses.len() && scores.is_sorted());
        let error = scene.error(&ranked.hypotheses[0].0.fundamental);
        // Lines of a pencil are 2 px apart at the far corner at side 192, or 3.3 px at side 320. The
        // best pair is half a step off at most.
        assert!(error < 1.7, "{error} px");
        let refined = refine(&source, &ranked, scene.clicks(), &parameters, &cancel).unwrap();
        let after = scene.error(&refined);
        assert!(after < 0.7 * error.max(0.3), "{error} px before, {after} px after");
        for click in scene.clicks() {
            assert!(symmetric_epipolar_distance(&refined, &click) < 1e-6, "clicks are held for exact");
        }
    }

    #[test]
    fn a_third_pair_gives_kappa_both_ways() {
        let scene = ExactScene::aside();
        let (parameters, cancel) = (parameters(), CancelFlag::default());
        let source = ExactSource(scene.fundamental());
        let similarity = source.at(parameters.pencils.coarse_side);
        let third = scene.seen(0.3, -0.5, 5.0);
        let mut pencils = compared(&scene, &parameters);
        // The candidates include the true directions.
        let truth = scene.angles();
        for (compared, angles) in pencils.iter_mut().zip([truth.p, truth.q]) {
            compared.candidates.insert(0, Candidate { angles, cost: 0.0 });
        }
        let drafts = propose(&similarity, pencils.each_ref(), Some(&third), &parameters, &cancel).unwrap();
        for draft in &drafts {
            assert_eq!(draft.angles.kappa.to_bits(), draft.kappa_backward.to_bits());
            assert!(draft.round_trip < 1e-9, "both maps are the same: {} px", draft.round_trip);
            let found = PencilPair::new(&draft.angles, scene.clicks()).unwrap().fundamental().unwrap();
            assert!(symmetric_epipolar_distance(&found, &third) < 1e-6);
        }
        let is_right = |draft: &&Draft| PencilAngles { kappa: truth.kappa, ..draft.angles } == truth;
        let right = drafts.iter().find(is_right).unwrap();
        assert!((right.angles.kappa / truth.kappa - 1.0).abs() < 1e-6);
        assert_eq!(validated(&drafts, true, &parameters), drafts.len(), "the round trip selects none");
    }

    #[test]
    fn a_share_of_the_hypotheses_is_validated_and_ten_at_least() {
        let scene = ExactScene::aside();
        let draft = Draft {
            origin: ProposedBy::LinePairs { ranks: [1, 1] }.into(),
            angles: scene.angles(),
            kappa_backward: 1.0,
            round_trip: 0.0,
        };
        let share = |count: usize, validated: f64| {
            let validation = ValidationParameters { validated, lines: 24, line_score: LineScore::Cost };
            super::validated(&vec![draft.clone(); count], false, &Parameters { validation, ..parameters() })
        };
        assert_eq!([share(1000, 0.05), share(1001, 0.05), share(100, 0.05)], [50, 51, LEAST_VALIDATED]);
        assert_eq!([share(7, 0.05), share(7, 1.0), share(0, 1.0)], [7, 7, 0]);
    }

    #[test]
    fn clicks_on_each_others_lines_propose_nothing() {
        let rows = PencilAngles { p: [0.0; 2], q: [0.0; 2], kappa: 1.0 };
        let frames = [Frame::new(400, 300); 2];
        // The limit is 2 % of the diagonal of 500 px, in the image where the clicks are nearer.
        let spread = |y1: f64, y2: f64| {
            let clicks = [PointPair::new(100.0, 100.0, 80.0, 100.0), PointPair::new(300.0, y1, 280.0, y2)];
            is_spread(&PencilPair::new(&rows, clicks).unwrap(), &clicks, frames)
        };
        assert!(spread(110.1, 110.1) && spread(89.9, 89.9));
        assert!(!spread(109.9, 200.0) && !spread(200.0, 109.9) && !spread(90.1, 20.0));
    }
}
