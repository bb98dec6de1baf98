//! Words for the distortion of a lens.

use nalgebra::Matrix3;

use crate::camera::{Lens, LensModel, PicturesOf, UndistortedView};
use crate::estimate::DivisionFit;
use crate::geometry::Frame;

/// Returns the coefficients with their standard deviations, and how far they move the corners of images of
/// these sizes.
pub fn lens_in_words(lens: &DivisionFit, frames: [Frame; 2]) -> String {
    let coefficient = |k: usize| format!("{:.4} ± {:.4}", lens.lambdas[k], lens.deviations[k]);
    let coefficients = if lens.is_same {
        format!("λ {} for both images", coefficient(0))
    } else {
        format!("λ {} and {}", coefficient(0), coefficient(1))
    };
    let shift = lens.corner_shift(frames);
    format!(
        "lens distortion fits the matches clearly better: {coefficients}; it moves the corners by {shift:.0} px"
    )
}

/// Returns sentences on the pictures that coordinates belong to, in ASCII. `origin` is the coordinate of the
/// centre of the top-left pixel. Empty if the pictures are not known.
pub fn pictures_in_words(pictures: &PicturesOf, origin: f64) -> Vec<String> {
    match pictures {
        PicturesOf::Untold => Vec::new(),
        PicturesOf::Original => vec!["All coordinates belong to the pictures as they are.".to_owned()],
        PicturesOf::Undistorted(views) => {
            let views = views.as_ref().map(|views| &views.views);
            let described =
                views.into_iter().flatten().zip(1..).map(|(view, k)| view_in_words(view, k, origin));
            let first = "All coordinates belong to views without lens distortion, not to the pictures.";
            std::iter::once(first.to_owned()).chain(described).collect()
        }
    }
}

/// Describes a view: its size and matrix, and the lens of its picture.
fn view_in_words(view: &UndistortedView, number: usize, origin: f64) -> String {
    let (frame, original) = (view.frame(), view.original());
    let camera = view.camera().calibration();
    format!(
        "View {number}: {} x {} px, K = {}; the picture of {} x {} px has K = {}, centre ({:?}, {:?}), lens model {}.",
        frame.width,
        frame.height,
        matrix_in_words(view.calibration(), origin),
        original.width,
        original.height,
        matrix_in_words(&camera, origin),
        camera[(0, 2)] + origin,
        camera[(1, 2)] + origin,
        model_in_words(view.camera().lens()),
    )
}

/// Returns a calibration matrix in one line, row by row.
fn matrix_in_words(calibration: &Matrix3<f64>, origin: f64) -> String {
    let mut moved = *calibration;
    moved[(0, 2)] += origin;
    moved[(1, 2)] += origin;
    let row = |k: usize| format!("{:?}, {:?}, {:?}", moved[(k, 0)], moved[(k, 1)], moved[(k, 2)]);
    format!("[{}; {}; {}]", row(0), row(1), row(2))
}

/// Names the model of a lens with its coefficients.
fn model_in_words(lens: &Lens) -> String {
    let (model, coefficients) = lens.named();
    let names: &[&str] = match model {
        LensModel::Ideal | LensModel::Other => &[],
        LensModel::OpenCv => &["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"],
        LensModel::OpenCvFisheye => &["k1", "k2", "k3", "k4"],
        LensModel::ThinPrismFisheye => &["k1", "k2", "p1", "p2", "k3", "k4", "sx1", "sy1"],
        LensModel::FieldOfView => &["omega"],
        LensModel::Division => &["lambda"],
    };
    let values = names.iter().zip(&coefficients).map(|(name, value)| format!(" {name} {value:?}"));
    format!("{}{}", model.name(), values.collect::<Vec<_>>().join(","))
}

/// Names the lenses of both pictures in a few words, for messages.
pub fn lenses_in_words(pictures: &PicturesOf) -> String {
    let Some(views) = pictures.views() else { return "a lens that the file does not describe".to_owned() };
    let [left, right] = views.views.each_ref().map(|view| model_in_words(view.camera().lens()));
    if left == right {
        format!("lens model {left}")
    } else {
        format!("lens models {left} (left) and {right} (right)")
    }
}
