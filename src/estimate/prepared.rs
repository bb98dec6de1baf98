//! What is computed once per image pair, whatever the clicks: pyramids, what patches need, compared pencils.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::lines::ComparedPencils;
use super::patches::{PatchLevels, SupportLevel};
use super::{EstimateError, Parameters, PencilParameters};
use crate::geometry::{Frame, PointPair};
use crate::image::{GrayPlane, PyramidPair};
use crate::similarity::{PictureSource, SimilarityParameters, SimilaritySource};

/// Two images made ready for estimates. Keep it while the images stay the same: moving a click then costs only
/// what depends on the click.
#[derive(Debug)]
pub struct PreparedPair {
    pyramids: PyramidPair,
    patches: PatchLevels,
    pencils: PencilCache,
}

/// Levels smaller than this are never used, px.
const SMALLEST_LEVEL: f64 = 48.0;

impl PreparedPair {
    /// Builds the pyramids, in parallel; everything else when it is first needed.
    pub fn new(image1: &GrayPlane, image2: &GrayPlane) -> Self {
        Self {
            pyramids: PyramidPair::new(image1, image2, SMALLEST_LEVEL),
            patches: PatchLevels::default(),
            pencils: PencilCache::default(),
        }
    }

    /// Sizes of the two images.
    pub fn frames(&self) -> [Frame; 2] {
        self.pyramids.frames()
    }

    /// Both images at the sizes of their pyramids.
    pub fn pyramids(&self) -> &PyramidPair {
        &self.pyramids
    }

    pub(super) fn patches(&self) -> &PatchLevels {
        &self.patches
    }

    pub(super) fn fine_support(&self) -> &SupportLevel {
        self.patches.fine(&self.pyramids)
    }

    /// What lines are compared in.
    pub(super) fn similarity_source(&self, parameters: &Parameters) -> Box<dyn SimilaritySource + '_> {
        Box::new(PictureSource { pyramids: &self.pyramids, parameters: parameters.similarity })
    }

    /// The pencils through a click (full-size pixels): those compared before, or what `compare` finds.
    pub(super) fn pencils(
        &self,
        click: &PointPair,
        parameters: &Parameters,
        compare: impl FnOnce() -> Result<ComparedPencils, EstimateError>,
    ) -> Result<Arc<ComparedPencils>, EstimateError> {
        self.pencils.get((parameters.similarity, parameters.pencils), click, compare)
    }
}

/// The latest compared pencils, newest first: while one click is dragged, those of the others stay.
#[derive(Debug, Default)]
struct PencilCache(Mutex<VecDeque<(PencilKey, Arc<ComparedPencils>)>>);

/// What pencils depend on besides the images and the click.
type PencilKey = (SimilarityParameters, PencilParameters);

/// Compared pencils kept: some hundred kilobytes each.
const COMPARISONS_KEPT: usize = 4;

impl PencilCache {
    fn get(
        &self,
        key: PencilKey,
        click: &PointPair,
        compare: impl FnOnce() -> Result<ComparedPencils, EstimateError>,
    ) -> Result<Arc<ComparedPencils>, EstimateError> {
        // Entries are whole whatever happened to a thread that held the lock.
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, found)) = kept().iter().find(|(of, pencils)| *of == key && pencils.click == *click) {
            return Ok(Arc::clone(found));
        }
        let pencils = Arc::new(compare()?);
        let mut kept = kept();
        kept.truncate(COMPARISONS_KEPT - 1);
        kept.push_front((key, Arc::clone(&pencils)));
        Ok(pencils)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::similarity::CostMatrix;

    #[test]
    fn pencils_are_compared_once_for_a_click_and_what_they_depend_on() {
        let plane = GrayPlane::from_fn(Frame::new(64, 64), |x, y| ((x * y) % 251) as f32);
        let prepared = PreparedPair::new(&plane, &plane);
        let empty = |click| ComparedPencils {
            click,
            angles1: Vec::new(),
            angles2: Vec::new(),
            lines_before: [0, 0],
            costs: CostMatrix::new(0, 0, Vec::new()),
            candidates: Vec::new(),
        };
        let mut compared = 0;
        let mut ask = |x: f64, parameters: &Parameters| {
            let click = PointPair::new(x, 1.0, 2.0, 3.0);
            let found = prepared.pencils(&click, parameters, || {
                compared += 1;
                Ok(empty(click))
            });
            assert_eq!(found.unwrap().click, click);
            compared
        };
        let usual = Parameters::default();
        let mut coarser = usual.clone();
        coarser.pencils.coarse_side = 96.0;
        let elsewhere = Parameters { seed: 9, hypotheses: 5, click_sigma: 2.0, ..usual.clone() };
        let asked = [ask(0.0, &usual), ask(0.0, &elsewhere), ask(0.0, &coarser), ask(0.0, &usual)];
        assert_eq!(asked, [1, 1, 2, 2]);
        // Others push the first one out.
        for x in 1..5 {
            ask(f64::from(x), &usual);
        }
        assert_eq!(ask(0.0, &usual), 7);
        let click = PointPair::new(9.0, 9.0, 9.0, 9.0);
        let stopped = prepared.pencils(&click, &usual, || Err(EstimateError::Cancelled));
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
