//! Command line: the computations of the window, for scripts.
//!
//! Text for people goes to standard output, progress and errors to standard error. Exit statuses: 0
//! success, 1 a computation without a result, 2 invalid input, 70 an error in the program itself.

mod arguments;
mod barcode;
mod calibration;
mod check;
mod console;
mod convert;
mod error;
mod estimate;
mod estimate_arguments;
mod geometry_file;
mod judge;
mod output;
mod overrides;
mod points;
mod rectify;
#[cfg(test)]
mod reference;
mod result_output;
mod suggest;
mod window;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub use arguments::{pixels, threads, whole};
use console::run_with_arguments;
pub use console::{run_program, tell};
pub use error::CliError;
pub use output::Output;
pub use overrides::{Overrides, with_parameter};

/// See and trust the epipolar geometry of two images, from two clicked point pairs.
///
/// Without a command, the window opens, with two images or with the built-in sample. Coordinates
/// are pixels, x to the right and y down; the centre of the top-left pixel is (0, 0).
#[derive(Debug, Parser)]
#[command(name = "epiline", version, args_conflicts_with_subcommands = true)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<CliCommand>,
    #[command(flatten)]
    window: window::WindowArguments,
}

#[derive(Debug, Subcommand)]
enum CliCommand {
    Barcode(Box<barcode::BarcodeArguments>),
    Check(check::CheckArguments),
    Convert(convert::ConvertArguments),
    Estimate(Box<estimate_arguments::EstimateArguments>),
    Judge(judge::JudgeArguments),
    Rectify(rectify::RectifyArguments),
    Suggest(suggest::SuggestArguments),
}

/// Runs the program `epiline`.
pub fn main() -> ExitCode {
    run_program(CommandLine::run, CliError::exit_status)
}

/// Runs the program `epiline` with arguments, the first of which is its name. Returns the exit status.
pub fn main_with(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    run_with_arguments(arguments, CommandLine::run, CliError::exit_status)
}

impl CommandLine {
    fn run(self) -> Result<(), CliError> {
        match self.command {
            None => window::run(self.window),
            Some(CliCommand::Barcode(arguments)) => barcode::run(&arguments),
            Some(CliCommand::Check(arguments)) => check::run(&arguments),
            Some(CliCommand::Convert(arguments)) => convert::run(&arguments),
            Some(CliCommand::Estimate(arguments)) => estimate::run(&arguments),
            Some(CliCommand::Judge(arguments)) => judge::run(&arguments),
            Some(CliCommand::Rectify(arguments)) => rectify::run(&arguments),
            Some(CliCommand::Suggest(arguments)) => suggest::run(&arguments),
        }
    }
}
