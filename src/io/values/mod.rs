//! Named values in files: trees of YAML and of OpenCV's XML, archives of NumPy, and what names say about them.

mod match_arrays;
mod match_names;
mod matrix_name;
mod npz;
mod opencv_xml;
mod quantity;
mod yaml;

pub(super) use self::match_arrays::{FoundMatches, NamedArray, check_pixels, matches_of, shape_in_words};
pub(super) use self::match_names::{concerns_matches, names_points, names_scores};
pub(super) use self::matrix_name::MatrixName;
pub(super) use self::npz::archive;
pub(super) use self::opencv_xml::{is_xml, xml_value};
pub(super) use self::quantity::{Quantity, insert, there_twice};
pub(super) use self::yaml::{NOT_YAML, yaml_value};
