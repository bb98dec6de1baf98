//! A geometry that follows moved clicks at once, without a search.
//!
//! The fundamental matrix belongs to the two images, not to the clicks, so an earlier one of the same images is
//! a start: it is refitted to the matches that support it, together with the clicks where they are now. That
//! takes milliseconds where the search takes a second, and is right as long as the earlier geometry was. The
//! published method looks at lines only and holds the clicks for exact, so there the lines turn with the clicks.
//!
//! # Pitfalls
//! - It cannot leave a wrong geometry; only the search can. Hence several starts, of which the one with most
//!   patch support is followed, and no verdict.

use super::level::resized_pair;
use super::polish::{Observation, fit};
use super::search::BAND;
use super::{Construction, Estimate, Parameters, PatchSupport, PreparedPair};
use crate::geometry::{FundamentalMatrix, PointPair};

/// Standard deviation of a supporting match, px of the level it was found at.
const MATCH_SIGMA: f64 = 1.0;
/// Sampson distance beyond which a match loses influence, in its standard deviations.
const ROBUST: f64 = 2.0;
/// Fewer supporting matches than this leave the clicks to decide alone, which is the search's business.
const LEAST_MATCHES: usize = 16;

/// A geometry for the clicks where they are now, from earlier estimates of the same images, the newest last. It
/// carries the hypotheses of the estimate it comes from and no verdict.
///
/// Where patches count, the start with most support is refitted to its matches and the clicks; where only lines do,
/// the newest start has its lines turned to pass through the clicks. `None` when there are too few clicks, no start,
/// or too few matches that support one. Takes some 10 ms at 768×576.
pub fn follow<'a>(
    prepared: &PreparedPair,
    starts: impl IntoIterator<Item = &'a Estimate>,
    pairs: &[PointPair],
    parameters: &Parameters,
) -> Option<Estimate> {
    let clicks = pairs.get(..parameters.method.pairs_needed())?;
    let (start, fundamental, support) = if parameters.patch_support {
        refitted(prepared, starts, clicks, parameters.click_sigma)?
    } else {
        let start = starts.into_iter().last()?;
        (start, through_clicks(start, [clicks[0], clicks[1]])?, None)
    };
    Some(Estimate {
        fundamental,
        epipole1: fundamental.epipole1(),
        epipole2: fundamental.epipole2(),
        support,
        warnings: Vec::new(),
        trust: None,
        uncertainty: None,
        refined: false,
        matches: Vec::new(),
        ..start.clone()
    })
}

/// The most supported start, refitted to its matches and the clicks.
fn refitted<'a>(
    prepared: &PreparedPair,
    starts: impl IntoIterator<Item = &'a Estimate>,
    clicks: &[PointPair],
    click_sigma: f64,
) -> Option<(&'a Estimate, FundamentalMatrix, Option<PatchSupport>)> {
    let fine = prepared.fine_witness();
    let [s1, s2] = fine.scales;
    let (start, at_level, score) = starts
        .into_iter()
        .filter_map(|start| {
            let at_level: FundamentalMatrix = start.fundamental.rescaled(s1, s2)?;
            Some((start, at_level, fine.support.score(&at_level, BAND)))
        })
        .max_by(|a, b| a.2.total_cmp(&b.2))?;
    let matches = fine.support.matches(&at_level, BAND);
    if matches.len() < LEAST_MATCHES {
        return None;
    }
    // No click is more precise than the level can show.
    let click_sigma = (click_sigma * s1).max(0.5);
    let clicks = clicks.iter().map(|click| resized_pair(click, fine.scales));
    let observations: Vec<Observation> = matches
        .iter()
        .map(|m| Observation { pair: m.pair, sigma: MATCH_SIGMA })
        .chain(clicks.map(|pair| Observation { pair, sigma: click_sigma }))
        .collect();
    let fitted = fit(&at_level, &observations, ROBUST)?;
    let fundamental = fitted.fundamental.rescaled(1.0 / s1, 1.0 / s2)?;
    Some((start, fundamental, Some(PatchSupport { matches: matches.len(), score })))
}

/// The geometry nearest to an earlier one that fits two clicks exactly, as the published method has it.
fn through_clicks(start: &Estimate, clicks: [PointPair; 2]) -> Option<FundamentalMatrix> {
    let turn = start.hypotheses.first().map_or(0.0, |hypothesis| hypothesis.construction.turn());
    Construction::of(&start.fundamental, clicks, turn)?.fundamental()
}
