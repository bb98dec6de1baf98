//! Requests to the tasks, made from the current state.

use super::Model;
use super::comparison::ComparisonQuestion;
use super::computation::{EstimateRequest, Freshness};
use super::document::Imported;
use super::focus::Target;
use super::ids::{StageId, TabId};
use super::inspection::InspectionRequest;
use super::picture::Pictures;
use super::rectified::{MatchesAtHand, RectifyQuestion};
use super::scene::{Scene, SceneQuestion};
use super::shared::Shared;
use super::suggesting::{LensQuestion, PairsQuestion, SuggestQuestion};
use crate::convention::FEWEST_MATCHES;
use crate::estimate::{DivisionFit, Estimate, Reason, Search, Verdict};
use crate::geometry::PointPair;
use crate::io::PairOrigin;
use crate::study::ShownGeometry;

impl Model {
    /// Returns the request for a scene: for a final result on calibrated pictures whose epipole is determined.
    /// Only the final verdict tells whether it is.
    pub fn scene_question(&self) -> Option<SceneQuestion> {
        let found = self.final_result().filter(|found| !found.says_one_plane())?;
        let left = self.open.pictures.as_ref()?[0].picture.clone();
        Some(SceneQuestion { left, found, views: self.open.posed_views()? })
    }

    /// Returns the scene of the present result. A scene of another result or of other views is never
    /// returned.
    pub fn scene(&self) -> Option<&Scene> {
        let scene = self.open.scene.as_ref()?.as_ref()?;
        scene.is_of(&self.scene_question()?).then_some(scene)
    }

    /// Returns whether a scene waits for the verdict of the running search.
    pub fn awaits_scene(&self) -> bool {
        let computation = &self.open.computation;
        computation.is_running() && computation.result().is_some() && self.open.posed_views().is_some()
    }

    /// Returns whether there is a scene, one is being made, or the stage says why there is none.
    pub fn offers_scene(&self) -> bool {
        let is_asked = self.scene_question().is_some() && !matches!(self.open.scene, Some(None));
        self.awaits_scene() || self.epipole_is_open() || is_asked
    }

    /// Describes the scene point under the cursor.
    pub fn pointed_in_scene(&self) -> Option<String> {
        let Some(Target::Match(number)) = self.open.focus.hovered() else { return None };
        let scene = self.scene().filter(|_| self.stage() == StageId::Scene)?;
        let place = scene.point(number)?.place;
        let parallax = scene.cloud.parallax(&place).to_degrees();
        Some(format!("Match {}   depth {:.2} baselines   parallax {parallax:.2}°", number + 1, place.z))
    }

    /// Returns the pictures whose patches a search will need.
    pub fn pictures_to_prepare(&self) -> Option<Pictures> {
        let by_patches = self.document.parameters.search == Search::Patches && !self.compares_barcodes();
        self.open.pictures().filter(|_| by_patches)
    }

    /// Returns the request for an estimate, once there are enough pairs.
    pub fn estimate_request(&self) -> Option<EstimateRequest> {
        Some(EstimateRequest {
            pictures: self.open.pictures()?,
            recordings: self.compared_recordings(),
            views: self.open.searched_views(),
            pairs: self.document.used_pairs()?,
            given: self.document.given.as_ref().map(|given| given.matches.clone()),
            parameters: self.document.search_parameters(),
        })
    }

    /// Returns the lines to match, while something shows them. Matching would keep a core busy
    /// during a drag.
    pub fn inspection_request(&self, exports: bool) -> Option<InspectionRequest> {
        if self.compares_barcodes() {
            return None;
        }
        let is_shown = match self.tab() {
            Some(TabId::Profiles) => true,
            Some(TabId::Step) => self.open.replay.moment().is_some_and(|moment| moment.filled.is_some()),
            _ => false,
        };
        let wanted = exports || is_shown || !self.document.pins.is_empty();
        let inspected = wanted.then(|| self.inspected()).flatten()?;
        let pictures = self.open.pictures()?;
        let [left, right] = pictures.each_ref().map(|picture| picture.frame().longer_side());
        let view = self.open.computation.searched().map(Estimate::view);
        let scale = view.and_then(|view| view.scale).unwrap_or(right / left);
        Some(InspectionRequest::new(pictures, inspected.lines, scale, &self.document.parameters))
    }

    /// Returns the request for a comparison, while something shows it.
    pub fn comparison_question(&self) -> Option<ComparisonQuestion> {
        let tab = matches!(self.tab(), Some(TabId::Residuals | TabId::Compare));
        let is_wanted = self.truth().is_some() || self.open.focus.contestant().is_some();
        if !(tab || is_wanted) {
            return None;
        }
        let document = &self.document;
        Some(ComparisonQuestion {
            result: self.result().map(ShownGeometry::from),
            shown: self.shown().map(|shown| *shown.fundamental),
            imported: document.imported.as_ref().map(Imported::geometry),
            pairs: document.pairs.clone(),
            excluded: document.excluded.iter().copied().collect(),
            used: document.used().map(|pair| document.pairs[pair]).collect(),
            given: document.given.as_ref().map(|given| given.matches.clone()),
            frames: document.frames()?,
            truth: self.truth().and(self.open.known()).map(|known| known.truth.clone()),
            subject: self.look.compared,
        })
    }

    /// Returns the request for a suggested match. None for sequences: their cameras are too far
    /// apart for patches.
    pub fn suggest_question(&self) -> Option<SuggestQuestion> {
        if self.compares_barcodes() {
            return None;
        }
        let found = self.trusted_result();
        let placed = if found.is_none() {
            self.document.used().map(|pair| self.document.pairs[pair]).collect()
        } else {
            Vec::new()
        };
        Some(SuggestQuestion { half: self.document.half?, pictures: self.open.pictures()?, found, placed })
    }

    /// Returns the request for the next click: for a doubtful result of a search that uses all
    /// pairs.
    pub fn next_click_question(&self) -> Option<PairsQuestion> {
        let document = &self.document;
        if document.parameters.search != Search::Patches
            || document.half.is_some()
            || self.compares_barcodes()
        {
            return None;
        }
        let found = self.final_result()?;
        let trust = found.assessment.trust.as_ref().filter(|trust| trust.verdict != Verdict::Reliable)?;
        // If the verdict only names clicked pairs, or if all of them contradict the images, these should be corrected
        // first. More pairs on a plane, or of a turned camera, do not show the epipole.
        let are_contradicted = trust.reasons.contains(&Reason::ClicksAlone);
        if trust.doubts_clicks_alone() || are_contradicted || trust.says_one_plane() {
            return None;
        }
        Some(PairsQuestion { pictures: self.open.pictures()?, found, pairs: document.pairs.clone() })
    }

    /// Returns the lens that explains the matches of the result clearly better.
    pub fn offered_lens(&self) -> Option<&DivisionFit> {
        let (question, lens) = self.open.lens.as_ref()?;
        lens.as_ref().filter(|_| self.lens_question().is_some_and(|now| now == *question))
    }

    /// Returns the request for a lens: for a result of pictures without a calibration. Guessed focal lengths are none.
    pub fn lens_question(&self) -> Option<LensQuestion> {
        let is_wanted = self.document.parameters.search == Search::Patches
            && !self.compares_barcodes()
            && self.open.views().is_none_or(|views| views.is_guessed());
        let found = self.final_result().filter(|_| is_wanted)?;
        Some(LensQuestion { pictures: self.open.pictures()?, found })
    }

    /// Returns the final result, unless it is unreliable.
    pub fn trusted_result(&self) -> Option<Shared<Estimate>> {
        let is_trusted = |found: &Shared<Estimate>| {
            let trust = found.assessment.trust.as_ref();
            trust.is_none_or(|trust| !trust.verdict.is_unreliable())
        };
        self.final_result().filter(is_trusted)
    }

    /// Returns whether the rectified pair is visible.
    pub fn wants_rectified(&self) -> bool {
        self.stage() == StageId::Rectified
    }

    /// Returns the request for a rectified pair, once there is a geometry.
    pub fn rectify_question(&self) -> Option<RectifyQuestion> {
        let shown = self.shown()?;
        let matches = self.matches_beside();
        let dragging = self.open.hover.is_some_and(|hover| hover.dragging);
        Some(RectifyQuestion {
            pictures: self.open.pictures()?,
            fundamental: *shown.fundamental,
            matches,
            scene: self.known_matches().into_iter().chain([self.matches_at_hand()]).collect(),
            method: self.document.rectification,
            moving: shown.freshness == Freshness::Followed || dragging,
            bent: self.open.undistorted().and_then(|views| {
                Some((self.open.pictures.as_ref()?.each_ref().map(|opened| opened.shown().clone()), views))
            }),
        })
    }

    /// Returns the matches for measuring the shown geometry: true ones, else matches of the result,
    /// else clicked pairs.
    pub fn matches_beside(&self) -> MatchesAtHand {
        let known = self.truth().and_then(|_| self.known_matches());
        known.unwrap_or_else(|| self.matches_at_hand())
    }

    /// Returns the true matches, whether or not the ground truth is in use.
    fn known_matches(&self) -> Option<MatchesAtHand> {
        self.open.known().map(|known| MatchesAtHand::True(known.truth.clone()))
    }

    /// Returns the matches of the result, or else the clicked pairs.
    fn matches_at_hand(&self) -> MatchesAtHand {
        let found = self.open.computation.shared_result().filter(|(found, _)| !found.matches().is_empty());
        found.map_or_else(
            || MatchesAtHand::Clicked(self.document.pairs.clone()),
            |(found, _)| MatchesAtHand::Found(found),
        )
    }

    /// Returns the matches for checking an imported matrix: true ones, unless a trusted result has more; else the pairs
    /// of the user, or the matches of the result. Pairs made from matches count as those. True ones are not revealed.
    pub fn matches_for_import(&self) -> MatchesAtHand {
        let clicked: Vec<PointPair> = self.document.included().collect();
        let own = self.document.labels().filter(|label| label.origin != PairOrigin::Automatic).count();
        let found = self.open.computation.shared_result().filter(|(found, of)| {
            *of == Freshness::Final && found.matches().len() >= FEWEST_MATCHES && own < FEWEST_MATCHES
        });
        // A dozen matches fit by chance where the size of the pictures is sought, too.
        let more = found.as_ref().filter(|(found, _)| found.may_contradict());
        let more = more.map_or(0, |(found, _)| found.matches().len());
        let known = self.open.known().map(|known| known.truth.clone());
        if let Some(truth) = known.filter(|truth| truth.matches.len() >= FEWEST_MATCHES.max(more)) {
            return MatchesAtHand::True(truth);
        }
        found.map_or(MatchesAtHand::Clicked(clicked), |(found, _)| MatchesAtHand::Found(found))
    }

    fn final_result(&self) -> Option<Shared<Estimate>> {
        let (found, freshness) = self.open.computation.shared_result()?;
        (freshness == Freshness::Final).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::fake;
    use crate::app::model::computation::EstimateNews;
    use crate::estimate::{RefinedMatch, Refinement};

    #[test]
    fn kept_matches_do_not_stand_for_all_matches_of_the_result() {
        let pair = |k: u8| PointPair::new(f64::from(k), 5.0, f64::from(k) + 1.0, 6.0);
        let pairs: Vec<PointPair> = (0..20).map(pair).collect();
        let request = fake::request(1.0);
        let mut found = fake::result(&request.pairs, &request.parameters).unwrap();
        let matches = pairs.iter().map(|pair| RefinedMatch { pair: *pair, correlation: 1.0 }).collect();
        found.assessment.refinement =
            Some(Refinement { matches, uncertainty: None, noise: None, is_posed: false });
        let mut model = Model::default();
        model.open.computation.adopt(Some(&request));
        model.open.computation.begin(1, false);
        model.open.computation.take(1, EstimateNews::Finished(Ok(Box::new(found))));
        model.document.keep_as_checks(&pairs[..9]);
        assert_eq!(model.matches_for_import().pairs().len(), 20);
        model.document.set_pairs(pairs[..9].to_vec(), PairOrigin::Clicked);
        assert_eq!(model.matches_for_import().pairs().len(), 9);
    }
}
