//! Search with motion barcodes of lines (paper, sections 2.3 and 4): two synchronised sequences
//! instead of two pictures, with or without clicks.
//!
//! [`crate::similarity::BarcodeSource`] replaces stereo matching in the searches with lines:
//! pencils through clicks, and all lines of both images. Their proposals are refined here on the
//! barcodes, all seven numbers at once. The verdict rests on barcodes, since patches of distant
//! cameras do not match.

mod agreement;
#[cfg(test)]
mod exact;
mod precision;
mod refinement;
mod sharpening;

use super::REPORTED;
use crate::estimate::checks::little_texture;
use crate::estimate::evidence::lines::LineCandidate;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::searches::judged::{Judged, report_preliminary};
use crate::estimate::searches::lines::from_all_lines;
use crate::estimate::searches::published;
use crate::estimate::searches::record::SearchRecord;
use crate::estimate::verdict::trust::Case;
use crate::estimate::{
    Assessment, BarcodeFigures, Estimate, EstimateError, EventKind, HypothesisNote, Origin, Parameters,
    Preset, Proposed, RankedHypothesis, RefinementStep, Search, Stage, Trust,
};
use crate::geometry::{FundamentalMatrix, PointPair, epipolar_difference, line_spacing, sampson_distance};
use crate::motion::Silhouettes;
use crate::similarity::ScaledSimilarity;

use agreement::Pencils;
use precision::deviation;
use refinement::{Objective, RefinedByBarcodes, refine};
use sharpening::sharpen;

/// Mean distance between the lines of two geometries, as a share of the longer side, up to which
/// the geometries are the same. Twice the limit for pictures, since barcodes are less precise.
const SAME: f64 = 0.02;

/// Adapts parameters to barcodes. All rotations are allowed, since a barcode does not depend on the
/// direction of its line, and cameras may stand anywhere. Patches are not used.
fn adapted(parameters: &Parameters) -> Parameters {
    let mut adapted = parameters.clone();
    adapted.pencils.rotation = std::f64::consts::PI;
    adapted.pencils.coarse_side = adapted.pencils.coarse_side.max(parameters.barcodes.side);
    adapted.lines_alone.side = adapted.lines_alone.side.max(parameters.barcodes.side);
    adapted.search = Search::Lines;
    adapted.refinement.refine = false;
    adapted
}

/// Limits the hypotheses through the clicks to the numbers of the published search. The best ones
/// are later refined on the barcodes of many more lines.
fn as_published(parameters: &Parameters) -> Parameters {
    let published = Parameters::from(Preset::Paper);
    let mut few = parameters.clone();
    few.hypotheses = few.hypotheses.min(published.hypotheses);
    few.validation.validated = few.validation.validated.min(published.validation.validated);
    few
}

/// Proposes geometries from the pencils of two clicks, if given, and from all lines. Refines and
/// judges the best one.
pub(in crate::estimate) fn search(
    input: SearchInput,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let silhouettes = input.prepared.silhouettes().ok_or(EstimateError::NoSequences)?;
    let parameters = &adapted(input.parameters);
    let input = SearchInput { parameters, ..input };
    let (viewed, clicks) = (&ViewedPair::upright(input), input.clicks);
    let cancel = record.cancel();
    let mut proposed: Vec<Proposed> = Vec::new();
    let mut hypotheses: Vec<Estimate> = Vec::new();
    if clicks.anchors().len() >= 2 {
        let few = as_published(parameters);
        match published::find(&ViewedPair::upright(SearchInput { parameters: &few, ..input }), record) {
            Ok(found) => {
                let others = found.hypotheses.iter().filter_map(Estimate::as_proposed);
                proposed.push(found.proposed);
                proposed.extend(others.take(parameters.barcodes.refined));
                hypotheses = found.hypotheses;
                // This is drawn while all lines are compared.
                report_preliminary(proposed[0], &hypotheses, None, viewed, record);
            }
            // If nothing crosses the lines through the clicks, all lines still propose.
            Err(EstimateError::NoCandidates(_) | EstimateError::NoGeometry) => {}
            Err(error) => return Err(error),
        }
    }
    let sharpened = |level: &ScaledSimilarity, pairs: Vec<LineCandidate>| {
        let spacing = line_spacing(level.frames[0], parameters.lines_alone.lines);
        sharpen(level, &pairs, spacing, parameters.seed, cancel)
    };
    let alone = from_all_lines(&*viewed.source, parameters, record, sharpened)?;
    proposed.extend(alone.iter().take(parameters.barcodes.refined));
    hypotheses.extend(alone.into_iter().map(|one| Estimate::proposed(one, None, None)));
    hypotheses.truncate(REPORTED);
    if let Some(first) = proposed.first() {
        report_preliminary(*first, &hypotheses, None, viewed, record);
    }

    record.enter(Stage::Validation)?;
    let events = proposed
        .first()
        .and_then(|one| Pencils::new(silhouettes, &one.fundamental))
        .map_or(1.0, |pencils| pencils.events());
    let observed = clicks.observed();
    let objective = Objective { silhouettes, clicks: &observed, click_sigma: parameters.click_sigma, events };
    let mut refined: Vec<(RefinedByBarcodes, Origin)> = Vec::new();
    // Half the size suffices to rank proposals and for the jackknife over frames.
    let half = silhouettes.map(Silhouettes::halved);
    let coarse = Objective { silhouettes: half.each_ref(), ..objective };
    for start in &proposed {
        let Proposed { fundamental, origin } = start;
        let found = refine(&coarse, fundamental, refinement::FROM_AFAR, parameters.seed, 0, cancel)?;
        refined.extend(found.map(|found| (found, *origin)));
    }
    refined.sort_by(|(a, _), (b, _)| a.value.total_cmp(&b.value));
    let (coarsely, origin) = refined.first().ok_or(EstimateError::NothingFromBarcodes)?;
    record.note_race(raced(&refined, silhouettes));

    record.enter(Stage::Refinement)?;
    let start = &coarsely.fundamental;
    let best = refine(&objective, start, refinement::NEARBY, parameters.seed, 0, cancel)?
        .unwrap_or_else(|| coarsely.clone());
    let pencils = Pencils::new(silhouettes, &best.fundamental).ok_or(EstimateError::NothingFromBarcodes)?;
    let margin = refined
        .iter()
        .map(|(rival, _)| rival)
        .filter(|rival| apart(&best.fundamental, &rival.fundamental, silhouettes) > SAME)
        .filter_map(|rival| {
            Some(1.0 - pencils.cost() / Pencils::new(silhouettes, &rival.fundamental)?.cost())
        })
        .min_by(f64::total_cmp);
    let figures = BarcodeFigures {
        correlation: 1.0 - pencils.cost(),
        by_chance: pencils.correlation_by_chance(),
        lines: pencils.independent_lines(),
        deviation: deviation(&coarse, &best.fundamental, parameters.seed, cancel)?,
        frames: silhouettes[0].len(),
    };
    let assessment = assessed(&best.fundamental, figures, margin, input, record);
    let selected = Proposed { fundamental: best.fundamental, origin: *origin };
    let steps = coarsely.course.iter().chain(&best.course).map(|(fundamental, _)| *fundamental);
    record.note(EventKind::Refined { selected: selected.into(), matches: 0, steps: changes(steps) });
    let verdict = assessment.trust.as_ref().map(|trust| trust.verdict);
    record.note(EventKind::Judged { verdict, is_open: false });
    Ok(Judged {
        clicks: clicks.clone(),
        fundamental: best.fundamental,
        origin: *origin,
        hypotheses,
        assessment,
        weight: 0.0,
        weight_deviation: 0.0,
        patches: std::sync::Arc::clone(&viewed.patches),
        pencils: record.present_pencils().to_vec(),
    })
}

/// Returns the best different fits with the course of their support, best first.
fn raced(
    refined: &[(RefinedByBarcodes, Origin)],
    silhouettes: [&Silhouettes; 2],
) -> impl Iterator<Item = RankedHypothesis> {
    let mut different: Vec<&(RefinedByBarcodes, Origin)> = Vec::new();
    for one in refined {
        let is_new = |known: &&(RefinedByBarcodes, Origin)| {
            apart(&known.0.fundamental, &one.0.fundamental, silhouettes) > SAME
        };
        if different.iter().all(is_new) {
            different.push(one);
        }
    }
    different.into_iter().map(|(fit, origin)| {
        let course: Vec<f64> = fit.support().collect();
        let support = course.last().copied();
        let hypothesis = HypothesisNote { fundamental: fit.fundamental, origin: *origin, support };
        RankedHypothesis { hypothesis, course }
    })
}

/// Returns the geometries of a fit, each once. Barcodes have no matches to count.
fn changes(fits: impl Iterator<Item = FundamentalMatrix>) -> Vec<RefinementStep> {
    let mut steps: Vec<RefinementStep> =
        fits.map(|fundamental| RefinementStep { fundamental, matches: 0 }).collect();
    steps.dedup();
    steps
}

/// Returns the mean distance between the lines of two geometries, as a share of the longer side of
/// image 2.
fn apart(a: &FundamentalMatrix, b: &FundamentalMatrix, silhouettes: [&Silhouettes; 2]) -> f64 {
    let frames = silhouettes.map(Silhouettes::full_size);
    let side = frames[1].longer_side();
    epipolar_difference(a, b, frames, side) / side
}

fn assessed(
    f: &FundamentalMatrix,
    figures: BarcodeFigures,
    margin: Option<f64>,
    input: SearchInput,
    record: &SearchRecord,
) -> Assessment {
    let SearchInput { prepared, clicks, parameters } = input;
    let distances: Vec<f64> =
        clicks.observed().iter().map(|pair: &PointPair| sampson_distance(f, pair)).collect();
    let trust = Trust::judge(&Case {
        barcodes: Some(figures),
        clicks: distances.into(),
        click_sigma: parameters.click_sigma,
        margin,
        deviation: figures.deviation,
        side: prepared.frames()[0].longer_side(),
        ..Case::default()
    });
    Assessment {
        barcodes: Some(figures),
        margin,
        warnings: little_texture(clicks, record.present_pencils()),
        trust: Some(trust),
        ..Assessment::default()
    }
}

#[cfg(test)]
#[cfg(feature = "pictures")]
mod tests {
    use super::*;
    use crate::estimate::{CancelFlag, Monitor, PreparedPair, Reason, Verdict, estimate_prepared};
    use crate::geometry::{Frame, symmetric_epipolar_distance};
    use crate::image::GrayPlane;
    use crate::similarity::LineMeasure;
    use crate::synthetic::{BallScene, ThrownBalls};

    const SMALL: ThrownBalls = ThrownBalls {
        frame: Frame { width: 320, height: 240 },
        frames: 200,
        balls: 8,
        offset: 0,
        noise: 0.0,
        brightening: 0.0,
        seed: 1,
    };

    fn prepared(scene: &BallScene, thrown: &ThrownBalls, offset: i32) -> PreparedPair {
        let [first, second] = [0, 1].map(|camera| {
            let masks: Vec<Vec<bool>> = (0..thrown.frames).map(|number| scene.mask(camera, number)).collect();
            Silhouettes::from_masks("made", thrown.frame, thrown.frame, masks).unwrap()
        });
        let plane = |k: usize| GrayPlane::from_fn(thrown.frame, |x, y| ((x * (7 + k) + y * 13) % 97) as f32);
        PreparedPair::of_sequences(&plane(0), &plane(4), [&first, &second], offset).unwrap()
    }

    fn parameters() -> Parameters {
        let mut parameters = Parameters::default();
        parameters.similarity.measure = LineMeasure::Barcodes;
        parameters
    }

    fn found(prepared: &PreparedPair, clicks: &[PointPair]) -> Result<Estimate, EstimateError> {
        estimate_prepared(prepared, clicks, &parameters(), &Monitor::silent())
    }

    /// Checks the events from which a replay is drawn.
    fn tells_the_search(found: &Estimate) {
        let events = &found.trace.as_ref().unwrap().events;
        let lines = events.iter().find_map(|event| match &event.kind {
            EventKind::Lines { swept, candidates, .. } => Some((swept.len(), candidates.len())),
            _ => None,
        });
        assert!(lines.is_some_and(|(swept, candidates)| (20..=90).contains(&swept) && candidates > 20));
        let race = events.iter().rev().find_map(|event| match &event.kind {
            EventKind::Ranked(race) => Some(race),
            _ => None,
        });
        for own in race.unwrap() {
            assert_eq!(own.course.len(), refinement::FROM_AFAR.rounds + 1);
            assert!(own.course.is_sorted() && own.hypothesis.support == own.course.last().copied());
        }
        let steps = events.iter().find_map(|event| match &event.kind {
            EventKind::Refined { steps, matches: 0, .. } => Some(steps),
            _ => None,
        });
        let steps = steps.unwrap();
        assert!(steps.len() > 2);
        assert_eq!(&steps[steps.len() - 1].fundamental, found.fundamental());
    }

    #[test]
    fn balls_seen_from_far_apart_give_the_geometry_with_clicks_and_without() {
        let scene = BallScene::new(SMALL).unwrap();
        let (prepared, matches) = (prepared(&scene, &SMALL, 0), scene.matches(200));
        for clicks in [&[][..], &matches[..2]] {
            let found = found(&prepared, clicks).unwrap();
            let f = found.fundamental();
            let sum: f64 = matches.iter().map(|m| symmetric_epipolar_distance(f, m)).sum();
            let error = sum / matches.len() as f64;
            assert!(error < 1.0, "{} clicks: {error} px", clicks.len());
            let trust = found.assessment.trust.as_ref().unwrap();
            // The small scene has about as many independent lines as a reliable result needs (14).
            let is_near_enough = |r: &Reason| matches!(r, Reason::FewBarcodes { lines } if *lines >= 12);
            assert!(trust.reasons.iter().all(is_near_enough), "{:?}", trust.reasons);
            let figures = found.assessment.barcodes.unwrap();
            assert!(figures.correlation > 0.9 && figures.by_chance < 0.5, "{figures:?}");
            assert!(figures.deviation.unwrap() < 1.0 && figures.frames == 200, "{figures:?}");
            assert!(!found.hypotheses().is_empty() && found.matches().is_empty());
            tells_the_search(&found);
        }
    }

    #[test]
    fn recordings_of_different_times_or_of_little_motion_are_not_reliable() {
        let scene = BallScene::new(SMALL).unwrap();
        let shifted = found(&prepared(&scene, &SMALL, 60), &[]);
        let is_reliable = |found: &Estimate| {
            found.assessment.trust.as_ref().is_some_and(|trust| trust.verdict == Verdict::Reliable)
        };
        assert!(shifted.is_err() || !is_reliable(&shifted.unwrap()));
        let lonely = ThrownBalls { balls: 1, frames: 60, ..SMALL };
        let scene = BallScene::new(lonely).unwrap();
        let one = found(&prepared(&scene, &lonely, 0), &[]);
        assert!(one.is_err() || !is_reliable(&one.unwrap()));
    }

    #[test]
    fn pictures_without_frames_are_refused_and_cancelling_stops() {
        let plane = GrayPlane::from_fn(SMALL.frame, |x, y| ((x * 7 + y * 13) % 97) as f32);
        let other = GrayPlane::from_fn(SMALL.frame, |x, y| ((x * 11 + y * 5) % 89) as f32);
        let pictures = PreparedPair::new(&plane, &other);
        assert_eq!(found(&pictures, &[]).unwrap_err(), EstimateError::NoSequences);
        let scene = BallScene::new(ThrownBalls { frames: 40, ..SMALL }).unwrap();
        let prepared = prepared(&scene, &ThrownBalls { frames: 40, ..SMALL }, 0);
        let flag = CancelFlag::default();
        flag.cancel();
        let stopped = estimate_prepared(&prepared, &[], &parameters(), &Monitor::new(flag, |_| ()));
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
