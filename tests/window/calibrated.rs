//! A calibration in the window: pictures as they are, lines as curves.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Shape, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::camera::PicturesOf;
use epiline::estimate::{DivisionFit, Trust, Verdict};
use epiline::geometry::{Frame, Point, PointPair, symmetric_epipolar_distance};
use epiline::internals::app::model::document::Side;
use epiline::internals::app::model::suggesting::LensQuestion;
use epiline::internals::app::{Opening, Services, Start};
use epiline::io::GeometryFile;

use crate::clipboard::copied;
use crate::exchange::{export, type_into};
use crate::support::{
    ESTIMATED, Files, Window, click, click_at, drag, drop_files, fake_estimate, pane, press, press_with,
    save_as, services, settle, tap, undo, window,
};

const FRAME: Frame = Frame { width: 320, height: 240 };

fn calibration(files: &Files, width: u32) -> std::path::PathBuf {
    let path = files.0.path().join(format!("cameras-{width}.txt"));
    std::fs::write(&path, format!("1 SIMPLE_RADIAL {width} 240 250 160 120 -0.2\n")).unwrap();
    path
}

fn pairs() -> [PointPair; 2] {
    [PointPair::new(30.0, 40.0, 50.0, 42.0), PointPair::new(250.0, 200.0, 270.0, 190.0)]
}

fn calibrated(files: &Files) -> Window {
    let opening = Opening::Files(files.image("a.png", 320, 240), files.image("b.png", 320, 240));
    let imports = vec![calibration(files, 320)];
    let mut window = window(Start { opening, imports, pairs: pairs().to_vec() }, services());
    settle(&mut window);
    window
}

/// Position on the screen of a pixel of a fitting picture.
fn on_screen(window: &Window, side: Side, pixel: Point) -> Pos2 {
    let rect = pane(window, side);
    let scale = (rect.width() / FRAME.width as f32).min(rect.height() / FRAME.height as f32);
    let offset = pixel - FRAME.centre();
    rect.center() + vec2(offset.x as f32, offset.y as f32) * scale
}

fn is_near(a: &PointPair, b: &PointPair, within: f64) -> bool {
    (a.point1 - b.point1).norm() < within && (a.point2 - b.point2).norm() < within
}

#[test]
fn points_stay_where_they_are_in_the_pictures() {
    let files = Files::new();
    let mut window = calibrated(&files);
    let document = window.state().document();
    let frame = document.frame(Side::Left).unwrap();
    assert!(frame.width > 320 && document.pairs.len() == 2, "{frame:?}");
    // Coordinates of the computation are those without distortion, farther from the middle.
    assert!(document.pairs[0].point1.x < 60.0 && !is_near(&document.pairs[0], &pairs()[0], 5.0));
    for (found, given) in window.state().model().pairs_in_pictures().iter().zip(&pairs()) {
        assert!(is_near(found, given, 1e-6), "{found:?}");
    }
    // A click places a point under the cursor, and a drag moves it with the cursor.
    let third = PointPair::new(280.0, 30.0, 290.0, 35.0);
    for (side, pixel) in [(Side::Left, third.point1), (Side::Right, third.point2)] {
        let at = on_screen(&window, side, pixel);
        click(&mut window, at);
    }
    let found = window.state().model().pairs_in_pictures()[2];
    assert!(is_near(&found, &third, 1e-2), "{found:?}");
    let moved = Point::new(240.0, 60.0);
    let (from, to) = (on_screen(&window, Side::Left, third.point1), on_screen(&window, Side::Left, moved));
    drag(&mut window, from, to, PointerButton::Primary);
    let found = window.state().model().pairs_in_pictures()[2];
    assert!((found.point1 - moved).norm() < 0.1, "{found:?}");
}

#[test]
fn a_pair_of_a_folder_keeps_its_folder_and_its_lens() {
    let files = Files::new();
    for name in ["a.png", "b.png", "c.png"] {
        files.image(name, 320, 240);
    }
    let opening = Opening::Folder(files.0.path().to_owned());
    let mut window = window(Start { opening, pairs: pairs().to_vec(), ..Start::default() }, services());
    let elsewhere = Files::new();
    drop_files(&mut window, &[calibration(&elsewhere, 320)]);
    let open = |window: &Window| window.state().model().folder().map(|(_, pair)| pair);
    let lens = |window: &Window| window.state().model().open.cameras().is_some();
    assert!(open(&window) == Some([0, 1]) && lens(&window));
    let placed = window.state().document().pairs.clone();
    press(&mut window, Key::PageDown);
    assert!(open(&window) == Some([1, 2]) && !lens(&window), "the lens belongs to the first pair");
    press(&mut window, Key::PageUp);
    assert!(open(&window) == Some([0, 1]) && lens(&window));
    assert_eq!(window.state().document().pairs, placed);
    press(&mut window, Key::PageDown);
    // A session knows the lens of a pair that is not open.
    let session = elsewhere.0.path().join("s.json");
    save_as(&mut window, &session);
    let mut again = crate::support::window(
        Start { opening: Opening::Session(session.into()), ..Start::default() },
        services(),
    );
    press(&mut again, Key::PageUp);
    assert!(open(&again) == Some([0, 1]) && lens(&again) && again.state().document().pairs == placed);
}

#[test]
fn epipolar_lines_are_curves_through_their_points() {
    let files = Files::new();
    let mut window = calibrated(&files);
    // The selected pair has its own lines.
    let handle = on_screen(&window, Side::Left, pairs()[0].point1);
    click(&mut window, handle);
    let curves: Vec<Vec<Pos2>> = window
        .output()
        .shapes
        .iter()
        .filter_map(|clipped| match &clipped.shape {
            Shape::Path(path)
                if path.stroke == egui::epaint::PathStroke::new(path.stroke.width, ESTIMATED) =>
            {
                Some(path.points.clone())
            }
            _ => None,
        })
        .collect();
    assert!(curves.len() >= 4, "{} curves", curves.len());
    let bend = |curve: &Vec<Pos2>| {
        let (start, end) = (curve[0], curve[curve.len() - 1]);
        let across = (end - start).normalized().rot90();
        curve.iter().map(|at| (*at - start).dot(across).abs()).fold(0.0, f32::max)
    };
    assert!(curves.iter().map(bend).fold(0.0, f32::max) > 3.0);
    // The curve of a point passes through its match.
    for side in [Side::Left, Side::Right] {
        let pair = pairs()[0];
        let at = on_screen(&window, side, if side == Side::Left { pair.point1 } else { pair.point2 });
        let away = |curve: &Vec<Pos2>| {
            curve
                .windows(2)
                .map(|ends| {
                    let way = ends[1] - ends[0];
                    let t = ((at - ends[0]).dot(way) / way.length_sq()).clamp(0.0, 1.0);
                    (ends[0] + way * t).distance(at)
                })
                .fold(f32::INFINITY, f32::min)
        };
        assert!(curves.iter().map(away).fold(f32::INFINITY, f32::min) < 0.2, "{side:?}");
    }
}

#[test]
fn a_session_keeps_the_calibration_and_another_size_is_refused() {
    let files = Files::new();
    let mut first = calibrated(&files);
    let path = files.0.path().join("work.json");
    save_as(&mut first, &path);
    let again = window(Start { opening: Opening::Session(path.into()), ..Start::default() }, services());
    assert!(again.state().messages().next().is_none(), "{:?}", again.state().messages().collect::<Vec<_>>());
    assert_eq!(again.state().model().open.cameras(), first.state().model().open.cameras());
    for (found, given) in again.state().model().pairs_in_pictures().iter().zip(&pairs()) {
        assert!(is_near(found, given, 1e-6), "{found:?}");
    }
    let before = first.state().document().clone();
    drop_files(&mut first, &[calibration(&files, 640)]);
    assert!(first.state().messages().any(|message| message.contains("is for images of 640×240")));
    assert_eq!(*first.state().document(), before);
}

#[test]
fn files_of_point_pairs_are_places_in_the_pictures() {
    let files = Files::new();
    let mut window = calibrated(&files);
    let model = window.state().model();
    let row = model.copied_pairs().lines().nth(1).unwrap().to_owned();
    let numbers: Vec<f64> = row.split('\t').skip(1).map(|cell| cell.parse().unwrap()).collect();
    assert!(is_near(&PointPair::new(numbers[0], numbers[1], numbers[2], numbers[3]), &pairs()[0], 1e-6));
    let path = files.0.path().join("pairs.txt");
    std::fs::write(&path, "300 20 310 30\n20 220 25 210\n").unwrap();
    drop_files(&mut window, &[path]);
    let found = window.state().model().pairs_in_pictures();
    assert!(is_near(&found[0], &PointPair::new(300.0, 20.0, 310.0, 30.0), 1e-6), "{found:?}");
    assert_eq!(found.len(), 2);
}

#[test]
fn another_calibration_keeps_given_matches_and_the_names_of_pairs() {
    let files = Files::new();
    let mut window = calibrated(&files);
    let in_pictures = |window: &Window| {
        let model = window.state().model();
        let given = model.document.given.as_ref().unwrap();
        given.pairs().map(|pair| model.open.pixels_of(pair)).collect::<Vec<_>>()
    };
    let row = |k| format!("{0} {1} {0} {1}", 20 + k % 280, 20 + k / 2);
    let text = (0..400).map(row).collect::<Vec<_>>().join("\n");
    let path = files.0.path().join("matches.txt");
    std::fs::write(&path, text).unwrap();
    drop_files(&mut window, &[path]);
    settle(&mut window);
    window.event(Event::Paste("name\tx1\ty1\tx2\ty2\ndoor\t200\t100\t190\t101\n".to_owned()));
    settle(&mut window);
    let (given, points) = (in_pictures(&window), window.state().document().pairs[0]);
    assert_eq!((given.len(), window.state().document().pairs.len()), (400, 3));
    let other = files.0.path().join("other.txt");
    std::fs::write(&other, "1 SIMPLE_RADIAL 320 240 250 160 120 -0.1\n").unwrap();
    drop_files(&mut window, &[other]);
    settle(&mut window);
    let document = window.state().document();
    assert!(document.name(2) == "door" && document.pairs[0] != points);
    for (found, given) in window.state().model().pairs_in_pictures().iter().zip(&pairs()) {
        assert!(is_near(found, given, 1e-6), "{found:?}");
    }
    assert!(in_pictures(&window).iter().zip(&given).all(|(found, given)| is_near(found, given, 1e-6)));
}

#[test]
fn the_pose_of_a_calibration_is_an_imported_geometry_with_its_cameras() {
    let files = Files::new();
    let mut window = calibrated(&files);
    let path = files.0.path().join("calib.txt");
    let camera = "[250 0 160; 0 250 120; 0 0 1]";
    let text =
        format!("cam0={camera}\ncam1={camera}\ndoffs=0\nbaseline=100\nwidth=320\nheight=240\nndisp=64\n");
    std::fs::write(&path, text).unwrap();
    drop_files(&mut window, &[path]);
    settle(&mut window);
    let imported = window.state().document().imported.as_ref().unwrap();
    assert!(imported.cameras.is_some() && imported.file == "calib.txt", "{imported:?}");
    // The second camera of a rectified pair is to the right, so lines are rows.
    let line = imported.fundamental.line2_from_point1(Point::new(10.0, 50.0)).unwrap();
    assert!(line.distance(Point::new(300.0, 50.0)) < 1e-6);
}

#[test]
fn a_lens_that_explains_the_matches_better_is_offered_used_and_removed() {
    let files = Files::new();
    let opening = Opening::Files(files.image("a.png", 320, 240), files.image("b.png", 320, 240));
    let lens = |question: &LensQuestion| {
        Some(DivisionFit {
            lambdas: [-0.2; 2],
            deviations: [0.01; 2],
            is_same: true,
            fundamental: *question.found.fundamental(),
            gain: 40.0,
        })
    };
    let mut services = Services { lens: Box::new(lens), ..services() };
    services.estimate = Box::new(|request, _| {
        let mut found = fake_estimate(&request.pairs, &request.parameters)?;
        found.assessment.trust = Some(Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
        Ok(found)
    });
    let mut window = window(Start { opening, imports: Vec::new(), pairs: pairs().to_vec() }, services);
    settle(&mut window);
    click_at(&mut window, Side::Left, 0.1, 0.1);
    press(&mut window, Key::Escape);
    assert!(window.state().model().history.can_undo());
    window.get_by_label("Partly reliable");
    window.get_by_label_contains("The lens bends the lines");
    for (choices, name) in [(&["Report", "Plain text"][..], "r.txt"), (&["Report", "JSON"], "r.json")] {
        let path = files.0.path().join(name);
        export(&mut window, choices, &path);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("partly reliable") && text.contains("The lens bends the lines"), "{text}");
        assert!(name == "r.txt" || text.contains("\"verdict\": \"partly reliable\""), "{text}");
    }
    press(&mut window, Key::I);
    click_at(&mut window, Side::Left, 0.2, 0.2);
    press(&mut window, Key::I);
    let pin = window.state().document().pins[0];
    tap(&mut window, "Details");
    assert!(window.query_by_label_contains("λ -0.200 ± 0.010").is_some());
    window.get_by_label_contains("correct it for exact lines and epipoles");
    tap(&mut window, "Correct the lens distortion");
    let frame = window.state().document().frame(Side::Left).unwrap();
    assert!(frame.width > 320, "{frame:?}");
    for (found, given) in window.state().model().pairs_in_pictures().iter().zip(&pairs()) {
        assert!(is_near(found, given, 1e-6), "{found:?}");
    }
    assert!(window.query_by_label("Correct the lens distortion").is_none(), "it is corrected");
    let moved = window.state().document().pins[0];
    assert!(moved.number == pin.number && moved.source != pin.source, "it stays at its place in the picture");
    // Undo takes it back, redo repeats it, and the lens is offered again.
    undo(&mut window);
    assert_eq!(window.state().document().pins, [pin]);
    assert_eq!(window.state().document().frame(Side::Left), Some(FRAME));
    assert_eq!(window.state().document().pairs, pairs(), "the very points");
    press_with(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!(window.state().document().frame(Side::Left), Some(frame));
    assert_eq!(window.state().document().pins, [moved]);
    // What came after it returns, too.
    click_at(&mut window, Side::Left, 0.1, -0.2);
    let half = window.state().document().half;
    undo(&mut window);
    undo(&mut window);
    assert_eq!(window.state().document().frame(Side::Left), Some(FRAME));
    for _ in 0..3 {
        press_with(&mut window, Modifiers::COMMAND, Key::Y);
    }
    assert!(half.is_some() && window.state().document().half == half);
    undo(&mut window);
    undo(&mut window);
    assert!(window.state().model().history.can_undo(), "the steps before the correction are there");
    undo(&mut window);
    assert!(window.state().document().pins.is_empty());
    undo(&mut window);
    assert!(window.state().document().half.is_some());
    press(&mut window, Key::Escape);
    tap(&mut window, "Correct the lens distortion");
    // The focal lengths are unknown, so a scene asks for them, and the lines stay where they are.
    assert!(window.state().model().scene_question().is_none());
    assert!(window.state().model().open.takes_focal_lengths());
    press_with(&mut window, Modifiers::COMMAND, Key::K);
    window.get_by_label("Search commands").type_text("Remove the lens correction");
    settle(&mut window);
    press(&mut window, Key::Enter);
    let document = window.state().document();
    assert_eq!(document.frame(Side::Left), Some(FRAME));
    assert!(document.pairs.iter().zip(&pairs()).all(|(found, given)| is_near(found, given, 1e-6)));
    // Its removal is a step, too.
    undo(&mut window);
    assert_eq!(window.state().document().frame(Side::Left), Some(frame));
    press_with(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!(window.state().document().frame(Side::Left), Some(FRAME));
    // Guessed focal lengths say nothing of the lens, which is offered all the same, and takes them over.
    press(&mut window, Key::Num7);
    window.get_by_role_and_label(Role::TextInput, "Left image").focus();
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Left image").type_text("300");
    settle(&mut window);
    press(&mut window, Key::Enter);
    press(&mut window, Key::Num5);
    window.get_by_label_contains("correct it for exact lines and epipoles");
    tap(&mut window, "Correct the lens distortion");
    let cameras = window.state().model().open.cameras().unwrap();
    for camera in cameras {
        let focal = camera.focal_length().unwrap();
        assert!((focal.pixels - 300.0).abs() < 1e-9 && (focal.deviation - 0.05).abs() < 1e-12, "{focal:?}");
    }
}

/// Largest distance of the placed pairs, as they are in the pictures, from the lines of a file, px.
fn largest(window: &Window, file: &GeometryFile) -> f64 {
    let (views, f) = (file.pictures.views().expect("the lens is described"), file.geometry().unwrap());
    let in_pictures = window.state().model().pairs_in_pictures();
    let placed = in_pictures.iter().map(|pair| views.undistorted_from_original(pair).unwrap());
    placed.map(|pair| symmetric_epipolar_distance(&f, &pair)).fold(0.0, f64::max)
}

#[test]
fn everything_that_leaves_names_the_lens_and_fits_after_the_mapping() {
    let files = Files::new();
    let mut window = calibrated(&files);
    let json = copied(&mut window, "Copy F as JSON").unwrap();
    assert!(largest(&window, &GeometryFile::parse(&json).unwrap().0) < 0.1, "{json}");
    settle(&mut window);
    window.get_by_label("Copied F of the pictures without distortion as JSON");
    for (command, code) in [
        ("Copy F as NumPy", "cv2.undistortPoints"),
        ("Copy F as C++", "cv::undistortPoints("),
        ("Copy F as MATLAB", "undistorted1 = "),
        ("Copy F as LaTeX", "lens model opencv k1 -0.2"),
    ] {
        let text = copied(&mut window, command).unwrap();
        assert!(text.contains(code) && text.contains("lens model opencv k1 -0.2"), "{command}: {text}");
    }
    settle(&mut window);
    for (kind, name) in
        [("Geometry", "g.json"), ("Report", "r.txt"), ("Table", "t.csv"), ("Profile", "p.csv")]
    {
        let path = files.0.path().join(name);
        if kind == "Profile" {
            press(&mut window, Key::Num2);
        }
        export(&mut window, &[kind], &path);
        let text = std::fs::read_to_string(&path).unwrap();
        let words =
            if kind == "Table" { "belong to the pictures as they are" } else { "model opencv k1 -0.2" };
        assert!(text.contains(words), "{kind}: {text}");
        if kind == "Geometry" {
            assert!(largest(&window, &GeometryFile::parse(&text).unwrap().0) < 0.1);
        }
    }
    // An array has no room for a lens.
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    assert!(window.get_by_label("NumPy array").accesskit_node().is_disabled());
    press(&mut window, Key::Escape);
    let session = files.0.path().join("s.json");
    save_as(&mut window, &session);
    let (file, _) = GeometryFile::read(&session).unwrap();
    assert!(largest(&window, &file) < 0.1);
}

#[test]
fn pictures_without_distortion_are_written_with_their_own_geometry() {
    let files = Files::new();
    let mut window = calibrated(&files);
    let folder = files.0.path().join("flat");
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    tap(&mut window, "Without distortion");
    type_into(&mut window, "Folder", &folder);
    tap(&mut window, "Export pictures");
    settle(&mut window);
    let views = window.state().model().open.views().unwrap();
    let (file, _) = GeometryFile::read(&folder.join("geometry.json")).unwrap();
    assert_eq!(file.pictures, PicturesOf::Original);
    for (name, frame) in ["left.png", "right.png"].iter().zip(views.frames()) {
        let picture = epiline::image::Picture::open(&folder.join(name)).unwrap();
        assert_eq!(picture.frame(), frame);
    }
    assert_eq!(file.images.unwrap()[0].name, "left.png");
    let text = std::fs::read_to_string(folder.join("geometry.json")).unwrap();
    assert!(
        text.contains("drawn_from") && text.contains("\"a.png\"") && text.contains("\"opencv\""),
        "{text}"
    );
}

#[test]
fn a_geometry_of_other_pictures_is_refused_with_its_lens() {
    let files = Files::new();
    let mut window = calibrated(&files);
    let [of_views, of_pictures] = ["views.json", "pictures.json"].map(|name| files.0.path().join(name));
    export(&mut window, &["Geometry"], &of_views);
    let text = std::fs::read_to_string(&of_views).unwrap();
    std::fs::write(&of_pictures, text.replace("\"undistorted\"", "\"original\"")).unwrap();
    let refusal = |window: &mut Window, path: &std::path::PathBuf, words: &str| {
        drop_files(window, std::slice::from_ref(path));
        settle(window);
        let told: Vec<String> = window.state().messages().map(str::to_owned).collect();
        assert!(told.iter().any(|text| text.contains(words)), "{words}: {told:?}");
        assert!(window.query_by_label_contains("Which convention").is_none());
    };
    refusal(
        &mut window,
        &of_pictures,
        "belongs to the pictures as they are, and the lens of these is corrected",
    );
    let opening = Opening::Files(files.image("a.png", 320, 240), files.image("b.png", 320, 240));
    let mut bare = crate::support::window(Start { opening, ..Start::default() }, services());
    refusal(&mut bare, &of_views, "lens model opencv k1 -0.2");
    // In the same pictures its pairs come back to their places.
    drop_files(&mut window, &[of_views]);
    settle(&mut window);
    tap(&mut window, "Import matrix");
    for (found, given) in window.state().model().pairs_in_pictures().iter().zip(&pairs()) {
        assert!(is_near(found, given, 1e-6), "{found:?}");
    }
    let copied = copied(&mut window, "Copy F as JSON").unwrap();
    assert!(copied.contains("imported from views.json, as read, not the result"), "{copied}");
}
