//! Two pictures, and the search for their geometry.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use nalgebra::Matrix3;

use super::cameras::undistorted;
use crate::camera::ViewPair;
use crate::estimate::{
    CancelFlag, DivisionFit, Estimate, EstimateError, Lazy, Match, MatchFitError, Monitor, Parameters,
    PreparedPair, estimate_since, find_lens, follow,
};
use crate::geometry::{Frame, PointPair};
use crate::image::Picture;
use crate::motion::Silhouettes;

/// Two pictures with everything that is known about them before the first click.
///
/// The first question makes the pyramids, patches and features of the pictures. Later questions and clones of the
/// study share them, so keep the study while the pictures stay the same.
#[derive(Debug, Clone)]
pub struct Study {
    /// The pictures in their views.
    pictures: [Arc<Picture>; 2],
    views: Option<ViewPair>,
    silhouettes: Option<[Arc<Silhouettes>; 2]>,
    made: Arc<Made>,
}

/// Data that is made from the pictures at its first use.
#[derive(Debug, Default)]
struct Made {
    /// The pictures alone.
    images: Lazy<PreparedPair>,
    /// The pictures with the cameras and the matches of the latest question that has matches.
    with_given: Mutex<Option<WithGiven>>,
}

#[derive(Debug)]
struct WithGiven {
    given: Vec<Match>,
    calibrations: Option<[Matrix3<f64>; 2]>,
    seed: u64,
    prepared: PreparedPair,
}

/// Everything that an estimate depends on, besides the pictures. All points are places in the views.
#[derive(Debug, Clone, Copy)]
pub struct Question<'a> {
    /// Clicked point pairs.
    pub clicks: &'a [PointPair],
    /// Matches of another program.
    pub given: Option<&'a [Match]>,
    /// Parameters of the search.
    pub parameters: &'a Parameters,
}

impl Study {
    /// Studies pictures as they are.
    pub fn of_pictures<P: Into<Arc<Picture>>>(pictures: [P; 2]) -> Self {
        Self { pictures: pictures.map(Into::into), views: None, silhouettes: None, made: Arc::default() }
    }

    /// Draws the pictures in views without distortion.
    #[must_use]
    pub fn with_views(self, views: ViewPair) -> Self {
        let Self { pictures, made, .. } = &self;
        let drawn = [0, 1].map(|k| undistorted(&views.views[k], &pictures[k]));
        let made = if views.is_undistorted() { Arc::default() } else { Arc::clone(made) };
        Self { pictures: drawn, views: Some(views), made, ..self }
    }

    /// Tells the views of pictures that are drawn in them already, or that there are none.
    #[must_use]
    pub fn drawn_in(self, views: Option<ViewPair>) -> Self {
        Self { views, ..self }
    }

    /// Adds the silhouettes of moving objects in front of two static cameras. Both sequences have the same
    /// number of frames, of the size of the pictures.
    #[must_use]
    pub fn with_silhouettes(self, silhouettes: [Arc<Silhouettes>; 2]) -> Self {
        Self { silhouettes: Some(silhouettes), made: Arc::default(), ..self }
    }

    /// Returns the pictures in their views.
    pub fn pictures(&self) -> [&Picture; 2] {
        self.pictures.each_ref().map(AsRef::as_ref)
    }

    /// Returns the sizes of the pictures in their views.
    pub fn frames(&self) -> [Frame; 2] {
        self.pictures().map(Picture::frame)
    }

    /// Returns the views, if the cameras are known.
    pub fn views(&self) -> Option<&ViewPair> {
        self.views.as_ref()
    }

    /// Returns whether a search uses the cameras of these views: both focal lengths are known. A guessed length
    /// would bend the geometry.
    pub fn searches_with(views: &ViewPair) -> bool {
        views.known_calibrations().is_some()
    }

    /// Makes everything that a search by patches needs and that no click changes. Called before the first
    /// click, it shortens the first search.
    pub fn make_ready(&self, cancel: &CancelFlag) {
        self.images().make_ready(cancel);
    }

    /// Checks whether the given matches agree on a geometry.
    ///
    /// # Errors
    /// The reason why they take no part in the search.
    pub fn check_given(&self, question: &Question) -> Result<(), MatchFitError> {
        self.asked(question).unused_matches().map_or(Ok(()), Err)
    }

    /// Searches for the geometry of the views. The result is an essential matrix where the cameras take part
    /// ([`Study::searches_with`]), unless the matches show that the calibration is wrong. Given matches that agree
    /// on no geometry take no part.
    ///
    /// # Errors
    /// The errors of [`estimate`](crate::estimate::estimate()).
    pub fn solve(&self, question: &Question, monitor: &Monitor) -> Result<Estimate, EstimateError> {
        let begun = Instant::now();
        let prepared = self.asked(question);
        estimate_since(begun, &prepared, question.clicks, question.parameters, monitor)
    }

    /// Refits the best supported of some earlier geometries to moved clicks, within milliseconds. `None` as for
    /// [`follow`], and for sequences: the refit uses patches, and sequences are compared by barcodes.
    pub fn follow(
        &self,
        starts: &[&Estimate],
        clicks: &[PointPair],
        parameters: &Parameters,
    ) -> Option<Estimate> {
        if self.silhouettes.is_some() {
            return None;
        }
        follow(self.images(), starts.iter().copied(), clicks, parameters)
    }

    /// Finds the radial distortion that explains the matches clearly better than a result without it
    /// ([`find_lens`]).
    pub fn find_lens(&self, found: &Estimate) -> Option<DivisionFit> {
        find_lens(self.images(), found)
    }

    /// Returns matches of features that were found without a geometry. Many may be wrong.
    pub fn putative_pairs(&self) -> Vec<PointPair> {
        self.images().putative_matches().iter().map(|found| found.pair).collect()
    }

    /// Returns the prepared pictures.
    pub(super) fn images(&self) -> &PreparedPair {
        self.made.images.get_or_make(|| {
            let [image1, image2] = &self.pictures;
            let prepared = PreparedPair::new(&image1.gray, &image2.gray);
            match &self.silhouettes {
                Some(silhouettes) => prepared.with_silhouettes(silhouettes.clone()),
                None => prepared,
            }
        })
    }

    /// Returns the prepared pictures with the known cameras and the matches of a question. The fit of the latest
    /// matches is kept, since moved clicks do not change it.
    fn asked(&self, question: &Question) -> PreparedPair {
        let calibrations = self.views.as_ref().and_then(ViewPair::known_calibrations);
        let mut prepared = self.images().clone().with_calibrations(calibrations);
        let Some(given) = question.given else { return prepared };
        let seed = question.parameters.seed;
        // A panic of a thread that held the lock leaves the entry complete.
        let kept = || self.made.with_given.lock().unwrap_or_else(PoisonError::into_inner);
        let is_right =
            |kept: &&WithGiven| kept.seed == seed && kept.calibrations == calibrations && kept.given == given;
        if let Some(kept) = kept().as_ref().filter(is_right) {
            return kept.prepared.clone();
        }
        // The reason of a failure stays with the pair.
        let _ = prepared.add_matches(given, seed);
        *kept() = Some(WithGiven { given: given.to_vec(), calibrations, seed, prepared: prepared.clone() });
        prepared
    }
}
