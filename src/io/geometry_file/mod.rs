//! Epipolar geometry as files that other programs read, each in the convention its readers expect.
//!
//! | [`Format`] | read by | F | centre of the upper left pixel |
//! |---|---|---|---|
//! | [`Json`](Format::Json) | this program, scripts | `x2ᵀ F x1 = 0` | (0, 0) |
//! | [`Text`](Format::Text) | people, `awk` | `x2ᵀ F x1 = 0` | (0, 0) |
//! | [`OpencvYaml`](Format::OpencvYaml) | `cv::FileStorage` | `x2ᵀ F x1 = 0` | (0, 0) |
//! | [`Matlab`](Format::Matlab), written only | MATLAB, Octave, the VGG toolbox | `x2ᵀ F x1 = 0`, and `F_vgg` transposed | (1, 1) |
//!
//! A [`GeometryFile`] is in the convention of this program; writing converts.
//! Every file says its convention in words and carries a self-check: the distances of its own point pairs to
//! their epipolar lines, from the numbers as they stand in the file. Numbers are written with as many digits as
//! bring back the same `f64`.
//!
//! Pitfall: a reader knows the convention of a format, not what somebody did before writing a file. Whether a
//! matrix means what its format says is for [`crate::convention`] to find out, with matches.

mod content;
mod coordinates;
mod fields;
mod format;
mod json;
mod labels;
mod matlab;
mod opencv_yaml;
mod quantity;
#[cfg(test)]
mod tests;
mod text;

use std::path::Path;

use self::content::BareNumbers;
use self::coordinates::WrittenGeometry;
use self::fields::Fields;
use super::number::rows;
use super::output::{OutputFile, WriteError};
use super::read::{ReadError, read_text};
use crate::geometry::{FundamentalMatrix, PointPair};

pub use self::content::{GeometryFile, ImageNote, Problem};
pub use self::format::Format;
pub use self::labels::{PairLabel, PairOrigin, TrustNote};

/// The largest text with nested lists that is read; every number and list in it takes some 15 times its length in
/// memory.
const MOST_STRUCTURED: usize = 16 << 20;

impl GeometryFile {
    /// The whole content of a file.
    pub fn to_text(&self, format: Format) -> String {
        let written = WrittenGeometry::new(self, format);
        match format {
            Format::Json => json::write(&written),
            Format::Text => text::write(&written),
            Format::OpencvYaml => opencv_yaml::write(&written),
            Format::Matlab => matlab::write(&written),
        }
    }

    /// Writes a file, whole or not at all.
    pub fn write(&self, path: &Path, format: Format) -> Result<(), WriteError> {
        OutputFile::prepare(path)?.write(self.to_text(format).as_bytes())
    }

    /// Reads a file of any of the formats but MATLAB's; which one, its content tells. Bare numbers are taken too: nine are
    /// an `F` row by row, rows of four are point pairs.
    pub fn read(path: &Path) -> Result<(Self, Format), ReadError> {
        Self::read_for(path, BareNumbers::Anything)
    }

    /// Reads a text of any of the formats but MATLAB's.
    pub fn parse(text: &str) -> Result<(Self, Format), Problem> {
        Self::parse_for(text, BareNumbers::Anything)
    }

    /// Reads a file that is to hold `F` or two cameras: six bare rows of four numbers are cameras.
    pub fn read_geometry(path: &Path) -> Result<(Self, Format), ReadError> {
        let (file, format) = Self::read_for(path, BareNumbers::Geometry)?;
        if file.geometry().is_none() {
            let problem = match &file.cameras {
                Some(_) => "the two cameras have the same centre, so there is no fundamental matrix",
                None => {
                    "there is no fundamental matrix in it (\"F\" or \"fundamental\") and no two cameras (\"P1\", \"P2\")"
                }
            };
            return Err(ReadError::content(path, problem));
        }
        Ok((file, format))
    }

    fn read_for(path: &Path, wanted: BareNumbers) -> Result<(Self, Format), ReadError> {
        Self::parse_for(&read_text(path)?, wanted).map_err(|problem| problem.of_file(path))
    }

    fn parse_for(text: &str, wanted: BareNumbers) -> Result<(Self, Format), Problem> {
        if text.trim_start().starts_with('<') {
            return Err(Problem::whole(XML));
        }
        let format = Format::of_content(text);
        if format != Format::Text && text.len() > MOST_STRUCTURED {
            return Err(Problem::whole(format!(
                "the file is larger than {} MiB, too large for {}: save the point pairs as plain text",
                MOST_STRUCTURED >> 20,
                format.label()
            )));
        }
        let fields: Fields = match format {
            Format::Json => json::read(text)?,
            Format::Text => text::read(text, wanted)?,
            Format::OpencvYaml => opencv_yaml::read(text)?,
            Format::Matlab => return Err(Problem::whole(MATLAB_SCRIPT)),
        };
        Ok((fields.interpret()?, format))
    }
}

/// The refusal of XML, with the words by which OpenCV converts it.
const XML: &str = "this is XML, which is not read: convert it to YAML with OpenCV in Python, s = cv2.FileStorage('F.xml', 0); cv2.FileStorage('F.yml', 1).write('F', s.getNode('F').mat())";

/// What to do with a script, which only MATLAB can evaluate.
const MATLAB_SCRIPT: &str = "this is a MATLAB script, which is written but not read: save the numbers as text, writematrix(F, 'F.txt', 'Delimiter', ' ')";

/// Reads `F` from a file of any [`Format`], of its two cameras if there is no other; or from nine bare numbers
/// row by row, or six rows of four (two cameras).
pub fn read_fundamental(path: &Path) -> Result<FundamentalMatrix, ReadError> {
    let (file, _) = GeometryFile::read_geometry(path)?;
    let missing = || ReadError::content(path, "there is no fundamental matrix in it");
    file.geometry().ok_or_else(missing)
}

/// Reads the point pairs of a file of any [`Format`]; at least one.
pub fn read_point_pairs(path: &Path) -> Result<Vec<PointPair>, ReadError> {
    let none = || ReadError::content(path, "no point pairs found, expected rows of x1 y1 x2 y2");
    // Piped data can be read once.
    let text = read_text(path)?;
    let (file, _) = match GeometryFile::parse(&text) {
        // Nothing at all is nothing to explain names of fields for.
        Err(_) if rows(&text).next().is_none() => return Err(none()),
        other => other.map_err(|problem| problem.of_file(path))?,
    };
    if file.pairs.is_empty() { Err(none()) } else { Ok(file.pairs) }
}
