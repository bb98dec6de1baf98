//! Coarse-to-fine search for the match of a click.

use rayon::prelude::*;

use super::alignment::Aligner;
use super::correlation::{Region, Windows};
use super::template::{Pose, Template};
use crate::estimate::PreparedPair;
use crate::geometry::{Line, Point, rescaled};
use crate::image::{GrayPlane, Placement, RelativeView};

/// Longer sides of the compared levels, px; halved levels have 1/√2 to √2 times these sizes. A
/// patch of fixed size covers some 6 %, 3 % and 1.5 % of the image. The wide patches distinguish
/// repeated structure; the narrow patch localises.
const SIDES: [f64; LEVELS] = [145.0, 290.0, 580.0];
const LEVELS: usize = 3;
/// Maximum number of candidates followed from each level.
const PER_LEVEL: usize = 16;
/// Minimum correlation of a candidate at a reduced size.
const LEAST_CORRELATION: f32 = 0.5;
/// Distance below which two candidates are merged, as a fraction of the longer side.
const SEPARATION: f64 = 0.005;

/// Both images at one size, in the order of the search.
#[derive(Clone, Copy)]
struct SearchStage<'a> {
    from: &'a GrayPlane,
    to: &'a GrayPlane,
    /// Reduced size over full size.
    from_scale: f64,
    to_scale: f64,
}

/// Levels of both images, in the order of the search.
pub(super) struct SearchView<'a> {
    stages: [SearchStage<'a>; LEVELS],
    full: SearchStage<'a>,
    /// Pose of the view between the smallest levels.
    pub usual: Pose,
}

/// Candidate position of the match, full-size px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FoundPlace {
    pub placement: Placement,
    /// Correlation of the patches, mean of all levels, −1 to 1.
    pub correlation: f64,
}

/// Point to search for, with poses and region.
pub(super) struct Quest<'a> {
    /// Clicked point, full-size px.
    pub at: Point,
    pub poses: &'a [Pose],
    /// Epipolar line and half width of the band around it, full-size px.
    pub band: Option<(Line, f64)>,
}

impl SearchStage<'_> {
    fn placement(&self, full: &Placement) -> Placement {
        Placement {
            at: rescaled(full.at, self.to_scale),
            affine: full.affine * (self.to_scale / self.from_scale),
        }
    }

    fn full(&self, own: &Placement) -> Placement {
        Placement {
            at: rescaled(own.at, 1.0 / self.to_scale),
            affine: own.affine * (self.from_scale / self.to_scale),
        }
    }

    fn aligner(&self, full_at: Point) -> Aligner<'_> {
        Aligner { from: self.from, to: self.to, at: rescaled(full_at, self.from_scale) }
    }

    /// Returns the peaks of the correlation at this size, in full-size pixels.
    fn peaks(&self, quest: &Quest) -> Vec<Placement> {
        let at = rescaled(quest.at, self.from_scale);
        let templates: Vec<Template> =
            quest.poses.iter().filter_map(|pose| Template::new(self.from, at, *pose)).collect();
        if templates.is_empty() {
            return Vec::new();
        }
        let frame = self.to.frame();
        let region = match &quest.band {
            None => Region::whole(frame),
            Some((line, band)) => match rescaled_line(line, self.to_scale) {
                // The band covers at least the pixels on either side of the line.
                Some(line) => Region::band(frame, &line, (band * self.to_scale).max(1.0)),
                None => return Vec::new(),
            },
        };
        let map = Windows::new(self.to).best(&templates, region);
        map.peaks(LEAST_CORRELATION, PER_LEVEL)
            .into_iter()
            .map(|peak| {
                let template = &templates[usize::from(peak.best.template)];
                self.full(&Placement {
                    at: Point::new(peak.x as f64, peak.y as f64) + template.offset,
                    affine: template.pose.matrix(),
                })
            })
            .collect()
    }
}

impl<'a> SearchView<'a> {
    /// Creates a search from image `from` (0 or 1) to the other. The level sizes compensate the
    /// scale of the view.
    pub fn new(prepared: &'a PreparedPair, from: usize, view: RelativeView) -> Self {
        let warp = prepared.pyramids().level_seen(SIDES[0], view).warp(view);
        let usual = if from == 0 { Pose::of(&warp) } else { Pose::of(&warp).inverse() };
        let stage = |side: f64| {
            let level = prepared.pyramids().level_seen(side, view);
            SearchStage {
                from: level.planes[from],
                to: level.planes[1 - from],
                from_scale: level.scales[from],
                to_scale: level.scales[1 - from],
            }
        };
        Self { stages: SIDES.map(stage), full: stage(f64::INFINITY), usual }
    }

    /// Returns the distance below which two candidates count as one place, full-size px.
    pub fn resolution(&self) -> f64 {
        SEPARATION * self.full.to.frame().longer_side()
    }

    /// Returns whether the surroundings of a point are too uniform for a search.
    pub fn is_flat(&self, at: Point) -> bool {
        let upright = Pose { rotation: 0.0, scale: 1.0 };
        self.stages.iter().all(|s| Template::new(s.from, rescaled(at, s.from_scale), upright).is_none())
    }

    /// Returns separate candidates, best first.
    pub fn candidates(&self, quest: &Quest) -> Vec<FoundPlace> {
        // A band is small enough to search the large level too.
        let searched = if quest.band.is_some() { LEVELS } else { 2 };
        let starts: Vec<(usize, Placement)> = (0..searched)
            .flat_map(|k| self.stages[k].peaks(quest).into_iter().map(move |p| (k, p)))
            .collect();
        let mut found: Vec<FoundPlace> =
            starts.par_iter().filter_map(|(k, start)| self.followed(quest, *k, *start)).collect();
        // A stable sort: equal candidates keep an order that does not depend on threads.
        found.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
        let apart = self.resolution();
        let mut separate: Vec<FoundPlace> = Vec::new();
        for candidate in found {
            let near = |c: &FoundPlace| (c.placement.at - candidate.placement.at).norm() < apart;
            if !separate.iter().any(near) {
                separate.push(candidate);
            }
        }
        separate
    }

    /// Returns the best match of `at` within `reach` of `near`. Alignment starts from each of
    /// `poses` on each level.
    pub fn nearby(&self, at: Point, near: Point, reach: f64, poses: &[Pose]) -> Option<FoundPlace> {
        let quest = Quest { at, poses, band: None };
        let starts: Vec<(usize, Placement)> = (0..LEVELS)
            .flat_map(|level| poses.iter().map(move |pose| (level, *pose)))
            .map(|(level, pose)| {
                let SearchStage { from_scale, to_scale, .. } = self.stages[0];
                // Poses refer to the smallest levels.
                (level, Placement { at: near, affine: pose.matrix() * (from_scale / to_scale) })
            })
            .collect();
        let found: Vec<FoundPlace> =
            starts.par_iter().filter_map(|(level, start)| self.followed(&quest, *level, *start)).collect();
        let near_enough = found.into_iter().filter(|found| (found.placement.at - near).norm() <= reach);
        // The first of equal candidates, in an order that does not depend on threads.
        near_enough.reduce(|best, other| if other.correlation > best.correlation { other } else { best })
    }

    /// Aligns a candidate at its own level and at all finer levels.
    fn followed(&self, quest: &Quest, level: usize, start: Placement) -> Option<FoundPlace> {
        let mut full = start;
        for stage in &self.stages[level..] {
            full = stage.full(&stage.aligner(quest.at).align(stage.placement(&full))?);
        }
        if let Some((line, band)) = &quest.band
            && line.distance(full.at) > band + 1.0
        {
            return None;
        }
        let correlation = |stage: &SearchStage| stage.aligner(quest.at).correlation(&stage.placement(&full));
        let correlation = self.stages.iter().map(correlation).sum::<f64>() / LEVELS as f64;
        Some(FoundPlace { placement: full, correlation })
    }

    /// Converts a pose between the full-size images to the smallest levels, whose reductions may
    /// differ.
    pub fn level_pose(&self, pose: Pose) -> Pose {
        let SearchStage { from_scale, to_scale, .. } = self.stages[0];
        Pose { scale: pose.scale * to_scale / from_scale, ..pose }
    }

    /// Aligns the candidate at the full size of the images.
    pub fn finished(&self, at: Point, candidate: &FoundPlace) -> Placement {
        let aligned = self.full.aligner(at).align(self.full.placement(&candidate.placement));
        aligned.map_or(candidate.placement, |placement| self.full.full(&placement))
    }
}

fn rescaled_line(line: &Line, scale: f64) -> Option<Line> {
    let foot = rescaled(line.foot(Point::origin()), scale);
    Line::through(foot, foot + line.direction())
}
