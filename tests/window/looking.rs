//! Looking at the geometry: overlays, the inspect tool, the loupe, the map, linked views, suggestions, the palette.

use crate::support::*;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::{Color32, Key, Modifiers, PointerButton, Pos2, Shape, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::estimate::{RefinedMatch, Refinement};
use epiline::geometry::{Point, PointPair, symmetric_epipolar_distance};
use epiline::internals::app::model::document::LineSource;
use epiline::internals::app::model::document::Side;
use epiline::internals::app::model::look::Look;
use epiline::internals::app::{Services, Start};
use epiline::suggest::{Clarity, Suggestion, Suggestions};

const CURSOR_LINE: Color32 = Color32::from_rgb(244, 239, 110);
const FIRST_PIN: Color32 = Color32::from_rgb(244, 239, 110);

/// Returns the signs outside ASCII in the texts of a folder's code, tests left out.
fn signs_of_texts(folder: &std::path::Path, signs: &mut std::collections::BTreeSet<char>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            signs_of_texts(&path, signs);
        } else if !path.ends_with("tests.rs") {
            let code = std::fs::read_to_string(&path).unwrap();
            let code = code.split("#[cfg(test)]").next().unwrap();
            let lines = code.lines().map(|line| line.split("//").next().unwrap());
            signs.extend(lines.flat_map(str::chars).filter(|sign| !sign.is_ascii()));
        }
    }
}

#[test]
fn every_sign_of_the_window_has_a_glyph() {
    let window = sample();
    let source = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut signs = std::collections::BTreeSet::new();
    for folder in ["app", "presentation"] {
        signs_of_texts(&source.join(folder), &mut signs);
    }
    assert!(signs.contains(&'°'), "{signs:?}");
    let font = egui::FontId::proportional(12.0);
    signs.retain(|sign| !window.ctx.fonts_mut(|fonts| fonts.has_glyph(&font, *sign)));
    assert!(signs.is_empty(), "no glyph for {signs:?}");
}

/// The square frame of the loupe in an image, if it is drawn.
fn loupe_in(window: &Window, side: Side) -> Option<egui::Rect> {
    let pane = pane(window, side);
    window.output().shapes.iter().find_map(|clipped| match &clipped.shape {
        Shape::Rect(rect) if (rect.rect.size() - vec2(132.0, 132.0)).length() < 0.1 => {
            Some(rect.rect).filter(|frame| pane.contains(frame.center()))
        }
        _ => None,
    })
}

/// The frame of the loupe in the left image.
fn loupe(window: &Window) -> Option<egui::Rect> {
    loupe_in(window, Side::Left)
}

fn suggesting(verdict: Clarity) -> Services {
    Services {
        suggest: Box::new(move |question| {
            let position = question.half.point + epiline::geometry::Vector::new(12.5, -3.0);
            let candidate = Suggestion { position, correlation: 0.93, rotation: 0.0, scale: 1.0 };
            let rival = Suggestion { position: Point::new(10.0, 20.0), correlation: 0.71, ..candidate };
            Ok(Suggestions {
                candidates: vec![candidate, rival],
                ambiguity: 0.2,
                return_distance: Some(0.1),
                verdict,
            })
        }),
        ..services()
    }
}

#[test]
fn the_cursor_line_is_the_epipolar_line_of_the_place_under_the_cursor() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let f = *window.state().estimate().unwrap().fundamental();
    for side in Side::BOTH {
        let cursor = at(&window, side, 0.11, -0.07);
        window.hover_at(cursor);
        settle(&mut window);
        let under = image_position(&window, side, cursor);
        let expected = match side {
            Side::Left => f.line2_from_point1(under),
            Side::Right => f.line1_from_point2(under),
        };
        let drawn = lines(&window, side.other(), CURSOR_LINE);
        assert!(!drawn.is_empty(), "from the {} image", side.name());
        for end in drawn.into_iter().flatten() {
            let distance = expected.unwrap().distance(image_position(&window, side.other(), end));
            assert!(distance < 0.1, "{distance} px off, from the {} image", side.name());
        }
    }
}

#[test]
fn the_inspect_tool_pins_line_pairs_and_escape_leaves_it() {
    let mut window = sample();
    click_two_pairs(&mut window);
    press(&mut window, Key::I);
    window.get_by_label_contains("Pin tool: click to pin");
    let place = at(&window, Side::Right, 0.1, 0.1);
    click(&mut window, place);
    let pins = window.state().document().pins.clone();
    assert!(matches!(pins[..], [pin] if matches!(pin.source, LineSource::Through { side: Side::Right, .. })));
    window.hover_at(egui::pos2(4.0, 844.0));
    settle(&mut window);
    for side in Side::BOTH {
        assert_eq!(lines(&window, side, FIRST_PIN).len(), 1, "in the {} image", side.name());
    }
    // A click on a point pins the lines of its pair.
    let handle = screen(&window, P_LEFT);
    click(&mut window, handle);
    assert_eq!(window.state().document().inspected_pin().unwrap().source, LineSource::Pair(0));
    assert!(window.state().document().half.is_none(), "no point was placed");
    press(&mut window, Key::Delete);
    assert_eq!(window.state().document().pins, pins, "the pair that was looked at is unpinned");
    assert_eq!(window.state().document().pairs.len(), 2);
    press(&mut window, Key::Escape);
    click(&mut window, place);
    assert!(window.state().document().half.is_some());
    assert_eq!(window.state().document().pins.len(), 1);
}

#[test]
fn enter_accepts_a_clear_suggestion_only() {
    for (verdict, accepted) in [(Clarity::Clear, true), (Clarity::Ambiguous, false)] {
        let mut window = window(Start::default(), suggesting(verdict));
        click_at(&mut window, Side::Left, -0.1, 0.1);
        let first = window.state().document().half.unwrap().point;
        press(&mut window, Key::Enter);
        let pairs = &window.state().document().pairs;
        assert_eq!(pairs.len(), usize::from(accepted), "{verdict:?}");
        if accepted {
            let moved = pairs[0].point2 - first;
            assert!((moved.x - 12.5).abs() < 1e-9 && (moved.y + 3.0).abs() < 1e-9, "{moved:?}");
            undo(&mut window);
            assert!(window.state().document().pairs.is_empty(), "one step to undo");
        } else {
            window.get_by_label_contains("Several places look alike");
        }
    }
}

#[test]
fn only_places_that_look_alike_are_marked_and_their_number_is_named() {
    for (verdict, says) in [
        (Clarity::Clear, Some("Enter to accept, similarity 0.93 of 1")),
        (Clarity::Ambiguous, Some("one of several alike, similarity 0.93 of 1")),
        (Clarity::Weak, None),
        (Clarity::NoReturn, None),
    ] {
        let mut window = window(Start::default(), suggesting(verdict));
        click_at(&mut window, Side::Left, -0.1, 0.1);
        assert_eq!(painted(&window, "similarity"), says.is_some(), "{verdict:?}");
        assert!(says.is_none_or(|says| painted(&window, says)), "{verdict:?}");
        assert!(verdict == Clarity::Clear || verdict == Clarity::Ambiguous || !painted(&window, "0.71"));
    }
}

#[test]
fn the_palette_finds_and_runs_commands_by_key_and_by_mouse() {
    let mut window = sample();
    let theme = window.ctx.theme();
    press_with(&mut window, Modifiers::COMMAND, Key::K);
    window.event(egui::Event::Text("dark".into()));
    settle(&mut window);
    press(&mut window, Key::Enter);
    assert_ne!(window.ctx.theme(), theme);
    assert!(window.query_by_label("Search commands").is_none(), "it closes when a command runs");

    press_with(&mut window, Modifiers::COMMAND, Key::P);
    window.event(egui::Event::Text("show me".into()));
    settle(&mut window);
    tap(&mut window, "Show me: place two pairs on the sample");
    assert_eq!(window.state().document().pairs.len(), 2);

    press_with(&mut window, Modifiers::COMMAND, Key::K);
    press(&mut window, Key::ArrowDown);
    press(&mut window, Key::Delete);
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Search commands").is_none());
    assert_eq!(window.state().document().pairs.len(), 2, "its keys are its own");
}

#[test]
fn letters_of_the_frame_in_which_the_palette_opens_are_typed_into_it() {
    let mut window = sample();
    let theme = window.ctx.theme();
    let key = |key, modifiers| egui::Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    };
    // A slow frame has the keys of a second.
    window.input_mut().events.extend([
        key(Key::K, Modifiers::COMMAND),
        key(Key::T, Modifiers::NONE),
        egui::Event::Text("theme".into()),
        key(Key::Enter, Modifiers::NONE),
    ]);
    window.step();
    settle(&mut window);
    assert_eq!(window.ctx.theme(), theme, "no letter acts as a key");
    window.get_by_label("Search commands");
    press(&mut window, Key::Enter);
    assert_ne!(window.ctx.theme(), theme);
}

#[test]
fn enter_runs_no_other_command_in_place_of_an_unavailable_one() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 3, 3), files.image("b.png", 658, 486)]);
    press_with(&mut window, Modifiers::COMMAND, Key::K);
    window.event(egui::Event::Text("without".into()));
    settle(&mut window);
    assert!(painted(&window, "not available now"));
    press(&mut window, Key::Enter);
    window.get_by_label("Search commands");
    assert!(!window.state().model().open.alone);
    let entry = window.get_by_label("Find the geometry without clicks");
    assert!(entry.accesskit_node().is_disabled());
}

#[test]
fn no_tooltip_stays_below_a_dialog() {
    let mut window = sample();
    let tooltip = "Pin the epipolar lines through each place you click. Escape returns";
    for (modifiers, key) in
        [(Modifiers::COMMAND, Key::K), (Modifiers::NONE, Key::F1), (Modifiers::COMMAND, Key::O)]
    {
        let button = window.get_by_label("Pin tool").rect().center();
        window.hover_at(button + vec2(400.0, 300.0));
        window.step();
        window.hover_at(button);
        let wait = |window: &mut Window| (0..30).for_each(|_| window.step());
        wait(&mut window);
        assert!(painted(&window, tooltip), "{key:?}");
        press_with(&mut window, modifiers, key);
        assert!(!painted(&window, tooltip), "{key:?}");
        wait(&mut window);
        assert!(!painted(&window, tooltip), "{key:?}");
        press(&mut window, Key::Escape);
    }
}

#[test]
fn linked_views_zoom_and_move_together() {
    let mut window = sample();
    let (left, right) = (at(&window, Side::Left, 0.2, 0.1), at(&window, Side::Right, 0.2, 0.1));
    let place = |window: &mut Window| {
        click(window, right);
        let point = window.state().document().half.unwrap().point;
        press(window, Key::Escape);
        point
    };
    let before = place(&mut window);
    scroll(&mut window, left);
    let alone = place(&mut window);
    assert!((alone - before).norm() < 1e-6, "not linked: {alone}");
    press(&mut window, Key::L);
    let beside = right + vec2(-90.0, -60.0);
    click(&mut window, beside);
    let zoomed = window.state().document().half.unwrap().point;
    press(&mut window, Key::Escape);
    let unzoomed = image_position(&window, Side::Right, beside);
    assert!(
        (zoomed - before).norm() < 0.8 * (unzoomed - before).norm(),
        "{zoomed} is not nearer than {unzoomed}"
    );
    let empty = left + vec2(-40.0, 0.0);
    drag(&mut window, empty, empty + vec2(50.0, 0.0), PointerButton::Middle);
    let moved = place(&mut window);
    assert!(moved.x < before.x - 10.0, "{moved}");
}

#[test]
fn linked_views_follow_the_match_and_alt_moves_one_alone() {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
        // The geometry maps every point by the translation of p.
        let moved = request.pairs[0].point2 - request.pairs[0].point1;
        let at = |x: f64, y: f64| Point::new(x, y);
        let points = [at(200.0, 150.0), at(400.0, 300.0), at(600.0, 450.0)];
        let pairs = points.map(|point1| PointPair { point1, point2: point1 + moved });
        let matches = pairs.map(|pair| RefinedMatch { pair, correlation: 0.9 }).to_vec();
        estimate.assessment.refinement =
            Some(Refinement { matches, uncertainty: None, noise: None, is_posed: false });
        Ok(estimate)
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    let p = window.state().document().pairs[0];
    press(&mut window, Key::L);
    let left = at(&window, Side::Left, 0.15, 0.1);
    scroll(&mut window, left);
    let middle = |window: &mut Window, side: Side| {
        let centre = pane(window, side).center();
        click(window, centre);
        let point = window.state().document().half.unwrap().point;
        press(window, Key::Escape);
        point
    };
    let [own, other] = Side::BOTH.map(|side| middle(&mut window, side));
    assert!((other - own - (p.point2 - p.point1)).norm() < 1.0, "{own} and {other}");
    window.event(egui::Event::ModifiersChanged(Modifiers::ALT));
    drag(&mut window, left, left + vec2(60.0, 20.0), PointerButton::Middle);
    window.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    settle(&mut window);
    let [moved, stays] = Side::BOTH.map(|side| middle(&mut window, side));
    assert!((moved - own).norm() > 5.0 && (stays - other).norm() < 0.1, "{moved} and {stays}");
}

#[test]
fn the_loupe_shows_while_a_point_is_placed_or_dragged() {
    let mut window = sample();
    // Before anything is placed, the sample shows lines.
    for side in Side::BOTH {
        click_at(&mut window, side, 0.3, 0.3);
    }
    let cursor = at(&window, Side::Left, 0.0, 0.1);
    window.hover_at(cursor);
    settle(&mut window);
    let frame = loupe(&window).expect("a loupe while the first points are placed");
    assert!(!frame.contains(cursor) && pane(&window, Side::Left).contains_rect(frame));
    click_two_pairs(&mut window);
    window.hover_at(cursor);
    settle(&mut window);
    assert!(loupe(&window).is_none(), "nothing is being placed");
    let handle = screen(&window, P_LEFT);
    window.hover_at(handle);
    button(&window, handle, PointerButton::Primary, true);
    window.hover_at(handle + vec2(15.0, 5.0));
    window.hover_at(handle + vec2(20.0, 5.0));
    window.step();
    window.step();
    assert!(loupe(&window).is_some() && loupe_in(&window, Side::Right).is_some(), "while dragging");
    button(&window, handle + vec2(20.0, 5.0), PointerButton::Primary, false);
    settle(&mut window);
}

#[test]
fn both_points_of_a_pair_are_magnified_and_the_suggestion_stays_in_view() {
    let mut window = window(Start::default(), suggesting(Clarity::Clear));
    click_at(&mut window, Side::Left, 0.05, 0.1);
    assert!(loupe(&window).is_none(), "the first point is placed");
    let first = window.state().document().half.unwrap().point;
    let offered = screen_of(&window, Side::Right, first + epiline::geometry::Vector::new(12.5, -3.0));
    // The loupe would be above and to the right of the cursor.
    let cursor = offered + vec2(-60.0, 60.0);
    window.hover_at(cursor);
    settle(&mut window);
    let there = loupe_in(&window, Side::Right).expect("a loupe where the match is sought");
    assert!(!there.expand(10.0).contains(offered) && !there.contains(cursor), "{there:?} {offered:?}");
    let here = loupe(&window).expect("a loupe beside the first point");
    assert!(!here.contains(at(&window, Side::Left, 0.05, 0.1)), "{here:?}");
}

#[test]
fn a_name_in_the_corner_does_not_hide_the_place_under_the_cursor() {
    let mut window = sample();
    let corner = pane(&window, Side::Left).min + vec2(20.0, 14.0);
    let is_named = |window: &Window| {
        window.output().shapes.iter().any(|clipped| match &clipped.shape {
            Shape::Text(text) => text.pos.distance(corner) < 20.0 && text.galley.text().starts_with("Left"),
            _ => false,
        })
    };
    assert!(is_named(&window));
    window.hover_at(corner);
    settle(&mut window);
    assert!(!is_named(&window), "a click would place a point there");
}

#[test]
fn overlays_are_shown_and_hidden_and_the_choice_is_kept() {
    let mut window = window(Start::default(), rich_services());
    click_two_pairs(&mut window);
    let corner = pane(&window, Side::Left).left_top() - vec2(0.0, 30.0);
    tap(&mut window, "Overlays");
    for name in ["Epipolar lines", "Points", "Hypotheses", "Uncertainty"] {
        let drawn = |window: &mut Window| {
            window.hover_at(corner);
            settle(window);
            window.output().shapes.len()
        };
        let before = drawn(&mut window);
        tap(&mut window, &format!("Show {name}"));
        assert_ne!(drawn(&mut window), before, "{name}");
    }
    let look = window.state().look().clone();
    let mut again = sample();
    again.state_mut().set_look(look.clone());
    settle(&mut again);
    assert_eq!(*again.state().look(), look);
    assert_ne!(look, Look::default());
}

#[test]
fn the_geometry_follows_a_dragged_point_while_the_search_is_held_up() {
    let held_up = Arc::new(AtomicBool::new(false));
    let mut services = services();
    services.estimate = Box::new({
        let held_up = Arc::clone(&held_up);
        move |request, _| {
            while held_up.load(Ordering::Relaxed) {
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            fake_estimate(&request.pairs, &request.parameters)
        }
    });
    services.follow = Box::new(|request, starts| {
        assert!(!starts.is_empty());
        fake_estimate(&request.pairs, &request.parameters).ok()
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    held_up.store(true, Ordering::Relaxed);
    let from = screen(&window, P_LEFT);
    window.hover_at(from);
    button(&window, from, PointerButton::Primary, true);
    for step in 1..=5 {
        window.hover_at(from + vec2(8.0 * step as f32, 0.0));
        window.step();
    }
    let begun = std::time::Instant::now();
    let fits = |window: &Window| {
        let inspector = window.state();
        let f = inspector.estimate().unwrap().fundamental();
        inspector.document().pairs.iter().all(|pair| symmetric_epipolar_distance(f, pair) < 1e-6)
    };
    while !fits(&window) {
        assert!(begun.elapsed() < PATIENCE, "the geometry does not follow");
        std::thread::sleep(std::time::Duration::from_millis(1));
        window.step();
    }
    assert!(window.state().is_busy(), "the search still goes on");
    held_up.store(false, Ordering::Relaxed);
    button(&window, from + vec2(40.0, 0.0), PointerButton::Primary, false);
    settle(&mut window);
}

#[test]
fn pinned_lines_have_numbers_and_can_be_unpinned_by_name() {
    let mut window = sample();
    click_two_pairs(&mut window);
    press(&mut window, Key::I);
    for y in [0.0, 0.1] {
        click_at(&mut window, Side::Left, 0.0, y);
    }
    let numbered = |window: &Window, number: &str| {
        let is_it = |shape: &Shape| matches!(shape, Shape::Text(text) if text.galley.text() == number);
        let pane = pane(window, Side::Right).expand(1.0);
        let shapes = &window.output().shapes;
        shapes.iter().any(|clipped| pane.contains_rect(clipped.clip_rect) && is_it(&clipped.shape))
    };
    assert!(numbered(&window, "pin 1") && numbered(&window, "pin 2") && !numbered(&window, "pin 3"));
    press_with(&mut window, Modifiers::COMMAND, Key::K);
    window.event(egui::Event::Text("unpin all".into()));
    settle(&mut window);
    press(&mut window, Key::Enter);
    assert!(window.state().document().pins.is_empty() && !numbered(&window, "pin 1"));
}

#[test]
fn stretched_brightness_changes_what_is_shown_and_nothing_else() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = window.state().estimate().map(|estimate| *estimate.fundamental());
    tap(&mut window, "Stretch brightness");
    assert_eq!(window.query_all_by_label_contains("brightness stretched").count(), 2);
    let [left, right] = window.state().model().open.stretched.unwrap();
    assert!(left != right, "each picture has a range of its own");
    assert_eq!(window.state().estimate().map(|estimate| *estimate.fundamental()), before);
    tap(&mut window, "Stretch brightness");
    assert_eq!(window.query_all_by_label_contains("brightness stretched").count(), 0);
}

#[test]
fn images_stand_above_each_other_on_request_and_it_is_remembered() {
    let mut window = sample();
    assert!(pane(&window, Side::Left).right() <= pane(&window, Side::Right).left());
    press(&mut window, Key::V);
    assert!(pane(&window, Side::Left).bottom() <= pane(&window, Side::Right).top());
    click_two_pairs(&mut window);
    assert_eq!(window.state().document().pairs.len(), 2);
    let look: Look = serde_json::from_str(&serde_json::to_string(window.state().look()).unwrap()).unwrap();
    assert_eq!(look.stacked, Some(true));
    press(&mut window, Key::V);
    assert!(pane(&window, Side::Left).right() <= pane(&window, Side::Right).left());
}

/// Where a place of an image turned clockwise by 90° is on the screen.
fn screen_turned(window: &Window, side: Side, point: Point) -> Pos2 {
    let rect = pane(window, side);
    let frame = window.state().document().frame(side).unwrap();
    let scale = (rect.width() / frame.height as f32).min(rect.height() / frame.width as f32);
    let offset = point - frame.centre();
    rect.center() + vec2(-offset.y as f32, offset.x as f32) * scale
}

#[test]
fn a_view_turns_by_90_degrees_and_coordinates_stay() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = window.state().document().pairs.clone();
    let beside = at(&window, Side::Left, 0.3, -0.4);
    right_click(&mut window, beside);
    tap(&mut window, "Turn clockwise by 90°");
    assert_eq!(window.state().document().pairs, before);

    // A click gives the coordinates of the image, and a drag moves a point under the cursor.
    let place = Point::new(90.0, 60.0);
    let here = screen_turned(&window, Side::Left, place);
    click(&mut window, here);
    let half = window.state().document().half.unwrap();
    assert!((half.point - place).norm() < 0.5, "{}", half.point);
    press(&mut window, Key::Escape);
    let start = point(&window, P_LEFT);
    let (from, step) = (screen_turned(&window, Side::Left, start), vec2(30.0, 10.0));
    drag(&mut window, from, from + step, PointerButton::Primary);
    let reached = point(&window, P_LEFT);
    assert!((screen_turned(&window, Side::Left, reached) - (from + step)).length() < 0.5);
    // An arrow key moves it that way on the screen: to the right is up in the image.
    press_with(&mut window, Modifiers::ALT, Key::ArrowRight);
    assert!((point(&window, P_LEFT) - reached - epiline::geometry::Vector::new(0.0, -0.1)).norm() < 1e-9);

    // A figure shows the image as it is turned, and the other one upright.
    let path = files.0.path().join("figure.svg");
    crate::exchange::export(&mut window, &["Figure"], &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let extent = |image: &str, name: &str| -> f32 {
        let value = image.split(&format!(" {name}=\"")).nth(1).unwrap();
        value.split('"').next().unwrap().parse().unwrap()
    };
    let images: Vec<&str> = text.split("<image").skip(1).collect();
    let is_tall = |image: &str| extent(image, "height") > extent(image, "width");
    assert_eq!([is_tall(images[0]), is_tall(images[1])], [true, false]);

    // Other pictures are upright.
    drop_files(&mut window, &[files.image("a.png", 320, 240), files.image("b.png", 320, 240)]);
    let upright = at(&window, Side::Left, 0.2, 0.1);
    click(&mut window, upright);
    let expected = image_position(&window, Side::Left, upright);
    assert!((window.state().document().half.unwrap().point - expected).norm() < 0.5);
}
