//! Everything that is computed once for an image pair and serves any clicks: pyramids, patches,
//! features, compared pencils.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Matrix3;

use crate::estimate::evidence::features::{MatchedFeatures, putative};
use crate::estimate::evidence::lazy::Lazy;
use crate::estimate::evidence::lines::ComparedPencils;
use crate::estimate::evidence::patches::PatchLevels;
use crate::estimate::fit::{Match, MatchFitError, Uncertainty, estimate_essential, fit_given};
use crate::estimate::{CancelFlag, EstimateError, Parameters, PencilParameters};
use crate::features::FeatureViews;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::{GrayPlane, PyramidPair, RelativeView};
use crate::motion::{MotionError, Silhouettes};
use crate::similarity::{BarcodeSource, LineMeasure, PictureSource, SimilarityParameters, SimilaritySource};

/// Two images made ready for estimates. Keep it while the images stay the same. A moved click then
/// costs only the work that depends on the clicks.
///
/// Clones share everything that is made from the images. Each has its own matches from elsewhere and its own
/// calibrations.
#[derive(Debug, Clone)]
pub struct PreparedPair {
    pyramids: Arc<PyramidPair>,
    upright: Arc<PatchLevels>,
    features: Arc<Lazy<MatchedFeatures>>,
    slanted: Arc<Lazy<MatchedFeatures>>,
    /// The latest views with features, newest first.
    views: Arc<Mutex<VecDeque<Arc<PatchLevels>>>>,
    pencils: Arc<PencilCache>,
    silhouettes: Option<[Arc<Silhouettes>; 2]>,
    given: Option<Arc<GivenMatches>>,
    calibrations: Option<[Matrix3<f64>; 2]>,
}

/// Matches from elsewhere.
#[derive(Debug)]
pub(in crate::estimate) struct GivenMatches {
    pub all: Vec<Match>,
    /// Geometry on which they agree.
    pub fit: Result<GivenFit, MatchFitError>,
}

/// Geometry on which matches from elsewhere agree.
#[derive(Debug)]
pub(in crate::estimate) struct GivenFit {
    pub fundamental: FundamentalMatrix,
    /// Matches that the geometry explains.
    pub inliers: Vec<PointPair>,
    /// Distance below which 95 % of the right matches lie, px.
    pub reach: f64,
    pub uncertainty: Option<Uncertainty>,
    /// Whether the geometry is an essential matrix.
    pub is_posed: bool,
}

/// Least longer side of a pyramid level, px. Parameters that ask for smaller images get the
/// smallest level.
const SMALLEST_LEVEL: f64 = 48.0;
/// Number of views kept, besides the upright one. Each takes some ten megabytes. No result depends
/// on it.
const VIEWS_KEPT: usize = 4;

impl PreparedPair {
    /// Builds the pyramids in parallel. Everything else is made when it is first needed.
    pub fn new(image1: &GrayPlane, image2: &GrayPlane) -> Self {
        let pyramids = Arc::new(PyramidPair::new(image1, image2, SMALLEST_LEVEL));
        Self {
            upright: Arc::new(PatchLevels::new(&pyramids, RelativeView::UPRIGHT)),
            pyramids,
            features: Arc::default(),
            slanted: Arc::default(),
            views: Arc::default(),
            pencils: Arc::default(),
            silhouettes: None,
            given: None,
            calibrations: None,
        }
    }

    /// Adds matches from another program. The geometry that they agree on competes with the program's
    /// own; the images judge it as strictly. It is the result where the images alone show none.
    /// Matches near the lines of the result weigh in its final fit, by their own noise. If
    /// [`given_alone`](crate::estimate::FeatureParameters::given_alone) is set, their geometry is the
    /// result as it is.
    ///
    /// # Errors
    /// The errors of [`estimate_fundamental`](crate::estimate::estimate_fundamental). The matches take no part then,
    /// and an estimate from them alone fails.
    pub fn add_matches(&mut self, matches: &[Match], seed: u64) -> Result<(), MatchFitError> {
        let fit = fit_given(matches, self.frames(), self.calibrations, seed);
        let outcome = fit.as_ref().map(|_| ()).map_err(|error| *error);
        let fit = fit.map(|fit| GivenFit {
            fundamental: fit.fundamental,
            inliers: fit.agreeing(matches),
            reach: fit.noise.reach(),
            uncertainty: fit.uncertainty,
            is_posed: fit.is_posed,
        });
        self.given = Some(Arc::new(GivenMatches { all: matches.to_vec(), fit }));
        outcome
    }

    /// Returns the reason why the matches from elsewhere take no part, if so.
    pub fn unused_matches(&self) -> Option<MatchFitError> {
        self.given.as_ref()?.fit.as_ref().err().copied()
    }

    /// Tells the calibration matrices of the cameras, before matches are added. The images are views without
    /// distortion. The result is then an essential matrix, unless the matches show that the calibration is wrong.
    #[must_use]
    pub fn with_calibrations(self, calibrations: Option<[Matrix3<f64>; 2]>) -> Self {
        Self { calibrations, ..self }
    }

    pub(in crate::estimate) fn calibrations(&self) -> Option<[Matrix3<f64>; 2]> {
        self.calibrations
    }

    /// Returns the matches from elsewhere.
    pub(in crate::estimate) fn given(&self) -> Option<&GivenMatches> {
        self.given.as_deref()
    }

    /// Returns the geometry on which the matches from elsewhere agree.
    pub(in crate::estimate) fn given_fit(&self) -> Option<&GivenFit> {
        self.given.as_ref()?.fit.as_ref().ok()
    }

    /// Returns the matches from elsewhere if the geometry is fitted to them alone. Fails if they agree on
    /// none.
    pub(in crate::estimate) fn given_alone(
        &self,
        parameters: &Parameters,
    ) -> Result<Option<&GivenFit>, MatchFitError> {
        let wanted = self.given.as_ref().filter(|_| parameters.features.given_alone);
        wanted.map(|given| given.fit.as_ref().map_err(|error| *error)).transpose()
    }

    /// Adds the silhouettes of moving objects in front of two static cameras. Both sequences have
    /// the same number of frames, of the size of the images.
    #[must_use]
    pub fn with_silhouettes(self, silhouettes: [Arc<Silhouettes>; 2]) -> Self {
        // Pencils depend on the silhouettes.
        Self { silhouettes: Some(silhouettes), pencils: Arc::default(), ..self }
    }

    /// Prepares the sequences of two static cameras. The images show the views of the cameras and
    /// have the size of the frames. Frame `k` of the first sequence was taken at the same time as
    /// frame `k + offset` of the second.
    pub fn of_sequences(
        image1: &GrayPlane,
        image2: &GrayPlane,
        silhouettes: [&Silhouettes; 2],
        offset: i32,
    ) -> Result<Self, MotionError> {
        let together = Silhouettes::overlapping(silhouettes, offset)?;
        Ok(Self::new(image1, image2).with_silhouettes(together.map(Arc::new)))
    }

    /// Makes everything that a search by patches needs and that no click changes. Called before the
    /// first click, it shortens the first search. A search that begins meanwhile waits for the part
    /// under way and does not make it again.
    pub fn make_ready(&self, cancel: &CancelFlag) {
        let upright = &*self.upright;
        let parts: [fn(&PatchLevels); 4] = [
            |levels| _ = levels.coarse(),
            |levels| _ = levels.voting(),
            |levels| _ = levels.fine(),
            PatchLevels::prepare_refinement,
        ];
        parts.iter().take_while(|_| !cancel.is_cancelled()).for_each(|part| part(upright));
    }

    /// Returns the silhouettes of both cameras, if the pair has sequences.
    pub fn silhouettes(&self) -> Option<[&Silhouettes; 2]> {
        self.silhouettes.as_ref().map(|[first, second]| [&**first, &**second])
    }

    /// Returns the sizes of the two images.
    pub fn frames(&self) -> [Frame; 2] {
        self.pyramids.frames()
    }

    /// Returns the pyramids of both images.
    pub fn pyramids(&self) -> &PyramidPair {
        &self.pyramids
    }

    /// Returns the covariant features of both images and their matches.
    pub(in crate::estimate) fn features(&self, views: FeatureViews) -> &MatchedFeatures {
        let frontal = || self.features.get_or_make(|| MatchedFeatures::frontal(&self.pyramids));
        match views {
            FeatureViews::Frontal => frontal(),
            FeatureViews::Slanted => self.slanted.get_or_make(|| frontal().with_slanted(&self.pyramids)),
        }
    }

    /// Returns the matches of covariant features as observations for a fit. They were found without any
    /// geometry, and many may be wrong.
    pub fn putative_matches(&self) -> Vec<Match> {
        let MatchedFeatures { sets, matches, .. } = self.features(FeatureViews::Frontal);
        putative(sets.each_ref(), matches, self.frames())
    }

    /// Returns the geometry of known cameras that most matches of features agree on, and these matches. `None` if
    /// the cameras are not known, or too few matches agree.
    pub(in crate::estimate) fn essential_of_features(
        &self,
        of: FeatureViews,
        seed: u64,
    ) -> Option<(FundamentalMatrix, Vec<PointPair>)> {
        let calibrations = self.calibrations?;
        let MatchedFeatures { sets, matches, .. } = self.features(of);
        let putative = putative(sets.each_ref(), matches, self.frames());
        let fit = estimate_essential(&putative, self.frames(), calibrations, seed).ok()?;
        let right = putative.iter().zip(&fit.inlier_probabilities).filter(|(_, right)| **right > 0.5);
        Some((fit.fundamental, right.map(|(m, _)| m.pair).collect()))
    }

    /// Returns the patches of the upright view, without features.
    pub(in crate::estimate) fn upright_patches(&self) -> Arc<PatchLevels> {
        Arc::clone(&self.upright)
    }

    /// Returns the patches of a view, with the matches of features.
    pub(in crate::estimate) fn patches_with_features(
        &self,
        view: RelativeView,
        of: FeatureViews,
    ) -> Arc<PatchLevels> {
        // Features are found before the lock is taken: their threads may ask for it.
        let matched = self.features(of);
        // A panic of a thread that held the lock leaves all entries complete.
        let mut views = self.views.lock().unwrap_or_else(PoisonError::into_inner);
        let mut under_view = views.iter().filter(|patches| patches.view() == view);
        if let Some(kept) = under_view.clone().find(|patches| patches.features() == Some(of)) {
            return Arc::clone(kept);
        }
        // Corners already compared under this view are used again.
        let corners = if view == RelativeView::UPRIGHT { Some(&self.upright) } else { under_view.next() };
        let patches = corners.map_or_else(|| Arc::new(PatchLevels::new(&self.pyramids, view)), Arc::clone);
        let patches = Arc::new(patches.with_features(of, matched.supports()));
        views.truncate(VIEWS_KEPT - 1);
        views.push_front(Arc::clone(&patches));
        patches
    }

    /// Returns the similarity in which lines are compared under a view.
    pub(in crate::estimate) fn similarity_source(
        &self,
        view: RelativeView,
        parameters: &Parameters,
    ) -> Box<dyn SimilaritySource + '_> {
        if let (LineMeasure::Barcodes, Some(silhouettes)) = (parameters.similarity.measure, &self.silhouettes)
        {
            return Box::new(BarcodeSource { silhouettes: silhouettes.clone() });
        }
        Box::new(PictureSource { pyramids: &self.pyramids, view, parameters: parameters.similarity })
    }

    /// Returns the compared pencils through a click, full-size pixels. Calls `compare` when none
    /// are kept.
    pub(in crate::estimate) fn pencils(
        &self,
        click: &PointPair,
        view: RelativeView,
        parameters: &Parameters,
        compare: impl FnOnce() -> Result<ComparedPencils, EstimateError>,
    ) -> Result<Arc<ComparedPencils>, EstimateError> {
        self.pencils.get((view, parameters.similarity, parameters.pencils), click, compare)
    }
}

/// Latest compared pencils, newest first. While one click is dragged, the pencils of the others
/// stay.
#[derive(Debug, Default)]
struct PencilCache(Mutex<VecDeque<(PencilKey, Arc<ComparedPencils>)>>);

/// Everything that pencils depend on, besides the images and the click.
type PencilKey = (RelativeView, SimilarityParameters, PencilParameters);

/// Number of compared pencils kept. Each takes some hundred kilobytes. No result depends on it.
const COMPARISONS_KEPT: usize = 4;

impl PencilCache {
    fn get(
        &self,
        key: PencilKey,
        click: &PointPair,
        compare: impl FnOnce() -> Result<ComparedPencils, EstimateError>,
    ) -> Result<Arc<ComparedPencils>, EstimateError> {
        // A panic of a thread that held the lock leaves all entries complete.
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
    use rayon::prelude::*;

    use super::*;

    #[test]
    fn making_ready_changes_no_result() {
        let scene = crate::estimate::exact::ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let estimate = |prepared: &PreparedPair| {
            let (clicks, parameters) = (scene.clicks(), Parameters::default());
            let monitor = crate::estimate::Monitor::silent();
            *crate::estimate::estimate_prepared(prepared, &clicks, &parameters, &monitor)
                .unwrap()
                .fundamental()
        };
        let ready = PreparedPair::new(&plane1, &plane2);
        ready.make_ready(&CancelFlag::default());
        assert_eq!(estimate(&ready), estimate(&PreparedPair::new(&plane1, &plane2)));
        // A cancelled preparation returns.
        let cancel = CancelFlag::default();
        cancel.cancel();
        PreparedPair::new(&plane1, &plane2).make_ready(&cancel);
    }

    #[test]
    fn preparation_and_estimates_side_by_side_do_not_deadlock() {
        // A deadlock shows as a timeout.
        let scene = crate::estimate::exact::ExactScene::aside();
        let (planes, clicks) = (scene.planes(), scene.clicks());
        let (done, finished) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            for _ in 0..12 {
                let prepared = PreparedPair::new(&planes[0], &planes[1]);
                std::thread::scope(|scope| {
                    scope.spawn(|| prepared.make_ready(&CancelFlag::default()));
                    scope.spawn(|| {
                        let (parameters, monitor) =
                            (Parameters::default(), crate::estimate::Monitor::silent());
                        crate::estimate::estimate_prepared(&prepared, &clicks, &parameters, &monitor)
                            .unwrap();
                    });
                });
            }
            done.send(()).unwrap();
        });
        finished.recv_timeout(std::time::Duration::from_mins(5)).expect("both end");
    }

    #[test]
    fn searches_of_one_pair_run_side_by_side_on_a_pool() {
        let scene = crate::estimate::exact::ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let prepared = PreparedPair::new(&plane1, &plane2);
        let estimate = |_| {
            let (parameters, monitor) = (Parameters::default(), crate::estimate::Monitor::silent());
            *crate::estimate::estimate_prepared(&prepared, &scene.clicks(), &parameters, &monitor)
                .unwrap()
                .fundamental()
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let found: Vec<_> = pool.install(|| (0..4).into_par_iter().map(estimate).collect());
        assert!(found.iter().all(|f| *f == estimate(0)));
    }

    #[test]
    fn pencils_are_compared_once_for_a_click_and_its_parameters() {
        let plane = GrayPlane::from_fn(Frame::new(64, 64), |x, y| ((x * y) % 251) as f32);
        let prepared = PreparedPair::new(&plane, &plane);
        let mut compared = 0;
        let mut ask = |x: f64, parameters: &Parameters| {
            let click = PointPair::new(x, 1.0, 2.0, 3.0);
            let found = prepared.pencils(&click, RelativeView::UPRIGHT, parameters, || {
                compared += 1;
                Ok(ComparedPencils::of_so_many(click, 0, 0))
            });
            assert_eq!(found.unwrap().click, click);
            compared
        };
        let usual = Parameters::default();
        let mut coarser = usual.clone();
        coarser.pencils.coarse_side = 64.0;
        let elsewhere = Parameters { seed: 9, hypotheses: 5, click_sigma: 2.0, ..usual.clone() };
        let asked = [ask(0.0, &usual), ask(0.0, &elsewhere), ask(0.0, &coarser), ask(0.0, &usual)];
        assert_eq!(asked, [1, 1, 2, 2]);
        // Four other clicks push the first one out.
        for x in 1..5 {
            ask(f64::from(x), &usual);
        }
        assert_eq!(ask(0.0, &usual), 7);
        let click = PointPair::new(9.0, 9.0, 9.0, 9.0);
        let stopped =
            prepared.pencils(&click, RelativeView::UPRIGHT, &usual, || Err(EstimateError::Cancelled));
        assert_eq!(stopped.unwrap_err(), EstimateError::Cancelled);
    }
}
