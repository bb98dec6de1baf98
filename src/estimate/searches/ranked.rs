//! Ranked geometries of one pass of a search, before any is refined.

use super::judged::Judged;
use super::record::SearchRecord;
use super::refinement::refine_ranked;
use crate::estimate::evidence::patches::Proposal;
use crate::estimate::evidence::viewed::ViewedPair;
use crate::estimate::verdict::assessment::unguided_agreement;
use crate::estimate::{Estimate, EstimateError, Stage};

/// Geometries ranked by the support of patches under a view, best first.
pub(super) struct Ranked {
    pub proposals: Vec<Proposal>,
    /// The geometries that differ.
    pub hypotheses: Vec<Estimate>,
}

impl Ranked {
    /// Returns whether chance gives a geometry that agrees as well as the best one with the matches found without a
    /// geometry: it is expected once or more often.
    pub fn are_by_chance(&self, viewed: &ViewedPair) -> bool {
        let frames = viewed.input.prepared.frames();
        let agreement = |best: &Estimate| unguided_agreement(&viewed.patches, best.fundamental(), frames);
        self.hypotheses.first().is_none_or(|best| agreement(best).log_false_alarms >= 0.0)
    }

    /// Refines the best geometries and judges the result.
    pub fn judged(self, viewed: &ViewedPair, record: &mut SearchRecord) -> Result<Judged, EstimateError> {
        record.enter(Stage::Refinement)?;
        let found = refine_ranked(&self.proposals, self.hypotheses, viewed, record.cancel())?;
        Ok(Judged::of(found, viewed, record))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::evidence::viewed::SearchInput;
    use crate::estimate::exact::{ExactScene, rows};
    use crate::estimate::{Clicks, Parameters, Proposed, ProposedBy, SearchPlan};

    #[test]
    fn chance_gives_as_good_a_geometry_as_a_wrong_one_but_not_as_the_true_one() {
        let scene = ExactScene::aside();
        let (prepared, parameters) = (scene.prepared(), Parameters::default());
        let clicks = Clicks::for_plan(&scene.clicks(), SearchPlan::Patches { clicks: 2 });
        let input = SearchInput { prepared: &prepared, clicks: &clicks, parameters: &parameters };
        let viewed = ViewedPair::upright(input);
        let [right, wrong] = [scene.fundamental(), rows(90.0)].map(|f| {
            let best = Estimate::proposed(Proposed::by(ProposedBy::Clicks, f), None, None);
            Ranked { proposals: Vec::new(), hypotheses: vec![best] }.are_by_chance(&viewed)
        });
        assert!(!right && wrong);
        let none = Ranked { proposals: Vec::new(), hypotheses: Vec::new() };
        assert!(none.are_by_chance(&viewed));
    }
}
