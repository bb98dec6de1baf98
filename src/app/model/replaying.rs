//! The replay of the search of the open pictures.

use std::sync::Arc;
use std::time::Duration;

use super::computation::Freshness;
use super::recording::PlayerCommand;
use super::replay::course::{Course, Place};
use super::replay::kept::hypothesis_of;
use super::replay::moment::Moment;
use super::replay::record::{Record, Source};
use super::replay::{Key, ReplayCommand, Speed, steps};
use super::verdict::Tone;
use super::{MethodStep, Model, Side, StageId, TabId};
use crate::estimate::{Event, EventKind, SearchPlan};
use crate::geometry::Frame;

/// Time after which a running search is drawn, so that short ones do not flash.
const LONG: Duration = Duration::from_millis(500);

impl Model {
    /// Returns the steps of the search on the time axis.
    pub fn course(&self) -> Course {
        let plan = self.document.search_plan();
        match &self.open.replay.record {
            Some((key, record)) if key.running => Course::of_running(plan, record),
            Some((_, record)) if !record.is_empty() => Course::of(plan, record),
            _ => Course::planned(plan),
        }
    }

    /// Returns whether a search left a record that can be replayed.
    pub fn has_record(&self) -> bool {
        self.open.replay.record.as_ref().is_some_and(|(_, record)| !record.is_empty())
    }

    /// Returns the record of the search, for charts.
    pub fn record(&self) -> Option<&Record> {
        self.open.replay.record.as_ref().map(|(_, record)| &**record)
    }

    /// Returns the step and the moment that the window shows; `None` at the result.
    pub fn replayed(&self) -> Option<Place> {
        self.open.replay.place.or_else(|| self.live())
    }

    /// Returns whether the shown moment is the newest one of a running search.
    pub fn is_live(&self) -> bool {
        self.open.replay.place.is_none() && self.live().is_some()
    }

    /// Returns whether the pictures show a hypothesis in place of the moment at which the replay pauses.
    pub fn pauses_at_hypothesis(&self) -> bool {
        let replay = &self.open.replay;
        replay.place.is_some() && !replay.playing && self.open.focus.hypothesis().is_some()
    }

    /// Returns the drawing that the pictures show; `None` if they show a geometry.
    pub fn drawn_moment(&self) -> Option<&Moment> {
        self.open.replay.moment().filter(|_| !self.pauses_at_hypothesis())
    }

    /// Shows a hypothesis in the whole window, by its place in the list; `None` shows the result.
    pub fn choose_hypothesis(&mut self, number: Option<usize>) {
        self.open.replay.playing = false;
        if number.is_none() {
            self.open.replay.stop();
        }
        self.open.focus.choose_hypothesis(number);
    }

    /// Returns the newest moment of a search that runs for long and has nothing better to show.
    fn live(&self) -> Option<Place> {
        let computation = &self.open.computation;
        let is_long = computation.elapsed().is_some_and(|elapsed| elapsed >= LONG);
        let shows_result =
            computation.result().is_some_and(|(_, freshness)| freshness != Freshness::Preliminary);
        if !is_long || shows_result {
            return None;
        }
        let (course, newest) = (self.course(), self.record()?.newest?);
        course.end_of(newest).filter(|_| course.lasts(newest))
    }

    /// Returns the moment of the matches, which stand in place of lines if the pictures seem to show different scenes.
    fn matches_of_different_scenes(&self) -> Option<Place> {
        let is_apart = self.tone() == Tone::Apart && !self.shows_another();
        self.course().end_of(MethodStep::Matches).filter(|_| is_apart)
    }

    /// Updates the record and the drawing of the shown moment.
    pub fn follow_replay(&mut self) {
        let computation = &self.open.computation;
        let events = computation.events_so_far();
        let key = Key {
            revision: computation.revision(),
            pencils: computation.pencils_revision(),
            events: events.map_or(0, <[_]>::len),
            running: events.is_some(),
        };
        if self.open.replay.record.as_ref().map(|(known, _)| *known) != Some(key) {
            self.open.replay.record = Some((key, Arc::new(self.new_record())));
            self.open.focus.hold(None);
        }
        if self.open.replay.awaited && computation.is_final() {
            self.open.replay.awaited = false;
            if !self.look.still_steps {
                self.apply_to_replay(ReplayCommand::PlaySlowly);
            }
        }
        let place = self.replayed().or_else(|| self.matches_of_different_scenes());
        if place.is_none() {
            self.open.focus.hold(None);
        }
        let replay = &mut self.open.replay;
        let is_drawn =
            |place: &Place| matches!(&replay.drawn, Some((of, at, _)) if (of, at) == (&key, place));
        if place.is_none_or(|place| !is_drawn(&place)) {
            let record = replay.record.as_ref().map(|(_, record)| record);
            let drawn = place.zip(record);
            replay.drawn = drawn.map(|(place, record)| (key, place, Arc::new(steps::draw(record, place))));
        }
    }

    /// Advances the replay. Returns whether it goes on.
    pub fn replay_on(&mut self, seconds: f64) -> bool {
        let course = self.course();
        let speed = self.look.speed.times();
        let replay = &mut self.open.replay;
        let Some(place) = replay.place.filter(|_| replay.playing) else { return false };
        // After a pause of the window, the replay goes on where it was.
        let (place, is_over) = course.after(place, seconds.clamp(0.0, 0.1) * speed, replay.alone);
        replay.place = place;
        replay.playing = !is_over;
        !is_over
    }

    pub fn apply_to_replay(&mut self, command: ReplayCommand) {
        if let ReplayCommand::Nudge { forward } = command
            && self.shows_player()
        {
            return self.apply_to_player(PlayerCommand::Step(if forward { 1 } else { -1 }));
        }
        let is_setting = matches!(command, ReplayCommand::NextSpeed | ReplayCommand::ToggleStill);
        if self.document.pictures.is_none() && !is_setting {
            return;
        }
        let course = self.course();
        let live = self.live();
        let still = self.look.still_steps;
        if !is_setting {
            self.open.focus.hold(None);
            self.open.focus.forget_hypothesis();
        }
        let replay = &mut self.open.replay;
        match command {
            ReplayCommand::TogglePlay | ReplayCommand::PlaySlowly if still => {
                self.apply_to_replay(ReplayCommand::Step { forward: true });
            }
            ReplayCommand::TogglePlay | ReplayCommand::PlaySlowly => {
                if command == ReplayCommand::PlaySlowly {
                    self.look.speed = Speed::SLOW;
                }
                let is_at_end = replay.place.is_none_or(|place| course.after(place, 1e-6, false).0.is_none());
                replay.playing = !replay.playing || is_at_end && live.is_none();
                if is_at_end && replay.playing {
                    replay.place = course.first();
                }
                replay.alone = false;
                replay.playing &= replay.place.is_some();
            }
            ReplayCommand::Seek(at) => (replay.place, replay.playing) = (course.place(at), false),
            ReplayCommand::Nudge { forward } => {
                let Some(place) = replay.place.or_else(|| course.last()) else { return };
                let seconds = course.at(place) + if forward { steps::NUDGE } else { -steps::NUDGE };
                (replay.place, replay.playing) = (course.place(seconds.max(0.0)), false);
            }
            ReplayCommand::Play(step) => {
                let (first, last) = (Place { step, seconds: 0.0 }, course.end_of(step));
                let moves = !still && course.lasts(step);
                replay.place = if moves { Some(first) } else { last.or(Some(first)) };
                (replay.playing, replay.alone) = (moves, true);
            }
            ReplayCommand::Step { forward } => {
                let now = replay.place.or(live).map(|place| place.step);
                match course.neighbour(now, forward) {
                    Some(step) => self.apply_to_replay(ReplayCommand::Play(step)),
                    None if forward => replay.stop(),
                    None => {}
                }
            }
            ReplayCommand::Show(target) => {
                (replay.place, replay.playing) = (replay.place.or(live), false);
                let shown = replay.moment().zip(replay.record.as_ref());
                let kept = shown.and_then(|(moment, (_, record))| hypothesis_of(record, moment, target));
                self.open.focus.hold(Some(target));
                if kept.is_some() {
                    self.choose_hypothesis(kept);
                }
            }
            ReplayCommand::Begin => (replay.place, replay.playing) = (course.first(), false),
            ReplayCommand::Finish => self.choose_hypothesis(None),
            ReplayCommand::NextSpeed => self.look.speed = self.look.speed.next(),
            ReplayCommand::ToggleStill => self.look.still_steps = !still,
        }
        // The chart of the step is in the first tab.
        if self.open.replay.place.is_some() && !is_setting {
            self.look.tab = TabId::Step;
            self.look.stage = StageId::Pictures;
            (self.open.player.gives_way, self.open.player.playing) = (true, false);
        }
    }

    /// Collects the record of the running search, or else of the shown result. A search that failed has none: the
    /// latest result belongs to earlier points.
    fn new_record(&self) -> Record {
        let (document, computation) = (&self.document, &self.open.computation);
        let running = computation.events_so_far();
        let result =
            computation.result().filter(|(_, freshness)| running.is_none() && !freshness.is_behind());
        let found = result.map(|(found, _)| found);
        let trace = found.and_then(|found| found.trace.as_deref());
        let events = running.or(trace.map(|trace| &trace.events[..])).unwrap_or_default();
        // The pencils compared last may be those of earlier points.
        let compared = computation.pencils().filter(|pencils| {
            let clicks = || pencils.iter().map(|own| own.click);
            let is_of_these = |event: &Event| matches!(&event.kind, EventKind::Pencils { anchors, .. } if clicks().eq(anchors.iter().copied()));
            running.is_some() && events.iter().any(is_of_these)
        });
        let frames = Side::BOTH.map(|side| document.frame(side).unwrap_or(Frame::new(1, 1)));
        Record::new(&Source {
            plan: document.search_plan(),
            frames,
            recordings: self.compared_recordings().filter(|_| document.search_plan() == SearchPlan::Barcodes),
            events,
            found,
            pencils: compared.or(trace.map(|trace| &trace.pencils[..])).unwrap_or_default(),
            pair: &|number, click| document.pair_of_pencils(number, click),
        })
    }
}

#[cfg(test)]
#[path = "replaying_tests.rs"]
mod tests;
