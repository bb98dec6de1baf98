//! The steered search: line similarity proposes, patch support disposes, local optimisation polishes.
//!
//! 1. Many combinations of candidate line pairs are scored by the κ votes of look-alike corners.
//! 2. The best, thinned so that no two are near-copies, are scored by exact patch support.
//! 3. Those with most support are refitted to their own supporting matches with a shrinking band.
//!
//! What their matches lead to is looked for by [`super::resampling`].

use rayon::prelude::*;

use super::bundle::{Angles, Bundle};
use super::candidates::Candidate;
use super::polish::{Observation, fit};
use super::prepared::Witness;
use super::support::Support;
use super::voting::{Ballot, Booth, Elected};
use super::{EstimateError, Monitor};
use crate::geometry::{FundamentalMatrix, PointPair};

/// A hypothesis at the witness level.
#[derive(Debug, Clone)]
pub(crate) struct Steered {
    /// The line pairs and κ it was proposed with.
    pub angles: Angles,
    /// Its matrix, in pixels of the witness level.
    pub fundamental: FundamentalMatrix,
    /// Sum of correlation excesses of the supporting matches.
    pub support: f64,
}

/// How far a supporting corner may be from the epipolar line of its partner, px of the witness level.
pub(crate) const BAND: f64 = 2.0;
/// Combinations kept for thinning, as many again as are scored exactly times this.
const THINNING: usize = 12;
/// Combinations whose exact support is computed.
const EXACT: usize = 240;

/// Scores combinations by votes and exact support; best first. All clicks are in full-size pixels.
pub(crate) fn propose(
    witness: &Witness,
    drawn: &[(Candidate, Candidate)],
    clicks: &[PointPair; 2],
    third: Option<&PointPair>,
    monitor: &Monitor,
) -> Result<Vec<Steered>, EstimateError> {
    let [p, q] = clicks;
    let electorate = &witness.electorate;
    let ballots = |list: &mut Vec<Candidate>, own: &PointPair, other: &PointPair, first: bool| {
        list.sort_by(|a, b| a.angles[0].total_cmp(&b.angles[0]).then(a.angles[1].total_cmp(&b.angles[1])));
        list.dedup();
        list.par_iter().map(|c| electorate.ballot(c, own, other, first)).collect::<Vec<Ballot>>()
    };
    let mut list_p: Vec<Candidate> = drawn.iter().map(|(p, _)| *p).collect();
    let mut list_q: Vec<Candidate> = drawn.iter().map(|(_, q)| *q).collect();
    let (ballots_p, ballots_q) = (ballots(&mut list_p, p, q, true), ballots(&mut list_q, q, p, false));
    let position = |list: &[Candidate], c: &Candidate| {
        list.partition_point(|o| {
            o.angles[0].total_cmp(&c.angles[0]).then(o.angles[1].total_cmp(&c.angles[1])).is_lt()
        })
    };
    let mut elected: Vec<Elected> = drawn
        .par_iter()
        .map_init(Booth::default, |booth, (p, q)| {
            if monitor.is_cancelled() {
                return None;
            }
            let p = &ballots_p[position(&list_p, p)];
            let q = &ballots_q[position(&list_q, q)];
            match third {
                None => Some(electorate.count(p, q, BAND as f32, booth)),
                Some(pair) => {
                    let angles = Angles { p: p.angles(), q: q.angles(), kappa: 1.0 };
                    let kappa = Bundle::new(&angles, *clicks)?.map().kappa_from_point_pair(pair)?;
                    (kappa > 0.0).then(|| electorate.count_for(p, q, BAND as f32, kappa))
                }
            }
        })
        .flatten()
        .collect();
    monitor.check()?;
    elected.sort_by(|a, b| b.votes.total_cmp(&a.votes));
    elected.truncate(THINNING * EXACT);
    let mut proposals: Vec<Steered> = thinned(&elected, EXACT)
        .par_iter()
        .filter_map(|e| {
            let fundamental = Bundle::new(&e.angles, *clicks)?.fundamental()?;
            let support = witness.support.score(&fundamental, BAND);
            Some(Steered { angles: e.angles, fundamental, support })
        })
        .collect();
    monitor.check()?;
    proposals.sort_by(|a, b| b.support.total_cmp(&a.support));
    Ok(proposals)
}

/// The best ones of a list sorted by votes, none nearly the same as one before it.
fn thinned(elected: &[Elected], count: usize) -> Vec<Elected> {
    let near = |a: f64, b: f64| (a - b).abs() < 0.03;
    let mut kept: Vec<Elected> = Vec::with_capacity(count);
    for e in elected {
        let copy = kept.iter().any(|k| {
            (0..2).all(|i| near(k.angles.p[i], e.angles.p[i]) && near(k.angles.q[i], e.angles.q[i]))
                && near(k.angles.kappa.ln(), e.angles.kappa.ln())
        });
        if !copy {
            kept.push(*e);
            if kept.len() == count {
                break;
            }
        }
    }
    kept
}

/// How the hypotheses of one witness level are polished.
pub(crate) struct Polishing {
    /// Hypotheses that are refitted.
    pub count: usize,
    /// Widths of the band while refitting, px of the level.
    pub bands: &'static [f64],
}

/// At the level where the proposals come from.
pub(crate) const COARSE: Polishing = Polishing { count: 40, bands: &[6.0, 4.0, 2.5, 1.5, 1.5] };
/// At the next finer level, from the results of the coarser one.
pub(crate) const FINE: Polishing = Polishing { count: 24, bands: &[6.0, 3.0, 1.5] };

/// Refits the best proposals to their supporting matches; best first by support afterwards, near-copies left
/// out. The clicks take part with standard deviation `sigma`, px of the level.
pub(crate) fn polish(
    support: &Support,
    proposals: &[Steered],
    how: &Polishing,
    clicks: &[PointPair],
    sigma: f64,
    monitor: &Monitor,
) -> Result<Vec<Steered>, EstimateError> {
    let mut polished: Vec<Steered> = proposals
        .par_iter()
        .take(how.count)
        .map(|start| {
            if monitor.is_cancelled() {
                return start.clone();
            }
            let fundamental = climb(support, &start.fundamental, how.bands, clicks, sigma);
            let score = support.score(&fundamental, BAND);
            if score > start.support {
                Steered { fundamental, support: score, ..start.clone() }
            } else {
                start.clone()
            }
        })
        .collect();
    monitor.check()?;
    polished.sort_by(|a, b| b.support.total_cmp(&a.support));
    polished.dedup_by(|b, a| (a.fundamental.matrix() - b.fundamental.matrix()).norm() < 1e-9);
    Ok(polished)
}

fn climb(
    support: &Support,
    start: &FundamentalMatrix,
    bands: &[f64],
    clicks: &[PointPair],
    sigma: f64,
) -> FundamentalMatrix {
    let mut f = *start;
    for band in bands {
        let observations: Vec<Observation> = support
            .matches(&f, *band)
            .iter()
            .map(|m| Observation { pair: m.pair, sigma: 1.0 })
            .chain(clicks.iter().map(|c| Observation { pair: *c, sigma }))
            .collect();
        match fit(&f, &observations, band / 3.0) {
            Some(result) => f = result.fundamental,
            None => break,
        }
    }
    f
}
