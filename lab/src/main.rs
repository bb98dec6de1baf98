//! The program `epiline-lab`: accuracy of the estimators on pairs with ground truth.

use std::process::ExitCode;

fn main() -> ExitCode {
    epiline_lab::main()
}
