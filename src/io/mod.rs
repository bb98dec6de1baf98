//! Files: point pairs, fundamental matrices, folders of pairs, the VGG layout, and output that is never half written.

mod fundamental_file;
mod ground_truth;
mod number;
mod output;
mod pair_folder;
mod picture_file;
mod point_pairs;
mod read;
mod rectified;
mod truth_folder;
mod vgg;

pub use fundamental_file::read_fundamental;
pub use ground_truth::{GroundTruth, TruthError, TruthOrigin};
pub use output::{OutputFile, WriteError};
pub use pair_folder::{PairFiles, pair_folder};
pub use picture_file::{PictureError, PictureFormat, encode_picture};
pub use point_pairs::{PairProblem, parse_point_pairs, read_point_pairs};
pub use read::ReadError;
pub use rectified::{RectifiedError, RectifiedFiles, RectifiedOptions};
pub use truth_folder::TruthFolder;
pub use vgg::VggFolder;
