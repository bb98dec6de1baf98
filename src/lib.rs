//! Epipolar geometry of two images from two clicked point pairs.
//!
//! See `ARCHITECTURE.md` for the layout.

#[cfg(feature = "inspector")]
pub mod app;
pub mod cli;
pub mod estimate;
pub mod evaluate;
pub mod geometry;
pub mod image;
pub mod io;
pub mod similarity;
pub mod suggest;
pub mod synthetic;
