//! What a document is made of.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::geometry::{Frame, FundamentalMatrix, HomogeneousPoint, Point, PointPair};
use crate::image::Picture;
use crate::io::PairOrigin;

/// One of the two images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// Image 1.
    Left,
    /// Image 2.
    Right,
}

impl Side {
    /// Both, left first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// 0 or 1, for arrays with one entry an image.
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }

    /// The other image.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The point of a pair in this image.
    pub fn point(self, pair: &PointPair) -> Point {
        match self {
            Self::Left => pair.point1,
            Self::Right => pair.point2,
        }
    }

    /// The epipole of a geometry in this image.
    pub fn epipole(self, f: &FundamentalMatrix) -> HomogeneousPoint {
        match self {
            Self::Left => f.epipole1(),
            Self::Right => f.epipole2(),
        }
    }

    /// What the user reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

/// Which picture a document is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureIdentity {
    /// File name, or the name of a built-in sample.
    pub name: String,
    /// Where it came from, if from a file.
    pub path: Option<PathBuf>,
    /// Size of the picture.
    pub frame: Frame,
}

impl From<&Picture> for PictureIdentity {
    fn from(picture: &Picture) -> Self {
        Self { name: picture.name.clone(), path: picture.path.clone(), frame: picture.frame() }
    }
}

/// Where the ground truth in use comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TruthSource {
    /// A built-in sample, by its name.
    Sample(String),
    /// Two views of a folder.
    Folder {
        /// The folder, in the VGG layout or one of pairs.
        folder: PathBuf,
        /// The names of the left and the right view: those of their images without the ending.
        views: [String; 2],
    },
}

/// A geometry that came from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Imported {
    /// The matrix in the convention of this program.
    pub fundamental: FundamentalMatrix,
    /// The name of the file, or of the two.
    pub file: String,
    /// How the numbers of the file were taken.
    pub reading: String,
    /// What matches said about that; none if nobody asked them.
    pub check: Option<Checked>,
}

/// What matches said about a geometry from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checked {
    /// How many they were.
    pub matches: usize,
    /// What they are called.
    pub of: String,
    /// Their median symmetric epipolar distance, px.
    pub median: f64,
    /// Whether that is small enough.
    pub fits: bool,
}

/// The first click of a pair whose second click is due.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HalfPair {
    /// The image that was clicked.
    pub side: Side,
    /// Where, px.
    pub point: Point,
}

/// One clicked point: a pair by its number, and the image. The number after the last pair means the
/// half-finished one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct PointRef {
    /// Number of the pair, from 0.
    pub pair: usize,
    /// The image.
    pub side: Side,
}

/// What a pair is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The geometry is estimated from it.
    Used,
    /// The pair only shows how well the geometry fits.
    Check,
    /// The pair was left out.
    Excluded,
}

/// What is noted of a pair besides its points.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairNote {
    /// What a person calls it; without one it has the name of its place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Where its points come from.
    #[serde(default)]
    pub origin: PairOrigin,
}

/// What a pair is called: `p`, `q`, `r`, then numbers.
pub fn pair_name(pair: usize) -> String {
    match pair {
        0 => "p".to_owned(),
        1 => "q".to_owned(),
        2 => "r".to_owned(),
        more => (more + 1).to_string(),
    }
}

/// So many point pairs, in words.
pub fn counted(pairs: usize) -> String {
    if pairs == 1 { "1 point pair".to_owned() } else { format!("{pairs} point pairs") }
}
