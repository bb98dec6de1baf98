//! Imports that a button begins.

use crate::exchange::{file, imported, rows, told, truth};
use crate::support::*;

use std::sync::Arc;

use egui::Key;
use egui_kittest::kittest::Queryable;
use epiline::internals::app::{Services, Start};

#[test]
fn the_comparison_imports_a_geometry() {
    let files = Files::new();
    let path = file(&files, "F.txt", &rows(&truth().fundamental));
    let services = Services { pick_file: Arc::new(move || Some(path.clone())), ..rich_services() };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    press(&mut window, Key::Num4);
    tap(&mut window, "Import a geometry…");
    tap(&mut window, "Import matrix");
    assert!(imported(&window).is_some());
    window.get_by_label("Geometry: Imported");
    assert!(window.query_by_label("Import a geometry…").is_none());
}

#[test]
fn without_a_file_dialog_the_path_can_be_typed() {
    let mut window = sample();
    click_two_pairs(&mut window);
    press(&mut window, Key::Num4);
    tap(&mut window, "Import a geometry…");
    assert!(told(&window, "file dialog could not be opened here"));
    #[cfg(target_os = "linux")]
    assert!(told(&window, "zenity"));
    window.get_by_label("Import");
}
