//! Pairs of this program in databases of COLMAP, and match lists for its `matches_importer`.
//!
//! A pair goes into a copy of a database: its keypoints are appended to the keypoints of both
//! images, its matches to `matches`, and the geometry with its inliers replaces the row of
//! `two_view_geometries`. Keypoints that are there keep their numbers, and so do the matches of all
//! pairs. A point at an old keypoint (within 1 px) takes the keypoint: only shared keypoints join
//! pairs to tracks.
//!
//! COLMAP counts the centre of the top-left pixel as (0.5, 0.5). The images of a pair have the
//! numbers `id1 < id2`, and the pair has the number `2147483647 id1 + id2`; a pair the other way
//! round is turned: `Fᵀ`, `Eᵀ`, `H⁻¹`, and the inverse pose. Blobs are little-endian: keypoints
//! `f32`, matches `u32`, matrices `f64`, row by row. Source: `scene/database_sqlite.cc` of COLMAP.
//!
//! Pitfall: `F` and `E` of COLMAP belong to pictures with distortion and to rays. A result for views
//! without distortion therefore leaves `F` out and needs a pose.

mod database;
mod error;
mod keypoints;
#[cfg(test)]
mod tests;

use std::collections::HashSet;
use std::fmt::{self, Display, Formatter, Write};
use std::path::Path;

use nalgebra::{Matrix3, UnitQuaternion};

use self::database::{Database, Image, StoredGeometry};
pub use self::error::ColmapError;
use self::error::ImageProblem;
use self::keypoints::Keypoints;
use super::geometry_file::{GeometryFile, moved_fundamental, moved_pair, shift};
use super::output::OutputFile;
use super::read::ReadError;
use crate::camera::RelativePose;
use crate::foreign::excerpt;
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance};

/// Coordinate of the centre of the top-left pixel in COLMAP.
const ORIGIN: f64 = 0.5;
/// Largest Sampson distance of a verified match, px: the default of COLMAP.
const MOST_DISTANCE: f64 = 4.0;

/// A pair in a database.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColmapPair {
    /// Names of both images in the database.
    pub names: [String; 2],
    /// Number of matches of the pair that were written.
    pub matches: usize,
    /// Number of matches that agree with the geometry.
    pub verified: usize,
    /// Number of new keypoints in each image.
    pub keypoints: [usize; 2],
}

impl Display for ColmapPair {
    /// Tells the matches and the images in a clause.
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let [left, right] = self.names.each_ref().map(|name| excerpt(name));
        let Self { matches, verified, .. } = self;
        write!(
            f,
            "{matches} matches of {left} and {right}, {verified} of them within {MOST_DISTANCE} px of the geometry"
        )
    }
}

/// A match of a result.
struct Pair {
    /// Points in the pictures as they are, in pixels of COLMAP.
    points: PointPair,
    /// Whether the geometry of the result agrees.
    is_verified: bool,
}

impl GeometryFile {
    /// Writes a copy of a COLMAP database with the pair added. `names` name both images in the
    /// database, by default the names of [`GeometryFile::images`]; folders may be left out.
    pub fn add_to_colmap(
        &self,
        names: Option<[&str; 2]>,
        database: &Path,
        output: &OutputFile,
    ) -> Result<ColmapPair, ColmapError> {
        let refused = refused(database);
        let (copy, images, pairs) = self.opened(names, database, output)?;
        let geometry = self.colmap_geometry().map_err(refused)?;
        let added = add(&copy, &images, &pairs, &geometry).map_err(refused)?;
        copy.finish().map_err(refused)?.put()?;
        Ok(added)
    }

    /// Writes the matches of which both points are keypoints of a COLMAP database, as a list for
    /// `matches_importer --match_type raw`. `names` are as for [`GeometryFile::add_to_colmap`].
    pub fn write_colmap_matches(
        &self,
        names: Option<[&str; 2]>,
        database: &Path,
        output: &OutputFile,
    ) -> Result<ColmapPair, ColmapError> {
        let refused = refused(database);
        let (copy, images, pairs) = self.opened(names, database, output)?;
        let (_, found) = numbered(&copy, &images, &pairs, false).map_err(refused)?;
        if found.is_empty() {
            let problem = "no match has a keypoint at both points. Write a copy of the database with the keypoints \
                           first (--output new.db)";
            return Err(refused(problem.into()).into());
        }
        if let Some(image) = images.iter().find(|image| image.name.contains(char::is_whitespace)) {
            let name = excerpt(&image.name);
            let problem =
                format!("the name {name} has a space, which lists of matches cannot hold. Rename the image");
            return Err(refused(problem).into());
        }
        let mut text = format!("{} {}\n", images[0].name, images[1].name);
        for (numbers, _) in &found {
            let _ = writeln!(text, "{} {}", numbers[0], numbers[1]);
        }
        // An empty line ends the list of a pair.
        text.push('\n');
        output.write(text.as_bytes())?;
        let verified = found.iter().filter(|(_, is_verified)| *is_verified).count();
        let names = images.map(|image| image.name);
        Ok(ColmapPair { names, matches: found.len(), verified, keypoints: [0; 2] })
    }

    /// Copies the database, and finds the images and the matches.
    fn opened(
        &self,
        names: Option<[&str; 2]>,
        database: &Path,
        output: &OutputFile,
    ) -> Result<(Database, [Image; 2], Vec<Pair>), ColmapError> {
        let copy = Database::copied(database, output)?;
        let images = self.images_in(&copy, names).map_err(|problem| problem.of(database))?;
        let pairs = self.colmap_pairs().map_err(refused(database))?;
        Ok((copy, images, pairs))
    }

    /// Finds both images, and compares their sizes.
    fn images_in(&self, database: &Database, names: Option<[&str; 2]>) -> Result<[Image; 2], ImageProblem> {
        let notes = self.images.as_ref();
        let own = || notes.map(|notes| notes.each_ref().map(|note| note.name.as_str()));
        let unnamed = || ImageProblem::Names("the result does not name its images".into());
        let [first, second] = names.or_else(own).ok_or_else(unnamed)?;
        let images = [database.image(first)?, database.image(second)?];
        if images[0].id == images[1].id {
            let name = &images[0].name;
            return Err(ImageProblem::Names(format!("both images of the result would be {name}")));
        }
        let originals = self.calibrated.as_ref().and_then(|calibrated| calibrated.frames);
        let frames = originals.or_else(|| notes.map(|notes| notes.each_ref().map(|note| note.frame)));
        for (image, frame) in images.iter().zip(frames.into_iter().flatten()) {
            if image.frame != frame {
                let problem = format!(
                    "{} has {}×{} px in the database and {}×{} px in the result. Use the pictures of the database",
                    image.name, image.frame.width, image.frame.height, frame.width, frame.height
                );
                return Err(problem.into());
            }
        }
        Ok(images)
    }

    /// Returns the clicks and the matches.
    fn colmap_pairs(&self) -> Result<Vec<Pair>, String> {
        let own: Vec<PointPair> = self.pairs.iter().chain(&self.found).copied().collect();
        let originals: Vec<Option<PointPair>> = match &self.calibrated {
            Some(calibrated) if self.pictures.is_undistorted() => calibrated.originals.clone(),
            _ if self.pictures.is_undistorted() => Vec::new(),
            _ => own.iter().copied().map(Some).collect(),
        };
        if originals.len() != own.len() {
            return Err(
                "the result does not have its points in the pictures as they are. Make it again with \
                        epiline estimate --json"
                    .into(),
            );
        }
        if own.is_empty() {
            return Err("the result has no matches".into());
        }
        let geometry = self.geometry();
        let is_near = |pair: &PointPair| geometry.is_none_or(|f| sampson_distance(&f, pair) <= MOST_DISTANCE);
        let pair = |(own, original): (&PointPair, Option<PointPair>)| {
            Some(Pair { points: moved_pair(&original?, ORIGIN), is_verified: is_near(own) })
        };
        Ok(own.iter().zip(originals).filter_map(pair).collect())
    }

    /// Returns the geometry in the convention of COLMAP, for the images in the order of the result.
    fn colmap_geometry(&self) -> Result<Geometry, String> {
        if self.is_of_different_scenes {
            return Err(
                "the pictures of the result probably show different scenes, so there is no geometry to add"
                    .into(),
            );
        }
        // A pose without a covariance belongs to an epipole that is not determined.
        let certain = self.calibrated.as_ref().filter(|calibrated| calibrated.pose_covariance.is_some());
        let pose = certain.and_then(|calibrated| calibrated.pose);
        if self.pictures.is_undistorted() && pose.is_none() {
            return Err(
                "the result has no certain pose, which pictures with distortion need: too few matches, or an epipole that \
                 is not determined"
                    .into(),
            );
        }
        let fundamental = self.geometry().filter(|_| !self.pictures.is_undistorted());
        if fundamental.is_none() && pose.is_none() {
            return Err("the result has no fundamental matrix".into());
        }
        let homography = self.homography21.filter(|_| !self.pictures.is_undistorted());
        Ok(Geometry {
            fundamental: fundamental.and_then(|f| moved_fundamental(&f, ORIGIN)),
            homography: homography.map(|h| shift(ORIGIN) * h * shift(-ORIGIN)),
            pose,
            is_plane: self.homography21.is_some(),
        })
    }
}

/// Returns how a problem becomes an error that names the database.
fn refused(database: &Path) -> impl Fn(String) -> ReadError + Copy {
    move |problem| ReadError::content(database, problem)
}

/// Geometry of a pair in pixels of COLMAP.
#[derive(Debug, Clone, Copy)]
struct Geometry {
    fundamental: Option<FundamentalMatrix>,
    homography: Option<Matrix3<f64>>,
    pose: Option<RelativePose>,
    /// Whether a plane or a turn of the camera explains the matches.
    is_plane: bool,
}

impl Geometry {
    /// Returns the geometry of the exchanged images.
    fn turned(self) -> Self {
        let turned = |pose: RelativePose| RelativePose {
            rotation: pose.rotation.inverse(),
            translation: pose.position2(),
        };
        Self {
            fundamental: self
                .fundamental
                .and_then(|f| FundamentalMatrix::from_rank_two(f.matrix().transpose())),
            homography: self.homography.and_then(Matrix3::try_inverse),
            pose: self.pose.map(turned),
            ..self
        }
    }

    fn stored(&self) -> StoredGeometry {
        // Numbers of the configurations in COLMAP.
        const CALIBRATED: i64 = 2;
        const UNCALIBRATED: i64 = 3;
        const PLANAR_OR_PANORAMIC: i64 = 6;
        let config = match (self.is_plane, &self.pose) {
            (true, _) => PLANAR_OR_PANORAMIC,
            (false, Some(_)) => CALIBRATED,
            (false, None) => UNCALIBRATED,
        };
        let rows = |matrix: &Matrix3<f64>| matrix.transpose().as_slice().to_vec();
        let quaternion = |pose: &RelativePose| {
            let q = UnitQuaternion::from_rotation_matrix(&pose.rotation);
            vec![q.w, q.i, q.j, q.k]
        };
        StoredGeometry {
            config,
            matrices: [
                ("F", self.fundamental.as_ref().map(|f| rows(f.matrix()))),
                ("E", self.pose.as_ref().map(|pose| rows(&pose.essential()))),
                ("H", self.homography.as_ref().map(rows)),
                ("qvec", self.pose.as_ref().map(quaternion)),
                ("tvec", self.pose.as_ref().map(|pose| pose.translation.as_slice().to_vec())),
            ],
        }
    }
}

/// Matches by the numbers of their keypoints, and whether the geometry agrees.
type Numbered = Vec<([u32; 2], bool)>;

/// Numbers the points of the matches. Points without a keypoint get a new one if `append` is set;
/// otherwise their matches are left out.
fn numbered(
    database: &Database,
    images: &[Image; 2],
    pairs: &[Pair],
    append: bool,
) -> Result<([Keypoints; 2], Numbered), String> {
    let mut keypoints = [database.keypoints(images[0].id)?, database.keypoints(images[1].id)?];
    let (mut found, mut matched): (Numbered, HashSet<[u32; 2]>) = Default::default();
    for Pair { points, is_verified } in pairs {
        let points = [points.point1, points.point2];
        let near = [0, 1].map(|k| keypoints[k].nearest(points[k]));
        // A click and a match may be at the same place.
        if let [Some(i), Some(j)] = near
            && matched.contains(&[i, j])
        {
            continue;
        }
        let free = [0, 1].map(|k| keypoints[k].nearest_free(points[k]));
        let numbers = match free {
            [Some(i), Some(j)] => [i, j],
            _ if append => [0, 1].map(|k| free[k].unwrap_or_else(|| keypoints[k].append(points[k]))),
            _ => continue,
        };
        for (keypoints, number) in keypoints.iter_mut().zip(numbers) {
            keypoints.take(number);
        }
        matched.insert(numbers);
        found.push((numbers, *is_verified));
    }
    Ok((keypoints, found))
}

fn add(
    database: &Database,
    images: &[Image; 2],
    pairs: &[Pair],
    geometry: &Geometry,
) -> Result<ColmapPair, String> {
    let (keypoints, mut found) = numbered(database, images, pairs, true)?;
    for (image, keypoints) in images.iter().zip(&keypoints) {
        database.write_keypoints(image.id, keypoints)?;
    }
    let is_turned = images[0].id > images[1].id;
    let mut geometry = *geometry;
    let [mut id1, mut id2] = images.each_ref().map(|image| image.id);
    let [mut first, mut second] = keypoints.each_ref();
    if is_turned {
        geometry = geometry.turned();
        (id1, id2) = (id2, id1);
        (first, second) = (second, first);
        for (numbers, _) in &mut found {
            numbers.reverse();
        }
    }
    let pair_id = database::pair_id(id1, id2);
    let mut all = database.matches("matches", pair_id)?;
    let known: HashSet<[u32; 2]> = all.iter().copied().collect();
    all.extend(found.iter().map(|(numbers, _)| *numbers).filter(|numbers| !known.contains(numbers)));
    if all.len() > known.len() {
        database.write_matches(pair_id, &all)?;
    }
    // Verified matches of COLMAP stay if they agree with the geometry.
    let mut verified: Vec<[u32; 2]> =
        found.iter().filter(|(_, is)| *is).map(|(numbers, _)| *numbers).collect();
    let own = verified.len();
    let agrees = |[i, j]: &[u32; 2]| {
        let pair = first.point(*i).zip(second.point(*j)).map(|(point1, point2)| PointPair { point1, point2 });
        let is_near = |f, pair| sampson_distance(f, &pair) <= MOST_DISTANCE;
        let agrees = geometry.fundamental.as_ref().zip(pair).is_some_and(|(f, pair)| is_near(f, pair));
        agrees && !first.is_taken(*i) && !second.is_taken(*j)
    };
    verified.extend(database.verified(pair_id)?.into_iter().filter(agrees));
    database.write_geometry(pair_id, &verified, &geometry.stored())?;
    Ok(ColmapPair {
        names: images.each_ref().map(|image| image.name.clone()),
        matches: found.len(),
        verified: own,
        keypoints: keypoints.map(|keypoints| keypoints.appended()),
    })
}
