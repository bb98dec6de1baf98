//! Lenses by the name of their model and its coefficients, for files and for people.

use super::lens::{Lens, Projection, Radial};

named! {
    fn name;
    /// Lens model with a common definition.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum LensModel {
        /// No distortion.
        Ideal = "none",
        /// OpenCV: `k1, k2, p1, p2[, k3[, k4, k5, k6[, s1, s2, s3, s4]]]`.
        OpenCv = "opencv",
        /// `cv::fisheye`, Kalibr's `equidistant`: `k1, k2, k3, k4`.
        OpenCvFisheye = "opencv-fisheye",
        /// COLMAP's `THIN_PRISM_FISHEYE`: `k1, k2, p1, p2, k3, k4, sx1, sy1`.
        ThinPrismFisheye = "thin-prism-fisheye",
        /// Field-of-view model: `ω`.
        FieldOfView = "fov",
        /// Division model: `λ` for radii in focal lengths.
        Division = "division",
        /// A combination without a common name, which files cannot describe.
        Other = "other",
    }
}

impl Lens {
    /// Returns the model of the lens, and its coefficients in the order of [`LensModel`].
    pub fn named(&self) -> (LensModel, Vec<f64>) {
        let Self { projection, radial, tangential: [p1, p2], prism: [s1, s2, s3, s4] } = *self;
        let is_radial = self.tangential.iter().chain(&self.prism).all(|c| *c == 0.0);
        if self.is_ideal() {
            return (LensModel::Ideal, Vec::new());
        }
        match (projection, radial) {
            (
                Projection::Perspective,
                Radial::Polynomial { numerator: [k1, k2, k3, 0.0], denominator: [k4, k5, k6] },
            ) => {
                let all = vec![k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4];
                let used = all.iter().rposition(|k| *k != 0.0).map_or(0, |last| last + 1);
                let count = [4, 5, 8, 12].into_iter().find(|count| *count >= used).unwrap_or(12);
                (LensModel::OpenCv, all[..count].to_vec())
            }
            (Projection::Equidistant, Radial::Polynomial { numerator, denominator: [0.0, 0.0, 0.0] }) => {
                let [k1, k2, k3, k4] = numerator;
                match (is_radial, s2 == 0.0 && s4 == 0.0) {
                    (true, _) => (LensModel::OpenCvFisheye, numerator.to_vec()),
                    (false, true) => (LensModel::ThinPrismFisheye, vec![k1, k2, p1, p2, k3, k4, s1, s3]),
                    (false, false) => (LensModel::Other, Vec::new()),
                }
            }
            (Projection::Perspective, Radial::FieldOfView { omega }) if is_radial => {
                (LensModel::FieldOfView, vec![omega])
            }
            (Projection::Perspective, Radial::Division { lambda }) if is_radial => {
                (LensModel::Division, vec![lambda])
            }
            _ => (LensModel::Other, Vec::new()),
        }
    }

    /// Creates the lens of a model from the coefficients of [`Self::named`]. `None` for an unknown model or
    /// another number of coefficients.
    pub fn of_model(name: &str, coefficients: &[f64]) -> Option<Self> {
        match (LensModel::ALL.into_iter().find(|model| model.name() == name)?, coefficients) {
            (LensModel::Ideal, []) => Some(Self::IDEAL),
            (LensModel::OpenCv, _) => Self::from_opencv(coefficients).ok(),
            (LensModel::OpenCvFisheye, [_, _, _, _]) => Some(Self::equidistant(coefficients)),
            (LensModel::ThinPrismFisheye, [k1, k2, p1, p2, k3, k4, sx1, sy1]) => Some(Self {
                tangential: [*p1, *p2],
                prism: [*sx1, 0.0, *sy1, 0.0],
                ..Self::equidistant(&[*k1, *k2, *k3, *k4])
            }),
            (LensModel::FieldOfView, [omega]) => {
                Some(Self::perspective(Radial::FieldOfView { omega: *omega }))
            }
            (LensModel::Division, [lambda]) => Some(Self::perspective(Radial::Division { lambda: *lambda })),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_comes_back_by_its_name() {
        let coefficients = [
            (LensModel::Ideal, vec![]),
            (LensModel::OpenCv, vec![-0.2, 0.1, 1e-3, -2e-3]),
            (LensModel::OpenCv, vec![-0.2, 0.1, 0.0, 0.0, 0.03]),
            (LensModel::OpenCv, vec![-0.2, 0.1, 0.0, 0.0, 0.03, 0.1, 0.2, 0.3]),
            (LensModel::OpenCv, vec![-0.2, 0.1, 0.0, 0.0, 0.03, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 2e-3]),
            (LensModel::OpenCvFisheye, vec![0.1, -0.02, 0.0, 0.004]),
            (LensModel::OpenCvFisheye, vec![0.0; 4]),
            (LensModel::ThinPrismFisheye, vec![0.1, 0.2, 1e-3, 2e-3, 0.03, 0.04, 1e-4, 2e-4]),
            (LensModel::FieldOfView, vec![0.9]),
            (LensModel::Division, vec![-0.3]),
        ];
        for (model, coefficients) in coefficients {
            let lens = Lens::of_model(model.name(), &coefficients).unwrap();
            assert_eq!(lens.named(), (model, coefficients));
        }
        assert_eq!(Lens::of_model("division", &[]), None);
        assert_eq!(Lens::of_model("other", &[]), None);
        let mixed = Lens { tangential: [0.1, 0.0], ..Lens::of_model("fov", &[0.9]).unwrap() };
        assert_eq!(mixed.named().0, LensModel::Other);
    }
}
