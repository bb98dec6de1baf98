//! Saving a session, opening it again, and what a crash leaves behind.

use crate::support::*;

use std::path::Path;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use epiline::camera::{CameraModel, Lens};
use epiline::estimate::{Match, Parameters};
use epiline::geometry::{Point, PointPair};
use epiline::image::Picture;
use epiline::internals::app::model::document::{Document, LineSource, Side};
use epiline::internals::app::model::recents::Recents;
use epiline::internals::app::model::session::{OpenSession, SessionOwner, Work};
use epiline::internals::app::{Opening, Services, Start};
use epiline::io::SessionFile;
use epiline::study::Question;
use nalgebra::Matrix3;

/// What a person made: everything but which pictures and which point is selected.
fn made(window: &Window) -> Document {
    Document { pictures: None, selection: None, ..window.state().document().clone() }
}

fn pairs() -> Vec<PointPair> {
    vec![PointPair::new(5.25, 6.5, 7.125, 8.0), PointPair::new(40.0, 31.5, 33.0, 30.0625)]
}

/// Two images with two pairs, a pin and a check point left out.
fn worked(files: &Files) -> Window {
    let opening = Opening::Files(files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    let mut all = pairs();
    all.push(PointPair::new(20.0, 20.0, 20.0, 20.0));
    let mut window = window(Start { opening, pairs: all, ..Start::default() }, services());
    window.key_press(Key::I);
    click_at(&mut window, Side::Left, 0.1, 0.1);
    assert_eq!(window.state().document().pins.len(), 1);
    window
}

#[test]
fn a_session_comes_back_as_it_was_saved() {
    let files = Files::new();
    let mut window = worked(&files);
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    assert!(path.exists(), "{:?}", window.state().messages().collect::<Vec<_>>());
    let again = reopened(path.clone());
    assert_eq!(made(&again), made(&window));
    let sources =
        |window: &Window| window.state().document().pins.iter().map(|p| p.source).collect::<Vec<_>>();
    assert_eq!(sources(&again), sources(&window));
    assert_eq!(again.state().look(), window.state().look());
    assert!(again.state().estimate().is_some(), "the geometry is computed again");
    // Other programs find F where results have it.
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("\"fundamental\"") && text.contains("\"path\": \"a.png\""), "{text}");
    // Dropped on a window that shows something else, too.
    let mut other = sample();
    drop_files(&mut other, &[path]);
    assert_eq!(made(&other), made(&window));
}

#[test]
fn a_search_of_another_program_is_made_again_and_belongs_to_no_file() {
    let files = Files::new();
    let picture = |name| Picture::open(&files.image(name, 64, 48)).unwrap();
    // One picture is a file, the other only pixels.
    let mut pictures = [picture("a.png"), picture("b.png")];
    pictures[1].path = None;
    let of = |pair, prior| Match { pair, sigma: 1.5, prior };
    let given = [of(PointPair::new(5.0, 6.0, 7.0, 8.0), 0.5), of(PointPair::new(9.0, 6.0, 9.0, 8.0), 0.9)];
    let parameters = Parameters { seed: 7, ..Parameters::default() };
    let camera =
        CameraModel::new(&Matrix3::new(90.0, 0.0, 31.5, 0.0, 90.0, 23.5, 0.0, 0.0, 1.0), Lens::IDEAL);
    let clicks = pairs();
    for (clicks, cameras) in [(&clicks[..], None), (&[], camera.map(|camera| [camera; 2]))] {
        let question = Question { clicks, given: Some(&given), parameters: &parameters };
        let work = Work::of_question(&question, cameras, 0);
        let path = SessionFile::hand_over(pictures.each_ref(), work, files.0.path()).unwrap();
        let session = OpenSession { owner: SessionOwner::Caller, ..path.clone().into() };
        let start = Start { opening: Opening::Session(session), ..Start::default() };
        let mut window = window(start, services());
        let document = window.state().document();
        assert_eq!((&document.pairs[..], document.parameters.seed), (clicks, 7));
        assert_eq!(document.given.as_ref().unwrap().matches[..], given);
        assert_eq!(window.state().model().open.views().is_some(), cameras.is_some());
        // The stand-in for the search needs clicks. Without any, the images are asked.
        assert_eq!(
            (window.state().estimate().is_some(), document.unclicked),
            (cameras.is_none(), cameras.is_some())
        );
        assert!(
            !window.state().model().has_unsaved_work() && *window.state().recents() == Recents::default()
        );
        // The file of the caller is not saved to.
        std::fs::remove_file(path).unwrap();
        press_with(&mut window, Modifiers::COMMAND, Key::S);
        assert!(window.query_by_label("Save session").is_some());
    }
}

#[test]
fn the_sample_can_be_saved_as_well() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let path = files.0.path().join("sample.json");
    save_as(&mut window, &path);
    let again = reopened(path);
    assert_eq!(made(&again), made(&window));
    assert_eq!(again.state().document().pairs.len(), 2);
}

#[test]
fn saving_again_goes_to_the_same_file_and_failure_loses_nothing() {
    let files = Files::new();
    let mut window = worked(&files);
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    window.key_press(Key::Escape);
    click_at(&mut window, Side::Left, -0.2, 0.2);
    press_with(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(made(&reopened(path)), made(&window));
    let before = made(&window);
    save_as(&mut window, &files.0.path().join("no/such/folder/work.json"));
    assert!(window.state().messages().any(|text| text.contains("was not saved")));
    assert_eq!(made(&window), before);
}

#[test]
fn a_moved_image_is_asked_for_and_found() {
    let files = Files::new();
    let mut window = worked(&files);
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    let there = files.0.path().join("renamed.png");
    std::fs::rename(files.0.path().join("a.png"), &there).unwrap();
    let mut again = reopened(path);
    again.get_by_label_contains("The left image was not found");
    assert!(again.query_by_label_contains("The right image").is_none());
    drop_files(&mut again, &[there]);
    tap(&mut again, "Open with these");
    assert_eq!(made(&again), made(&window));
}

#[test]
fn a_changed_image_is_taken_only_when_a_person_says_so() {
    let files = Files::new();
    let mut window = worked(&files);
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    // Smaller than before: one point is outside now.
    files.image("b.png", 30, 70);
    let mut again = reopened(path);
    again.get_by_label_contains("The right image has changed since the session was saved");
    assert!(again.state().document().pairs.is_empty());
    tap(&mut again, "Open with these");
    again.get_by_label_contains("The right image has changed since the session was saved");
    tap(&mut again, "Use changed images as they are");
    assert_eq!(again.state().document().pairs.len(), 3);
    assert_eq!(again.state().document().pairs[1].point2, Point::new(29.5, 30.0625));
    assert!(again.state().messages().any(|text| text.contains("The size of an image has changed")));
}

#[test]
fn files_that_are_no_sessions_change_nothing() {
    let files = Files::new();
    let mut window = worked(&files);
    let before = window.state().document().clone();
    for (text, words) in [
        ("{}", "is not a session of Epiline"),
        ("{\"format\": \"epiline-session\", \"version\": 99}", "saved by a newer Epiline"),
        ("{\"format\": \"epiline-session\", \"version\": 1}", "is damaged"),
    ] {
        let path = files.0.path().join("s.json");
        std::fs::write(&path, text).unwrap();
        drop_files(&mut window, &[path]);
        assert!(window.state().messages().any(|message| message.contains(words)), "{words}");
        assert_eq!(window.state().document(), &before);
    }
}

fn with_copies(folder: &Path) -> Services {
    Services { copies: Some(folder.to_owned()), ..services() }
}

#[test]
fn the_offer_of_unsaved_work_counts_pinned_lines() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let opening = Opening::Files(files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    let start = Start { opening, pairs: pairs(), ..Start::default() };
    let mut crashed = window(start, with_copies(copies.path()));
    press(&mut crashed, Key::I);
    for y in [-0.1, 0.2] {
        click_at(&mut crashed, Side::Left, 0.3, y);
    }
    assert_eq!(crashed.state().document().pins.len(), 2);
    // The copy is written at most two seconds later.
    std::thread::sleep(std::time::Duration::from_secs(2));
    settle(&mut crashed);
    drop(crashed);
    let next = window(Start::default(), with_copies(copies.path()));
    let says = "2 point pairs and 2 pinned line pairs on a.png and b.png were not saved";
    next.get_by_label_contains(says);
}

#[test]
fn unsaved_work_is_offered_after_a_crash() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let opening = || Opening::Files(files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    let crashed =
        window(Start { opening: opening(), pairs: pairs(), ..Start::default() }, with_copies(copies.path()));
    let before = made(&crashed);
    // Dropping the window without closing it is what a crash leaves: the copy stays, its lock goes.
    drop(crashed);
    let mut next = window(Start::default(), with_copies(copies.path()));
    next.get_by_label_contains("2 point pairs on a.png and b.png were not saved");
    tap(&mut next, "Restore");
    assert_eq!(made(&next), before);
    assert_eq!(next.state().messages().count(), 0);
    // Taken over: it is this window's own now, and a crash of this one offers it again.
    drop(next);
    let mut last = window(Start::default(), with_copies(copies.path()));
    // Once a person works on other pictures, the dialog for opening files has the offer.
    click_at(&mut last, Side::Left, 0.1, 0.1);
    assert!(last.query_by_label("Restore").is_none());
    press_with(&mut last, Modifiers::COMMAND, Key::O);
    last.get_by_label("Restore");
    tap(&mut last, "Delete it");
    assert!(last.query_by_label("Restore").is_none() && last.query_by_label("Open these").is_some());
    // Closes the dialog, then removes the point.
    press(&mut last, Key::Escape);
    press(&mut last, Key::Escape);
    drop(last);
    let clean = window(Start::default(), with_copies(copies.path()));
    assert!(clean.state().model().left_behind.is_empty());
}

#[test]
fn a_search_without_clicks_is_no_unsaved_work() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let opening = Opening::Files(files.image("a.png", 640, 480), files.image("b.png", 640, 480));
    let services = Services {
        estimate: Box::new(|request, _| fake_estimate(&pairs(), &request.parameters)),
        ..with_copies(copies.path())
    };
    let mut window = window(Start { opening, ..Start::default() }, services);
    tap(&mut window, "Find without clicks");
    assert!(window.state().document().is_unclicked());
    choose(&mut window, "Help", "Open the sample pictures");
    assert_eq!(window.state().messages().count(), 0, "{:?}", window.state().messages().next());
    assert!(window.state().model().left_behind.is_empty());
    assert!(!window.state().model().has_unsaved_work(), "the sample has its cameras from the start");
}

#[test]
fn pins_of_a_file_are_numbers_and_lines_that_exist_and_old_ones_get_numbers() {
    let files = Files::new();
    let opening = Opening::Files(files.image("a.png", 320, 240), files.image("b.png", 320, 240));
    let mut made = window(Start { opening, pairs: pairs(), ..Start::default() }, services());
    let path = files.0.path().join("work.json");
    save_as(&mut made, &path);
    let saved = std::fs::read_to_string(&path).unwrap();
    let opened = |content: &str, old: &str| {
        let mut session: serde_json::Value = serde_json::from_str(&saved).unwrap();
        session["content"]["document"]["pins"] = serde_json::from_str(content).unwrap();
        session["content"]["pins"] = serde_json::from_str(old).unwrap();
        std::fs::write(&path, session.to_string()).unwrap();
        let mut again =
            window(Start { opening: Opening::Session(path.clone().into()), ..Start::default() }, services());
        settle(&mut again);
        let pins = again.state().document().pins.iter();
        pins.map(|pin| (pin.number, pin.source)).collect::<Vec<_>>()
    };
    let hostile = r#"[{"source": {"pair": 0}, "number": 18446744073709551615}, {"source": {"pair": 1}, "number": 3},
        {"source": {"pair": 0}, "number": 3}, {"source": {"pair": 9}, "number": 4}]"#;
    assert_eq!(opened(hostile, "[]"), [(3, LineSource::Pair(1))]);
    let old = r#"[{"pair": 1}, {"pair": 0}]"#;
    assert_eq!(opened("[]", old), [(0, LineSource::Pair(1)), (1, LineSource::Pair(0))]);
}

#[test]
fn a_long_line_about_unsaved_work_is_wrapped() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let [left, right] = ["A", "B"].map(|end| format!("a-rather-long-name-of-an-image-{end}.png"));
    let opening = Opening::Files(files.image(&left, 64, 48), files.image(&right, 50, 70));
    let start = Start { opening, pairs: pairs(), ..Start::default() };
    drop(window(start, with_copies(copies.path())));
    let mut next = window(Start::default(), with_copies(copies.path()));
    click_at(&mut next, Side::Left, 0.1, 0.1);
    press_with(&mut next, Modifiers::COMMAND, Key::O);
    let whole = next.output().shapes.iter().any(|clipped| match &clipped.shape {
        egui::Shape::Text(text) => {
            text.galley.text().contains("were not saved.")
                && !text.galley.elided
                && text.galley.rows.len() > 1
        }
        _ => false,
    });
    assert!(whole);
}

#[test]
fn what_is_saved_leaves_no_copy() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let opening = Opening::Files(files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    let mut first = window(Start { opening, pairs: pairs(), ..Start::default() }, with_copies(copies.path()));
    save_as(&mut first, &files.0.path().join("work.json"));
    first.state_mut().close();
    drop(first);
    let next = window(Start::default(), with_copies(copies.path()));
    assert!(next.state().model().left_behind.is_empty());
}

#[test]
fn opening_something_else_keeps_what_is_not_saved() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let opening = Opening::Files(files.image("a.png", 64, 48), files.image("b.png", 50, 70));
    let start = Start { opening, pairs: pairs(), ..Start::default() };
    let mut window = window(start, with_copies(copies.path()));
    let before = made(&window);
    choose(&mut window, "Help", "Open the sample pictures");
    assert!(window.state().document().pairs.is_empty());
    window.get_by_label_contains("a.png and b.png were not saved");
    // There and back again; the sample has nothing that would be a loss.
    tap(&mut window, "Restore");
    assert_eq!(made(&window), before);
    assert_eq!(window.state().messages().count(), 0);
}

#[test]
fn a_session_that_another_window_saved_is_not_replaced_without_asking() {
    let files = Files::new();
    let mut first = worked(&files);
    let path = files.0.path().join("work.json");
    save_as(&mut first, &path);
    let mut second = reopened(path.clone());
    second.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    click_at(&mut second, Side::Left, -0.2, 0.2);
    press_with(&mut second, Modifiers::COMMAND, Key::S);
    assert_eq!(second.state().messages().count(), 0);
    let theirs = std::fs::read_to_string(&path).unwrap();
    first.key_press(Key::Escape);
    click_at(&mut first, Side::Right, 0.2, 0.3);
    press_with(&mut first, Modifiers::COMMAND, Key::S);
    assert!(first.state().messages().any(|text| text.contains("has changed since this window read it")));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), theirs);
    tap(&mut first, "Replace");
    assert_eq!(made(&reopened(path)), made(&first));
    assert_eq!(first.state().messages().count(), 0);
}

#[test]
fn a_session_never_takes_the_name_of_an_image() {
    let files = Files::new();
    let mut window = worked(&files);
    let image = files.0.path().join("b.png");
    let before = std::fs::read(&image).unwrap();
    save_as(&mut window, &image);
    assert_eq!(std::fs::read(&image).unwrap(), before);
    assert!(files.0.path().join("b.png.json").exists());
}

#[test]
fn clicks_on_the_sample_are_kept_too_when_other_images_are_opened() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let mut window = window(Start::default(), with_copies(copies.path()));
    tap(&mut window, "Show me how the lines are found");
    let both = [files.image("a.png", 64, 48), files.image("b.png", 50, 70)];
    drop_files(&mut window, &both);
    assert!(window.state().model().left_behind.is_empty(), "what the program placed is no loss");
    choose(&mut window, "Help", "Open the sample pictures");
    click_at(&mut window, Side::Left, 0.1, 0.1);
    click_at(&mut window, Side::Right, 0.1, 0.1);
    let before = made(&window);
    drop_files(&mut window, &both);
    let offer = &window.state().model().left_behind[0].text;
    assert!(
        offer.starts_with("1 point pair on the sample ") && offer.ends_with(" was not saved."),
        "{offer}"
    );
    tap(&mut window, "Restore");
    assert_eq!(made(&window).pairs, before.pairs);
}

#[test]
fn files_of_one_name_are_no_sample() {
    let (files, others, copies) = (Files::new(), Files::new(), tempfile::tempdir().unwrap());
    let mut window = window(Start::default(), with_copies(copies.path()));
    drop_files(&mut window, &[files.image("a.png", 64, 48), others.image("a.png", 50, 70)]);
    click_at(&mut window, Side::Left, 0.1, 0.1);
    click_at(&mut window, Side::Right, 0.1, 0.1);
    drop_files(&mut window, &[files.image("b.png", 64, 48), files.image("c.png", 50, 70)]);
    let offers = &window.state().model().left_behind;
    assert!(offers.iter().any(|copy| copy.text.contains("1 point pair on a.png and a.png was not")));
}

#[test]
fn what_was_done_is_told_for_a_while() {
    let files = Files::new();
    let mut window = worked(&files);
    save_as(&mut window, &files.0.path().join("work.json"));
    window.get_by_label_contains("Saved ");
    // Nine seconds.
    for _ in 0..180 {
        window.step();
    }
    assert!(window.query_by_label_contains("Saved ").is_none());
}

#[test]
fn all_unsaved_work_stays_and_is_listed() {
    let (files, copies) = (Files::new(), tempfile::tempdir().unwrap());
    let [a, b, c, d] = ["a.png", "b.png", "c.png", "d.png"].map(|name| files.image(name, 64, 48));
    let start = Start { opening: Opening::Files(a, b), pairs: pairs(), ..Start::default() };
    let mut window = window(start, with_copies(copies.path()));
    let path = files.0.path().join("my.json");
    save_as(&mut window, &path);
    let one_more = |window: &mut Window| {
        click_at(window, Side::Left, 0.1, 0.1);
        click_at(window, Side::Right, 0.1, 0.1);
    };
    one_more(&mut window);
    drop_files(&mut window, &[c, d]);
    one_more(&mut window);
    // The session itself has two pairs.
    drop_files(&mut window, &[path]);
    assert_eq!(window.state().document().pairs.len(), 2);
    press_with(&mut window, Modifiers::COMMAND, Key::O);
    assert_eq!(window.get_all_by_label("Restore").count(), 2);
    window.get_by_label_contains("3 point pairs on a.png and b.png");
    window.get_by_label_contains("1 point pair on c.png and d.png");
    // What is restored is this window's own, and the other one stays.
    window.get_all_by_label("Restore").last().unwrap().click();
    settle(&mut window);
    assert_eq!(window.state().document().pairs.len(), 3);
    press_with(&mut window, Modifiers::COMMAND, Key::O);
    assert_eq!(window.get_all_by_label("Restore").count(), 1);
    window.get_by_label_contains("1 point pair on c.png and d.png");
    // Without an answer, both are there after the end of the program.
    drop(window);
    let next = crate::support::window(Start::default(), with_copies(copies.path()));
    assert_eq!(next.state().model().left_behind.len(), 2);
}
