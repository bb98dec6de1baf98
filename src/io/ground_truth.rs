//! What is known about an image pair beforehand: its true matches and the true F.

use thiserror::Error;

use super::camera_rig::CameraRig;
use super::geometry_file::read_point_pairs;
use super::pair_folder::PairFiles;
use super::read::ReadError;
use super::vgg::VggFolder;
use crate::geometry::{Camera, EightPointError, FundamentalMatrix, PointPair, eight_point};

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
    /// Fitted to all true matches with the normalised eight-point algorithm.
    Matches,
}

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

    /// A pair of a folder of pairs: the matches of its file, and F fitted to all of them.
    pub fn of_pair(files: &PairFiles) -> Result<Self, TruthError> {
        let name = files.name.clone();
        let matches = read_point_pairs(&files.matches)?;
        match eight_point(&matches) {
            Ok(fundamental) => Ok(Self { name, fundamental, matches, origin: TruthOrigin::Matches }),
            Err(source) => Err(TruthError::Matches { name, source }),
        }
    }
}
