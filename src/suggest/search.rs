//! Candidates for the match of a click: found on small images, followed to the large ones.

use rayon::prelude::*;

use super::alignment::Aligner;
use super::correlation::{Region, Windows};
use super::template::{Pose, Template};
use crate::estimate::PreparedPair;
use crate::geometry::{Line, Point, rescaled};
use crate::image::{GrayPlane, Placement, RelativeView};

/// Longer sides of the levels candidates are compared at, px; with halved levels they are from 1/√2 to √2 times
/// that. A patch of fixed size shows some 6 %, 3 % and 1.5 % of the image: the surroundings tell repeated things
/// apart, the detail gives the place.
const SIDES: [f64; LEVELS] = [145.0, 290.0, 580.0];
const LEVELS: usize = 3;
/// Candidates followed from each level.
const PER_LEVEL: usize = 16;
/// Correlation below which a place on a small image is not followed.
const LEAST_CORRELATION: f32 = 0.5;
/// Candidates nearer to each other than this share of the longer side are one.
const SEPARATION: f64 = 0.005;

/// The two images at one size, in the order of the search.
#[derive(Clone, Copy)]
struct SearchStage<'a> {
    from: &'a GrayPlane,
    to: &'a GrayPlane,
    /// Size over full size.
    from_scale: f64,
    to_scale: f64,
}

/// The images seen from the one that was clicked.
pub(super) struct SearchView<'a> {
    stages: Vec<SearchStage<'a>>,
    full: SearchStage<'a>,
    usual: Pose,
}

/// Where the match may lie, full-size pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FoundPlace {
    pub placement: Placement,
    /// Correlation of the patches, mean of all levels, −1 to 1.
    pub correlation: f64,
}

/// What is searched for, and where.
pub(super) struct Quest<'a> {
    /// The click, full-size px.
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

    /// Peaks of the correlation on the small image, full size.
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
                // At least the pixels on either side of the line.
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
    /// A search from image `from` (0 or 1) to the other, at sizes at which things are of like size under a view.
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
        Self { stages: SIDES.map(stage).to_vec(), full: stage(f64::INFINITY), usual }
    }

    /// How things look in the other image under the view, between the smallest images of the search.
    pub fn usual_pose(&self) -> Pose {
        self.usual
    }

    fn longer_side(&self) -> f64 {
        self.full.to.frame().longer_side()
    }

    /// Whether the surroundings of a point are too uniform to be found anywhere.
    pub fn is_flat(&self, at: Point) -> bool {
        let upright = Pose { rotation: 0.0, scale: 1.0 };
        self.stages.iter().all(|s| Template::new(s.from, rescaled(at, s.from_scale), upright).is_none())
    }

    /// Places that look like the click, best first, each separate from the others.
    pub fn candidates(&self, quest: &Quest) -> Vec<FoundPlace> {
        // Along a line there is time for the large image too.
        let searched = if quest.band.is_some() { LEVELS } else { 2 };
        let starts: Vec<(usize, Placement)> = (0..searched)
            .flat_map(|k| self.stages[k].peaks(quest).into_iter().map(move |p| (k, p)))
            .collect();
        let mut found: Vec<FoundPlace> =
            starts.par_iter().filter_map(|(k, start)| self.followed(quest, *k, *start)).collect();
        // Stable: equals stay in the order they were found in, which does not depend on threads.
        found.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
        let apart = SEPARATION * self.longer_side();
        let mut separate: Vec<FoundPlace> = Vec::new();
        for candidate in found {
            let near = |c: &FoundPlace| (c.placement.at - candidate.placement.at).norm() < apart;
            if !separate.iter().any(near) {
                separate.push(candidate);
            }
        }
        separate
    }

    /// The place within reach of `near` that looks most like the surroundings of a point, wherever the alignment of one
    /// of the poses ends.
    pub fn nearby(&self, at: Point, near: Point, reach: f64, poses: &[Pose]) -> Option<FoundPlace> {
        let quest = Quest { at, poses, band: None };
        let starts: Vec<(usize, Placement)> = (0..LEVELS)
            .flat_map(|level| poses.iter().map(move |pose| (level, *pose)))
            .map(|(level, pose)| {
                let SearchStage { from_scale, to_scale, .. } = self.stages[0];
                // Poses are between the smallest images.
                (level, Placement { at: near, affine: pose.matrix() * (from_scale / to_scale) })
            })
            .collect();
        let found: Vec<FoundPlace> =
            starts.par_iter().filter_map(|(level, start)| self.followed(&quest, *level, *start)).collect();
        let near_enough = found.into_iter().filter(|found| (found.placement.at - near).norm() <= reach);
        // The first of equals, in an order that does not depend on threads.
        near_enough.reduce(|best, other| if other.correlation > best.correlation { other } else { best })
    }

    /// A place aligned at its own level and all finer ones.
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

    /// A pose between the full-size images as one between the small ones, which may be reduced unequally.
    pub fn level_pose(&self, pose: Pose) -> Pose {
        let SearchStage { from_scale, to_scale, .. } = self.stages[0];
        Pose { scale: pose.scale * to_scale / from_scale, ..pose }
    }

    /// The candidate at the full size of the images.
    pub fn finished(&self, at: Point, candidate: &FoundPlace) -> Placement {
        let aligned = self.full.aligner(at).align(self.full.placement(&candidate.placement));
        aligned.map_or(candidate.placement, |placement| self.full.full(&placement))
    }
}

fn rescaled_line(line: &Line, scale: f64) -> Option<Line> {
    let foot = rescaled(line.foot(Point::origin()), scale);
    Line::through(foot, foot + line.direction())
}
