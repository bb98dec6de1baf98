//! Ground truth of image pairs: true matches and the true F.

use thiserror::Error;

use super::camera_rig::CameraRig;
use super::geometry_file::{read_fundamental, read_point_pairs};
use super::pair_folder::PairFiles;
use super::read::ReadError;
use super::vgg::VggFolder;
use crate::geometry::{
    Camera, EightPointError, FundamentalMatrix, PointPair, eight_point, median, symmetric_epipolar_distance,
};

/// Reason why a pair has no ground truth. The message is shown to the user.
#[derive(Debug, Error)]
pub enum TruthError {
    /// The file of the matches cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The matches of a pair determine no F.
    #[error("{0} has no true geometry: {1}")]
    Matches(String, #[source] EightPointError),
    /// The F of a file does not fit the matches: their median distance, px.
    #[error(
        "{name}_F.txt does not fit the matches in {name}.txt. Half of them are more than {off:.0} px from their epipolar \
         lines. F must satisfy x2ᵀ F x1 = 0, with the centre of the top-left pixel at (0, 0)"
    )]
    OtherGeometry { name: String, off: f64 },
    /// Both cameras have the same centre.
    #[error("{0} has no true geometry: the two cameras have the same centre")]
    SameCentre(String),
}

/// Origin of a true F.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TruthOrigin {
    /// Two known cameras.
    Cameras,
    /// File beside the matches.
    File,
    /// Normalised eight-point fit to all true matches.
    Matches,
}

/// Largest median distance of the matches that an F from a file may have, as a share of the largest
/// coordinate, which is at most the longer side of the images. Above it, F is transposed or belongs
/// to other images or another size.
const OTHER_GEOMETRY: f64 = 0.02;

/// Ground truth of an image pair.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundTruth {
    /// Name of the pair, unique within its folder.
    pub name: String,
    /// True F, from image 1 to image 2.
    pub fundamental: FundamentalMatrix,
    /// All true matches.
    pub matches: Vec<PointPair>,
    /// Origin of the true F.
    pub origin: TruthOrigin,
}

impl GroundTruth {
    /// Returns the ground truth of two views of a VGG folder, selected by number and named `0-1`
    /// and so on. F comes from the cameras; the matches are the tracks visible in both views.
    ///
    /// # Panics
    /// When a view does not exist.
    pub fn of_views(set: &VggFolder, [view1, view2]: [usize; 2]) -> Result<Self, TruthError> {
        let matches = || Ok(set.matches(view1, view2));
        Self::between(format!("{view1}-{view2}"), &set.cameras[view1], &set.cameras[view2], matches)
    }

    /// Reads the ground truth of two cameras of a rig, selected by number. F comes from the
    /// cameras, the matches from their file.
    ///
    /// # Panics
    /// When a camera does not exist.
    pub fn of_cameras(rig: &CameraRig, pair: [usize; 2]) -> Result<Self, TruthError> {
        let [camera1, camera2] = pair.map(|number| &rig.cameras[number]);
        Self::between(rig.pair_name(pair), camera1, camera2, || rig.matches(pair))
    }

    fn between(
        name: String,
        camera1: &Camera,
        camera2: &Camera,
        matches: impl FnOnce() -> Result<Vec<PointPair>, ReadError>,
    ) -> Result<Self, TruthError> {
        match Camera::fundamental(camera1, camera2) {
            Some(fundamental) => {
                Ok(Self { name, fundamental, matches: matches()?, origin: TruthOrigin::Cameras })
            }
            None => Err(TruthError::SameCentre(name)),
        }
    }

    /// Reads the ground truth of a pair in a folder of pairs. F comes from its own file, or is fitted
    /// to all matches.
    pub fn of_pair(files: &PairFiles) -> Result<Self, TruthError> {
        let name = files.name.clone();
        let matches = files.matches.as_deref().map(read_point_pairs).transpose()?.unwrap_or_default();
        if let Some(path) = &files.fundamental {
            let fundamental = read_fundamental(path)?;
            let off = median_distance(&fundamental, &matches);
            let largest =
                matches.iter().flat_map(|m| [m.point1, m.point2]).map(|p| p.x.max(p.y)).fold(1.0, f64::max);
            if off > OTHER_GEOMETRY * largest {
                return Err(TruthError::OtherGeometry { name, off });
            }
            return Ok(Self { name, fundamental, matches, origin: TruthOrigin::File });
        }
        match eight_point(&matches) {
            Ok(fundamental) => Ok(Self { name, fundamental, matches, origin: TruthOrigin::Matches }),
            Err(source) => Err(TruthError::Matches(name, source)),
        }
    }
}

fn median_distance(fundamental: &FundamentalMatrix, matches: &[PointPair]) -> f64 {
    median(matches.iter().map(|pair| symmetric_epipolar_distance(fundamental, pair)))
}
