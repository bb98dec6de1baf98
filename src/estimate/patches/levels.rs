//! What patches need to be computed once per image pair, whatever the clicks: corners, correlations, votes.

use std::sync::OnceLock;

use super::refinement::{Refined, RefinementLevel};
use super::support::{Support, SupportLevel};
use super::voting::KappaVoting;
use crate::estimate::Monitor;
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::image::{PyramidPair, warps};

/// Longer side of the images patch support is computed on first, px.
const COARSE_SIDE: f64 = 384.0;
/// Corners an image at that size.
const COARSE_CORNERS: usize = 600;
/// Longer side where the right geometry stands out more clearly, px.
const FINE_SIDE: f64 = 768.0;
/// Corners an image at that size.
const FINE_CORNERS: usize = 1500;
/// Look-alikes of a corner that vote.
const VOTES_PER_CORNER: usize = 3;
/// Longer sides of the levels `F` is refined at, px; the last one is full size.
const REFINEMENT_SIDES: [f64; 2] = [800.0, f64::INFINITY];

/// The patches of an image pair at all sizes, each made when it is first needed.
#[derive(Debug, Default)]
pub(in crate::estimate) struct PatchLevels {
    coarse: OnceLock<SupportLevel>,
    voting: OnceLock<KappaVoting>,
    fine: OnceLock<SupportLevel>,
    refinement: [RefinementLevel; REFINEMENT_SIDES.len()],
}

impl PatchLevels {
    /// Support where proposals are made.
    pub fn coarse(&self, pyramids: &PyramidPair) -> &SupportLevel {
        self.coarse.get_or_init(|| support(pyramids, COARSE_SIDE, COARSE_CORNERS))
    }

    /// The corner pairs of the coarse level that vote for κ.
    pub fn voting(&self, pyramids: &PyramidPair) -> &KappaVoting {
        self.voting.get_or_init(|| KappaVoting::new(&self.coarse(pyramids).support, VOTES_PER_CORNER))
    }

    /// Support where proposals are ranked.
    pub fn fine(&self, pyramids: &PyramidPair) -> &SupportLevel {
        self.fine.get_or_init(|| support(pyramids, FINE_SIDE, FINE_CORNERS))
    }

    /// Refines `f` level by level up to full size; `None` when there are too few matches at the first, or when stopped.
    pub fn refine(
        &self,
        pyramids: &PyramidPair,
        f: &FundamentalMatrix,
        clicks: &[PointPair],
        click_sigma: f64,
        monitor: &Monitor,
    ) -> Option<Refined> {
        let mut refined: Option<Refined> = None;
        let mut done = None;
        for (side, stage) in REFINEMENT_SIDES.iter().zip(&self.refinement) {
            let level = pyramids.level(*side);
            if done == Some(level.scales) {
                break;
            }
            let start = refined.as_ref().map_or(*f, |r| r.fundamental);
            match stage.refine(&level, &start, clicks, click_sigma, monitor) {
                Some(result) => refined = Some(result),
                None => break,
            }
            done = Some(level.scales);
        }
        refined
    }
}

fn support(pyramids: &PyramidPair, side: f64, corners: usize) -> SupportLevel {
    let level = pyramids.level(side);
    SupportLevel { scales: level.scales, support: Support::new(level.planes, corners, &warps()) }
}
