//! Terms of the field with their meanings.

use crate::support::*;

use egui_kittest::kittest::Queryable;
use epiline::internals::app::Start;

#[test]
fn a_term_in_a_heading_has_its_meaning() {
    let mut window = window(Start::default(), rich_services());
    click_two_pairs(&mut window);
    show_hypotheses(&mut window);
    let heading = window.get_by_label("Sort by Support").rect().center();
    window.hover_at(heading);
    for _ in 0..30 {
        window.step();
    }
    assert!(painted(&window, "It compares geometries. Higher is better."));
}
