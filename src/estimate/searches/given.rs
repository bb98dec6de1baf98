//! Geometry of matches of another program: alone, or against the result of the images.
//!
//! Alone, the geometry stays as it is. The images and the clicks judge it, and geometries proposed by features
//! compete with it.
//!
//! Otherwise the two geometries are compared if the given matches contradict the result. Evidence is matches
//! that were found without either geometry: those of the images, and the given ones. Matches along the lines
//! of a geometry agree with it by construction. A geometry that the matches of the images confirm beyond chance
//! is preferred to one that they do not, because given matches may all be wrong in one way: those of other
//! images, or of images of another size. Otherwise the sum of both evidences decides.

use super::features::{FeatureProposals, ranked};
use super::judged::{Found, Judged, distinct_hypotheses};
use super::record::SearchRecord;
use crate::estimate::evidence::features::view_of_pairs;
use crate::estimate::evidence::patches::{PatchLevels, Settling};
use crate::estimate::evidence::prepared::{GivenFit, GivenMatches};
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::fit::false_alarms::{Agreement, PRECISION};
use crate::estimate::verdict::assessment::{RestsOn, given_figures, unguided_agreement};
use crate::estimate::verdict::selection::ClickedPairs;
use crate::estimate::{Estimate, EstimateError, Proposed, ProposedBy, Stage};
use crate::features::FeatureViews;
use crate::geometry::{Frame, FundamentalMatrix};
use crate::image::RelativeView;

/// Judges the geometry of given matches under the view that they suggest.
pub(in crate::estimate) fn search(
    input: SearchInput,
    given: &GivenFit,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let of = FeatureViews::Frontal;
    let proposals = FeatureProposals::new(input, of, record)?;
    let view = proposals.views.first().copied().unwrap_or(RelativeView::UPRIGHT);
    let viewed = ViewedPair::new(input, input.prepared.patches_with_features(view, of));
    record.enter(Stage::Validation)?;
    let rivals = ranked(&proposals.proposed(), &[], &viewed, record.cancel())?;
    let rivals = distinct_hypotheses(&rivals, &viewed, record.cancel());
    record.enter(Stage::Refinement)?;
    // The images alone may show nothing.
    let hypotheses = rivals.map_or_else(|_| Vec::new(), |(hypotheses, _)| hypotheses);
    Ok(Judged::of(unchanged(given, hypotheses, &viewed), &viewed, record))
}

/// Returns the geometry of given matches as it is.
fn unchanged(given: &GivenFit, hypotheses: Vec<Estimate>, viewed: &ViewedPair) -> Found {
    let matched = viewed.patches.matched(&given.fundamental);
    let refined = matched.map(|mut refined| {
        refined.fundamental = given.fundamental;
        refined.refinement.uncertainty.clone_from(&given.uncertainty);
        refined.refinement.is_posed = given.is_posed;
        refined
    });
    Found {
        proposed: Proposed::by(ProposedBy::GivenMatches, given.fundamental),
        hypotheses,
        supporting: given.inliers.clone(),
        refined,
        rests_on: RestsOn::GivenAlone,
    }
}

/// Agreement of the matches that were found without a geometry.
struct Standing {
    of_images: Agreement,
    of_given: Agreement,
}

impl Standing {
    fn new(f: &FundamentalMatrix, patches: &PatchLevels, given: &GivenMatches, frames: [Frame; 2]) -> Self {
        let of_given = Agreement::with_lines(f, given.all.iter().map(|m| m.pair), frames, PRECISION);
        Self { of_images: unguided_agreement(patches, f, frames), of_given }
    }

    fn is_better_than(&self, other: &Self) -> bool {
        let [own, its] = [self, other].map(|one| one.of_images.is_no_chance());
        let evidence = |one: &Self| one.of_images.evidence() + one.of_given.evidence();
        // Where chance may explain both, the less likely agreement wins.
        let alarms = |one: &Self| one.of_images.log_false_alarms + one.of_given.log_false_alarms;
        let by_alarms = || alarms(other).total_cmp(&alarms(self));
        if own == its { evidence(self).total_cmp(&evidence(other)).then_with(by_alarms).is_gt() } else { own }
    }
}

/// Compares the result of the images with the geometry of given matches, if these contradict it or chance
/// explains it. Where the images show no geometry, returns the geometry of the given matches.
pub(in crate::estimate) fn compared(
    input: SearchInput,
    found: Result<Judged, EstimateError>,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let SearchInput { prepared, parameters, .. } = input;
    let (Some(given), Some(fit)) = (prepared.given(), prepared.given_fit()) else { return found };
    let clicks = ClickedPairs::of(input);
    let frames = prepared.frames();
    let contradict = |f: &FundamentalMatrix| given_figures(given, f, parameters.click_sigma).contradict();
    let standing_of = |own: &Judged| Standing::new(&own.fundamental, &own.patches, given, frames);
    let own = match found {
        Ok(own) if clicks.prefer(&own.fundamental, &fit.fundamental) => return Ok(own),
        Ok(own) => {
            let standing = standing_of(&own);
            // What chance explains stands for nothing, even if few given matches contradict it.
            if standing.of_images.is_no_chance() && !contradict(&own.fundamental) {
                return Ok(own);
            }
            Some((own, standing))
        }
        Err(
            EstimateError::NoCandidates(_) | EstimateError::NoGeometry | EstimateError::NothingWithoutClicks,
        ) => None,
        Err(error) => return Err(error),
    };
    record.enter(Stage::Refinement)?;
    let patches = own.as_ref().map(|(own, _)| &own.patches);
    let of = patches.and_then(|patches| patches.features()).unwrap_or(FeatureViews::Frontal);
    let found_under = patches.map_or(RelativeView::UPRIGHT, |patches| patches.view());
    let view = view_of_pairs(&fit.inliers, frames).unwrap_or(found_under);
    let viewed = ViewedPair::new(input, prepared.patches_with_features(view, of));
    let standing = Standing::new(&fit.fundamental, &viewed.patches, given, frames);
    let of_given = Proposed::by(ProposedBy::GivenMatches, fit.fundamental);
    let measured = |one: Proposed| Estimate::proposed(one, None, viewed.patches.measure(&one.fundamental));
    let mut hypotheses = vec![measured(of_given)];
    if let Some((own, its_standing)) = own {
        if !standing.is_better_than(&its_standing) {
            return Ok(own);
        }
        hypotheses.push(measured(own.proposed()));
        hypotheses.extend(own.hypotheses);
    }
    let settling = Settling {
        clicks: &clicks.0,
        given: &given.all,
        calibrations: prepared.calibrations(),
        allows: &|_| true,
        seed: parameters.seed,
    };
    // Matches along the lines of a geometry that the images do not confirm are chance, and spoil it.
    let refined = standing
        .of_images
        .is_no_chance()
        .then(|| viewed.patches.settle(&fit.fundamental, &settling, record.cancel()))
        .flatten()
        .filter(|refined| !contradict(&refined.fundamental));
    record.cancel().check()?;
    let found = match refined {
        Some(refined) => Found {
            proposed: of_given,
            hypotheses,
            supporting: fit.inliers.clone(),
            refined: Some(refined),
            rests_on: RestsOn::Images,
        },
        None => unchanged(fit, hypotheses, &viewed),
    };
    Ok(Judged::of(found, &viewed, record))
}
