//! Camera models by the names and parameters of COLMAP, OpenCV and Kalibr.

use nalgebra::Matrix3;

use super::lens::{Lens, Projection, Radial};
use super::model::CameraModel;

/// COLMAP counts the centre of the top-left pixel as (0.5, 0.5).
const COLMAP_CENTRE: f64 = 0.5;

/// Names and parameters of the camera models of COLMAP, in its order.
const COLMAP: [(&str, &str); 15] = [
    ("SIMPLE_PINHOLE", "f, cx, cy"),
    ("PINHOLE", "fx, fy, cx, cy"),
    ("SIMPLE_RADIAL", "f, cx, cy, k"),
    ("RADIAL", "f, cx, cy, k1, k2"),
    ("OPENCV", "fx, fy, cx, cy, k1, k2, p1, p2"),
    ("FULL_OPENCV", "fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6"),
    ("SIMPLE_FISHEYE", "f, cx, cy"),
    ("FISHEYE", "fx, fy, cx, cy"),
    ("SIMPLE_RADIAL_FISHEYE", "f, cx, cy, k"),
    ("RADIAL_FISHEYE", "f, cx, cy, k1, k2"),
    ("OPENCV_FISHEYE", "fx, fy, cx, cy, k1, k2, k3, k4"),
    ("THIN_PRISM_FISHEYE", "fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1"),
    ("FOV", "fx, fy, cx, cy, omega"),
    ("SIMPLE_DIVISION", "f, cx, cy, k"),
    ("DIVISION", "fx, fy, cx, cy, k"),
];

impl CameraModel {
    /// Creates a camera model of COLMAP from its name and parameters. The principal point is moved
    /// by half a pixel, because COLMAP counts the centre of the top-left pixel as (0.5, 0.5).
    ///
    /// # Errors
    /// A clause for the user: an unknown name, a wrong number of parameters, impossible values.
    pub fn from_colmap(name: &str, parameters: &[f64]) -> Result<Self, String> {
        let Some((_, expected)) = COLMAP.iter().find(|(known, _)| *known == name) else {
            let known: Vec<_> = COLMAP.iter().map(|(known, _)| *known).collect();
            let name: String = name.chars().take(40).filter(|c| !c.is_control()).collect();
            return Err(format!("the camera model {name} is unknown. Known are {}", known.join(", ")));
        };
        let count = expected.split(',').count();
        if parameters.len() != count {
            return Err(format!("{name} has {count} parameters ({expected}), found {}", parameters.len()));
        }
        let has_one_focal = expected.starts_with("f,");
        let (focal, rest) = parameters.split_at(if has_one_focal { 1 } else { 2 });
        let (centre, k) = rest.split_at(2);
        let calibration = calibration(
            [focal[0], focal[focal.len() - 1]],
            [centre[0] - COLMAP_CENTRE, centre[1] - COLMAP_CENTRE],
        );
        let lens = match name {
            "SIMPLE_RADIAL" | "RADIAL" => Lens::perspective(Radial::polynomial(k)),
            "OPENCV" | "FULL_OPENCV" => Lens::from_opencv(k)?,
            "FISHEYE" | "SIMPLE_FISHEYE" | "SIMPLE_RADIAL_FISHEYE" | "RADIAL_FISHEYE" | "OPENCV_FISHEYE" => {
                Lens::equidistant(k)
            }
            "THIN_PRISM_FISHEYE" => Lens {
                tangential: [k[2], k[3]],
                prism: [k[6], 0.0, k[7], 0.0],
                ..Lens::equidistant(&[k[0], k[1], k[4], k[5]])
            },
            "FOV" => Lens::perspective(Radial::FieldOfView { omega: k[0] }),
            "SIMPLE_DIVISION" | "DIVISION" => Lens::perspective(Radial::Division { lambda: k[0] }),
            _ => Lens::IDEAL,
        };
        Self::new(&calibration, lens).ok_or_else(|| IMPOSSIBLE.into())
    }
}

/// Clause for a calibration matrix that no camera has.
pub(crate) const IMPOSSIBLE: &str =
    "the calibration is impossible: focal lengths must be positive, and all numbers finite";

impl Lens {
    /// Creates a lens from distortion coefficients of OpenCV: `k1, k2, p1, p2[, k3[, k4, k5, k6[, s1,
    /// s2, s3, s4]]]`.
    ///
    /// # Errors
    /// A clause for the user: another number of coefficients, or a tilted sensor, which is not
    /// supported.
    pub fn from_opencv(coefficients: &[f64]) -> Result<Self, String> {
        let count = coefficients.len();
        if count == 14 && coefficients[12..] != [0.0; 2] {
            return Err("lenses with a tilted sensor (τx, τy) are not supported".into());
        }
        if !matches!(count, 0 | 4 | 5 | 8 | 12 | 14) {
            return Err(format!("expected 4, 5, 8 or 12 distortion coefficients, found {count}"));
        }
        let k = |n: usize| coefficients.get(n).copied().unwrap_or(0.0);
        Ok(Self {
            tangential: [k(2), k(3)],
            prism: [k(8), k(9), k(10), k(11)],
            ..Self::perspective(Radial::Polynomial {
                numerator: [k(0), k(1), k(4), 0.0],
                denominator: [k(5), k(6), k(7)],
            })
        })
    }

    /// Creates a fisheye lens of OpenCV or Kalibr (`equidistant`) with up to four coefficients.
    pub fn equidistant(coefficients: &[f64]) -> Self {
        Self { projection: Projection::Equidistant, ..Self::perspective(Radial::polynomial(coefficients)) }
    }
}

/// Returns the calibration matrix of focal lengths and a principal point, px.
pub fn calibration(focal: [f64; 2], principal: [f64; 2]) -> Matrix3<f64> {
    Matrix3::new(focal[0], 0.0, principal[0], 0.0, focal[1], principal[1], 0.0, 0.0, 1.0)
}
