//! Command line: the library of the window, for tests, benchmarks and scripts.
//!
//! Text for people goes to standard output, progress and errors to standard error. Exit statuses: 0
//! success, 1 a computation without a result, 2 invalid input, 130 stopped by Ctrl-C, 70 an error
//! in the program itself.

mod arguments;
mod barcode;
mod check;
mod console;
mod convert;
mod error;
mod estimate;
mod evaluate;
mod geometry_file;
mod output;
mod overrides;
mod rectify;
mod result_output;
mod suggest;
mod window;

use clap::{Parser, Subcommand};

pub use console::{complain, print_answer, report_panics_in_one_sentence};
pub use error::{CliError, INTERNAL_ERROR};

/// See and trust the epipolar geometry of two images, from two clicked point pairs.
///
/// Without a command, the window opens, with two images or with the built-in sample. Coordinates
/// are pixels, x to the right and y down; the centre of the top-left pixel is (0, 0).
#[derive(Debug, Parser)]
#[command(name = "epiline", version, args_conflicts_with_subcommands = true)]
pub struct CommandLine {
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
    Estimate(Box<estimate::EstimateArguments>),
    Evaluate(evaluate::EvaluateArguments),
    Rectify(rectify::RectifyArguments),
    Suggest(suggest::SuggestArguments),
}

impl CommandLine {
    /// Runs the command.
    pub fn run(self) -> Result<(), CliError> {
        match self.command {
            None => window::run(self.window),
            Some(CliCommand::Barcode(arguments)) => barcode::run(&arguments),
            Some(CliCommand::Check(arguments)) => check::run(&arguments),
            Some(CliCommand::Convert(arguments)) => convert::run(&arguments),
            Some(CliCommand::Estimate(arguments)) => estimate::run(&arguments),
            Some(CliCommand::Evaluate(arguments)) => evaluate::run(&arguments),
            Some(CliCommand::Rectify(arguments)) => rectify::run(&arguments),
            Some(CliCommand::Suggest(arguments)) => suggest::run(&arguments),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_of_the_command_line_is_consistent() {
        <CommandLine as clap::CommandFactory>::command().debug_assert();
    }
}
