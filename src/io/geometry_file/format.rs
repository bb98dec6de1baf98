//! File formats of geometry: names, extensions, coordinates, and their detection.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::io::point_pairs::is_of_pictures;
use crate::io::values::{Quantity, is_xml};

named! {
    fn name;
    /// Format of a geometry file.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Format {
        /// JSON with the field names of a result of `epiline estimate`.
        Json = "json",
        /// Plain text with comments.
        Text = "text",
        /// OpenCV `FileStorage`, YAML. XML is read, too.
        OpencvYaml = "opencv-yaml",
        /// Script for MATLAB and Octave, written only.
        Matlab = "matlab",
    }
}

/// Variables assigned by a script besides the quantities.
const MATLAB_ALSO_ASSIGNED: [&str; 32] = [
    "F_vgg",
    "tform1",
    "tform2",
    "image1",
    "image2",
    "self_check",
    "verdict",
    "reasons",
    "pair_names",
    "pair_origins",
    "geometry",
    "pictures",
    "view1",
    "view2",
    "picture1",
    "picture2",
    "undistorted1",
    "undistorted2",
    "K1",
    "K2",
    "D1",
    "D2",
    "View1",
    "View2",
    "n",
    "x",
    "y",
    "u",
    "v",
    "s",
    "k",
    "f",
];

impl Format {
    /// Returns the name for display.
    pub fn label(self) -> &'static str {
        match self {
            Self::Json => "JSON",
            Self::Text => "plain text",
            Self::OpencvYaml => "OpenCV FileStorage (YAML)",
            Self::Matlab => "MATLAB, Octave and VGG",
        }
    }

    /// Returns the file extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Text => "txt",
            Self::OpencvYaml => "yml",
            Self::Matlab => "m",
        }
    }

    /// Returns the format of a file extension, ignoring case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|f| f.extension() == extension).or(match extension.as_str() {
            "yaml" => Some(Self::OpencvYaml),
            _ => None,
        })
    }

    /// Detects the format of a text. Plain text is the fallback.
    pub fn of_content(text: &str) -> Self {
        let start = text.trim_start();
        if start.starts_with(['{', '[']) {
            return Self::Json;
        }
        if start.starts_with("%YAML") || start.starts_with("---") || is_xml(text) {
            return Self::OpencvYaml;
        }
        let mut lines = text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with(['#', '%']));
        let Some(first) = lines.clone().next() else { return Self::Text };
        if is_of_pictures(text) {
            return Self::Text;
        }
        if is_word_before(first, ':') {
            return Self::OpencvYaml;
        }
        // A script may begin with any statement.
        if lines.any(|line| is_word_before(line, '=')) { Self::Matlab } else { Self::Text }
    }

    /// Returns a warning about a file name. MATLAB runs a script by its name, which must be a valid
    /// variable name and none of the variables that the script assigns.
    pub fn note_on_name(self, path: &Path) -> Option<String> {
        if self != Self::Matlab {
            return None;
        }
        let name = path.file_stem()?.to_string_lossy();
        let is_variable = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !is_variable {
            return Some(format!(
                "MATLAB cannot run a script called {name}. Use letters, digits and _, beginning with a letter"
            ));
        }
        let is_assigned = Quantity::named(&name).is_some() || MATLAB_ALSO_ASSIGNED.contains(&&*name);
        is_assigned.then(|| {
            format!("in MATLAB the script {name} hides the variable {name}, and the variable hides the script. Rename the file")
        })
    }

    /// Returns the coordinate of the centre of the upper left pixel, in x and y, px.
    pub fn origin(self) -> f64 {
        match self {
            Self::Json | Self::Text | Self::OpencvYaml => 0.0,
            Self::Matlab => 1.0,
        }
    }

    /// Returns the convention as sentences in ASCII.
    pub fn convention(self) -> Vec<String> {
        let origin = self.origin();
        let mut sentences = vec![
            "F maps points of image 1 to their epipolar lines in image 2: x2' F x1 = 0, line2 = F x1, line1 = F' x2, F e1 = 0, F' e2 = 0."
                .to_owned(),
            format!(
                "Pixels: x to the right, y down; the centre of the upper left pixel is ({origin}, {origin})."
            ),
            "Matrices are listed row by row; points are x, y; pairs are x1, y1, x2, y2.".to_owned(),
        ];
        sentences.extend(self.peculiarities().iter().map(|s| (*s).to_owned()));
        sentences
    }

    /// Returns sentences for readers of this format only.
    fn peculiarities(self) -> &'static [&'static str] {
        match self {
            Self::Json | Self::Text => &[],
            Self::OpencvYaml => &[
                "This is the F of cv::findFundamentalMat and cv::computeCorrespondEpilines; H1 and H2 are for cv::warpPerspective.",
            ],
            Self::Matlab => &[
                "F is that of estimateFundamentalMatrix and epipolarLine, [p2 1] * F * [p1 1]' = 0 for points as rows, and of vgg_F_from_P.",
                "F_vgg is its transpose, which vgg_gui_F and vgg_F_from_7pts_2img have.",
                "H1 and H2 act on columns (projtform2d); tform1 and tform2 are their transposes, which act on rows (projective2d, maketform).",
            ],
        }
    }
}

/// Returns whether a line begins with a word followed by the character, spaces allowed between
/// them.
fn is_word_before(line: &str, mark: char) -> bool {
    line.split_once(mark).is_some_and(|(word, _)| {
        let word = word.trim_end();
        !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || c == '_')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_extensions_are_told_apart() {
        for format in Format::ALL {
            let name = format!("some/Result.{}", format.extension().to_uppercase());
            assert_eq!(Format::of_path(Path::new(&name)), Some(format));
        }
        assert_eq!(Format::of_path(Path::new("a.yaml")), Some(Format::OpencvYaml));
        assert_eq!(Format::of_path(Path::new("a.png")), None);
        assert_eq!(Format::of_path(Path::new("json")), None);
    }

    #[test]
    fn the_content_tells_the_format() {
        for (text, format) in [
            ("  {\"F\": 1}", Format::Json),
            ("[[1, 2]]", Format::Json),
            ("%YAML:1.0\n---", Format::OpencvYaml),
            ("# c\nF: !!opencv-matrix", Format::OpencvYaml),
            ("% c\n\nF = [1 2", Format::Matlab),
            ("F=[1 2", Format::Matlab),
            ("clear all\nF = [1 2", Format::Matlab),
            ("# c\nF\n1 2 3", Format::Text),
            ("1 2 3 4", Format::Text),
            ("x1,y1,x2,y2\n1,2,3,4", Format::Text),
            ("", Format::Text),
            ("% only a comment", Format::Text),
            ("= 3", Format::Text),
            ("\u{e9}t\u{e9}: 3", Format::OpencvYaml),
        ] {
            assert_eq!(Format::of_content(text), format, "{text:?}");
        }
    }

    #[test]
    fn conventions_are_plain_text_fit_for_every_comment() {
        for format in Format::ALL {
            for sentence in format.convention() {
                assert!(
                    sentence.is_ascii() && !sentence.contains("--") && sentence.ends_with('.'),
                    "{sentence}"
                );
            }
        }
    }
}
