//! Geometry from the motion barcodes of lines (paper, sections 2.3 and 4): two synchronised sequences instead of two
//! pictures, with clicks or without.
//!
//! The line similarity behind [`crate::similarity::BarcodeSource`] serves the searches of `lines` as stereo matching does:
//! pencils through clicks, and all lines of both images. What they propose is refined here on the barcodes themselves, all
//! seven numbers at once, and judged by what barcodes can tell: patches of cameras far apart do not match.

mod agreement;
mod precision;
mod refinement;
mod sharpening;

use serde::Serialize;

use super::lines::{LineConsensus, compare_lines, geometries_from_lines};
use super::record::SearchRecord;
use super::result::REPORTED;
use super::search::{Input, Judged, by_lines};
use super::trust::{BarcodeEvidence, Evidence, Together};
use super::{Assessment, Estimate, EstimateError, Parameters, Stage, Trust};
use crate::geometry::{FundamentalMatrix, PointPair, line_spacing, sampson_distance};
use crate::motion::Silhouettes;

use agreement::Pencils;
use precision::deviation;
use refinement::{Objective, Refined, refine};
use sharpening::sharpen;

/// Longer side of the images that lines are compared at, px: barcodes cost little, so more of them than by stereo.
const SIDE: f64 = 384.0;
/// Proposals that are refined: those of the clicks, then those of all lines.
const REFINED: usize = 6;
/// Two geometries are one when their lines are nearer to each other than this fraction of the longer side, on average.
const SAME: f64 = 0.02;
/// Epipolar lines differ between two geometries by what is measured at so many places of image 1 either way.
const PLACES: usize = 8;

/// What the barcodes of corresponding lines say of a geometry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BarcodeFigures {
    /// How well the barcodes of corresponding epipolar lines agree over both images, 1 for equal ones, 0 for unrelated.
    pub correlation: f64,
    /// The best agreement when the second sequence is shifted in time, so that it cannot agree but by chance.
    pub by_chance: f64,
    /// Epipolar lines that tell something of their own: neighbours are crossed by the same things.
    pub lines: f64,
    /// Standard deviation of the epipolar lines where things move, px, from leaving out a part of the frames at a time;
    /// `None` where too few frames are left.
    pub deviation: Option<f64>,
    /// Frames that were compared.
    pub frames: usize,
}

/// Parameters as barcodes take them: a barcode is the same whichever way its line is read, cameras may stand anywhere
/// around the scene, and there are no patches.
pub(super) fn adapted(parameters: &Parameters) -> Parameters {
    let mut adapted = parameters.clone();
    adapted.pencils.rotation = std::f64::consts::PI;
    adapted.pencils.coarse_side = adapted.pencils.coarse_side.max(SIDE);
    adapted.search = super::Search::Lines;
    adapted.refinement.refine = false;
    adapted
}

/// Proposals from the pencils of the clicks, where there are two, and from all lines; the best one refined and judged.
pub(super) fn by_barcodes(
    input: &Input,
    silhouettes: [&Silhouettes; 2],
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let Input { clicks, parameters, cancel, patches, .. } = *input;
    let mut proposed: Vec<FundamentalMatrix> = Vec::new();
    let mut hypotheses: Vec<Estimate> = Vec::new();
    if clicks.anchors().len() >= 2 {
        match by_lines(input, record) {
            Ok(found) => {
                proposed.push(found.fundamental);
                proposed.extend(found.hypotheses.iter().take(REFINED / 2).map(Estimate::fundamental));
                hypotheses = found.hypotheses;
            }
            // Lines through the clicks that nothing crosses leave all other lines.
            Err(EstimateError::NoCandidates { .. } | EstimateError::NoGeometry) => {}
            Err(error) => return Err(error),
        }
    }
    let alone = from_all_lines(input, record)?;
    proposed.extend(alone.iter().take(REFINED / 2));
    hypotheses.extend(alone.into_iter().map(Estimate::from));
    hypotheses.truncate(REPORTED);
    if let Some(first) = proposed.first() {
        input.report(record, *first, &hypotheses, None);
    }

    record.enter(Stage::Refinement)?;
    let events =
        proposed.first().and_then(|f| Pencils::new(silhouettes, f)).map_or(1.0, |pencils| pencils.events());
    let objective = Objective::new(silhouettes, &clicks.observed(), parameters.click_sigma, events);
    let mut refined = Vec::new();
    // Half the size is fine enough to tell proposals apart, and for how much the result depends on single frames.
    let half = silhouettes.map(Silhouettes::halved);
    let coarse = objective.with([&half[0], &half[1]]);
    for start in &proposed {
        refined.extend(refine(&coarse, start, refinement::FROM_AFAR, parameters.seed, cancel)?);
    }
    refined.sort_by(|a: &Refined, b| a.value.total_cmp(&b.value));
    let best = refined.first().ok_or(EstimateError::NothingFromBarcodes)?;
    let best = refine(&objective, &best.fundamental, refinement::NEARBY, parameters.seed, cancel)?
        .unwrap_or_else(|| best.clone());

    record.enter(Stage::Validation)?;
    let pencils = Pencils::new(silhouettes, &best.fundamental).ok_or(EstimateError::NothingFromBarcodes)?;
    let margin = refined
        .iter()
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
    let assessment = assessed(input, record, &best.fundamental, figures, margin);
    Ok(Judged {
        clicks: clicks.clone(),
        fundamental: best.fundamental,
        hypotheses,
        assessment,
        weight: 0.0,
        patches: std::sync::Arc::clone(patches),
    })
}

/// Geometries that pairs of all lines agree on (paper, section 4), full-size pixels.
fn from_all_lines(input: &Input, record: &mut SearchRecord) -> Result<Vec<FundamentalMatrix>, EstimateError> {
    let Input { source, parameters, cancel, .. } = *input;
    record.enter(Stage::Pencils)?;
    let level = source.at(parameters.pencils.coarse_side);
    let alone = &parameters.lines_alone;
    let compared = compare_lines(&level, alone.lines, source.rotation(), &parameters.pencils, cancel)?;
    record.lines_alone(compared.lines, compared.pairs.len());
    record.enter(Stage::Hypotheses)?;
    let pairs = sharpen(
        &level,
        &compared.pairs,
        line_spacing(level.frames[0], alone.lines),
        parameters.seed,
        cancel,
    )?;
    let how = LineConsensus { draws: parameters.hypotheses, area: alone.agreement, seed: parameters.seed };
    let found = geometries_from_lines(&pairs, level.frames, &how, cancel)?;
    record.counts.hypotheses += parameters.hypotheses;
    let full_size = level.scales.map(f64::recip);
    Ok(found.iter().filter_map(|one| one.fundamental.rescaled(full_size[0], full_size[1])).collect())
}

/// How far the lines of two geometries are apart on average, as a fraction of the longer side of image 2.
fn apart(a: &FundamentalMatrix, b: &FundamentalMatrix, silhouettes: [&Silhouettes; 2]) -> f64 {
    let [frame1, frame2] = silhouettes.map(Silhouettes::full_size);
    let mut distances = Vec::new();
    for k in 0..PLACES * PLACES {
        let share = |k: usize| (k as f64 + 0.5) / PLACES as f64;
        let at = crate::geometry::Point::new(
            share(k % PLACES) * frame1.right(),
            share(k / PLACES) * frame1.bottom(),
        );
        let lines = (a.line2_from_point1(at), b.line2_from_point1(at));
        if let (Some(one), Some(other)) = lines
            && let Some(seen) = frame2.clip(&one)
        {
            distances.push(0.5 * (other.distance(seen.start) + other.distance(seen.end)));
        }
    }
    if distances.is_empty() {
        return 0.0;
    }
    distances.iter().sum::<f64>() / distances.len() as f64 / frame2.longer_side()
}

fn assessed(
    input: &Input,
    record: &SearchRecord,
    f: &FundamentalMatrix,
    figures: BarcodeFigures,
    margin: Option<f64>,
) -> Assessment {
    let Input { clicks, parameters, prepared, .. } = *input;
    let distances: Vec<f64> =
        clicks.observed().iter().map(|pair: &PointPair| sampson_distance(f, pair)).collect();
    let trust = Trust::judge(&Evidence {
        patches: false,
        barcodes: Some(BarcodeEvidence {
            correlation: figures.correlation,
            by_chance: figures.by_chance,
            lines: figures.lines,
        }),
        matches: None,
        clicks: &distances,
        click_sigma: parameters.click_sigma,
        margin,
        deviation: figures.deviation,
        plane: None,
        together: Together::default(),
        side: prepared.frames()[0].longer_side(),
    });
    Assessment {
        barcodes: Some(figures),
        margin,
        warnings: record.warnings.clone(),
        trust: Some(trust),
        ..Assessment::default()
    }
}
