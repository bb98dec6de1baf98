//! The geometry shown by the whole window, and its lines.

use super::comparison::Contestant;
use super::computation::Freshness;
use super::document::{LineSource, Pin, Side};
use super::verdict::Tone;
use super::{Model, TabId};
use crate::estimate::{Construction, Estimate, Reason, RefinedMatch, lines_at};
use crate::geometry::fan::{self, NumberedLines};
use crate::geometry::{AnchoredLine, FundamentalMatrix, Line, Point, PointPair, symmetric_epipolar_distance};
use crate::io::{GroundTruth, PictureFolder};

/// The geometry shown by the whole window: the selected hypothesis, other method or imported
/// geometry, or else the result. Without a result, the imported geometry.
#[derive(Clone, Copy)]
pub struct ShownGeometry<'a> {
    pub fundamental: &'a FundamentalMatrix,
    /// The selected hypothesis, with its place in the list.
    pub hypothesis: Option<(usize, &'a Estimate)>,
    /// The selected contestant of the comparison, other than the result.
    pub contestant: Option<Contestant>,
    /// The result behind the geometry; an imported geometry without a result stands for itself.
    pub estimate: &'a Estimate,
    /// Relation of the result to the current points.
    pub freshness: Freshness,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InspectedLines {
    pub source: LineSource,
    /// One line per image, with matching directions and anchors at nearly the same scene point.
    pub lines: [AnchoredLine; 2],
}

impl ShownGeometry<'_> {
    pub fn is_result(&self) -> bool {
        self.hypothesis.is_none() && self.contestant.is_none()
    }
}

impl Model {
    /// Returns the shown geometry. All drawings and measures use this one.
    pub fn shown(&self) -> Option<ShownGeometry<'_>> {
        let own = self.open.computation.result();
        let chosen = self.open.focus.contestant() == Some(Contestant::Imported);
        let imported = self.open.imported.as_ref().filter(|_| chosen || own.is_none());
        let (estimate, freshness) = own.or(imported.map(|imported| (imported, Freshness::Final)))?;
        let hypothesis = self.open.focus.hypothesis().and_then(|k| Some((k, estimate.hypotheses().get(k)?)));
        let compared = self.open.focus.contestant().zip(self.open.comparison.as_ref());
        let compared = compared.and_then(|(contestant, c)| Some((contestant, c.fundamental(contestant)?)));
        let compared = compared
            .filter(|(contestant, _)| *contestant != Contestant::Imported)
            .or(imported.map(|imported| (Contestant::Imported, imported.fundamental())));
        let fundamental = match (hypothesis, compared) {
            (Some((_, hypothesis)), _) => hypothesis.fundamental(),
            (None, Some((_, fundamental))) => fundamental,
            (None, None) => estimate.fundamental(),
        };
        let contestant = compared.map(|(contestant, _)| contestant);
        Some(ShownGeometry { fundamental, hypothesis, contestant, estimate, freshness })
    }

    /// Returns the true geometry of a sample before anything was placed. It shows what epipolar lines are.
    pub fn lesson(&self) -> Option<&FundamentalMatrix> {
        let is_sample = self.open.show_me.is_some() && !self.compares_barcodes();
        let is_start = self.is_at_start() && self.document.truth.is_none();
        let known = self.open.known().filter(|_| is_sample && is_start);
        known.map(|known| &known.truth.fundamental)
    }

    /// Returns the geometry that files and the clipboard may have: the shown one, unless it is only what the search
    /// ended with for pictures of different scenes.
    pub fn geometry_to_write(&self) -> Option<ShownGeometry<'_>> {
        self.shown().filter(|shown| self.tone() != Tone::Apart || !shown.is_result())
    }

    /// Returns evenly spaced lines of the shown geometry.
    pub fn numbered_lines(&self) -> Vec<NumberedLines> {
        let Some((shown, frames)) = self.shown().zip(self.document.frames()) else { return Vec::new() };
        let found = shown.estimate.matches().iter().map(|found| found.pair);
        let used = self.document.used().map(|pair| self.document.pairs[pair]);
        let matches: Vec<PointPair> =
            if shown.estimate.matches().is_empty() { used.collect() } else { found.collect() };
        fan::numbered(shown.fundamental, frames, &matches)
    }

    /// Returns the open folder, and its open pair.
    pub fn folder(&self) -> Option<(&PictureFolder, [usize; 2])> {
        self.open.folder.as_ref().map(|(folder, pair)| (folder.as_ref(), *pair))
    }

    /// Returns whether the open folder has another pair beside the open one.
    pub fn has_neighbour(&self, forward: bool) -> bool {
        self.folder().is_some_and(|(folder, pair)| folder.neighbour(pair, forward).is_some())
    }

    /// Returns the symmetric distance of a pair from the result, px, if the verdict names the pair
    /// as off its line.
    pub fn outvoted(&self, pair: usize) -> Option<f64> {
        let (estimate, freshness) = self.open.computation.result()?;
        let number = self.document.used().position(|used| used == pair)? + 1;
        let mut reasons = estimate
            .assessment
            .trust
            .iter()
            .filter(|_| freshness == Freshness::Final)
            .flat_map(|t| &t.reasons);
        let is_named = reasons.any(|r| matches!(r, Reason::ClickOff { pair, .. } if *pair == number));
        is_named.then(|| symmetric_epipolar_distance(estimate.fundamental(), &self.document.pairs[pair]))
    }

    /// Returns about where the match of a point is in the other image: displaced like the nearest match of the
    /// result, on the epipolar line. `None` without matches.
    pub fn matched(&self, side: Side, point: Point) -> Option<Point> {
        let shown = self.shown()?;
        let distance = |pair: &PointPair| (side.point(pair) - point).norm_squared();
        let matches = shown.estimate.matches().iter().map(|found| found.pair);
        let nearest = matches.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let moved = point + (side.other().point(&nearest) - side.point(&nearest));
        let line = match side {
            Side::Left => shown.fundamental.line2_from_point1(point),
            Side::Right => shown.fundamental.line1_from_point2(point),
        };
        Some(line?.foot(moved))
    }

    /// Returns whether another geometry than the result is selected.
    pub fn shows_another(&self) -> bool {
        self.open.focus.hypothesis().is_some() || self.open.focus.contestant().is_some()
    }

    /// Returns the geometry of a final result that is not unreliable.
    pub fn settled(&self) -> Option<&FundamentalMatrix> {
        let (estimate, freshness) = self.open.computation.result()?;
        let stands = !matches!(self.tone(), Tone::Bad | Tone::Apart);
        (freshness == Freshness::Final && stands).then(|| estimate.fundamental())
    }

    /// Returns the latest result, even while a newer one is being computed.
    pub fn result(&self) -> Option<&Estimate> {
        self.open.computation.result().map(|(estimate, _)| estimate)
    }

    pub fn matches(&self) -> &[RefinedMatch] {
        self.result().map_or(&[], Estimate::matches)
    }

    /// Returns the pairs of the matches of the latest result.
    pub fn matched_pairs(&self) -> impl ExactSizeIterator<Item = PointPair> + '_ {
        self.matches().iter().map(|found| found.pair)
    }

    pub fn truth(&self) -> Option<&GroundTruth> {
        self.document.truth.as_ref()?;
        self.open.known().map(|known| &*known.truth)
    }

    /// Returns the lines that build the shown geometry: of the selected hypothesis, or else of the
    /// result or best hypothesis. `None` for other methods, which are fitted to points.
    pub fn construction(&self) -> Option<&Construction> {
        self.shown().filter(|shown| shown.contestant.is_none())?;
        self.own_construction()
    }

    /// Returns the lines of the estimate, even while another method is shown.
    fn own_construction(&self) -> Option<&Construction> {
        let shown = self.shown()?;
        let estimate = shown.hypothesis.map_or(shown.estimate, |(_, hypothesis)| hypothesis);
        estimate.assessment.lines.as_ref().map(|lines| &lines.construction)
    }

    /// Returns the lines of a source under the shown geometry; `None` if there are none.
    pub fn lines(&self, source: LineSource) -> Option<[AnchoredLine; 2]> {
        match source {
            LineSource::Pencil { pair, angles } => {
                self.document.pairs.get(pair).map(|click| lines_at(click, angles))
            }
            LineSource::Pair(pair) => {
                let PointPair { point1, point2 } = *self.document.pairs.get(pair)?;
                let f = self.shown()?.fundamental;
                self.corresponding(&f.line1_from_point2(point2)?, &f.line2_from_point1(point1)?)
            }
            LineSource::Through { side: Side::Left, point } => {
                let f = self.shown()?.fundamental;
                let line1 = Line::joining(&f.epipole1(), &point.to_homogeneous())?;
                self.corresponding(&line1, &f.line2_from_point1(point)?)
            }
            LineSource::Through { side: Side::Right, point } => {
                let f = self.shown()?.fundamental;
                let line2 = Line::joining(&f.epipole2(), &point.to_homogeneous())?;
                self.corresponding(&f.line1_from_point2(point)?, &line2)
            }
        }
    }

    /// Returns two epipolar lines of the shown geometry with matching directions.
    fn corresponding(&self, line1: &Line, line2: &Line) -> Option<[AnchoredLine; 2]> {
        let turn = self
            .own_construction()
            .map(Construction::turn)
            .or_else(|| self.open.computation.searched().map(Estimate::turn))
            .unwrap_or(0.0);
        let f = self.shown()?.fundamental;
        let used = self.document.used_pairs().and_then(|pairs| pairs.first_chunk::<2>().copied());
        // Matches anchor the lines of both images at the same scene points.
        let matched = || self.standing_in().first_chunk::<2>().copied();
        let clicks = used.or_else(matched).or_else(|| self.stand_in_clicks(f))?;
        let own = Construction::of(f, clicks, turn)?;
        own.corresponding(line1, line2).map(|(line1, line2)| [line1, line2])
    }

    /// Returns two pairs that replace clicks for a geometry without any: places of the left image,
    /// and the nearest points on their epipolar lines. They only fix matching directions and
    /// anchors of lines.
    fn stand_in_clicks(&self, f: &FundamentalMatrix) -> Option<[PointPair; 2]> {
        let [upper, _, lower, _] = self.document.frame(Side::Left)?.corners();
        let pair = |share: f64| {
            let point1 = upper + (lower - upper) * share;
            Some(PointPair { point1, point2: f.line2_from_point1(point1)?.foot(point1) })
        };
        Some([pair(0.3)?, pair(0.65)?])
    }

    /// Returns places on corresponding lines of a result without clicks: the matches that replace the clicks, or
    /// else any places, as sequences have no matches.
    pub fn unclicked_places(&self) -> Vec<PointPair> {
        let found = self.standing_in();
        let result = self.result().filter(|_| found.is_empty() && self.document.is_unclicked());
        let any = result.and_then(|estimate| self.stand_in_clicks(estimate.fundamental()));
        any.map_or(found, Vec::from)
    }

    /// Returns the suggested second point if the suggestion is clear. Enter places it.
    pub fn accepted_suggestion(&self) -> Option<(Side, Point)> {
        let half = self.document.half?;
        let clear = self.open.suggestion.as_ref()?.as_ref().ok()?.clear()?;
        Some((half.side.other(), clear.position))
    }

    /// Returns the pinned line pairs with their numbers, oldest first.
    pub fn pinned(&self) -> impl Iterator<Item = (usize, InspectedLines)> + '_ {
        self.document.pins.iter().filter_map(|pin: &Pin| {
            Some((pin.number, InspectedLines { source: pin.source, lines: self.lines(pin.source)? }))
        })
    }

    /// Returns the lines through one of the places that replace clicks: the lines that both images
    /// show most of.
    fn through_longest(&self) -> Option<LineSource> {
        let shown = |source: &LineSource| {
            let length = |side: Side, line: &AnchoredLine| {
                self.document.frame(side)?.clip(&line.line()).map(|segment| segment.length())
            };
            let [line1, line2] = self.lines(*source)?;
            Some(length(Side::Left, &line1)?.min(length(Side::Right, &line2)?))
        };
        let through = |found: PointPair| LineSource::Through { side: Side::Left, point: found.point1 };
        let sources = self.unclicked_places().into_iter().map(through);
        let longest = sources.filter_map(|source| Some((shown(&source)?, source)));
        longest.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, source)| source)
    }

    /// Returns the inspected line pair: the chosen pin, or else the lines of the selected pair or of the
    /// first one. The left line runs to the right, so its charts lie like the picture.
    pub fn inspected(&self) -> Option<InspectedLines> {
        // The replay shows the profiles of its own lines, unless the user looks at others meanwhile.
        let replay = &self.open.replay;
        let has_none = self.look.tab == TabId::Step && self.document.inspected_pin().is_none();
        let is_free = replay.is_playing() || has_none;
        let replayed = replay.moment().filter(|_| is_free).and_then(|moment| moment.lines);
        if let Some(source) = replayed {
            return Some(InspectedLines { source, lines: self.lines(source)? });
        }
        let source = match self.document.inspected_pin() {
            Some(pin) => pin.source,
            None => match self.document.selected_pair().or_else(|| self.document.used().next()) {
                Some(pair) => LineSource::Pair(pair),
                None => self.through_longest()?,
            },
        };
        let mut lines = self.lines(source)?;
        let way = lines[0].direction;
        if way.x < 0.0 || way.x == 0.0 && way.y < 0.0 {
            lines = lines.map(|line| AnchoredLine { direction: -line.direction, ..line });
        }
        Some(InspectedLines { source, lines })
    }
}
