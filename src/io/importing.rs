//! Import of files of other programs for two open images. Matches check the convention of a matrix.

use std::path::Path;

use super::calibration::{CalibratedCamera, Calibration};
use super::geometry_file::{Format, GeometryFile};
use super::import_source::{ImportSource, is_archive};
use super::match_file::MatchFile;
use super::vgg::read_camera;
use crate::camera::{PicturesOf, ViewPair};
use crate::convention::{ConventionCheck, FEWEST_MATCHES, check_convention};
use crate::estimate::{Match, estimate_fundamental};
use crate::geometry::{Camera, Frame, FundamentalMatrix, PointPair};
use crate::presentation::lenses_in_words;
use crate::study::matches_in;

/// Maximum number of pairs that a list of points places. More handles hide the image, and nobody clicks so many: they
/// become given matches, and the message offers the other way.
const MOST_PAIRS: usize = 300;
/// Maximum number of pairs listed in a message.
const MOST_NAMED: usize = 5;

/// Content of imported files.
#[derive(Debug, Clone)]
pub enum ImportedFile {
    /// A geometry or point pairs.
    Geometry(Box<ImportFound>),
    /// The calibrated cameras of the open pictures.
    Calibration { name: String, cameras: Box<[CalibratedCamera; 2]> },
}

/// Files to import for two open images.
pub struct Import<'a> {
    pub source: &'a ImportSource,
    /// Sizes of the open images.
    pub frames: [Frame; 2],
    /// Sizes of the pictures with their distortion, for which a calibration is.
    pub shown: [Frame; 2],
    /// Views without distortion, if a lens is corrected. Points found belong to them.
    pub views: Option<&'a ViewPair>,
    /// Matches for the check, and their name.
    pub matches: (&'a [PointPair], &'static str),
}

/// A fundamental matrix from a file.
#[derive(Debug, Clone)]
pub struct ImportedMatrix {
    /// The matrix as its format defines it.
    pub fundamental: FundamentalMatrix,
    /// The cameras of the file.
    pub cameras: Option<[Camera; 2]>,
    /// Check by matches; `None` with too few.
    pub check: Option<ConventionCheck>,
    /// Name of the matches.
    pub matches: &'static str,
    pub count: usize,
}

/// A geometry or points from files.
#[derive(Debug, Clone)]
pub struct ImportFound {
    pub name: String,
    pub format: &'static str,
    pub pairs: Vec<PointPair>,
    /// Matches to search with, not to edit.
    pub matches: Vec<Match>,
    pub matrix: Option<ImportedMatrix>,
    /// Warnings, one sentence each.
    pub notes: Vec<String>,
}

impl Import<'_> {
    /// Reads a calibration, or else a geometry. The error is text for the middle of a sentence.
    pub fn read(&self) -> Result<ImportedFile, String> {
        if let ImportSource::File(path) = self.source {
            let found = Calibration::find(path);
            if let Some(Ok(calibration)) = &found {
                // Matches at hand are places in the pictures unless a lens is corrected.
                let matches = || if self.frames == self.shown { self.matches.0.to_vec() } else { Vec::new() };
                let pair = CalibratedCamera::settled(calibration.open_pair(None)?, self.shown, matches)?;
                let cameras = Box::new(pair);
                for (camera, frame) in cameras.iter().zip(self.shown) {
                    camera.check_frame(frame)?;
                }
                return Ok(ImportedFile::Calibration { name: self.source.name(), cameras });
            }
            // An archive may have F, matches, or both. Matches alone keep their weights.
            let has_matrix = || GeometryFile::read(path).is_ok_and(|(file, _)| file.geometry().is_some());
            if is_archive(path) && !has_matrix() {
                return Ok(ImportedFile::Geometry(Box::new(self.matches_of(path)?)));
            }
            if let Some(Err(refusal)) = found {
                // A calibration that is refused may still hold a geometry.
                let geometry = self.read_geometry().map_err(|_| refusal.to_string());
                return geometry.map(|found| ImportedFile::Geometry(Box::new(found)));
            }
        }
        Ok(ImportedFile::Geometry(Box::new(self.read_geometry()?)))
    }

    fn read_geometry(&self) -> Result<ImportFound, String> {
        let name = self.source.name();
        let (file, format) = match self.source {
            ImportSource::File(path) => GeometryFile::read(path).map_err(|error| error.to_string())?,
            ImportSource::Cameras([left, right]) => {
                let camera = |path| read_camera(path).map_err(|error| error.to_string());
                let cameras = Some([camera(left)?, camera(right)?]);
                (GeometryFile { cameras, ..GeometryFile::of(PicturesOf::Untold) }, Format::Text)
            }
            ImportSource::LoneCamera(_) => {
                return Err(
                    "it is the camera of one image. Import the cameras of both images at once".to_owned()
                );
            }
        };
        let geometry = file.geometry();
        if geometry.is_none() && file.pairs.is_empty() {
            return Err(if file.cameras.is_some() {
                "the two cameras have the same centre, so there is no fundamental matrix".to_owned()
            } else {
                "there are no point pairs and no fundamental matrix in it".to_owned()
            });
        }
        let mut notes = in_sentences(&name, &file.remarks);
        let own = PicturesOf::from(self.views);
        let has_geometry = geometry.is_some();
        match (&file.pictures, file.pictures.views()) {
            (PicturesOf::Undistorted(_), Some(described)) if self.is_same(described) => {}
            (PicturesOf::Undistorted(None), _) if own.is_undistorted() => notes.push(format!(
                "{name} belongs to pictures without distortion, but does not tell their lens. It is read for the lens of \
                 these pictures."
            )),
            (PicturesOf::Undistorted(_), described) => {
                let lens = lenses_in_words(&file.pictures);
                let action = match (described, own.is_undistorted()) {
                    (_, false) => "Import the calibration of the pictures, or correct their lens, first",
                    _ => "These pictures have another lens",
                };
                return Err(format!("it belongs to pictures without distortion ({lens}). {action}"));
            }
            (PicturesOf::Original, _) if own.is_undistorted() && has_geometry => {
                return Err(
                    "its geometry belongs to the pictures as they are, and the lens of these is corrected. Remove the \
                     lens correction first"
                        .to_owned(),
                );
            }
            (PicturesOf::Untold, _) if own.is_undistorted() && has_geometry => notes.push(format!(
                "{name} does not tell its pictures. Its geometry is read for the pictures without distortion, its point \
                 pairs are places in the pictures."
            )),
            (PicturesOf::Untold | PicturesOf::Original, _) => {}
        }
        if file.images.as_ref().is_some_and(|images| {
            ![self.frames, self.shown].contains(&images.each_ref().map(|image| image.frame))
        }) {
            notes.push(format!(
                "{name} belongs to images of other sizes. Check that it fits the open images."
            ));
        }
        let sizes = if file.pictures.is_undistorted() { self.frames } else { self.shown };
        let (mut pairs, note) = on_the_images(&file.pairs, sizes, &name);
        notes.extend(note);
        if let Some(views) = self.views.filter(|_| !file.pictures.is_undistorted()) {
            pairs = pairs.iter().filter_map(|pair| views.undistorted_from_original(pair)).collect();
        }
        if geometry.is_none() && pairs.is_empty() {
            return Err("none of its point pairs lies on the open images".to_owned());
        }
        let matrix = geometry.map(|fundamental| self.checked(fundamental, file.cameras, &pairs));
        let (mut pairs, mut matches) = (pairs, Vec::new());
        if pairs.len() > MOST_PAIRS {
            matches = std::mem::take(&mut pairs).into_iter().map(Match::from).collect();
            notes.extend(self.disagreement(&matches));
        }
        Ok(ImportFound { name, format: format.label(), pairs, matches, matrix, notes })
    }

    /// Reads the matches of a NumPy archive.
    fn matches_of(&self, path: &Path) -> Result<ImportFound, String> {
        let name = self.source.name();
        let MatchFile { matches: all, remarks } = MatchFile::read(path).map_err(|error| error.to_string())?;
        let is_inside = |found: &&Match| found.pair.is_inside(self.shown);
        let mut matches: Vec<Match> = all.iter().filter(is_inside).copied().collect();
        // Matches of an archive are places in the pictures.
        if let Some(views) = self.views {
            matches = matches_in(views, &matches).unwrap_or_default();
        }
        if matches.is_empty() {
            return Err("none of its matches lies on the open images".to_owned());
        }
        let outside = all.len() - matches.len();
        let left_out = || {
            format!("Left out because outside the images: {outside} of the {} matches of {name}.", all.len())
        };
        let mut notes = in_sentences(&name, &remarks);
        notes.extend((outside > 0).then(left_out));
        notes.extend(self.disagreement(&matches));
        Ok(ImportFound { name, format: "NumPy archive", pairs: Vec::new(), matches, matrix: None, notes })
    }

    /// Returns whether these are the views of the open pictures.
    fn is_same(&self, described: &ViewPair) -> bool {
        self.views.is_some_and(|own| own.adopting(described).is_some() && own.frames() == described.frames())
    }

    /// Says that matches agree on no geometry, if so.
    fn disagreement(&self, matches: &[Match]) -> Option<String> {
        let error = estimate_fundamental(matches, self.frames, 0).err()?;
        let name = self.source.name();
        Some(format!("The matches of {name} are shown, but the estimate does not use them: {error}."))
    }

    /// Checks a matrix with the available matches, or with the pairs of the file if these are too
    /// few.
    fn checked(
        &self,
        fundamental: FundamentalMatrix,
        cameras: Option<[Camera; 2]>,
        own: &[PointPair],
    ) -> ImportedMatrix {
        let (at_hand, name) = self.matches;
        let (matches, pairs) = if at_hand.len() < FEWEST_MATCHES && own.len() >= FEWEST_MATCHES {
            ("point pairs of the file itself", own)
        } else {
            (name, at_hand)
        };
        let check = check_convention(&fundamental, pairs).ok();
        // A check without any finite reading leaves nothing to choose from.
        let check = check.filter(|check| !check.readings.is_empty());
        ImportedMatrix { fundamental, cameras, check, matches, count: pairs.len() }
    }
}

/// Returns clauses about how a file was read as sentences.
fn in_sentences(name: &str, remarks: &[String]) -> Vec<String> {
    remarks.iter().map(|remark| format!("{name}: {remark}.")).collect()
}

/// Returns the pairs on the images, and a message about the others.
fn on_the_images(pairs: &[PointPair], frames: [Frame; 2], name: &str) -> (Vec<PointPair>, Option<String>) {
    let is_outside = |k: &usize| !pairs[*k].is_inside(frames);
    let outside: Vec<usize> = (0..pairs.len()).filter(is_outside).collect();
    let inside: Vec<PointPair> = pairs.iter().copied().filter(|pair| pair.is_inside(frames)).collect();
    if outside.is_empty() {
        return (inside, None);
    }
    let mut numbers: Vec<String> =
        outside.iter().take(MOST_NAMED).map(|k| format!("number {}", k + 1)).collect();
    if outside.len() > MOST_NAMED {
        numbers.push(format!("{} more", outside.len() - MOST_NAMED));
    }
    let (left_out, all, numbers) = (outside.len(), pairs.len(), numbers.join(", "));
    let note = format!(
        "Left out because outside the images: {left_out} of the {all} point pairs of {name} ({numbers})."
    );
    (inside, Some(note))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_outside_are_listed() {
        let frames = [Frame::new(100, 80); 2];
        let inside = PointPair::new(5.0, 6.0, 7.0, 8.0);
        let mut pairs = vec![inside; 3];
        pairs[1].point2.x = 100.0;
        let (kept, note) = on_the_images(&pairs, frames, "m.csv");
        assert_eq!(kept.len(), 2);
        assert_eq!(
            note.unwrap(),
            "Left out because outside the images: 1 of the 3 point pairs of m.csv (number 2)."
        );
        assert_eq!(on_the_images(&[inside; 2], frames, "m.csv").1, None);
        let (_, note) = on_the_images(&[PointPair::new(-9.0, 0.0, 0.0, 0.0); 8], frames, "m.csv");
        assert!(note.unwrap().ends_with("number 4, number 5, 3 more)."));
    }
}
