//! `F` as source code, for pasting into other programs.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use super::coordinates::{moved_fundamental, numbers, one_line};
use super::mapping::{Language, mapping};
use super::{Format, TrustNote};
use crate::camera::PicturesOf;
use crate::geometry::FundamentalMatrix;
use crate::io::values::Quantity;
use crate::presentation::pictures_in_words;

named! {
    fn name;
    /// Notation of a matrix in another language.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Notation {
        /// Python with `import numpy as np`.
        NumPy = "NumPy",
        /// C++ with OpenCV's `cv::Matx`.
        Cpp = "C++ (OpenCV)",
        /// MATLAB and Octave, which count pixels from 1.
        Matlab = "MATLAB",
        /// LaTeX with `amsmath`, rounded to six digits.
        Latex = "LaTeX",
        /// JSON with the field names of this program.
        Json = "JSON",
    }
}

impl Notation {
    /// Returns `F` in this notation. Comments state the convention, the pictures that `F` belongs to, what the
    /// geometry is, and the verdict; JSON has fields instead. With a lens, code leads from the pictures to `F`.
    pub fn text(
        self,
        fundamental: &FundamentalMatrix,
        pictures: &PicturesOf,
        trust: Option<&TrustNote>,
    ) -> String {
        let origin = if self == Self::Matlab { Format::Matlab.origin() } else { 0.0 };
        let moved = moved_fundamental(fundamental, origin);
        let matrix = moved.as_ref().unwrap_or(fundamental);
        let rows = matrix.rows();
        if self == Self::Json {
            let mut fields = Map::from_iter([(Quantity::Fundamental.word().to_owned(), json!(rows))]);
            if let Ok(Value::Object(pictures)) = serde_json::to_value(pictures) {
                fields.extend(pictures);
            }
            let words = trust.into_iter().flat_map(|trust| {
                [
                    ("geometry", json!(trust.geometry)),
                    ("verdict", json!(trust.verdict)),
                    ("reasons", json!(trust.reasons)),
                ]
            });
            fields.extend(words.map(|(name, value)| (name.to_owned(), value)));
            return format!("{}\n", json!(fields));
        }
        let comment = match self {
            Self::NumPy | Self::Json => "#",
            Self::Cpp => "//",
            Self::Matlab | Self::Latex => "%",
        };
        let mut text = format!(
            "{comment} x2' F x1 = 0 in pixels; the centre of the upper left pixel is ({origin}, {origin}).\n"
        );
        for sentence in pictures_in_words(pictures, origin) {
            let _ = writeln!(text, "{comment} {sentence}");
        }
        if let Some(trust) = trust {
            let _ = writeln!(text, "{comment} {}", one_line(&trust.in_words()));
        }
        let joined =
            |separator: &str| rows.iter().map(|row| numbers(row, ", ")).collect::<Vec<_>>().join(separator);
        let _ = match self {
            Self::NumPy | Self::Json => writeln!(text, "F = np.array([\n    [{}],\n])", joined("],\n    [")),
            Self::Cpp => writeln!(text, "const cv::Matx33d F(\n    {});", joined(",\n    ")),
            Self::Matlab => writeln!(text, "F = [\n    {};\n];", joined(";\n    ")),
            Self::Latex => {
                let row = |row: &[f64; 3]| row.iter().map(|v| in_latex(*v)).collect::<Vec<_>>().join(" & ");
                let rows = rows.iter().map(row).collect::<Vec<_>>().join(" \\\\\n    ");
                writeln!(text, "\\begin{{bmatrix}}\n    {rows}\n\\end{{bmatrix}}")
            }
        };
        let language = match self {
            Self::NumPy => Language::Python,
            Self::Cpp => Language::Cpp,
            Self::Matlab => Language::Matlab,
            Self::Latex | Self::Json => return text,
        };
        if let Some(views) = pictures.views() {
            let _ = writeln!(
                text,
                "{comment} F belongs to undistorted1 and undistorted2 of places in the pictures:"
            );
            text += &mapping(views, language, origin);
        }
        text
    }
}

/// Returns a number with six significant digits, as `1.5 \times 10^{-3}`.
fn in_latex(value: f64) -> String {
    let written = format!("{value:.5e}");
    match written.split_once('e') {
        Some((digits, "0")) => digits.to_owned(),
        Some((digits, exponent)) => format!("{digits} \\times 10^{{{exponent}}}"),
        None => written,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::example_fundamental as example;
    use crate::geometry::{Point, PointPair, symmetric_epipolar_distance};
    use crate::io::GeometryFile;

    /// Returns the numbers between the first mark and the last one.
    fn numbers_within(text: &str, begin: &str, end: &str) -> Vec<f64> {
        let text = text.split_once(begin).unwrap().1.rsplit_once(end).unwrap().0;
        let words = text.split(|c: char| c.is_whitespace() || ",;[]".contains(c));
        words.filter(|word| !word.is_empty()).map(|word| word.parse().unwrap()).collect()
    }

    #[test]
    fn code_has_every_digit_row_by_row() {
        let f = example();
        let expected = f.rows().concat();
        let numpy = Notation::NumPy.text(&f, &PicturesOf::Original, None);
        assert!(numpy.starts_with("# x2' F x1 = 0"), "{numpy}");
        assert_eq!(numbers_within(&numpy, "F = np.array([", "])"), expected);
        let cpp = Notation::Cpp.text(&f, &PicturesOf::Original, None);
        assert!(cpp.starts_with("// x2' F x1 = 0"), "{cpp}");
        assert_eq!(numbers_within(&cpp, "const cv::Matx33d F(", ");"), expected);
        let json = Notation::Json.text(&f, &PicturesOf::Original, None);
        assert_eq!(GeometryFile::parse(&json).unwrap().0.fundamental, Some(f));
    }

    #[test]
    fn matlab_counts_pixels_from_one() {
        let f = example();
        let text = Notation::Matlab.text(&f, &PicturesOf::Original, None);
        assert!(text.contains("pixel is (1, 1)"), "{text}");
        let found = nalgebra::Matrix3::from_row_slice(&numbers_within(&text, "F = [", "];"));
        let found = FundamentalMatrix::from_rank_two(found).unwrap();
        let place = Point::new(120.0, 75.0);
        let line = f.line2_from_point1(place).unwrap();
        let foot = line.foot(Point::new(200.0, 90.0));
        let shifted = PointPair::new(place.x + 1.0, place.y + 1.0, foot.x + 1.0, foot.y + 1.0);
        assert!(symmetric_epipolar_distance(&found, &shifted) < 1e-6);
        assert!(symmetric_epipolar_distance(&f, &shifted) > 1e-3, "the two conventions differ here");
    }

    #[test]
    fn latex_rounds_to_six_digits() {
        assert_eq!(in_latex(-1.234_567_8e-5), "-1.23457 \\times 10^{-5}");
        assert_eq!(in_latex(0.0), "0.00000");
        assert_eq!(in_latex(1.5), "1.50000");
        let text = Notation::Latex.text(&example(), &PicturesOf::Original, None);
        assert_eq!((text.matches(" & ").count(), text.matches("\\\\\n").count()), (6, 2), "{text}");
    }

    #[test]
    fn each_notation_tells_the_verdict() {
        let geometry = "hypothesis 3 of 8, not the result".to_owned();
        let trust = TrustNote { geometry, verdict: "doubtful".into(), reasons: Vec::new() };
        for notation in Notation::ALL {
            let text = notation.text(&example(), &PicturesOf::Original, Some(&trust));
            assert!(
                text.contains("doubtful") && text.contains("hypothesis 3 of 8, not the result"),
                "{text}"
            );
            assert!(
                text.contains("the pictures as they are") || text.contains("\"pictures\":\"original\""),
                "{text}"
            );
        }
    }
}
