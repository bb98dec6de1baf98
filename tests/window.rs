//! The window without a display: clicks, drags, keys and dropped files, as a person would make them.
#![cfg(feature = "inspector")]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use egui::{Key, Modifiers, PointerButton, Pos2, Rect, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use epiline::app::document::{PointRef, Side};
use epiline::app::{Inspector, Opening, Services, Start, install_theme};
use epiline::estimate::{Counts, Estimate, EstimateError, Method, Parameters};
use epiline::geometry::{FundamentalMatrix, Point, PointPair, symmetric_epipolar_distance};
use nalgebra::{Matrix3, Vector3};

/// Long enough for a loaded machine; reached only when something is wrong.
const PATIENCE: Duration = Duration::from_secs(30);

/// A stand-in for the estimator, instant and exact for the two pairs it is given: `F = [e2]× T` with the
/// translation `T` from `p1` to `p2`, and `e2` on the line of `q2` and `T q1`.
fn fake_estimate(pairs: &[PointPair], parameters: &Parameters) -> Result<Estimate, EstimateError> {
    let [p, q, ..] = pairs else {
        return Err(EstimateError::TooFewPairs { found: pairs.len(), needed: 2 });
    };
    let t = p.point2 - p.point1;
    let shift = Matrix3::new(1.0, 0.0, t.x, 0.0, 1.0, t.y, 0.0, 0.0, 1.0);
    let line = q.point2.to_homogeneous().cross(&(shift * q.point1.to_homogeneous()));
    let e2 = line.cross(&Vector3::new(0.0, 1.0, -100.0)).try_normalize(1e-9).unwrap_or_else(Vector3::x);
    let fundamental =
        FundamentalMatrix::from_rank_two(e2.cross_matrix() * shift).ok_or(EstimateError::NoGeometry)?;
    Ok(Estimate {
        epipole1: fundamental.epipole1(),
        epipole2: fundamental.epipole2(),
        fundamental,
        score: 0.25,
        round_trip_area: 0.5,
        margin: Some(0.4),
        method: parameters.method,
        preset: parameters.preset,
        seed: parameters.seed,
        warnings: Vec::new(),
        counts: Counts::default(),
        timings: Vec::new(),
        first_seconds: 0.01,
        seconds: 0.02,
        hypotheses: Vec::new(),
    })
}

fn services() -> Services {
    Services {
        estimate: Box::new(|_, _, pairs, parameters, _| fake_estimate(pairs, parameters)),
        pick_file: Arc::new(|| None),
    }
}

type Window = Harness<'static, Inspector>;

fn window(start: Start, services: Services) -> Window {
    let mut window = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .with_max_steps(30)
        .with_step_dt(0.05)
        .with_context_setup(install_theme)
        .build_ui_state(|ui, inspector: &mut Inspector| inspector.show(ui), Inspector::new(start, services));
    settle(&mut window);
    window
}

fn sample() -> Window {
    window(Start::default(), services())
}

/// Steps until nothing is under way in any thread, then until nothing is repainted.
fn settle(window: &mut Window) {
    let start = Instant::now();
    window.step();
    while window.state().is_busy() {
        assert!(start.elapsed() < PATIENCE, "still busy");
        std::thread::sleep(Duration::from_millis(1));
        window.step();
    }
    window.run();
}

fn pane(window: &Window, side: Side) -> Rect {
    window.get_by_label(&format!("{} image", side.name())).rect()
}

/// Screen points per image pixel of an image that fits its pane (6 points of room at each side).
fn fitting_scale(window: &Window, side: Side) -> f32 {
    let rect = pane(window, side);
    let frame = window.state().document().frame(side).unwrap();
    ((rect.width() - 12.0) / frame.width as f32).min((rect.height() - 12.0) / frame.height as f32).min(64.0)
}

/// A place in a fitting image, as a fraction of its size from the middle.
fn at(window: &Window, side: Side, x: f32, y: f32) -> Pos2 {
    let frame = window.state().document().frame(side).unwrap();
    let offset = vec2(x * frame.width as f32, y * frame.height as f32);
    pane(window, side).center() + offset * fitting_scale(window, side)
}

fn button(window: &Window, pos: Pos2, button: PointerButton, pressed: bool) {
    window.event(egui::Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
}

fn click(window: &mut Window, position: Pos2) {
    window.hover_at(position);
    button(window, position, PointerButton::Primary, true);
    button(window, position, PointerButton::Primary, false);
    // Long enough for the next click not to be the second of a double click.
    for _ in 0..8 {
        window.step();
    }
    settle(window);
}

fn drag(window: &mut Window, from: Pos2, to: Pos2, with: PointerButton) {
    window.hover_at(from);
    button(window, from, with, true);
    for k in 1..=5 {
        window.hover_at(from.lerp(to, k as f32 / 5.0));
    }
    window.step();
    button(window, to, with, false);
    window.step();
    settle(window);
}

/// Two pairs on the sample: `p` near the top left, `q` near the bottom right.
fn click_two_pairs(window: &mut Window) {
    for (x, y) in [(-0.2, -0.2), (0.2, 0.25)] {
        for side in Side::BOTH {
            let position = at(window, side, if side == Side::Left { x } else { x - 0.05 }, y);
            click(window, position);
        }
    }
}

/// Where a point appears in a fitting image.
fn screen(window: &Window, at: PointRef) -> Pos2 {
    let document = window.state().document();
    let offset = document.point(at).unwrap() - document.frame(at.side).unwrap().centre();
    let scale = fitting_scale(window, at.side);
    pane(window, at.side).center() + vec2(offset.x as f32, offset.y as f32) * scale
}

const P_LEFT: PointRef = PointRef { pair: 0, side: Side::Left };

fn point(window: &Window, at: PointRef) -> Point {
    window.state().document().point(at).unwrap()
}

/// A file that is removed with its folder.
struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn image(&self, name: &str, width: u32, height: u32) -> PathBuf {
        let path = self.0.path().join(name);
        image::GrayImage::from_fn(width, height, |x, y| image::Luma([(x * 7 + y * 13) as u8]))
            .save(&path)
            .unwrap();
        path
    }

    fn text(&self, name: &str) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, "not an image").unwrap();
        path
    }
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn drop_files(window: &mut Window, paths: &[PathBuf]) {
    for path in paths {
        window.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
    }
    window.step();
    settle(window);
}

fn open(paths: [PathBuf; 2]) -> Window {
    let [left, right] = paths;
    window(Start { opening: Opening::Files(left, right), ..Start::default() }, services())
}

#[test]
fn the_sample_opens_and_the_window_says_what_to_do() {
    let window = sample();
    assert!(window.state().document().pictures.is_some());
    window.get_by_label_contains("Click a distinct point in the left image");
    window.get_by_label("Show me");
}

#[test]
fn two_clicked_pairs_give_the_geometry() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let inspector = window.state();
    assert_eq!(inspector.document().pairs.len(), 2);
    let estimate = inspector.estimate().expect("an estimate");
    for pair in &inspector.document().pairs {
        assert!(symmetric_epipolar_distance(&estimate.fundamental, pair) < 1e-6);
    }
    window.get_by_label_contains("Epipolar geometry found from pairs p and q");
}

#[test]
fn the_sentence_follows_the_clicks() {
    let mut window = sample();
    let left = at(&window, Side::Left, 0.1, 0.1);
    click(&mut window, left);
    window.get_by_label_contains("Pair p: now click the same scene point in the right image");
    let right = at(&window, Side::Right, 0.1, 0.1);
    click(&mut window, right);
    window.get_by_label_contains("One more pair: click pair q");
}

#[test]
fn show_me_places_two_pairs_and_undo_takes_them_back() {
    let mut window = sample();
    window.get_by_label("Show me").click();
    settle(&mut window);
    assert_eq!(window.state().document().pairs.len(), 2);
    assert!(window.state().estimate().is_some());
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert!(window.state().document().pairs.is_empty());
    assert!(window.state().estimate().is_none());
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    settle(&mut window);
    assert_eq!(window.state().document().pairs.len(), 2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    settle(&mut window);
    assert_eq!(window.state().document().pairs.len(), 2);
}

#[test]
fn a_drag_moves_by_the_whole_way_and_is_one_step() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let (before, estimate) = (point(&window, P_LEFT), window.state().estimate().unwrap().fundamental);
    let from = screen(&window, P_LEFT);
    // Grabbed beside its centre, it must not jump.
    let grab = from + vec2(3.0, 2.0);
    drag(&mut window, grab, grab + vec2(40.25, -20.5), PointerButton::Primary);
    let moved = screen(&window, P_LEFT) - from;
    assert!((moved - vec2(40.25, -20.5)).length() < 0.02, "{moved:?}");
    assert_ne!(window.state().estimate().unwrap().fundamental, estimate);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(point(&window, P_LEFT), before);
    assert_eq!(window.state().estimate().unwrap().fundamental, estimate);
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
    window.key_press_modifiers(Modifiers::SHIFT, Key::ArrowUp);
    settle(&mut window);
    let moved = point(&window, P_LEFT) - before;
    assert!((moved.x - 0.2).abs() < 1e-9 && (moved.y + 1.0).abs() < 1e-9, "{moved:?}");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(point(&window, P_LEFT), before, "a run of nudges is one step");
}

#[test]
fn pairs_are_deleted_by_key_and_in_the_list() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let handle = screen(&window, P_LEFT);
    click(&mut window, handle);
    window.key_press(Key::Delete);
    settle(&mut window);
    assert_eq!(window.state().document().pairs.len(), 1);
    assert!(window.state().estimate().is_none());
    window.get_by_label("Delete pair p").click();
    settle(&mut window);
    assert!(window.state().document().pairs.is_empty());
}

#[test]
fn escape_gives_up_the_first_click_of_a_pair() {
    let mut window = sample();
    let left = at(&window, Side::Left, 0.1, 0.1);
    click(&mut window, left);
    window.key_press(Key::Escape);
    settle(&mut window);
    assert!(window.state().document().half.is_none());
}

#[test]
fn further_pairs_check_the_result() {
    let mut window = sample();
    click_two_pairs(&mut window);
    for side in Side::BOTH {
        let position = at(&window, side, 0.3, -0.3);
        click(&mut window, position);
    }
    window.get_by_label("check");
    window.get_by_label("Three pairs").click();
    settle(&mut window);
    assert_eq!(window.state().document().parameters.method, Method::ThreePoint);
    assert!(window.query_by_label("check").is_none());
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
        let yellow = egui::Color32::from_rgb(240, 228, 66);
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
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert!(window.state().document().half.is_none());
}

#[test]
fn scrolling_zooms_about_the_cursor_and_dragging_moves_the_image() {
    let mut window = sample();
    let position = at(&window, Side::Left, 0.1, 0.1);
    let scroll = |window: &mut Window| {
        window.hover_at(position);
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, 200.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        for _ in 0..10 {
            window.step();
        }
        settle(window);
    };
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
fn files_of_the_command_line_open_with_their_pairs() {
    let files = Files::new();
    let pairs = vec![PointPair::new(5.0, 6.0, 7.0, 8.0), PointPair::new(500.0, 1.0, 1.0, 1.0)];
    let opening = Opening::Files(files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    let window = window(Start { opening, pairs: pairs.clone() }, services());
    assert_eq!(window.state().document().pairs, pairs[..1]);
    assert!(window.state().messages().any(|text| text.contains("lie outside")));
    assert!(window.query_by_label("Show me").is_none());
}

#[test]
fn a_missing_file_is_a_sentence_that_can_be_dismissed() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 64, 48), files.0.path().join("missing.png")]);
    assert!(window.state().messages().any(|text| text.contains("there is no such file")));
    window.get_by_label_contains("Drop two images of the same scene");
    window.get_by_label("Dismiss").click();
    settle(&mut window);
    assert_eq!(window.state().messages().count(), 0);
}

#[test]
fn a_dropped_file_that_is_no_image_leaves_the_session_as_it_was() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = window.state().document().clone();
    drop_files(&mut window, &[files.text("a.txt"), files.image("b.png", 64, 48)]);
    assert!(window.state().messages().any(|text| text.contains("not an image in a known format")));
    assert_eq!(window.state().document(), &before);
    assert!(window.state().estimate().is_some());
}

#[test]
fn two_dropped_files_open_and_one_waits_for_the_other() {
    let files = Files::new();
    let mut window = sample();
    let (a, b) = (files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    drop_files(&mut window, &[a.clone(), b.clone()]);
    let names = |window: &Window| {
        let pictures = window.state().document().pictures.clone().unwrap();
        pictures.map(|picture| picture.name)
    };
    assert_eq!(names(&window), ["a.png", "b.png"]);
    drop_files(&mut window, std::slice::from_ref(&b));
    assert_eq!(names(&window), ["a.png", "b.png"]);
    window.get_by_label("Open images");
    drop_files(&mut window, &[a]);
    assert_eq!(names(&window), ["b.png", "a.png"]);
}

#[test]
fn typed_paths_open() {
    let files = Files::new();
    let mut window = sample();
    window.key_press_modifiers(Modifiers::COMMAND, Key::O);
    settle(&mut window);
    for (label, name) in [("Left image", "left.png"), ("Right image", "right.png")] {
        let field = window.get_by_role_and_label(egui::accesskit::Role::TextInput, label);
        field.focus();
        window.step();
        let path = files.image(name, 40, 30).display().to_string();
        window.get_by_role_and_label(egui::accesskit::Role::TextInput, label).type_text(&path);
        window.step();
    }
    window.get_by_label("Open these").click();
    settle(&mut window);
    let pictures = window.state().document().pictures.clone().unwrap();
    assert_eq!(pictures.map(|picture| picture.name), ["left.png", "right.png"]);
}

#[test]
fn a_file_dialog_that_cannot_open_is_told() {
    let mut window = sample();
    window.get_by_label("Open").click();
    settle(&mut window);
    window.get_by_label("Browse for the left image").click();
    settle(&mut window);
    assert!(window.state().messages().any(|text| text.contains("file dialog could not be opened here")));
}

#[test]
fn typing_does_not_run_commands() {
    let mut window = sample();
    click_two_pairs(&mut window);
    window.get_by_label("Open").click();
    settle(&mut window);
    window.key_press(Key::Delete);
    window.key_press(Key::S);
    settle(&mut window);
    assert_eq!(window.state().document().pairs.len(), 2);
    window.key_press(Key::Escape);
    settle(&mut window);
    assert!(window.query_by_label("Open these").is_none());
}

#[test]
fn extreme_images_can_be_clicked() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 1, 1), files.image("b.png", 12_000, 200)]);
    for side in Side::BOTH {
        let position = at(&window, side, 0.0, 0.0);
        click(&mut window, position);
    }
    assert_eq!(window.state().document().pairs.len(), 1);
    // Zooming in brings tiles of the full resolution.
    window.hover_at(at(&window, Side::Right, 0.1, 0.0));
    for _ in 0..6 {
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, 200.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        for _ in 0..5 {
            window.step();
        }
    }
    window.run();
}

#[test]
fn a_failing_and_a_panicking_computation_are_told_and_the_points_stay() {
    let calls = Arc::new(AtomicUsize::new(0));
    let mut services = services();
    services.estimate =
        Box::new(move |_, _, pairs, parameters, _| match calls.fetch_add(1, Ordering::Relaxed) {
            0 => Err(EstimateError::NoGeometry),
            1 => panic!("index out of range"),
            _ => fake_estimate(pairs, parameters),
        });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window.get_by_label_contains("no epipolar geometry was found");
    window.key_press(Key::F5);
    settle(&mut window);
    window.get_by_label_contains("stopped unexpectedly (index out of range)");
    assert_eq!(window.state().document().pairs.len(), 2);
    window.key_press(Key::F5);
    settle(&mut window);
    window.get_by_label_contains("Epipolar geometry found");
}

#[test]
fn the_window_stays_live_while_computing_and_shows_only_the_newest_result() {
    let gate = Arc::new(AtomicUsize::new(0));
    let mut services = services();
    services.estimate = Box::new({
        let gate = Arc::clone(&gate);
        move |_, _, pairs, parameters, _| {
            while gate.load(Ordering::Relaxed) == 0 {
                std::thread::sleep(Duration::from_millis(1));
            }
            fake_estimate(pairs, parameters)
        }
    });
    let mut window = window(Start::default(), services);
    window.get_by_label("Show me").click();
    window.step();
    window.step();
    assert!(window.state().is_busy());
    window.get_by_label_contains("Estimating. Points can be dragged");
    window.get_by_label("Stop");
    // Dragging goes on while the computation is held up.
    let from = screen(&window, P_LEFT);
    window.hover_at(from);
    button(&window, from, PointerButton::Primary, true);
    for k in 1..=10 {
        window.hover_at(from + vec2(3.0 * k as f32, 0.0));
    }
    window.step();
    let moved = (screen(&window, P_LEFT) - from).x;
    assert!((moved - 30.0).abs() < 0.1, "{moved}");
    gate.store(1, Ordering::Relaxed);
    button(&window, from + vec2(30.0, 0.0), PointerButton::Primary, false);
    settle(&mut window);
    let inspector = window.state();
    let estimate = inspector.estimate().expect("an estimate");
    for pair in &inspector.document().pairs {
        assert!(symmetric_epipolar_distance(&estimate.fundamental, pair) < 1e-6);
    }
}

#[test]
fn stop_ends_the_computation() {
    let mut services = services();
    services.estimate = Box::new(|_, _, pairs, parameters, _| {
        std::thread::sleep(Duration::from_millis(300));
        fake_estimate(pairs, parameters)
    });
    let mut window = window(Start::default(), services);
    window.key_press(Key::S);
    window.step();
    window.step();
    window.get_by_label("Stop").click();
    window.step();
    window.step();
    assert!(!window.state().is_busy());
    std::thread::sleep(Duration::from_millis(400));
    settle(&mut window);
    assert!(window.state().estimate().is_none());
    window.key_press(Key::F5);
    settle(&mut window);
    assert!(window.state().estimate().is_some());
}

#[test]
fn overlays_keys_and_themes_can_be_switched() {
    let mut window = sample();
    click_two_pairs(&mut window);
    window.key_press(Key::Questionmark);
    settle(&mut window);
    window.get_by_label("Keys and mouse");
    window.key_press(Key::Escape);
    settle(&mut window);
    assert!(window.query_by_label("Keys and mouse").is_none());
    let dark = window.ctx.theme();
    window.key_press(Key::T);
    settle(&mut window);
    assert_ne!(window.ctx.theme(), dark);
    window.get_by_label("Show").click();
    settle(&mut window);
    window.get_by_label("Points").click();
    settle(&mut window);
    window.get_by_label("Epipoles").click();
    settle(&mut window);
}

#[test]
fn a_small_window_and_a_large_one_hold_everything() {
    for size in [vec2(720.0, 480.0), vec2(1920.0, 1080.0)] {
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
