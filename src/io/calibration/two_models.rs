//! Four distortion coefficients: of `cv::calibrateCamera` or of `cv::fisheye::calibrate`.
//!
//! Both write four numbers without the name of the model. They mean `k1 k2 p1 p2` of a perspective camera, or
//! `k1 k2 k3 k4` of an equidistant one. Both readings are compared at matches that were found without a
//! geometry: a match is explained by a reading if it is near its epipolar curves in the pictures. The curves
//! are those of the pose, or of a matrix that is fitted to the matches.

use super::CalibratedCamera;
use crate::camera::{CameraModel, Radial, ViewPair};
use crate::estimate::{Match, estimate_fundamental};
use crate::foreign::excerpt;
use crate::geometry::{Frame, FundamentalMatrix, Point, PointPair};

/// Samples along each side of a picture.
const SAMPLES: usize = 9;
/// Both readings are alike if they bend the picture less than this differently, px: the noise of a match.
const ALIKE: f64 = 1.0;
/// Largest distances of an explained match from its epipolar curves, px. Calibrations err by about a pixel; the
/// larger distances serve large pictures.
const NEAR: [f64; 3] = [1.0, 2.0, 4.0];
/// Standard deviations by which one reading must explain more matches than the other. Neighbouring matches are
/// not independent, so this is more than the usual three.
const CLEAR: f64 = 5.0;

/// Largest tangential coefficient of a usual lens: at one focal length from the centre it moves a pixel by a
/// hundredth of the focal length.
const TANGENTIAL: f64 = 0.01;
/// Largest share of the last two coefficients in the first two, where the images do not decide and the reading
/// is noted. The coefficients of a fisheye are terms of one series, and of like size.
const SMALL: f64 = 0.1;

impl CalibratedCamera {
    /// Chooses the cameras for images of these sizes, and the models of their lenses. Where four coefficients
    /// may be those of two models, the matches decide. They should be found without a geometry, and are asked
    /// for only if needed.
    ///
    /// # Errors
    /// A clause for the user that asks for the model, if neither the matches nor the sizes of the numbers
    /// decide.
    pub fn settled(
        pair: [Self; 2],
        frames: [Frame; 2],
        matches: impl FnOnce() -> Vec<PointPair>,
    ) -> Result<[Self; 2], String> {
        let mut k = 0;
        let mut pair = pair.map(|camera| {
            k += 1;
            camera.of_size(frames[k - 1])
        });
        if pair.iter().all(|camera| camera.reading.fisheye.is_none()) {
            return Ok(pair);
        }
        let radial = pair.each_ref().map(|camera| camera.model);
        let fisheye = pair.each_ref().map(|camera| camera.reading.fisheye.unwrap_or(camera.model));
        if (0..2).all(|k| bends_alike(&radial[k], &fisheye[k], frames[k])) {
            for camera in &mut pair {
                camera.reading.fisheye = None;
            }
            return Ok(pair);
        }
        let matches = matches();
        let Some((is_fisheye, [of_fisheye, of_radial])) =
            better(&pair, [&fisheye, &radial], frames, &matches)
        else {
            return if pair.iter().all(Self::is_plainly_radial) {
                Ok(pair.map(Self::with_radial))
            } else {
                Err(question(&pair))
            };
        };
        for camera in &mut pair {
            let Some(fisheye) = camera.reading.fisheye.take() else { continue };
            if is_fisheye {
                camera.model = fisheye;
            }
            let (kind, other) =
                if is_fisheye { ("fisheye, k1 k2 k3 k4", "k1 k2 p1 p2") } else { ("k1 k2 p1 p2", "fisheye") };
            let [more, less] = if is_fisheye { [of_fisheye, of_radial] } else { [of_radial, of_fisheye] };
            camera.reading.notes.push(format!(
                "the four distortion coefficients are read as {kind}, which explains {more} matches, and {other} \
                 {less}"
            ));
        }
        Ok(pair)
    }

    /// Refuses a pair whose lenses are open.
    ///
    /// # Errors
    /// A clause for the user that asks for the model.
    pub fn check_settled(pair: &[Self; 2]) -> Result<(), String> {
        if pair.iter().any(|camera| camera.reading.fisheye.is_some()) { Err(question(pair)) } else { Ok(()) }
    }

    /// Returns whether the last two of four coefficients are as small as tangential distortion. Those of a
    /// fisheye are terms of one series with the first two, and of their size.
    fn is_plainly_radial(&self) -> bool {
        let lens = self.model.lens();
        let Radial::Polynomial { numerator: [k1, k2, ..], .. } = lens.radial else { return true };
        let last = lens.tangential.iter().fold(0.0f64, |most, p| most.max(p.abs()));
        self.reading.fisheye.is_none() || last < TANGENTIAL && last < SMALL * k1.abs().max(k2.abs())
    }

    /// Reads four coefficients that are open as `k1 k2 p1 p2`, and notes it.
    fn with_radial(mut self) -> Self {
        if self.reading.fisheye.take().is_some() {
            self.reading.notes.push(
                "the four distortion coefficients are read as k1 k2 p1 p2, because the last two are small. The images \
                 do not tell; if cv::fisheye made the file, add fisheye: 1 to it"
                    .into(),
            );
        }
        self
    }

    /// Returns the camera for pictures of a size, if the file has several.
    fn of_size(self, frame: Frame) -> Self {
        if self.frame == Some(frame) {
            return self;
        }
        let other = self.reading.other_sizes.iter().find(|camera| camera.frame == Some(frame)).cloned();
        other.unwrap_or(self)
    }
}

fn question(pair: &[CalibratedCamera; 2]) -> String {
    let open = pair.iter().find(|camera| camera.reading.fisheye.is_some());
    let name = open.map_or("the camera", |camera| &camera.name);
    format!(
        "the distortion of {} has four numbers, which two lens models write, and the images do not tell which. \
         Add fisheye: 1 to the file if cv::fisheye made it, and fisheye: 0 if the numbers are k1 k2 p1 p2",
        excerpt(name)
    )
}

/// Returns whether two models take each pixel of a picture from nearly the same ray.
fn bends_alike(first: &CameraModel, second: &CameraModel, frame: Frame) -> bool {
    let at = |k: usize, side: f64| side * k as f64 / (SAMPLES - 1) as f64;
    (0..SAMPLES * SAMPLES).all(|k| {
        let pixel = Point::new(at(k % SAMPLES, frame.right()), at(k / SAMPLES, frame.bottom()));
        let moved = first.ray_from_image(pixel).and_then(|ray| second.image_from_ray(&ray));
        moved.is_some_and(|moved| (moved - pixel).norm() < ALIKE)
    })
}

/// Returns whether the first reading explains clearly more matches than the second (or clearly fewer), with the
/// numbers of explained matches. `None` if neither is clear.
fn better(
    pair: &[CalibratedCamera; 2],
    readings: [&[CameraModel; 2]; 2],
    frames: [Frame; 2],
    matches: &[PointPair],
) -> Option<(bool, [usize; 2])> {
    let pose = CalibratedCamera::relative_pose(pair).map(|(pose, _)| pose);
    let seen = readings.map(|models| Seen::new(models, frames, matches));
    let of_pose = pose.and_then(|pose| {
        let distances = seen.each_ref().map(|seen| {
            seen.as_ref().map_or_else(Vec::new, |seen| {
                let fundamental = pose.fundamental(&seen.views.calibrations());
                fundamental.map_or_else(Vec::new, |fundamental| seen.distances(&fundamental))
            })
        });
        clearer(&distances, matches.len())
    });
    of_pose.or_else(|| {
        let distances = seen.each_ref().map(|seen| {
            seen.as_ref().and_then(Seen::fitted).map_or_else(Vec::new, |(seen, f)| seen.distances(&f))
        });
        clearer(&distances, matches.len())
    })
}

/// Matches in the views of one reading.
struct Seen {
    views: ViewPair,
    /// Places in the views; `None` beyond the range of a lens.
    places: Vec<Option<PointPair>>,
}

impl Seen {
    fn new(models: &[CameraModel; 2], frames: [Frame; 2], matches: &[PointPair]) -> Option<Self> {
        let views = ViewPair::new(models.each_ref(), frames)?;
        let places = matches.iter().map(|found| views.undistorted_from_original(found)).collect();
        Some(Self { views, places })
    }

    /// Returns the distances in the pictures of all matches from their epipolar curves, px.
    fn distances(&self, f: &FundamentalMatrix) -> Vec<f64> {
        let distance = |place: &Option<PointPair>| self.views.distance_from_curves(f, place.as_ref()?);
        self.places.iter().map(|place| distance(place).unwrap_or(f64::INFINITY)).collect()
    }

    /// Fits a matrix to the matches.
    fn fitted(&self) -> Option<(&Self, FundamentalMatrix)> {
        let matches: Vec<Match> = self.places.iter().flatten().copied().map(Match::from).collect();
        estimate_fundamental(&matches, self.views.frames(), 0).ok().map(|fit| (self, fit.fundamental))
    }
}

/// Compares how many matches two readings explain, as in `McNemar`'s test: the matches that only one of them
/// explains tell them apart. The difference of their numbers has the deviation of the square root of their sum.
fn clearer(distances: &[Vec<f64>; 2], count: usize) -> Option<(bool, [usize; 2])> {
    let near = |reading: usize, k: usize, limit: f64| distances[reading].get(k).is_some_and(|d| *d < limit);
    let mut found = None;
    for limit in NEAR {
        let explained = [0, 1].map(|reading| (0..count).filter(|k| near(reading, *k, limit)).count());
        let alone = [0, 1].map(|reading| {
            (0..count).filter(|k| near(reading, *k, limit) && !near(1 - reading, *k, limit)).count() as f64
        });
        let [first, second] = alone;
        if (first - second).abs() <= CLEAR * (first + second).sqrt() {
            continue;
        }
        match found {
            // The answer must not hang on the limit.
            Some((is_first, _)) if is_first != (first > second) => return None,
            Some(_) => {}
            None => found = Some((first > second, explained)),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_must_explain_clearly_more_matches() {
        let good = vec![0.3; 60];
        let bad = vec![9.0; 60];
        assert_eq!(clearer(&[good.clone(), bad.clone()], 60), Some((true, [60, 0])));
        assert_eq!(clearer(&[bad.clone(), good.clone()], 60), Some((false, [0, 60])));
        assert_eq!(clearer(&[good.clone(), good.clone()], 60), None);
        assert_eq!(clearer(&[good[..20].to_vec(), bad[..20].to_vec()], 20), None, "too few");
        // Near at one limit, and far at another: nothing is clear.
        let [near, middle] = [vec![0.5; 40], vec![1.5; 40]];
        let first = [near, vec![9.0; 60]].concat();
        let second = [middle, vec![1.5; 60]].concat();
        assert_eq!(clearer(&[first, second], 100), None);
    }
}
