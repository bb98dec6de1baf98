//! Files of epipolar geometry for other programs, each in the convention of its readers.
//!
//! | [`Format`] | read by | F | centre of the upper left pixel |
//! |---|---|---|---|
//! | [`Json`](Format::Json) | this program, scripts | `x2ᵀ F x1 = 0` | (0, 0) |
//! | [`Text`](Format::Text) | people, `awk` | `x2ᵀ F x1 = 0` | (0, 0) |
//! | [`OpencvYaml`](Format::OpencvYaml) | `cv::FileStorage` | `x2ᵀ F x1 = 0` | (0, 0) |
//! | [`Matlab`](Format::Matlab), written only | MATLAB, Octave, the VGG toolbox | `x2ᵀ F x1 = 0`, and `F_vgg` transposed | (1, 1) |
//!
//! A [`GeometryFile`] is in the convention of this program; writing converts. Every file states its
//! convention in words and carries a self-check: the epipolar distances of its point pairs,
//! computed from the numbers in the file. Numbers have enough digits to restore the same `f64`.
//!
//! Pitfall: reading assumes the convention of the format. A file may have been written in another
//! convention; [`crate::convention`] detects this from matches.

mod content;
mod coordinates;
mod fields;
mod format;
mod json;
mod labels;
mod mapping;
mod matlab;
mod notation;
mod opencv_yaml;
mod quantity;
#[cfg(test)]
mod tests;
mod text;
mod views;
#[cfg(test)]
mod views_tests;
mod yaml;

use std::path::Path;

use self::content::BareNumbers;
use self::coordinates::WrittenGeometry;
use self::fields::Fields;
use super::npy::rows_as_text;
use super::number::rows;
use super::opencv_xml::{is_xml, xml_value};
use super::output::{OutputFile, WriteError};
use super::read::{Problem, ReadError, read_bytes, text_of};
use super::vgg::read_camera;
use crate::camera::PicturesOf;
use crate::geometry::{FundamentalMatrix, PointPair};

pub use self::content::{CalibratedNote, GeometryFile, ImageNote};
#[cfg(feature = "colmap")]
pub(super) use self::coordinates::{moved_fundamental, moved_pair, shift};
pub use self::format::Format;
pub use self::labels::{PairLabel, PairOrigin, TrustNote};
pub use self::notation::Notation;
pub(super) use self::fields::insert;
pub(super) use self::yaml::{DEEPEST, plain_scalar, yaml_value};

/// Largest structured text that is read, bytes. Parsing takes about 15 times its length in memory.
const MOST_STRUCTURED: usize = 16 << 20;

impl GeometryFile {
    /// Returns the content of a file.
    pub fn to_text(&self, format: Format) -> String {
        let written = WrittenGeometry::new(self, format);
        match format {
            Format::Json => json::write(&written),
            Format::Text => text::write(&written),
            Format::OpencvYaml => opencv_yaml::write(&written),
            Format::Matlab => matlab::write(&written),
        }
    }

    /// Writes a file completely or not at all.
    pub fn write(&self, path: &Path, format: Format) -> Result<(), WriteError> {
        OutputFile::prepare(path)?.write(self.to_text(format).as_bytes())
    }

    /// Reads a file of any format except MATLAB's, detected from its content. Bare numbers are
    /// accepted: nine are an `F` row by row, rows of four are point pairs.
    pub fn read(path: &Path) -> Result<(Self, Format), ReadError> {
        Self::read_for(path, BareNumbers::Anything)
    }

    /// Reads a text of any format except MATLAB's.
    pub fn parse(text: &str) -> Result<(Self, Format), Problem> {
        Self::parse_for(text, BareNumbers::Anything)
    }

    /// Reads a file that must hold `F` or two cameras. Six bare rows of four numbers are cameras.
    pub fn read_geometry(path: &Path) -> Result<(FundamentalMatrix, Self), ReadError> {
        let (file, _) = Self::read_for(path, BareNumbers::Geometry)?;
        let missing = match &file.cameras {
            Some(_) => SAME_CENTRE,
            None => {
                "there is no fundamental matrix in it (\"F\" or \"fundamental\"), nor two cameras (\"P1\" and \"P2\")"
            }
        };
        let fundamental = file.geometry().ok_or_else(|| ReadError::content(path, missing))?;
        Ok((fundamental, file))
    }

    /// Reads two files with a camera each.
    pub fn read_cameras([left, right]: [&Path; 2]) -> Result<(FundamentalMatrix, Self), ReadError> {
        let cameras = Some([read_camera(left)?, read_camera(right)?]);
        let file = Self { cameras, ..Self::of(PicturesOf::Untold) };
        let fundamental = file.geometry().ok_or_else(|| ReadError::content(right, SAME_CENTRE))?;
        Ok((fundamental, file))
    }

    fn read_for(path: &Path, wanted: BareNumbers) -> Result<(Self, Format), ReadError> {
        Self::parse_for(&text_or_rows(path, read_bytes(path)?)?, wanted)
            .map_err(|problem| problem.of_file(path))
    }

    fn parse_for(text: &str, wanted: BareNumbers) -> Result<(Self, Format), Problem> {
        let format = Format::of_content(text);
        if format != Format::Text && text.len() > MOST_STRUCTURED {
            return Err(Problem::whole(format!(
                "the file is larger than {} MiB, the limit for {}. Save the point pairs as plain text",
                MOST_STRUCTURED >> 20,
                format.label()
            )));
        }
        let fields: Fields = match format {
            Format::Json => json::read(text)?,
            Format::Text => text::read(text, wanted)?,
            Format::OpencvYaml if is_xml(text) => Fields::from_value(&xml_value(text)?)?,
            Format::OpencvYaml => opencv_yaml::read(text)?,
            Format::Matlab => return Err(Problem::whole(MATLAB_SCRIPT)),
        };
        Ok((fields.interpret()?, format))
    }
}

const SAME_CENTRE: &str = "the two cameras have the same centre, so there is no fundamental matrix";

/// Advice for a MATLAB script, which only MATLAB can evaluate.
const MATLAB_SCRIPT: &str = "this is a MATLAB script, which is written but not read. Save the numbers as text: writematrix(F, 'F.txt', 'Delimiter', ' ')";

/// Reads `F` from a file of any [`Format`]. Two cameras in place of `F` are accepted, as are nine
/// bare numbers row by row or six rows of four (two cameras).
pub fn read_fundamental(path: &Path) -> Result<FundamentalMatrix, ReadError> {
    Ok(GeometryFile::read_geometry(path)?.0)
}

/// Returns the text of a file, or the rows of a NumPy array as text.
fn text_or_rows(path: &Path, bytes: Vec<u8>) -> Result<String, ReadError> {
    match rows_as_text(&bytes) {
        Some(text) => text.map_err(|problem| ReadError::content(path, problem)),
        None => text_of(path, bytes),
    }
}

/// Reads the point pairs of a file of any [`Format`], in the pictures as they are; at least one.
pub fn read_point_pairs(path: &Path) -> Result<Vec<PointPair>, ReadError> {
    point_pairs(path, read_bytes(path)?, GeometryFile::original_pairs)
}

/// Parses the bytes of a file and returns those of its point pairs that `select` takes; at least one.
pub(super) fn point_pairs(
    path: &Path,
    bytes: Vec<u8>,
    select: fn(GeometryFile) -> Result<Vec<PointPair>, String>,
) -> Result<Vec<PointPair>, ReadError> {
    let none = || ReadError::content(path, "no point pairs found. Each row needs x1 y1 x2 y2");
    let text = text_or_rows(path, bytes)?;
    let (file, _) = match GeometryFile::parse(&text) {
        // An empty file needs no list of field names.
        Err(_) if rows(&text).next().is_none() => return Err(none()),
        other => other.map_err(|problem| problem.of_file(path))?,
    };
    let pairs = select(file).map_err(|problem| ReadError::content(path, problem))?;
    if pairs.is_empty() { Err(none()) } else { Ok(pairs) }
}
