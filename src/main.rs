//! The program `epiline`: a thin wrapper of the library's command line.

use std::process::ExitCode;

use clap::Parser;
use epiline::cli::{CommandLine, INTERNAL_ERROR, complain, print_answer, report_panics_in_one_sentence};

fn main() -> ExitCode {
    report_panics_in_one_sentence();
    let command_line = match CommandLine::try_parse() {
        Ok(command_line) => command_line,
        Err(answer) => return ExitCode::from(print_answer(&answer)),
    };
    match std::panic::catch_unwind(|| command_line.run()) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            complain(&error);
            ExitCode::from(error.exit_status())
        }
        Err(_) => ExitCode::from(INTERNAL_ERROR),
    }
}
