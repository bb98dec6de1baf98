//! The replay of a search: played, paused, dragged along its time, and left.

use crate::support::*;

use std::time::Instant;

use egui::{Color32, Key, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use epiline::internals::app::Start;
use epiline::internals::app::model::document::Side;
use epiline::internals::app::model::look::Look;

/// Returns a window with a result, in which steps move.
fn moving() -> Window {
    let mut window = window(Start::default(), rich_services());
    click_two_pairs(&mut window);
    let look = window.state().look().clone();
    window.state_mut().set_look(Look { still_steps: false, ..look });
    window
}

/// Draws so many frames, whether or not something still moves.
fn frames(window: &mut Window, count: usize) {
    for _ in 0..count {
        window.step();
    }
}

fn is_playing(window: &Window) -> bool {
    window.state().model().open.replay.is_playing()
}

/// Returns the time of the replay on its axis, s.
fn time(window: &Window) -> Option<f64> {
    let model = window.state().model();
    Some(model.course().at(model.replayed()?))
}

#[test]
fn show_me_ends_in_a_replay_and_the_space_bar_pauses_it() {
    let mut window = window(Start::default(), rich_services());
    window.state_mut().set_look(Look::default());
    window.get_by_label("Show me how the lines are found").click();
    let begun = Instant::now();
    while !is_playing(&window) {
        assert!(begun.elapsed().as_secs() < 60, "no replay");
        window.step();
    }
    frames(&mut window, 4);
    let before = time(&window).unwrap();
    frames(&mut window, 4);
    let after = time(&window).unwrap();
    // Four frames of 0.05 s at half speed.
    assert!((after - before - 0.1).abs() < 1e-6, "{before} {after}");
    window.get_by_label("Pause the replay");
    window.key_press(Key::Space);
    frames(&mut window, 2);
    assert!(!is_playing(&window));
    let paused = time(&window);
    settle(&mut window);
    assert_eq!(time(&window), paused, "nothing moves by itself");
    window.key_press(Key::Space);
    frames(&mut window, 2);
    assert!(is_playing(&window));
    press(&mut window, Key::End);
    assert_eq!(time(&window), None);
    window.get_by_label("Play how the lines were found");
}

#[test]
fn the_replay_has_one_tab_and_keys_of_the_others_leave_it() {
    let mut window = moving();
    press(&mut window, Key::Home);
    for _ in 0..3 {
        press(&mut window, Key::Period);
    }
    assert!(time(&window).unwrap() > 0.0);
    let moment = window.state().model().drawn_moment().unwrap();
    assert!(moment.filled.is_some() && moment.slide >= 1.0, "a line of the sweep shows its warp");
    assert!(window.query_by_label("Residuals").is_none());
    press(&mut window, Key::Num3);
    assert_eq!(time(&window), None);
    window.get_by_label("Residuals");
}

#[test]
fn the_time_can_be_dragged_and_the_drawing_is_the_same_both_ways() {
    let mut window = moving();
    let bar = window.get_by_label("Time of the replay").rect();
    let place = |share: f32| bar.left_center() + vec2(bar.width() * share, 0.0);
    let drawn =
        |window: &Window| Side::BOTH.map(|side| lines(window, side, Color32::from_rgb(127, 239, 252)));
    let mut seen = Vec::new();
    window.hover_at(place(0.02));
    button(&window, place(0.02), PointerButton::Primary, true);
    let shares: Vec<f32> = (1..=5).map(|k| 0.04 * k as f32).collect();
    for share in shares.iter().chain(shares.iter().rev()) {
        window.hover_at(place(*share));
        frames(&mut window, 3);
        seen.push((time(&window).unwrap(), drawn(&window)));
    }
    button(&window, place(0.04), PointerButton::Primary, false);
    settle(&mut window);
    let (forwards, mut backwards) = (seen[..5].to_vec(), seen[5..].to_vec());
    backwards.reverse();
    assert!(forwards.is_sorted_by(|a, b| a.0 < b.0));
    assert_eq!(forwards, backwards);
    assert!(forwards.iter().any(|(_, [left, right])| !left.is_empty() && !right.is_empty()));
    assert!(!is_playing(&window));
    tap(&mut window, "Result");
    assert_eq!(time(&window), None);
}

#[test]
fn a_click_in_a_picture_ends_the_replay() {
    let mut window = moving();
    window.get_by_label("Step Candidates").click();
    frames(&mut window, 3);
    assert!(is_playing(&window));
    let start = time(&window).unwrap();
    // Between the lines of the candidates, a click places a point.
    let place = at(&window, Side::Left, 0.33, -0.25);
    click(&mut window, place);
    assert_eq!(window.state().document().pairs.len(), 2);
    assert!(window.state().document().half.is_some());
    // A first click changes no result, so the step stays; the second one gives another result.
    let place = at(&window, Side::Right, 0.28, -0.25);
    click(&mut window, place);
    assert_eq!(time(&window), None, "after {start}");
}

#[test]
fn a_click_on_a_line_shows_its_hypothesis_and_places_no_point() {
    let mut window = moving();
    window.get_by_label("Step Round trip").click();
    // The line of a hypothesis has gone across.
    frames(&mut window, 17);
    assert!(is_playing(&window));
    let [start, end] = lines(&window, Side::Left, Color32::from_rgb(143, 180, 255))[0];
    let (before, place) = (time(&window).unwrap(), start + (end - start) * 0.3);
    window.hover_at(place);
    for pressed in [true, false] {
        button(&window, place, PointerButton::Primary, pressed);
    }
    settle(&mut window);
    let chosen = window.state().focus().hypothesis().unwrap();
    window.get_by_label(&format!("Hypothesis {}", chosen + 1));
    assert!(!is_playing(&window) && time(&window).unwrap() - before < 0.5);
    assert!(window.state().document().half.is_none() && window.state().document().pairs.len() == 2);
    let f = *window.state().estimate().unwrap().hypotheses()[chosen].fundamental();
    assert!(shows_lines(&window, &f, OTHER));
    // The replay goes on, or ends with the result.
    window.key_press(Key::Space);
    frames(&mut window, 2);
    assert!(is_playing(&window) && window.state().focus().hypothesis().is_none());
    press(&mut window, Key::End);
    assert_eq!(time(&window), None);
}

#[test]
fn a_click_on_a_row_of_a_dropped_candidate_keeps_it_lit() {
    let mut window = moving();
    window.get_by_label("Step Candidates").click();
    frames(&mut window, 3);
    assert!(is_playing(&window));
    window.get_by_label("Candidate 5 through p").click();
    settle(&mut window);
    let lit = window.state().focus().hovered();
    assert!(!is_playing(&window) && lit.is_some() && window.state().focus().hypothesis().is_none());
    window.hover_at(at(&window, Side::Left, -0.45, -0.45) - vec2(0.0, 60.0));
    settle(&mut window);
    assert_eq!(window.state().focus().hovered(), lit);
    press(&mut window, Key::End);
    assert_eq!(window.state().focus().hovered(), None);
}

#[test]
fn a_step_that_is_clicked_pauses_at_its_end() {
    let mut window = moving();
    window.get_by_label("Step Candidates").click();
    frames(&mut window, 60);
    let model = window.state().model();
    let place = model.replayed().unwrap();
    assert_eq!((place.step.title(), is_playing(&window)), ("Candidates", false));
    assert_eq!(Some(place), model.course().end_of(place.step));
    // The first tab has the name of the step, and the result its own table.
    assert_eq!(window.query_all_by_label("Candidates").count(), 2, "the tab and the title of the words");
    press(&mut window, Key::End);
    window.get_by_label("Hypotheses");
}

#[test]
fn the_dock_stays_where_it_is_from_step_to_step() {
    let mut window = moving();
    let area = |window: &Window| Side::BOTH.map(|side| pane(window, side));
    let before = area(&window);
    for step in ["Pencils", "Candidates", "Features", "Epipoles", "Round trip", "Validation", "Refinement"] {
        window.get_by_label(&format!("Step {step}")).click();
        frames(&mut window, 3);
        assert_eq!(area(&window), before, "{step}");
    }
    press(&mut window, Key::End);
    assert_eq!(area(&window), before);
}
