//! Figures for a paper: both images with what is drawn over them, as SVG and PDF.

use crate::exchange::export;
use crate::support::*;

use egui::Key;
use egui_kittest::kittest::Queryable;
use epiline::estimate::Estimate;
use epiline::geometry::FundamentalMatrix;
use epiline::internals::app::Start;
use epiline::internals::app::model::document::Side;
use nalgebra::Matrix3;

#[test]
fn a_figure_has_the_images_with_lines_and_letters() {
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
        bytes.starts_with(b"%PDF-") && count("/Subtype /Image") == 2 && count("/FontFile2 ") == 1,
        "the images, and the font"
    );
    assert!(count(" l\nS") >= 8, "the lines of two pairs with their edges in both images");
    let text = String::from_utf8_lossy(&bytes);
    for name in ['p', 'q'] {
        // The number of the letter in the font that is in the file, and where it is written.
        let letter = format!("> <{:04X}>", u32::from(name));
        let number = text.lines().find_map(|line| line.strip_suffix(&letter)?.strip_prefix('<')).unwrap();
        let number = u8::from_str_radix(number, 16).unwrap();
        let second = match number {
            8..=10 => ["b", "t", "n"][usize::from(number) - 8].to_owned(),
            12 => "f".to_owned(),
            13 => "r".to_owned(),
            _ => format!("{number:03o}"),
        };
        let written = format!("(\\000\\{second}) Tj");
        assert_eq!(count(&written), 2, "{name} is named in both images");
    }
    assert_eq!(count("/Subject (The geometry is "), 1);
}

/// The estimator with hypotheses whose epipoles are at infinity.
fn with_far_hypotheses() -> Window {
    let mut services = rich_services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
        let mut trace = estimate.trace.as_deref().cloned().unwrap();
        let rows = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 5.0);
        trace.hypotheses = vec![Estimate::from(FundamentalMatrix::from_rank_two(rows).unwrap())];
        estimate.trace = Some(trace.into());
        Ok(estimate)
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window
}

#[test]
fn a_figure_has_no_mark_of_what_is_selected_or_outside() {
    let files = Files::new();
    let mut window = with_far_hypotheses();
    let handle = screen(&window, P_LEFT);
    click(&mut window, handle);
    assert!(window.state().document().selection.is_some());
    let path = files.0.path().join("figure.svg");
    export(&mut window, &["Figure"], &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let circles: Vec<_> = text.lines().filter(|line| line.starts_with("<circle")).collect();
    assert!(circles.iter().any(|circle| circle.contains("r=\"6.50\"")), "the points are there");
    assert!(circles.iter().all(|circle| !circle.contains("r=\"10.00\"")), "{circles:?}");
    assert!(!text.contains("#b871f2"), "an arrow to an epipole outside");
    let widths = |text: &str, color: &str| {
        let lines = text.lines().filter(|line| line.starts_with("<line") && line.contains(color));
        lines.filter_map(|line| line.split("stroke-width=").nth(1).map(str::to_owned)).collect::<Vec<_>>()
    };
    let widths = widths(&text, "#1fc798");
    assert!(widths.len() >= 4 && widths.iter().all(|width| *width == widths[0]), "{widths:?}");
}

#[test]
fn marks_of_the_search_are_on_a_figure_that_asks_for_them() {
    let files = Files::new();
    let mut services = rich_services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
        let mut trace = estimate.trace.as_deref().cloned().unwrap();
        // Both epipoles at (300, 200), in the image.
        let skew = nalgebra::Vector3::new(300.0, 200.0, 1.0).cross_matrix();
        trace.hypotheses = vec![Estimate::from(FundamentalMatrix::from_rank_two(skew).unwrap())];
        estimate.trace = Some(trace.into());
        Ok(estimate)
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    show_hypotheses(&mut window);
    let path = files.0.path().join("figure.svg");
    let mut areas = |choices: &[&str]| {
        export(&mut window, choices, &path);
        std::fs::read_to_string(&path).unwrap().matches("<polygon ").count()
    };
    let plain = areas(&["Figure"]);
    // Two halves of a diamond and its edge, in both images.
    assert_eq!(areas(&["Figure", "Hypotheses on the figure"]), plain + 6);
    // What the window does not show cannot be chosen.
    assert_eq!(areas(&["Figure", "Hypotheses on the figure", "Points on the figure"]), plain);
    press(&mut window, Key::Escape);
    press_with(&mut window, egui::Modifiers::COMMAND, Key::E);
    assert_eq!(window.query_all_by_label("Matches on the figure").count(), 0);
}

#[test]
fn the_number_of_a_pin_is_in_the_part_that_is_seen() {
    let files = Files::new();
    let mut window = sample();
    click_two_pairs(&mut window);
    press(&mut window, Key::I);
    let place = at(&window, Side::Left, 0.25, 0.2);
    click(&mut window, place);
    press(&mut window, Key::I);
    press(&mut window, Key::L);
    for _ in 0..6 {
        scroll(&mut window, place);
    }
    for side in Side::BOTH {
        let pane = pane(&window, side);
        let is_inside = |shape: &egui::Shape| {
            matches!(shape, egui::Shape::Text(text) if text.galley.text() == "pin 1"
                && pane.contains_rect(text.galley.rect.translate(text.pos.to_vec2())))
        };
        let shapes = &window.output().shapes;
        // Where the line leaves the part that is seen, there is no number either.
        let in_pane = shapes.iter().filter(|clipped| pane.expand(1.0).contains_rect(clipped.clip_rect));
        assert!(in_pane.into_iter().any(|clipped| is_inside(&clipped.shape)), "{}", side.name());
    }
    let path = files.0.path().join("figure.svg");
    export(&mut window, &["Figure", "Current view"], &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let size = |name: &str, text: &str| -> f32 {
        text.split(&format!("{name}=\""))
            .nth(1)
            .and_then(|rest| rest.split('"').next()?.parse().ok())
            .unwrap()
    };
    let (width, height) = (size("width", &text), size("height", &text));
    let numbers: Vec<_> = text.lines().filter(|line| line.ends_with(">pin 1</text>")).collect();
    assert_eq!(numbers.len(), 2);
    for number in numbers {
        assert!(
            (0.0..width).contains(&size("x", number)) && (0.0..height).contains(&size("y", number)),
            "{number}"
        );
    }
}
