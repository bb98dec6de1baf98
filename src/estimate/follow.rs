//! A geometry that follows moved clicks at once, without a search.
//!
//! The fundamental matrix belongs to the two images, not to the clicks, so an earlier one of the same images is
//! a start: it is refitted to the matches that support it, together with the clicks where they are now. That
//! takes milliseconds where the search takes a second, and is right as long as the earlier geometry was.
//!
//! # Pitfalls
//! - It cannot leave a wrong geometry; only the search can. Hence several starts, of which the one with most
//!   patch support is followed, and no verdict.

use super::level::resized_pair;
use super::polish::{Observation, fit};
use super::search::BAND;
use super::{Estimate, Parameters, PatchSupport, PreparedPair};
use crate::geometry::{FundamentalMatrix, PointPair};

/// Standard deviation of a supporting match, px of the level it was found at.
const MATCH_SIGMA: f64 = 1.0;
/// Sampson distance beyond which a match loses influence, in its standard deviations.
const ROBUST: f64 = 2.0;
/// Fewer supporting matches than this leave the clicks to decide alone, which is the search's business.
const LEAST_MATCHES: usize = 16;

/// The most supported of some earlier estimates of the same images, refitted with the clicks where they are
/// now. It carries the hypotheses of the estimate it comes from and no verdict.
///
/// `None` when the parameters do not look at patches, when there are too few clicks, or when too few matches
/// support any of the starts. Takes some 10 ms at 768×576.
pub fn follow<'a>(
    prepared: &PreparedPair,
    starts: impl IntoIterator<Item = &'a Estimate>,
    pairs: &[PointPair],
    parameters: &Parameters,
) -> Option<Estimate> {
    let clicks = pairs.get(..parameters.method.pairs_needed())?;
    if !parameters.patch_support {
        return None;
    }
    let fine = prepared.fine_witness();
    let [s1, s2] = fine.scales;
    let (start, at_level, support) = starts
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
    let click_sigma = (parameters.click_sigma * s1).max(0.5);
    let observations: Vec<Observation> = matches
        .iter()
        .map(|m| Observation { pair: m.pair, sigma: MATCH_SIGMA })
        .chain(
            clicks
                .iter()
                .map(|click| Observation { pair: resized_pair(click, fine.scales), sigma: click_sigma }),
        )
        .collect();
    let fitted = fit(&at_level, &observations, ROBUST)?;
    let fundamental = fitted.fundamental.rescaled(1.0 / s1, 1.0 / s2)?;
    Some(Estimate {
        fundamental,
        epipole1: fundamental.epipole1(),
        epipole2: fundamental.epipole2(),
        support: Some(PatchSupport { matches: matches.len(), score: support }),
        warnings: Vec::new(),
        trust: None,
        uncertainty: None,
        refined: false,
        matches: Vec::new(),
        ..start.clone()
    })
}
