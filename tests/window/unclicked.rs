//! A geometry that nobody clicked for: offered, shown with the matches that stand in, and made into point pairs.

use crate::support::*;

use std::sync::Arc;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use epiline::estimate::{Clicks, EstimateError, SearchPlan};
use epiline::geometry::PointPair;
use epiline::internals::app::Services;
use epiline::internals::app::Start;
use epiline::internals::app::model::document::{Role, Side};
use epiline::io::PairOrigin;

/// Found where there is no click, and held by what is clicked where there is.
fn finding() -> Services {
    Services {
        estimate: Box::new(|request, _| {
            let standing_in =
                [PointPair::new(100.0, 80.0, 90.0, 82.0), PointPair::new(420.0, 300.0, 400.0, 310.0)];
            if request.pairs.len() > 1 {
                return fake_estimate(&request.pairs, &request.parameters);
            }
            let mut found = fake_estimate(&standing_in, &request.parameters)?;
            let mut trace = found.trace.as_deref().ok_or(EstimateError::NoGeometry)?.clone();
            let plan = SearchPlan::of(&request.parameters, request.pairs.len());
            trace.clicks = Clicks::for_plan(&request.pairs, plan).with_chosen(standing_in);
            found.trace = Some(Arc::new(trace));
            Ok(found)
        }),
        ..services()
    }
}

/// Asks for a search without clicks by the list of commands: the sample offers others.
fn find(window: &mut Window) {
    press_with(window, Modifiers::COMMAND, Key::K);
    window.get_by_label("Search commands").type_text("Find the geometry without");
    settle(window);
    press(window, Key::Enter);
}

#[test]
fn a_geometry_is_found_without_a_click_and_its_matches_become_pairs() {
    let mut window = window(Start::default(), finding());
    assert!(window.state().model().shown().is_none(), "nobody asked");
    find(&mut window);
    let model = window.state().model();
    assert!(model.shown().is_some() && model.document.pairs.is_empty());
    assert_eq!(model.standing_in().len(), 2);
    assert!(model.inspected().is_some(), "lines to look at");
    window.get_by_label_contains("the images alone, without clicks");
    assert!(window.query_by_label("Find without clicks").is_none(), "found already");
    tap(&mut window, "Step Lines");
    window.get_by_label_contains("As a test of the result, lines through two matches are compared");
    tap(&mut window, "Step Epipoles");
    window.get_by_label_contains("Small samples of the matches give hypotheses.");
    tap(&mut window, "Result");

    tap(&mut window, "Turn matches into point pairs");
    let document = window.state().document();
    let about = |pair| (document.role(pair), document.origin(pair));
    assert_eq!([about(0), about(1)], [(Role::Check, PairOrigin::Automatic); 2]);
    assert!(window.query_by_label("Turn matches into point pairs").is_none(), "they are");

    // Enough clicks, and the images alone are not asked any more; undo goes back to them.
    click_two_pairs(&mut window);
    let model = window.state().model();
    assert!(!model.document.is_unclicked() && model.standing_in().is_empty());
    assert_eq!(model.document.used_pairs().map(|pairs| pairs.len()), Some(2));

    // Asked again, the images decide alone and the clicks check them.
    find(&mut window);
    let model = window.state().model();
    assert!(model.document.is_unclicked() && model.shown().is_some());
    assert_eq!([2, 3].map(|pair| model.document.role(pair)), [Role::Check; 2]);
    undo(&mut window);
    assert!(!window.state().document().is_unclicked());
}

#[test]
fn after_a_search_in_vain_the_hint_says_so() {
    let services = Services { estimate: Box::new(|_, _| Err(EstimateError::Flat(2))), ..services() };
    let mut window = window(Start::default(), services);
    find(&mut window);
    window.get_by_label_contains("There is no result. The verdict says why");
    window.get_by_label_contains("The right image is (nearly) uniform");
}

#[test]
fn a_single_point_leaves_the_offer_in_view() {
    let mut window = window(Start::default(), finding());
    click_at(&mut window, Side::Left, 0.1, 0.1);
    assert!(painted(&window, "Mark two point pairs to estimate the epipolar geometry."));
    tap(&mut window, "Find without clicks");
    assert!(window.state().model().shown().is_some());
    assert!(window.query_by_label("Find without clicks").is_none());
}

#[test]
fn one_click_takes_part_and_clearing_asks_no_more() {
    let mut window = window(Start::default(), finding());
    find(&mut window);
    for side in Side::BOTH {
        click_at(&mut window, side, 0.1, 0.1);
    }
    let model = window.state().model();
    assert_eq!(model.document.used_pairs().map(|pairs| pairs.len()), Some(1));
    assert!(model.shown().is_some());
    window.get_by_label_contains("the images and one pair");
    for _ in 0..4 {
        undo(&mut window);
    }
    assert!(!window.state().document().unclicked, "undone");
    assert!(window.state().model().is_at_start());
}
