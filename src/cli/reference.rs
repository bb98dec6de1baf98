//! Reference of the command line in `docs/command-line.md` and the man pages in `docs/man`,
//! generated from the definition in `src/cli`. After a change,
//! `EPILINE_RENEW=1 cargo test --lib reference` regenerates it.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use clap::{Command, CommandFactory};

use super::CommandLine;

/// Last line of the hand-written part of the document.
const BEGINNING: &str = "from the definition in `src/cli`.\n";
/// Width of the help, characters.
const WIDTH: usize = 110;

fn command() -> Command {
    let mut command = CommandLine::command().term_width(WIDTH).disable_help_subcommand(true);
    command.build();
    command
}

/// Returns the help of the program and of each command.
fn help() -> String {
    let mut command = command();
    let mut text = String::new();
    let mut add = |title: &str, command: &mut Command| {
        let help = command.render_long_help().to_string();
        let lines: Vec<&str> = help.lines().map(str::trim_end).collect();
        let _ = write!(text, "\n### {title}\n\n```text\n{}\n```\n", lines.join("\n").trim_end());
    };
    add("epiline", &mut command);
    for sub in command.get_subcommands_mut() {
        add(&format!("epiline {}", sub.get_name()), sub);
    }
    text
}

/// Compares a file with its expected content, or regenerates it.
fn check(path: &Path, expected: &str) {
    if std::env::var_os("EPILINE_RENEW").is_some() {
        fs::write(path, expected).unwrap();
        return;
    }
    let found = fs::read_to_string(path).unwrap_or_default();
    assert!(
        found == expected,
        "{} is not what the command line says: run EPILINE_RENEW=1 cargo test --lib reference",
        path.display()
    );
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

#[test]
fn the_document_has_the_help_of_every_command() {
    let path = docs().join("command-line.md");
    let document = fs::read_to_string(&path).unwrap();
    let (written_by_hand, _) = document.split_once(BEGINNING).unwrap();
    check(&path, &format!("{written_by_hand}{BEGINNING}{}", help()));
}

#[test]
fn the_man_pages_are_those_of_the_commands() {
    let folder = docs().join("man");
    let fresh = tempfile::tempdir().unwrap();
    clap_mangen::generate_to(command(), fresh.path()).unwrap();
    let names = |folder: &Path| {
        let entries = fs::read_dir(folder).into_iter().flatten();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    fs::create_dir_all(&folder).unwrap();
    for name in names(fresh.path()) {
        check(&folder.join(&name), &fs::read_to_string(fresh.path().join(&name)).unwrap());
    }
    assert_eq!(names(&folder), names(fresh.path()), "pages of commands that are gone: delete them");
}
