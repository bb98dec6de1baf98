//! Writer of the events of a search. Their number and size are limited: a record stays below 1 MB, apart from the
//! pencils, which it shares with the trace.

use crate::estimate::evidence::lines::LineCandidate;
use crate::estimate::{DistinctMatch, Event, EventKind, HypothesisNote, LinePairNote, RankedHypothesis};
use crate::geometry::{AnchoredLine, rescaled};

/// Largest number of hypotheses in all events of a search.
const KEPT_HYPOTHESES: usize = 240;
/// Number of the best hypotheses of an event that are kept. Of the others, some are kept evenly in their order.
const KEPT_BEST: usize = 40;
/// Number of hypotheses of a ranking that are kept.
const KEPT_RANKED: usize = 8;
/// Largest number of candidates among all lines in an event.
const KEPT_LINES: usize = 400;
/// Largest number of matches of features in an event.
const KEPT_MATCHES: usize = 1500;

/// Writer of events.
#[derive(Debug, Default)]
pub(in crate::estimate) struct EventLog {
    events: Vec<Event>,
    hypotheses: usize,
}

impl EventLog {
    pub fn push(&mut self, seconds: f64, kind: EventKind) {
        self.events.push(Event { seconds, kind });
    }

    /// Writes that features were matched. `matches` have their ratio.
    pub fn matched(&mut self, seconds: f64, matches: impl Iterator<Item = DistinctMatch>) {
        let mut best: Vec<DistinctMatch> = matches.collect();
        let all = best.len();
        best.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        best.truncate(KEPT_MATCHES);
        self.push(seconds, EventKind::Matched { all, best });
    }

    /// Writes lines with their best partners, and candidates, best first. `scales` leads from full size to the pixels
    /// of the lines.
    pub fn lines(
        &mut self,
        seconds: f64,
        compared: [usize; 2],
        [swept, candidates]: [&[LineCandidate]; 2],
        scales: [f64; 2],
    ) {
        let full_size = |line: &AnchoredLine, scale: f64| AnchoredLine {
            anchor: rescaled(line.anchor, scale.recip()),
            direction: line.direction,
        };
        let noted = |own: &LineCandidate| LinePairNote {
            lines: [full_size(&own.line1, scales[0]), full_size(&own.line2, scales[1])],
            cost: f64::from(own.cost),
        };
        let swept = swept.iter().map(noted).collect();
        let candidates = candidates.iter().take(KEPT_LINES).map(noted).collect();
        self.push(seconds, EventKind::Lines { compared, swept, candidates });
    }

    /// Writes proposals, best first.
    pub fn proposed(&mut self, seconds: f64, examined: usize, all: &[HypothesisNote]) {
        // Half of the room stays for later events.
        let room = (KEPT_HYPOTHESES - self.hypotheses).div_ceil(2);
        let hypotheses = thinned(all, room);
        self.hypotheses += hypotheses.len();
        self.push(seconds, EventKind::Proposed { examined, hypotheses });
    }

    /// Writes the best different hypotheses, best first.
    pub fn ranked(&mut self, seconds: f64, all: impl Iterator<Item = RankedHypothesis>) {
        self.push(seconds, EventKind::Ranked(all.take(KEPT_RANKED).collect()));
    }

    pub fn events(&self) -> &[Event] {
        &self.events
    }
}

/// Returns the best hypotheses, and others evenly in their order, `room` at most.
fn thinned(all: &[HypothesisNote], room: usize) -> Vec<HypothesisNote> {
    let (best, others) = all.split_at(all.len().min(KEPT_BEST).min(room));
    let room = room - best.len();
    let evenly = (0..room.min(others.len())).map(|k| others[k * others.len() / room.min(others.len())]);
    best.iter().copied().chain(evenly).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::rows;
    use crate::estimate::{Proposed, ProposedBy};
    use crate::geometry::{Point, PointPair};

    fn hypotheses(count: usize) -> Vec<HypothesisNote> {
        let of = |k: usize| HypothesisNote {
            support: Some(k as f64),
            ..Proposed::by(ProposedBy::Features, rows(0.0)).into()
        };
        (0..count).map(of).collect()
    }

    #[test]
    fn the_best_are_kept_and_some_of_the_others() {
        let kept: Vec<f64> = thinned(&hypotheses(240), 60).iter().filter_map(|one| one.support).collect();
        assert_eq!((kept.len(), kept[39], kept[40], kept[41], kept[59]), (60, 39.0, 40.0, 50.0, 230.0));
        assert_eq!(thinned(&hypotheses(7), 60).len(), 7);
        assert_eq!(thinned(&hypotheses(100), 10).len(), 10);
        assert!(thinned(&hypotheses(100), 0).is_empty() && thinned(&[], 9).is_empty());
    }

    #[test]
    fn lines_are_noted_in_full_size() {
        let line = |x: f64| AnchoredLine::at_angle(Point::new(x, 10.0), 0.3);
        let own = |k: i32| LineCandidate { line1: line(f64::from(k)), line2: line(20.0), cost: 0.25 };
        let all: Vec<LineCandidate> = (0..900).map(own).collect();
        let mut log = EventLog::default();
        log.lines(0.0, [5, 6], [&all[..90], &all], [0.5, 0.25]);
        let EventKind::Lines { compared, swept, candidates } = &log.events()[0].kind else { panic!() };
        assert_eq!((*compared, swept.len(), candidates.len()), ([5, 6], 90, KEPT_LINES));
        let [left, right] = swept[3].lines;
        assert_eq!((left.anchor, right.anchor), (Point::new(6.5, 20.5), Point::new(81.5, 41.5)));
        assert_eq!((left.direction, swept[3].cost), (line(0.0).direction, 0.25));
        assert!(size_of::<LinePairNote>() * (90 + KEPT_LINES) < 1 << 16);
    }

    #[test]
    fn a_record_has_a_largest_size_whatever_happens() {
        let mut log = EventLog::default();
        let found = DistinctMatch { pair: PointPair::new(1.0, 2.0, 3.0, 4.0), ratio: 0.5 };
        for _ in 0..9 {
            log.proposed(0.0, 2000, &hypotheses(240));
            log.matched(0.0, (0..9000).map(|k| DistinctMatch { ratio: 1.0 / f64::from(k), ..found }));
        }
        let (mut kept, mut bytes) = (0, size_of_val(log.events()));
        for event in log.events() {
            match &event.kind {
                EventKind::Proposed { hypotheses, .. } => {
                    kept += hypotheses.len();
                    bytes += size_of_val(hypotheses.as_slice());
                }
                EventKind::Matched { all, best } => {
                    assert!(*all == 9000 && best.is_sorted_by(|a, b| a.ratio <= b.ratio));
                    bytes += size_of_val(best.as_slice());
                }
                _ => {}
            }
        }
        assert!(kept > KEPT_HYPOTHESES - 3 && kept <= KEPT_HYPOTHESES, "{kept}");
        assert!(bytes < 1 << 20, "{bytes}");
    }
}
