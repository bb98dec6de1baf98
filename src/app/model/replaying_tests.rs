//! Tests of the replay on a real search of the sample.

use std::sync::LazyLock;

use super::*;
use crate::app::model::computation::{EstimateFailure, EstimateNews, EstimateRequest};
use crate::app::model::document::LineSource;
use crate::app::model::focus::Replayed;
use crate::app::model::picture::Opened;
use crate::app::model::recording::{Recording, Synchronised};
use crate::app::model::replay::course::StepState;
use crate::app::model::replay::moment::{Ink, Mark, Moment, Shape};
use crate::app::model::replay::strokes::parts_of;
use crate::app::model::sample::sample_pair;
use crate::app::model::shared::Shared;
use crate::app::model::{MethodStep, Target};
use crate::estimate::{
    EstimateError, Event, EventKind, HypothesisNote, Monitor, PreparedPair, Progress, ProposedBy,
    RankedHypothesis, RefinementStep, estimate, estimate_prepared,
};
use crate::geometry::{FundamentalMatrix, PointPair, fan};
use crate::image::Picture;
use crate::io::PairOrigin;
use crate::synthetic::{BallScene, Sample, ThrownBalls};

/// Returns a model with the result of a search of the sample, and the events that the search reported.
fn searched(clicked: bool) -> (Model, Vec<Event>) {
    let sample = sample_pair(Sample::Courtyard);
    let pairs = if clicked { sample.show_me.to_vec() } else { Vec::new() };
    let mut model = Model::default();
    model.open(sample.pictures, None, false, Some(sample.show_me));
    model.document.set_pairs(pairs.clone(), PairOrigin::Clicked);
    model.document.unclicked = !clicked;
    let pictures = model.open.pictures().unwrap();
    let parameters = model.document.search_parameters();
    let events = std::sync::Mutex::new(Vec::new());
    let monitor = Monitor::new(crate::cancel::CancelFlag::default(), |progress| {
        if let Progress::Happened(event) = progress {
            events.lock().unwrap().push(event);
        }
    });
    let found = estimate(&pictures[0].gray, &pictures[1].gray, &pairs, &parameters, &monitor).unwrap();
    drop(monitor);
    begin(&mut model, 1, pairs, None);
    model.open.computation.take(1, EstimateNews::Finished(Ok(Box::new(found))));
    (model, events.into_inner().unwrap())
}

/// Begins a search with this number, of the open pictures and these pairs.
fn begin(model: &mut Model, number: u64, pairs: Vec<PointPair>, recordings: Option<Synchronised>) {
    let (pictures, parameters) = (model.open.pictures().unwrap(), model.document.search_parameters());
    let request = EstimateRequest { pictures, recordings, views: None, pairs, given: None, parameters };
    model.open.computation.adopt(Some(&request));
    model.open.computation.begin(number, false);
}

static CLICKED: LazyLock<Record> = LazyLock::new(|| searched(true).0.new_record());
static UNCLICKED: LazyLock<Record> = LazyLock::new(|| searched(false).0.new_record());
static SEQUENCES: LazyLock<Record> = LazyLock::new(|| searched_sequences(sequences().1, false).new_record());
static CLICKED_SEQUENCES: LazyLock<Record> =
    LazyLock::new(|| searched_sequences(sequences().1, true).new_record());

/// Returns two small sequences, each time opened anew.
fn sequences() -> ([Opened; 2], [Opened; 2]) {
    let recordings = BALLS.sequences().unwrap().map(|sequence| {
        Shared::new(Recording::new(sequence, &crate::cancel::CancelFlag::default()).unwrap())
    });
    let opened = || {
        recordings.each_ref().map(|recording| {
            let size = recording.sequence.size();
            let frame = image::GrayImage::from_raw(
                size.width as u32,
                size.height as u32,
                recording.sequence.frame(0).to_vec(),
            );
            let picture = Picture::from_pixels("frame".into(), None, frame.unwrap().into()).unwrap();
            Opened { recording: Some(recording.clone()), ..Opened::new(picture) }
        })
    };
    (opened(), opened())
}

static BALLS: LazyLock<BallScene> = LazyLock::new(|| {
    let thrown = ThrownBalls {
        frame: Frame::new(320, 240),
        frames: 200,
        balls: 8,
        noise: 0.0,
        ..ThrownBalls::default()
    };
    BallScene::new(thrown).unwrap()
});

/// Returns a model with the result of a search of two sequences.
fn searched_sequences(opened: [Opened; 2], clicked: bool) -> Model {
    let mut model = Model::default();
    model.open(opened, None, false, None);
    let pairs = if clicked { BALLS.matches(200)[..2].to_vec() } else { Vec::new() };
    model.document.set_pairs(pairs.clone(), PairOrigin::Clicked);
    model.document.unclicked = !clicked;
    let (pictures, parameters) = (model.open.pictures().unwrap(), model.document.search_parameters());
    let recordings = model.compared_recordings().unwrap();
    let silhouettes = recordings.recordings.each_ref().map(|own| &own.silhouettes);
    let [left, right] = pictures.each_ref().map(|picture| &picture.gray);
    let prepared = PreparedPair::of_sequences(left, right, silhouettes, recordings.offset).unwrap();
    let found = estimate_prepared(&prepared, &pairs, &parameters, &Monitor::silent()).unwrap();
    begin(&mut model, 1, pairs, Some(recordings));
    model.open.computation.take(1, EstimateNews::Finished(Ok(Box::new(found))));
    model
}

/// Returns ten moments of each step that ran.
fn moments(record: &Record) -> Vec<Place> {
    let course = Course::of(record.plan, record);
    let ran = course.steps.into_iter().filter(|step| step.state == StepState::Ran);
    ran.flat_map(|step| {
        (0..=10).map(move |k| Place { step: step.step, seconds: step.seconds * f64::from(k) / 10.0 })
    })
    .collect()
}

#[test]
fn a_moment_depends_on_nothing_but_record_and_time() {
    for record in [&*CLICKED, &*UNCLICKED, &*SEQUENCES, &*CLICKED_SEQUENCES] {
        let places = moments(record);
        let forwards: Vec<Moment> = places.iter().map(|place| steps::draw(record, *place)).collect();
        for (place, before) in places.iter().zip(&forwards).rev() {
            assert_eq!(steps::draw(record, *place), *before);
            assert!(!before.figures.is_empty() && before.zoom >= 1.0, "{place:?}");
            let is_drawn = |opacity: f32| (0.0..=1.0).contains(&opacity);
            assert!(before.marks.iter().all(|mark| is_drawn(mark.opacity)), "{place:?}");
        }
    }
}

#[test]
fn every_search_has_its_own_steps() {
    use MethodStep::{
        Barcodes, Candidates, Epipoles, Features, Matches, Motion, Pencils, Refinement, RoundTrip, Validation,
    };
    let ran = |record: &Record| -> Vec<MethodStep> {
        let course = Course::of(record.plan, record);
        course.steps.into_iter().filter(|step| step.state == StepState::Ran).map(|step| step.step).collect()
    };
    let clicked = ran(&CLICKED);
    for step in [Pencils, Candidates, Epipoles, RoundTrip, Validation, Refinement] {
        assert!(clicked.contains(&step), "{step:?}");
    }
    assert_eq!(ran(&UNCLICKED), [Features, Matches, Epipoles, Validation, Refinement, Pencils]);
    for record in [&*SEQUENCES, &*CLICKED_SEQUENCES] {
        assert_eq!(ran(record), [Motion, Barcodes, Candidates, Epipoles, Validation, Refinement]);
    }
}

#[test]
fn barcodes_in_a_record_are_of_the_compared_silhouettes() {
    for record in [&*SEQUENCES, &*CLICKED_SEQUENCES] {
        let (sweep, recordings) = (record.sweep.as_ref().unwrap(), record.recordings.as_ref().unwrap());
        let silhouettes = recordings.overlapping().unwrap();
        assert!(sweep.swept.len() > 20 && sweep.swept.len() <= 90, "{}", sweep.swept.len());
        for own in sweep.swept.iter().chain([&sweep.held]) {
            for (k, line) in own.lines.iter().enumerate() {
                assert_eq!(own.compared.barcodes[k], silhouettes[k].barcode(line, 1.0));
            }
        }
        // The held pair lies on lines of the result.
        assert!(sweep.held.compared.correlation().unwrap() > 0.5);
        // The lines are of the kind that led to the result.
        let led = record.hypotheses[record.winner.unwrap()].origin.source;
        assert_eq!(record.is_by_clicks(), matches!(led, ProposedBy::LinePairs { .. }), "{led:?}");
    }
    assert!(!SEQUENCES.is_by_clicks());
}

#[test]
fn frames_run_while_silhouettes_and_barcodes_grow() {
    use MethodStep::{Barcodes, Motion};
    let at = |step, seconds| steps::draw(&SEQUENCES, Place { step, seconds });
    let last = SEQUENCES.recordings.as_ref().unwrap().recordings[0].sequence.len() - 1;
    let (begin, end) = (at(Motion, 0.0), at(Motion, 1.6));
    assert_eq!((begin.frames, begin.piled), (Some([0; 2]), Some([1; 2])));
    assert_eq!((end.frames, end.piled), (Some([last; 2]), Some([32; 2])));
    let grown = |seconds| at(Barcodes, seconds).grown.unwrap();
    let lines = SEQUENCES.sweep.as_ref().unwrap().swept.len();
    assert_eq!((grown(0.0).line, grown(0.0).frames, grown(0.0).swept), (None, 1, 0));
    assert_eq!((grown(0.71).line, grown(0.71).frames), (Some(0), last + 1));
    assert_eq!((grown(2.2).line, grown(2.2).swept), (None, lines));
}

#[test]
fn sequences_have_no_record_before_a_search_and_the_player_ends_the_replay_of_frames() {
    let opened = sequences();
    let mut model = Model::default();
    model.open(opened.0, None, false, None);
    model.follow_replay();
    assert!(!model.has_record());
    let mut model = searched_sequences(opened.1, false);
    model.follow_replay();
    model.apply_to_replay(ReplayCommand::Play(MethodStep::Motion));
    model.apply_to_replay(ReplayCommand::Seek(0.8));
    model.follow_replay();
    let shown = model.shown_frames().unwrap();
    assert!(shown[0] > 0 && Some(shown) == model.open.replay.moment().unwrap().frames);
    model.apply_to_player(PlayerCommand::ToggleSilhouettes);
    assert!(model.replayed().is_some());
    model.apply_to_player(PlayerCommand::Step(1));
    assert_eq!((model.replayed(), model.shown_frames()), (None, Some(shown.map(|frame| frame + 1))));
}

#[test]
fn without_clicks_features_come_before_their_matches_and_lines_test_the_result() {
    let at = |step, seconds| steps::draw(&UNCLICKED, Place { step, seconds });
    let drawn = |step, seconds| {
        let marks = at(step, seconds).marks;
        let strokes = |mark: &&Mark| matches!(mark.shape, Shape::Stroke { has_stroke: true, .. });
        (marks.len(), marks.iter().filter(strokes).count())
    };
    let all = UNCLICKED.matches.len();
    assert!(drawn(MethodStep::Features, 0.5).0 < all);
    assert_eq!(drawn(MethodStep::Features, 2.2), (all, 0));
    assert_eq!(drawn(MethodStep::Matches, 0.0), (all, 0));
    let (dots, strokes) = drawn(MethodStep::Matches, 0.7);
    assert!(dots == all && strokes > 0 && strokes < all);
    assert_eq!(drawn(MethodStep::Matches, 2.2), (all, all));
    let opacities = |agrees: bool| {
        let of = |mark: &Mark| match mark.target {
            Some(Target::Replayed(Replayed::Match(k))) if UNCLICKED.matches[k].agrees == agrees => {
                mark.opacity
            }
            _ => f32::NAN,
        };
        at(MethodStep::Matches, 2.2).marks.iter().map(of).fold(f32::NAN, f32::max)
    };
    assert!(opacities(true) > 0.8 && opacities(false) < 0.3);
    // Lines through a match test the result where its own lines pass.
    let held = at(MethodStep::Pencils, 1.0);
    let off = held.figures.iter().find(|figure| figure.name == "off the result's lines").unwrap();
    let degrees: Vec<f64> =
        off.value.split(" and ").map(|own| own.trim_end_matches('°').parse().unwrap()).collect();
    assert!(degrees.len() == 2 && degrees.iter().all(|own| *own < 20.0), "{}", off.value);
}

#[test]
fn a_click_on_a_part_shows_the_hypothesis_that_was_kept() {
    let (mut model, _) = searched(true);
    model.follow_replay();
    let kept = |model: &Model, number: usize| *model.result().unwrap().hypotheses()[number].fundamental();
    model.apply_to_replay(ReplayCommand::Play(MethodStep::Validation));
    assert!(model.replay_on(0.05));
    model.follow_replay();
    let before = model.replayed();
    let racer = model.record().unwrap().race[0].hypothesis.fundamental;
    model.apply_to_replay(ReplayCommand::Show(Target::Replayed(Replayed::Racer(0))));
    let number = model.open.focus.hypothesis().unwrap();
    assert_eq!((kept(&model, number), model.open.replay.is_playing()), (racer, false));
    assert!(model.replayed() == before && model.drawn_moment().is_none());
    // The replay goes on where it was.
    model.apply_to_replay(ReplayCommand::TogglePlay);
    assert!(model.open.replay.is_playing() && model.drawn_moment().is_some() && model.replayed() == before);
    assert_eq!(model.open.focus.hypothesis(), None);
    // Candidates belong to the hypotheses that they proposed.
    let record = model.record().unwrap();
    let moment = model.drawn_moment().unwrap();
    let origin = |k: usize| record.kept[k].1;
    let ranks = (0..record.kept.len()).find_map(|k| match origin(k) {
        Some(ProposedBy::LinePairs { ranks }) => Some(ranks),
        _ => None,
    });
    let cell = |record: &Record, pair: usize, rank: usize| {
        let compared = &record.pencils[pair].compared;
        let [row, column] = compared.cell(&compared.candidates[rank - 1]).unwrap();
        Target::Cell { pair, row, column }
    };
    for (pair, rank) in ranks.unwrap().into_iter().enumerate() {
        let found = hypothesis_of(record, moment, cell(record, pair, rank)).unwrap();
        assert!(matches!(origin(found), Some(ProposedBy::LinePairs { ranks }) if ranks[pair] == rank));
    }
    // Without clicks, a rank does not tell the match that the lines pass through.
    let moment = steps::draw(&UNCLICKED, Place { step: MethodStep::Pencils, seconds: 1.0 });
    assert_eq!(hypothesis_of(&UNCLICKED, &moment, cell(&UNCLICKED, 0, 1)), None);
    // A part of a dropped hypothesis stays lit.
    let target = (0..model.record().unwrap().hypotheses.len())
        .map(|k| Target::Replayed(Replayed::Hypothesis(k)))
        .find(|target| {
            let record = model.record().unwrap();
            hypothesis_of(record, model.drawn_moment().unwrap(), *target).is_none()
        });
    model.apply_to_replay(ReplayCommand::Show(target.unwrap()));
    model.follow_replay();
    assert_eq!((model.open.focus.hypothesis(), model.open.focus.hovered()), (None, target));
    assert!(!model.open.replay.is_playing() && model.drawn_moment().is_some());
    model.choose_hypothesis(None);
    model.follow_replay();
    assert_eq!((model.replayed(), model.open.focus.hovered()), (None, None));
}

#[test]
fn lines_of_a_round_trip_and_of_the_leader_belong_to_their_hypotheses() {
    let at = |step, seconds| steps::draw(&CLICKED, Place { step, seconds }).kept;
    let trip = CLICKED.trips.first().unwrap().kept.unwrap();
    assert_eq!((at(MethodStep::RoundTrip, 0.9), at(MethodStep::RoundTrip, 1.6)), (Some(trip), None));
    let f = CLICKED.kept[at(MethodStep::Validation, 1.0).unwrap()].0;
    assert!(CLICKED.race.iter().any(|own| own.hypothesis.fundamental == f));
    assert_eq!(at(MethodStep::Refinement, 1.0), None, "they are lines of the result");
}

#[test]
fn player_and_replay_have_one_place() {
    let mut model = searched_sequences(sequences().1, false);
    model.follow_replay();
    assert!(model.shows_player());
    let frame = model.shown_frames().unwrap()[0];
    model.apply_to_replay(ReplayCommand::Nudge { forward: true });
    assert_eq!((model.shown_frames().unwrap()[0], model.replayed()), (frame + 1, None));
    model.apply_to_player(PlayerCommand::TogglePlay);
    model.apply_to_player(PlayerCommand::Exchange);
    assert!(!model.shows_player() && !model.play_on(0.1));
    model.apply_to_replay(ReplayCommand::Nudge { forward: false });
    assert!(model.replayed().is_some());
    model.apply_to_player(PlayerCommand::Exchange);
    assert!(model.shows_player() && model.replayed().is_none());
    model.apply_to_replay(ReplayCommand::Play(MethodStep::Motion));
    assert!(!model.shows_player());
    model.apply_to_player(PlayerCommand::TogglePlay);
    assert!(model.shows_player() && model.replayed().is_none() && model.play_on(0.1));
}

#[test]
fn marks_of_a_moment_can_be_pointed_at() {
    let has = |record: &Record, step: MethodStep, is_one: fn(&Target) -> bool| {
        let end = Course::of(record.plan, record).end_of(step).unwrap();
        steps::draw(record, end).marks.iter().filter_map(|mark| mark.target).any(|target| is_one(&target))
    };
    let is_cell: fn(&Target) -> bool = |target| matches!(target, Target::Cell { .. });
    let is_line: fn(&Target) -> bool = |target| matches!(target, Target::Replayed(Replayed::Line(_)));
    let is_dot: fn(&Target) -> bool = |target| matches!(target, Target::Replayed(Replayed::Hypothesis(_)));
    assert!(has(&CLICKED, MethodStep::Pencils, is_cell) && has(&CLICKED, MethodStep::Candidates, is_cell));
    for record in [&*CLICKED, &*SEQUENCES] {
        assert!(has(record, MethodStep::Epipoles, is_dot));
        assert!(has(record, MethodStep::Validation, is_line) && has(record, MethodStep::Refinement, is_line));
    }
    for part in [Replayed::Hypothesis(0), Replayed::Racer(0), Replayed::Swept(0), Replayed::Candidate(0)] {
        assert!(!parts_of(&SEQUENCES, part).is_empty(), "{part:?}");
    }
    assert!(parts_of(&CLICKED, Replayed::Candidate(0)).is_empty(), "pencils have cells");
}

#[test]
fn the_replay_ends_with_the_lines_of_the_result() {
    for record in [&*CLICKED, &*UNCLICKED, &*SEQUENCES, &*CLICKED_SEQUENCES] {
        let result = record.result.unwrap();
        let end = Course::of(record.plan, record).end_of(MethodStep::Refinement).unwrap();
        let moment = steps::draw(record, end);
        let drawn: Vec<_> = moment
            .marks
            .iter()
            .filter_map(|mark| match &mark.shape {
                Shape::Lines { lines, .. } if mark.ink == Ink::Verdict => Some(lines),
                _ => None,
            })
            .collect();
        assert_eq!(drawn.len(), record.fan.len());
        for (lines, place) in drawn.into_iter().zip(&record.fan) {
            let own = fan::lines(&result, *place);
            for (line, own) in lines.iter().zip(own) {
                assert!(line.as_ref().unwrap().angle_to(&own.unwrap()) < 1e-9);
            }
        }
    }
}

#[test]
fn a_sweep_compares_every_line_once_and_holds_the_winner() {
    let record = &*CLICKED;
    let at = |seconds: f64| steps::draw(record, Place { step: MethodStep::Pencils, seconds }).filled.unwrap();
    let rows = |k: usize| record.pencils[k].compared.angles1.len();
    assert_eq!((at(0.0).pencil, at(0.0).rows), (0, 1));
    assert_eq!((at(1.2).pencil, at(1.2).rows), (0, rows(0)));
    assert_eq!((at(2.2).pencil, at(2.2).rows), (1, rows(1)));
    let held = steps::draw(record, Place { step: MethodStep::Pencils, seconds: 1.35 });
    let own = &record.pencils[0];
    let candidate = own.compared.candidates[own.winner.unwrap()];
    assert_eq!(held.lines, Some(LineSource::Pencil { pair: 0, angles: candidate.angles }));
    assert!(held.slide > 0.0);
}

#[test]
fn a_growing_record_has_the_steps_that_have_happened() {
    let (mut model, events) = searched(false);
    let whole = model.new_record();
    model.open.computation.restart();
    begin(&mut model, 2, Vec::new(), None);
    let mut known = 0;
    for event in events {
        model.open.computation.take(2, EstimateNews::Happened(event));
        let record = model.new_record();
        let has = MethodStep::ALL
            .into_iter()
            .filter(|step| !matches!(step, MethodStep::Pencils | MethodStep::Candidates) && record.has(*step))
            .count();
        assert!(has >= known, "a step does not go again");
        known = has;
    }
    assert!(known >= 3);
    let grown = model.new_record();
    assert_eq!((grown.hypotheses.len(), grown.tentative), (whole.hypotheses.len(), whole.tentative));
}

#[test]
fn the_record_belongs_to_the_points_it_was_made_from() {
    let (mut model, _) = searched(true);
    model.follow_replay();
    assert!(model.has_record());
    model.apply_to_replay(ReplayCommand::Play(MethodStep::Epipoles));
    model.follow_replay();
    assert!(model.open.replay.is_playing() && model.open.replay.moment().is_some());
    assert!(model.replay_on(0.1));
    model.edit(|document| document.pairs[0] = PointPair::new(300.0, 300.0, 310.0, 300.0));
    model.follow_replay();
    assert_eq!(model.replayed(), None);
    assert!(model.open.replay.moment().is_none() && !model.replay_on(0.1));
    // Other pictures have no record yet.
    let sample = sample_pair(Sample::Courtyard);
    model.open(sample.pictures, None, false, None);
    model.follow_replay();
    assert!(!model.has_record());
    assert!(model.document.frame(Side::Left).is_some());
}

#[test]
fn undo_ends_the_replay_and_a_failed_search_has_no_record() {
    let (mut model, _) = searched(true);
    model.edit(|document| document.pairs[0].point1.x += 1.0);
    model.follow_replay();
    model.apply_to_replay(ReplayCommand::Play(MethodStep::Pencils));
    assert!(model.replayed().is_some());
    model.travel(true);
    assert_eq!(model.replayed(), None);
    // The latest result remains known, but it is not of these points.
    let failed = EstimateFailure::Estimate(EstimateError::NoGeometry);
    model.open.computation.take(1, EstimateNews::Finished(Err(failed)));
    assert!(model.open.computation.searched().is_some());
    model.follow_replay();
    assert!(!model.has_record());
}

#[test]
fn a_search_of_several_passes_tells_the_story_of_the_selected_one() {
    use MethodStep::{Epipoles, Refinement, Validation};
    let geometry = |y: f64| {
        let e = nalgebra::Vector3::new(1000.0, y, 1.0);
        FundamentalMatrix::from_rank_two(e.cross_matrix()).unwrap()
    };
    let note = |y: f64, source: ProposedBy| HypothesisNote {
        fundamental: geometry(y),
        origin: source.into(),
        support: Some(y),
    };
    let [first, second] =
        [note(1.0, ProposedBy::LinePairs { ranks: [6, 8] }), note(2.0, ProposedBy::Features)];
    let pass = |own: HypothesisNote| {
        let ranked = RankedHypothesis { hypothesis: own, course: vec![1.0, 2.0] };
        let step = |y: f64| RefinementStep { fundamental: geometry(y), matches: 50 };
        let steps = vec![
            step(own.support.unwrap() + 0.5),
            RefinementStep { fundamental: own.fundamental, matches: 60 },
        ];
        [
            EventKind::Proposed { examined: 10, hypotheses: vec![own] },
            EventKind::Ranked(vec![ranked]),
            EventKind::Refined { selected: own, matches: 60, steps },
        ]
    };
    let kinds = pass(first).into_iter().chain(pass(second)).chain([EventKind::Selected(first)]);
    let events: Vec<Event> = kinds.map(|kind| Event { seconds: 0.0, kind }).collect();
    let record = |events: &[Event]| {
        Record::new(&Source {
            plan: CLICKED.plan,
            frames: CLICKED.frames,
            recordings: None,
            events,
            found: None,
            pencils: &[],
            pair: &|_, _| None,
        })
    };
    let of = |record: &Record| (record.winner, record.race[0].hypothesis, *record.swing.last().unwrap());
    let newest = |count: usize| record(&events[..count]).newest.unwrap();
    assert_eq!(
        [1, 2, 3, 4].map(newest),
        [Epipoles, Validation, Refinement, Epipoles],
        "in the order of events"
    );
    // While the search runs, its latest pass is shown.
    assert_eq!(of(&record(&events[..6])), (Some(1), second, second.fundamental));
    assert_eq!(of(&record(&events)), (Some(0), first, first.fundamental));
}

#[test]
fn still_steps_do_not_move() {
    let (mut model, _) = searched(true);
    model.look.still_steps = true;
    model.follow_replay();
    model.apply_to_replay(ReplayCommand::TogglePlay);
    let place = model.replayed().unwrap();
    assert_eq!(Some(place), model.course().end_of(place.step));
    assert!(!model.replay_on(0.1));
    while model.replayed().is_some() {
        model.apply_to_replay(ReplayCommand::Step { forward: true });
    }
    model.apply_to_replay(ReplayCommand::Seek(3.0));
    assert!((model.course().at(model.replayed().unwrap()) - 3.0).abs() < 1e-9);
    model.apply_to_replay(ReplayCommand::Finish);
    assert_eq!(model.replayed(), None);
}
