//! Inspection of one line pair: its intensities, its disparities, and the second profile warped
//! onto the first.

use super::{DisparityRange, StereoMatch, StereoParameters, match_profiles};
use crate::geometry::{AnchoredLine, Frame};
use crate::image::{GrayPlane, Profile};

/// The profiles of two lines before and after warping (paper, figure 3 c and d).
#[derive(Debug, Clone, PartialEq)]
pub struct WarpedProfile {
    /// Intensities along the line of image 1.
    pub profile1: Profile,
    /// Intensities along the line of image 2.
    pub profile2: Profile,
    /// Best matching of profile 1 with profile 2.
    pub matching: StereoMatch,
    /// Profile 2 warped onto the samples of profile 1, `I₂(i + dᵢ)`; `None` where the match falls
    /// outside image 2.
    pub warped2: Vec<Option<u8>>,
}

/// Approximate maximum number of samples of a line. Longer lines have larger steps.
const SAMPLES: f64 = 1000.0;

/// Returns the sample spacing (px) and the disparities to try (samples) for inspecting a line pair.
/// `frame1` is the size of the first image. `reach` is the largest disparity as a fraction of the
/// longer side.
pub fn inspection_scale(frame1: Frame, reach: f64) -> (f64, DisparityRange) {
    let step = (frame1.diagonal() / SAMPLES).max(1.0);
    let most = (reach * frame1.longer_side() / step).round().max(2.0) as i32;
    (step, DisparityRange::symmetric(most))
}

/// Samples two lines with these spacings, px, matches them and warps the second onto the first. The spacings
/// have the ratio of the scales of the images.
pub fn inspect_lines(
    planes: [&GrayPlane; 2],
    lines: [&AnchoredLine; 2],
    steps: [f64; 2],
    range: DisparityRange,
    parameters: &StereoParameters,
) -> WarpedProfile {
    let profile1 = Profile::sample(planes[0], lines[0], steps[0]);
    let profile2 = Profile::sample(planes[1], lines[1], steps[1]);
    let matching = match_profiles(&profile1, &profile2, range, parameters);
    let warped2 = matching
        .disparities
        .iter()
        .enumerate()
        .map(|(i, d)| profile2.get(profile1.first + i as i32 + d))
        .collect();
    WarpedProfile { profile1, profile2, matching, warped2 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Frame, Point};

    #[test]
    fn warping_brings_a_shifted_row_back() {
        let texture = |x: usize, y: usize| ((x * x * 7 + y * 13) % 251) as f32;
        let plane1 = GrayPlane::from_fn(Frame::new(90, 9), texture);
        let plane2 = GrayPlane::from_fn(Frame::new(90, 9), |x, y| texture(x + 4, y));
        let line = AnchoredLine::at_angle(Point::new(40.0, 4.0), 0.0);
        let range = DisparityRange::symmetric(8);
        let w = inspect_lines([&plane1, &plane2], [&line, &line], [1.0; 2], range, &StereoParameters::PAPER);
        let equal = w.warped2.iter().zip(&w.profile1.values).filter(|(b, a)| **b == Some(**a)).count();
        assert!(equal >= 85, "{equal} of 90");
        assert_eq!(w.matching.disparities[45], -4);
    }
}
