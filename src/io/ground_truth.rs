//! What is known about an image pair beforehand: its true matches and the true F.

use thiserror::Error;

use super::camera_rig::CameraRig;
use super::geometry_file::{read_fundamental, read_point_pairs};
use super::pair_folder::PairFiles;
use super::read::ReadError;
use super::vgg::VggFolder;
use crate::geometry::{
    Camera, EightPointError, FundamentalMatrix, PointPair, eight_point, median, symmetric_epipolar_distance,
};

/// Why a pair has no ground truth. Each message is one sentence for the user.
#[derive(Debug, Error)]
pub enum TruthError {
    /// The file of the matches could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The matches of a pair determine no true F.
    #[error("{name}: no true geometry, because {source}")]
    Matches {
        /// The pair.
        name: String,
        /// Why.
        source: EightPointError,
    },
    /// The F of a file is not that of the matches.
    #[error(
        "{name}: {name}_F.txt and {name}.txt do not belong together, half of the matches are more than {off:.0} px off its \
         epipolar lines; expected is F with x2ᵀ F x1 = 0, the centre of the top-left pixel at (0, 0)"
    )]
    OtherGeometry {
        /// The pair.
        name: String,
        /// Median distance of the matches, px.
        off: f64,
    },
    /// Two cameras have no F.
    #[error("{name}: the two cameras have the same centre, so there is no true geometry")]
    SameCentre {
        /// The pair.
        name: String,
    },
}

/// Where a true F comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TruthOrigin {
    /// Two known cameras.
    Cameras,
    /// A file beside the matches.
    File,
    /// Fitted to all true matches with the normalised eight-point algorithm.
    Matches,
}

/// Median distance of the matches, relative to how far they reach, above which an F is not theirs: transposed, of
/// other pictures, or of another size of them.
const OTHER_GEOMETRY: f64 = 0.02;

/// What is known about an image pair.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundTruth {
    /// A name of the pair, unique within its folder.
    pub name: String,
    /// The true F, from image 1 to image 2.
    pub fundamental: FundamentalMatrix,
    /// All true matches.
    pub matches: Vec<PointPair>,
    /// Where the true F comes from.
    pub origin: TruthOrigin,
}

impl GroundTruth {
    /// Two views of a VGG folder, by their numbers, called `0-1` and so on: F from their cameras, the tracks
    /// seen in both as matches.
    ///
    /// # Panics
    /// When there are no such views.
    pub fn of_views(set: &VggFolder, [view1, view2]: [usize; 2]) -> Result<Self, TruthError> {
        let name = format!("{view1}-{view2}");
        let Some(fundamental) = Camera::fundamental(&set.cameras[view1], &set.cameras[view2]) else {
            return Err(TruthError::SameCentre { name });
        };
        let matches = set.matches(view1, view2);
        Ok(Self { name, fundamental, matches, origin: TruthOrigin::Cameras })
    }

    /// Two cameras of a rig, by their numbers: F from the cameras, and the true matches of their file.
    ///
    /// # Panics
    /// When there are no such cameras.
    pub fn of_cameras(rig: &CameraRig, pair: [usize; 2]) -> Result<Self, TruthError> {
        let name = rig.pair_name(pair);
        let Some(fundamental) = Camera::fundamental(&rig.cameras[pair[0]], &rig.cameras[pair[1]]) else {
            return Err(TruthError::SameCentre { name });
        };
        Ok(Self { name, fundamental, matches: rig.matches(pair)?, origin: TruthOrigin::Cameras })
    }

    /// A pair of a folder of pairs: the matches of its file, and F of the file beside it or fitted to all of them.
    pub fn of_pair(files: &PairFiles) -> Result<Self, TruthError> {
        let name = files.name.clone();
        let matches = read_point_pairs(&files.matches)?;
        if let Some(path) = &files.fundamental {
            let fundamental = read_fundamental(path)?;
            let off = median_distance(&fundamental, &matches);
            let extent =
                matches.iter().flat_map(|m| [m.point1, m.point2]).map(|p| p.x.max(p.y)).fold(1.0, f64::max);
            if off > OTHER_GEOMETRY * extent {
                return Err(TruthError::OtherGeometry { name, off });
            }
            return Ok(Self { name, fundamental, matches, origin: TruthOrigin::File });
        }
        match eight_point(&matches) {
            Ok(fundamental) => Ok(Self { name, fundamental, matches, origin: TruthOrigin::Matches }),
            Err(source) => Err(TruthError::Matches { name, source }),
        }
    }
}

fn median_distance(fundamental: &FundamentalMatrix, matches: &[PointPair]) -> f64 {
    median(matches.iter().map(|pair| symmetric_epipolar_distance(fundamental, pair)))
}
