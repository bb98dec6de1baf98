//! Intensities along the inspected line pair, matched sample by sample.

use std::sync::Arc;

use image::RgbImage;

use super::document::Side;
use super::heat;
use super::picture::Pictures;
use super::revision;
use crate::estimate::Parameters;
use crate::geometry::{AnchoredLine, Point};
use crate::similarity::{DisparityRange, StereoParameters, WarpedProfile, inspect_lines, inspection_scale};

/// Request to match two lines.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectionRequest {
    pub pictures: Pictures,
    /// One line in each picture.
    pub lines: [AnchoredLine; 2],
    pub stereo: StereoParameters,
    /// Largest disparity tried, as a fraction of the longer side of the left image.
    pub reach: f64,
    /// Size of things in the right picture over their size in the left one.
    pub scale: f64,
}

impl InspectionRequest {
    /// Creates a request with the parameters of the estimate, for pictures of this relative scale.
    pub fn new(pictures: Pictures, lines: [AnchoredLine; 2], scale: f64, parameters: &Parameters) -> Self {
        let similarity = parameters.similarity;
        Self { pictures, lines, stereo: similarity.stereo, reach: similarity.disparity_reach, scale }
    }

    /// Samples and matches the lines.
    pub fn inspect(&self) -> Inspection {
        let (step, range) = inspection_scale(self.pictures[0].frame(), self.reach);
        let planes = self.pictures.each_ref().map(|picture| &picture.gray);
        let steps = [step, step * self.scale];
        let warped = inspect_lines(planes, self.lines.each_ref(), steps, range, &self.stereo);
        let band = Arc::new(band(&warped, range, &self.stereo));
        let largest = largest(&self.stereo);
        Inspection {
            number: revision::fresh(),
            lines: self.lines,
            step,
            scale: self.scale,
            range,
            warped,
            largest,
            band,
        }
    }
}

fn largest(stereo: &StereoParameters) -> f32 {
    f32::from(stereo.truncation.max(1))
}

/// Returns how alike two samples are, from 0 to 1. The square root spreads the small costs, which decide.
fn alike(cost: f32, largest: f32) -> f32 {
    1.0 - (cost / largest).min(1.0).sqrt()
}

fn band(warped: &WarpedProfile, range: DisparityRange, stereo: &StereoParameters) -> RgbImage {
    let WarpedProfile { profile1, profile2, .. } = warped;
    let color = |cost: u16| heat::rgb(alike(cost.into(), largest(stereo)));
    let pixels = (range.min..=range.max)
        .rev()
        .flat_map(|disparity| {
            let samples = (profile1.first..).zip(&profile1.values);
            samples.map(move |(i, value)| (*value, profile2.get(i + disparity)))
        })
        .flat_map(|(value, partner)| color(stereo.sample_cost(value, partner)))
        .collect();
    let (width, height) = (profile1.len() as u32, range.len() as u32);
    RgbImage::from_raw(width, height, pixels).expect("three bytes a sample and disparity")
}

/// Two lines matched sample by sample. Sample `i` is `i` steps from the anchor of the left line.
#[derive(Debug, Clone)]
pub struct Inspection {
    pub number: u64,
    pub lines: [AnchoredLine; 2],
    /// Distance of neighbouring samples of the left line, px.
    pub step: f64,
    /// That of the right line over that of the left one.
    pub scale: f64,
    /// Range of tested disparities, samples.
    pub range: DisparityRange,
    /// Intensities and disparities.
    pub warped: WarpedProfile,
    /// Largest cost of two samples.
    largest: f32,
    /// Cost of matching each sample (x) at each disparity (y, the largest on top). Bright means
    /// similar.
    pub band: Arc<RgbImage>,
}

impl Inspection {
    pub fn samples(&self) -> std::ops::Range<i32> {
        self.warped.profile1.first..self.warped.profile1.end()
    }

    /// Returns the position of a sample in the left image, px.
    pub fn point1(&self, sample: i32) -> Option<Point> {
        self.samples().contains(&sample).then(|| self.lines[0].point_at(f64::from(sample) * self.step))
    }

    /// Returns the match of a sample in the right image, px; `None` outside the image.
    pub fn point2(&self, sample: i32) -> Option<Point> {
        let k = usize::try_from(sample - self.warped.profile1.first).ok()?;
        let partner = sample + self.warped.matching.disparities.get(k)?;
        let profile2 = &self.warped.profile2;
        (profile2.first..profile2.end())
            .contains(&partner)
            .then(|| self.lines[1].point_at(f64::from(partner) * self.step * self.scale))
    }

    /// Returns whether the sample with this number, from the first one of the left line, has a match in the
    /// right image that is like it at all. Otherwise its cost is a fixed one.
    pub fn has_counterpart(&self, number: usize) -> bool {
        let own = self.warped.profile1.values.get(number);
        let other = self.warped.warped2.get(number).copied().flatten();
        own.zip(other).is_some_and(|(own, other)| f32::from(own.abs_diff(other)).powi(2) < self.largest)
    }

    /// Returns how alike a sample and its match are, from 0 to 1.
    pub fn likeness(&self, sample: i32) -> f32 {
        let place = usize::try_from(sample - self.warped.profile1.first).ok();
        let cost = place.and_then(|k| self.warped.matching.sample_costs.get(k));
        cost.map_or(0.0, |cost| alike(*cost as f32, self.largest))
    }

    /// Returns the sample nearest to a position, if the line passes within `reach` px of it.
    pub fn sample_near(&self, side: Side, point: Point, reach: f64) -> Option<i32> {
        let line = &self.lines[side.index()];
        if line.line().distance(point) > reach {
            return None;
        }
        let step = if side == Side::Left { self.step } else { self.step * self.scale };
        let along = ((point - line.anchor).dot(&line.direction) / step).round() as i32;
        match side {
            Side::Left => self.samples().contains(&along).then_some(along),
            Side::Right => {
                // Several samples may match one place, and the path may jump. So all samples are
                // searched.
                let partner = |i: i32| {
                    let k = (i - self.warped.profile1.first) as usize;
                    i + self.warped.matching.disparities[k]
                };
                let nearest = self.samples().min_by_key(|i| partner(*i).abs_diff(along))?;
                (partner(nearest).abs_diff(along) <= 2).then_some(nearest)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::shared::Shared;
    use crate::image::Picture;

    /// Returns two pictures whose rows differ by a shift of 7 px.
    fn shifted() -> Pictures {
        [0, 7].map(|shift| {
            let pixels = image::GrayImage::from_fn(160, 40, |x, y| {
                let x = x + shift;
                image::Luma([((x * x * 7 + y * 13) % 251) as u8])
            });
            Shared::new(Picture::from_pixels("rows".into(), None, pixels.into()).expect("has pixels"))
        })
    }

    fn request(pictures: &Pictures, y: f64) -> InspectionRequest {
        let line = AnchoredLine::at_angle(Point::new(50.0, y), 0.0);
        InspectionRequest::new(pictures.clone(), [line; 2], 1.0, &Parameters::default())
    }

    #[test]
    fn a_smaller_right_picture_is_sampled_in_smaller_steps() {
        let [left, _] = shifted();
        let small = left.pixels.resize_exact(80, 20, image::imageops::FilterType::Triangle);
        let right = Shared::new(Picture::from_pixels("small".into(), None, small).expect("has pixels"));
        let line = |x, y| AnchoredLine::at_angle(Point::new(x, y), 0.0);
        let lines = [line(50.0, 20.0), line(24.75, 9.75)];
        let request = InspectionRequest::new([left, right], lines, 0.5, &Parameters::default());
        let inspection = request.inspect();
        for sample in [-30, 40, 80] {
            let (left, right) = (inspection.point1(sample).unwrap(), inspection.point2(sample).unwrap());
            assert!((right.x - (left.x - 0.5) / 2.0).abs() < 1.6, "{left} {right}");
            assert_eq!(
                inspection.sample_near(Side::Right, right, 1.0).map(|at| (at - sample).abs() < 3),
                Some(true)
            );
        }
    }

    #[test]
    fn samples_that_cost_a_fixed_amount_have_no_counterpart() {
        let mut inspection = request(&shifted(), 20.0).inspect();
        // The first samples match places to the left of the right image.
        assert!(!inspection.has_counterpart(0) && inspection.has_counterpart(80));
        inspection.warped.warped2[80] = Some(inspection.warped.profile1.values[80] ^ 0x80);
        assert!(!inspection.has_counterpart(80));
        assert!(!inspection.has_counterpart(10_000));
    }

    #[test]
    fn samples_have_their_places_in_both_images() {
        let inspection = request(&shifted(), 20.0).inspect();
        assert_eq!(inspection.samples(), -50..110);
        assert_eq!(inspection.point1(30), Some(Point::new(80.0, 20.0)));
        assert_eq!(inspection.point2(30), Some(Point::new(73.0, 20.0)));
        assert_eq!(inspection.point1(110), None);
        assert_eq!(inspection.sample_near(Side::Left, Point::new(80.3, 22.0), 4.0), Some(30));
        assert_eq!(inspection.sample_near(Side::Right, Point::new(73.3, 22.0), 4.0), Some(30));
        assert_eq!(inspection.sample_near(Side::Right, Point::new(73.3, 32.0), 4.0), None);
        let band = |sample: i32, disparity: i32| {
            let (x, y) = (sample - inspection.samples().start, inspection.range.max - disparity);
            inspection.band.get_pixel(x as u32, y as u32).0
        };
        assert_eq!(band(30, -7), heat::rgb(1.0), "alike");
        assert_ne!(band(30, -4), heat::rgb(1.0));
    }
}
