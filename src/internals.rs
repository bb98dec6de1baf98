//! Parts of the library for the program, its tests and benchmarks, and the laboratory. They are not
//! part of the public interface and may change at any time.

/// Comparison of methods on the same points.
pub mod comparison {
    pub use crate::comparison::{
        Distances, FitError, KnownPair, PointFit, Purpose, SPACING, Spread, apart, fit_eight, fit_seven,
        generator, mean, median, share_below,
    };
}

/// Building blocks of a command line.
#[cfg(feature = "cli")]
pub mod cli {
    pub use crate::cli::{
        CliError, Output, Overrides, main_with, pixels, run_program, tell, threads, whole, with_parameter,
    };
}

/// The window.
#[cfg(feature = "inspector")]
pub mod app {
    pub use crate::app::{AppError, Inspector, Opening, Services, Start, install_theme, model, run};
}

#[cfg(feature = "files")]
pub use crate::foreign::excerpt;
