//! The computation behind the window: slow, stopped, failing.

use crate::support::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use egui::{Key, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use epiline::estimate::EstimateError;
use epiline::geometry::symmetric_epipolar_distance;
use epiline::internals::app::Start;

#[test]
fn a_failing_and_a_panicking_computation_are_told_and_the_points_stay() {
    let calls = Arc::new(AtomicUsize::new(0));
    let mut services = services();
    services.estimate = Box::new(move |request, _| match calls.fetch_add(1, Ordering::Relaxed) {
        0 => Err(EstimateError::NoGeometry),
        1 => panic!("index out of range"),
        _ => fake_estimate(&request.pairs, &request.parameters),
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window.get_by_label_contains("No epipolar geometry was found");
    assert!(window.query_by_label("Compute again").is_none(), "the same points give the same answer");
    press(&mut window, Key::F5);
    window.get_by_label_contains("stopped unexpectedly (index out of range)");
    assert_eq!(window.state().document().pairs.len(), 2);
    tap(&mut window, "Compute again");
    window.get_by_label_contains("Found from p and q");
}

#[test]
fn the_window_stays_live_while_computing_and_shows_only_the_newest_result() {
    let gate = Arc::new(AtomicUsize::new(0));
    let mut services = services();
    services.estimate = Box::new({
        let gate = Arc::clone(&gate);
        move |request, _| {
            while gate.load(Ordering::Relaxed) == 0 {
                std::thread::sleep(Duration::from_millis(1));
            }
            fake_estimate(&request.pairs, &request.parameters)
        }
    });
    let mut window = window(Start::default(), services);
    window.get_by_label("Show me how the lines are found").click();
    window.step();
    window.step();
    assert!(window.state().is_busy());
    window.get_by_label_contains("Estimating. Points can be dragged");
    window.get_by_label("Stop");
    // Dragging goes on while the computation is held up.
    let from = screen(&window, P_LEFT);
    window.hover_at(from);
    button(&window, from, PointerButton::Primary, true);
    for k in 1..=10 {
        window.hover_at(from + vec2(3.0 * k as f32, 0.0));
    }
    window.step();
    let moved = (screen(&window, P_LEFT) - from).x;
    assert!((moved - 30.0).abs() < 0.1, "{moved}");
    gate.store(1, Ordering::Relaxed);
    button(&window, from + vec2(30.0, 0.0), PointerButton::Primary, false);
    settle(&mut window);
    let inspector = window.state();
    let estimate = inspector.estimate().expect("an estimate");
    for pair in &inspector.document().pairs {
        assert!(symmetric_epipolar_distance(estimate.fundamental(), pair) < 1e-6);
    }
}

#[test]
fn stop_ends_the_computation() {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        std::thread::sleep(Duration::from_millis(300));
        fake_estimate(&request.pairs, &request.parameters)
    });
    let mut window = window(Start::default(), services);
    window.key_press(Key::S);
    window.step();
    window.step();
    window.get_by_label("Stop").click();
    window.step();
    window.step();
    assert!(!window.state().is_busy());
    std::thread::sleep(Duration::from_millis(400));
    settle(&mut window);
    assert!(window.state().estimate().is_none());
    press(&mut window, Key::F5);
    assert!(window.state().estimate().is_some());
    window.key_press(Key::F5);
    window.step();
    assert!(
        !window.state().is_busy() && window.state().estimate().is_some(),
        "the same points give the same result"
    );
}
