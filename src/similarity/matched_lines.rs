//! Two lines matched sample by sample, with the place of each sample and of its match.

use super::profile::{WarpedProfile, inspect_lines, inspection_scale};
use super::{DisparityRange, StereoParameters};
use crate::geometry::{AnchoredLine, Point};
use crate::image::GrayPlane;

/// Two lines matched sample by sample. Sample `i` is `i` steps from the anchor of the first line.
#[derive(Debug, Clone)]
pub struct MatchedLines {
    /// The lines, one in each image.
    pub lines: [AnchoredLine; 2],
    /// Distance of neighbouring samples of the first line, px.
    pub step: f64,
    /// Distance of neighbouring samples of the second line over that of the first line.
    pub scale: f64,
    /// Range of tested disparities, samples.
    pub range: DisparityRange,
    /// Intensities and disparities.
    pub warped: WarpedProfile,
    stereo: StereoParameters,
}

impl MatchedLines {
    /// Samples and matches two lines. `scale` is the size of things in image 2 over their size in image 1.
    /// `reach` is the largest disparity as a fraction of the longer side of image 1.
    pub fn new(
        planes: [&GrayPlane; 2],
        lines: [AnchoredLine; 2],
        scale: f64,
        reach: f64,
        stereo: &StereoParameters,
    ) -> Self {
        let (step, range) = inspection_scale(planes[0].frame(), reach);
        let warped = inspect_lines(planes, lines.each_ref(), [step, step * scale], range, stereo);
        Self { lines, step, scale, range, warped, stereo: *stereo }
    }

    /// Returns the largest cost of two samples.
    fn largest(&self) -> f32 {
        f32::from(self.stereo.truncation.max(1))
    }

    /// Converts a cost to a similarity from 0 to 1. The square root spreads the small costs, which decide.
    fn alike(&self, cost: f32) -> f32 {
        1.0 - (cost / self.largest()).min(1.0).sqrt()
    }

    /// Returns the numbers of the samples of the first line.
    pub fn samples(&self) -> std::ops::Range<i32> {
        self.warped.profile1.first..self.warped.profile1.end()
    }

    /// Returns how alike each sample is to its partner at one disparity, from 0 to 1.
    pub fn likeness_at(&self, disparity: i32) -> impl Iterator<Item = f32> + '_ {
        let WarpedProfile { profile1, profile2, .. } = &self.warped;
        self.samples().zip(&profile1.values).map(move |(i, value)| {
            self.alike(self.stereo.sample_cost(*value, profile2.get(i + disparity)).into())
        })
    }

    /// Returns the position of a sample in image 1, px.
    pub fn point1(&self, sample: i32) -> Option<Point> {
        self.samples().contains(&sample).then(|| self.lines[0].point_at(f64::from(sample) * self.step))
    }

    /// Returns the match of a sample in image 2, px; `None` outside the image.
    pub fn point2(&self, sample: i32) -> Option<Point> {
        let k = usize::try_from(sample - self.warped.profile1.first).ok()?;
        let partner = sample + self.warped.matching.disparities.get(k)?;
        let profile2 = &self.warped.profile2;
        (profile2.first..profile2.end())
            .contains(&partner)
            .then(|| self.lines[1].point_at(f64::from(partner) * self.step * self.scale))
    }

    /// Returns whether the sample with this number, from the first one of the first line, has a match in
    /// image 2 that is like it at all. Otherwise its cost is a fixed one.
    pub fn has_counterpart(&self, number: usize) -> bool {
        let own = self.warped.profile1.values.get(number);
        let other = self.warped.warped2.get(number).copied().flatten();
        own.zip(other).is_some_and(|(own, other)| f32::from(own.abs_diff(other)).powi(2) < self.largest())
    }

    /// Returns how alike a sample and its match are, from 0 to 1.
    pub fn likeness(&self, sample: i32) -> f32 {
        let place = usize::try_from(sample - self.warped.profile1.first).ok();
        let cost = place.and_then(|k| self.warped.matching.sample_costs.get(k));
        cost.map_or(0.0, |cost| self.alike(*cost as f32))
    }

    /// Returns the sample nearest to a position in image 1 or 2 (`image` is 0 or 1), if the line passes within
    /// `reach` px of it.
    pub fn sample_near(&self, image: usize, point: Point, reach: f64) -> Option<i32> {
        let line = &self.lines[image];
        if line.line().distance(point) > reach {
            return None;
        }
        let step = if image == 0 { self.step } else { self.step * self.scale };
        let along = ((point - line.anchor).dot(&line.direction) / step).round() as i32;
        if image == 0 {
            return self.samples().contains(&along).then_some(along);
        }
        // Several samples may match one place, and the path may jump. So all samples are searched.
        let partner = |i: i32| {
            let k = (i - self.warped.profile1.first) as usize;
            i + self.warped.matching.disparities[k]
        };
        let nearest = self.samples().min_by_key(|i| partner(*i).abs_diff(along))?;
        (partner(nearest).abs_diff(along) <= 2).then_some(nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    /// Returns two images whose rows differ by a shift of 7 px.
    fn shifted() -> [GrayPlane; 2] {
        [0, 7].map(|shift| {
            GrayPlane::from_fn(Frame::new(160, 40), |x, y| {
                let x = x + shift;
                ((x * x * 7 + y * 13) % 251) as f32
            })
        })
    }

    fn matched(planes: [&GrayPlane; 2], lines: [AnchoredLine; 2], scale: f64) -> MatchedLines {
        // Those of the preset Robust.
        let stereo = StereoParameters { lambda: 400, alpha: 2000, outside: 1500, ..StereoParameters::PAPER };
        MatchedLines::new(planes, lines, scale, 0.16, &stereo)
    }

    fn in_row_20() -> MatchedLines {
        let line = AnchoredLine::at_angle(Point::new(50.0, 20.0), 0.0);
        matched(shifted().each_ref(), [line; 2], 1.0)
    }

    #[test]
    fn a_smaller_second_image_is_sampled_in_smaller_steps() {
        let [left, _] = shifted();
        // Weights of a triangle of four samples in either direction.
        let weights = [1.0, 3.0, 3.0, 1.0].map(|weight| weight / 8.0);
        let at = |x: usize, y: usize| left.at(x.clamp(1, 160) - 1, y.clamp(1, 40) - 1);
        let small = GrayPlane::from_fn(Frame::new(80, 20), |x, y| {
            let row = |j: usize| (0..4).map(|i| weights[i] * at(2 * x + i, 2 * y + j)).sum::<f32>();
            (0..4).map(|j| weights[j] * row(j)).sum()
        });
        let line = |x, y| AnchoredLine::at_angle(Point::new(x, y), 0.0);
        let matched = matched([&left, &small], [line(50.0, 20.0), line(24.75, 9.75)], 0.5);
        for sample in [-30, 40, 80] {
            let (left, right) = (matched.point1(sample).unwrap(), matched.point2(sample).unwrap());
            assert!((right.x - (left.x - 0.5) / 2.0).abs() < 1.6, "{left} {right}");
            let found = matched.sample_near(1, right, 1.0);
            assert!(found.is_some_and(|at| (at - sample).abs() < 3), "{found:?} and {sample}");
        }
    }

    #[test]
    fn samples_that_cost_a_fixed_amount_have_no_counterpart() {
        let mut matched = in_row_20();
        // The first samples match places to the left of the second image.
        assert!(!matched.has_counterpart(0) && matched.has_counterpart(80));
        matched.warped.warped2[80] = Some(matched.warped.profile1.values[80] ^ 0x80);
        assert!(!matched.has_counterpart(80));
        assert!(!matched.has_counterpart(10_000));
    }

    #[test]
    fn samples_have_their_places_in_both_images() {
        let matched = in_row_20();
        assert_eq!(matched.samples(), -50..110);
        assert_eq!(matched.point1(30), Some(Point::new(80.0, 20.0)));
        assert_eq!(matched.point2(30), Some(Point::new(73.0, 20.0)));
        assert_eq!(matched.point1(110), None);
        assert_eq!(matched.sample_near(0, Point::new(80.3, 22.0), 4.0), Some(30));
        assert_eq!(matched.sample_near(1, Point::new(73.3, 22.0), 4.0), Some(30));
        assert_eq!(matched.sample_near(1, Point::new(73.3, 32.0), 4.0), None);
        let alike = |disparity| matched.likeness_at(disparity).nth(80).unwrap();
        assert!(alike(-7) > 0.99 && alike(-4) < 0.9);
    }
}
