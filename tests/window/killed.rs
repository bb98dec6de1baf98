//! The window killed at any moment while it is worked with: every exported file is whole, and no edit older than two
//! seconds is lost.
//!
//! `EPILINE_KILLS` is how often; a few times in an ordinary run.

use crate::support::*;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use epiline::geometry::PointPair;
use epiline::internals::app::model::session::Work;
use epiline::internals::app::{Opening, Services, Start};
use epiline::io::{GeometryFile, SessionFile};

/// Set for the child that works until it is killed: the folder that it works in.
const CHILD: &str = "EPILINE_TEST_WORKS_IN";
/// Older edits are never lost.
const PROMISE: Duration = Duration::from_secs(2);
/// Children at work at the same time.
const AT_ONCE: usize = 4;
/// What the child exports, by turns.
const EXPORTS: [(&[&str], &str); 2] = [(&["Geometry"], "geometry.json"), (&["Figure", "SVG"], "figure.svg")];

fn kills() -> usize {
    std::env::var("EPILINE_KILLS").ok().and_then(|value| value.parse().ok()).unwrap_or(AT_ONCE)
}

fn copies(folder: &Path) -> PathBuf {
    folder.join("copies")
}

/// What the child does; as a test by itself it does nothing. Each edit moves a point by some pixels to the right.
#[test]
fn child_that_works() {
    let Ok(folder) = std::env::var(CHILD).map(PathBuf::from) else { return };
    let opening = Opening::Files(folder.join("left.png"), folder.join("right.png"));
    let pairs = vec![PointPair::new(10.0, 40.0, 12.0, 41.0), PointPair::new(300.0, 150.0, 290.0, 152.0)];
    let services = Services { copies: Some(copies(&folder)), ..services() };
    let mut window = window(Start { opening, pairs, ..Start::default() }, services);
    let place = screen(&window, P_LEFT);
    click(&mut window, place);
    for number in 0.. {
        for _ in 0..5 {
            window.key_press(Key::ArrowRight);
            window.step();
            println!("edited {}", point(&window, P_LEFT).x);
            std::thread::sleep(Duration::from_millis(30));
        }
        let (choices, name) = EXPORTS[number % 2];
        press_with(&mut window, Modifiers::COMMAND, Key::E);
        for label in choices.iter().chain(&["File"]) {
            tap(&mut window, label);
        }
        window.key_press_modifiers(Modifiers::COMMAND, Key::A);
        window.get_by_label("File").type_text(folder.join(name).to_str().unwrap());
        settle(&mut window);
        tap(&mut window, "Export file");
        println!("exported {name}");
    }
}

/// A child at work.
struct Worker {
    child: Child,
    folder: tempfile::TempDir,
    /// What it says, each with the moment.
    said: std::thread::JoinHandle<Vec<(Instant, String)>>,
    ends: Instant,
}

impl Worker {
    fn start(kill: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, k) in [("left.png", 7), ("right.png", 5)] {
            let pixel = |x, y| image::Luma([(x * k + y * 13) as u8]);
            image::GrayImage::from_fn(320, 200, pixel).save(folder.path().join(name)).unwrap();
        }
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "killed::child_that_works", "--nocapture", "--test-threads=1"])
            .env(CHILD, folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        // It begins to live with its first edit.
        let first = lines.by_ref().map_while(Result::ok).find(|line| line.contains("edited ")).unwrap();
        let first = (Instant::now(), first);
        let said = std::thread::spawn(move || {
            let lines = lines.map_while(Result::ok).map(|line| (Instant::now(), line));
            std::iter::once(first).chain(lines).collect()
        });
        // Another moment of saving and exporting in each, the same in every run.
        let mixed = (kill as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let life = PROMISE + Duration::from_micros(200_000 + mixed % 2_000_000);
        Self { child, folder, said, ends: Instant::now() + life }
    }

    /// Kills it and looks at what is left; how many edits it made and how many of them are found again.
    fn finish(mut self, kill: usize) -> [usize; 2] {
        std::thread::sleep(self.ends.saturating_duration_since(Instant::now()));
        let killed = Instant::now();
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        let said = self.said.join().unwrap();
        let edits: Vec<(Instant, f64)> = said
            .iter()
            .filter_map(|(then, line)| Some((*then, line.rsplit_once("edited ")?.1.parse().ok()?)))
            .collect();
        let old = edits.iter().filter(|(then, _)| killed - *then > PROMISE).map(|(_, x)| *x);
        let safe = old.fold(f64::NEG_INFINITY, f64::max);
        let copy = copies(self.folder.path()).join("unsaved-0.json");
        let kept =
            SessionFile::<Work>::read(&copy).unwrap_or_else(|problem| panic!("kill {kill}: {problem}"));
        let x = kept.content.document.pairs[0].point1.x;
        assert!(x >= safe, "kill {kill}: x = {x} px is kept, {safe} px was older than {PROMISE:?}");
        for (_, name) in EXPORTS {
            let path = self.folder.path().join(name);
            let told = said.iter().any(|(_, line)| line.ends_with(&format!("exported {name}")));
            assert!(path.exists() || !told, "kill {kill}: {name} is lost");
            if path.exists() && name.ends_with("json") {
                let (read, _) = GeometryFile::read(&path).unwrap_or_else(|e| panic!("kill {kill}: {e}"));
                assert!(read.fundamental.is_some() && read.pairs.len() == 2, "kill {kill}");
            } else if path.exists() {
                let text =
                    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("kill {kill}: {name}: {e}"));
                assert!(text.trim_end().ends_with("</svg>"), "kill {kill}: {name} is cut");
            }
        }
        if kill.is_multiple_of(AT_ONCE) {
            is_offered_again(self.folder.path(), x);
        }
        [edits.len(), edits.iter().filter(|(_, known)| *known <= x).count()]
    }
}

/// The next window brings it back.
fn is_offered_again(folder: &Path, x: f64) {
    let services = Services { copies: Some(copies(folder)), ..services() };
    let mut next = window(Start::default(), services);
    tap(&mut next, "Restore");
    assert!((point(&next, P_LEFT).x - x).abs() < 1e-9);
}

#[test]
fn no_edit_older_than_two_seconds_is_lost_and_no_export_is_half() {
    let mut totals = [0, 0];
    for first in (0..kills()).step_by(AT_ONCE) {
        let together = first..(first + AT_ONCE).min(kills());
        let workers: Vec<(usize, Worker)> = together.map(|kill| (kill, Worker::start(kill))).collect();
        for (kill, worker) in workers {
            let [made, kept] = worker.finish(kill);
            totals = [totals[0] + made, totals[1] + kept];
        }
    }
    println!("{} kills, {} edits, {} of them kept", kills(), totals[0], totals[1]);
}
