//! Ground truth in the window: folders of pairs, true lines and matches, the residuals.

use crate::support::*;

use std::path::Path;

use egui::{Color32, Key, Modifiers, Shape};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::geometry::{Camera, PointPair};
use epiline::internals::app::model::document::LineSource;
use epiline::internals::app::model::document::{Document, Side, TruthSource};
use epiline::internals::app::model::focus::Target;
use epiline::internals::app::{Opening, Services, Start};
use epiline::io::TruthFolder;
use nalgebra::{Matrix3, Matrix3x4, Point3, Rotation3, Vector3};

const TRUE: Color32 = Color32::from_rgb(255, 255, 255);

/// A camera that walks to the right and turns a little, for images of 240 × 180 px.
fn camera(view: usize) -> Camera {
    let step = view as f64;
    let inner = Matrix3::new(200.0, 0.0, 120.0, 0.0, 200.0, 90.0, 0.0, 0.0, 1.0);
    let turn = Rotation3::from_euler_angles(0.01 * step, 0.04 * step, 0.02 * step);
    let outer = Matrix3x4::from_columns(&[
        turn.matrix().column(0).into(),
        turn.matrix().column(1).into(),
        turn.matrix().column(2).into(),
        Vector3::new(-0.3 * step, 0.02 * step, 0.05 * step),
    ]);
    Camera::from_matrix(inner * outer).unwrap()
}

/// A scene point, not on one plane with the others.
fn scene_point(k: usize) -> Point3<f64> {
    let t = k as f64;
    Point3::new((t * 0.9).sin() * 1.6, (t * 1.7).cos() * 1.2, 5.0 + (t * 2.3).sin() * 1.5)
}

/// Scene points of every folder.
const POINTS: usize = 60;

/// A VGG folder of so many views.
fn vgg(views: usize) -> Files {
    let files = Files::new();
    let write = |name: String, text: String| std::fs::write(files.0.path().join(name), text).unwrap();
    for view in 0..views {
        // All images but the first few are the same small file.
        files.image(&format!("set.{view:03}.png"), 240, 180);
        let matrix = camera(view % 7);
        let rows = matrix
            .matrix()
            .row_iter()
            .map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
        write(format!("set.{view:03}.P"), rows.collect::<Vec<_>>().join("\n"));
        let corners = (0..POINTS).map(|k| matrix.project(&scene_point(k)).unwrap());
        let corners: Vec<_> = corners.map(|corner| format!("{} {}", corner.x, corner.y)).collect();
        write(format!("set.{view:03}.corners"), corners.join("\n"));
    }
    let tracks: Vec<_> = (0..POINTS).map(|k| vec![k.to_string(); views].join(" ")).collect();
    write("set.nview-corners".into(), tracks.join("\n"));
    files
}

/// A folder of two pairs.
fn pairs() -> Files {
    let files = Files::new();
    for name in ["first", "second"] {
        for side in ["A", "B"] {
            files.image(&format!("{name}{side}.png"), 240, 180);
        }
        let rows = (0..POINTS).map(|k| {
            let [a, b] = [0, 1].map(|view| camera(view).project(&scene_point(k)).unwrap());
            format!("{} {} {} {}", a.x, a.y, b.x, b.y)
        });
        let rows = rows.collect::<Vec<_>>().join("\n");
        std::fs::write(files.0.path().join(format!("{name}.txt")), rows).unwrap();
    }
    files
}

fn open_folder(path: &Path) -> Window {
    window(Start { opening: Opening::Folder(path.to_owned()), ..Start::default() }, services())
}

/// Opens a VGG folder with two true matches as clicks.
fn open_with_clicks(files: &Files) -> Window {
    let matches = truth(files, [0, 1]).matches;
    let pairs = vec![matches[1], matches[4]];
    let opening = Opening::Folder(files.0.path().to_owned());
    window(Start { opening, pairs, ..Start::default() }, services())
}

fn names(window: &Window) -> [String; 2] {
    window.state().document().pictures.clone().unwrap().map(|picture| picture.name)
}

fn document(window: &Window) -> Document {
    window.state().document().clone()
}

/// The truth that a folder has about a pair.
fn truth(files: &Files, pair: [usize; 2]) -> epiline::io::GroundTruth {
    TruthFolder::open(files.0.path()).unwrap().truth(pair).unwrap()
}

#[test]
fn a_vgg_folder_opens_its_first_pair_and_steps_to_the_others() {
    let files = vgg(4);
    let mut window = open_folder(files.0.path());
    assert_eq!(names(&window), ["set.000.png", "set.001.png"]);
    let views = ["set.000", "set.001"].map(str::to_owned);
    let source = TruthSource::Folder { folder: files.0.path().to_owned(), views };
    assert_eq!(document(&window).truth, Some(source));
    assert!(window.query_by_label("Show me how the lines are found").is_none());
    let legends = |window: &Window| window.query_all_by_label_contains("× true matches").count();
    assert_eq!(legends(&window), 2, "both pictures tell what the crosses are");
    press(&mut window, Key::G);
    assert_eq!(legends(&window), 0);
    press(&mut window, Key::G);
    assert!(window.get_by_label("Previous pair").accesskit_node().is_disabled());
    press(&mut window, Key::PageDown);
    assert_eq!(names(&window), ["set.001.png", "set.002.png"]);
    press(&mut window, Key::PageUp);
    assert_eq!(names(&window), ["set.000.png", "set.001.png"]);
    // Pressed again before the images are there: from the pair on its way, not from the one shown.
    window.key_press(Key::PageDown);
    press(&mut window, Key::PageDown);
    assert_eq!(names(&window), ["set.002.png", "set.003.png"]);
    assert!(window.get_by_label("Next pair").accesskit_node().is_disabled());
    press(&mut window, Key::PageDown);
    assert_eq!(names(&window), ["set.002.png", "set.003.png"]);
    assert_eq!(window.state().messages().count(), 0);
}

#[test]
fn any_two_views_can_be_chosen() {
    let files = vgg(4);
    let mut window = open_folder(files.0.path());
    tap(&mut window, "The right view");
    tap(&mut window, "set.003");
    assert_eq!(names(&window), ["set.000.png", "set.003.png"]);
    // As far apart as these.
    assert!(window.get_by_label("Next pair").accesskit_node().is_disabled());
    tap(&mut window, "The left view");
    tap(&mut window, "set.002");
    assert_eq!(names(&window), ["set.002.png", "set.003.png"]);
}

#[test]
fn a_folder_of_pairs_opens_by_dropping_typing_and_browsing() {
    let (folder, views) = (pairs(), vgg(2));
    let mut window = sample();
    drop_files(&mut window, &[folder.0.path().to_owned()]);
    assert_eq!(names(&window), ["firstA.png", "firstB.png"]);
    press(&mut window, Key::PageDown);
    assert_eq!(names(&window), ["secondA.png", "secondB.png"]);
    tap(&mut window, "The pair");
    tap(&mut window, "first");
    assert_eq!(names(&window), ["firstA.png", "firstB.png"]);

    let typed = |window: &mut Window, label: &str, path: &Path| {
        press_with(window, Modifiers::COMMAND, Key::O);
        window.get_by_role_and_label(egui::accesskit::Role::TextInput, label).focus();
        window.step();
        let field = window.get_by_role_and_label(egui::accesskit::Role::TextInput, label);
        field.type_text(&path.display().to_string());
        window.step();
        tap(window, "Open these");
    };
    typed(&mut window, "Folder", views.0.path());
    assert_eq!(names(&window), ["set.000.png", "set.001.png"]);
    typed(&mut window, "Left image", folder.0.path());
    assert_eq!(names(&window), ["firstA.png", "firstB.png"]);

    let picked = views.0.path().to_owned();
    let services = Services { pick_folder: std::sync::Arc::new(move || Some(picked.clone())), ..services() };
    let mut window = crate::support::window(Start::default(), services);
    tap(&mut window, "Open");
    tap(&mut window, "Browse for the folder");
    tap(&mut window, "Open these");
    assert_eq!(names(&window), ["set.000.png", "set.001.png"]);
}

#[test]
fn a_truth_beside_two_opened_pictures_is_offered() {
    let files = pairs();
    let open = |sides: [&str; 2]| {
        crate::support::open(sides.map(|side| files.0.path().join(format!("first{side}.png"))))
    };
    let mut window = open(["A", "B"]);
    window.get_by_label_contains("Ground truth lies beside the pictures");
    assert!(document(&window).truth.is_none(), "nobody asked for it");
    press(&mut window, Key::G);
    assert!(matches!(document(&window).truth, Some(TruthSource::Folder { .. })));
    // In the other order, it is not the truth of these pictures.
    let mut window = open(["B", "A"]);
    press(&mut window, Key::G);
    assert!(document(&window).truth.is_none());
    window.get_by_label_contains("have no ground truth");
    // What was wrong with these pictures is not told beside others.
    drop_files(&mut window, &["A", "B"].map(|side| files.0.path().join(format!("first{side}.png"))));
    assert!(window.query_by_label_contains("have no ground truth").is_none());
    // A session finds it again.
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    let mut again = reopened(path);
    press(&mut again, Key::G);
    assert!(document(&again).truth.is_some());
}

#[test]
fn a_true_matrix_alone_has_no_true_matches_to_measure_on() {
    let files = Files::new();
    for side in ["A", "B"] {
        files.image(&format!("b{side}.png"), 240, 180);
    }
    std::fs::write(files.0.path().join("b_F.txt"), "0 0 0\n0 0 -1\n0 1 0\n").unwrap();
    let mut window = open_folder(files.0.path());
    click_two_pairs(&mut window);
    press(&mut window, Key::Num4);
    assert!(window.get_by_label("My pairs + true matches").accesskit_node().is_disabled());
    assert!(!window.get_by_label("Symmetric").accesskit_node().is_disabled());
}

#[test]
fn a_pair_with_too_few_true_matches_opens_without_a_true_geometry() {
    let files = pairs();
    let path = files.0.path().join("second.txt");
    let seven: Vec<_> = std::fs::read_to_string(&path).unwrap().lines().take(7).map(str::to_owned).collect();
    std::fs::write(&path, seven.join("\n")).unwrap();
    let mut window = open_folder(files.0.path());
    press(&mut window, Key::PageDown);
    assert_eq!(names(&window), ["secondA.png", "secondB.png"]);
    assert!(document(&window).truth.is_none());
    assert!(window.state().messages().any(|text| text.contains("The pair has no ground truth")));
}

#[test]
fn hostile_folders_are_answered_by_a_sentence_and_change_nothing() {
    let broken = |break_it: &dyn Fn(&Path)| {
        let files = vgg(3);
        break_it(files.0.path());
        files
    };
    let empty = Files::new();
    let cases = [
        (
            broken(&|folder| std::fs::remove_file(folder.join("set.002.P")).unwrap()),
            "set.002.P: there is no such file",
        ),
        (
            broken(&|folder| std::fs::write(folder.join("set.nview-corners"), "0\n1\n").unwrap()),
            "no tracks over two or more views",
        ),
        (
            broken(&|folder| std::fs::write(folder.join("set.001.png"), "not an image").unwrap()),
            "not an image in a known format",
        ),
        (
            broken(&|folder| {
                std::fs::write(folder.join("set.001.P"), "1 0 0 0\n0 1 0 0\n0 0 0 0\n").unwrap();
            }),
            "not a camera",
        ),
        (
            broken(&|folder| {
                std::fs::copy(folder.join("set.000.P"), folder.join("set.001.P")).unwrap();
            }),
            "same centre",
        ),
        (empty, "has no images in it"),
    ];
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = document(&window);
    for (files, expected) in &cases {
        drop_files(&mut window, &[files.0.path().to_owned()]);
        let told: Vec<_> = window.state().messages().map(str::to_owned).collect();
        assert!(told.last().is_some_and(|text| text.contains(expected)), "{expected}: {told:?}");
        assert_eq!(document(&window), before, "{expected}");
        assert!(window.state().estimate().is_some());
    }
    // An image further behind is missed only when it is asked for, and then the pair before it stays.
    let files = broken(&|folder| std::fs::write(folder.join("set.002.png"), "not an image").unwrap());
    drop_files(&mut window, &[files.0.path().to_owned()]);
    press(&mut window, Key::PageDown);
    assert!(
        window
            .state()
            .messages()
            .any(|text| text.contains("The right image") && text.contains("set.002.png"))
    );
    assert_eq!(names(&window), ["set.000.png", "set.001.png"]);
    // The pair is still in use: its ground truth can be switched off.
    assert!(document(&window).truth.is_some());
    press(&mut window, Key::G);
    assert_eq!(document(&window).truth, None);
    let mut window = open_folder(Path::new("no/such/folder"));
    assert!(window.state().messages().any(|text| text.contains("there is no such file or folder")));
    press(&mut window, Key::PageDown);
    window.get_by_label_contains("Drop two images of the same scene");
}

#[test]
fn a_thousand_views_can_be_stepped_through() {
    let files = vgg(1000);
    let mut window = open_folder(files.0.path());
    press(&mut window, Key::PageDown);
    tap(&mut window, "The right view");
    tap(&mut window, "set.004");
    assert_eq!(names(&window), ["set.001.png", "set.004.png"]);
}

#[test]
fn without_ground_truth_its_button_is_greyed_and_says_why() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 64, 48), files.image("b.png", 64, 48)]);
    click_at(&mut window, Side::Left, 0.1, 0.1);
    press(&mut window, Key::Num3);
    window.get_by_label_contains("Distances from the epipolar lines appear here");
    assert!(window.get_by_label("Ground truth").accesskit_node().is_disabled());
    press(&mut window, Key::G);
    assert!(window.state().messages().any(|text| text.contains("open a VGG folder")));
    assert_eq!(document(&window).truth, None);
}

#[test]
fn the_sample_offers_its_truth_and_undo_takes_it_out_of_use() {
    let mut window = sample();
    click_two_pairs(&mut window);
    assert!(lines(&window, Side::Right, TRUE).is_empty());
    press(&mut window, Key::G);
    assert_eq!(document(&window).truth, Some(TruthSource::Sample("courtyard".into())));
    assert!(!lines(&window, Side::Right, TRUE).is_empty());
    undo(&mut window);
    assert_eq!(document(&window).truth, None);
    assert!(lines(&window, Side::Right, TRUE).is_empty());
}

#[test]
fn true_lines_and_matches_are_blue_and_can_be_hidden() {
    let files = vgg(2);
    let window = open_folder(files.0.path());
    // Two arms a mark, and the dashes of the lines.
    assert!(lines(&window, Side::Left, TRUE).len() > 2 * POINTS + 40);
    let mut window = open_with_clicks(&files);
    assert!(lines(&window, Side::Right, TRUE).len() > 2 * POINTS + 40, "dashes");
    tap(&mut window, "Overlays");
    for name in ["Show True lines", "Show True matches"] {
        tap(&mut window, name);
    }
    assert!(lines(&window, Side::Right, TRUE).is_empty());
}

#[test]
fn a_true_match_under_the_cursor_lights_up_in_both_images() {
    let files = vgg(2);
    let mut window = open_folder(files.0.path());
    let known = truth(&files, [0, 1]);
    window.hover_at(screen_of(&window, Side::Left, known.matches[7].point1));
    settle(&mut window);
    let Some(Target::TrueMatch(number)) = window.state().focus().hovered() else { panic!("nothing hovered") };
    let near = screen_of(&window, Side::Right, known.matches[number].point2);
    let ringed =
        window.output().shapes.iter().any(
            |clipped| matches!(&clipped.shape, Shape::Circle(circle) if circle.center.distance(near) < 1.0),
        );
    assert!(ringed, "no ring in the right image");
}

#[test]
fn the_card_states_the_real_error() {
    let files = vgg(2);
    let mut window = open_with_clicks(&files);
    let known = truth(&files, [0, 1]);
    let f = window.state().estimate().unwrap().fundamental();
    let distances = known.matches.iter().map(|pair| epiline::geometry::symmetric_epipolar_distance(f, pair));
    let error = distances.sum::<f64>() / POINTS as f64;
    window.get_by_label("True error");
    window.get_by_label(&format!("{error:.2} px (truth 0.00)"));
    press(&mut window, Key::G);
    assert!(window.query_by_label("True error").is_none());
}

#[test]
fn choosing_another_geometry_shows_it_in_the_whole_window() {
    let files = vgg(2);
    let mut window = open_with_clicks(&files);
    press(&mut window, Key::Num4);
    let known = truth(&files, [0, 1]);
    let result = *window.state().estimate().unwrap().fundamental();
    assert!(shows_lines(&window, &result, ESTIMATED) && !shows_lines(&window, &known.fundamental, ESTIMATED));
    tap(&mut window, "Geometry: 8-point");
    // Fitted to exact matches it is the true one.
    assert!(shows_lines(&window, &known.fundamental, OTHER));
    window.get_by_label_contains("The images show the 8-point geometry, not the result");
    window.get_by_label("0.00 px (truth 0.00)");
    tap(&mut window, "Geometry: Result");
    assert!(shows_lines(&window, &result, ESTIMATED));
    tap(&mut window, "Geometry: Ground truth");
    window.get_by_label_contains("The images show the true geometry, not the result");
    press(&mut window, Key::R);
    assert!(shows_lines(&window, &result, ESTIMATED));
}

#[test]
fn the_residuals_say_how_many_pairs_are_missing_and_count_those_included() {
    let files = vgg(2);
    let known = truth(&files, [0, 1]);
    let mut pairs = known.matches[..9].to_vec();
    pairs[8] = PointPair {
        point1: pairs[8].point1,
        point2: pairs[8].point2 + epiline::geometry::Vector::new(0.0, 30.0),
    };
    let path = |view: usize| files.0.path().join(format!("set.00{view}.png"));
    let opening = || Opening::Files(path(0), path(1));
    let mut window = crate::support::window(
        Start { opening: opening(), pairs: pairs[..2].to_vec(), ..Start::default() },
        services(),
    );
    press(&mut window, Key::Num4);
    window.set_size(egui::vec2(1440.0, 900.0));
    settle(&mut window);
    assert!(painted(&window, "needs 5 more pairs") && painted(&window, "needs 6 more pairs"));
    assert!(window.query_by_label("Geometry: Ground truth").is_some(), "it lies beside the pictures");
    // Where there is no room for a column of it, it is told where the figures would be.
    window.set_size(egui::vec2(1024.0, 640.0));
    settle(&mut window);
    assert!(painted(&window, "7-point: needs 5 more pairs"));
    let mut window =
        crate::support::window(Start { opening: opening(), pairs, ..Start::default() }, services());
    window.set_size(egui::vec2(1440.0, 900.0));
    press(&mut window, Key::Num4);
    assert!(painted(&window, "9 pairs") && !painted(&window, "needs"));
    press(&mut window, Key::Num3);
    // The last pair, which is far off, on top: without it 8-point fits exactly.
    tap(&mut window, "Sort by Point");
    assert!(!painted(&window, "9, check"), "all pairs are used");
    // A click selects the pair, and the list of pairs scrolls to it.
    tap(&mut window, "Residuals of pair 9");
    tap(&mut window, "Leave out pair 9");
    assert!(document(&window).excluded.contains(&8));
    assert!(painted(&window, "9, out"));
    press(&mut window, Key::Num4);
    assert!(painted(&window, "8 pairs"));
    assert_eq!(document(&window).selection.map(|at| at.pair), Some(8));
}

#[test]
fn a_small_window_has_room_for_rows_of_residuals() {
    let files = vgg(2);
    let mut window = open_with_clicks(&files);
    window.set_size(egui::vec2(1024.0, 640.0));
    press(&mut window, Key::Num3);
    let seen = |window: &Window, label: &str| {
        let rows = window.query_all_by_label_contains(label);
        rows.filter(|row| row.rect().max.y <= 640.0 - 22.0 && row.rect().max.x <= 1024.0).count()
    };
    assert!(seen(&window, "True match ") >= 3, "{}", seen(&window, "True match "));
    press(&mut window, Key::Num4);
    assert!(seen(&window, "Geometry: ") >= 2, "{}", seen(&window, "Geometry: "));
    let all = |heading: &str| window.query_all_by_label(heading).count() == 1;
    assert!(all("Sort by Median, px") && all("Sort by < 1 px") && !all("Sort by From"));
}

#[test]
fn the_rows_of_another_result_begin_at_the_top() {
    let files = vgg(2);
    let mut window = open_with_clicks(&files);
    press(&mut window, Key::Num3);
    assert!(painted(&window, "Result, px"), "the unit of the figures");
    let place = window.get_by_label("True match 2").rect().center();
    scroll_by(&mut window, place, -400.0);
    assert!(window.query_by_label("True match 1").is_none(), "scrolled");
    // The same result keeps its place.
    press(&mut window, Key::Num4);
    press(&mut window, Key::Num3);
    assert!(window.query_by_label("True match 1").is_none());
    click_at(&mut window, Side::Left, 0.3, 0.3);
    click_at(&mut window, Side::Right, 0.28, 0.35);
    window.get_by_label("True match 1");
}

#[test]
fn rows_of_true_matches_are_linked_with_the_images() {
    let files = vgg(2);
    let mut window = open_with_clicks(&files);
    press(&mut window, Key::Num3);
    window.hover_at(window.get_by_label("True match 2").rect().center());
    settle(&mut window);
    assert_eq!(window.state().focus().hovered(), Some(Target::TrueMatch(1)));
    tap(&mut window, "True match 2");
    let point = truth(&files, [0, 1]).matches[1].point1;
    let pins: Vec<_> = window.state().document().pins.iter().map(|pin| pin.source).collect();
    assert_eq!(pins, [LineSource::Through { side: Side::Left, point }]);
}
