//! Refitting proposals to their own supporting matches, with a shrinking band.

use rayon::prelude::*;

use super::Proposal;
use super::support::SupportLevel;
use crate::estimate::{EstimateError, Monitor};
use crate::geometry::{FundamentalMatrix, Observation, PointPair, fit_fundamental};

/// How the proposals of one level are polished.
pub(super) struct Polishing {
    /// Proposals that are refitted.
    pub count: usize,
    /// Widths of the band while refitting, px of the level.
    pub bands: &'static [f64],
}

/// At the level where the proposals come from.
pub(super) const COARSE: Polishing = Polishing { count: 40, bands: &[6.0, 4.0, 2.5, 1.5, 1.5] };
/// At the next finer level, from the results of the coarser one.
pub(super) const FINE: Polishing = Polishing { count: 24, bands: &[6.0, 3.0, 1.5] };

/// Standard deviations that a band is wide: matches beyond one of them lose influence.
const BAND_DEVIATIONS: f64 = 3.0;
/// Standard deviation of a click at least, px of the level: clicks more precise than a level can show would pin what its
/// corners cannot.
pub(in crate::estimate) const LEAST_CLICK_SIGMA: f64 = 0.5;
/// Matrices of norm 1 that differ by less than this are results of the same climb.
const SAME: f64 = 1e-9;

/// Refits the best proposals to their supporting matches; best first by support afterwards, near-copies left
/// out. The clicks (full size, with their standard deviation) take part.
pub(super) fn polish(
    level: &SupportLevel,
    proposals: &[Proposal],
    how: &Polishing,
    clicks: &[PointPair],
    click_sigma: f64,
    monitor: &Monitor,
) -> Result<Vec<Proposal>, EstimateError> {
    let sigma = (click_sigma * level.scales[0]).max(LEAST_CLICK_SIGMA);
    let clicks: Vec<Observation> =
        clicks.iter().map(|click| Observation { pair: click.rescaled(level.scales), sigma }).collect();
    let mut polished: Vec<Proposal> = proposals
        .par_iter()
        .take(how.count)
        .map(|start| {
            if monitor.is_cancelled() {
                return start.clone();
            }
            let fundamental = climb(level, &start.fundamental, how.bands, &clicks);
            let support = level.support.measure(&fundamental);
            let is_better = support.score > start.support.score;
            if is_better { Proposal { fundamental, support, ..start.clone() } } else { start.clone() }
        })
        .collect();
    monitor.check()?;
    Proposal::sort(&mut polished);
    polished.dedup_by(|b, a| (a.fundamental.matrix() - b.fundamental.matrix()).norm() < SAME);
    Ok(polished)
}

fn climb(
    level: &SupportLevel,
    start: &FundamentalMatrix,
    bands: &[f64],
    clicks: &[Observation],
) -> FundamentalMatrix {
    let mut f = *start;
    for band in bands {
        let matches = level.support.matches(&f, *band);
        let observations: Vec<Observation> = matches
            .iter()
            .map(|m| Observation { pair: m.pair, sigma: 1.0 })
            .chain(clicks.iter().copied())
            .collect();
        match fit_fundamental(&f, &observations, band / BAND_DEVIATIONS) {
            Some(result) => f = result.fundamental,
            None => break,
        }
    }
    f
}
