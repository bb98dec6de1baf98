//! Judged geometries, preliminary reports, and the hypotheses shown with them.

use std::sync::Arc;

use super::REPORTED;
use super::record::SearchRecord;
use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::{ComparedPencils, LineExaminer};
use crate::estimate::evidence::patches::{self, PatchLevels, Proposal, Refined};
use crate::estimate::evidence::viewed::ViewedPair;
use crate::estimate::verdict::assessment::{Judge, RestsOn};
use crate::estimate::verdict::result::Assessment;
use crate::estimate::verdict::selection::Weighed;
use crate::estimate::verdict::trust::Trust;
use crate::estimate::{Clicks, Estimate, EstimateError, EventKind, Origin, PatchSupport, Proposed};
use crate::geometry::{FundamentalMatrix, PointPair};

/// Result of a search before its assessment.
pub(in crate::estimate) struct Found {
    /// The best geometry before refinement. After refinement, the origin is that of the refined start.
    pub proposed: Proposed,
    /// Hypotheses before refinement, best first.
    pub hypotheses: Vec<Estimate>,
    /// Matches on which rivals are compared with the result.
    pub supporting: Vec<PointPair>,
    /// The best refinement, if there is one.
    pub refined: Option<Refined>,
    pub rests_on: RestsOn,
}

/// Assessed geometry, with the evidence of the view under which it was found.
pub(in crate::estimate) struct Judged {
    /// Clicks of the search, stand-ins included.
    pub clicks: Clicks,
    pub fundamental: FundamentalMatrix,
    pub origin: Origin,
    pub hypotheses: Vec<Estimate>,
    pub assessment: Assessment,
    /// Weight of the refined matches, and its standard deviation.
    pub weight: f64,
    pub weight_deviation: f64,
    pub patches: Arc<PatchLevels>,
    /// Pencils through the anchors of `clicks`.
    pub pencils: Vec<Arc<ComparedPencils>>,
}

impl From<&Judged> for Weighed {
    fn from(judged: &Judged) -> Self {
        let Judged { fundamental, weight, weight_deviation: deviation, .. } = *judged;
        Self { fundamental, weight, deviation }
    }
}

impl Judged {
    /// Judges a geometry found under a view with these clicks.
    pub fn of(found: Found, viewed: &ViewedPair, record: &mut SearchRecord) -> Self {
        let Found { proposed, hypotheses, supporting, refined, rests_on } = found;
        let (weight, weight_deviation) =
            refined.as_ref().map_or((0.0, 0.0), |refined| (refined.weight, refined.weight_deviation));
        let fundamental = refined.as_ref().map_or(proposed.fundamental, |refined| refined.fundamental);
        let selected = Proposed { fundamental, ..proposed };
        if let Some(refined) = &refined {
            let matches = refined.refinement.matches.len();
            let steps = refined.steps.clone();
            record.note(EventKind::Refined { selected: selected.into(), matches, steps });
        }
        let judge = Judge { rests_on, ..judge(viewed, &hypotheses, record) };
        let assessment = judge.result(&fundamental, &supporting, refined);
        let judged = Self {
            clicks: viewed.input.clicks.clone(),
            fundamental,
            origin: proposed.origin,
            hypotheses,
            assessment,
            weight,
            weight_deviation,
            patches: Arc::clone(&viewed.patches),
            pencils: record.present_pencils().to_vec(),
        };
        let verdict = judged.assessment.trust.as_ref().map(|trust| trust.verdict);
        record.note(EventKind::Judged { verdict, is_open: judged.is_open() });
        judged
    }

    /// Returns whether another search could find a better geometry.
    pub fn is_open(&self) -> bool {
        self.assessment.trust.as_ref().is_none_or(Trust::leaves_another_search)
    }

    /// Returns the geometry with its origin.
    pub fn proposed(&self) -> Proposed {
        Proposed { fundamental: self.fundamental, origin: self.origin }
    }

    /// Returns whether the verdict is doubtful for lack of matches alone.
    pub fn lacks_matches(&self) -> bool {
        let trust = self.assessment.trust.as_ref();
        trust.is_some_and(|trust| !trust.reasons.is_empty() && trust.may_pass_with_more_matches())
    }
}

/// Reports a geometry good enough to draw.
pub(super) fn report_preliminary(
    proposed: Proposed,
    hypotheses: &[Estimate],
    support: Option<PatchSupport>,
    viewed: &ViewedPair,
    record: &mut SearchRecord,
) {
    let Proposed { fundamental, origin } = proposed;
    let assessment = judge(viewed, hypotheses, record).preliminary(&fundamental, support);
    let found = Estimate { fundamental, origin: Some(origin), assessment, trace: None };
    record.preliminary(found, hypotheses, viewed);
}

fn judge<'a>(viewed: &'a ViewedPair, hypotheses: &'a [Estimate], record: &'a SearchRecord) -> Judge<'a> {
    let (pencils, cancel) = (record.present_pencils(), record.cancel());
    Judge { viewed, hypotheses, pencils, rests_on: RestsOn::Images, cancel }
}

/// Returns the ranked proposals that differ, with their line figures if there are two anchors, and
/// the first of all proposals.
pub(super) fn distinct_hypotheses<'p>(
    ranked: &'p [Proposal],
    viewed: &ViewedPair,
    cancel: &CancelFlag,
) -> Result<(Vec<Estimate>, &'p Proposal), EstimateError> {
    let anchors = viewed.input.clicks.anchors();
    let fine = viewed.patches.fine();
    let different = patches::different(&fine.support, ranked, REPORTED);
    cancel.check()?;
    let examiner = anchors
        .first_chunk()
        .map(|anchors| LineExaminer::new(&*viewed.source, *anchors, viewed.input.parameters, cancel));
    let hypotheses = patches::hypotheses(examiner.as_ref(), &different, fine);
    let hypotheses: Vec<Estimate> = hypotheses.into_iter().map(Estimate::from).collect();
    cancel.check()?;
    let leader = ranked.first().filter(|_| !hypotheses.is_empty());
    Ok((hypotheses, leader.ok_or(EstimateError::NoGeometry)?))
}
