//! Checks of the input before a search, and warnings about the clicks of a result.

use std::sync::Arc;

use crate::estimate::evidence::lines::ComparedPencils;
use crate::estimate::{Clicks, EstimateError, PreparedPair, SearchPlan, Warning};
use crate::geometry::{Frame, FundamentalMatrix, PointPair, apart_across_lines};
use crate::image::GrayPlane;

/// Smallest image side in which lines are compared, px: the smallest side that `coarse_side`
/// permits.
pub const SMALLEST_SIDE: usize = 32;
/// Smallest distance between clicks, px: a few times the error of a click.
const CLOSEST: f64 = 4.0;
/// Mean absolute difference below which two images are the same picture, grey levels. Compression
/// leaves less at this size, a camera that moved leaves more at edges.
const IDENTICAL: f64 = 0.8;
/// Standard deviation below which an image is flat, grey levels: about the rounding of its pixels.
const FLAT: f64 = 1.0;
/// Mean grey level below which a corner is black: black in video (ITU-R BT.601).
const DARK: f64 = 16.0;
/// Side of a corner, as one of so many parts of the shorter side.
const DARK_SQUARES: usize = 16;
/// Longer side at which images are checked, px. Reduction averages the noise of single pixels.
const LOOK_SIDE: f64 = 256.0;
/// Distance of a click from the epipolar line of the other, as a share of the longer side, below
/// which the clicks hardly determine the epipoles. An error of a click is twenty times as large at
/// the other end of the image.
const SAME_LINE: f64 = 0.05;
/// Distance between clicks, as a share of the longer side, below which a small error turns the
/// lines a lot. An error of a pixel is twelve pixels at the far side.
const CLOSE: f64 = 0.08;
/// A pair has little texture if fewer than one in this many of its lines have texture. It decides
/// only whether there is a warning.
const LITTLE_TEXTURE: usize = 3;

/// Checks that there are enough clicks, inside the images, and apart from each other.
pub(in crate::estimate) fn check_points(
    frames: [Frame; 2],
    clicks: &Clicks,
    plan: SearchPlan,
) -> Result<(), EstimateError> {
    let needed = plan.least_clicks();
    if clicks.len() < needed {
        return Err(EstimateError::TooFewPairs { found: clicks.len(), needed });
    }
    let pairs: Vec<PointPair> = clicks.iter().map(|click| click.pair).collect();
    for (image, frame) in frames.iter().enumerate() {
        if frame.width.min(frame.height) < SMALLEST_SIDE {
            let (width, height) = (frame.width, frame.height);
            return Err(EstimateError::TooSmall { image: image + 1, width, height, smallest: SMALLEST_SIDE });
        }
    }
    for (k, pair) in pairs.iter().enumerate() {
        if !pair.is_finite() {
            return Err(EstimateError::NotFinite(k + 1));
        }
        for (image, point) in [pair.point1, pair.point2].into_iter().enumerate() {
            let frame = frames[image];
            if !frame.contains(point) {
                return Err(EstimateError::Outside {
                    pair: k + 1,
                    image: image + 1,
                    x: point.x,
                    y: point.y,
                    width: frame.width,
                    height: frame.height,
                });
            }
        }
    }
    let held = clicks.indispensable(plan);
    for (rank, k) in held.iter().enumerate() {
        for j in &held[..rank] {
            let (a, b) = (pairs[*j], pairs[*k]);
            for (image, distance) in
                [(b.point1 - a.point1).norm(), (b.point2 - a.point2).norm()].into_iter().enumerate()
            {
                if distance < CLOSEST {
                    return Err(EstimateError::TooClose {
                        first: j + 1,
                        second: k + 1,
                        image: image + 1,
                        distance,
                    });
                }
            }
        }
    }
    Ok(())
}

/// Checks that the images are not flat and not identical.
pub(in crate::estimate) fn check_images(prepared: &PreparedPair) -> Result<(), EstimateError> {
    let level = prepared.pyramids().level(LOOK_SIDE);
    for (image, plane) in level.planes.iter().enumerate() {
        if plane.contrast() < FLAT {
            return Err(EstimateError::Flat(image + 1));
        }
    }
    let [a, b] = level.planes;
    let difference = || a.mean_with(b, |x, y| f64::from((x - y).abs()));
    if a.frame() == b.frame() && difference().is_some_and(|mean| mean < IDENTICAL) {
        return Err(EstimateError::NoParallax);
    }
    Ok(())
}

/// Returns whether all corners of both images are black, as around the round picture of a fisheye lens.
pub(in crate::estimate) fn have_dark_corners(prepared: &PreparedPair) -> bool {
    let is_dark = |plane: &GrayPlane| {
        let Frame { width, height } = plane.frame();
        let square = (width.min(height) / DARK_SQUARES).max(1);
        let mean = |x: usize, y: usize| {
            let sum: f64 =
                (y..y + square).flat_map(|y| &plane.row(y)[x..x + square]).map(|v| f64::from(*v)).sum();
            sum / (square * square) as f64
        };
        let (right, bottom) = (width - square, height - square);
        [(0, 0), (right, 0), (0, bottom), (right, bottom)].into_iter().all(|(x, y)| mean(x, y) < DARK)
    };
    prepared.pyramids().level(LOOK_SIDE).planes.iter().all(|plane| is_dark(plane))
}

/// Returns warnings about clicks whose pencils have few textured lines. Stand-ins for clicks get no
/// warning, since nobody can move them.
pub(in crate::estimate) fn little_texture(clicks: &Clicks, pencils: &[Arc<ComparedPencils>]) -> Vec<Warning> {
    let warning = |(number, compared): (Option<usize>, &Arc<ComparedPencils>)| {
        let mut images = compared.lines_compared().into_iter().zip(compared.lines_before);
        let (textured, lines) = images.find(|(textured, lines)| LITTLE_TEXTURE * textured < *lines)?;
        Some(Warning::LittleTexture { pair: number?, textured, lines })
    };
    clicks.anchor_numbers().into_iter().zip(pencils).filter_map(warning).collect()
}

/// Returns warnings about the positions of the clicks under the geometry `f`.
pub(in crate::estimate) fn click_warnings(
    f: &FundamentalMatrix,
    frames: [Frame; 2],
    clicks: &Clicks,
) -> Vec<Warning> {
    let anchors = clicks.anchors();
    let [p, q, ..] = anchors.as_slice() else { return Vec::new() };
    if !clicks.chosen().is_empty() {
        return Vec::new();
    }
    let mut warnings = Vec::new();
    let [apart1, apart2] = apart_across_lines(f, p, q);
    let relative1 = apart1 / frames[0].longer_side();
    let relative2 = apart2 / frames[1].longer_side();
    if relative1.min(relative2) < SAME_LINE {
        let distance = if relative1 < relative2 { apart1 } else { apart2 };
        warnings.push(Warning::SameEpipolarLine { distance });
    }
    let apart = [(p.point1 - q.point1).norm(), (p.point2 - q.point2).norm()];
    let is_close = |image: &usize| apart[*image] < CLOSE * frames[*image].longer_side();
    if let Some(distance) = (0..2).filter(is_close).map(|image| apart[image]).min_by(f64::total_cmp) {
        warnings.push(Warning::CloseClicks { distance });
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::rows;
    use nalgebra::Matrix3;

    fn check(pairs: &[[f64; 4]]) -> Result<(), EstimateError> {
        let pairs: Vec<_> = pairs.iter().map(|[a, b, c, d]| PointPair::new(*a, *b, *c, *d)).collect();
        let plan = SearchPlan::Patches { clicks: 2 };
        check_points([Frame::new(100, 80); 2], &Clicks::for_plan(&pairs, plan), plan)
    }

    #[test]
    fn each_bad_point_pair_is_named() {
        let good = [10.0, 10.0, 20.0, 10.0];
        let other = [60.0, 60.0, 50.0, 60.0];
        assert_eq!(check(&[good, other]), Ok(()));
        assert_eq!(check(&[good]), Err(EstimateError::TooFewPairs { found: 1, needed: 2 }));
        assert_eq!(check(&[good, [f64::NAN, 0.0, 0.0, 0.0]]), Err(EstimateError::NotFinite(2)));
        assert!(matches!(
            check(&[good, [60.0, 60.0, 50.0, 80.0]]),
            Err(EstimateError::Outside { pair: 2, image: 2, .. })
        ));
        assert!(matches!(
            check(&[good, [60.0, 60.0, 21.0, 10.0]]),
            Err(EstimateError::TooClose { image: 2, .. })
        ));
        // A repeated click is superfluous. The other two suffice.
        assert_eq!(check(&[good, good, other]), Ok(()));
        assert!(matches!(
            check(&[good, good, [11.0, 10.0, 21.0, 10.0]]),
            Err(EstimateError::TooClose { first: 1, second: 3, .. })
        ));
    }

    #[test]
    fn flat_and_identical_images_are_refused() {
        let frame = Frame::new(120, 90);
        let texture = GrayPlane::from_fn(frame, |x, y| ((x * x + 3 * y * x + y) % 251) as f32);
        let flat = GrayPlane::from_fn(frame, |_, _| 80.0);
        assert_eq!(check_images(&PreparedPair::new(&texture, &flat)), Err(EstimateError::Flat(2)));
        assert_eq!(check_images(&PreparedPair::new(&texture, &texture)), Err(EstimateError::NoParallax));
    }

    /// Returns the warnings about two clicks, in the presence of a third one that is no anchor.
    fn warned(f: &FundamentalMatrix, frames: [Frame; 2], p: [f64; 4], q: [f64; 4]) -> Vec<Warning> {
        let pair = |c: [f64; 4]| PointPair::new(c[0], c[1], c[2], c[3]);
        let clicks = [pair(p), pair(q), pair([1.0, 1.0, 1.0, 1.0])];
        click_warnings(f, frames, &Clicks::for_plan(&clicks, SearchPlan::Published { clicks: 3 }))
    }

    #[test]
    fn clicks_on_one_line_and_clicks_side_by_side_are_told() {
        let frames = [Frame::new(400, 300); 2];
        let p = [100.0, 100.0, 80.0, 100.0];
        let ask = |x: f64, y: f64| warned(&rows(0.0), frames, p, [x, y, x - 20.0, y]);
        assert_eq!(ask(300.0, 120.1), []);
        assert!(
            matches!(ask(300.0, 119.9)[..], [Warning::SameEpipolarLine { distance }] if (distance - 19.9).abs() < 1e-9)
        );
        assert!(
            matches!(ask(300.0, 80.1)[..], [Warning::SameEpipolarLine { distance }] if (distance - 19.9).abs() < 1e-9)
        );
        assert_eq!(ask(100.0, 132.1), []);
        assert!(
            matches!(ask(100.0, 131.9)[..], [Warning::CloseClicks { distance }] if (distance - 31.9).abs() < 1e-9)
        );
        assert_eq!(ask(110.0, 105.0).len(), 2);
        // Being close in one image suffices.
        let beside2 = warned(&rows(0.0), frames, p, [300.0, 125.0, 85.0, 125.0]);
        assert!(matches!(beside2[..], [Warning::CloseClicks { .. }]));
        assert_eq!(click_warnings(&rows(0.0), frames, &Clicks::default()), []);
    }

    #[test]
    fn distances_count_in_the_size_of_their_own_image() {
        // Image 2 shows the same at half the size: y1 = 2 y2.
        let half =
            FundamentalMatrix::from_rank_two(Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -2.0, 0.0, 1.0, 0.0));
        let frames = [Frame::new(400, 300), Frame::new(200, 150)];
        let ask = |x: f64, y: f64| {
            warned(&half.unwrap(), frames, [100.0, 100.0, 50.0, 50.0], [x, y, 0.5 * x, 0.5 * y])
        };
        assert_eq!(ask(300.0, 121.0), [], "10.5 px of 200 as 21 px of 400");
        assert!(matches!(ask(300.0, 119.0)[..], [Warning::SameEpipolarLine { .. }]));
        assert_eq!(ask(100.0, 133.0), [], "16.5 px of 200 as 33 px of 400");
        assert!(matches!(ask(100.0, 131.0)[..], [Warning::CloseClicks { .. }]));
    }
}
