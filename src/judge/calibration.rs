//! Mistakes with a stereo calibration: other lenses belong to other matches without distortion.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::GivenGeometry;
use crate::camera::{CameraModel, Lens, Projection, Radial, RelativePose, ViewPair};
use crate::geometry::{FundamentalMatrix, Point, PointPair, finite_point, rescaling};

/// A stereo calibration, with the views without distortion in which matches and `F` are given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenCalibration {
    /// Relative pose of the cameras.
    pub pose: RelativePose,
    /// Views of both pictures without distortion.
    pub views: ViewPair,
}

/// Mistake with a stereo calibration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "mistake")]
pub enum CalibrationChange {
    /// The pictures are exchanged: the first calibration belongs to the second picture.
    PicturesExchanged,
    /// The four coefficients belong to an equidistant lens (fisheye), not to a radial and tangential one.
    EquidistantLens,
    /// The four coefficients belong to a radial and tangential lens, not to an equidistant one (fisheye).
    RadialLens,
    /// The calibration is for pictures of another size.
    OtherSize {
        /// Size of the pictures of the calibration over the size of the judged pictures.
        factor: f64,
    },
}

/// A calibration in another reading.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReadCalibration {
    models: [CameraModel; 2],
    calibrations: [Matrix3<f64>; 2],
    pose: RelativePose,
}

impl GivenCalibration {
    /// Returns the geometry of the calibration in the views. `None` if the cameras have none.
    pub fn geometry(&self) -> Option<GivenGeometry> {
        let fundamental = self.pose.fundamental(&self.views.calibrations())?;
        let cameras = Some(self.views.posed(&self.pose)?);
        Some(GivenGeometry { fundamental, cameras, calibration: Some(*self) })
    }

    /// Returns the calibration without a mistake. `None` if it cannot have this mistake.
    pub(super) fn read(&self, change: CalibrationChange) -> Option<ReadCalibration> {
        let models = self.views.views.each_ref().map(|view| *view.camera());
        let each =
            |of: &dyn Fn(&CameraModel) -> Option<CameraModel>| Some([of(&models[0])?, of(&models[1])?]);
        let with_lens = |of: fn(&Lens) -> Option<Lens>| {
            let is_changed = models.iter().any(|model| of(model.lens()).is_some());
            let changed = |model: &CameraModel| match of(model.lens()) {
                Some(lens) => CameraModel::new(&model.calibration(), lens),
                None => Some(*model),
            };
            each(&changed).filter(|_| is_changed)
        };
        let (models, pose) = match change {
            CalibrationChange::PicturesExchanged => {
                let [first, second] = models;
                ([second, first], inverse(&self.pose))
            }
            CalibrationChange::EquidistantLens => (with_lens(equidistant)?, self.pose),
            CalibrationChange::RadialLens => (with_lens(radial)?, self.pose),
            CalibrationChange::OtherSize { factor } => {
                let resized = |model: &CameraModel| {
                    CameraModel::new(&(rescaling(factor.recip()) * model.calibration()), *model.lens())
                };
                (each(&resized)?, self.pose)
            }
        };
        let calibrations = models.each_ref().map(CameraModel::calibration);
        Some(ReadCalibration { models, calibrations, pose })
    }

    /// Returns the places in the pictures of matches between the views.
    pub(super) fn originals(&self, matches: &[PointPair]) -> Vec<Option<PointPair>> {
        matches.iter().map(|pair| self.views.original_from_undistorted(pair)).collect()
    }
}

impl ReadCalibration {
    /// Returns `F` for pictures without distortion that keep the calibration matrices.
    pub(super) fn fundamental(&self) -> Option<FundamentalMatrix> {
        self.pose.fundamental(&self.calibrations)
    }

    /// Returns a match of the pictures without distortion.
    pub(super) fn undistorted(&self, original: &PointPair) -> Option<PointPair> {
        let place = |image: usize, point: Point| {
            let ray = self.models[image].ray_from_image(point).filter(|ray: &Vector3<f64>| ray.z > 0.0)?;
            finite_point(&(self.calibrations[image] * ray))
        };
        original.mapped(place)
    }
}

fn inverse(pose: &RelativePose) -> RelativePose {
    let rotation = pose.rotation.inverse();
    RelativePose { rotation, translation: -(rotation * pose.translation) }
}

/// Reads the coefficients `k1 k2 p1 p2` of a lens as those of an equidistant one.
fn equidistant(lens: &Lens) -> Option<Lens> {
    let Radial::Polynomial { numerator: [k1, k2, 0.0, 0.0], denominator: [0.0, 0.0, 0.0] } = lens.radial
    else {
        return None;
    };
    let is_read = lens.projection == Projection::Perspective && is_zero(&lens.prism) && !lens.is_ideal();
    let [p1, p2] = lens.tangential;
    let radial = Radial::Polynomial { numerator: [k1, k2, p1, p2], denominator: [0.0; 3] };
    let lens = Lens { projection: Projection::Equidistant, radial, tangential: [0.0; 2], prism: [0.0; 4] };
    is_read.then_some(lens)
}

fn is_zero(coefficients: &[f64]) -> bool {
    coefficients.iter().all(|c| *c == 0.0)
}

/// Reads the four coefficients of an equidistant lens as `k1 k2 p1 p2`.
fn radial(lens: &Lens) -> Option<Lens> {
    let Radial::Polynomial { numerator: [k1, k2, p1, p2], denominator: [0.0, 0.0, 0.0] } = lens.radial else {
        return None;
    };
    let is_read = lens.projection == Projection::Equidistant && is_zero(&lens.tangential);
    let radial = Radial::Polynomial { numerator: [k1, k2, 0.0, 0.0], denominator: [0.0; 3] };
    let lens = Lens { projection: Projection::Perspective, radial, tangential: [p1, p2], prism: [0.0; 4] };
    is_read.then_some(lens)
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;
    use rand::{RngExt, SeedableRng};

    use super::super::{Change, Finding, LIMIT, Reference, judge};
    use super::*;
    use crate::geometry::{Frame, eight_point, scaling};

    const FRAMES: [Frame; 2] = [Frame { width: 768, height: 576 }; 2];

    fn lens(projection: Projection, [a, b, c, d]: [f64; 4]) -> Lens {
        let (numerator, tangential) = match projection {
            Projection::Perspective => ([a, b, 0.0, 0.0], [c, d]),
            Projection::Equidistant => ([a, b, c, d], [0.0; 2]),
        };
        let radial = Radial::Polynomial { numerator, denominator: [0.0; 3] };
        Lens { projection, radial, tangential, prism: [0.0; 4] }
    }

    /// A rig of two different cameras.
    fn rig(lenses: [Lens; 2]) -> ([CameraModel; 2], RelativePose) {
        let models = [
            CameraModel::new(&scaling(620.0, 371.0, 300.0), lenses[0]).unwrap(),
            CameraModel::new(&scaling(560.0, 402.0, 271.0), lenses[1]).unwrap(),
        ];
        let rotation = Rotation3::from_euler_angles(0.02, -0.05, 0.03);
        (models, RelativePose { rotation, translation: Vector3::new(-0.98, 0.1, 0.15).normalize() })
    }

    /// Returns matches of the pictures of a rig.
    fn seen((models, pose): &([CameraModel; 2], RelativePose)) -> Vec<PointPair> {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let mut found = Vec::new();
        while found.len() < 400 {
            let mut along = |by: f64| random.random_range(-by..by);
            let point = Vector3::new(along(6.0), along(5.0), 7.0 + along(3.0));
            let noise = [0; 2].map(|_| crate::geometry::Vector::new(along(0.1), along(0.1)));
            let rays = [point, pose.rotation * point + pose.translation];
            let at = |k: usize| {
                let place = models[k].image_from_ray(&rays[k])? + noise[k];
                FRAMES[k].contains(place).then_some(place)
            };
            if let (Some(point1), Some(point2)) = (at(0), at(1)) {
                found.push(PointPair { point1, point2 });
            }
        }
        found
    }

    /// Judges a calibration by matches of the pictures.
    fn judged(
        (models, pose): &([CameraModel; 2], RelativePose),
        seen: &[PointPair],
    ) -> super::super::Judgement {
        let views = ViewPair::new(models.each_ref(), FRAMES).unwrap();
        let matches: Vec<PointPair> =
            seen.iter().filter_map(|pair| views.undistorted_from_original(pair)).collect();
        let reference = Reference {
            fundamental: eight_point(&matches).unwrap(),
            matches: &matches,
            witnesses: &matches,
            frames: views.frames(),
            is_trusted: true,
            has_epipoles: true,
            covariance: None,
        };
        let given = GivenGeometry {
            fundamental: pose.fundamental(&views.calibrations()).unwrap(),
            cameras: views.posed(pose),
            calibration: Some(GivenCalibration { pose: *pose, views }),
        };
        judge(&given, &reference, LIMIT).unwrap()
    }

    fn named(rig: &([CameraModel; 2], RelativePose), seen: &[PointPair]) -> CalibrationChange {
        let judged = judged(rig, seen);
        assert_eq!(judged.finding, Finding::DoesNotFit, "{judged:?}");
        match judged.change {
            Some(found) => match found.change {
                Change::Calibration(change) => change,
                other => panic!("{other:?}, {judged:?}"),
            },
            None => panic!("nothing named: {judged:?}"),
        }
    }

    #[test]
    fn exchanged_pictures_other_sizes_and_other_lenses_are_named() {
        let radial = [[-0.28, 0.09, 0.001, -0.002], [-0.24, 0.06, -0.001, 0.001]];
        let perspective = rig(radial.map(|d| lens(Projection::Perspective, d)));
        let pairs = seen(&perspective);
        assert_eq!(judged(&perspective, &pairs).finding, Finding::Fits);

        let exchanged: Vec<PointPair> =
            pairs.iter().map(|pair| PointPair { point1: pair.point2, point2: pair.point1 }).collect();
        assert_eq!(named(&perspective, &exchanged), CalibrationChange::PicturesExchanged);

        let misread = rig(radial.map(|d| lens(Projection::Equidistant, d)));
        assert_eq!(named(&misread, &pairs), CalibrationChange::RadialLens);
        let fisheye = rig([[-0.02, 0.004, -0.003, 0.001], [-0.015, 0.002, -0.001, 0.0005]]
            .map(|d| lens(Projection::Equidistant, d)));
        let through = seen(&fisheye);
        assert_eq!(judged(&fisheye, &through).finding, Finding::Fits);
        let misread = rig([[-0.02, 0.004, -0.003, 0.001], [-0.015, 0.002, -0.001, 0.0005]]
            .map(|d| lens(Projection::Perspective, d)));
        assert_eq!(named(&misread, &through), CalibrationChange::EquidistantLens);

        let (models, pose) = perspective;
        let twice = models
            .map(|model| CameraModel::new(&(rescaling(2.0) * model.calibration()), *model.lens()).unwrap());
        let factor = match named(&(twice, pose), &pairs) {
            CalibrationChange::OtherSize { factor } => factor,
            other => panic!("{other:?}"),
        };
        assert!((factor - 2.0).abs() < 0.02, "{factor}");
    }
}
