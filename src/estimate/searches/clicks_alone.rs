//! Geometry of the clicks alone, if they agree with each other and contradict the images, or if the images show nothing.

use crate::geometry::{
    FundamentalMatrix, Observation, PointPair, eight_point, fit_fundamental, median, sampson_distance,
    seven_point,
};

/// Number of clicks that determine `F` by themselves: one for each of the seven unknowns, and one
/// to test that they agree.
const CLICKS_ALONE: usize = 8;
/// Number of clicks from which known cameras have a pose and a test of it.
const FEWEST: usize = 6;
/// The clicks contradict the found geometry if their median distance from it exceeds this multiple
/// of their median distance from the geometry of the other clicks. A smaller number gives wrong
/// clicks more influence.
const CONTRADICTED: f64 = 3.0;

/// Returns the geometry of the clicks alone, if they agree with each other and contradict `found`, or if chance
/// explains the matches of `found`: then they would only disturb the clicks.
///
/// `posed` fits the pose of known cameras to the clicks; `None` if chance explains how they agree.
pub(super) fn of_clicks_alone(
    clicks: &[PointPair],
    found: &FundamentalMatrix,
    is_chance: impl Fn() -> bool,
    click_sigma: f64,
    posed: impl FnOnce() -> Option<FundamentalMatrix>,
) -> Option<FundamentalMatrix> {
    let off = |f: &FundamentalMatrix| median(clicks.iter().map(|pair| sampson_distance(f, pair)));
    let may_overrule = || off(found) > CONTRADICTED * click_sigma || is_chance();
    if clicks.len() >= FEWEST
        && may_overrule()
        && let Some(posed) = posed()
    {
        let contradict = off(found) > CONTRADICTED * off(&posed).max(click_sigma);
        return (contradict || is_chance()).then_some(posed);
    }
    if clicks.len() < CLICKS_ALONE {
        return None;
    }
    let observations: Vec<Observation> =
        clicks.iter().map(|pair| Observation { pair: *pair, sigma: click_sigma }).collect();
    let fitted = fit_fundamental(&eight_point(clicks).ok()?, &observations, ROBUST_CLICKS)?.fundamental;
    if is_chance() {
        return Some(fitted);
    }
    // A fit to eight clicks passes through all of them, right or wrong. A click that is left out
    // tests the fit.
    let off_others = (0..clicks.len()).map(|k| off_the_others(clicks, k));
    (off(found) > CONTRADICTED * median(off_others).max(click_sigma)).then_some(fitted)
}

/// Returns the distance of a click from the geometry of the other clicks, px. Infinite if they
/// determine none.
fn off_the_others(clicks: &[PointPair], k: usize) -> f64 {
    let mut others = clicks.to_vec();
    let left_out = others.remove(k);
    let solutions = if others.len() < 8 {
        seven_point(&others).unwrap_or_default()
    } else {
        eight_point(&others).into_iter().collect()
    };
    let distance = |f: &FundamentalMatrix| sampson_distance(f, &left_out);
    solutions.iter().map(distance).fold(f64::INFINITY, f64::min)
}

/// Distance at which a click loses influence on a fit, in standard deviations: 99.7 % of Gaussian
/// errors are below it.
const ROBUST_CLICKS: f64 = 3.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::estimate::{Assessment, Monitor, Parameters, Reason, estimate_prepared};

    #[test]
    fn clicks_that_agree_overrule_a_geometry_that_contradicts_them() {
        let scene = ExactScene::aside();
        let (truth, wrong) = (scene.fundamental(), scene.disturbed(30.0));
        let mut clicks = scene.pairs(12);
        let error = |f: &FundamentalMatrix| scene.error(f);
        let alone = |clicks: &[PointPair], found: &FundamentalMatrix| {
            of_clicks_alone(clicks, found, || false, 1.0, || None)
        };
        assert!(error(&alone(&clicks, &wrong).unwrap()) < 1e-3);
        assert!(alone(&clicks, &truth).is_none(), "nothing contradicts them");
        assert!(alone(&clicks, &scene.disturbed(0.5)).is_none(), "within what clicks are off");
        assert!(alone(&clicks[..CLICKS_ALONE], &wrong).is_some());
        assert!(alone(&clicks[..CLICKS_ALONE - 1], &wrong).is_none(), "nothing tells that seven agree");
        // A single slip of a click is outvoted.
        clicks[4].point2.y += 6.0;
        // Least squares spread 6 px over twelve clicks and seven parameters: 0.87 px on average.
        assert!(error(&alone(&clicks, &wrong).unwrap()) < 1.0);
    }

    #[test]
    fn eight_clicks_that_disagree_overrule_nothing() {
        let scene = ExactScene::aside();
        let mut clicks = scene.pairs(CLICKS_ALONE);
        for (k, pair) in (1..).zip(&mut clicks) {
            pair.point2.y += 8.0 * (12.9898 * f64::from(k) + 1.0).sin();
        }
        let off =
            |f: &FundamentalMatrix| clicks.iter().map(|pair| sampson_distance(f, pair)).collect::<Vec<_>>();
        // A fit to eight clicks passes through all of them, right or wrong.
        assert!(median(off(&eight_point(&clicks).unwrap())) < 1.5);
        assert!(median(off(&scene.fundamental())) > CONTRADICTED);
        assert!(of_clicks_alone(&clicks, &scene.fundamental(), || false, 1.0, || None).is_none());
    }

    #[test]
    fn a_geometry_of_clicks_alone_is_named_and_compared_with_the_found_one() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        // All clicks are off the image content by the same shift.
        let mut clicks = scene.pairs(60);
        for pair in &mut clicks {
            pair.point2.y += 40.0;
        }
        clicks.retain(|pair| prepared.frames()[1].contains(pair.point2));
        let found =
            estimate_prepared(&prepared, &clicks, &Parameters::default(), &Monitor::silent()).unwrap();
        let off: Vec<f64> = clicks.iter().map(|pair| sampson_distance(found.fundamental(), pair)).collect();
        assert!(median(off) < 0.1);
        let Assessment { trust, margin, support, refinement, .. } = &found.assessment;
        let reasons = &trust.as_ref().unwrap().reasons;
        assert!(reasons.contains(&Reason::ClicksAlone) && refinement.is_none(), "{reasons:?}");
        let [own, rival] = [&found.hypotheses()[0], &found.hypotheses()[1]].map(|h| h.assessment.support);
        assert_eq!(own, *support, "measured, like that of the others");
        assert!(own.unwrap().score < rival.unwrap().score && margin.is_some_and(|m| m < 0.0 && m > -1.0));
    }
}
