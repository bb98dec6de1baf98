//! Parts of a document.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::geometry::{Camera, Frame, FundamentalMatrix, HomogeneousPoint, Point, PointPair};
use crate::image::Picture;
use crate::io::PairOrigin;
use crate::judge::GivenGeometry;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    Left,
    Right,
}

impl Side {
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// Returns 0 or 1, for arrays with one entry per image.
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }

    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    pub fn point(self, pair: &PointPair) -> Point {
        match self {
            Self::Left => pair.point1,
            Self::Right => pair.point2,
        }
    }

    pub fn epipole(self, f: &FundamentalMatrix) -> HomogeneousPoint {
        match self {
            Self::Left => f.epipole1(),
            Self::Right => f.epipole2(),
        }
    }

    /// Returns the name of the side for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// Returns the name of the side for headings.
    pub fn title(self) -> &'static str {
        match self {
            Self::Left => "Left",
            Self::Right => "Right",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureIdentity {
    /// File name, or the name of a built-in sample.
    pub name: String,
    pub path: Option<PathBuf>,
    pub frame: Frame,
}

impl From<&Picture> for PictureIdentity {
    fn from(picture: &Picture) -> Self {
        Self { name: picture.name.clone(), path: picture.path.clone(), frame: picture.frame() }
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TruthSource {
    /// A built-in sample, by name.
    Sample(String),
    /// Two views of a folder.
    Folder {
        /// The folder, in the VGG layout or with pairs.
        folder: PathBuf,
        /// Names of the left and the right view: their images without the ending.
        views: [String; 2],
    },
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Imported {
    /// Matrix in the convention of this program.
    pub fundamental: FundamentalMatrix,
    /// The cameras of the file, if they were read as they are. They allow more mistakes to be named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cameras: Option<[Camera; 2]>,
    /// Name of the file, or names of both files.
    pub file: String,
    /// Convention in which the numbers of the file were read.
    pub reading: String,
    /// Check of the geometry by matches, if there was one.
    pub check: Option<Checked>,
}

/// Name of the reading without changes, as stored in sessions.
pub const AS_READ: &str = "as read";

impl Imported {
    /// Returns whether the numbers of the file were taken without a change.
    pub fn is_as_read(&self) -> bool {
        self.reading == AS_READ
    }

    pub fn geometry(&self) -> GivenGeometry {
        GivenGeometry { cameras: self.cameras, ..self.fundamental.into() }
    }
}

/// Check of an imported geometry by matches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checked {
    pub matches: usize,
    /// Description of the matches.
    pub of: String,
    /// Median symmetric epipolar distance, px.
    pub median: f64,
    /// Whether the median is small enough.
    pub fits: bool,
}

/// The first click of a pair whose second click is due.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HalfPair {
    pub side: Side,
    /// Position of the click, px.
    pub point: Point,
}

/// One clicked point: the number of its pair, and the image. The number after the last pair refers
/// to the unfinished pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct PointRef {
    /// Number of the pair, from 0.
    pub pair: usize,
    pub side: Side,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    Used,
    /// The pair only checks the geometry.
    Check,
    Excluded,
}

impl Role {
    pub const ALL: [Self; 3] = [Self::Used, Self::Check, Self::Excluded];
}

#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairNote {
    /// Given name; without one, the pair has the name of its place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    #[serde(default)]
    pub origin: PairOrigin,
}

/// Returns the name of a place in the list: `p`, `q`, `r`, then numbers.
pub fn pair_name(pair: usize) -> String {
    match pair {
        0 => "p".to_owned(),
        1 => "q".to_owned(),
        2 => "r".to_owned(),
        more => (more + 1).to_string(),
    }
}

/// Returns a number of point pairs in words.
pub fn counted(pairs: usize) -> String {
    if pairs == 1 { "1 point pair".to_owned() } else { format!("{pairs} point pairs") }
}
