//! The rectified pair: pictures, rows linked with the images, layouts, measures, export.

use crate::support::*;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Color32, Key, Modifiers, PointerButton, Pos2, Rect, Shape, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::estimate::{CancelFlag, Estimate, Reason, Trust, Verdict};
use epiline::geometry::{Frame, FundamentalMatrix, Point, PointPair};
use epiline::internals::app::Services;
use epiline::internals::app::Start;
use epiline::internals::app::model::document::Side;
use epiline::internals::app::model::focus::Target;
use epiline::internals::app::model::rectified::RectifiedLayout;
use epiline::rectify::{Limits, Rectification, RectifyMethod, rectify};
use epiline::synthetic::Sample;
use nalgebra::Vector3;

const CURSOR: Color32 = Color32::from_rgb(244, 239, 110);
const GUIDE: Color32 = Color32::from_rgba_premultiplied(110, 110, 110, 131);

/// The estimator finds this F, whatever is clicked.
fn finding(fundamental: FundamentalMatrix) -> Services {
    Services { estimate: Box::new(move |_, _| Ok(Estimate::from(fundamental))), ..services() }
}

/// The sample with its true geometry and the rectified pair on the stage.
fn rectified() -> (Window, Rectification) {
    let sample = Sample::Courtyard.load();
    let mut window = window(Start::default(), finding(sample.fundamental));
    tap(&mut window, "Show me how the lines are found");
    press(&mut window, Key::Num6);
    let frames = sample.pictures.each_ref().map(epiline::image::Picture::frame);
    let found =
        rectify(&sample.fundamental, frames, &sample.matches, RectifyMethod::Auto, &Limits::default());
    (window, found.unwrap())
}

#[test]
fn where_the_epipole_is_not_determined_disparities_are_called_no_depth() {
    let fundamental = Sample::Courtyard.load().fundamental;
    let mut services = finding(fundamental);
    services.estimate = Box::new(move |_, _| {
        let mut found = Estimate::from(fundamental);
        let reasons = vec![Reason::NoRelief { along: 3, across: 4, on_warp: 400 }];
        found.assessment.trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
        Ok(found)
    });
    let mut window = window(Start::default(), services);
    tap(&mut window, "Show me how the lines are found");
    press(&mut window, Key::Num6);
    window.get_by_label_contains("The epipole is not determined: rows match, but disparities are not depth.");
    assert!(window.query_by_label_contains("because").is_none());
}

fn picture(window: &Window, name: &str) -> Rect {
    window.get_by_label(name).rect()
}

const LEFT: &str = "rectified left picture";
const RIGHT: &str = "rectified right picture";

/// Where a pixel of a rectified picture that is shown whole appears.
fn place(rect: Rect, size: Frame, at: Point) -> Pos2 {
    let scale = (rect.width() / size.width as f32).min(rect.height() / size.height as f32);
    let offset = at - size.centre();
    rect.center() + vec2(offset.x as f32, offset.y as f32) * scale
}

/// The heights of horizontal lines of a colour across a picture.
fn rows(window: &Window, rect: Rect, color: Color32) -> Vec<f32> {
    let inside =
        window.output().shapes.iter().filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
    inside
        .filter_map(|clipped| match &clipped.shape {
            Shape::LineSegment { points: [a, b], stroke }
                if stroke.color == color && (a.y - b.y).abs() < 1e-6 =>
            {
                Some(a.y)
            }
            _ => None,
        })
        .collect()
}

/// Where the picture is drawn within its place.
fn drawn(window: &Window, rect: Rect) -> Rect {
    let inside =
        window.output().shapes.iter().filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
    let meshes = inside.filter_map(|clipped| match &clipped.shape {
        Shape::Mesh(mesh) => Some(mesh.calc_bounds()),
        _ => None,
    });
    meshes.reduce(Rect::union).expect("a picture").translate(-rect.min.to_vec2())
}

#[test]
fn the_pair_is_made_once_there_is_a_geometry_and_measured() {
    let mut empty = sample();
    press(&mut empty, Key::Num6);
    assert!(empty.query_by_label(LEFT).is_none(), "there is nothing to rectify");
    let (mut window, found) = rectified();
    assert_eq!(picture(&window, LEFT).size(), picture(&window, RIGHT).size());
    window.get_by_label_contains("Planar, because the epipoles lie well outside both images");
    window.get_by_label_contains("over 2 point pairs");
    window.get_by_label(&format!("{} × {} px", found.size.width, found.size.height));
    // With the ground truth all its matches count.
    press(&mut window, Key::G);
    let matches = found.measures.rows.unwrap();
    window.get_by_label_contains(&format!("over {} true matches", matches.matches));
    window.get_by_label_contains("Suggested search range: ");
}

#[test]
fn a_place_in_a_rectified_picture_marks_its_row_in_both_and_names_its_pixel() {
    let (mut window, found) = rectified();
    for (which, side, name) in [(0, Side::Left, LEFT), (1, Side::Right, RIGHT)] {
        let at = Point::new(0.4 * found.size.width as f64, 0.3 * found.size.height as f64);
        window.hover_at(place(picture(&window, name), found.size, at));
        settle(&mut window);
        let Some(Target::Rectified { side: hovered, at }) = window.state().focus().hovered() else {
            panic!("nothing is pointed at");
        };
        assert_eq!(hovered, side);
        for other in [LEFT, RIGHT] {
            let rect = picture(&window, other);
            let expected = place(rect, found.size, at).y;
            let drawn = rows(&window, rect, CURSOR);
            assert!(drawn.iter().any(|y| (y - expected).abs() < 0.6), "{drawn:?} not {expected} in {other}");
        }
        let original = found.maps[which].original_from_rectified(at).unwrap();
        let text = format!("{} image ({:.1}, {:.1})", side.name(), original.x, original.y);
        let is_told =
            |shape: &Shape| matches!(shape, Shape::Text(shown) if shown.galley.text().contains(&text));
        assert!(window.output().shapes.iter().any(|clipped| is_told(&clipped.shape)), "{text}");
    }
}

#[test]
fn the_rectified_pair_takes_most_of_the_window() {
    let (mut window, found) = rectified();
    for size in [vec2(1024.0, 640.0), vec2(1280.0, 800.0), vec2(1440.0, 900.0), vec2(1920.0, 1080.0)] {
        window.set_size(size);
        settle(&mut window);
        let scale = |width: f32, height: f32| {
            (width / found.size.width as f32).min(height / found.size.height as f32)
        };
        let shown = picture(&window, LEFT);
        let share = scale(shown.width(), shown.height()) / scale(size.x / 2.0 - 1.0, size.y);
        let least = if size.x < 1100.0 { 0.7 } else { 0.8 };
        assert!(share * share >= least, "{size:?}: {}", share * share);
    }
}

#[test]
fn both_pictures_zoom_and_move_together_and_a_double_click_shows_them_whole() {
    let (mut window, _) = rectified();
    let whole = drawn(&window, picture(&window, LEFT));
    let cursor = picture(&window, LEFT).center() + vec2(20.0, 10.0);
    window.hover_at(cursor);
    window.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 150.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    for _ in 0..10 {
        window.step();
    }
    settle(&mut window);
    let both = |window: &Window| [LEFT, RIGHT].map(|name| drawn(window, picture(window, name)));
    let [left, right] = both(&window);
    assert!(left.width() > 1.5 * whole.width());
    assert!((left.min - right.min).length() < 0.1 && (left.size() - right.size()).length() < 0.1);
    drag(&mut window, cursor, cursor + vec2(-60.0, -30.0), PointerButton::Primary);
    let [moved, other] = both(&window);
    assert!(moved.min.x < left.min.x - 30.0 && moved.min.y < left.min.y - 10.0);
    assert!((moved.min - other.min).length() < 0.1);
    let at = picture(&window, RIGHT).center();
    for _ in 0..2 {
        button(&window, at, PointerButton::Primary, true);
        button(&window, at, PointerButton::Primary, false);
    }
    settle(&mut window);
    let [left, _] = both(&window);
    assert!((left.min - whole.min).length() < 0.1, "{left:?} not {whole:?}");
    assert_eq!(window.state().document().pairs.len(), 2, "no point was placed");
}

#[test]
fn pictures_take_turns_by_key_and_the_choice_is_kept() {
    let (mut window, _) = rectified();
    tap(&mut window, "Disparity");
    window.get_by_label("disparities of the rectified pair");
    assert!(window.query_by_label(LEFT).is_none());
    let look = window.state().look().clone();
    assert_eq!(look.rectified.layout, RectifiedLayout::Disparity);
    let text = serde_json::to_string(&look).unwrap();
    let kept = serde_json::from_str::<epiline::internals::app::model::look::Look>(&text).unwrap();
    assert_eq!(kept.rectified, look.rectified);
    press(&mut window, Key::X);
    window.get_by_label(LEFT);
    assert!(window.query_by_label(RIGHT).is_none());
    press(&mut window, Key::X);
    window.get_by_label(RIGHT);
    assert!(window.query_by_label(LEFT).is_none());
    tap(&mut window, "Swap");
    window.get_by_label(LEFT);
    // By the clock, both come in turn.
    window.get_by_role_and_label(Role::CheckBox, "auto").click();
    window.step();
    let mut seen = [false; 2];
    for _ in 0..60 {
        window.step();
        seen = [
            seen[0] | window.query_by_label(LEFT).is_some(),
            seen[1] | window.query_by_label(RIGHT).is_some(),
        ];
    }
    assert_eq!(seen, [true, true]);
}

#[test]
fn guide_lines_are_at_the_same_rows_and_can_be_hidden() {
    let (mut window, _) = rectified();
    let guides = |window: &Window, name| {
        let rect = picture(window, name);
        rows(window, rect, GUIDE).iter().map(|y| y - rect.min.y).collect::<Vec<_>>()
    };
    let left = guides(&window, LEFT);
    assert!(left.len() >= 3, "{left:?}");
    assert_eq!(left, guides(&window, RIGHT));
    tap(&mut window, "guide lines");
    assert!(guides(&window, LEFT).is_empty());
    tap(&mut window, "guide lines");
    window.get_by_label_contains("its line in both");
    // The disparities are one picture without guide lines.
    tap(&mut window, "Disparity");
    assert!(window.query_by_label_contains("its line in both").is_none());
    window.get_by_label_contains("Point at the picture to see its line");
    assert!(window.get_by_label("guide lines").accesskit_node().is_disabled());
}

#[test]
fn an_epipole_inside_forbids_planar_and_polar_is_one_press_away() {
    let inside = Vector3::new(320.0, 240.0, 1.0);
    let forward = FundamentalMatrix::from_rank_two(inside.cross_matrix()).unwrap();
    let mut window = window(Start::default(), finding(forward));
    tap(&mut window, "Show me how the lines are found");
    press(&mut window, Key::Num6);
    window.get_by_label_contains("Polar, because the epipole lies inside the left image");
    tap(&mut window, "Planar");
    assert_eq!(window.state().document().rectification, RectifyMethod::Planar);
    window.get_by_label_contains("epipole lies inside the left image. Planar rectification is impossible");
    tap(&mut window, "Use the polar method");
    assert_eq!(window.state().document().rectification, RectifyMethod::Polar);
    window.get_by_label_contains("Polar, because it was asked for");
    undo(&mut window);
    assert_eq!(window.state().document().rectification, RectifyMethod::Planar, "a step to undo");
}

#[test]
fn the_pair_is_exported_at_full_size_with_what_was_chosen() {
    let (mut window, found) = rectified();
    let folder = tempfile::tempdir().unwrap();
    let into = folder.path().join("pair");
    press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(egui::Event::Text(into.display().to_string()));
    settle(&mut window);
    window.get_by_role_and_label(Role::RadioButton, "TIFF").click();
    window
        .get_by_role_and_label(Role::CheckBox, "Source position of each pixel, as .npy arrays for cv2.remap")
        .click();
    settle(&mut window);
    window.get_by_role_and_label(Role::Button, "Export rectified pair").click();
    settle(&mut window);
    window.get_by_label_contains("The rectified pair is in ");
    assert!(window.query_by_label("Export rectified pair").is_none(), "the window for it is closed");
    // The message does not cover the next dialog.
    press_with(&mut window, Modifiers::COMMAND, Key::O);
    assert!(window.query_by_label_contains("The rectified pair is in ").is_none());
    for name in [
        "left.tiff",
        "right.tiff",
        "side-by-side.tiff",
        "left-map.npy",
        "right-map.npy",
        "rectification.json",
    ] {
        assert!(into.join(name).is_file(), "{name}");
    }
    let original = Sample::Courtyard.load().pictures[1].pixels.clone();
    let expected = found.warp(1, &original, &CancelFlag::default()).unwrap();
    assert_eq!(image::open(into.join("right.tiff")).unwrap().to_rgba8(), expected.to_rgba8());
}

#[test]
fn an_export_that_fails_is_a_sentence() {
    let (mut window, _) = rectified();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").unwrap();
    tap(&mut window, "Export rectified pair…");
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(egui::Event::Text(file.display().to_string()));
    settle(&mut window);
    press(&mut window, Key::Enter);
    window.get_by_label_contains("there is a file of that name. Correct it, or choose another folder.");
}

#[test]
fn the_rectified_pair_follows_the_geometry_that_is_shown() {
    let mut window = window(Start::default(), rich_services());
    click_two_pairs(&mut window);
    press(&mut window, Key::Num6);
    let line = |window: &Window| {
        let node = window.get_by_label_contains("Suggested search range: ");
        format!("{node:?}")
    };
    let result = line(&window);
    show_hypotheses(&mut window);
    tap(&mut window, "Hypothesis 3");
    press(&mut window, Key::Num6);
    assert_ne!(line(&window), result);
}

#[test]
fn the_rectified_pair_follows_a_moved_point_while_the_search_is_held_up() {
    let held_up = Arc::new(AtomicBool::new(false));
    let mut services = services();
    services.estimate = Box::new({
        let held_up = Arc::clone(&held_up);
        move |request, _| {
            while held_up.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(1));
            }
            fake_estimate(&request.pairs, &request.parameters)
        }
    });
    services.follow = Box::new(|request, _| fake_estimate(&request.pairs, &request.parameters).ok());
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    press(&mut window, Key::Num6);
    let drawn = |window: &Window| window.state().model().open.rectified.as_ref().unwrap().fundamental;
    let before = drawn(&window);
    held_up.store(true, Ordering::Relaxed);
    // The arrow keys move the selected point, whatever the stage shows.
    for _ in 0..12 {
        window.key_press_modifiers(Modifiers::SHIFT, Key::ArrowDown);
        window.step();
    }
    let begun = Instant::now();
    while drawn(&window) == before {
        assert!(begun.elapsed() < PATIENCE, "the rectified pair does not follow");
        std::thread::sleep(Duration::from_millis(1));
        window.step();
    }
    assert!(window.state().is_busy(), "the search still goes on");
    held_up.store(false, Ordering::Relaxed);
    settle(&mut window);
}

/// The colour of pair q.
const PAIR_Q: Color32 = Color32::from_rgb(216, 120, 180);

/// Where the ring of pair q is in a picture.
fn ring(window: &Window, name: &str) -> egui::Pos2 {
    let rect = picture(window, name);
    let shapes =
        window.output().shapes.iter().filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
    let mut rings = shapes.filter_map(|clipped| match &clipped.shape {
        egui::Shape::Circle(circle) if circle.stroke.color == PAIR_Q => Some(circle.center),
        _ => None,
    });
    rings.next().expect("the ring of q")
}

#[test]
fn a_click_on_a_ring_brings_its_depth_into_register() {
    let (mut window, _) = rectified();
    // Farther to the right than what is seen at its place.
    press(&mut window, Key::Num5);
    let from =
        screen(&window, epiline::internals::app::model::document::PointRef { pair: 1, side: Side::Right });
    drag(&mut window, from, from + vec2(25.0, 0.0), PointerButton::Primary);
    press(&mut window, Key::Num6);
    let apart = |window: &Window| {
        let place = |name| ring(window, name).x - picture(window, name).min.x;
        place(LEFT) - place(RIGHT)
    };
    assert!(apart(&window).abs() > 2.0, "{}", apart(&window));
    let at = ring(&window, LEFT);
    click(&mut window, at);
    assert!(apart(&window).abs() < 0.6, "{}", apart(&window));
    tap(&mut window, "0");
    assert!(apart(&window).abs() > 2.0);
    tap(&mut window, "Disparity");
    window.get_by_label("disparities of the rectified pair");
    window.get_by_label_contains("Disparity preview: ");
}

#[test]
fn the_disparities_have_a_colour_scale_with_the_search_range() {
    let (mut window, _) = rectified();
    // The dock has more words before these.
    let is_beside_the_scale = |window: &Window| {
        let begins = |shape: &egui::Shape| matches!(shape, egui::Shape::Text(text) if text.galley.text().starts_with("Suggested search range: "));
        window.output().shapes.iter().any(|clipped| begins(&clipped.shape))
    };
    assert!(!is_beside_the_scale(&window));
    tap(&mut window, "Disparity");
    assert!(is_beside_the_scale(&window));
}

#[test]
fn what_rows_that_lie_apart_mean_depends_on_whose_geometry_is_shown() {
    for (verdict, says) in [
        (Verdict::Reliable, "hypothesis 3 is shown, and these points contradict it. Press R for the result."),
        (Verdict::Doubtful, "hypothesis 3 is shown, which differs from the result. Neither is certain"),
    ] {
        let mut services = rich_services();
        services.estimate = Box::new(move |request, _| {
            let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
            estimate.assessment.trust = Some(Trust { verdict, reasons: Vec::new() });
            Ok(estimate)
        });
        let pairs =
            vec![PointPair::new(150.0, 150.0, 130.0, 155.0), PointPair::new(600.0, 400.0, 560.0, 390.0)];
        let mut window = window(Start { pairs, ..Start::default() }, services);
        show_hypotheses(&mut window);
        tap(&mut window, "Hypothesis 3");
        press(&mut window, Key::Num6);
        window.get_by_label_contains(says);
        assert!(window.query_by_label_contains("add or correct point pairs").is_none());
        assert!(window.query_by_label_contains("Search ").is_none(), "a range of a wrong geometry");
        press(&mut window, Key::R);
        assert!(window.query_by_label_contains("Rows of ").is_none());
    }
}
