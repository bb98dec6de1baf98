//! Figures for a paper: both images with what is drawn over them, as SVG, PDF and PNG.

use crate::exchange::export;
use crate::support::*;

use epiline::app::model::document::Side;

#[test]
fn a_figure_has_the_images_with_lines_and_letters_or_pixels_of_any_size() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    let path = files.0.path().join("figure.svg");
    export(&mut window, &["Figure"], &path);
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text.matches("data:image/png;base64,").count(), 2, "both images");
    assert!(text.matches("<line ").count() >= 8, "the lines of two pairs with their edges in both images");
    for name in ["p", "q"] {
        assert_eq!(text.matches(&format!(">{name}</text>")).count(), 2, "{name} is named in both images");
    }
    assert!(text.contains("<desc>The geometry is "));
    export(&mut window, &["Figure", "Labels"], &path);
    assert!(!std::fs::read_to_string(&path).unwrap().contains("<text"), "without labels");

    let path = files.0.path().join("figure.pdf");
    export(&mut window, &["Figure", "PDF", "Labels"], &path);
    let bytes = std::fs::read(&path).unwrap();
    let count = |what: &str| bytes.windows(what.len()).filter(|part| *part == what.as_bytes()).count();
    assert!(
        bytes.starts_with(b"%PDF-") && count("/Subtype /Image") == 2 && count("/BaseFont /Helvetica") == 1
    );
    assert!(count(" l\nS") >= 8, "the lines of two pairs with their edges in both images");
    for name in ["p", "q"] {
        assert_eq!(count(&format!("({name}) Tj")), 2, "{name} is named in both images");
    }
    assert_eq!(count("/Subject (The geometry is "), 1);

    let path = files.0.path().join("figure.png");
    export(&mut window, &["Figure", "PNG"], &path);
    let bytes = std::fs::read(&path).unwrap();
    let note = b"Description\0\0\0\0\0The geometry is ";
    assert!(bytes.windows(note.len()).any(|part| part == note), "the file says how far to trust it");
    let full = image::open(&path).unwrap();
    let [left, right] = Side::BOTH.map(|side| window.state().document().frame(side).unwrap());
    assert!((left.width + right.width) as u32 <= full.width() && full.height() >= left.height as u32);
    let green =
        |picture: &image::DynamicImage| picture.to_rgb8().pixels().filter(|p| p.0 == [26, 204, 140]).count();
    assert!(green(&full) > 100, "the lines are on it");
    export(&mut window, &["Figure", "PNG", "Width", "Dark paper"], &path);
    let narrow = image::open(&path).unwrap();
    assert!(narrow.width().abs_diff(1600) <= 1, "{}", narrow.width());
    assert_eq!(narrow.to_rgb8().get_pixel(1, 1).0, [24; 3]);
    export(&mut window, &["Figure", "What is seen"], &path);
    assert!(image::open(&path).is_ok());
}
