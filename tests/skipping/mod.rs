//! Tests that need more than the project say by name that they were skipped.

#![allow(dead_code, reason = "each test uses its part of it")]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Prints that the running test is skipped. The test runner would hide an `eprintln!` of a passed
/// test.
#[expect(clippy::explicit_write, reason = "the runner must not capture the line")]
pub fn skipped(reason: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("test without a name");
    writeln!(std::io::stderr(), "skipped: {test}: {reason}").unwrap();
}

/// Returns a folder of the data beside the project, such as `data/house`. Without it, prints that
/// the test is skipped.
pub fn shared(folder: &str) -> Option<PathBuf> {
    // The laboratory is a folder of the project.
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().skip(1).take(2);
    let found = above.map(|path| path.join("shared").join(folder)).find(|path| path.is_dir());
    if found.is_none() {
        skipped(&format!("there is no folder ../shared/{folder}"));
    }
    found
}

/// Returns a Python that has a module: the program named by `EPILINE_PYTHON`, or `python3`. Without it,
/// prints that the test is skipped, or fails if `EPILINE_REQUIRE_PYTHON` is set, as in `.ci/run`.
pub fn python(module: &str) -> Option<PathBuf> {
    let python = std::env::var_os("EPILINE_PYTHON").map_or_else(|| PathBuf::from("python3"), PathBuf::from);
    let import = format!("import {module}");
    if Command::new(&python).args(["-c", &import]).output().is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    let message = format!("{} has no module {module}", python.display());
    assert!(std::env::var_os("EPILINE_REQUIRE_PYTHON").is_none(), "{message}");
    skipped(&message);
    None
}
