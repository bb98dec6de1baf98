//! Epipolar geometry of two images, from two or more clicked point pairs, or from none.
//!
//! A scene point seen in one image lies on a line in the other image: its epipolar line. The
//! fundamental matrix `F` maps points to their epipolar lines. **Two** point pairs are enough here
//! to find `F`: the lines through the clicks are compared by their intensities, so no further
//! points are needed.
//!
//! # The pipeline on one page
//!
//! | stage | input | output | where |
//! |---|---|---|---|
//! | load | files | [`image::Picture`]: pixels, and a grey plane of floats | [`image`] |
//! | prepare | two grey planes | [`estimate::PreparedPair`]: pyramids; corners and patch correlations when first needed | [`estimate`] |
//! | pencils | a click, a pyramid level | all lines through the click in both images; the cost of every line pair; mutual best matches | [`similarity`], [`estimate::ComparedPencils`] |
//! | hypotheses | candidate line pairs of both clicks | two line pairs and one number κ each: epipoles, a map between the pencils, an `F` | [`geometry::PencilMap`] |
//! | validation | hypotheses | hypotheses scored on lines across both images, and on patches | [`estimate::SearchTrace`] |
//! | refinement | the best hypotheses | `F` at full resolution | [`estimate::Estimate`] |
//! | features | covariant features of both images, if the result is in doubt | further geometries and views, ranked and refined alike | [`features`], [`estimate::covariant`] |
//! | judgement | the result, its matches, its rivals | a verdict with its reasons | [`estimate::Trust`]; in words: [`presentation`] |
//!
//! Each stage is a pure function of its input, the parameters and a seed. [`estimate::Monitor`]
//! receives progress reports and can stop an estimate. `docs/estimator.md` describes the stages in
//! equations; `docs/parameters.md` describes every parameter.
//!
//! # An estimate
//!
//! ```
//! use epiline::estimate::{Monitor, Parameters, estimate};
//! use epiline::geometry::symmetric_epipolar_distance;
//! use epiline::synthetic::Sample;
//!
//! // A built-in pair with its exact matches; `image::Picture::open` reads files.
//! let pair = Sample::default().load();
//! let [left, right] = &pair.pictures;
//! let clicks = pair.show_me;
//!
//! let found = estimate(&left.gray, &right.gray, &clicks, &Parameters::default(), &Monitor::silent())?;
//!
//! // The epipolar line in the right image of a point in the left image:
//! let line = found.fundamental().line2_from_point1(clicks[0].point1).ok_or("that point is the epipole")?;
//! assert!(line.distance(clicks[0].point2) < 1.0);
//!
//! // Distances of all true matches from their epipolar lines, px:
//! let f = found.fundamental();
//! let distances: Vec<f64> = pair.matches.iter().map(|m| symmetric_epipolar_distance(f, m)).collect();
//! assert!(distances.iter().sum::<f64>() / (distances.len() as f64) < 0.7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! - Pixels are `(x, y)`, x right, y down; the centre of the top-left pixel is `(0, 0)`.
//! - `F` maps image 1 (left) to image 2 (right): `x2ᵀ F x1 = 0`; rank 2, Frobenius norm 1, the
//!   entry of largest magnitude positive. [`geometry`] lists all conventions.
//! - The same images, points, parameters and seed give the same bits on any number of threads.
//!
//! # Features
//!
//! With `default-features = false` the crate is the estimator for callers who have pixels already:
//! [`geometry`], [`image`] (without files), [`features`], [`similarity`], [`motion`],
//! [`mod@estimate`], [`presentation`], [`suggest`], [`rectify`], [`convention`] and [`judge`]. Further features,
//! all on by default:
//!
//! | feature | contents |
//! |---|---|
//! | `pictures` | [`image::Picture`]: reading of picture files, warping of rectified pictures; [`study`]: the use cases of the program; [`synthetic`] |
//! | `files` (with `pictures`) | [`io`], `synthetic::Sample`: JSON, YAML and `.npy` arrays, sequences of frames |
//! | `colmap` (with `files`) | `io::GeometryFile::add_to_colmap`: databases of COLMAP; needs a C compiler |
//! | `cli` (with `colmap`) | the program `epiline` |
//! | `inspector` (with `cli`) | the window of the program |
//!
//! `ARCHITECTURE.md` shows the layout of the code and how to add to it.

#[macro_use]
mod named;

#[cfg(feature = "inspector")]
mod app;
pub mod camera;
mod cancel;
#[cfg(feature = "cli")]
mod cli;
mod comparison;
pub mod convention;
pub mod estimate;
pub mod features;
#[cfg(feature = "pictures")]
mod foreign;
pub mod geometry;
pub mod image;
#[doc(hidden)]
pub mod internals;
#[cfg(feature = "files")]
pub mod io;
pub mod judge;
mod lanes;
pub mod motion;
pub mod presentation;
pub mod rectify;
pub mod similarity;
#[cfg(all(test, feature = "files"))]
#[path = "../tests/skipping/mod.rs"]
mod skipping;
#[cfg(feature = "pictures")]
pub mod study;
pub mod suggest;
#[cfg(feature = "pictures")]
pub mod synthetic;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub use cli::main;
