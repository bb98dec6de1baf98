//! Lens of a camera from its coefficients and the name of its model.
//!
//! OpenCV writes four coefficients for two models: `k1 k2 p1 p2` of `cv::calibrateCamera` and `k1 k2 k3 k4` of
//! `cv::fisheye::calibrate`. Without the name of the model both readings are kept, and the images decide.

use super::fields::Content;
use super::names::{Role, Scalar};
use super::rig::Rig;
use crate::camera::{Lens, Radial};
use crate::foreign::excerpt;

/// Model of a lens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Model {
    /// OpenCV's `k1 k2 p1 p2 k3 …`.
    RadialTangential,
    /// Equidistant fisheye with `k1 k2 k3 k4`.
    Fisheye,
    FieldOfView,
    Ideal,
}

/// Lens of a camera.
pub(super) struct LensReading {
    pub lens: Lens,
    /// The lens if its four coefficients are those of a fisheye, as far as that is open.
    pub fisheye: Option<Lens>,
    /// Whether the file has coefficients.
    pub is_given: bool,
    pub note: Option<String>,
}

const FISHEYE: [&str; 12] = [
    "equidistant",
    "equi",
    "fisheye",
    "opencvfisheye",
    "kannalabrandt",
    "kannalabrandt4",
    "kannalabrandt8",
    "kb4",
    "kb8",
    "pinholeequi",
    "pinholeequidistant",
    "cvfisheye",
];
const RADIAL_TANGENTIAL: [&str; 19] = [
    "radtan",
    "radtan4",
    "radtan5",
    "radtan8",
    "plumbbob",
    "radialtangential",
    "brown",
    "brownconrady",
    "browncon",
    "opencv",
    "rational",
    "rationalpolynomial",
    "pinholeradtan",
    "pinholeradtan8",
    "standard",
    "polynomial",
    "perspective",
    "thinprism",
    "pinhole",
];
const IDEAL: [&str; 5] = ["none", "nodistortion", "", "ideal", "null"];
/// Names of camera models that are not supported.
const FOREIGN: [&str; 14] = [
    "omni",
    "omnidirectional",
    "mei",
    "catadioptric",
    "ds",
    "doublesphere",
    "eucm",
    "ucm",
    "scaramuzza",
    "ocam",
    "ftheta",
    "equirectangular",
    "spherical",
    "inversebrownconrady",
];

/// Names of settings that tell the model of a lens, words joined.
const FLAGS: [&str; 6] =
    ["fisheye", "isfisheye", "fisheyemodel", "usefisheye", "fisheyelens", "fisheyecamera"];
const LENS_NAMES: [&str; 6] =
    ["distortionmodel", "distmodel", "distortiontype", "distortion", "lensmodel", "lenstype"];
const PROJECTION_NAMES: [&str; 6] =
    ["cameramodel", "cameratype", "modeltype", "model", "type", "projectionmodel"];

/// Returns whether a name, its words joined, tells the model of a lens.
pub(super) fn is_setting(name: &str) -> bool {
    [FLAGS, LENS_NAMES, PROJECTION_NAMES].concat().contains(&name)
}

/// Returns the model that the file names for a camera or for all cameras.
///
/// # Errors
/// A clause for the user, if the model is not supported or two names contradict each other.
pub(super) fn model_of(rig: &Rig, camera: &[String]) -> Result<Option<Model>, String> {
    let (mut lens, mut projection) = (None, None);
    for field in &rig.fields {
        let (setting, of) = field.setting();
        if of != camera && !of.is_empty() {
            continue;
        }
        let found = match setting.as_str() {
            flag_name if FLAGS.contains(&flag_name) => match flag(&field.content) {
                Some(true) => Some(Model::Fisheye),
                Some(false) => Some(Model::RadialTangential),
                None => continue,
            },
            name if LENS_NAMES.contains(&name) => {
                let Content::Word(word) = &field.content else { continue };
                let model = named(word);
                if model.is_none() {
                    return Err(format!("the distortion model {} is not supported", excerpt(word)));
                }
                model
            }
            name if PROJECTION_NAMES.contains(&name) => {
                let Content::Word(word) = &field.content else { continue };
                if FOREIGN.contains(&joined(word).as_str()) {
                    return Err(format!("the camera model {} is not supported, only pinhole", excerpt(word)));
                }
                // The product of a maker is no model of a lens.
                projection = named(word).filter(|model| *model != Model::Ideal).or(projection);
                continue;
            }
            _ => continue,
        };
        if lens.is_some() && found != lens {
            return Err("two names tell different models of the lens".into());
        }
        lens = found;
    }
    let says = |f: &&super::fields::Field| f.meaning.is_fisheye && f.meaning.camera == camera;
    let is_named = rig.fields.iter().find(says).map(|_| Model::Fisheye);
    Ok(lens.or(projection).or(is_named))
}

/// Returns the lens of a camera.
pub(super) fn lens_of(rig: &Rig, camera: &[String], model: Option<Model>) -> Result<LensReading, String> {
    let list = rig.field(camera, |role| role == Role::Distortion)?;
    let k: Vec<Option<f64>> = (1..=6).map(|n| rig.scalar(camera, Scalar::K(n))).collect::<Result<_, _>>()?;
    let p: Vec<Option<f64>> = (1..=2).map(|n| rig.scalar(camera, Scalar::P(n))).collect::<Result<_, _>>()?;
    let has_scalars = k.iter().chain(&p).any(Option::is_some);
    let radial = rig.field(camera, |role| role == Role::Radial)?;
    let tangential = rig.field(camera, |role| role == Role::Tangential)?;
    let number = |list: &[Option<f64>], k: usize| list.get(k).copied().flatten().unwrap_or(0.0);
    let mut model = model;
    let coefficients = if let Some(list) = list {
        if has_scalars || radial.is_some() {
            return Err(format!(
                "there are two distortions: {} and single coefficients",
                excerpt(&list.name())
            ));
        }
        list.numbers().to_vec()
    } else if let Some(radial) = radial {
        let r = radial.numbers();
        let t = tangential.map_or(&[][..], |field| field.numbers());
        if r.len() > 3 || !matches!(t.len(), 0 | 2) || has_scalars {
            return Err("expected 2 or 3 radial and 2 tangential coefficients".into());
        }
        model = model.or(Some(Model::RadialTangential));
        let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
        vec![at(r, 0), at(r, 1), at(t, 0), at(t, 1), at(r, 2)]
    } else if tangential.is_some() {
        return Err("there are tangential coefficients without radial ones".into());
    } else if has_scalars {
        // VINS names the coefficients of a fisheye k2 to k5.
        let is_shifted = k[0].is_none() && k[1..5].iter().all(Option::is_some) && p == [None, None];
        let count = k.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
        if !is_shifted && k[..count].iter().any(Option::is_none) {
            return Err("a radial coefficient is missing between the others".into());
        }
        match (&p[..], count) {
            ([None, None], 5) if is_shifted => {
                model = Some(Model::Fisheye);
                k[1..5].iter().map(|k| k.unwrap_or(0.0)).collect()
            }
            // Only a fisheye has a fourth radial coefficient without tangential ones.
            ([None, None], 4) => {
                model = model.or(Some(Model::Fisheye));
                k[..4].iter().map(|k| k.unwrap_or(0.0)).collect()
            }
            ([None, Some(_)] | [Some(_), None], _) => {
                return Err("p1 and p2 must both be given".into());
            }
            _ => {
                model = model.or(Some(Model::RadialTangential));
                let mut list =
                    vec![number(&k, 0), number(&k, 1), number(&p, 0), number(&p, 1), number(&k, 2)];
                if count > 3 {
                    list.extend([number(&k, 3), number(&k, 4), number(&k, 5)]);
                }
                list
            }
        }
    } else {
        Vec::new()
    };
    let is_given = !coefficients.is_empty();
    reading(&coefficients, model, is_given)
}

fn reading(coefficients: &[f64], model: Option<Model>, is_given: bool) -> Result<LensReading, String> {
    let plain = |lens: Lens| LensReading { lens, fisheye: None, is_given, note: None };
    Ok(match model {
        Some(Model::Fisheye) => LensReading {
            note: Some("the lens is read as a fisheye (equidistant, k1 k2 k3 k4)".into()),
            ..plain(fisheye(coefficients)?)
        },
        Some(Model::FieldOfView) => match coefficients[..] {
            [omega] => plain(Lens::perspective(Radial::FieldOfView { omega })),
            _ => return Err("the distortion model fov has one coefficient".into()),
        },
        Some(Model::Ideal) if coefficients.iter().any(|k| *k != 0.0) => {
            return Err("there are coefficients, and the distortion model is none".into());
        }
        Some(Model::Ideal) => plain(Lens::IDEAL),
        Some(Model::RadialTangential) => plain(Lens::from_opencv(coefficients)?),
        None => {
            let is_open = coefficients.len() == 4 && coefficients.iter().any(|k| *k != 0.0);
            let fisheye = is_open.then(|| Lens::equidistant(coefficients));
            LensReading { fisheye, ..plain(Lens::from_opencv(coefficients)?) }
        }
    })
}

/// Creates a fisheye lens. Coefficients after the fourth must be zero.
pub(super) fn fisheye(coefficients: &[f64]) -> Result<Lens, String> {
    match coefficients.split_at_checked(4) {
        Some((four, rest)) if rest.iter().all(|k| *k == 0.0) => Ok(Lens::equidistant(four)),
        _ => Err(format!("a fisheye lens has 4 coefficients, found {}", coefficients.len())),
    }
}

fn joined(word: &str) -> String {
    word.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn named(word: &str) -> Option<Model> {
    let word = joined(word);
    let is_in = |list: &[&str]| list.contains(&word.as_str());
    if is_in(&FISHEYE) {
        Some(Model::Fisheye)
    } else if is_in(&RADIAL_TANGENTIAL) {
        Some(Model::RadialTangential)
    } else if is_in(&IDEAL) {
        Some(Model::Ideal)
    } else {
        (word == "fov" || word == "atan").then_some(Model::FieldOfView)
    }
}

fn flag(content: &Content) -> Option<bool> {
    match content {
        Content::Number(number) => Some(*number != 0.0),
        Content::Word(word) => match word.to_lowercase().as_str() {
            "true" | "yes" | "on" => Some(true),
            "false" | "no" | "off" => Some(false),
            _ => None,
        },
        _ => None,
    }
}
