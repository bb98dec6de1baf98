//! Long use of the window: drags, openings and exports must not leak memory, threads or files.
//!
//! This is a separate test program because parallel tests would be counted too. The allocator
//! counts memory; the system counts threads and open files. The stand-in of the window's tests
//! answers most searches at once, and the real estimator some of them. With the estimator alone, a
//! day's use takes a day.
//!
//! ```sh
//! EPILINE_DRAGS=10000 EPILINE_OPENINGS=200 EPILINE_EXPORTS=200 cargo test --test soak -- --ignored --nocapture
//! ```
#![cfg(target_os = "linux")]

mod counting;
#[allow(dead_code, reason = "each test uses its part of it")]
#[path = "window/support.rs"]
mod support;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use counting::held;
use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use epiline::geometry::{Frame, PointPair};
use epiline::internals::app::{Services, Start};
use epiline::synthetic::{Motion, test_pair};
use support::{Files, P_LEFT, Window, button, drop_files, fake_estimate, screen, settle, window};

/// Rounds before the comparison, while lists of limited length fill up (unsaved copies, undo,
/// messages).
const WARM_UP: usize = 32;
/// Searches per search with the real estimator.
const REAL_SEARCHES: usize = 100;
/// Tolerated growth of memory, bytes. The estimator's memory depends on the pair.
const SLACK: usize = 16 << 20;
/// Tolerated growth of open files. Locks of unsaved copies come and go.
const MORE_FILES: usize = 4;

fn count(variable: &str, otherwise: usize) -> usize {
    std::env::var(variable).map_or(otherwise, |value| value.parse().unwrap())
}

/// Resources held by the program.
#[derive(Debug, Clone, Copy)]
struct Holdings {
    bytes: usize,
    threads: usize,
    files: usize,
}

impl Holdings {
    fn now() -> Self {
        let entries = |folder: &str| std::fs::read_dir(folder).unwrap().count();
        Self { bytes: held(), threads: entries("/proc/self/task"), files: entries("/proc/self/fd") }
    }
}

/// Test data: two pairs of pictures with point pairs, a session, a folder.
struct Material {
    files: Files,
    pairs: [[PathBuf; 2]; 2],
    points: PathBuf,
    session: PathBuf,
}

impl Material {
    fn new() -> Self {
        let files = Files::new();
        let path = |name: &str| files.0.path().join(name);
        let frame = Frame::new(240, 180);
        let mut points = Vec::new();
        let pairs = [3, 5].map(|seed| {
            let pair = test_pair(frame, Motion::Sideways, seed).unwrap();
            let far = |p: &&PointPair| (p.point1 - pair.matches[0].point1).norm() > 80.0;
            let two = [pair.matches[0], *pair.matches.iter().find(far).unwrap()];
            if seed == 3 {
                points.extend(two.map(|p| [p.point1.x, p.point1.y, p.point2.x, p.point2.y]));
            }
            let mut sides = ["left", "right"].into_iter();
            pair.pictures.map(|picture| {
                let path = path(&format!("{}{seed}.png", sides.next().unwrap()));
                picture.pixels.save(&path).unwrap();
                path
            })
        });
        let file = path("points.csv");
        let rows = points.iter().map(|row| row.map(|v| v.to_string()).join(","));
        std::fs::write(&file, rows.collect::<Vec<_>>().join("\n")).unwrap();
        Self { pairs, points: file, session: path("work.json"), files }
    }

    fn output(&self, name: &str) -> PathBuf {
        self.files.0.path().join(name)
    }
}

fn type_path(window: &mut Window, path: &Path) {
    window.get_by_label("File").focus();
    settle(window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.get_by_label("File").type_text(path.to_str().unwrap());
    settle(window);
}

fn export(window: &mut Window, kind: &str, path: &Path) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::E);
    settle(window);
    window.get_by_label(kind).click();
    settle(window);
    type_path(window, path);
    window.get_by_label("Export file").click();
    settle(window);
    assert!(path.exists(), "{kind}: {:?}", window.state().messages().collect::<Vec<_>>());
    std::fs::remove_file(path).unwrap();
}

/// Opens other content than the current one, with two point pairs.
fn open(window: &mut Window, material: &Material, round: usize) {
    match round % 4 {
        0 => drop_files(window, std::slice::from_ref(&material.session)),
        k => {
            drop_files(window, &material.pairs[k % 2]);
            drop_files(window, std::slice::from_ref(&material.points));
        }
    }
    assert_eq!(window.state().document().pairs.len(), 2, "round {round}");
}

/// Drags the first point there or back, without waiting for results.
fn drag(window: &mut Window, number: usize) {
    let from = screen(window, P_LEFT);
    let to = from + if number.is_multiple_of(2) { vec2(9.0, 6.0) } else { vec2(-9.0, -6.0) };
    window.hover_at(from);
    button(window, from, PointerButton::Primary, true);
    window.hover_at(from.lerp(to, 0.5));
    window.step();
    window.hover_at(to);
    window.step();
    button(window, to, PointerButton::Primary, false);
    window.step();
}

/// Runs one round: an opening, an export, drags.
fn round(window: &mut Window, material: &Material, number: usize, drags: usize) {
    open(window, material, number);
    let before = support::point(window, P_LEFT);
    for k in 0..drags {
        drag(window, k);
        if k == 0 {
            assert_ne!(support::point(window, P_LEFT), before, "round {number}: the point follows");
        }
    }
    settle(window);
    // The ending names the format.
    let exports = [
        ("Geometry", "geometry.json"),
        ("Report", "report.json"),
        ("Figure", "figure.svg"),
        ("Figure", "figure.pdf"),
    ];
    let (kind, name) = exports[number % exports.len()];
    export(window, kind, &material.output(name));
}

fn soak(drags: usize, openings: usize, exports: usize) {
    let rounds = openings.max(exports).max(1);
    let (material, copies) = (Material::new(), tempfile::tempdir().unwrap());
    let Services { estimate: mut search, .. } = Services::default();
    let mut asked = 0;
    let services = Services {
        estimate: Box::new(move |request, monitor| {
            asked += 1;
            if asked % REAL_SEARCHES == 1 {
                return search(request, monitor);
            }
            fake_estimate(&request.pairs, &request.parameters)
        }),
        pick_file: Arc::new(|| None),
        pick_folder: Arc::new(|| None),
        pick_save: Arc::new(|_| None),
        copies: Some(copies.path().to_owned()),
        ..Services::default()
    };
    let mut window = window(Start::default(), services);
    open(&mut window, &material, 1);
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    settle(&mut window);
    type_path(&mut window, &material.session);
    window.key_press(Key::Enter);
    settle(&mut window);
    let started = Instant::now();
    // The same number of drags as later, so that their peak memory is included in the baseline.
    let each = drags.div_ceil(rounds);
    for number in 0..WARM_UP {
        round(&mut window, &material, number, each);
    }
    let before = Holdings::now();
    println!("after {WARM_UP} rounds of {each} drags: {before:?}, {:.0} s", started.elapsed().as_secs_f64());
    for number in 0..rounds {
        round(&mut window, &material, WARM_UP + number, each);
        let now = Holdings::now();
        if (number + 1).is_multiple_of(rounds.div_ceil(8)) || number + 1 == rounds {
            println!("round {}: {now:?}, {:.0} s", number + 1, started.elapsed().as_secs_f64());
        }
        assert!(now.bytes <= before.bytes + SLACK, "round {number}: {now:?} after {before:?}");
        assert!(now.threads <= before.threads, "round {number}: {now:?} after {before:?}");
        assert!(now.files <= before.files + MORE_FILES, "round {number}: {now:?} after {before:?}");
    }
    println!("{} drags, {rounds} openings, {rounds} exports", rounds * each);
}

#[test]
#[ignore = "takes minutes; .ci/run runs a part of it"]
fn nothing_grows_however_long_the_window_is_used() {
    soak(count("EPILINE_DRAGS", 10_000), count("EPILINE_OPENINGS", 200), count("EPILINE_EXPORTS", 200));
}
