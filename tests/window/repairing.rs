//! Matches that are found for a person: suggestions on turned images, the repair of placed pairs with the menu of a pair,
//! and the place for the next click.

use crate::support::*;

use std::path::Path;

use egui::Key;
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::estimate::{Reason, Trust, Verdict};
use epiline::geometry::{Point, Vector, symmetric_epipolar_distance};
use epiline::internals::app::model::document::{PointRef, Role, Side};
use epiline::internals::app::{Opening, Services, Start};
use epiline::study::PlaceFound;

const Q_RIGHT: PointRef = PointRef { pair: 1, side: Side::Right };

/// Moves every point that is to be refined by the same, and finds every match at one place.
fn moving() -> Services {
    Services {
        repair: Box::new(|question| Ok(question.points.point2 + Vector::new(0.4, -0.3))),
        places: Box::new(|question| {
            let place = Some(Point::new(200.0, 150.0));
            question.pairs.iter().map(|pair| PlaceFound { pair: *pair, place, is_confirmed: true }).collect()
        }),
        ..services()
    }
}

#[test]
fn a_pair_is_repaired_from_its_row_and_undo_takes_it_back() {
    let mut window = window(Start::default(), moving());
    click_two_pairs(&mut window);
    let before = point(&window, Q_RIGHT);
    tap(&mut window, "Refine: pair q");
    assert!((point(&window, Q_RIGHT) - before - Vector::new(0.4, -0.3)).norm() < 1e-9);
    window.get_by_label_contains("Pair q refined: its right point moved by 0.50 px");
    undo(&mut window);
    assert_eq!(point(&window, Q_RIGHT), before);
    tap(&mut window, "Move to match: pair q");
    assert_eq!(point(&window, Q_RIGHT), Point::new(200.0, 150.0));
    assert!(window.get_by_label("Move to match: pair q").accesskit_node().is_disabled(), "it is there");
    undo(&mut window);
    assert_eq!(point(&window, Q_RIGHT), before);
}

#[test]
fn a_pair_without_a_match_stays_and_the_window_says_why() {
    let mut window = sample();
    click_two_pairs(&mut window);
    let before = point(&window, Q_RIGHT);
    tap(&mut window, "Refine: pair q");
    assert_eq!(point(&window, Q_RIGHT), before);
    window.get_by_label_contains("Pair q was not changed. Nothing is alike. Drag its right point");
}

#[test]
fn an_unreliable_geometry_moves_no_point_to_its_lines() {
    let mut services = moving();
    services.estimate = Box::new(|request, _| {
        let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
        estimate.assessment.trust = Some(Trust { verdict: Verdict::Unreliable, reasons: Vec::new() });
        Ok(estimate)
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    assert!(window.get_by_label("Move to match: pair q").accesskit_node().is_disabled());
    assert!(!window.get_by_label("Refine: pair q").accesskit_node().is_disabled());
}

#[test]
fn the_menu_of_a_pair_opens_on_its_points_and_on_its_row() {
    let mut window = window(Start::default(), moving());
    click_two_pairs(&mut window);
    let before = point(&window, Q_RIGHT);
    let position = screen(&window, Q_RIGHT);
    right_click(&mut window, position);
    tap(&mut window, "Refine");
    assert_ne!(point(&window, Q_RIGHT), before);
    assert!(window.query_by_label("Refine").is_none(), "the menu closes");

    // On the row, in its middle and on its name.
    let row = window.get_by_label("Row of pair q").rect();
    for position in [row.center(), row.left_center() + egui::vec2(24.0, 0.0)] {
        right_click(&mut window, position);
        window.get_by_label("Pin lines");
        tap(&mut window, "Check only");
        assert_eq!(window.state().document().role(1), Role::Check);
        undo(&mut window);
    }
    right_click(&mut window, row.center());
    tap(&mut window, "Delete");
    assert_eq!(window.state().document().pairs.len(), 1);
}

#[test]
fn a_click_that_closes_the_menu_places_nothing() {
    let mut window = window(Start::default(), moving());
    click_two_pairs(&mut window);
    let position = screen(&window, P_LEFT);
    right_click(&mut window, position);
    window.get_by_label("Refine");
    let elsewhere = at(&window, Side::Left, 0.35, 0.35);
    click(&mut window, elsewhere);
    assert!(window.query_by_label("Refine").is_none());
    assert!(window.state().document().half.is_none());
    // Beside the points there is the menu of the place.
    right_click(&mut window, elsewhere);
    assert!(window.query_by_label("Refine").is_none());
    window.get_by_label("Copy coordinates");
    click(&mut window, elsewhere);
    assert!(window.state().document().half.is_none());
    click(&mut window, elsewhere);
    assert!(window.state().document().half.is_some());
}

#[test]
fn the_library_repairs_a_pair_of_the_sample() {
    let real = Services { estimate: services().estimate, suggest: services().suggest, ..Services::default() };
    let mut window = window(Start::default(), real);
    tap(&mut window, "Show me how the lines are found");
    let truth = point(&window, Q_RIGHT);
    let q = screen(&window, Q_RIGHT);
    click(&mut window, q);
    for key in [Key::ArrowRight, Key::ArrowUp] {
        press(&mut window, key);
    }
    assert!((point(&window, Q_RIGHT) - truth).norm() > 1.2);
    tap(&mut window, "Refine: pair q");
    let moved = point(&window, Q_RIGHT);
    assert!((moved - truth).norm() < 1.0, "{moved} for {truth}");
    let f = window.state().estimate().unwrap().fundamental();
    assert!(symmetric_epipolar_distance(f, &window.state().document().pairs[1]) < 1e-6);
}

#[test]
fn while_the_result_is_in_doubt_the_most_useful_next_click_is_marked() {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
        let verdict = if request.pairs.len() < 3 { Verdict::Doubtful } else { Verdict::Reliable };
        estimate.assessment.trust = Some(Trust { verdict, reasons: Vec::new() });
        Ok(estimate)
    });
    // The real search for the place, among the rivals of the result.
    services.next_click = Services::default().next_click;
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    assert!(is_marked(&window));
    // The button of the card places the left point there.
    tap(&mut window, "Add a pair at the mark");
    assert!(window.state().document().half.is_some_and(|half| half.side == Side::Left));
    press(&mut window, Key::Escape);
    assert!(is_marked(&window));
    // The first click of that pair, and giving it up.
    let elsewhere = at(&window, Side::Left, 0.35, -0.35);
    click(&mut window, elsewhere);
    assert!(!is_marked(&window));
    press(&mut window, Key::Escape);
    assert!(is_marked(&window));
    // The pair makes the result firm.
    click(&mut window, elsewhere);
    click_at(&mut window, Side::Right, 0.35, -0.35);
    assert!(!is_marked(&window));
    assert!(window.query_by_label_contains("Add a pair at the mark").is_none());
    // The published search would not use it.
    show_parameters(&mut window, "Pencils");
    tap(&mut window, "As published");
    assert!(!is_marked(&window));
}

#[test]
fn no_pair_is_asked_for_where_only_a_plane_is_certain_or_all_pairs_contradict_the_images() {
    for (reason, marked) in [
        (Reason::Ambiguous { margin: 0.1 }, true),
        (Reason::ClicksAlone, false),
        (Reason::OnePlane { percent: 98, groups: 0, agreeing: 0, is_still: false }, false),
    ] {
        let mut services = services();
        services.estimate = Box::new(move |request, _| {
            let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
            let reasons = vec![reason.clone()];
            estimate.assessment.trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
            Ok(estimate)
        });
        services.next_click = Services::default().next_click;
        let mut window = window(Start::default(), services);
        click_two_pairs(&mut window);
        assert_eq!(is_marked(&window), marked);
    }
}

/// Whether the left image has a label that asks for a pair.
fn is_marked(window: &Window) -> bool {
    let is_label = |shape: &egui::Shape| matches!(shape, egui::Shape::Text(text) if text.galley.text() == "a pair here helps most");
    let pane = pane(window, Side::Left);
    window
        .output()
        .shapes
        .iter()
        .any(|clipped| pane.expand(1.0).contains_rect(clipped.clip_rect) && is_label(&clipped.shape))
}

#[test]
fn the_second_click_is_guided_in_a_turned_image() {
    let files = Files::new();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let turned = files.0.path().join("turned.png");
    image::open(assets.join("courtyard-2.png")).unwrap().rotate90().save(&turned).unwrap();
    let opening = Opening::Files(assets.join("courtyard-1.png"), turned);
    let services = Services { suggest: Services::default().suggest, ..services() };
    let mut window = window(Start { opening, ..Start::default() }, services);
    // The first pair by the features of the images, the second by what surrounds the first.
    for (pair, place) in [Point::new(384.0, 153.0), Point::new(705.0, 333.0)].into_iter().enumerate() {
        let position = screen_of(&window, Side::Left, place);
        click(&mut window, position);
        window.get_by_label_contains("Enter accepts the suggested match");
        press(&mut window, Key::Enter);
        let found = point(&window, PointRef { pair, side: Side::Right });
        // Upright it is seen 12 px to the left; 576 px high, (x, y) becomes (575 − y, x).
        let expected = Point::new(575.0 - place.y - 0.5, place.x - 12.0);
        assert!((found - expected).norm() < 5.0, "{found} for {expected}");
    }
}

#[test]
fn a_pair_whose_match_lies_elsewhere_on_its_line_is_told_and_moved() {
    let place = Point::new(200.0, 150.0);
    let mut services = moving();
    services.estimate = Box::new(|request, _| {
        let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
        estimate.assessment.trust = Some(Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
        Ok(estimate)
    });
    services.places = Box::new(move |question| {
        let pair = question.pairs[1];
        if pair.point2 == place {
            return vec![PlaceFound { pair: question.pairs[0], place: None, is_confirmed: false }];
        }
        vec![PlaceFound { pair, place: Some(place), is_confirmed: false }]
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    assert!(window.query_by_label("off its match").is_some());
    assert!(window.query_by_label_contains("The match of q probably lies elsewhere on its line.").is_some());
    tap(&mut window, "Move q to its match");
    assert_eq!(point(&window, Q_RIGHT), place);
    assert!(window.query_by_label("off its match").is_none());
    assert!(window.query_by_label_contains("lies elsewhere").is_none());
    // The place of the other pair is not clear.
    assert!(window.query_by_label("?").is_some() && window.state().model().slid(0).is_none());
    undo(&mut window);
    assert!(window.query_by_label("off its match").is_some(), "it is checked again");
}
