//! The menu of a place in an image.

use crate::support::*;

use egui::{Key, OutputCommand, Pos2};
use egui_kittest::kittest::Queryable;
use epiline::internals::app::model::document::LineSource;
use epiline::internals::app::model::document::Side;

#[test]
fn without_a_geometry_there_is_no_rectified_pair() {
    let mut window = sample();
    press(&mut window, Key::Num6);
    window.get_by_label("There is no rectified pair yet. Find the geometry first.");
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
    let pins = &window.state().document().pins;
    assert!(matches!(pins[0].source, LineSource::Through { side: Side::Left, .. }));
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
