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

use super::lines::Construction;
use super::patches::{BAND, LEAST_CLICK_SIGMA};
use super::{Assessment, Clicks, Estimate, Parameters, PatchSupport, PreparedPair, Search};
use crate::geometry::{FundamentalMatrix, Observation, PointPair, fit_fundamental};

/// Standard deviation of a supporting match, px of the level it was found at.
const MATCH_SIGMA: f64 = 1.0;
/// Sampson distance beyond which a match loses influence, in its standard deviations.
const ROBUST: f64 = 2.0;
/// Fewer supporting matches than this leave the clicks to decide alone, which is the search's business.
const LEAST_MATCHES: usize = 16;

/// A geometry for the clicks where they are now, from earlier estimates of the same images, the newest last. What
/// was found out about the earlier one, for clicks that were elsewhere, does not come along: it has its patch support
/// and nothing else.
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
    if pairs.len() < parameters.method.pairs_needed() {
        return None;
    }
    let clicks = Clicks::for_method(pairs, parameters.method);
    let (fundamental, support) = match parameters.search {
        Search::Patches => {
            let (f, support) = refitted(prepared, starts, &clicks.observed(), parameters.click_sigma)?;
            (f, Some(support))
        }
        Search::Lines => (through_clicks(starts.into_iter().last()?, &clicks)?, None),
    };
    let assessment = Assessment { support, ..Assessment::default() };
    Some(Estimate { geometry: fundamental.into(), assessment, trace: None })
}

/// The most supported start, refitted to its matches and the clicks.
fn refitted<'a>(
    prepared: &PreparedPair,
    starts: impl IntoIterator<Item = &'a Estimate>,
    clicks: &[PointPair],
    click_sigma: f64,
) -> Option<(FundamentalMatrix, PatchSupport)> {
    let fine = prepared.fine_support();
    let [s1, s2] = fine.scales;
    let (at_level, support) = starts
        .into_iter()
        .filter_map(|start| {
            let at_level: FundamentalMatrix = start.fundamental().rescaled(s1, s2)?;
            Some((at_level, fine.support.measure(&at_level)))
        })
        .max_by(|a, b| a.1.score.total_cmp(&b.1.score))?;
    if support.matches < LEAST_MATCHES {
        return None;
    }
    // No click is more precise than the level can show.
    let click_sigma = (click_sigma * s1).max(LEAST_CLICK_SIGMA);
    let clicks = clicks.iter().map(|click| click.rescaled(fine.scales));
    let matches = fine.support.matches(&at_level, BAND);
    let observations: Vec<Observation> = matches
        .iter()
        .map(|m| Observation { pair: m.pair, sigma: MATCH_SIGMA })
        .chain(clicks.map(|pair| Observation { pair, sigma: click_sigma }))
        .collect();
    let fitted = fit_fundamental(&at_level, &observations, ROBUST)?;
    Some((fitted.fundamental.rescaled(1.0 / s1, 1.0 / s2)?, support))
}

/// The geometry nearest to an earlier one that fits two clicks exactly, as the published method has it.
fn through_clicks(start: &Estimate, clicks: &Clicks) -> Option<FundamentalMatrix> {
    let anchors = *clicks.anchors().first_chunk::<2>()?;
    Construction::of(start.fundamental(), anchors, start.turn())?.fundamental()
}
