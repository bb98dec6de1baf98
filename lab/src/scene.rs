//! Image pairs with ground truth.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

use super::printed::printed_errors;
use super::{KnownPair, PrintedErrors};
use super::{mean, median};
use epiline::estimate::{CancelFlag, PreparedPair};
use epiline::geometry::{FundamentalMatrix, PointPair, epipolar_difference, symmetric_epipolar_distance};
use epiline::image::{GrayPlane, LoadError, Picture};
use epiline::internals::excerpt;
use epiline::io::{
    CameraRig, GroundTruth, PairFiles, ReadError, SequenceError, TruthError, TruthOrigin, VggFolder,
    has_image_extension, is_sequence, pair_folder, read_sequence,
};
use epiline::motion::{BackgroundParameters, MotionError, Silhouettes};
use epiline::synthetic::SamplePair;

/// Reason why an evaluation is impossible. The message is shown to the user.
#[derive(Debug, Error)]
pub enum EvaluateError {
    /// A file or folder cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// An image cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A sequence cannot be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// A sequence has no usable motion.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A pair has no ground truth.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// There is no pair of the requested name.
    #[error("there is no pair {0}. Choose one of {1}")]
    UnknownPair(String, String),
    /// No two views have the requested step.
    #[error("the folder has only {views} views, too few for a step of {step}")]
    Step {
        /// Number of views.
        views: usize,
        /// Requested step.
        step: usize,
    },
    /// There is no such method.
    #[error("there is no method {0}. Choose one of {1}")]
    UnknownMethod(String, String),
    /// Threads cannot be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Number of threads.
        threads: usize,
        /// Reason given by the system.
        reason: String,
    },
}

/// Cap on the distance between lines, as a fraction of the longer side of the larger image. Larger
/// errors are equally wrong.
const FAR: f64 = 0.1;

/// Image pair with true matches and a true F.
#[derive(Debug, Clone)]
pub struct KnownScene {
    /// Name of the pair, unique within a run.
    pub name: String,
    /// Images, or the first frames of sequences.
    pub images: [Arc<GrayPlane>; 2],
    /// Moving silhouettes in the common frames of two sequences.
    pub silhouettes: Option<[Arc<Silhouettes>; 2]>,
    /// All true matches.
    pub matches: Vec<PointPair>,
    /// True F.
    pub truth: FundamentalMatrix,
    /// Origin of the true F.
    pub origin: TruthOrigin,
    /// Errors printed by the published experiment, if it has this pair.
    pub printed: Option<PrintedErrors>,
}

/// Pairs of a folder that can be evaluated, and notes on the others.
#[derive(Debug, Default)]
pub struct SceneSet {
    /// Pairs with ground truth, at least one.
    pub scenes: Vec<KnownScene>,
    /// Notes on the excluded pairs, one sentence each.
    pub left_out: Vec<String>,
}

impl SceneSet {
    /// Collects the readable pairs. Returns the first error if there are none.
    fn of(
        results: impl Iterator<Item = (String, Result<KnownScene, EvaluateError>)>,
    ) -> Result<Self, EvaluateError> {
        let mut set = Self::default();
        let mut first = None;
        for (name, result) in results {
            match result {
                Ok(scene) => set.scenes.push(scene),
                Err(error) => {
                    set.left_out.push(format!("{} was left out: {error}.", excerpt(&name)));
                    first = first.or(Some(error));
                }
            }
        }
        first.filter(|_| set.scenes.is_empty()).map_or(Ok(set), Err)
    }
}

impl KnownScene {
    fn new(known: GroundTruth, images: [Arc<GrayPlane>; 2], printed: Option<PrintedErrors>) -> Self {
        let GroundTruth { name, fundamental: truth, matches, origin } = known;
        Self { name, images, silhouettes: None, matches, truth, origin, printed }
    }

    /// Returns the scene of a built-in pair.
    pub fn of_sample(name: &str, pair: SamplePair) -> Self {
        let SamplePair { pictures, fundamental, matches, .. } = pair;
        let known = GroundTruth { name: name.to_owned(), fundamental, matches, origin: TruthOrigin::Cameras };
        Self::new(known, pictures.map(|picture| Arc::new(picture.gray)), None)
    }

    /// Prepares the images and silhouettes for estimates.
    pub fn prepared(&self) -> PreparedPair {
        let [image1, image2] = &self.images;
        let prepared = PreparedPair::new(image1, image2);
        match &self.silhouettes {
            Some(silhouettes) => prepared.with_silhouettes(silhouettes.clone()),
            None => prepared,
        }
    }

    /// Returns the ground truth that determines the clicks.
    pub fn known(&self) -> KnownPair<'_> {
        let frames = self.images.each_ref().map(|image| image.frame());
        KnownPair { name: &self.name, frames, truth: &self.truth, matches: &self.matches }
    }

    /// Returns the longer side of the larger image, px.
    pub fn longer_side(&self) -> f64 {
        self.images.iter().map(|i| i.frame().longer_side()).fold(0.0, f64::max)
    }

    /// Returns the limit of a good error at the true matches: 1 % of the longer side, px.
    pub fn good_error(&self) -> f64 {
        0.01 * self.longer_side()
    }

    /// Returns the symmetric epipolar distance of every true match under an F, px.
    pub fn distances(&self, fundamental: &FundamentalMatrix) -> Vec<f64> {
        self.matches.iter().map(|m| symmetric_epipolar_distance(fundamental, m)).collect()
    }

    /// Returns the mean distance between the estimated and the true epipolar lines over the whole
    /// images ([`epipolar_difference`], capped at a tenth of the longer side), px. If the true
    /// matches lie on one plane, lines may pass through all of them and be wrong elsewhere. Returns
    /// `None` if the true F was fitted to the matches, as it is then unknown elsewhere.
    pub fn off_everywhere(&self, fundamental: &FundamentalMatrix) -> Option<f64> {
        let frames = self.images.each_ref().map(|image| image.frame());
        let off = || epipolar_difference(fundamental, &self.truth, frames, FAR * self.longer_side());
        (self.origin != TruthOrigin::Matches).then(off)
    }

    /// Returns the median angle between the estimated and the true epipolar lines, over the true
    /// matches and both images, radians. If matches move little between the images, lines at any
    /// angle may pass within a few px of them. The angle is then more informative than the
    /// distances.
    pub fn turned(&self, fundamental: &FundamentalMatrix) -> f64 {
        let both = [fundamental, &self.truth];
        let pairs = self.matches.iter().flat_map(|m| {
            [both.map(|f| f.line1_from_point2(m.point2)), both.map(|f| f.line2_from_point1(m.point1))]
        });
        let angles: Vec<f64> = pairs.filter_map(|[line, truth]| Some(line?.angle_to(&truth?))).collect();
        median(&angles)
    }

    /// Returns the mean distance of the true matches under the true F, px. No estimate can be much
    /// better.
    pub fn truth_error(&self) -> f64 {
        mean(&self.distances(&self.truth))
    }
}

/// Reads pairs like [`vgg_scene_set`]; an unreadable pair is an error.
pub fn vgg_scenes(folder: &Path, step: usize, only: &[String]) -> Result<Vec<KnownScene>, EvaluateError> {
    vgg_results(folder, step, only)?.into_iter().map(|(_, scene)| scene).collect()
}

/// Reads the pairs of views of a VGG folder that are `step` apart, named `0-1`, `1-2`, …. If `only`
/// is not empty, it names the pairs to read. The true F comes from the two cameras.
pub fn vgg_scene_set(folder: &Path, step: usize, only: &[String]) -> Result<SceneSet, EvaluateError> {
    SceneSet::of(vgg_results(folder, step, only)?.into_iter())
}

/// Pairs or errors by name.
type NamedScenes = Vec<(String, Result<KnownScene, EvaluateError>)>;

fn vgg_results(folder: &Path, step: usize, only: &[String]) -> Result<NamedScenes, EvaluateError> {
    let set = VggFolder::open(folder)?;
    let views = set.cameras.len();
    let named: Vec<_> =
        (0..views.saturating_sub(step)).map(|v| (format!("{v}-{}", v + step), v, v + step)).collect();
    if named.is_empty() {
        return Err(EvaluateError::Step { views, step });
    }
    let mut loaded: BTreeMap<usize, Arc<GrayPlane>> = BTreeMap::new();
    let mut load = |view: usize| -> Result<_, EvaluateError> {
        if let Some(plane) = loaded.get(&view) {
            return Ok(plane.clone());
        }
        let plane = Arc::new(Picture::open(&set.images[view])?.gray);
        loaded.insert(view, plane.clone());
        Ok(plane)
    };
    let mut scene = |view1: usize, view2: usize| {
        let truth = GroundTruth::of_views(&set, [view1, view2])?;
        let images = [load(view1)?, load(view2)?];
        let frame = images[0].frame();
        let size = [frame.width, frame.height];
        let printed = printed_errors(&set.prefix, views, size, [view1, view2]);
        Ok(KnownScene::new(truth, images, printed))
    };
    let chosen = chosen(named, only, |(name, ..)| name)?;
    Ok(chosen.into_iter().map(|(name, view1, view2)| (name, scene(view1, view2))).collect())
}

/// Reads all pairs of cameras of a folder of sequences, named `cam1-cam2` and so on. If `only` is
/// not empty, it names the pairs to read. The sequences must start at the same time. The true F
/// comes from the two cameras.
pub fn sequence_scene_set(
    folder: &Path,
    only: &[String],
    cancel: &CancelFlag,
) -> Result<SceneSet, EvaluateError> {
    let rig = CameraRig::open(folder)?;
    let count = rig.names.len();
    let pairs = (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second]));
    let named: Vec<_> = pairs.map(|pair| (rig.pair_name(pair), pair)).collect();
    let mut read: BTreeMap<usize, (Arc<GrayPlane>, Arc<Silhouettes>)> = BTreeMap::new();
    let mut load = |camera: usize| -> Result<_, EvaluateError> {
        if let Some(known) = read.get(&camera) {
            return Ok(known.clone());
        }
        let file = read_sequence(&rig.sequences[camera], cancel, &|_| ())?;
        let moving = Silhouettes::new(&file.sequence, &BackgroundParameters::default(), cancel)?;
        let loaded = (Arc::new(file.first.gray), Arc::new(moving));
        read.insert(camera, loaded.clone());
        Ok(loaded)
    };
    let mut scene = |pair: [usize; 2]| -> Result<KnownScene, EvaluateError> {
        let truth = GroundTruth::of_cameras(&rig, pair)?;
        let ((image1, moving1), (image2, moving2)) = (load(pair[0])?, load(pair[1])?);
        let together = Silhouettes::overlapping([&moving1, &moving2], 0)?;
        let scene = KnownScene::new(truth, [image1, image2], None);
        Ok(KnownScene { silhouettes: Some(together.map(Arc::new)), ..scene })
    };
    let chosen = chosen(named, only, |(name, _)| name)?;
    SceneSet::of(chosen.into_iter().map(|(name, pair)| (name, scene(pair))))
}

/// Reads pairs like [`pair_scene_set`]; an unreadable pair is an error.
pub fn pair_scenes(folder: &Path, only: &[String]) -> Result<Vec<KnownScene>, EvaluateError> {
    pair_results(folder, only)?.map(|(_, scene)| scene).collect()
}

/// Reads the pairs of a folder of `NAMEA.*`, `NAMEB.*` and `NAME.txt`. If `only` is not empty, it
/// names the pairs to read. The true F is read from `NAME_F.txt` or fitted to all matches.
pub fn pair_scene_set(folder: &Path, only: &[String]) -> Result<SceneSet, EvaluateError> {
    SceneSet::of(pair_results(folder, only)?)
}

fn pair_results(
    folder: &Path,
    only: &[String],
) -> Result<impl Iterator<Item = (String, Result<KnownScene, EvaluateError>)>, EvaluateError> {
    let scene = |files: &PairFiles| {
        let truth = GroundTruth::of_pair(files)?;
        let [a, b] = &files.images;
        let images = [Arc::new(Picture::open(a)?.gray), Arc::new(Picture::open(b)?.gray)];
        Ok(KnownScene::new(truth, images, None))
    };
    let chosen = chosen(pair_folder(folder)?, only, |files| &files.name)?;
    Ok(chosen.into_iter().map(move |files| {
        let scene = scene(&files);
        (files.name, scene)
    }))
}

/// Returns the files of a folder that an evaluation may read: images, frames of sequences, and
/// ground truth.
pub fn files_read(folder: &Path) -> Vec<PathBuf> {
    const KNOWN: [&str; 4] = ["txt", "p", "corners", "nview-corners"];
    let entries =
        |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_read = |path: &PathBuf| {
        let is_known = |e: &std::ffi::OsStr| KNOWN.iter().any(|known| e.eq_ignore_ascii_case(known));
        has_image_extension(path) || path.extension().is_some_and(is_known) || is_sequence(path)
    };
    let (folders, files): (Vec<_>, Vec<_>) = entries(folder).partition(|path| path.is_dir());
    let frames = folders.iter().flat_map(|folder| entries(folder)).filter(|path| has_image_extension(path));
    files.into_iter().filter(is_read).chain(frames).collect()
}

/// Selects the scenes named in `only`, keeping their order; all if `only` is empty.
fn chosen<T>(all: Vec<T>, only: &[String], name: impl Fn(&T) -> &String) -> Result<Vec<T>, EvaluateError> {
    if let Some(unknown) = only.iter().find(|asked| all.iter().all(|t| name(t) != *asked)) {
        let known = all.iter().map(|t| name(t).as_str()).collect::<Vec<_>>().join(", ");
        return Err(EvaluateError::UnknownPair(unknown.clone(), known));
    }
    Ok(all.into_iter().filter(|t| only.is_empty() || only.contains(name(t))).collect())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use epiline::geometry::{Camera, Frame, Point};
    use nalgebra::{Point3, Vector3};

    /// Creates a scene of exact matches under two general cameras, with grey images.
    pub(crate) fn example_scene(name: &str, matches: usize) -> KnownScene {
        let camera = |x: f64, y: f64, z: f64| {
            let (position, target) = (Point3::new(x, y, z), Point3::new(0.1, 0.0, 6.0));
            let up = Vector3::new(0.0, -1.0, 0.05);
            Camera::looking_at(position, target, up, 800.0, Point::new(383.5, 287.5)).unwrap()
        };
        let (camera1, camera2) = (camera(-0.4, 0.0, 0.0), camera(0.7, -0.2, 0.4));
        let frame = Frame::new(768, 576);
        let plane = Arc::new(GrayPlane::from_fn(frame, |_, _| 128.0));
        let matches = (0..)
            .filter_map(|k| {
                let t = f64::from(k);
                let x =
                    Point3::new((t * 0.9).sin() * 2.0, (t * 1.7).cos() * 1.5, 5.0 + (t * 2.3).sin() * 2.0);
                let pair = PointPair { point1: camera1.project(&x)?, point2: camera2.project(&x)? };
                (frame.contains(pair.point1) && frame.contains(pair.point2)).then_some(pair)
            })
            .take(matches)
            .collect();
        let fundamental = Camera::fundamental(&camera1, &camera2).unwrap();
        let known = GroundTruth { name: name.to_owned(), fundamental, matches, origin: TruthOrigin::Cameras };
        KnownScene::new(known, [plane.clone(), plane], None)
    }

    #[test]
    fn only_the_named_pairs_and_a_clear_word_about_others() {
        let all = || ["a", "b", "c"].map(str::to_owned).to_vec();
        let pick = |only: &[&str]| {
            let only: Vec<_> = only.iter().map(|s| (*s).to_owned()).collect();
            chosen(all(), &only, |name| name)
        };
        assert_eq!(pick(&[]).unwrap(), all());
        assert_eq!(pick(&["c", "a"]).unwrap(), ["a", "c"]);
        assert_eq!(pick(&["d"]).unwrap_err().to_string(), "there is no pair d. Choose one of a, b, c");
    }

    #[test]
    fn the_true_f_fits_the_true_matches() {
        let scene = example_scene("s", 20);
        assert!(scene.truth_error() < 1e-8 && scene.turned(&scene.truth) < 1e-8);
    }
}
