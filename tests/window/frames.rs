//! How long frames take while a point is dragged, with the real estimator. It asserts nothing, for times depend on
//! the machine; run it in a release build:
//!
//! ```text
//! cargo test --release --test window -- --ignored --nocapture frames
//! ```

use crate::support::*;

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use egui::{PointerButton, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use epiline::app::{Inspector, Services, Start, install_theme};

/// Frames of a drag, at 60 a second.
const FRAMES: u32 = 180;
const FRAME: Duration = Duration::from_micros(16_667);

#[test]
#[ignore = "it measures and asserts nothing"]
fn frames_while_dragging() {
    let times: Rc<RefCell<Vec<Duration>>> = Rc::default();
    let noted = Rc::clone(&times);
    let mut window: Window = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .with_max_steps(30)
        .with_context_setup(install_theme)
        .build_ui_state(
            move |ui, inspector: &mut Inspector| {
                let begun = Instant::now();
                inspector.show(ui);
                noted.borrow_mut().push(begun.elapsed());
            },
            Inspector::new(Start::default(), Services::default()),
        );
    settle(&mut window);
    window.get_by_label("Show me").click();
    settle(&mut window);
    let from = screen(&window, P_LEFT);
    window.hover_at(from);
    button(&window, from, PointerButton::Primary, true);
    window.step();
    times.borrow_mut().clear();
    let fundamental = |window: &Window| window.state().estimate().map(|estimate| estimate.fundamental);
    // When a point was moved that the geometry on the screen does not know of yet, and how long such waits were.
    let (mut waiting, mut waits) = (None, Vec::new());
    let mut shown = fundamental(&window);
    for frame in 0..FRAMES {
        let begun = Instant::now();
        let turn = f64::from(frame) * 0.05;
        let way = vec2(turn.sin() as f32 * 12.0, turn.cos() as f32 * 12.0 - 12.0);
        window.hover_at(from + way);
        window.step();
        let now = fundamental(&window);
        if now != shown {
            shown = now;
            waits.extend(waiting.take().map(|moved: Instant| moved.elapsed()));
        }
        // The lines of this frame came before the answer to what it moved.
        waiting.get_or_insert(begun);
        std::thread::sleep(FRAME.saturating_sub(begun.elapsed()));
    }
    let dragging = times.borrow().clone();
    button(&window, from, PointerButton::Primary, false);
    let released = Instant::now();
    settle(&mut window);
    println!("frames while dragging: {}", summary(dragging));
    println!("from a moved point to new lines: {}", summary(waits));
    println!("from the end of the drag to the final geometry: {:.2} s", released.elapsed().as_secs_f64());
}

fn summary(mut times: Vec<Duration>) -> String {
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
    if times.is_empty() {
        return "none".to_owned();
    }
    format!(
        "{} times, median {:.2} ms, 95 % {:.2} ms, longest {:.2} ms",
        times.len(),
        at(0.5),
        at(0.95),
        at(1.0)
    )
}
