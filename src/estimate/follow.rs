//! A geometry that follows moved clicks at once, without a search.
//!
//! The fundamental matrix belongs to the two images, not to the clicks, so an earlier matrix of the
//! same images is a good start. It is refitted to its supporting matches and the moved clicks, in
//! milliseconds instead of a second. The result is right if the earlier geometry was. The published
//! method fits the clicks exactly and uses lines only, so there the lines turn with the clicks.
//!
//! # Pitfalls
//! - A refit cannot correct a wrong geometry; only a search can. So several starts are given, the
//!   start with most patch support is followed, and there is no verdict.

use super::evidence::lines::Construction;
use super::evidence::patches::{BAND, LEAST_CLICK_SIGMA, LEAST_MATCHES};
use super::{Assessment, Clicks, Estimate, Parameters, PatchSupport, PreparedPair, Search, SearchPlan};
use crate::geometry::{FundamentalMatrix, Observation, PointPair, fit_fundamental};

/// Standard deviation of a supporting match, px of the level: corners are found to a pixel.
const MATCH_SIGMA: f64 = 1.0;
/// Sampson distance beyond which a match loses influence, in standard deviations. Corners within
/// the band of support keep at least half of their weight.
const ROBUST: f64 = 2.0;

/// Returns a geometry for the present clicks, from earlier estimates of the same images, the newest
/// last. The returned estimate has patch support only: other findings held for the earlier clicks.
///
/// With patches, the start with most support is refitted to its matches and the clicks. With lines
/// alone, the lines of the newest start turn to pass through the clicks. Returns `None` when there
/// are too few clicks, no start, or too few supporting matches. Takes some 10 ms at 768×576.
pub fn follow<'a>(
    prepared: &PreparedPair,
    starts: impl IntoIterator<Item = &'a Estimate>,
    pairs: &[PointPair],
    parameters: &Parameters,
) -> Option<Estimate> {
    if pairs.len() < parameters.method.pairs_needed() {
        return None;
    }
    let clicks = Clicks::for_plan(pairs, SearchPlan::of(parameters, pairs.len()));
    let (fundamental, support) = match parameters.search {
        Search::Patches => {
            let (f, support) = refitted(prepared, starts, &clicks.observed(), parameters.click_sigma)?;
            (f, Some(support))
        }
        Search::Lines => (through_clicks(starts.into_iter().last()?, &clicks)?, None),
    };
    let assessment = Assessment { support, ..Assessment::default() };
    Some(Estimate { fundamental, origin: None, assessment, trace: None })
}

/// Returns the most supported start, refitted to its matches and the clicks.
fn refitted<'a>(
    prepared: &PreparedPair,
    starts: impl IntoIterator<Item = &'a Estimate>,
    clicks: &[PointPair],
    click_sigma: f64,
) -> Option<(FundamentalMatrix, PatchSupport)> {
    let (patches, at_level, support) = starts
        .into_iter()
        .filter_map(|start| {
            // Patches are compared under the view of the search that found the start.
            let patches = prepared.patches_of(start);
            let fine = patches.fine();
            let at_level = start.fundamental().rescaled(fine.scales)?;
            let support = fine.support.measure(&at_level);
            Some((patches, at_level, support))
        })
        .max_by(|a, b| a.2.score.total_cmp(&b.2.score))?;
    let fine = patches.fine();
    if support.matches < LEAST_MATCHES {
        return None;
    }
    // A click is no more precise than the level can show.
    let click_sigma = (click_sigma * fine.scales[0]).max(LEAST_CLICK_SIGMA);
    let clicks = clicks.iter().map(|click| click.rescaled(fine.scales));
    let matches = fine.support.matches(&at_level, BAND);
    let observations: Vec<Observation> = matches
        .iter()
        .map(|m| Observation { pair: m.pair, sigma: MATCH_SIGMA })
        .chain(clicks.map(|pair| Observation { pair, sigma: click_sigma }))
        .collect();
    let fitted = fit_fundamental(&at_level, &observations, ROBUST)?;
    Some((fitted.fundamental.rescaled(fine.scales.map(f64::recip))?, support))
}

/// Returns the geometry nearest to an earlier one that fits two clicks exactly, as the published
/// method does.
fn through_clicks(start: &Estimate, clicks: &Clicks) -> Option<FundamentalMatrix> {
    let anchors = *clicks.anchors().first_chunk::<2>()?;
    Construction::of(start.fundamental(), anchors, start.turn())?.fundamental()
}

#[cfg(test)]
mod tests {
    use super::super::Preset;
    use super::super::exact::{ExactScene, FRAME, rows};
    use super::*;
    use crate::geometry::{Vector, symmetric_epipolar_distance};
    use crate::image::GrayPlane;

    fn prepared(scene: &ExactScene) -> PreparedPair {
        scene.prepared()
    }

    /// Returns the clicks, the first one moved in image 2.
    fn moved(scene: &ExactScene, by: Vector) -> Vec<PointPair> {
        let [p, q] = scene.clicks();
        vec![PointPair { point2: p.point2 + by, ..p }, q]
    }

    #[test]
    fn the_most_supported_start_is_refitted_and_has_no_other_findings() {
        let scene = ExactScene::aside();
        let prepared = prepared(&scene);
        let [near, wrong] = [scene.disturbed(0.7), rows(0.0)].map(Estimate::from);
        let before = scene.error(near.fundamental());
        let parameters = Parameters::default();
        for starts in [[&near, &wrong], [&wrong, &near]] {
            let found = follow(&prepared, starts, &scene.clicks(), &parameters).unwrap();
            let after = scene.error(found.fundamental());
            // Corners are found to a pixel, and there are some hundred.
            assert!(after < 0.5 && after < 0.5 * before, "{before} px before, {after} px after");
            let Assessment {
                lines,
                support,
                margin,
                refined_margin,
                apart,
                line_evidence,
                barcodes,
                refinement,
                distinctive,
                warnings,
                trust,
                plane,
                case,
                of_given,
            } = found.assessment;
            assert!(support.unwrap().matches > 60 && found.trace.is_none());
            assert!(lines.is_none() && refinement.is_none() && trust.is_none() && plane.is_none());
            assert!(margin.is_none() && refined_margin.is_none() && apart.is_none() && barcodes.is_none());
            assert!(line_evidence.is_none() && distinctive.is_empty() && warnings.is_empty() && !of_given);
            assert!(case.is_none());
        }
        // A click that is far off does not take the geometry along, but has an influence.
        let far = moved(&scene, Vector::new(0.0, 30.0));
        let [still, dragged] = [&scene.clicks()[..], &far]
            .map(|clicks| *follow(&prepared, [&near], clicks, &parameters).unwrap().fundamental());
        assert_ne!(still, dragged);
        assert!(scene.error(&dragged) < 1.0, "{} px", scene.error(&dragged));
    }

    #[test]
    fn lines_of_the_newest_start_turn_with_the_clicks() {
        let scene = ExactScene::aside();
        let prepared = prepared(&scene);
        let parameters = Parameters::from(Preset::Paper);
        let [truth, wrong] = [scene.fundamental(), rows(3.0)].map(Estimate::from);
        let clicks = moved(&scene, Vector::new(2.0, 4.0));
        let found = follow(&prepared, [&wrong, &truth], &clicks, &parameters).unwrap();
        for click in &clicks {
            assert!(symmetric_epipolar_distance(found.fundamental(), click) < 1e-6);
        }
        // The clicks moved by 4 px, and the lines through them turned.
        assert!(scene.error(found.fundamental()) < 4.0, "not far from the newest one");
        assert!(found.assessment.support.is_none() && found.assessment.lines.is_none());
        let other = follow(&prepared, [&truth, &wrong], &clicks, &parameters).unwrap();
        assert!(scene.error(other.fundamental()) > 2.0 * scene.error(found.fundamental()));
        let still = follow(&prepared, [&truth], &scene.clicks(), &parameters).unwrap();
        assert!((still.fundamental().matrix() - truth.fundamental().matrix()).norm() < 1e-9);
    }

    #[test]
    fn too_few_clicks_starts_or_matches_give_none() {
        let scene = ExactScene::aside();
        let (prepared, start) = (prepared(&scene), Estimate::from(scene.fundamental()));
        let parameters = Parameters::default();
        let clicks = scene.clicks();
        assert!(follow(&prepared, [&start], &clicks, &parameters).is_some());
        assert!(follow(&prepared, [&start], &clicks[..1], &parameters).is_none());
        assert!(follow(&prepared, [], &clicks, &parameters).is_none());
        let three = Parameters { method: super::super::Method::ThreePoint, ..parameters.clone() };
        assert!(follow(&prepared, [&start], &clicks, &three).is_none());
        // With texture in one small part only, nothing is supported.
        let [plane1, plane2] = scene.planes().map(|plane| {
            GrayPlane::from_fn(FRAME, |x, y| if x < 40 && y < 40 { plane.at(x, y) } else { 90.0 })
        });
        let bare = PreparedPair::new(&plane1, &plane2);
        assert!(follow(&bare, [&start], &clicks, &parameters).is_none());
    }
}
