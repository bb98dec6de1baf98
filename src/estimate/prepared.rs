//! What is computed once per image pair, whatever the clicks: pyramids, corners and patch correlations.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::candidates::PencilComparison;
use super::level::Level;
use super::patches::warps;
use super::refinement::{Refined, RefinementLevel};
use super::support::Support;
use super::voting::Electorate;
use super::{EstimateError, Monitor, Parameters};
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::{GrayPlane, Pyramid};

/// Two images made ready for estimates. Keep it while the images stay the same: moving a click then costs only
/// what depends on the click.
#[derive(Debug)]
pub struct PreparedPair {
    pyramids: [Pyramid; 2],
    witness: OnceLock<Witness>,
    fine_witness: OnceLock<FineWitness>,
    refinement: [RefinementLevel; REFINEMENT_SIDES.len()],
    /// The latest compared pencils, newest first: while one click is dragged, those of the other stay.
    compared: Mutex<VecDeque<Compared>>,
}

#[derive(Debug)]
struct Compared {
    click: PointPair,
    parameters: Parameters,
    comparison: Arc<PencilComparison>,
}

/// Patch support at its level, with the corner pairs that vote.
#[derive(Debug)]
pub(crate) struct Witness {
    pub scales: [f64; 2],
    pub support: Support,
    pub electorate: Electorate,
}

/// Patch support at a finer level, where the right geometry stands out more clearly.
#[derive(Debug)]
pub(crate) struct FineWitness {
    pub scales: [f64; 2],
    pub support: Support,
}

/// Longer side of the images patch support is computed on, px.
const WITNESS_SIDE: f64 = 384.0;
/// Corners an image at that size.
const WITNESS_CORNERS: usize = 600;
/// The same at the finer level.
const FINE_SIDE: f64 = 768.0;
const FINE_CORNERS: usize = 1500;
/// Look-alikes of a corner that vote.
const VOTES_PER_CORNER: usize = 3;
/// Longer sides of the levels `F` is refined at, px; the last one is full size.
const REFINEMENT_SIDES: [f64; 2] = [800.0, f64::INFINITY];
/// Compared pencils kept: some hundred kilobytes each.
const COMPARISONS_KEPT: usize = 4;
/// Levels smaller than this are never used, px.
const SMALLEST_SIDE: f64 = 48.0;

impl PreparedPair {
    /// Builds the pyramids, in parallel; everything else when it is first needed.
    pub fn new(image1: &GrayPlane, image2: &GrayPlane) -> Self {
        let (a, b) =
            rayon::join(|| Pyramid::new(image1, SMALLEST_SIDE), || Pyramid::new(image2, SMALLEST_SIDE));
        Self {
            pyramids: [a, b],
            witness: OnceLock::new(),
            fine_witness: OnceLock::new(),
            refinement: Default::default(),
            compared: Mutex::default(),
        }
    }

    /// The pencils through a click (full-size pixels): those compared before with the same parameters, or
    /// what `compare` finds.
    pub(crate) fn pencils(
        &self,
        click: &PointPair,
        parameters: &Parameters,
        compare: impl FnOnce() -> Result<PencilComparison, EstimateError>,
    ) -> Result<Arc<PencilComparison>, EstimateError> {
        // Entries are whole whatever happened to a thread that held the lock.
        let kept = || self.compared.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |c: &&Compared| c.click == *click && c.parameters == *parameters;
        if let Some(found) = kept().iter().find(same) {
            return Ok(Arc::clone(&found.comparison));
        }
        let comparison = Arc::new(compare()?);
        let mut kept = kept();
        kept.truncate(COMPARISONS_KEPT - 1);
        let (click, parameters) = (*click, parameters.clone());
        kept.push_front(Compared { click, parameters, comparison: Arc::clone(&comparison) });
        Ok(comparison)
    }

    /// Sizes of the two images.
    pub fn frames(&self) -> [Frame; 2] {
        [self.pyramids[0].level(0).frame(), self.pyramids[1].level(0).frame()]
    }

    /// The levels nearest to a longer side of `side` px, chosen for each image apart, so that images of
    /// different size are compared at like sizes.
    pub(crate) fn level(&self, side: f64) -> Level<'_> {
        let nearest = |pyramid: &Pyramid| {
            let off = |k: &usize| {
                let own = pyramid.level(*k).frame().longer_side();
                if side.is_finite() { (own / side).ln().abs() } else { -own }
            };
            (0..pyramid.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        };
        let [k1, k2] = [nearest(&self.pyramids[0]), nearest(&self.pyramids[1])];
        Level {
            planes: [self.pyramids[0].level(k1), self.pyramids[1].level(k2)],
            scales: [0.5f64.powi(k1 as i32), 0.5f64.powi(k2 as i32)],
        }
    }

    /// Refines `f` level by level up to full size; `None` when there are too few matches at the first, or when stopped.
    pub(crate) fn refine(
        &self,
        f: &FundamentalMatrix,
        clicks: &[PointPair],
        click_sigma: f64,
        monitor: &Monitor,
    ) -> Option<Refined> {
        let mut refined: Option<Refined> = None;
        let mut done = None;
        for (side, stage) in REFINEMENT_SIDES.iter().zip(&self.refinement) {
            let level = self.level(*side);
            if done == Some(level.scales) {
                break;
            }
            let start = refined.as_ref().map_or(*f, |r| r.fundamental);
            match stage.refine(&level, &start, clicks, click_sigma, monitor) {
                Some(result) => refined = Some(result),
                None => break,
            }
            done = Some(level.scales);
        }
        refined
    }

    pub(crate) fn fine_witness(&self) -> &FineWitness {
        self.fine_witness.get_or_init(|| {
            let level = self.level(FINE_SIDE);
            FineWitness { scales: level.scales, support: Support::new(level.planes, FINE_CORNERS, &warps()) }
        })
    }

    pub(crate) fn witness(&self) -> &Witness {
        self.witness.get_or_init(|| {
            let level = self.level(WITNESS_SIDE);
            let support = Support::new(level.planes, WITNESS_CORNERS, &warps());
            let electorate = Electorate::new(&support, VOTES_PER_CORNER);
            Witness { scales: level.scales, support, electorate }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::similarity::CostMatrix;

    #[test]
    fn pencils_are_compared_once_for_a_click_and_parameters() {
        let plane = GrayPlane::from_fn(Frame::new(64, 64), |x, y| ((x * y) % 251) as f32);
        let prepared = PreparedPair::new(&plane, &plane);
        let comparison = || PencilComparison {
            angles1: Vec::new(),
            angles2: Vec::new(),
            lines: [0, 0],
            costs: CostMatrix::new(0, 0, Vec::new()),
            candidates: Vec::new(),
        };
        let mut compared = 0;
        let mut ask = |x: f64, parameters: &Parameters| {
            let found = prepared.pencils(&PointPair::new(x, 1.0, 2.0, 3.0), parameters, || {
                compared += 1;
                Ok(comparison())
            });
            found.unwrap();
            compared
        };
        let (usual, coarser) =
            (Parameters::default(), Parameters { coarse_side: 96.0, ..Parameters::default() });
        assert_eq!([ask(0.0, &usual), ask(0.0, &usual), ask(0.0, &coarser), ask(0.0, &usual)], [1, 1, 2, 2]);
        // Others push the first one out.
        for x in 1..5 {
            ask(f64::from(x), &usual);
        }
        assert_eq!(ask(0.0, &usual), 7);
        let stopped =
            prepared.pencils(&PointPair::new(9.0, 9.0, 9.0, 9.0), &usual, || Err(EstimateError::Cancelled));
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
