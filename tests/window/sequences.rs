//! Sequences in place of pictures: opened like them, played, compared by motion barcodes, saved and opened again.

use crate::support::*;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use egui::Key;
use egui_kittest::kittest::Queryable;
use epiline::estimate::Estimate;
use epiline::geometry::{Frame, PointPair};
use epiline::internals::app::model::document::Side;
use epiline::internals::app::{Opening, Services, Start};
use epiline::motion::FrameSequence;
use epiline::similarity::LineMeasure;
use epiline::synthetic::{BallScene, ThrownBalls};

const SMALL: ThrownBalls = ThrownBalls {
    frame: Frame { width: 160, height: 120 },
    frames: 48,
    balls: 6,
    offset: 0,
    noise: 1.0,
    brightening: 0.0,
    seed: 3,
};

fn write_frames(folder: &Path, sequence: &FrameSequence) {
    std::fs::create_dir(folder).unwrap();
    for number in 0..sequence.len() {
        let pixels = image::GrayImage::from_raw(160, 120, sequence.frame(number).to_vec()).unwrap();
        pixels.save(folder.join(format!("{number:03}.png"))).unwrap();
    }
}

/// Two folders of frames, `cam1` and `cam2`.
fn recorded(files: &Files, thrown: ThrownBalls) -> [PathBuf; 2] {
    let sequences = BallScene::new(thrown).unwrap().sequences().unwrap();
    let folders = ["cam1", "cam2"].map(|name| files.0.path().join(name));
    for (folder, sequence) in folders.iter().zip(&sequences) {
        write_frames(folder, sequence);
    }
    folders
}

fn opened([left, right]: [PathBuf; 2], services: Services) -> Window {
    window(Start { opening: Opening::Files(left, right), ..Start::default() }, services)
}

#[test]
fn sequences_open_like_pictures_and_are_stepped_through() {
    let files = Files::new();
    let mut window = opened(recorded(&files, SMALL), services());
    window.get_by_label("Frame 0 of 48");
    assert_eq!(window.state().document().parameters.similarity.measure, LineMeasure::Barcodes);
    for _ in 0..3 {
        window.key_press(Key::Period);
    }
    press(&mut window, Key::Comma);
    window.get_by_label("Frame 2 of 48");
    press(&mut window, Key::W);
    assert!(window.state().model().open.player.silhouettes);
    // Played, one frame follows the other; settled only once it is paused.
    window.key_press(Key::K);
    for _ in 0..10 {
        window.step();
    }
    press(&mut window, Key::K);
    let [left, right] = window.state().model().shown_frames().unwrap();
    assert!(left > 2 && left == right, "frame {left}");

    // Pictures have nothing of it.
    drop_files(&mut window, &[files.image("a.png", 64, 48), files.image("b.png", 64, 48)]);
    assert_eq!(window.state().document().parameters.similarity.measure, LineMeasure::Stereo);
    assert!(window.query_by_label_contains("Frame ").is_none());
    assert!(window.state().model().shown_frames().is_none());
}

#[test]
fn lines_are_compared_by_what_moves_in_the_frames_in_common() {
    let files = Files::new();
    let asked = Arc::new(Mutex::new(Vec::new()));
    let services = Services {
        estimate: Box::new({
            let asked = Arc::clone(&asked);
            move |request, _| {
                let offset = request.recordings.as_ref().map(|recordings| recordings.offset);
                asked.lock().unwrap().push(offset);
                fake_estimate(&request.pairs, &request.parameters)
            }
        }),
        ..services()
    };
    let mut window = opened(recorded(&files, ThrownBalls { offset: 4, frames: 120, ..SMALL }), services);
    click_two_pairs(&mut window);
    assert_eq!(asked.lock().unwrap().last(), Some(&Some(0)));
    press(&mut window, Key::Num2);
    window.get_by_label_contains("Epipolar lines of q: c");
    let barcodes = window.get_by_label("Motion barcodes").rect();
    assert_eq!(window.state().model().inspected_barcodes().unwrap().barcodes[0].len(), 120);
    click(&mut window, barcodes.right_center() - egui::vec2(3.0, 0.0));
    assert_eq!(window.state().model().shown_frames(), Some([119, 119]), "a click goes to the frame");

    // Another offset is another question, and one step of the history.
    tap(&mut window, "Find offset");
    assert_eq!(window.state().document().offset, 4);
    assert_eq!(asked.lock().unwrap().last(), Some(&Some(4)));
    assert_eq!(window.state().model().inspected_barcodes().unwrap().barcodes[0].len(), 116);
    window.get_by_label("Frames 115 and 119 of 120");
    undo(&mut window);
    assert_eq!(window.state().document().offset, 0);
}

#[test]
fn a_result_of_sequences_without_clicks_has_lines_and_barcodes() {
    let files = Files::new();
    let fundamental = BallScene::new(SMALL).unwrap().fundamental().unwrap();
    let services = Services { estimate: Box::new(move |_, _| Ok(Estimate::from(fundamental))), ..services() };
    let mut window = opened(recorded(&files, SMALL), services);
    tap(&mut window, "Find without clicks");
    let model = window.state().model();
    assert!(model.standing_in().is_empty() && model.inspected().is_some());
    assert_eq!(model.unclicked_places().len(), 2);
    press(&mut window, Key::Num2);
    window.get_by_label("Motion barcodes");
    assert!(window.query_by_label("Step Epipoles").is_none(), "the player is in the place of the steps");
    tap(&mut window, "Search");
    assert!(window.query_by_label_contains("Frame 0").is_none());
    tap(&mut window, "Step Epipoles");
    window.get_by_label_contains("Two or three candidates at a time give a hypothesis");
    tap(&mut window, "Result");
    tap(&mut window, "Frames");
    window.get_by_label("Frame 0 of 48");
    press(&mut window, Key::Num3);
    window.get_by_label_contains("Motion barcodes give no matches: click point pairs");
}

#[test]
fn a_session_of_sequences_comes_back() {
    let files = Files::new();
    let mut window = opened(recorded(&files, SMALL), services());
    click_two_pairs(&mut window);
    tap(&mut window, "Find offset");
    let offset = window.state().document().offset;
    let path = files.0.path().join("work.json");
    save_as(&mut window, &path);
    let open = |path: &Path| {
        crate::support::window(
            Start { opening: Opening::Session(path.to_owned().into()), ..Start::default() },
            services(),
        )
    };
    let again = open(&path);
    assert_eq!(again.state().document().pairs, window.state().document().pairs);
    assert_eq!(again.state().document().offset, offset);
    assert!(again.state().model().compares_barcodes());
    // Another frame, and they are not those of the session any more.
    std::fs::copy(files.0.path().join("cam1/001.png"), files.0.path().join("cam1/002.png")).unwrap();
    let changed = open(&path);
    assert!(changed.state().model().recordings().is_none());
    changed.get_by_label_contains("has changed");
}

#[test]
fn a_folder_of_sequences_with_their_cameras_knows_the_truth() {
    let files = Files::new();
    recorded(&files, SMALL);
    let scene = BallScene::new(SMALL).unwrap();
    let rows = |m: &PointPair| format!("{} {} {} {}\n", m.point1.x, m.point1.y, m.point2.x, m.point2.y);
    let matches: String = scene.matches(40).iter().map(rows).collect();
    std::fs::write(files.0.path().join("truth-1-2.txt"), matches).unwrap();
    for (name, camera) in ["cam1.P", "cam2.P"].iter().zip(scene.cameras()) {
        let matrix = camera.matrix();
        let row = |r: usize| (0..4).map(|c| matrix[(r, c)].to_string()).collect::<Vec<_>>().join(" ");
        std::fs::write(files.0.path().join(name), [row(0), row(1), row(2)].join("\n")).unwrap();
    }
    let opening = Opening::Folder(files.0.path().to_owned());
    let window = window(Start { opening, ..Start::default() }, services());
    assert!(window.state().model().recordings().is_some());
    let truth = window.state().model().truth().expect("known cameras");
    let off = scene
        .matches(40)
        .into_iter()
        .map(|m| epiline::geometry::symmetric_epipolar_distance(&truth.fundamental, &m));
    assert!(off.fold(0.0, f64::max) < 1e-6);
}

#[test]
fn what_cannot_be_compared_is_refused_with_a_sentence() {
    let files = Files::new();
    let folders = recorded(&files, SMALL);
    let picture = files.image("a.png", 64, 48);
    let mut window = opened(folders.clone(), services());
    let before = window.state().model().recordings().unwrap();
    let refused = |window: &mut Window, paths: [PathBuf; 2], words: &str| {
        drop_files(window, &paths);
        let told: Vec<&str> = window.state().messages().collect();
        assert!(told.iter().any(|text| text.contains(words)), "{told:?}");
        assert!(window.state().model().recordings().as_ref() == Some(&before), "nothing was changed");
    };
    refused(&mut window, [folders[0].clone(), picture], "The left side is a sequence of frames");
    let still = files.0.path().join("still");
    let mut frames = FrameSequence::new("still");
    let gray = epiline::image::GrayPlane::from_fn(SMALL.frame, |x, y| ((x * y) % 251) as f32);
    for _ in 0..20 {
        frames.push(&gray).unwrap();
    }
    write_frames(&still, &frames);
    refused(&mut window, [folders[0].clone(), still], "nothing moves");
    let empty = files.0.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    refused(&mut window, [empty, folders[1].clone()], "no numbered pictures");
}

#[test]
fn the_built_in_sequences_are_found_by_name() {
    let mut window = sample();
    press_with(&mut window, egui::Modifiers::COMMAND, Key::K);
    window.event(egui::Event::Text("sample sequences".into()));
    settle(&mut window);
    press(&mut window, Key::Enter);
    let model = window.state().model();
    assert!(model.compares_barcodes() && model.open.show_me.is_some());
    assert_eq!(window.state().document().frame(Side::Left), Some(Frame::new(640, 480)));
    window.get_by_label("Frame 0 of 300");
}
