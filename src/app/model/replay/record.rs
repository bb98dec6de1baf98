//! What a search left behind, in the form for drawing.

use std::sync::Arc;

use super::sweep::Sweep;
use crate::app::model::document::{LineSource, pair_name};
use crate::app::model::ids::MethodStep;
use crate::app::model::recording::Synchronised;
use crate::estimate::{
    BarcodeFigures, ComparedPencils, Construction, DistinctMatch, Estimate, Event, EventKind, HypothesisNote,
    LinePairNote, ProposedBy, RankedHypothesis, RoundTrip, SearchPlan, lines_at,
};
use crate::geometry::{
    AnchoredLine, Frame, FundamentalMatrix, Point, PointPair, area_between_lines, fan, sampson_distance,
};
use crate::presentation::proposer_in_words;

/// Ratio below which a match of features is distinctive.
const DISTINCTIVE: f64 = 0.8;
/// Share of the longer side within which a match agrees with the lines of the result.
const AGREES: f64 = 0.005;
/// Number of lines of a construction among which its typical round trip is sought.
const TRIPS: usize = 9;

/// All lines through a click, compared.
#[derive(Debug)]
pub struct RecordedPencils {
    pub compared: Arc<ComparedPencils>,
    /// Name of the click, or of the match in its place.
    pub name: String,
    /// Number of the point pair; `None` for a match in the place of a click.
    pub pair: Option<usize>,
    /// Number of the pencil.
    pub number: usize,
    /// Column of the best partner of each row, and its cost.
    pub partners: Vec<Option<(usize, f32)>>,
    /// Place of the candidate that led to the result, or of the candidate nearest to the result's lines.
    pub winner: Option<usize>,
}

impl RecordedPencils {
    /// Returns the number of the colour of the lines.
    pub fn color(&self) -> usize {
        self.pair.unwrap_or(self.number)
    }

    /// Returns the lines at these angles as lines that can be inspected. Those through a match cannot.
    pub fn source(&self, angles: [f64; 2]) -> Option<LineSource> {
        Some(LineSource::Pencil { pair: self.pair?, angles })
    }
}

/// A match of features.
#[derive(Debug)]
pub struct RecordedMatch {
    pub found: DistinctMatch,
    /// Whether it agrees with the lines of the result.
    pub agrees: bool,
}

/// A line on its way to the other picture and back.
#[derive(Debug)]
pub struct Trip {
    pub lines: RoundTrip,
    /// Mean distance between the line and its return, px.
    pub gap: f64,
    pub name: String,
    /// Place of the hypothesis in the list of the result; `None` for the result itself.
    pub kept: Option<usize>,
}

/// Where a record is collected from.
pub struct Source<'a> {
    pub plan: SearchPlan,
    /// Sizes of both pictures.
    pub frames: [Frame; 2],
    /// The sequences, if the search compares motion barcodes.
    pub recordings: Option<Synchronised>,
    pub events: &'a [Event],
    /// The result, once the search is over.
    pub found: Option<&'a Estimate>,
    pub pencils: &'a [Arc<ComparedPencils>],
    /// Returns the point pair of a pencil, by its number and its click; `None` for a match in its place.
    pub pair: &'a dyn Fn(usize, &PointPair) -> Option<usize>,
}

/// What a search left behind.
#[derive(Debug, Default)]
pub struct Record {
    pub plan: SearchPlan,
    /// Sizes of both pictures.
    pub frames: [Frame; 2],
    /// The sequences, if the search compared motion barcodes.
    pub recordings: Option<Synchronised>,
    /// Lines of the left picture with their barcodes, from the pencils or from all lines: whichever led to the result.
    pub sweep: Option<Sweep>,
    /// Candidates among all lines, best first.
    pub line_pairs: Vec<LinePairNote>,
    /// Number of lines of each picture among which the candidates were sought.
    pub lines_compared: [usize; 2],
    /// Agreement of the barcodes on the lines of the result.
    pub barcodes: Option<BarcodeFigures>,
    pub pencils: Vec<RecordedPencils>,
    /// Matches of features, in the order of use.
    pub matches: Vec<RecordedMatch>,
    /// Number of all tentative matches.
    pub tentative: usize,
    /// Proposed geometries, in order.
    pub hypotheses: Vec<HypothesisNote>,
    /// Number of all combinations that were examined.
    pub examined: usize,
    /// Place of the hypothesis that led to the result, or of the best one so far.
    pub winner: Option<usize>,
    /// A typical hypothesis and the result, from one picture to the other and back.
    pub trips: Vec<Trip>,
    /// Gaps of all hypotheses with a round trip, px, and their places in the list of the result.
    pub gaps: Vec<(f64, usize)>,
    /// Best different hypotheses with the course of their support.
    pub race: Vec<RankedHypothesis>,
    /// The fits from the best hypothesis to the result, in order.
    pub swing: Vec<FundamentalMatrix>,
    /// Number of matches of each fit.
    pub fitted: Vec<usize>,
    /// Places of the left picture whose lines are drawn.
    pub fan: Vec<Point>,
    /// Matches of the result.
    pub matched: Vec<PointPair>,
    pub result: Option<FundamentalMatrix>,
    /// Hypotheses of the result, as they are listed: their geometries, and the data that proposed them.
    pub kept: Vec<(FundamentalMatrix, Option<ProposedBy>)>,
    /// Step of the latest event that has something to show.
    pub newest: Option<MethodStep>,
    /// Data from which the result was proposed.
    pub(super) led_from: Option<ProposedBy>,
    /// Refinements of all passes so far.
    refined: Vec<Refinement>,
    /// Some lines among all, with their best partners.
    swept: Vec<LinePairNote>,
}

/// A refinement with the race before it.
#[derive(Debug)]
struct Refinement {
    selected: HypothesisNote,
    race: Vec<RankedHypothesis>,
    swing: Vec<FundamentalMatrix>,
    fitted: Vec<usize>,
}

impl Record {
    /// Collects a record.
    pub fn new(source: &Source) -> Self {
        let recordings = source.recordings.clone();
        let mut record = Self { plan: source.plan, frames: source.frames, recordings, ..Self::default() };
        for event in source.events {
            record.take(&event.kind);
        }
        if let Some(found) = source.found {
            record.take_result(found);
        }
        record.find_winner();
        let led = record.result.or(record.winner.map(|winner| record.hypotheses[winner].fundamental));
        record.fan = led.map_or_else(Vec::new, |f| fan::places(&f, record.frames[0]));
        let pencils = source.pencils.iter().enumerate();
        record.pencils =
            pencils.map(|(k, own)| record.pencil((source.pair)(k, &own.click), k, own)).collect();
        record.sweep = record.new_sweep();
        record
    }

    fn take(&mut self, event: &EventKind) {
        self.newest = match event {
            EventKind::Pencils { .. } if self.recordings.is_none() => Some(MethodStep::Pencils),
            EventKind::Lines { .. } | EventKind::Pencils { .. } => Some(MethodStep::Barcodes),
            EventKind::Matched { .. } if self.plan == SearchPlan::Unclicked => Some(MethodStep::Matches),
            EventKind::Matched { .. } => Some(MethodStep::Features),
            EventKind::Proposed { .. } => Some(MethodStep::Epipoles),
            EventKind::Ranked(_) => Some(MethodStep::Validation),
            EventKind::Refined { .. } => Some(MethodStep::Refinement),
            EventKind::Began(_) if self.recordings.is_some() => self.newest.or(Some(MethodStep::Motion)),
            EventKind::Began(_) | EventKind::Judged { .. } | EventKind::Selected(_) => self.newest,
        };
        match event {
            EventKind::Matched { all, best } => {
                // A wider search matches again. Its matches replace the earlier ones.
                self.tentative = *all;
                self.matches =
                    best.iter().map(|found| RecordedMatch { found: *found, agrees: false }).collect();
            }
            EventKind::Lines { compared, swept, candidates } => {
                self.lines_compared = *compared;
                self.swept.clone_from(swept);
                self.line_pairs.clone_from(candidates);
            }
            EventKind::Proposed { examined, hypotheses } => {
                self.examined += examined;
                self.hypotheses.extend(hypotheses);
            }
            EventKind::Ranked(best) => self.race.clone_from(best),
            EventKind::Refined { selected, steps, .. } => {
                self.refined.push(Refinement {
                    selected: *selected,
                    race: self.race.clone(),
                    swing: steps.iter().map(|step| step.fundamental).collect(),
                    fitted: steps.iter().map(|step| step.matches).collect(),
                });
                self.show_refinement(self.refined.len() - 1);
            }
            EventKind::Selected(selected) => {
                // A search of several passes may select the result of an earlier one.
                let of = |same: &dyn Fn(&HypothesisNote) -> bool| {
                    self.refined.iter().rposition(|own| same(&own.selected))
                };
                let pass = of(&|own| own.fundamental == selected.fundamental)
                    .or_else(|| of(&|own| own.origin == selected.origin));
                (self.swing, self.fitted) = (Vec::new(), Vec::new());
                if let Some(pass) = pass {
                    self.show_refinement(pass);
                }
                self.result = Some(selected.fundamental);
                self.led_from = Some(selected.origin.source);
            }
            EventKind::Began(_) | EventKind::Pencils { .. } | EventKind::Judged { .. } => {}
        }
    }

    /// Shows the race and the fits of one pass.
    fn show_refinement(&mut self, pass: usize) {
        let Refinement { selected, race, swing, fitted } = &self.refined[pass];
        (self.race, self.swing, self.fitted) = (race.clone(), swing.clone(), fitted.clone());
        (self.result, self.led_from) = (Some(selected.fundamental), Some(selected.origin.source));
    }

    /// Adds what only the end of a search knows.
    fn take_result(&mut self, found: &Estimate) {
        let f = *found.fundamental();
        self.result = Some(f);
        self.barcodes = found.assessment.barcodes;
        if self.swing.last().is_some_and(|last| *last != f) {
            self.swing.push(f);
            self.fitted.push(found.matches().len());
        }
        self.matched = found.matches().iter().map(|own| own.pair).collect();
        let limit = AGREES * self.frames[0].width.max(self.frames[0].height) as f64;
        for own in &mut self.matches {
            own.agrees = sampson_distance(&f, &own.found.pair) <= limit;
        }
        let source = |own: &Estimate| own.origin.map(|origin| origin.source);
        self.kept = found.hypotheses().iter().map(|own| (*own.fundamental(), source(own))).collect();
        let frame1 = self.frames[0];
        let hypotheses = found.hypotheses().iter().enumerate();
        let named = hypotheses.filter_map(|(k, own)| {
            let (gap, construction) = tripped(own)?;
            let name = own
                .origin
                .map_or_else(|| "a hypothesis".to_owned(), |origin| proposer_in_words(origin.source));
            Some((gap, construction, name, k))
        });
        let mut all: Vec<_> = named.collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.gaps = all.iter().map(|(gap, .., k)| (*gap, *k)).collect();
        let middle = all.len() / 2;
        let typical = all.into_iter().nth(middle).map(|(gap, lines, name, k)| (gap, lines, name, Some(k)));
        let own = tripped(found).map(|(gap, lines)| (gap, lines, "the result".to_owned(), None));
        self.trips = typical
            .into_iter()
            .chain(own)
            .filter_map(|(gap, construction, name, kept)| {
                // The line whose return is about as far away as usual.
                let mut trips = construction.round_trips(frame1, TRIPS);
                let area = |trip: &RoundTrip| area_between_lines(&trip.line1, &trip.back1, frame1);
                trips.sort_by(|a, b| area(a).total_cmp(&area(b)));
                Some(Trip { lines: *trips.get(trips.len() / 2)?, gap, name, kept })
            })
            .collect();
    }

    /// Finds the hypothesis that led to the result: the best one with its origin, or else the best one so far.
    fn find_winner(&mut self) {
        let leader = self.led_from.or(self.race.first().map(|best| best.hypothesis.origin.source));
        let same =
            leader.and_then(|leader| self.hypotheses.iter().position(|own| own.origin.source == leader));
        self.winner = same.or((!self.hypotheses.is_empty()).then_some(0));
    }

    fn pencil(&self, pair: Option<usize>, number: usize, compared: &Arc<ComparedPencils>) -> RecordedPencils {
        let name = pair.map_or_else(|| format!("match {}", number + 1), pair_name);
        let partner = |row: usize| {
            let costs = (0..compared.angles2.len()).map(|column| (column, compared.costs.at(row, column)));
            costs.filter(|(_, cost)| cost.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
        };
        let partners = (0..compared.angles1.len()).map(partner).collect();
        let ranks = self.winner.and_then(|winner| match self.hypotheses[winner].origin.source {
            ProposedBy::LinePairs { ranks } => ranks.get(number).copied(),
            _ => None,
        });
        let winner = ranks.map(|rank| rank - 1).filter(|place| *place < compared.candidates.len());
        let winner = winner.or_else(|| self.nearest(compared));
        RecordedPencils { compared: compared.clone(), name, pair, number, partners, winner }
    }

    /// Compares barcodes on lines that sweep across the left picture.
    fn new_sweep(&self) -> Option<Sweep> {
        let recordings = self.recordings.as_ref()?;
        let by_clicks = matches!(self.led_from, Some(ProposedBy::LinePairs { .. }));
        let pencil = self.pencils.first().filter(|_| by_clicks || self.swept.is_empty());
        match pencil {
            Some(own) => {
                Sweep::through_click(own.number, &own.compared, &own.partners, own.winner, recordings)
            }
            None => Sweep::of_lines(&self.swept, &self.line_pairs, self.result.as_ref(), recordings),
        }
    }

    /// Returns whether the candidates that led to the result, or may lead to it, are lines through clicks.
    pub fn is_by_clicks(&self) -> bool {
        self.sweep.as_ref().map_or(!self.pencils.is_empty(), |sweep| sweep.pencil.is_some())
    }

    /// Returns the candidate nearest to the lines of the result.
    fn nearest(&self, compared: &ComparedPencils) -> Option<usize> {
        let candidates = compared.candidates.iter().enumerate().filter_map(|(place, own)| {
            let off = self.off_result(&compared.click, &lines_at(&compared.click, own.angles))?;
            Some((off[0].max(off[1]), place))
        });
        candidates.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)
    }

    /// Returns the angles between lines through a click or match and its lines of the result, radians.
    pub fn off_result(&self, click: &PointPair, [line1, line2]: &[AnchoredLine; 2]) -> Option<[f64; 2]> {
        let f = self.result?;
        let (own1, own2) = (f.line1_from_point2(click.point2)?, f.line2_from_point1(click.point1)?);
        Some([own1.angle_to(&line1.line()), own2.angle_to(&line2.line())])
    }

    /// Returns whether a step has something to show.
    pub fn has(&self, step: MethodStep) -> bool {
        match step {
            MethodStep::Motion => self.recordings.is_some() && self.newest.is_some(),
            MethodStep::Barcodes => self.sweep.is_some(),
            MethodStep::Pencils => !self.pencils.is_empty(),
            MethodStep::Candidates if self.is_by_clicks() => {
                self.pencils.iter().any(|own| !own.compared.candidates.is_empty())
            }
            MethodStep::Candidates => self.recordings.is_some() && !self.line_pairs.is_empty(),
            MethodStep::Features | MethodStep::Matches => !self.matches.is_empty(),
            MethodStep::Epipoles => !self.hypotheses.is_empty(),
            MethodStep::RoundTrip => !self.trips.is_empty(),
            MethodStep::Validation => self.race.iter().any(|one| !one.course.is_empty()),
            MethodStep::Refinement => self.swing.len() > 1,
        }
    }

    pub fn is_empty(&self) -> bool {
        !MethodStep::ALL.into_iter().any(|step| self.has(step))
    }

    pub fn has_result(&self) -> bool {
        self.result.is_some()
    }

    /// Returns the number of distinctive matches, and of those that agree with the result.
    pub fn matches_that_count(&self) -> [usize; 2] {
        let distinctive = self.matches.iter().filter(|own| own.found.ratio < DISTINCTIVE).count();
        [distinctive, self.matches.iter().filter(|own| own.agrees).count()]
    }
}

/// Returns the round trip of a geometry that is built from lines: its gap, px, and the lines.
fn tripped(own: &Estimate) -> Option<(f64, &Construction)> {
    let lines = own.assessment.lines.as_ref()?;
    Some((lines.round_trip_area?, &lines.construction))
}
