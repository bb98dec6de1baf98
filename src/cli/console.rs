//! Standard output and standard error. A closed pipe or a panic prints no stack trace.

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::panic::AssertUnwindSafe;
use std::process::ExitCode;

use clap::Parser;

use super::error::{CliError, INTERNAL_ERROR};
use crate::foreign::{escaped, escaped_lines, reason};

/// Writes to standard output, with control characters escaped. A reader that closes early
/// (`| head -1`) is not an error.
pub(super) fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(escaped_lines(text).as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(CliError::StandardOutput(reason(&e))),
        _ => Ok(()),
    }
}

/// Writes a line to standard error. Errors are ignored: there is no other channel.
pub fn tell(line: impl Display) {
    let _ = writeln!(std::io::stderr(), "{}", escaped_lines(&line.to_string()));
}

/// Runs a program: parses its command line, runs the command, and prints an error in one line.
/// Returns the exit status.
pub fn run_program<C: Parser, E: Display>(
    run: fn(C) -> Result<(), E>,
    exit_status: fn(&E) -> u8,
) -> ExitCode {
    ExitCode::from(run_with_arguments(std::env::args_os(), run, exit_status))
}

/// Runs a program with arguments, the first of which is its name. Returns the exit status.
pub fn run_with_arguments<C: Parser, E: Display>(
    arguments: impl IntoIterator<Item = OsString>,
    run: fn(C) -> Result<(), E>,
    exit_status: fn(&E) -> u8,
) -> u8 {
    report_panics_in_one_sentence();
    let command_line = match C::try_parse_from(arguments) {
        Ok(command_line) => command_line,
        Err(answer) => return print_answer(&answer),
    };
    match std::panic::catch_unwind(AssertUnwindSafe(|| run(command_line))) {
        Ok(Ok(())) => 0,
        Ok(Err(error)) => {
            complain(&error);
            exit_status(&error)
        }
        Err(_) => INTERNAL_ERROR,
    }
}

/// Prints an error in one line.
fn complain(error: &impl Display) {
    tell(format_args!("error: {}", one_line(&error.to_string())));
}

/// Prints the answer of the argument parser and returns the exit status. The answer is the help, the
/// version, or an error in the arguments. Help that cannot be written is an error.
fn print_answer(answer: &clap::Error) -> u8 {
    let printed = answer.print().and_then(|()| std::io::stdout().flush());
    match printed {
        Err(e) if e.kind() != ErrorKind::BrokenPipe && !answer.use_stderr() => {
            let error = CliError::StandardOutput(reason(&e));
            complain(&error);
            error.exit_status()
        }
        _ => answer.exit_code() as u8,
    }
}

/// Makes a panic print one line to standard error, unless `RUST_BACKTRACE` is set.
fn report_panics_in_one_sentence() {
    if std::env::var_os("RUST_BACKTRACE").is_some_and(|v| v != "0") {
        return;
    }
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|l| format!(" ({}:{})", l.file(), l.line())).unwrap_or_default();
        let what = panic.payload_as_str().unwrap_or("no message");
        tell(format_args!("error: internal error, please report it: {}{place}", one_line(what)));
    }));
}

/// Joins lines and escapes control characters: messages of other libraries may contain both.
fn one_line(text: &str) -> String {
    escaped(&text.lines().map(str::trim).filter(|l| !l.is_empty()).collect::<Vec<_>>().join(" "))
}
