//! A session file is never partial, whenever the program is killed.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use epiline::camera::PicturesOf;
use epiline::geometry::Frame;
use epiline::io::{ImageReference, ImageSource, SessionFile};

/// Environment variable with the path for the child to save to.
const TARGET: &str = "EPILINE_TEST_SAVE_TO";

/// Returns a session of some hundred kilobytes, distinguished by every number in it.
fn session(number: u32) -> SessionFile<Vec<u32>> {
    let image = || ImageReference {
        source: ImageSource::File { path: "a.png".into(), sha256: "0".repeat(64) },
        frame: Frame::new(4, 3),
    };
    SessionFile {
        images: [image(), image()],
        fundamental: None,
        pictures: PicturesOf::Untold,
        trust: None,
        content: vec![number; 20_000],
    }
}

/// Body of the child process; not a test by itself.
#[test]
#[ignore = "run by the test below, in a process of its own"]
fn saves_until_it_is_killed() {
    let Some(path) = std::env::var_os(TARGET) else { return };
    for number in 1.. {
        session(number).write(Path::new(&path)).unwrap();
    }
}

#[test]
fn killing_the_program_while_it_saves_leaves_a_whole_session() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.json");
    session(0).write(&path).unwrap();
    let mut written = 0;
    let mut interrupted = 0;
    for round in 0..200u32 {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "killed::saves_until_it_is_killed", "--ignored"])
            .env(TARGET, &path)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Any moment of a save, which takes some milliseconds; the child needs a few to start.
        std::thread::sleep(Duration::from_micros(u64::from(4_000 + round * 7919 % 12_000)));
        child.kill().unwrap();
        child.wait().unwrap();
        let found = SessionFile::<Vec<u32>>::read(&path).unwrap();
        assert_eq!(found.content.len(), 20_000, "round {round}");
        assert!(found.content.iter().all(|n| *n == found.content[0]), "round {round}: parts of two sessions");
        written += u32::from(found.content[0] > 0);
        let parts = std::fs::read_dir(folder.path()).unwrap().filter_map(Result::ok);
        for part in parts.filter(|entry| entry.path() != path) {
            // The temporary file of the killed program is beside the session, not in its place.
            interrupted += 1;
            std::fs::remove_file(part.path()).unwrap();
        }
    }
    println!("{written} of 200 children had saved, {interrupted} were killed in the middle of it");
    assert!(written > 0 && interrupted > 20, "the test has to hit saves: {written}, {interrupted}");
}
