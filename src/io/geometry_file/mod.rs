//! Files of epipolar geometry for other programs, each in the convention of its readers.
//!
//! What is read is wider than what is written: XML of OpenCV, NumPy arrays and archives, and a matrix that is
//! printed in any notation ([`printed`]). What was read and what was left out is in [`GeometryFile::remarks`].
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
mod notes;
mod of_calibration;
mod opencv_yaml;
mod printed;
#[cfg(test)]
mod tests;
mod text;
mod views;
#[cfg(test)]
mod views_tests;

use std::path::Path;

use nalgebra::Matrix3;
use serde::de::IgnoredAny;
use serde_json::Value;

use self::content::BareNumbers;
use self::coordinates::WrittenGeometry;
use self::fields::Fields;
use self::notes::GeometryNote;
use self::printed::NoMatrix;
use super::npy::{Array, is_npy};
use super::number::{cells, rows};
use super::output::{OutputFile, WriteError};
use super::read::{Problem, ReadError, read_bytes, text_of};
use super::values::{NOT_YAML, archive, is_xml, xml_value};
use super::vgg::read_camera;
use crate::camera::PicturesOf;
use crate::geometry::{FundamentalMatrix, PointPair};

pub use self::content::{CalibratedNote, GeometryFile, ImageNote};
pub(super) use self::coordinates::shift;
#[cfg(feature = "colmap")]
pub(super) use self::coordinates::{moved_fundamental, moved_pair};
pub use self::format::Format;
pub use self::labels::{PairLabel, PairOrigin, TrustNote};
pub use self::notation::Notation;

/// Largest structured text that is read, bytes. Parsing takes about 15 times its length in memory.
const MOST_STRUCTURED: usize = 16 << 20;

/// Largest text that is searched for a printed matrix, bytes.
const MOST_PRINTED: usize = 1 << 20;
const LONG: &str = "a text of more than 1 MiB is not searched for a matrix. Save its nine numbers alone";

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

    /// Reads a file of any format except own MATLAB scripts, detected from its content, or NumPy arrays. Bare numbers
    /// are accepted: nine are an `F`, whatever stands around them, rows of four are point pairs.
    pub fn read(path: &Path) -> Result<(Self, Format), ReadError> {
        Self::read_for(path, BareNumbers::Anything)
    }

    /// Reads a text like [`read`](Self::read).
    pub fn parse(text: &str) -> Result<(Self, Format), Problem> {
        Self::parse_for(text, BareNumbers::Anything)
    }

    /// Reads a file that must hold `F` or two cameras. Six bare rows of four numbers are cameras.
    pub fn read_geometry(path: &Path) -> Result<(FundamentalMatrix, Self), ReadError> {
        let (file, _) = Self::read_for(path, BareNumbers::Geometry)?;
        let missing = match &file.cameras {
            Some(_) => SAME_CENTRE,
            None => file.not_fundamental.as_deref().unwrap_or(
                "there is no fundamental matrix in it (\"F\" or \"fundamental\"), nor two cameras (\"P1\" and \"P2\")",
            ),
        };
        let fundamental = file.geometry().ok_or_else(|| ReadError::content(path, missing))?;
        Ok((fundamental, file))
    }

    /// Reads two files with a camera each. Their notes tell whether they are rectified.
    pub fn read_cameras([left, right]: [&Path; 2]) -> Result<(FundamentalMatrix, Self), ReadError> {
        let cameras = Some([read_camera(left)?, read_camera(right)?]);
        let file = Self { cameras, ..Self::of(PicturesOf::Untold) }.noted();
        let fundamental = file.geometry().ok_or_else(|| ReadError::content(right, SAME_CENTRE))?;
        Ok((fundamental, file))
    }

    fn read_for(path: &Path, wanted: BareNumbers) -> Result<(Self, Format), ReadError> {
        let read = Self::of_bytes(path, read_bytes(path)?, wanted);
        of_calibration::completed(path, read).map(|(file, format)| (file.noted(), format))
    }

    /// Adds the notes that follow from the geometry itself.
    fn noted(mut self) -> Self {
        if self.essential.is_some() {
            self.remarks.push(GeometryNote::Essential.to_string());
        }
        if self.cameras.is_some() && self.geometry().is_some_and(|f| f.has_rows()) {
            self.remarks.push(GeometryNote::Rectified.to_string());
        }
        self
    }

    /// Reads the bytes of a file: an array, an archive of arrays, or a text.
    fn of_bytes(path: &Path, bytes: Vec<u8>, wanted: BareNumbers) -> Result<(Self, Format), ReadError> {
        let arrays = match &bytes {
            _ if is_npy(&bytes) => Some(Ok(vec![(String::new(), Array::parse(&bytes))])),
            _ if bytes.starts_with(b"PK") => Some(archive(bytes.clone())),
            _ => None,
        };
        if let Some(arrays) = arrays {
            let fields = arrays.map_err(Problem::whole).and_then(|arrays| Fields::from_arrays(&arrays));
            let file = fields.and_then(Fields::interpret).map_err(|problem| problem.of_file(path))?;
            return Ok((file, Format::Text));
        }
        if let Some(problem) = unread_kind(&bytes) {
            return Err(ReadError::content(path, problem));
        }
        Self::parse_for(&text_of(path, bytes)?, wanted).map_err(|problem| problem.of_file(path))
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
        if format == Format::Matlab && text.contains("written by epiline") {
            return Err(Problem::whole(MATLAB_SCRIPT));
        }
        let has_nine = || {
            let mut numbers = rows(text).flat_map(|(_, row)| cells(row)).map(str::parse::<f64>);
            numbers.by_ref().take(9).flatten().count() == 9 && numbers.next().is_none()
        };
        let strict = match format {
            // Numbers without anything around them.
            Format::Text if !text::has_sections(text) && has_nine() => Err(Problem::whole("")),
            Format::Json => json::read(text),
            Format::Text => text::read(text, wanted),
            Format::OpencvYaml if is_xml(text) => {
                xml_value(text).and_then(|value| Fields::from_value(&value))
            }
            Format::OpencvYaml => opencv_yaml::read(text),
            Format::Matlab => Err(Problem::whole("")),
        };
        match strict.and_then(Fields::interpret) {
            Ok(file) => Ok((file, format)),
            Err(problem) => {
                let fields = printed_matrix(text, format, problem)?;
                Ok((fields.interpret()?, Format::Text))
            }
        }
    }
}

/// Reads a matrix that is printed in a notation of its own. `problem` is that of the format by which the text begins;
/// it is returned where the text is that format, or shows no matrix.
fn printed_matrix(text: &str, format: Format, problem: Problem) -> Result<Fields, Problem> {
    let is_certain = match format {
        Format::Json => serde_json::from_str::<IgnoredAny>(text).is_ok(),
        Format::OpencvYaml => is_xml(text) || text.trim_start().starts_with(['%', '-']),
        Format::Text | Format::Matlab => false,
    };
    if is_certain || text.len() > MOST_PRINTED {
        return Err(if problem.problem.is_empty() { Problem::whole(LONG) } else { problem });
    }
    // Any other problem tells more of YAML that is valid.
    let may_be_unclear = match format {
        Format::OpencvYaml => problem.problem.starts_with(NOT_YAML),
        // A list of names that is almost JSON is damaged.
        Format::Json if text.trim_start().starts_with('{') => false,
        _ => !text::has_sections(text),
    };
    let mut printed = printed::read(text).map_err(|error| match error {
        NoMatrix::Unclear(unclear) if may_be_unclear => Problem::whole(unclear),
        // Brackets without a name in quotation marks are a printed array, not JSON; a row or less is neither.
        NoMatrix::Count(count)
            if problem.problem.is_empty() || (format == Format::Json && count > 3 && !text.contains('"')) =>
        {
            text::expected_nine(count)
        }
        _ => problem,
    })?;
    if text.contains("upper left pixel is (1, 1)") {
        let there = shift(1.0);
        let moved = there.transpose() * Matrix3::from_row_slice(&printed.numbers) * there;
        printed.numbers = moved.transpose().as_slice().try_into().unwrap_or(printed.numbers);
        printed.notes.push("its pixels are counted from (1, 1), and F was converted to (0, 0)".to_owned());
    }
    let mut fields = Fields::default();
    // Code that is copied for pictures without distortion says so in a comment.
    if text.contains("without distortion") || text.contains("undistorted") {
        fields.pictures.read("undistorted", &Value::Bool(true)).map_err(Problem::whole)?;
    }
    fields.add_printed(printed)?;
    Ok(fields)
}

const SAME_CENTRE: &str = "the two cameras have the same centre, so there is no fundamental matrix";

/// Advice for an own script of MATLAB, which has more than a matrix.
const MATLAB_SCRIPT: &str = "this is a MATLAB script, which is written but not read. Save the numbers as text: writematrix(F, 'F.txt', 'Delimiter', ' ')";

/// Returns a sentence about files of numbers that are not read.
fn unread_kind(bytes: &[u8]) -> Option<&'static str> {
    // MATLAB up to version 4 has no mark: its file begins with the kind of the first matrix, its sides, a mark of
    // complex numbers and the length of its name, as five numbers of 32 bits.
    let header: Vec<u32> =
        bytes.chunks_exact(4).take(5).map(|b| u32::from_le_bytes(b.try_into().unwrap_or_default())).collect();
    let is_old = match header[..] {
        [kind, rows, columns, complex, name] => {
            kind < 100
                && (1..1 << 24).contains(&rows)
                && (1..1 << 24).contains(&columns)
                && complex < 2
                && (2..64).contains(&name)
        }
        _ => false,
    };
    if bytes.starts_with(b"MATLAB ") || is_old {
        return Some(
            "this is a MATLAB file (.mat), which is not read. Save the numbers in MATLAB as text: writematrix(F, 'F.txt', 'Delimiter', ' '), or writematrix([points1 points2], 'matches.txt')",
        );
    }
    let is_hdf = bytes.starts_with(b"\x89HDF\r\n\x1a\n");
    is_hdf.then_some(
        "this is an HDF5 file (.h5), which is not read. Save the keypoints and the matches of the pair in Python: import h5py, numpy; numpy.savez('matches.npz', keypoints0=…, keypoints1=…, matches0=…)",
    )
}

/// Reads `F` from a file of any [`Format`]. Two cameras in place of `F` are accepted, as are nine
/// bare numbers row by row or six rows of four (two cameras).
pub fn read_fundamental(path: &Path) -> Result<FundamentalMatrix, ReadError> {
    Ok(GeometryFile::read_geometry(path)?.0)
}

/// Reads the point pairs of a file of any [`Format`], in the pictures as they are; at least one.
pub fn read_point_pairs(path: &Path) -> Result<Vec<PointPair>, ReadError> {
    let pairs = read_pairs(path)?.original_pairs().map_err(|problem| ReadError::content(path, problem))?;
    if pairs.is_empty() { Err(no_pairs(path)) } else { Ok(pairs) }
}

/// Reads a file with point pairs; at least one, or the matches of a result.
pub(super) fn read_pairs(path: &Path) -> Result<GeometryFile, ReadError> {
    let bytes = read_bytes(path)?;
    // An empty file needs no list of field names.
    if std::str::from_utf8(&bytes).is_ok_and(|text| rows(text).next().is_none()) {
        return Err(no_pairs(path));
    }
    let (file, _) = GeometryFile::of_bytes(path, bytes, BareNumbers::Anything)?;
    if file.pairs.is_empty() && file.found.is_empty() { Err(no_pairs(path)) } else { Ok(file) }
}

fn no_pairs(path: &Path) -> ReadError {
    ReadError::content(path, "no point pairs found. Each row needs x1 y1 x2 y2")
}
