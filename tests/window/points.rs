//! The list of point pairs: selection, names, and tables from and for spreadsheets; what exports say of
//! the pairs and of the geometry.

use crate::support::*;

use std::path::Path;

use egui::{Event, Key, Modifiers, OutputCommand, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use epiline::estimate::{Trust, Verdict};
use epiline::internals::app::Start;
use epiline::internals::app::model::document::Side;
use epiline::io::PairOrigin;

const TABLE: &str =
    "name\tx1\ty1\tx2\ty2\nroof\t300\t100,5\t280\t101\nstep\t200\t200\t190\t201\n\t120\t60\t110\t61\n";

fn paste(window: &mut Window, text: &str) {
    window.event(Event::Paste(text.to_owned()));
    settle(window);
}

#[test]
fn a_table_is_pasted_named_and_copied() {
    let mut window = sample();
    paste(&mut window, TABLE);
    let document = window.state().document();
    assert_eq!(document.pairs.len(), 3);
    assert_eq!((document.name(0).as_str(), document.given_name(2)), ("roof", None));
    assert_eq!((document.pairs[0].point1.y, document.origin(0)), (100.5, PairOrigin::Pasted));
    window.get_by_label_contains("Pasted 3 point pairs");
    unfold(&mut window, "q");
    window.get_by_label("Name of pair q").focus();
    settle(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.get_by_label("Name of pair q").type_text("door");
    settle(&mut window);
    assert_eq!(window.state().document().name(1), "door");
    press(&mut window, Key::Enter);
    window.event(Event::Copy);
    window.step();
    let copied = window.output().platform_output.commands.iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let expected =
        "name\tx1\ty1\tx2\ty2\nroof\t300\t100.5\t280\t101\ndoor\t200\t200\t190\t201\nr\t120\t60\t110\t61\n";
    assert_eq!(copied.as_deref(), Some(expected));
    for _ in 0..2 {
        undo(&mut window);
    }
    assert!(window.state().document().pairs.is_empty(), "a name and a paste are a step each");
}

#[test]
fn a_row_selects_its_pair_which_the_delete_key_removes() {
    let mut window = sample();
    paste(&mut window, TABLE);
    tap(&mut window, "Row of pair p");
    assert_eq!(window.state().document().selected_pair(), Some(0));
    window.get_by_label("Name of pair p");
    // Another click folds it.
    tap(&mut window, "Row of pair p");
    assert!(window.query_by_label("Name of pair p").is_none());
    tap(&mut window, "Row of pair p");
    press(&mut window, Key::Delete);
    assert_eq!(window.state().document().name(0), "step");
    assert_eq!(window.state().document().pairs.len(), 2);
    undo(&mut window);
    assert_eq!(window.state().document().pairs.len(), 3);
}

fn unreliable() -> Window {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
        estimate.assessment.trust =
            Some(Trust { verdict: Verdict::Unreliable, reasons: vec![click_off(2, 40.0)] });
        Ok(estimate)
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window
}

fn export(window: &mut Window, choice: &str, path: &Path) -> String {
    press_with(window, Modifiers::COMMAND, Key::E);
    tap(window, choice);
    if choice != "Pairs alone" {
        window.get_by_label_contains("geometry is unreliable, and the file says so");
    }
    window.get_by_label("File").focus();
    settle(window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.get_by_label("File").type_text(path.to_str().unwrap());
    settle(window);
    tap(window, "Export file");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn what_is_exported_says_that_it_is_unreliable_and_where_each_pair_comes_from() {
    let files = Files::new();
    let mut window = unreliable();
    paste(&mut window, "eave\t300\t100\t280\t101");
    for (choice, name) in [("Geometry", "g.json"), ("Table", "t.csv"), ("Report", "r.txt")] {
        let text = export(&mut window, choice, &files.0.path().join(name)).to_lowercase();
        for words in ["unreliable", "off its epipolar line", "clicked", "pasted", "eave"] {
            assert!(text.contains(words), "{choice}: {words} is not in\n{text}");
        }
    }
    let pairs = export(&mut window, "Pairs alone", &files.0.path().join("p.json"));
    assert!(pairs.contains("clicked") && pairs.contains("pasted"));
    // The table comes back as point pairs.
    let before = window.state().document().pairs.clone();
    drop_files(&mut window, &[files.0.path().join("t.csv")]);
    assert_eq!(window.state().document().pairs, before);
    assert_eq!(window.state().document().origin(0), PairOrigin::Imported);
}

#[test]
fn a_name_stands_beside_its_points() {
    let mut window = sample();
    paste(&mut window, TABLE);
    let written = |window: &Window, name: &str| {
        let image = pane(window, Side::Left);
        let mut shapes = window
            .output()
            .shapes
            .iter()
            .filter(|clipped| image.expand(1.0).contains_rect(clipped.clip_rect));
        shapes.any(|clipped| matches!(&clipped.shape, egui::Shape::Text(text) if text.galley.text() == name))
    };
    assert!(written(&window, "roof"));
}

#[test]
fn a_point_among_forty_can_be_dragged() {
    let pairs = epiline::synthetic::Sample::Courtyard.load().matches.into_iter().take(40).collect();
    let mut window = window(Start { pairs, ..Start::default() }, services());
    let (from, before) = (screen(&window, P_LEFT), point(&window, P_LEFT));
    drag(&mut window, from, from + vec2(14.0, 9.0), PointerButton::Primary);
    let moved = (point(&window, P_LEFT) - before).norm();
    assert!(moved > 5.0, "{moved} px");
    assert_eq!(window.state().document().pairs.len(), 40);
}

#[test]
fn forty_lines_are_pinned_numbered_and_found_in_a_list() {
    let pairs = epiline::synthetic::Sample::Courtyard.load().matches.into_iter().take(40).collect();
    let mut window = window(Start { pairs, ..Start::default() }, services());
    press(&mut window, Key::I);
    for k in 0..40 {
        click_at(&mut window, Side::Left, -0.42 + 0.115 * (k % 8) as f32, -0.4 + 0.19 * (k / 8) as f32);
    }
    press(&mut window, Key::I);
    let pins = window.state().document().pins.clone();
    assert_eq!(pins.len(), 40);
    let right = pane(&window, Side::Right);
    let texts = window.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        egui::Shape::Text(text) if right.expand(1.0).contains_rect(clipped.clip_rect) => {
            text.galley.text().strip_prefix("pin ")?.parse::<usize>().ok()
        }
        _ => None,
    });
    let mut numbers: Vec<_> = texts.collect();
    numbers.sort_unstable();
    numbers.dedup();
    // Lines that miss the right image have no number there.
    assert!(numbers.len() > 30 && numbers.iter().all(|number| (1..=40).contains(number)), "{numbers:?}");
    press(&mut window, Key::Num2);
    tap(&mut window, "Line pair 40 of 40");
    let rows: Vec<_> = window.query_all_by_label_contains("Inspect: ").collect();
    assert_eq!(rows.len(), 40);
    // The list opens at the one that was pinned last.
    rows[37].click();
    drop(rows);
    settle(&mut window);
    assert_eq!(window.state().document().inspected_pin(), Some(&pins[37]));
    window.get_by_label("Line pair 38 of 40");
}

#[test]
fn of_a_long_table_the_rows_in_sight_are_drawn_and_the_others_keep_their_place() {
    let mut window = sample();
    let rows: Vec<String> = (0..60).map(|k| format!("n{k}\t{0}\t{0}\t{0}\t{0}\n", 20 + 4 * k)).collect();
    paste(&mut window, &format!("name\tx1\ty1\tx2\ty2\n{}", rows.concat()));
    let row = |window: &Window, pair: &str| {
        window.query_by_label(&format!("Row of pair {pair}")).map(|row| row.rect())
    };
    let [p, q] = ["p", "q"].map(|pair| row(&window, pair).expect("in sight"));
    assert!(row(&window, "60").is_none(), "far below");
    scroll_by(&mut window, p.center(), -5000.0);
    assert!(row(&window, "p").is_none(), "far above");
    let [before, last] = ["59", "60"].map(|pair| row(&window, pair).expect("scrolled to"));
    // A row has its height whether or not it is drawn.
    assert!(((last.top() - before.top()) - (q.top() - p.top())).abs() < 0.1);
    // What is typed in stays, wherever it is scrolled to.
    unfold(&mut window, "60");
    scroll_by(&mut window, p.center(), -5000.0);
    window.get_by_label("Name of pair 60").focus();
    settle(&mut window);
    scroll_by(&mut window, p.center(), 5000.0);
    window.event(Event::Text("kept".to_owned()));
    settle(&mut window);
    assert!(window.state().document().name(59).contains("kept"), "{}", window.state().document().name(59));
}
