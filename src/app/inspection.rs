//! The inspected line pair: its intensities, matched in a thread of its own.
//!
//! Matching two lines of a large image takes a tenth of a second, so the window never waits for it. Only the
//! newest request counts; until it is answered the answer before stays.

use std::sync::Arc;

use egui::ColorImage;

use super::background::Latest;
use super::document::Side;
use super::heat;
use super::waker::Waker;
use crate::estimate::Parameters;
use crate::geometry::{AnchoredLine, Point};
use crate::image::Picture;
use crate::similarity::{DisparityRange, StereoParameters, WarpedProfile, inspect_lines, inspection_scale};

/// Two lines to match.
#[derive(Debug, Clone)]
pub struct InspectionRequest {
    /// The pictures.
    pub pictures: [Arc<Picture>; 2],
    /// The line of each.
    pub lines: [AnchoredLine; 2],
    /// The numbers of the stereo cost.
    pub stereo: StereoParameters,
    /// Largest disparity tried, as a fraction of the longer side of the left image.
    pub reach: f64,
}

impl InspectionRequest {
    /// A request with the parameters of the estimate.
    pub fn new(pictures: [Arc<Picture>; 2], lines: [AnchoredLine; 2], parameters: &Parameters) -> Self {
        let similarity = parameters.similarity;
        Self { pictures, lines, stereo: similarity.stereo, reach: similarity.disparity_reach }
    }

    fn is_same(&self, other: &Self) -> bool {
        self.lines == other.lines
            && self.stereo == other.stereo
            && self.reach.to_bits() == other.reach.to_bits()
            && self.pictures.iter().zip(&other.pictures).all(|(a, b)| Arc::ptr_eq(a, b))
    }

    /// Samples and matches the lines.
    pub fn inspect(&self, number: u64) -> Inspection {
        let (step, range) = inspection_scale(self.pictures[0].frame(), self.reach);
        let planes = self.pictures.each_ref().map(|picture| &picture.gray);
        let warped = inspect_lines(planes, self.lines.each_ref(), step, range, &self.stereo);
        let band = Arc::new(band(&warped, range, &self.stereo));
        Inspection { number, lines: self.lines, step, range, warped, band }
    }
}

/// The cost band as a picture.
fn band(warped: &WarpedProfile, range: DisparityRange, stereo: &StereoParameters) -> ColorImage {
    let WarpedProfile { profile1, profile2, .. } = warped;
    let largest = f32::from(stereo.truncation.max(1));
    // The square root spreads the small costs, which decide.
    let color = |cost: u16| heat::color(1.0 - (f32::from(cost) / largest).sqrt());
    let pixels = (range.min..=range.max)
        .rev()
        .flat_map(|disparity| {
            let samples = (profile1.first..).zip(&profile1.values);
            samples.map(move |(i, value)| (*value, profile2.get(i + disparity)))
        })
        .map(|(value, partner)| color(stereo.sample_cost(value, partner)))
        .collect();
    ColorImage::new([profile1.len(), range.len()], pixels)
}

/// Two lines matched sample by sample. Sample `i` is `i` steps from the anchor of the left line.
#[derive(Debug, Clone)]
pub struct Inspection {
    /// Another number for each.
    pub number: u64,
    /// The lines.
    pub lines: [AnchoredLine; 2],
    /// Distance of neighbouring samples, px.
    pub step: f64,
    /// Disparities tried, samples.
    pub range: DisparityRange,
    /// Intensities and disparities.
    pub warped: WarpedProfile,
    /// Cost of matching each sample (across) at each disparity (the largest on top): bright is alike.
    pub band: Arc<ColorImage>,
}

impl Inspection {
    /// Index of the first sample, and the one after the last.
    pub fn samples(&self) -> std::ops::Range<i32> {
        self.warped.profile1.first..self.warped.profile1.end()
    }

    /// Where a sample is in the left image, px.
    pub fn point1(&self, sample: i32) -> Option<Point> {
        self.samples().contains(&sample).then(|| self.lines[0].point_at(f64::from(sample) * self.step))
    }

    /// The match of a sample in the right image, px; `None` where it falls outside the image.
    pub fn point2(&self, sample: i32) -> Option<Point> {
        let k = usize::try_from(sample - self.warped.profile1.first).ok()?;
        let partner = sample + self.warped.matching.disparities.get(k)?;
        let profile2 = &self.warped.profile2;
        (profile2.first..profile2.end())
            .contains(&partner)
            .then(|| self.lines[1].point_at(f64::from(partner) * self.step))
    }

    /// The sample nearest to a position of an image, if the line passes within `reach` px of it.
    pub fn sample_near(&self, side: Side, point: Point, reach: f64) -> Option<i32> {
        let line = &self.lines[side.index()];
        if line.line().distance(point) > reach {
            return None;
        }
        let along = ((point - line.anchor).dot(&line.direction) / self.step).round() as i32;
        match side {
            Side::Left => self.samples().contains(&along).then_some(along),
            Side::Right => {
                // Several samples may match one place; the path is searched, since it may jump.
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

/// The thread that matches, and its latest answer.
pub struct Matcher {
    thread: Latest<InspectionRequest, Inspection>,
    asked: Option<InspectionRequest>,
    latest: Option<Inspection>,
}

impl Matcher {
    /// Starts the thread.
    pub fn new(waker: Waker) -> Self {
        let mut number = 0;
        let thread = Latest::new("inspection", waker, move |request: InspectionRequest| {
            number += 1;
            Some(request.inspect(number))
        });
        Self { thread, asked: None, latest: None }
    }

    /// Asks for these lines, unless they were asked for last; without a request there is nothing to show.
    pub fn follow(&mut self, request: Option<InspectionRequest>) {
        let Some(request) = request else {
            self.thread.forget();
            (self.asked, self.latest) = (None, None);
            return;
        };
        let asked = self.asked.as_ref();
        if asked.is_some_and(|asked| asked.is_same(&request)) {
            return;
        }
        let same_picture =
            |asked: &InspectionRequest, k: usize| Arc::ptr_eq(&asked.pictures[k], &request.pictures[k]);
        if asked.is_some_and(|asked| !(same_picture(asked, 0) && same_picture(asked, 1))) {
            self.thread.forget();
            self.latest = None;
        }
        self.asked = Some(request.clone());
        self.thread.ask(request);
    }

    /// Takes in what the thread has found.
    pub fn take_news(&mut self) {
        if let Some(inspection) = self.thread.poll() {
            self.latest = Some(inspection);
        }
    }

    /// The latest answer; while another is awaited, of the lines before.
    pub fn latest(&self) -> Option<&Inspection> {
        self.latest.as_ref()
    }

    /// Whether an answer is awaited.
    pub fn is_busy(&self) -> bool {
        self.thread.is_busy()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::fake;
    use std::time::{Duration, Instant};

    /// Two pictures whose rows differ by a shift of 7 px.
    fn shifted() -> [Arc<Picture>; 2] {
        [0, 7].map(|shift| {
            let pixels = image::GrayImage::from_fn(160, 40, |x, y| {
                let x = x + shift;
                image::Luma([((x * x * 7 + y * 13) % 251) as u8])
            });
            Arc::new(Picture::from_pixels("rows".into(), None, pixels.into()).expect("has pixels"))
        })
    }

    fn request(pictures: &[Arc<Picture>; 2], y: f64) -> InspectionRequest {
        let line = AnchoredLine::at_angle(Point::new(50.0, y), 0.0);
        InspectionRequest::new(pictures.clone(), [line; 2], &Parameters::default())
    }

    #[test]
    fn samples_have_their_places_in_both_images() {
        let inspection = request(&shifted(), 20.0).inspect(1);
        assert_eq!(inspection.samples(), -50..110);
        assert_eq!(inspection.point1(30), Some(Point::new(80.0, 20.0)));
        assert_eq!(inspection.point2(30), Some(Point::new(73.0, 20.0)));
        assert_eq!(inspection.point1(110), None);
        assert_eq!(inspection.sample_near(Side::Left, Point::new(80.3, 22.0), 4.0), Some(30));
        assert_eq!(inspection.sample_near(Side::Right, Point::new(73.3, 22.0), 4.0), Some(30));
        assert_eq!(inspection.sample_near(Side::Right, Point::new(73.3, 32.0), 4.0), None);
        let band = |sample: i32, disparity: i32| {
            let (x, y) = (sample - inspection.samples().start, inspection.range.max - disparity);
            inspection.band.pixels[y as usize * inspection.band.width() + x as usize]
        };
        assert_eq!(band(30, -7), heat::color(1.0), "alike");
        assert_ne!(band(30, -4), heat::color(1.0));
    }

    #[test]
    fn only_the_newest_request_is_answered_in_the_end() {
        let pictures = shifted();
        let mut matcher = Matcher::new(Waker::default());
        for y in [3.0, 9.0, 27.0] {
            matcher.follow(Some(request(&pictures, y)));
        }
        matcher.follow(Some(request(&pictures, 27.0)));
        let start = Instant::now();
        while matcher.is_busy() {
            assert!(start.elapsed() < Duration::from_secs(20), "no answer");
            std::thread::sleep(Duration::from_millis(1));
            matcher.take_news();
        }
        let row = matcher.latest().expect("an answer").lines[0].anchor.y;
        assert!((row - 27.0).abs() < 1e-12);
        let other = fake::request(0.0).pictures;
        matcher.follow(Some(request(&other, 5.0)));
        assert!(matcher.latest().is_none(), "lines of other pictures must not be drawn");
        matcher.follow(None);
        assert!(!matcher.is_busy());
    }
}
