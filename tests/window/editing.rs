//! Clicking, dragging, keys, undo, and what is drawn.

use crate::support::*;

use egui::{Color32, Key, Modifiers, PointerButton, Pos2, Rect, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::estimate::{Method, Trust, Verdict};
use epiline::geometry::{Point, Vector, symmetric_epipolar_distance};
use epiline::internals::app::Start;
use epiline::internals::app::model::document::Side;

#[test]
fn the_sample_opens_and_the_window_says_what_to_do() {
    let window = sample();
    assert!(window.state().document().pictures.is_some());
    window.get_by_label_contains("Every point of one picture lies on a line in the other.");
    window.get_by_label("Show me how the lines are found");
}

#[test]
fn two_clicked_pairs_give_the_geometry() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let inspector = window.state();
    assert_eq!(inspector.document().pairs.len(), 2);
    let estimate = inspector.estimate().expect("an estimate");
    for pair in &inspector.document().pairs {
        assert!(symmetric_epipolar_distance(estimate.fundamental(), pair) < 1e-6);
    }
    window.get_by_label_contains("Found from p and q");
}

#[test]
fn the_sentence_follows_the_clicks() {
    let mut window = sample();
    click_at(&mut window, Side::Left, 0.1, 0.1);
    window.get_by_label_contains("Pair p: now click the same scene point in the other image");
    click_at(&mut window, Side::Right, 0.1, 0.1);
    window.get_by_label_contains("One more pair: click q");
}

#[test]
fn show_me_places_two_pairs_and_undo_takes_them_back() {
    let mut window = sample();
    tap(&mut window, "Show me how the lines are found");
    assert_eq!(window.state().document().pairs.len(), 2);
    assert!(window.state().estimate().is_some());
    undo(&mut window);
    assert!(window.state().document().pairs.is_empty());
    assert!(window.state().estimate().is_none());
    press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(window.state().document().pairs.len(), 2);
    undo(&mut window);
    press_with(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!(window.state().document().pairs.len(), 2);
}

#[test]
fn a_drag_moves_by_the_whole_way_and_is_one_step() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let (before, estimate) = (point(&window, P_LEFT), *window.state().estimate().unwrap().fundamental());
    let from = screen(&window, P_LEFT);
    // Grabbed beside its centre, it must not jump.
    let grab = from + vec2(3.0, 2.0);
    drag(&mut window, grab, grab + vec2(40.25, -20.5), PointerButton::Primary);
    let moved = screen(&window, P_LEFT) - from;
    assert!((moved - vec2(40.25, -20.5)).length() < 0.02, "{moved:?}");
    assert_ne!(*window.state().estimate().unwrap().fundamental(), estimate);
    undo(&mut window);
    assert_eq!(point(&window, P_LEFT), before);
    assert_eq!(*window.state().estimate().unwrap().fundamental(), estimate);
}

#[test]
fn a_point_dragged_out_stays_on_its_image() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let from = screen(&window, P_LEFT);
    drag(&mut window, from, Pos2::new(-500.0, -500.0), PointerButton::Primary);
    assert_eq!(point(&window, P_LEFT), Point::new(-0.5, -0.5));
}

#[test]
fn escape_during_a_drag_puts_the_point_back() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let (before, from) = (point(&window, P_LEFT), screen(&window, P_LEFT));
    window.hover_at(from);
    button(&window, from, PointerButton::Primary, true);
    window.hover_at(from + vec2(20.0, 0.0));
    window.hover_at(from + vec2(40.0, 0.0));
    window.step();
    assert_ne!(point(&window, P_LEFT), before);
    window.key_press(Key::Escape);
    window.hover_at(from + vec2(50.0, 0.0));
    button(&window, from + vec2(50.0, 0.0), PointerButton::Primary, false);
    settle(&mut window);
    assert_eq!(point(&window, P_LEFT), before);
}

#[test]
fn arrow_keys_nudge_the_selected_point() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let handle = screen(&window, P_LEFT);
    click(&mut window, handle);
    let before = point(&window, P_LEFT);
    window.key_press(Key::ArrowRight);
    window.key_press(Key::ArrowRight);
    press_with(&mut window, Modifiers::SHIFT, Key::ArrowUp);
    let moved = point(&window, P_LEFT) - before;
    assert!((moved.x - 2.0).abs() < 1e-9 && (moved.y + 10.0).abs() < 1e-9, "{moved:?}");
    undo(&mut window);
    assert_eq!(point(&window, P_LEFT), before, "a run of nudges is one step");
}

/// A press held long enough counts as the beginning of a drag, though nothing has moved.
#[test]
fn escape_during_a_press_takes_no_earlier_edit_back() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let from = screen(&window, P_LEFT);
    click(&mut window, from);
    press(&mut window, Key::ArrowRight);
    let (nudged, from) = (point(&window, P_LEFT), screen(&window, P_LEFT));
    window.hover_at(from);
    button(&window, from, PointerButton::Primary, true);
    for _ in 0..200 {
        window.step();
    }
    press(&mut window, Key::Escape);
    assert_eq!(point(&window, P_LEFT), nudged);
}

#[test]
fn pairs_are_deleted_by_key_and_in_the_list() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let handle = screen(&window, P_LEFT);
    click(&mut window, handle);
    press(&mut window, Key::Delete);
    assert_eq!(window.state().document().pairs.len(), 1);
    assert!(window.state().estimate().is_none());
    unfold(&mut window, "p");
    tap(&mut window, "Delete: pair p");
    assert!(window.state().document().pairs.is_empty());
}

#[test]
fn escape_gives_up_the_first_click_of_a_pair() {
    let mut window = sample();
    click_at(&mut window, Side::Left, 0.1, 0.1);
    press(&mut window, Key::Escape);
    assert!(window.state().document().half.is_none());
}

/// A third pair on the sample, far from both others and off the geometry that they give.
fn click_a_third_pair(window: &mut Window) {
    for side in Side::BOTH {
        click_at(window, side, 0.3, -0.3);
    }
}

/// How many clicks the latest estimate was searched from.
fn clicks(window: &Window) -> usize {
    window
        .state()
        .estimate()
        .and_then(|estimate| estimate.trace.as_ref())
        .map_or(0, |trace| trace.clicks.len())
}

#[test]
fn every_pair_is_used_unless_it_is_to_check_only() {
    let mut window = sample();
    click_two_pairs(&mut window);
    click_a_third_pair(&mut window);
    assert_eq!(clicks(&window), 3);
    window.get_by_label_contains("Found from p, q and r");
    assert!(window.query_by_label("Three pairs").is_none() && window.query_by_label("Three-point").is_none());
    unfold(&mut window, "q");
    tap(&mut window, "Check only pair q");
    assert_eq!(clicks(&window), 2);
    window.get_by_label_contains("Found from p and r");
    tap(&mut window, "Use pair q");
    assert_eq!(clicks(&window), 3);
    for expected in [2, 3] {
        undo(&mut window);
        assert_eq!(clicks(&window), expected, "undo");
    }
}

#[test]
fn the_published_search_keeps_its_two_methods_beside_its_preset() {
    let mut window = sample();
    click_two_pairs(&mut window);
    click_a_third_pair(&mut window);
    show_parameters(&mut window, "Pencils");
    tap(&mut window, "As published");
    assert_eq!(clicks(&window), 2);
    unfold(&mut window, "r");
    assert!(window.get_by_label("Use pair r").accesskit_node().is_disabled());
    tap(&mut window, "Three-point");
    assert_eq!(window.state().document().parameters.method, Method::ThreePoint);
    assert_eq!(clicks(&window), 3);
    tap(&mut window, "Robust");
    tap(&mut window, "Delete: pair r");
    assert!(window.state().estimate().is_some(), "two pairs are enough again");
}

#[test]
fn leaving_out_one_of_two_pairs_leaves_the_geometry_to_the_images() {
    let mut window = sample();
    click_two_pairs(&mut window);
    unfold(&mut window, "q");
    for (role, is_unclicked) in [("Leave out", true), ("Use", false), ("Check only", true), ("Use", false)] {
        tap(&mut window, &format!("{role} pair q"));
        assert_eq!(window.state().document().is_unclicked(), is_unclicked, "{role}");
        assert!(window.state().document().used_pairs().is_some(), "{role}");
    }
}

#[test]
fn a_pair_that_the_images_speak_against_is_marked() {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        // Estimated as if the two pairs had been clicked elsewhere.
        let mut moved = request.pairs.clone();
        moved[0].point2.y += 25.0;
        moved[1].point2.x += 25.0;
        let mut estimate = fake_estimate(&moved, &request.parameters)?;
        let reasons = vec![click_off(2, 40.0)];
        estimate.assessment.trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
        Ok(estimate)
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    click_a_third_pair(&mut window);
    assert_eq!(window.query_all_by_label("off its line").count(), 1);
    // The distance of the table: the window has one.
    let off = |window: &Window, pair: usize| {
        let f = *window.state().estimate().unwrap().fundamental();
        symmetric_epipolar_distance(&f, &window.state().document().pairs[pair])
    };
    let distance = off(&window, 1);
    window.get_by_label_contains(&format!("Point pair q is {distance:.1} px (symmetric distance) off"));
    assert!(distance > 1.0);
    window.get_by_label(&format!("{distance:.2} px"));
    unfold(&mut window, "p");
    tap(&mut window, "Check only pair p");
    let distance = off(&window, 2);
    window.get_by_label_contains(&format!("Point pair r is {distance:.1} px (symmetric distance) off"));
}

#[test]
fn the_hover_line_is_drawn_in_the_other_image_both_ways() {
    let mut window = sample();
    click_two_pairs(&mut window);
    for side in Side::BOTH {
        let position = at(&window, side, 0.05, 0.05);
        window.hover_at(position);
        settle(&mut window);
        let other = pane(&window, side.other());
        // Yellow is the colour of the cursor's line and of nothing else.
        let yellow = egui::Color32::from_rgb(244, 239, 110);
        let drawn = window.output().shapes.iter().any(|clipped| match &clipped.shape {
            egui::Shape::LineSegment { points, stroke } => {
                stroke.color == yellow && points.iter().all(|p| other.contains(*p))
            }
            _ => false,
        });
        assert!(drawn, "hovering the {} image", side.name());
    }
}

#[test]
fn a_double_click_fits_and_leaves_no_point() {
    let mut window = sample();
    let position = at(&window, Side::Left, 0.1, 0.1);
    window.hover_at(position);
    for pressed in [true, false, true, false] {
        button(&window, position, PointerButton::Primary, pressed);
    }
    settle(&mut window);
    assert!(window.state().document().half.is_none());
    undo(&mut window);
    assert!(window.state().document().half.is_none());
}

#[test]
fn scrolling_zooms_about_the_cursor_and_dragging_moves_the_image() {
    let mut window = sample();
    let position = at(&window, Side::Left, 0.1, 0.1);
    let scroll = |window: &mut Window| scroll_by(window, position, 200.0);
    // A point placed at the cursor before and after the zoom is the same point of the image.
    click(&mut window, position);
    let before = window.state().document().half.unwrap().point;
    window.key_press(Key::Escape);
    scroll(&mut window);
    click(&mut window, position);
    let after = window.state().document().half.unwrap().point;
    assert!((after - before).norm() < 1e-2, "{before} {after}");
    window.key_press(Key::Escape);
    let empty = position + vec2(-60.0, 0.0);
    for with in [PointerButton::Middle, PointerButton::Primary] {
        drag(&mut window, empty, empty + vec2(30.0, 0.0), with);
    }
    assert!(window.state().document().half.is_none(), "a drag is no click");
    click(&mut window, position);
    let panned = window.state().document().half.unwrap().point;
    assert!(panned.x < before.x - 5.0);
}

#[test]
fn typing_does_not_run_commands() {
    let mut window = sample();
    click_two_pairs(&mut window);
    tap(&mut window, "Open");
    window.key_press(Key::Delete);
    press(&mut window, Key::S);
    assert_eq!(window.state().document().pairs.len(), 2);
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Open these").is_none());
}

#[test]
fn overlays_keys_and_themes_can_be_switched() {
    let mut window = sample();
    click_two_pairs(&mut window);
    press(&mut window, Key::Questionmark);
    window.get_by_label_contains(concat!("Keys and mouse, Epiline ", env!("CARGO_PKG_VERSION")));
    press(&mut window, Key::Escape);
    assert!(window.query_by_label_contains("Keys and mouse, ").is_none());
    let dark = window.ctx.theme();
    press(&mut window, Key::T);
    assert_ne!(window.ctx.theme(), dark);
    choose(&mut window, "Overlays", "Link views");
    assert!(window.state().look().linked);
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Link views").is_none(), "Escape closes the menu");
}

#[test]
fn overlays_of_a_tab_are_marked_only_while_there_are_tabs() {
    let mut window = sample();
    tap(&mut window, "Overlays");
    window.get_by_label("Show Matched samples");
    assert!(!painted(&window, "shown by the open tab"));
    press(&mut window, Key::Escape);
    click_two_pairs(&mut window);
    tap(&mut window, "Overlays");
    assert!(painted(&window, "shown by the open tab"));
}

#[test]
fn a_small_window_and_a_large_one_hold_everything() {
    for size in [vec2(860.0, 540.0), vec2(1920.0, 1080.0)] {
        let mut window = sample();
        window.set_size(size);
        settle(&mut window);
        click_two_pairs(&mut window);
        assert!(window.state().estimate().is_some(), "{size:?}");
        let whole = Rect::from_min_size(Pos2::ZERO, size);
        for side in Side::BOTH {
            assert!(whole.contains_rect(pane(&window, side)), "{size:?}");
        }
    }
}

#[test]
fn the_first_sample_shows_what_epipolar_lines_are_and_knows_its_cameras() {
    let mut window = started(Start::default(), services());
    assert!(painted(&window, "the other camera"), "before the mouse moves, too");
    window.hover_at(at(&window, Side::Left, 0.2, 0.2));
    settle(&mut window);
    let f = *window.state().model().lesson().unwrap();
    let place = image_position(&window, Side::Left, at(&window, Side::Left, 0.2, 0.2));
    let line = f.line2_from_point1(place).unwrap();
    let drawn = lines(&window, Side::Right, Color32::from_rgb(244, 239, 110));
    let ends = drawn.iter().flatten();
    assert!(
        !drawn.is_empty()
            && ends.into_iter().all(|end| line.distance(image_position(&window, Side::Right, *end)) < 0.5)
    );
    click_two_pairs(&mut window);
    assert!(!painted(&window, "the other camera") && window.state().model().lesson().is_none());
    assert!(window.state().model().open.posed_views().is_some(), "its scene needs no question");
}

#[test]
fn the_keyboard_places_points() {
    let mut window = sample();
    let frame = window.state().document().frame(Side::Left).unwrap();
    press(&mut window, Key::Enter);
    press(&mut window, Key::Tab);
    assert!(
        window.state().document().half.is_none(),
        "without the crosshair they do nothing to the pictures"
    );
    press(&mut window, Key::P);
    for _ in 0..3 {
        press(&mut window, Key::ArrowRight);
    }
    press_with(&mut window, Modifiers::SHIFT, Key::ArrowUp);
    press_with(&mut window, Modifiers::ALT, Key::ArrowLeft);
    press(&mut window, Key::Enter);
    let half = window.state().document().half.unwrap();
    let from = frame.centre() + Vector::new(2.9, -10.0);
    assert!(half.side == Side::Left && (half.point - from).norm() < 1e-9, "{half:?}");
    // The second point is in the other picture. A moved crosshair is not overruled by the suggestion.
    press(&mut window, Key::ArrowDown);
    press(&mut window, Key::Enter);
    let pair = window.state().document().pairs[0];
    assert!((pair.point1 - from).norm() < 1e-9 && (pair.point2 - from - Vector::new(0.0, 1.0)).norm() < 1e-9);
    press(&mut window, Key::Tab);
    assert_eq!(window.state().model().open.crosshair.unwrap().side, Side::Right);
    for _ in 0..200 {
        press_with(&mut window, Modifiers::SHIFT, Key::ArrowRight);
    }
    assert!(
        window.state().model().open.crosshair.unwrap().point.x <= frame.right(),
        "it stays in the picture"
    );
    press(&mut window, Key::Escape);
    assert!(window.state().model().open.crosshair.is_none() && window.state().document().pairs.len() == 1);
}
