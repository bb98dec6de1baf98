//! What the tasks are asked, from the state as it is.

use super::Model;
use super::comparison::ComparisonQuestion;
use super::computation::{EstimateRequest, Freshness};
use super::ids::TabId;
use super::inspection::InspectionRequest;
use super::picture::Pictures;
use super::rectified::{MatchesAtHand, RectifyQuestion};
use super::suggesting::{NextClickQuestion, SuggestQuestion};
use crate::convention::FEWEST_MATCHES;
use crate::estimate::{Estimate, Reason, Search, Verdict};
use crate::geometry::PointPair;
use crate::suggest::Known;

impl Model {
    /// The pictures whose patches a search will ask for.
    pub fn pictures_to_prepare(&self) -> Option<Pictures> {
        let by_patches = self.document.parameters.search == Search::Patches && !self.compares_barcodes();
        self.open.pictures().filter(|_| by_patches)
    }

    /// What is to be estimated, once there are enough pairs.
    pub fn estimate_request(&self) -> Option<EstimateRequest> {
        Some(EstimateRequest {
            pictures: self.open.pictures()?,
            recordings: self.compared_recordings(),
            pairs: self.document.used_pairs()?,
            parameters: self.document.search_parameters(),
        })
    }

    /// The lines to be matched, while something shows them: matching keeps a core busy while a point is dragged.
    pub fn inspection_request(&self, exports: bool) -> Option<InspectionRequest> {
        if self.compares_barcodes() {
            return None;
        }
        let wanted = exports || self.tab() == Some(TabId::Profiles) || !self.open.focus.pins().is_empty();
        let inspected = wanted.then(|| self.inspected()).flatten()?;
        Some(InspectionRequest::new(self.open.pictures()?, inspected.lines, &self.document.parameters))
    }

    /// What is to be compared, while something shows it.
    pub fn comparison_question(&self) -> Option<ComparisonQuestion> {
        let tab = self.tab() == Some(TabId::Residuals);
        if !(tab || self.truth().is_some() || self.open.focus.contestant().is_some()) {
            return None;
        }
        let document = &self.document;
        let pictures = document.pictures.as_ref()?;
        Some(ComparisonQuestion {
            result: self.open.computation.result().map(|(estimate, _)| *estimate.fundamental()),
            shown: self.shown().map(|shown| *shown.fundamental),
            imported: document.imported.as_ref().map(|imported| imported.fundamental),
            pairs: document.pairs.clone(),
            excluded: document.excluded.iter().copied().collect(),
            used: document.used().map(|pair| document.pairs[pair]).collect(),
            frames: pictures.each_ref().map(|picture| picture.frame),
            truth: self.truth().and(self.open.known.as_ref()).map(|known| known.truth.clone()),
            subject: self.look.compared,
        })
    }

    /// What a match is to be suggested for; of cameras that stand too far apart for patches to be compared, nothing.
    pub fn suggest_question(&self) -> Option<SuggestQuestion> {
        if self.compares_barcodes() {
            return None;
        }
        let known = self.known();
        let placed = if known.fundamental.is_none() {
            self.document.used().map(|pair| self.document.pairs[pair]).collect()
        } else {
            Vec::new()
        };
        Some(SuggestQuestion { half: self.document.half?, pictures: self.open.pictures()?, known, placed })
    }

    /// The result to be made firmer by another click: one in doubt, of a search that uses further pairs.
    pub fn next_click_question(&self) -> Option<NextClickQuestion> {
        let document = &self.document;
        if document.parameters.search != Search::Patches
            || document.half.is_some()
            || self.compares_barcodes()
        {
            return None;
        }
        let (found, _) = self.open.computation.shared_result().filter(|(_, of)| *of == Freshness::Final)?;
        let trust = found.assessment.trust.as_ref().filter(|trust| trust.verdict != Verdict::Reliable)?;
        // A pair that was outvoted is to be looked at itself.
        let of_a_click = |reason: &Reason| matches!(reason, Reason::ClickOff { .. });
        if !trust.reasons.is_empty() && trust.reasons.iter().all(of_a_click) {
            return None;
        }
        Some(NextClickQuestion { pictures: self.open.pictures()?, found, placed: document.pairs.clone() })
    }

    /// What the result says of the images: nothing while there is none, or one that is called unreliable.
    pub fn known(&self) -> Known {
        let is_trusted = |estimate: &&Estimate| {
            let trust = estimate.assessment.trust.as_ref();
            trust.is_none_or(|trust| trust.verdict != Verdict::Unreliable)
        };
        let found = self.final_result().filter(is_trusted);
        Known { fundamental: found.map(|estimate| *estimate.fundamental()), view: found.map(Estimate::view) }
    }

    /// Whether the rectified pair is looked at.
    pub fn wants_rectified(&self) -> bool {
        self.tab() == Some(TabId::Rectified)
    }

    /// The pair to be rectified, once there is a geometry.
    pub fn rectify_question(&self) -> Option<RectifyQuestion> {
        let shown = self.shown()?;
        let matches = self.matches_beside();
        let dragging = self.open.hover.is_some_and(|hover| hover.dragging);
        Some(RectifyQuestion {
            pictures: self.open.pictures()?,
            fundamental: *shown.fundamental,
            matches,
            method: self.document.rectification,
            moving: shown.freshness == Freshness::Followed || dragging,
        })
    }

    /// The matches on which the geometry shown is measured: known ones, else those of the result, hundreds all over the
    /// images, else clicked ones.
    pub fn matches_beside(&self) -> MatchesAtHand {
        let known = self.truth().and(self.open.known.as_ref()).map(|known| known.truth.clone());
        let found = self.open.computation.shared_result().filter(|(found, _)| !found.matches().is_empty());
        known
            .map(MatchesAtHand::True)
            .or_else(|| found.map(|(found, _)| MatchesAtHand::Found(found)))
            .unwrap_or_else(|| MatchesAtHand::Clicked(self.document.pairs.clone()))
    }

    /// The matches that can tell what a matrix means: known ones, else those that a person clicked, else those of the
    /// result, which may itself be wrong. That known ones are used shows nothing of them.
    pub fn matches_for_import(&self) -> MatchesAtHand {
        let known = self.open.known.as_ref().map(|known| known.truth.clone());
        if let Some(truth) = known.filter(|truth| truth.matches.len() >= FEWEST_MATCHES) {
            return MatchesAtHand::True(truth);
        }
        let clicked: Vec<PointPair> = self.document.included().collect();
        let found = self.open.computation.shared_result().filter(|(found, of)| {
            *of == Freshness::Final
                && found.matches().len() >= FEWEST_MATCHES
                && clicked.len() < FEWEST_MATCHES
        });
        found.map_or(MatchesAtHand::Clicked(clicked), |(found, _)| MatchesAtHand::Found(found))
    }

    fn final_result(&self) -> Option<&Estimate> {
        let (estimate, freshness) = self.open.computation.result()?;
        (freshness == Freshness::Final).then_some(estimate)
    }
}
