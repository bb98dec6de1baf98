//! Copying to the clipboard: F as source code, the view as a picture.

use crate::support::*;

use std::sync::Arc;

use egui::{Color32, ColorImage, Event, Key, Modifiers, OutputCommand, ViewportCommand};
use egui_kittest::kittest::Queryable;
use epiline::internals::app::model::document::Side;
use epiline::io::GeometryFile;

/// Runs a command of the palette, and returns the text that it copies.
pub fn copied(window: &mut Window, command: &str) -> Option<String> {
    press_with(window, Modifiers::COMMAND, Key::K);
    window.get_by_label("Search commands").type_text(command);
    settle(window);
    // Only the output of the frame of this event has the text.
    window.event(Event::Key {
        key: Key::Enter,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::NONE,
    });
    window.step();
    window.output().platform_output.commands.iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    })
}

#[test]
fn f_is_copied_as_code_with_its_verdict() {
    let mut window = sample();
    assert_eq!(copied(&mut window, "Copy F as JSON"), None, "there is no F yet");
    press(&mut window, Key::Escape);
    click_two_pairs(&mut window);
    let f = *window.state().estimate().unwrap().fundamental();
    let json = copied(&mut window, "Copy F as JSON").unwrap();
    assert_eq!(GeometryFile::parse(&json).unwrap().0.fundamental, Some(f));
    settle(&mut window);
    window.get_by_label("Copied F as JSON");
    for (command, begin) in [
        ("Copy F as NumPy", "F = np.array(["),
        ("Copy F as C++", "const cv::Matx33d F("),
        ("Copy F as MATLAB", "F = ["),
        ("Copy F as LaTeX", "\\begin{bmatrix}"),
    ] {
        let text = copied(&mut window, command).unwrap();
        assert!(text.contains(begin) && text.contains("The geometry is "), "{command}: {text}");
    }
}

#[test]
fn the_export_dialog_copies_f() {
    let mut window = sample();
    click_two_pairs(&mut window);
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    window.get_all_by_label("Copy F as").last().unwrap().click();
    settle(&mut window);
    tap(&mut window, "NumPy");
    window.get_by_label("Copied F as NumPy");
}

#[test]
fn the_view_is_copied_as_a_picture_of_the_images() {
    let mut window = sample();
    press_with(&mut window, Modifiers::COMMAND, Key::K);
    window.get_by_label("Search commands").type_text("Copy the view");
    settle(&mut window);
    window.key_press(Key::Enter);
    let mut asked = None;
    for _ in 0..6 {
        window.step();
        let commands = window.output().viewport_output.values().flat_map(|viewport| &viewport.commands);
        asked = commands.fold(asked, |asked, command| match command {
            ViewportCommand::Screenshot(callback) => Some(callback.clone()),
            _ => asked,
        });
    }
    let both = pane(&window, Side::Left).union(pane(&window, Side::Right));
    let screen = ColorImage::filled([1280, 848], Color32::from_rgb(1, 2, 3));
    asked.expect("a picture is asked for").complete(Arc::new(screen));
    let mut image = None;
    for _ in 0..4 {
        window.step();
        for command in &window.output().platform_output.commands {
            if let OutputCommand::CopyImage(copied) = command {
                image = Some(copied.clone());
            }
        }
    }
    let image = image.expect("a picture is copied");
    assert!((image.size[0] as f32 - both.width()).abs() < 30.0 && image.size[1] < 700, "{:?}", image.size);
    assert!(image.pixels.iter().all(|pixel| *pixel == Color32::from_rgb(1, 2, 3)));
}
