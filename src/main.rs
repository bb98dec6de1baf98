//! The program `epiline`: the command line of the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    epiline::main()
}
