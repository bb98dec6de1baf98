//! Words for judgements of geometries from elsewhere.

use crate::judge::{
    Affected, CalibrationChange, CameraChange, Change, Doubt, Finding, FittingChange, Judgement, Mirror,
    RowJudgement, Significance,
};

/// Describes a judgement: whether the geometry fits the images, and which change would correct it.
pub fn judgement_in_words(judgement: &Judgement) -> String {
    let Judgement { lines_apart, residuals, limit, matches, change, .. } = judgement;
    let apart = px(lines_apart.median);
    match judgement.finding {
        Finding::Fits => format!(
            "The geometry fits. Half of its lines are within {apart} px of the lines that the images show, at \
             {matches} matches.{}",
            judgement
                .significance
                .map_or_else(String::new, |found| difference_in_words(&found, change.as_ref()))
        ),
        Finding::Undecided => {
            let doubt = judgement.doubt.as_ref();
            format!(
                "The images cannot tell whether the geometry is right: {}{}",
                doubt.map_or_else(String::new, |doubt| doubt_in_words(doubt, &apart)),
                essential_in_words(judgement)
            )
        }
        Finding::DoesNotFit if change.is_some_and(|found| found.change == Change::TranslationReversed) => {
            format!(
                "The geometry does not fit. Its lines are within {apart} px of the lines that the images show, but the \
                 scene lies behind both cameras. It fits if the translation T has the opposite sign: negate it. F \
                 stays the same."
            )
        }
        Finding::DoesNotFit => {
            let wrong = if lines_apart.median > *limit {
                format!("Half of its lines are more than {apart} px from the lines that the images show")
            } else {
                format!("Half of the matches are more than {} px from its lines", px(residuals.median))
            };
            let mended = change.as_ref().map_or_else(
                || format!("No simple change clearly makes it fit.{}", essential_in_words(judgement)),
                |found| format!("It fits to {} px if {}.", px(found.median), change_in_words(&found.change)),
            );
            format!("The geometry does not fit. {wrong}, at {matches} matches. {mended}")
        }
    }
}

/// Describes why nothing is found, and what to do. Half of the lines are `apart` px from those of the
/// reference.
fn doubt_in_words(doubt: &Doubt, apart: &str) -> String {
    let far = format!("half of its lines are more than {apart} px from the best lines of the images, but");
    match doubt {
        Doubt::Reference => format!(
            "{far} these are in doubt themselves. Use pictures that overlap more or show more texture, or give matches of \
             your own."
        ),
        Doubt::FewWitnesses { .. } => {
            format!("{far} too few distinctive points show which lines are right. {PATTERNS_SHOW_NOTHING}")
        }
        Doubt::WitnessesAgree { .. } => format!(
            "{far} the distinctive points agree with the geometry. The images probably show a repeated pattern. Give \
             matches of your own."
        ),
        Doubt::Depth => {
            "its lines fit, but most points lie behind both cameras, and these points are not distinctive. \
                         Check the sign of the translation T, or give matches of your own."
                .to_owned()
        }
        Doubt::OtherSearch => format!(
            "{far} a second search finds other lines. Use pictures that overlap more, or give matches of your own."
        ),
    }
}

/// Why few distinctive points are found on a board, and what to do.
const PATTERNS_SHOW_NOTHING: &str = "Boards and other repeated patterns do not show it. Use pictures of a scene with more \
                                     distinctive points, or give matches of your own.";

/// Tells that a matrix looks like an essential matrix.
fn essential_in_words(judgement: &Judgement) -> &'static str {
    if judgement.looks_essential {
        " The matrix has two equal singular values, like an essential matrix E. F of the pictures is inv(K2)' E inv(K1): \
         give that."
    } else {
        ""
    }
}

/// Largest χ² of a difference that digits of a file explain.
const ROUNDING: f64 = 1e-3;

/// Describes whether the matches explain the difference of a geometry that fits.
fn difference_in_words(found: &Significance, change: Option<&FittingChange>) -> String {
    let Significance { chi_square, limit, is_significant } = found;
    if *chi_square < ROUNDING {
        return " It is the geometry of the result, up to rounding.".to_owned();
    }
    let figures = format!("χ² of the difference {chi_square:.0}; up to {limit:.0} would be chance");
    if !is_significant {
        return format!(" The matches are too imprecise to tell the two geometries apart ({figures}).");
    }
    let cause = change.map_or_else(String::new, |found| {
        format!(" Half a pixel explains it: {}.", change_in_words(&found.change))
    });
    format!(
        " But the two geometries differ by more than the errors of the matches explain ({figures}).{cause}"
    )
}

/// Describes a change as a condition that ends the sentence "It fits if".
fn change_in_words(change: &Change) -> String {
    match *change {
        Change::Convention { reading } => {
            format!("it is read in another convention: {reading}")
        }
        Change::Cameras { mistake } => match mistake {
            CameraChange::CameraToWorld => {
                "the poses are inverted (they map the camera to the world, not the world to the camera), or the pictures of \
                 two similar cameras are exchanged"
            }
            CameraChange::OpenGlAxes => {
                "the camera axes are those of OpenGL (y up, z backwards), or the pose is \
                                         a mirror image"
            }
            CameraChange::YUp => "y of the cameras points up",
            CameraChange::PositionForTranslation => {
                "the translations are the positions C of the cameras, and not \
                                                     t = −R C"
            }
            CameraChange::RotationInverted => "the rotations are inverted, and the translations are not",
            CameraChange::QuaternionOrder => "the quaternions have their real part last",
            CameraChange::FocalLengthsExchanged => "the focal lengths in x and y are exchanged",
            CameraChange::PrincipalPointExchanged => "x and y of the principal points are exchanged",
            CameraChange::CalibrationsExchanged => "the calibrations of the two cameras are exchanged",
            CameraChange::CalibrationTransposed => "the calibration matrices K are transposed",
        }
        .to_owned(),
        Change::Calibration(change) => match change {
            CalibrationChange::PicturesExchanged => {
                "the two pictures are exchanged: the first camera took the right picture".to_owned()
            }
            CalibrationChange::EquidistantLens => {
                "the lens is a fisheye: its coefficients are k1 to k4 of the equidistant model".to_owned()
            }
            CalibrationChange::RadialLens => {
                "the lens is no fisheye: its coefficients are k1, k2, p1, p2".to_owned()
            }
            CalibrationChange::OtherSize { factor } => format!(
                "the calibration is for pictures of another size, {:.1} % of these: divide the focal lengths and the \
                 principal points by {factor:.3}",
                100.0 * factor
            ),
        },
        Change::Essential { focal } => format!(
            "the matrix is an essential matrix E, not F, with a focal length of about {focal:.0} px: give \
             F = inv(K2)' E inv(K1)"
        ),
        Change::TranslationReversed => "the translation has the opposite sign".to_owned(),
        Change::Mirrored { images, mirror } => {
            let are = if images == Affected::Both { "are" } else { "is" };
            let images = format!("{} {are}", of_images(images));
            match mirror {
                Mirror::LeftRight => {
                    format!("{images} mirrored left to right, or the camera axes are those of OpenGL")
                }
                Mirror::TopBottom => format!("y is counted from the bottom: {images} mirrored top to bottom"),
                Mirror::HalfTurn => format!("{images} turned by 180°"),
            }
        }
        Change::Resized { images, factor } => {
            let of = of_images(images);
            format!("the geometry is for images of {:.1} % of the size of {of}", 100.0 * factor)
        }
        Change::FocalLength { images, factor } => {
            format!("the focal length of {} is divided by {factor:.3}", of_images(images))
        }
        Change::HalfPixel { images, offset } => {
            let of = of_images(images);
            if offset > 0.0 {
                format!("the geometry counts the centre of the top-left pixel of {of} as (0.5, 0.5)")
            } else {
                format!("the geometry subtracts half a pixel too much from the coordinates of {of}")
            }
        }
        Change::Moved { images, x, y } => format!(
            "({x:.1}, {y:.1}) px is added to the coordinates of {}: cropped images, a wrong principal point, or a \
             camera that has turned a little",
            of_images(images)
        ),
        Change::Distortion { k } => format!(
            "the distortion of the lens is removed from the images: points at the corners belong {:.1} % {}",
            100.0 * k.abs(),
            if k > 0.0 { "farther out" } else { "farther in" }
        ),
    }
}

/// Describes how far two rectified images are from common rows.
pub fn rows_in_words(judgement: &RowJudgement) -> String {
    let RowJudgement { matches, constant, across, down, curved, largest, typical, limit, .. } = judgement;
    let parts = format!(
        "Right rows less left rows: {constant:+.2} px in the middle, {across:+.2} px from left to right, \
         {down:+.2} px from top to bottom, {curved:.2} px of curvature ({matches} matches)."
    );
    if judgement.is_aligned {
        return format!("The images are rectified: rows agree to {typical:.2} px. {parts}");
    }
    if let Some(doubt) = &judgement.doubt {
        return match doubt {
            Doubt::Reference => {
                "The images cannot tell whether they are rectified: the matches are in doubt. Use pictures \
                                 that overlap more or show more texture, or give matches of your own."
                    .to_owned()
            }
            _ => format!(
                "The images cannot tell whether they are rectified: too few distinctive points show which rows \
                 correspond. {PATTERNS_SHOW_NOTHING}"
            ),
        };
    }
    let cause = if judgement.is_far_off() {
        "The pair was never rectified, or it was rectified for other cameras. Rectify it.".to_owned()
    } else if *curved > 0.5 * limit {
        "The remaining difference is curved, as with a wrong lens distortion. Calibrate again.".to_owned()
    } else {
        format!(
            "A homography of the right image, with a turn of {:+.2}° clockwise, aligns the rows (correction2 in the JSON \
             of epiline judge --rectified).",
            judgement.roll_degrees
        )
    };
    format!(
        "The images are not rectified: rows differ by {typical:.2} px, and by up to {largest:.2} px. {parts} {cause}"
    )
}

fn of_images(images: Affected) -> &'static str {
    match images {
        Affected::Both => "both images",
        Affected::Image1 => "the left image",
        Affected::Image2 => "the right image",
    }
}

/// Formats a distance with its significant digits.
fn px(value: f64) -> String {
    if value < 10.0 { format!("{value:.2}") } else { format!("{value:.0}") }
}
