//! The scene of a calibrated pair: orbit, points under the cursor, and the way back to the pictures.

use crate::exchange::export;
use crate::support::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, Shape, TouchPhase, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::camera::{CameraModel, RelativePose, ViewPair};
use epiline::estimate::{Estimate, Reason, RefinedMatch, Trust, Verdict};
use epiline::geometry::{Frame, Point, PointPair};
use epiline::internals::app::model::document::Side;
use epiline::internals::app::model::focus::Target;
use epiline::internals::app::model::ids::StageId;
use epiline::internals::app::{Opening, Services, Start};
use epiline::io::GeometryFile;
use nalgebra::{Rotation3, Vector3};

const FRAME: Frame = Frame { width: 320, height: 240 };
const CAMERA: [f64; 4] = [250.0, 160.0, 120.0, -0.2];
const POINTS: usize = 40;

/// An estimator that finds the geometry of two cameras and their exact matches of scene points.
fn exact() -> Services {
    let camera = CameraModel::from_colmap("SIMPLE_RADIAL", &CAMERA).unwrap();
    let views = ViewPair::new([&camera; 2], [FRAME; 2]).unwrap();
    let rotation = Rotation3::from_euler_angles(0.02, -0.1, 0.01);
    let pose = RelativePose { rotation, translation: Vector3::new(-1.0, 0.1, 0.1).normalize() };
    let calibrations = views.calibrations();
    let pixel = |k: usize, place: Vector3<f64>| {
        let seen = calibrations[k] * place;
        Point::new(seen.x / seen.z, seen.y / seen.z)
    };
    let matches = (0..POINTS).map(|k| {
        let k = k as f64;
        let place = Vector3::new((k * 0.7).sin() * 1.6, (k * 1.9).cos() * 1.2, 6.0 + (k * 0.4).sin());
        let there = pose.rotation * place + pose.translation;
        let pair = PointPair { point1: pixel(0, place), point2: pixel(1, there) };
        RefinedMatch { pair, correlation: 1.0 }
    });
    let matches: Vec<RefinedMatch> = matches.collect();
    let fundamental = pose.fundamental(&calibrations).unwrap();
    Services {
        estimate: Box::new(move |request, _| {
            let found = fake_estimate(&request.pairs, &request.parameters)?;
            let mut assessment = found.assessment.clone();
            assessment.refinement.as_mut().unwrap().matches.clone_from(&matches);
            Ok(Estimate { fundamental, assessment, ..found })
        }),
        ..services()
    }
}

fn calibrated(services: Services) -> Window {
    let files = Files::new();
    let path = files.0.path().join("cameras.txt");
    std::fs::write(&path, "1 SIMPLE_RADIAL 320 240 250 160 120 -0.2\n").unwrap();
    let opening = Opening::Files(files.image("a.png", 320, 240), files.image("b.png", 320, 240));
    let pairs = vec![PointPair::new(30.0, 40.0, 50.0, 42.0), PointPair::new(250.0, 200.0, 270.0, 190.0)];
    let mut window = window(Start { opening, imports: vec![path], pairs }, services);
    settle(&mut window);
    window
}

/// The places of the points on the screen, far ones first.
fn drawn(window: &Window) -> Vec<Pos2> {
    let stage = window.get_by_label("3-D scene").rect();
    let clipped =
        window.output().shapes.iter().filter(|clipped| stage.expand(1.0).contains_rect(clipped.clip_rect));
    let mesh = clipped.filter_map(|clipped| match &clipped.shape {
        Shape::Mesh(mesh) if mesh.texture_id == egui::TextureId::default() => Some(mesh.clone()),
        _ => None,
    });
    let mesh = mesh.max_by_key(|mesh| mesh.vertices.len()).unwrap();
    mesh.vertices.chunks(4).map(|corners| corners[0].pos.lerp(corners[3].pos, 0.5)).collect()
}

fn stage(window: &Window) -> StageId {
    window.state().model().stage()
}

#[test]
fn the_scene_of_a_calibrated_pair_turns_and_leads_back_to_the_pictures() {
    let mut window = calibrated(exact());
    press(&mut window, Key::Num7);
    assert_eq!(stage(&window), StageId::Scene);
    let fitted = drawn(&window);
    assert_eq!(fitted.len(), POINTS);
    let rect = window.get_by_label("3-D scene").rect();
    assert!(fitted.iter().all(|at| rect.contains(*at)));
    let scene = window.state().model().scene().unwrap();
    assert!(scene.cloud.points.iter().all(|point| (4.9..7.1).contains(&point.place.z)));

    // A drag turns the scene, a right drag moves it, the wheel zooms, and F fits it again.
    drag(&mut window, rect.center(), rect.center() + vec2(45.0, 10.0), PointerButton::Primary);
    let turned = drawn(&window);
    assert!(fitted.iter().zip(&turned).any(|(a, b)| a.distance(*b) > 10.0));
    drag(&mut window, rect.center(), rect.center() + vec2(15.0, 0.0), PointerButton::Secondary);
    let moved = drawn(&window);
    assert!(turned.iter().zip(&moved).all(|(a, b)| b.x > a.x && (b.y - a.y).abs() < 1.0));
    let spread = |places: &[Pos2]| egui::Rect::from_points(places).width();
    window.hover_at(rect.center());
    window.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, -60.0),
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    for _ in 0..10 {
        window.step();
    }
    settle(&mut window);
    assert!(spread(&drawn(&window)) < 0.9 * spread(&moved));
    press(&mut window, Key::F);
    assert_eq!(drawn(&window), fitted);

    // The front point is the one under the cursor. A click shows it in the pictures.
    let at = *fitted.last().unwrap();
    window.hover_at(at);
    settle(&mut window);
    let Some(Target::Match(number)) = window.state().focus().hovered() else { panic!("no match") };
    let text = window.state().model().pointed_in_scene().unwrap();
    assert!(text.starts_with(&format!("Match {}   depth ", number + 1)), "{text}");
    click(&mut window, at);
    assert_eq!(stage(&window), StageId::Pictures);
    let model = window.state().model();
    let pair = model.open.computation.result().unwrap().0.matches()[number].pair;
    let lines = model.pinned().next().unwrap().1.lines;
    for side in Side::BOTH {
        assert!(lines[side.index()].line().distance(side.point(&pair)) < 1e-6);
    }
}

#[test]
fn without_a_determined_epipole_there_is_no_scene_and_no_pose() {
    let mut services = exact();
    let mut estimate = services.estimate;
    services.estimate = Box::new(move |request, monitor| {
        let mut found = estimate(request, monitor)?;
        let reasons = vec![Reason::NoRelief { along: 3, across: 4, on_warp: 400 }];
        found.assessment.trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
        Ok(found)
    });
    let mut window = calibrated(services);
    press(&mut window, Key::Num7);
    assert_eq!(stage(&window), StageId::Scene);
    assert!(painted(&window, "The epipole is not determined, so there is no baseline and no depth."));
    assert!(window.state().model().scene().is_none() && !painted(&window, "±"));
    assert!(window.query_by_label("Rotation").is_none());
    press(&mut window, Key::Num5);
    show_hypotheses(&mut window);
    assert!(
        painted(&window, "not determined"),
        "the result in the table has no other epipole than the verdict"
    );
}

#[test]
fn the_scene_waits_for_the_final_verdict() {
    let go_on = Arc::new(AtomicBool::new(true));
    let mut services = exact();
    let mut estimate = services.estimate;
    services.estimate = Box::new({
        let go_on = Arc::clone(&go_on);
        move |request, monitor| {
            while !go_on.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(1));
            }
            estimate(request, monitor)
        }
    });
    let mut window = calibrated(services);
    tap(&mut window, "Row of pair p");
    press(&mut window, Key::Num7);
    assert!(window.state().model().scene().is_some());
    go_on.store(false, Ordering::Relaxed);
    window.key_press(Key::ArrowRight);
    for _ in 0..4 {
        window.step();
    }
    assert_eq!(stage(&window), StageId::Scene);
    assert!(window.state().estimate().is_some() && window.state().model().scene().is_none());
    assert!(painted(&window, "The 3-D points appear once the search has ended."));
    go_on.store(true, Ordering::Relaxed);
    settle(&mut window);
    assert!(window.state().model().scene().is_some());
}

#[test]
fn typed_focal_lengths_give_a_scene_and_leave_the_geometry() {
    let files = Files::new();
    let opening = Opening::Files(files.image("a.png", 320, 240), files.image("b.png", 320, 240));
    let pairs = vec![PointPair::new(30.0, 40.0, 50.0, 42.0), PointPair::new(250.0, 200.0, 270.0, 190.0)];
    let mut window = window(Start { opening, pairs, ..Start::default() }, exact());
    settle(&mut window);
    save_as(&mut window, &files.0.path().join("before.json"));
    assert!(!window.state().model().has_unsaved_work());
    let fundamental = |window: &Window| *window.state().model().shown().unwrap().fundamental;
    let before = fundamental(&window);
    press(&mut window, Key::Num7);
    assert_eq!(stage(&window), StageId::Pictures);
    window.get_by_role_and_label(Role::TextInput, "Left image").focus();
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Left image").type_text("-3");
    settle(&mut window);
    assert_eq!(window.get_all_by_label("not a positive number").count(), 2, "the left one counts for both");
    let is_bad = |clipped: &egui::epaint::ClippedShape| match &clipped.shape {
        egui::Shape::Text(text) if text.galley.text() == "not a positive number" => {
            let own = text.galley.job.sections[0].format.color;
            own.r() > own.g() + 60 && own.r() > own.b() + 60
        }
        _ => false,
    };
    assert!(window.output().shapes.iter().any(is_bad), "in the colour of errors");
    window.get_by_label("included in the uncertainty of the pose");
    press(&mut window, Key::Enter);
    assert_eq!(stage(&window), StageId::Pictures, "nothing to use yet");
    for (name, text) in [("Left image", "300.25"), ("Known to ±", "2")] {
        window.get_by_role_and_label(Role::TextInput, name).focus();
        window.key_press_modifiers(Modifiers::COMMAND, Key::A);
        window.step();
        window.get_by_role_and_label(Role::TextInput, name).type_text(text);
        window.step();
    }
    window.get_by_label("that of the left image: sees 56° from left to right");
    tap(&mut window, "Use");
    assert_eq!(stage(&window), StageId::Scene);
    assert!(window.state().model().has_unsaved_work(), "somebody typed them");
    run_command(&mut window, "Focal lengths");
    for (name, text) in [("Left image", "300.25"), ("Right image", "300.25"), ("Known to ±", "2")] {
        let field = window.get_by_role_and_label(Role::TextInput, name).accesskit_node().value();
        assert_eq!(field.as_deref(), Some(text), "to the digit");
    }
    press(&mut window, Key::Escape);
    let deviation = window.state().model().scene().unwrap().focal_deviation();
    assert!((deviation - 0.02).abs() < 1e-12, "{deviation}");
    let path = files.0.path().join("geometry.json");
    export(&mut window, &["Geometry"], &path);
    assert!(std::fs::read_to_string(&path).unwrap().contains("guesses, known to 2 %"));
    assert_eq!(fundamental(&window), before);
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    let mut again =
        self::window(Start { opening: Opening::Session(path.into()), ..Start::default() }, exact());
    settle(&mut again);
    assert!(again.state().model().open.views().is_some());
}

#[test]
fn the_scene_asks_for_cameras_and_goes_with_its_pictures() {
    let mut window = sample();
    assert!(window.get_by_label("3-D").accesskit_node().is_disabled(), "without a geometry");
    click_two_pairs(&mut window);
    tap(&mut window, "3-D");
    assert_eq!(stage(&window), StageId::Pictures);
    window.get_by_label("Focal lengths");
    // Neither the keyboard nor the mouse reaches the window behind the dialog.
    for _ in 0..8 {
        press(&mut window, Key::Tab);
        assert!(!window.get_by_label("3-D").is_focused() && !window.get_by_label("Open").is_focused());
    }
    let pairs = window.state().document().pairs.clone();
    for side in Side::BOTH {
        click_at(&mut window, side, 0.35, -0.4);
    }
    assert!(window.state().document().pairs == pairs && window.state().document().half.is_none());
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Focal lengths").is_none());

    let mut window = calibrated(exact());
    tap(&mut window, "3-D");
    assert_eq!(stage(&window), StageId::Scene);
    assert!(window.state().model().scene().is_some());

    // It goes with its pictures.
    let others = Files::new();
    drop_files(&mut window, &[others.image("c.png", 320, 240), others.image("d.png", 320, 240)]);
    assert!(window.state().model().scene().is_none());
    assert_eq!(stage(&window), StageId::Pictures);
}

#[test]
fn the_key_of_the_scene_asks_for_focal_lengths_only_where_the_switch_offers_it() {
    let mut window = sample();
    press(&mut window, Key::Num7);
    assert!(window.query_by_label("Focal lengths").is_none());
    window.get_by_label_contains("There are no 3-D points yet.");
    assert_eq!(window.state().messages().count(), 0, "a hint that fades");
    click_two_pairs(&mut window);
    press(&mut window, Key::Num7);
    window.get_by_label("Focal lengths");
}

#[test]
fn the_scene_and_its_pose_are_exported() {
    let files = Files::new();
    let mut window = calibrated(exact());
    let path = files.0.path().join("scene.ply");
    export(&mut window, &["3-D points"], &path);
    let scene = window.state().model().scene().unwrap();
    let (pose, points) = (scene.fit.pose, scene.cloud.points.len());
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(
        points > 10 && text.starts_with("ply\n") && text.contains(&format!("{points} scene points")),
        "{text}"
    );
    let path = files.0.path().join("geometry.json");
    export(&mut window, &["Geometry"], &path);
    let cameras = GeometryFile::read(&path).unwrap().0.cameras.unwrap();
    let centre = cameras[1].centre();
    assert!((centre.xyz() / centre.w - pose.position2()).norm() < 1e-9);
    // An imported geometry and its undo leave the scene, and its cameras in the file.
    let matrix = files.0.path().join("F.txt");
    std::fs::write(&matrix, "0 0 0\n0 0 -1\n0 1 0\n").unwrap();
    drop_files(&mut window, &[matrix]);
    settle(&mut window);
    tap(&mut window, "Import matrix");
    assert!(window.state().document().imported.is_some());
    undo(&mut window);
    assert!(window.state().document().imported.is_none());
    export(&mut window, &["Geometry"], &path);
    assert!(GeometryFile::read(&path).unwrap().0.cameras.is_some());
    let path = files.0.path().join("report.txt");
    export(&mut window, &["Report", "Plain text"], &path);
    assert!(std::fs::read_to_string(&path).unwrap().contains("Relative pose"));
    // Without focal lengths there is nothing to write, and the dialog says why.
    let mut bare = sample();
    click_two_pairs(&mut bare);
    press_with(&mut bare, Modifiers::COMMAND, Key::E);
    assert!(bare.get_by_label("3-D points").accesskit_node().is_disabled());
}
