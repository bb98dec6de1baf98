//! What the threads are asked, from the state as it is.

use std::sync::Arc;

use super::Inspector;
use crate::app::comparison::Question as Comparand;
use crate::app::computation::Freshness;
use crate::app::inspection::InspectionRequest;
use crate::app::panels::tabs::TABS;
use crate::app::suggesting::Question;
use crate::app::worker::Request;

impl Inspector {
    pub(super) fn request(&self) -> Option<Request> {
        let pictures = self.pictures.as_ref()?;
        Some(Request {
            pictures: pictures.each_ref().map(|opened| Arc::clone(&opened.picture)),
            pairs: self.document.used_pairs()?,
            parameters: self.document.parameters.clone(),
        })
    }

    pub(super) fn inspection_request(&self) -> Option<InspectionRequest> {
        let pictures = self.pictures.as_ref()?.each_ref().map(|opened| Arc::clone(&opened.picture));
        Some(InspectionRequest::new(pictures, self.inspected?, &self.document.parameters))
    }

    /// What is to be compared, while something shows it.
    pub(super) fn comparand(&self) -> Option<Comparand> {
        let scene = self.scene();
        let tab = scene.tab.is_some_and(|tab| TABS[tab].compares);
        if !(tab || scene.truth().is_some() || self.focus.contestant().is_some()) {
            return None;
        }
        let pictures = self.document.pictures.as_ref()?;
        let used = self.document.used().map(|pair| self.document.pairs[pair]).collect();
        Some(Comparand {
            result: self.computation.result().map(|(estimate, _)| *estimate.fundamental()),
            shown: scene.shown().map(|shown| *shown.fundamental),
            imported: self.document.imported.as_ref().map(|imported| imported.fundamental),
            pairs: self.document.pairs.clone(),
            excluded: self.document.excluded.iter().copied().collect(),
            used,
            frames: pictures.each_ref().map(|picture| picture.frame),
            truth: scene.truth().and(self.known.as_ref()).map(|known| Arc::clone(&known.truth)),
            seed: self.document.trial.map_or(0, |trial| trial.seed),
            subject: self.look.compared,
        })
    }

    /// What a match is to be suggested for.
    pub(super) fn question(&self) -> Option<Question> {
        let pictures = self.pictures.as_ref()?;
        let final_result = self.computation.result().filter(|(_, freshness)| *freshness == Freshness::Final);
        Some(Question {
            pictures: pictures.each_ref().map(|opened| Arc::clone(&opened.picture)),
            half: self.document.half?,
            fundamental: final_result.map(|(estimate, _)| *estimate.fundamental()),
        })
    }
}
