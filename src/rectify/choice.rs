//! Rectifies a pair of images and chooses the method.

use super::extent::Extent;
use super::map::{ImageMap, MapKind};
use super::measures::Measures;
use super::{Limits, Rectification, RectifyError, RectifyMethod, advice, planar, polar};
use crate::geometry::{Frame, FundamentalMatrix, PointPair, symmetric_epipolar_distance};

/// Rectifies a pair of images of the given sizes.
///
/// `matches` measure how well rows agree. With an epipole inside an image they also determine which
/// halves of epipolar lines correspond. They change nothing else and may be empty.
pub fn rectify(
    fundamental: &FundamentalMatrix,
    frames: [Frame; 2],
    matches: &[PointPair],
    method: RectifyMethod,
    limits: &Limits,
) -> Result<Rectification, RectifyError> {
    if let Some(small) = frames.iter().position(|f| f.width < 2 || f.height < 2) {
        return Err(RectifyError::TooSmall(small + 1));
    }
    // Reports a limit that is too small before the work starts.
    Extent { width: 1.0, height: 1.0 }.limited(limits.pixels)?;
    let task = RectifyTask { fundamental, frames, matches, limits };
    match method {
        RectifyMethod::Planar => task.planar("it was asked for".into()),
        RectifyMethod::Polar => task.polar("it was asked for".into()),
        RectifyMethod::Auto => {
            let planar = match task.planar("the epipoles lie well outside both images".into()) {
                Ok(planar) => planar,
                Err(error @ (RectifyError::EpipoleInside { .. } | RectifyError::NoCommonPlane)) => {
                    return task.polar(advice::instead_of_planar(&error));
                }
                Err(other) => return Err(other),
            };
            match advice::against_planar(&planar) {
                None => Ok(planar),
                // A distorted planar picture is better than none; its warnings describe the
                // distortion.
                Some(reason) => task.polar(reason).or(Ok(planar)),
            }
        }
    }
}

/// Input of a rectification.
pub(super) struct RectifyTask<'a> {
    pub fundamental: &'a FundamentalMatrix,
    pub frames: [Frame; 2],
    pub matches: &'a [PointPair],
    pub limits: &'a Limits,
}

impl RectifyTask<'_> {
    /// Returns the mean symmetric epipolar distance of the matches, px.
    fn misfit(&self) -> f64 {
        let distances = self.matches.iter().map(|m| symmetric_epipolar_distance(self.fundamental, m));
        distances.sum::<f64>() / self.matches.len().max(1) as f64
    }

    fn planar(&self, reason: String) -> Result<Rectification, RectifyError> {
        let (maps, size, scale) = planar::planar(self.fundamental, self.frames, self.limits.pixels)?;
        let maps = maps.map(|m| ImageMap::new(MapKind::Planar(m)));
        Ok(self.rectification(RectifyMethod::Planar, reason, maps, size, scale, false))
    }

    fn polar(&self, reason: String) -> Result<Rectification, RectifyError> {
        let found = polar::polar(self.fundamental, self.frames, self.matches, self.limits.pixels)?;
        let maps = found.maps.map(|m| ImageMap::new(MapKind::Polar(m)));
        let assumed = found.orientation_assumed;
        Ok(self.rectification(RectifyMethod::Polar, reason, maps, found.frame, found.scale, assumed))
    }

    pub fn rectification(
        &self,
        method: RectifyMethod,
        reason: String,
        maps: [ImageMap; 2],
        size: Frame,
        scale: f64,
        orientation_assumed: bool,
    ) -> Rectification {
        let measures = Measures::of(&maps, self.frames, size, scale, self.matches);
        let warnings = advice::warnings(method, &measures, self.misfit(), scale, orientation_assumed);
        Rectification { method, reason, maps, size, scale, measures, warnings }
    }
}
