//! A folder of images: any two as a pair, and points that are kept per pair.

use crate::support::*;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use epiline::internals::app::model::document::{Document, Side};
use epiline::internals::app::{Opening, Services, Start};

fn folder(count: usize) -> Files {
    let files = Files::new();
    for number in 1..=count {
        files.image(&format!("shot{number}.png"), 60, 40);
    }
    files
}

fn opened(files: &Files, services: Services) -> Window {
    window(Start { opening: Opening::Folder(files.0.path().to_owned()), ..Start::default() }, services)
}

fn names(window: &Window) -> [String; 2] {
    window.state().document().pictures.as_ref().unwrap().each_ref().map(|picture| picture.name.clone())
}

fn made(window: &Window) -> Document {
    Document { pictures: None, selection: None, ..window.state().document().clone() }
}

fn one_pair(window: &mut Window, x: f32) {
    for side in Side::BOTH {
        click_at(window, side, x, 0.1);
    }
}

#[test]
fn any_two_images_of_a_folder_open_and_the_bar_has_room_for_their_choice() {
    let files = folder(4);
    let mut window = opened(&files, services());
    tap(&mut window, "The right view");
    tap(&mut window, "shot4");
    assert_eq!(names(&window), ["shot1.png", "shot4.png"]);
    tap(&mut window, "The left view");
    tap(&mut window, "shot3");
    assert_eq!(names(&window), ["shot3.png", "shot4.png"]);
    assert_eq!(window.state().messages().count(), 0);
    window.set_size(egui::vec2(1024.0, 640.0));
    settle(&mut window);
    let [scene, overlays] = ["3-D", "Overlays"].map(|name| window.get_by_label(name).rect());
    assert!(scene.max.x <= overlays.min.x, "{scene:?} {overlays:?}");
}

#[test]
fn points_stay_with_their_pair_while_others_are_looked_at() {
    let (files, copies) = (folder(4), tempfile::tempdir().unwrap());
    let with_copies = || Services { copies: Some(copies.path().to_owned()), ..services() };
    let mut window = opened(&files, with_copies());
    one_pair(&mut window, 0.1);
    let first = made(&window);
    assert_eq!(first.pairs.len(), 1);
    press(&mut window, Key::PageDown);
    assert!(made(&window).pairs.is_empty());
    assert_eq!(window.state().messages().count(), 0, "nothing is lost, so nothing is told");
    one_pair(&mut window, -0.2);
    one_pair(&mut window, 0.2);
    let second = made(&window);
    press(&mut window, Key::PageUp);
    assert_eq!(made(&window), first);
    // Each entry tells what is on the pair that it opens.
    tap(&mut window, "The right view");
    tap(&mut window, "shot2  (1 point)");
    // The other one is offered, with what is on it.
    tap(&mut window, "Pairs with work (1)");
    tap(&mut window, "shot2 and shot3: 2 point pairs");
    assert_eq!(made(&window), second);
    // A crash leaves all of it behind, once the copy of it is due.
    std::thread::sleep(std::time::Duration::from_millis(2100));
    settle(&mut window);
    drop(window);
    let mut next = crate::support::window(Start::default(), with_copies());
    next.get_by_label_contains("3 point pairs on ");
    tap(&mut next, "Restore");
    assert_eq!(made(&next), second);
    press(&mut next, Key::PageUp);
    assert_eq!(made(&next), first);
}

#[test]
fn one_session_has_the_points_of_all_pairs() {
    let files = folder(3);
    let mut window = opened(&files, services());
    one_pair(&mut window, 0.1);
    let first = made(&window);
    press(&mut window, Key::PageDown);
    one_pair(&mut window, -0.2);
    let second = made(&window);
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    assert!(!window.state().model().has_unsaved_work());
    // Looking at the other pair changes nothing, a click there does.
    press(&mut window, Key::PageUp);
    assert!(!window.state().model().has_unsaved_work(), "{}", window.state().model().title());
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(!text.contains(&*files.0.path().to_string_lossy()), "paths are relative to the session");

    let mut again = reopened(path.clone());
    assert_eq!(again.state().messages().count(), 0);
    assert_eq!(made(&again), second);
    assert!(!again.state().model().has_unsaved_work());
    press(&mut again, Key::PageUp);
    assert_eq!(made(&again), first);
    assert!(!again.state().model().has_unsaved_work());
    one_pair(&mut again, 0.3);
    press(&mut again, Key::PageDown);
    assert!(again.state().model().has_unsaved_work());
    press_with(&mut again, Modifiers::COMMAND, Key::S);
    let mut last = reopened(path.clone());
    press(&mut last, Key::PageUp);
    assert_eq!(made(&last).pairs.len(), 2);

    // A session from before there were lists, and one whose folder has lost an image.
    let mut value: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    std::fs::remove_file(files.0.path().join("shot1.png")).unwrap();
    let mut without = reopened(path.clone());
    assert_eq!(made(&without), second);
    save_as(&mut without, &path);
    let kept: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert_eq!(
        kept["content"]["album"]["pairs"], value["content"]["album"]["pairs"],
        "what cannot be shown stays"
    );
    value["content"].as_object_mut().unwrap().remove("album");
    std::fs::write(&path, value.to_string()).unwrap();
    let old = reopened(path);
    assert_eq!(made(&old), second);
    assert_eq!(old.state().messages().count(), 0);
}
