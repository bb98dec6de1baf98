//! Processor time of the window's frames while a point is dragged, with the real estimator, and
//! while large images are moved. Uploads to a graphics card are not included. Run with
//! `cargo bench --bench frames`.

#[path = "../tests/window/support.rs"]
#[expect(dead_code, reason = "shared with the tests of the window")]
mod support;

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use epiline::internals::app::model::document::Side;
use epiline::internals::app::model::ids::TabId;
use epiline::internals::app::model::look::Look;
use epiline::internals::app::{Inspector, Opening, Services, Start, install_theme};
use epiline::synthetic::Sample;
use support::{Files, Window, at, button, click, drop_files, pane, press, settle, wheel};

/// Frames of a drag, at 60 per second.
const FRAMES: u32 = 180;
const FRAME: Duration = Duration::from_micros(16_667);

/// Returns the processor time of this thread: the estimator competes for the processors, which
/// would distort the elapsed time. Returns the elapsed time if the system reports no processor
/// time.
fn processor_time() -> Duration {
    static BEGUN: LazyLock<Instant> = LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|line| line.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| BEGUN.elapsed(), Duration::from_nanos)
}

/// Opens a window with the real services, and records the processor time of each frame.
fn timed(start: Start) -> (Window, Rc<RefCell<Vec<Duration>>>) {
    let times: Rc<RefCell<Vec<Duration>>> = Rc::default();
    let noted = Rc::clone(&times);
    let mut window: Window = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .with_max_steps(30)
        .with_context_setup(install_theme)
        .build_ui_state(
            move |ui, inspector: &mut Inspector| {
                let begun = processor_time();
                inspector.show(ui);
                noted.borrow_mut().push(processor_time().saturating_sub(begun));
            },
            Inspector::new(start, Services::default()),
        );
    // Nothing moves by itself while frames are timed.
    window.state_mut().set_look(Look { still_steps: true, ..Look::default() });
    settle(&mut window);
    (window, times)
}

fn main() {
    while_dragging();
    while_moving_large_images();
}

fn while_dragging() {
    let usual = Look::default();
    let everything = Look { overlays: usual.overlays.map(|_| true), ..Look::default() };
    let hypotheses = Look { tab: TabId::Step, ..Look::default() };
    for (name, look) in
        [("as usual", usual), ("every overlay", everything), ("tab of the hypotheses", hypotheses)]
    {
        let (mut window, times) = timed(Start::default());
        window.get_by_label("Show me how the lines are found").click();
        settle(&mut window);
        window.state_mut().set_look(look);
        window.step();
        println!("{name}");
        drag_in_circles(&mut window, &times);
    }
    let sample = Sample::Courtyard.load();
    let pairs = sample.show_me.into_iter().chain(sample.matches).take(MANY).collect();
    let (mut window, times) = timed(Start { pairs, ..Start::default() });
    let files = Files::new();
    let calibration = files.0.path().join("cameras.txt");
    std::fs::write(&calibration, "1 SIMPLE_RADIAL 768 576 700 384 288 -0.2\n").unwrap();
    for what in ["lines", "curves"] {
        if what == "curves" {
            drop_files(&mut window, std::slice::from_ref(&calibration));
        }
        press(&mut window, Key::I);
        for k in 0..MANY {
            let place = at(&window, Side::Right, -0.32 + 0.09 * (k % 8) as f32, -0.3 + 0.15 * (k / 8) as f32);
            click(&mut window, place);
        }
        press(&mut window, Key::I);
        println!("{MANY} pairs and {} pinned {what}", window.state().document().pins.len());
        drag_in_circles(&mut window, &times);
        replay(&mut window, &times);
    }
}

/// Plays the replay of the search once.
fn replay(window: &mut Window, times: &RefCell<Vec<Duration>>) {
    window.state_mut().set_look(Look::default());
    window.key_press(Key::Space);
    window.step();
    times.borrow_mut().clear();
    while window.state().model().open.replay.is_playing() && times.borrow().len() < FRAMES as usize {
        window.step();
    }
    println!("  frames of the replay: {}", summary(times.take()));
    window.state_mut().set_look(Look { still_steps: true, ..Look::default() });
    press(window, Key::End);
}

/// Number of pairs and of pinned lines in a full window.
const MANY: usize = 40;

/// Returns the place of the first left point on the screen.
fn on_screen(window: &Window) -> egui::Pos2 {
    let model = window.state().model();
    let frame = model.open.shown_frame(Side::Left).unwrap();
    let offset = model.pairs_in_pictures()[0].point1 - frame.centre();
    let rect = pane(window, Side::Left);
    let scale = (rect.width() / frame.width as f32).min(rect.height() / frame.height as f32);
    rect.center() + vec2(offset.x as f32, offset.y as f32) * scale
}

fn drag_in_circles(window: &mut Window, times: &RefCell<Vec<Duration>>) {
    let from = on_screen(window);
    window.hover_at(from);
    button(window, from, PointerButton::Primary, true);
    window.step();
    times.borrow_mut().clear();
    let fundamental = |window: &Window| window.state().estimate().map(|estimate| *estimate.fundamental());
    // Time of the first move not yet answered by a geometry on the screen, and the lengths of such
    // waits.
    let (mut waiting, mut waits) = (None, Vec::new());
    let mut shown = fundamental(window);
    for frame in 0..FRAMES {
        let begun = Instant::now();
        let turn = f64::from(frame) * 0.05;
        let way = vec2(turn.sin() as f32 * 12.0, turn.cos() as f32 * 12.0 - 12.0);
        window.hover_at(from + way);
        window.step();
        let now = fundamental(window);
        if now != shown {
            shown = now;
            waits.extend(waiting.take().map(|moved: Instant| moved.elapsed()));
        }
        // The lines of this frame were computed before the point moved.
        waiting.get_or_insert(begun);
        std::thread::sleep(FRAME.saturating_sub(begun.elapsed()));
    }
    println!("  frames while dragging: {}", summary(times.take()));
    println!("  from a moved point to new lines: {}", summary(waits));
    button(window, from, PointerButton::Primary, false);
    let released = Instant::now();
    settle(window);
    println!("  from the end of the drag to the final geometry: {:.2} s", released.elapsed().as_secs_f64());
}

fn while_moving_large_images() {
    let files = Files::new();
    let [left, right] = ["a.png", "b.png"].map(|name| files.image(name, 8000, 6000));
    let (mut window, times) = timed(Start { opening: Opening::Files(left, right), ..Start::default() });
    let middle = pane(&window, Side::Left).center();
    window.hover_at(middle);
    times.borrow_mut().clear();
    for (what, by) in [("in", 12.0), ("out", -12.0)] {
        for _ in 0..FRAMES {
            window.event(wheel(by));
            window.step();
        }
        println!("zooming {what}: {}", summary(times.take()));
    }
    for _ in 0..60 {
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, 12.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        window.step();
    }
    times.borrow_mut().clear();
    button(&window, middle, PointerButton::Middle, true);
    for frame in 0..FRAMES {
        window.hover_at(middle + vec2(-(frame as f32) * 4.0, -(frame as f32) * 3.0));
        window.step();
    }
    println!("moving: {}", summary(times.take()));
}

fn summary(mut times: Vec<Duration>) -> String {
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize].as_secs_f64() * 1e3;
    if times.is_empty() {
        return "none".to_owned();
    }
    // Systems that count processor time in ticks make the median coarse, and not the mean.
    let mean = times.iter().sum::<Duration>().as_secs_f64() * 1e3 / times.len() as f64;
    format!(
        "{} times, mean {mean:.2} ms, median {:.2} ms, 95 % {:.2} ms, longest {:.2} ms",
        times.len(),
        at(0.5),
        at(0.95),
        at(1.0)
    )
}
