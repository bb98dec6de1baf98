//! One plane, or a turn of the camera: what of it can be exported.

use crate::support::*;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use epiline::estimate::{Assessment, Estimate, PlaneHomography};
use epiline::internals::app::{Services, Start};
use epiline::io::GeometryFile;
use nalgebra::Matrix3;

const PLANE: PlaneHomography = PlaneHomography {
    homography21: Matrix3::new(1.0, 0.25, 3.0, -0.125, 1.0, 7.5, 0.0, 1e-4, 1.0),
    matches: 90,
    share: 0.9,
    residual: 0.125,
};

fn with_result(plane: Option<PlaneHomography>) -> Window {
    let services = Services {
        estimate: Box::new(move |request, _| {
            let found = fake_estimate(&request.pairs, &request.parameters)?;
            Ok(Estimate { assessment: Assessment { plane, ..found.assessment }, ..found })
        }),
        ..services()
    };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window
}

fn show_export(window: &mut Window) {
    press_with(window, Modifiers::COMMAND, Key::E);
}

#[test]
fn the_homography_of_a_plane_is_exported_where_there_is_one() {
    // By the dialog of all exports, and by the button of the card.
    for by_card in [false, true] {
        let files = Files::new();
        let path = files.0.path().join("plane.json");
        let mut window = with_result(Some(PLANE));
        if by_card {
            tap(&mut window, "Export the homography…");
        } else {
            show_export(&mut window);
            tap(&mut window, "Homography of the plane");
        }
        tap(&mut window, "File");
        window.key_press_modifiers(Modifiers::COMMAND, Key::A);
        window.get_by_label("File").type_text(path.to_str().unwrap());
        settle(&mut window);
        tap(&mut window, "Export file");
        window.get_by_label_contains("Exported the homography of the plane to");
        let (read, _) = GeometryFile::read(&path).unwrap();
        assert_eq!(read.homography21, Some(PLANE.homography21));
        assert_eq!(read.fundamental, None, "what is not determined is not in it");
        assert!(read.images.is_some());
    }
}

#[test]
fn where_there_is_none_it_is_not_offered() {
    let mut window = with_result(None);
    assert!(window.query_by_label("Export the homography…").is_none());
    show_export(&mut window);
    window.get_by_label("Pairs alone");
    assert!(window.query_by_label("Homography of the plane").is_none());
}
