//! Pinned line pairs: their numbers in the images, their menus.

use crate::support::*;

use egui::{Key, Modifiers, PointerButton, Rect};
use egui_kittest::kittest::Queryable;
use epiline::internals::app::model::document::{LineSource, Side};

/// A result with so many pinned line pairs, a few points of the screen from each other, and the place of the last one.
fn with_pins(count: usize) -> (Window, egui::Pos2) {
    let mut window = sample();
    click_two_pairs(&mut window);
    press(&mut window, Key::I);
    let mut last = egui::Pos2::ZERO;
    for k in 0..count {
        last = at(&window, Side::Left, 0.1, -0.4 + 0.012 * k as f32);
        click(&mut window, last);
    }
    press(&mut window, Key::I);
    assert_eq!(window.state().document().pins.len(), count);
    (window, last)
}

/// The numbers that stand on an image.
fn numbers(window: &Window, side: Side) -> Vec<(usize, Rect)> {
    let pane = pane(window, side);
    let shapes = window.output().shapes.iter();
    let in_pane = shapes.filter(|clipped| pane.expand(1.0).contains_rect(clipped.clip_rect));
    let numbers = in_pane.filter_map(|clipped| match &clipped.shape {
        egui::Shape::Text(text) => Some((
            text.galley.text().strip_prefix("pin ")?.parse().ok()?,
            text.galley.rect.translate(text.pos.to_vec2()),
        )),
        _ => None,
    });
    numbers.collect()
}

#[test]
fn numbers_of_many_pins_leave_the_images_free_and_cover_no_other() {
    let (mut window, _) = with_pins(39);
    window.hover_at(egui::pos2(4.0, 844.0));
    settle(&mut window);
    for side in Side::BOTH {
        let pane = pane(&window, side);
        let numbers = numbers(&window, side);
        assert!(numbers.len() >= 15, "{numbers:?}");
        assert!(numbers.iter().any(|(number, _)| *number == 39), "that of the pair that is looked at");
        for (k, (number, area)) in numbers.iter().enumerate() {
            assert!(pane.contains_rect(*area) && area.max.x < pane.center().x, "{number}: {area:?}");
            assert!(numbers[..k].iter().all(|(_, other)| !other.intersects(*area)), "{number} on another");
        }
    }
}

#[test]
fn a_right_click_on_a_pinned_line_tells_which_it_is_and_unpins_it() {
    let (mut window, place) = with_pins(3);
    let right_click = |window: &mut Window, place| {
        window.hover_at(place);
        button(window, place, PointerButton::Secondary, true);
        button(window, place, PointerButton::Secondary, false);
        settle(window);
    };
    let nowhere = at(&window, Side::Left, 0.1, 0.4);
    right_click(&mut window, nowhere);
    assert_eq!(window.query_all_by_label_contains("Line pair ").count(), 0, "no line, no menu of a line");
    tap(&mut window, "Copy coordinates");
    right_click(&mut window, place);
    window.get_by_label("Line pair 3");
    tap(&mut window, "Show its profiles");
    window.get_by_label("Grey before warping");
    let first = at(&window, Side::Left, 0.1, -0.4);
    right_click(&mut window, first);
    window.get_by_label("Line pair 1");
    window.get_all_by_label("Unpin").last().unwrap().click();
    settle(&mut window);
    let left: Vec<_> = window.state().document().pins.iter().map(|pin| pin.number).collect();
    assert_eq!(left, [1, 2]);
    assert_eq!(window.query_all_by_label_contains("Line pair 1").count(), 0, "the menu has closed");
}

#[test]
fn pins_are_undone_without_the_points_and_go_with_their_pair() {
    let (mut window, _) = with_pins(2);
    let pairs = window.state().document().pairs.clone();
    let pinned = |window: &Window| window.state().document().pins.len();
    undo(&mut window);
    assert_eq!((pinned(&window), &window.state().document().pairs), (1, &pairs));
    press_with(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!(pinned(&window), 2);
    run_command(&mut window, "Unpin all lines");
    assert_eq!(pinned(&window), 0);
    undo(&mut window);
    assert_eq!(pinned(&window), 2);
    // Inspecting a pin again is no step.
    let line = at(&window, Side::Left, 0.1, -0.4);
    window.get_by_label("Row of pair q").click_secondary();
    settle(&mut window);
    tap(&mut window, "Pin lines");
    assert_eq!(pinned(&window), 3);
    press(&mut window, Key::I);
    click(&mut window, line);
    press(&mut window, Key::I);
    assert_eq!((pinned(&window), window.state().document().inspected), (3, Some(0)), "it is pinned already");
    tap(&mut window, "Row of pair p");
    press(&mut window, Key::Delete);
    let sources: Vec<_> = window.state().document().pins.iter().map(|pin| pin.source).collect();
    assert_eq!(sources[2], LineSource::Pair(0), "q is the first pair now");
    tap(&mut window, "Row of pair p");
    press(&mut window, Key::Delete);
    assert_eq!(pinned(&window), 2, "without a pair it has no lines");
}

#[test]
fn the_menu_of_many_pins_opens_at_the_one_that_is_looked_at() {
    let (mut window, _) = with_pins(39);
    press(&mut window, Key::Num2);
    tap(&mut window, "Line pair 39 of 39");
    let rows: Vec<Rect> = window.query_all_by_label_contains("Inspect: ").map(|row| row.rect()).collect();
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    assert!(last.max.y < 848.0 && last.min.y > 0.0, "{last:?}");
    assert!(first.max.y < 0.0, "so many do not fit: {first:?}");
}
