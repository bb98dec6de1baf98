//! The measure tool, and the menu of a place in an image.

use crate::support::*;

use egui::{Key, OutputCommand, Pos2, Shape};
use egui_kittest::kittest::Queryable;
use epiline::internals::app::model::document::Side;
use epiline::internals::app::model::focus::LineSource;

/// Returns the texts drawn over an image.
fn texts(window: &Window, side: Side) -> Vec<String> {
    let pane = pane(window, side);
    let shapes = window.output().shapes.iter();
    let in_pane = shapes.filter(|clipped| pane.expand(1.0).contains_rect(clipped.clip_rect));
    let texts = in_pane.filter_map(|clipped| match &clipped.shape {
        Shape::Text(text) => Some(text.galley.text().to_owned()),
        _ => None,
    });
    texts.collect()
}

/// Returns the measured distance that is written over an image.
fn distance(window: &Window, side: Side) -> Option<f64> {
    texts(window, side).iter().find_map(|text| text.split_once(" px, ")?.0.parse().ok())
}

#[test]
fn two_clicks_measure_a_distance_until_escape() {
    let mut window = sample();
    press(&mut window, Key::Num6);
    window.get_by_label("There is no rectified pair yet. Find the geometry first.");
    press(&mut window, Key::Escape);
    tap(&mut window, "Measure tool");
    let [from, to] = [-0.2, 0.2].map(|x| at(&window, Side::Left, x, 0.1));
    click(&mut window, from);
    assert!(window.state().document().half.is_none(), "no point is placed");
    window.hover_at(from.lerp(to, 0.5));
    window.step();
    window.step();
    let width = window.state().document().frame(Side::Left).unwrap().width as f64;
    let half = distance(&window, Side::Left).unwrap();
    assert!((half - 0.2 * width).abs() < 1.0, "{half} px up to the cursor");
    click(&mut window, to);
    let whole = distance(&window, Side::Left).unwrap();
    assert!((whole - 0.4 * width).abs() < 1.0, "{whole} px");
    assert!(texts(&window, Side::Left).iter().any(|text| text.starts_with("intensity ")));
    assert_eq!(distance(&window, Side::Right), None);
    // It stays while points are placed.
    press(&mut window, Key::D);
    assert!(distance(&window, Side::Left).is_some());
    press(&mut window, Key::Escape);
    assert_eq!(distance(&window, Side::Left), None);
}

#[test]
fn a_drag_measures_like_two_clicks_and_does_not_move_the_image() {
    let mut window = sample();
    press(&mut window, Key::D);
    let [from, to] = [-0.2, 0.2].map(|x| at(&window, Side::Left, x, 0.1));
    drag(&mut window, from, to, egui::PointerButton::Primary);
    let width = window.state().document().frame(Side::Left).unwrap().width as f64;
    let whole = distance(&window, Side::Left).unwrap();
    assert!((whole - 0.4 * width).abs() < 1.0, "{whole} px");
    assert!(texts(&window, Side::Left).iter().any(|text| text.starts_with("intensity ")));
    assert!(window.state().model().open.measuring.unwrap().end.is_some());
    // The image was not moved: a click is where the image is drawn when it fits.
    press(&mut window, Key::D);
    click(&mut window, from);
    let half = window.state().document().half.unwrap();
    assert!((screen_of(&window, Side::Left, half.point) - from).length() < 0.1);
}

#[test]
fn escape_removes_the_measurement_then_the_tool_and_only_then_an_unfinished_pair() {
    let mut window = sample();
    click_at(&mut window, Side::Left, -0.2, 0.1);
    press(&mut window, Key::D);
    for x in [-0.2, 0.2] {
        click_at(&mut window, Side::Left, x, 0.2);
    }
    let left = |window: &Window| {
        let measures = window.query_by_label_contains("Measure tool: ").is_some();
        (distance(window, Side::Left).is_some(), measures, window.state().document().half.is_some())
    };
    assert_eq!(left(&window), (true, true, true));
    for after in [(false, true, true), (false, false, true), (false, false, false)] {
        press(&mut window, Key::Escape);
        assert_eq!(left(&window), after);
    }
}

#[test]
fn a_measurement_goes_with_its_pictures() {
    let files = Files::new();
    let mut window = sample();
    press(&mut window, Key::D);
    for x in [-0.2, 0.2] {
        click_at(&mut window, Side::Right, x, 0.1);
    }
    assert!(distance(&window, Side::Right).is_some());
    drop_files(&mut window, &[files.image("a.png", 320, 240), files.image("b.png", 320, 240)]);
    assert_eq!(distance(&window, Side::Right), None);
}

#[test]
fn the_empty_image_has_a_menu() {
    let mut window = sample();
    let place = at(&window, Side::Left, 0.1, 0.1);
    right_click(&mut window, place);
    tap(&mut window, "Add pair p here");
    let half = window.state().document().half.unwrap();
    assert!((screen_of(&window, Side::Left, half.point) - place).length() < 0.1);
    let match_place = at(&window, Side::Right, 0.05, 0.1);
    right_click(&mut window, match_place);
    tap(&mut window, "Match of p is here");
    assert_eq!(window.state().document().pairs.len(), 1);

    click_two_pairs(&mut window);
    let free = at_rest(&window);
    right_click(&mut window, free);
    tap(&mut window, "Pin the lines here");
    let pins = window.state().focus().pins();
    assert!(matches!(pins[0].source, LineSource::Through { side: Side::Left, .. }));
    // Beside the pinned line, which has its own menu.
    let beside = at(&window, Side::Left, 0.3, -0.4);
    right_click(&mut window, beside);
    tap(&mut window, "Measure from here");
    click_at(&mut window, Side::Left, -0.3, 0.4);
    assert!(distance(&window, Side::Left).is_some());
}

/// Returns a place without points and lines.
fn at_rest(window: &Window) -> Pos2 {
    at(window, Side::Left, -0.4, 0.4)
}

#[test]
fn the_menu_copies_coordinates() {
    let mut window = sample();
    let place = at(&window, Side::Left, 0.0, 0.0);
    let centre = window.state().document().frame(Side::Left).unwrap().centre();
    right_click(&mut window, place);
    window.get_by_label("Copy coordinates").click();
    let mut copied = None;
    for _ in 0..4 {
        window.step();
        for command in &window.output().platform_output.commands {
            if let OutputCommand::CopyText(text) = command {
                copied = Some(text.clone());
            }
        }
    }
    let copied = copied.unwrap();
    let numbers: Vec<f64> = copied.split(", ").map(|number| number.parse().unwrap()).collect();
    assert!((numbers[0] - centre.x).abs() < 0.5 && (numbers[1] - centre.y).abs() < 0.5, "{copied}");
}
