//! Files: geometry in the formats of other programs, point pairs, folders of pairs, the VGG layout, and output that is
//! never half written.

mod geometry_file;
mod number;
mod output;
mod pair_folder;
mod point_pairs;
mod read;
mod vgg;

pub use geometry_file::{Format, GeometryFile, ImageNote, Problem, read_fundamental, read_point_pairs};
pub use output::{OutputFile, WriteError};
pub use pair_folder::{PairFiles, pair_folder};
pub use point_pairs::{PairProblem, parse_point_pairs};
pub use read::ReadError;
pub use vgg::{VggFolder, read_camera};
