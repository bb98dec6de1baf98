//! Opening pictures, and what happens when that fails.

use crate::support::*;

use std::path::PathBuf;

use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::geometry::PointPair;
use epiline::internals::app::model::document::Side;
use epiline::internals::app::{Opening, Start};

#[test]
fn files_of_the_command_line_open_with_their_pairs() {
    let files = Files::new();
    let pairs = vec![PointPair::new(5.0, 6.0, 7.0, 8.0), PointPair::new(500.0, 1.0, 1.0, 1.0)];
    let opening = Opening::Files(files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    let window = window(Start { opening, pairs: pairs.clone(), ..Start::default() }, services());
    assert_eq!(window.state().document().pairs, pairs[..1]);
    assert!(window.state().messages().any(|text| text.contains("outside the images: 1 of the point pairs")));
    assert!(window.query_by_label("Show me how the lines are found").is_none());
}

#[test]
fn a_missing_file_is_a_sentence_that_can_be_dismissed() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 64, 48), files.0.path().join("missing.png")]);
    assert!(window.state().messages().any(|text| text.contains("there is no such file")));
    // Keys of other stages leave the start panel in view.
    let (before, tool) = (window.state().messages().count(), window.state().model().tool);
    for key in [Key::N, Key::I, Key::Comma, Key::G, Key::Space] {
        press(&mut window, key);
        let model = window.state().model();
        assert!(model.open.replay.moment().is_none() && model.tool == tool, "{key:?}");
    }
    assert_eq!(window.state().messages().count(), before, "no key speaks of images");
    window.get_by_label_contains("Drop two images of the same scene");
    let [pane, all] = [pane(&window, Side::Left).height(), window.ctx.content_rect().height()];
    assert!(pane > 0.5 * all, "room to drop images: {pane} of {all}");
    tap(&mut window, "Dismiss");
    assert_eq!(window.state().messages().count(), 0);
}

#[test]
fn a_dropped_file_that_is_no_image_leaves_the_session_as_it_was() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = window.state().document().clone();
    drop_files(&mut window, &[files.text("a.png"), files.image("b.png", 64, 48)]);
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
    assert!(window.get_by_label("Open these").accesskit_node().is_disabled(), "one image is not enough");
    drop_files(&mut window, &[a]);
    assert_eq!(names(&window), ["b.png", "a.png"]);
}

#[test]
fn swapped_images_keep_their_points() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 320, 240), files.image("b.png", 300, 260)]);
    click_two_pairs(&mut window);
    let before = window.state().document().clone();
    let f = *window.state().estimate().unwrap().fundamental();
    run_command(&mut window, "Swap the images");
    let after = window.state().document();
    let names = after.pictures.clone().unwrap().map(|picture| picture.name);
    assert_eq!(names, ["b.png", "a.png"]);
    assert_eq!(after.pairs, before.pairs.iter().map(|pair| pair.swapped()).collect::<Vec<_>>());
    // The left pane shows the image of the left points.
    let placed = point(&window, P_LEFT);
    assert_eq!(placed, before.pairs[0].point2);
    assert!(*window.state().estimate().unwrap().fundamental() != f, "the result is computed again");
    window.get_by_label_contains("Undo goes back");
    let swapped = after.pairs.clone();
    undo(&mut window);
    settle(&mut window);
    assert_eq!(window.state().document(), &before);
    assert_eq!(point(&window, P_LEFT), before.pairs[0].point1, "the left picture is on the left again");
    assert_eq!(window.state().estimate().unwrap().fundamental(), &f);
    // The clicks can be undone too, and all steps be redone.
    undo(&mut window);
    let document = window.state().document();
    assert_eq!((document.pairs.len(), document.half.map(|half| half.side)), (1, Some(Side::Left)));
    for _ in 0..2 {
        press_with(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    }
    assert_eq!(window.state().document().pairs, swapped);
    assert_eq!(point(&window, P_LEFT), before.pairs[0].point2);
}

#[test]
fn the_fields_stay_where_they_are_when_an_error_appears() {
    let mut window = sample();
    press_with(&mut window, Modifiers::COMMAND, Key::O);
    let role = egui::accesskit::Role::TextInput;
    for label in ["Left image", "Right image"] {
        window.get_by_role_and_label(role, label).focus();
        window.step();
        window.get_by_role_and_label(role, label).type_text("/no/such/picture.png");
        settle(&mut window);
    }
    let place = |window: &Window| window.get_by_role_and_label(role, "Left image").rect();
    let before = place(&window);
    press(&mut window, Key::Enter);
    window.get_by_label_contains("there is no such file");
    assert_eq!(place(&window), before);
}

#[test]
fn typed_paths_open() {
    let files = Files::new();
    let mut window = sample();
    press_with(&mut window, Modifiers::COMMAND, Key::O);
    for (label, name) in [("Left image", "left.png"), ("Right image", "right.png")] {
        let field = window.get_by_role_and_label(egui::accesskit::Role::TextInput, label);
        field.focus();
        window.step();
        let path = files.image(name, 40, 30).display().to_string();
        window.get_by_role_and_label(egui::accesskit::Role::TextInput, label).type_text(&path);
        window.step();
    }
    tap(&mut window, "Open these");
    let pictures = window.state().document().pictures.clone().unwrap();
    assert_eq!(pictures.map(|picture| picture.name), ["left.png", "right.png"]);
}

#[test]
fn after_a_failure_the_field_that_was_typed_in_has_the_focus() {
    let files = Files::new();
    let mut window = sample();
    press_with(&mut window, Modifiers::COMMAND, Key::O);
    let role = egui::accesskit::Role::TextInput;
    window.get_by_role_and_label(role, "Import").focus();
    window.step();
    let path = files.0.path().join("missing.txt").display().to_string();
    window.get_by_role_and_label(role, "Import").type_text(&path);
    window.step();
    press(&mut window, Key::Enter);
    window.get_by_label_contains("missing.txt");
    assert!(window.get_by_role_and_label(role, "Import").is_focused());
}

#[test]
fn an_empty_file_is_called_empty() {
    let files = Files::new();
    let mut window = sample();
    let empty = files.0.path().join("empty.png");
    std::fs::write(&empty, "").unwrap();
    drop_files(&mut window, &[empty, files.image("b.png", 64, 48)]);
    assert!(window.state().messages().any(|text| text.contains("the file is empty")));
}

#[test]
fn a_file_dialog_that_cannot_open_is_told() {
    let mut window = sample();
    tap(&mut window, "Open");
    tap(&mut window, "Browse for the left image");
    assert!(window.state().messages().any(|text| text.contains("file dialog could not be opened here")));
}

#[test]
fn too_small_images_ask_for_others_and_not_for_clicks() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 8, 8), files.image("b.png", 8, 8)]);
    let asks = |window: &Window| {
        window.get_all_by_label_contains("at least 32 × 32 px").next().unwrap();
        window.query_by_label_contains("Find without clicks").is_some() || painted(window, "pairs")
    };
    assert!(!asks(&window));
    click_at(&mut window, Side::Left, 0.0, 0.0);
    click_at(&mut window, Side::Right, 0.0, 0.0);
    assert!(window.query_by_label_contains("Mark one more").is_none());
    assert!(window.query_by_label("Find without clicks").is_none());
}

#[test]
fn extreme_images_can_be_clicked() {
    let files = Files::new();
    let mut window = open([files.image("a.png", 1, 1), files.image("b.png", 12_000, 200)]);
    for side in Side::BOTH {
        click_at(&mut window, side, 0.0, 0.0);
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

/// Opens the dialog and types what its fields get: the first one has the keyboard, Tab goes on.
fn type_paths(window: &mut Window, paths: &[String]) {
    press_with(window, Modifiers::COMMAND, Key::O);
    for (number, path) in paths.iter().enumerate() {
        if number > 0 {
            press(window, Key::Tab);
        }
        window.event(egui::Event::Text(path.clone()));
        settle(window);
    }
    press(window, Key::Enter);
}

fn names(window: &Window) -> [String; 2] {
    window.state().document().pictures.clone().unwrap().map(|picture| picture.name)
}

fn field_text(window: &Window, label: &str) -> Option<String> {
    window.get_by_role_and_label(egui::accesskit::Role::TextInput, label).value()
}

#[test]
fn tab_goes_from_the_left_path_to_the_right_one_and_enter_opens_both() {
    let files = Files::new();
    let mut window = sample();
    let paths = ["a.png", "b.png"].map(|name| files.image(name, 40, 30).display().to_string());
    type_paths(&mut window, &paths);
    assert_eq!(names(&window), ["a.png", "b.png"]);
    assert!(window.query_by_label("Open these").is_none(), "the dialog closes");
}

#[test]
fn one_path_opens_no_mixture_and_says_what_is_missing() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = window.state().document().clone();
    type_paths(&mut window, &[files.image("a.png", 40, 30).display().to_string()]);
    assert_eq!(window.state().document(), &before);
    window.get_by_label_contains("The right image is missing");
}

#[test]
fn an_error_stays_in_the_dialog_with_both_paths() {
    let files = Files::new();
    let mut window = sample();
    let left = files.image("a.png", 40, 30).display().to_string();
    let home = std::env::var("HOME").unwrap();
    type_paths(&mut window, &[left.clone(), "~/not-there-at-all.png".to_owned()]);
    window.get_by_label_contains(&format!("{home}/not-there-at-all.png"));
    assert_eq!(window.state().messages().count(), 0, "it is told once");
    assert_eq!(field_text(&window, "Left image"), Some(left));
    assert_eq!(field_text(&window, "Right image").as_deref(), Some("~/not-there-at-all.png"));
    // Corrected, it goes.
    window.event(egui::Event::Text(String::new()));
    let field = window.get_by_role_and_label(egui::accesskit::Role::TextInput, "Right image");
    field.focus();
    settle(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(egui::Event::Text(files.image("b.png", 40, 30).display().to_string()));
    settle(&mut window);
    press(&mut window, Key::Enter);
    assert_eq!(names(&window), ["a.png", "b.png"]);
}

#[test]
fn a_folder_of_images_opens_its_first_two_and_any_others_on_request() {
    let files = Files::new();
    for number in [1, 2, 10] {
        files.image(&format!("shot{number}.png"), 40, 30);
    }
    files.text("notes.txt");
    let mut window = sample();
    drop_files(&mut window, &[files.0.path().to_owned()]);
    assert_eq!(names(&window), ["shot1.png", "shot2.png"]);
    assert_eq!(window.state().messages().count(), 0);
    press(&mut window, Key::PageDown);
    assert_eq!(names(&window), ["shot2.png", "shot10.png"]);
    tap(&mut window, "The left view");
    tap(&mut window, "shot1");
    assert_eq!(names(&window), ["shot1.png", "shot10.png"]);
    assert!(window.query_by_label("Ground truth").is_none(), "there is nothing known about them");
}

#[test]
fn what_was_opened_last_is_offered_again() {
    let files = Files::new();
    let [a, b, c, d] = ["a.png", "b.png", "c.png", "d.png"].map(|name| files.image(name, 40, 30));
    let mut window = open([a.clone(), b.clone()]);
    drop_files(&mut window, &[c, d]);
    assert_eq!(window.state().document().pictures.as_ref().unwrap()[0].name, "c.png");
    press_with(&mut window, egui::Modifiers::COMMAND, egui::Key::O);
    window.get_by_label_contains("a.png and b.png, in ").click();
    settle(&mut window);
    assert_eq!(window.state().document().pictures.as_ref().unwrap()[0].name, "a.png");
    let kept: Vec<_> = window.state().recents().list().map(<[std::path::PathBuf]>::to_vec).collect();
    assert_eq!(kept.len(), 2);
    assert_eq!(kept[0], [a, b]);
}

/// A picture cut in the middle of its pixels.
fn cut(files: &Files, name: &str) -> PathBuf {
    let path = files.0.path().join(name);
    let pixels = image::GrayImage::from_fn(96, 64, |x, y| image::Luma([(x * 7 + y * y) as u8]));
    pixels.save(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() * 2 / 3]).unwrap();
    path
}

#[test]
fn a_damaged_picture_is_refused_and_nothing_is_changed() {
    let files = Files::new();
    let whole = files.image("whole.png", 80, 60);
    for name in ["cut.jpg", "cut.png"] {
        let mut window = sample();
        click_two_pairs(&mut window);
        let before = window.state().document().clone();
        drop_files(&mut window, &[whole.clone(), cut(&files, name)]);
        assert_eq!(window.state().document().pairs, before.pairs);
        let told: Vec<String> = window.state().messages().map(str::to_owned).collect();
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(
            told[0].contains("The right image") && told[0].contains("is damaged or incomplete"),
            "{told:?}"
        );
    }
}

#[test]
fn in_a_small_window_the_dialog_for_opening_scrolls_and_keeps_its_buttons() {
    let mut window = sample();
    // 1024 x 640 with texts of 1.44 times the size.
    window.set_size(vec2(711.0, 444.0));
    press_with(&mut window, Modifiers::COMMAND, Key::O);
    for label in ["Left image", "Right image"] {
        window.get_by_role_and_label(egui::accesskit::Role::TextInput, label).focus();
        window.step();
        window.get_by_role_and_label(egui::accesskit::Role::TextInput, label).type_text("/no/such/image.png");
        settle(&mut window);
    }
    press(&mut window, Key::Enter);
    let problem = window.get_by_label_contains("there is no such file").rect();
    for rect in [window.get_by_label("Open these").rect(), window.get_by_label("Cancel").rect(), problem] {
        assert!(rect.max.y <= 444.0 && rect.min.y > 0.0, "{rect:?}");
    }
}
