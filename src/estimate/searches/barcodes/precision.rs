//! Uncertainty of the epipolar lines by barcodes, from a jackknife over time.

use super::refinement::{NEARBY, Objective, refine};
use crate::cancel::CancelFlag;
use crate::estimate::EstimateError;
use crate::geometry::{FundamentalMatrix, Point, median, rescaled};
use crate::motion::{FEWEST_FRAMES, Silhouettes};

/// Groups of frames left out in turn (jackknife). More take more time; fewer leave the deviation
/// uncertain: with five, by about a third.
const GROUPS: usize = 5;
/// Number of runs of frames in a group. Motion in successive frames is similar, so whole runs are
/// left out; several runs spread a group over the sequence.
const RUNS: usize = 3;
/// Largest number of places in image 1 at which lines are measured. It bounds the time.
const PLACES: usize = 200;
/// Number of frames in which these places are searched, evenly spread. Motion in successive frames
/// is at nearly the same places.
const LOOKED_AT: usize = 20;
/// Number of places taken from one frame.
const PLACES_A_FRAME: usize = PLACES / LOOKED_AT;

/// Returns the median standard deviation of the epipolar lines in image 2, at places with motion in
/// image 1, px. `None` if too few frames remain when a group is left out.
pub(super) fn deviation(
    objective: &Objective,
    f: &FundamentalMatrix,
    seed: u64,
    cancel: &CancelFlag,
) -> Result<Option<f64>, EstimateError> {
    let count = objective.silhouettes[0].len();
    if count * (GROUPS - 1) / GROUPS < FEWEST_FRAMES {
        return Ok(None);
    }
    let mut left: Vec<FundamentalMatrix> = Vec::with_capacity(GROUPS);
    for group in 0..GROUPS {
        let times: Vec<usize> = (0..count).filter(|t| t * GROUPS * RUNS / count % GROUPS != group).collect();
        let [first, second] = objective.silhouettes.map(|silhouettes| silhouettes.at_times(&times));
        let fewer = Objective { silhouettes: [&first, &second], ..*objective };
        let Some(refined) = refine(&fewer, f, NEARBY, seed, group as u64 + 1, cancel)? else {
            return Ok(None);
        };
        left.push(refined.fundamental);
    }
    let places = moving_places(objective.silhouettes).into_iter();
    let deviations: Vec<f64> = places.filter_map(|at| line_deviation(&left, f, at)).collect();
    Ok((!deviations.is_empty()).then(|| median(deviations)))
}

/// Returns the jackknife deviation of the epipolar line of one place. It is measured across the
/// line, at its point nearest to the middle of the motion in image 2.
fn line_deviation(
    left: &[FundamentalMatrix],
    f: &FundamentalMatrix,
    (at, seen): (Point, Point),
) -> Option<f64> {
    let line = f.line2_from_point1(at)?;
    let (foot, normal) = (line.foot(seen), line.coefficients().xy());
    // Lines have no orientation, so the normals give comparable signs to the distances.
    let signed = |g: &FundamentalMatrix| {
        let own = g.line2_from_point1(at)?;
        let distance = own.signed_distance(foot);
        Some(if own.coefficients().xy().dot(&normal) < 0.0 { -distance } else { distance })
    };
    let signed: Vec<f64> = left.iter().map(signed).collect::<Option<_>>()?;
    let n = signed.len() as f64;
    let mean = signed.iter().sum::<f64>() / n;
    Some(((n - 1.0) / n * signed.iter().map(|d| (d - mean).powi(2)).sum::<f64>()).sqrt())
}

/// Returns places with motion in image 1, each with the middle of the motion in image 2, full-size
/// pixels.
fn moving_places(silhouettes: [&Silhouettes; 2]) -> Vec<(Point, Point)> {
    let every = (silhouettes[0].len() / LOOKED_AT).max(1);
    let places = |image: usize, time: usize| {
        let (size, full) = (silhouettes[image].size(), silhouettes[image].full_size());
        let scale = full.width as f64 / size.width as f64;
        let mask = silhouettes[image].mask(time);
        let moving = (0..mask.len()).filter(|k| mask[*k]);
        let place =
            move |k: usize| rescaled(Point::new((k % size.width) as f64, (k / size.width) as f64), scale);
        moving.map(place).collect::<Vec<_>>()
    };
    let mut all = Vec::new();
    for time in (0..silhouettes[0].len()).step_by(every) {
        let (first, second) = (places(0, time), places(1, time));
        if second.is_empty() {
            continue;
        }
        let middle =
            second.iter().fold(nalgebra::Vector2::zeros(), |s, p| s + p.coords) / second.len() as f64;
        let step = (first.len() / PLACES_A_FRAME).max(1);
        all.extend(first.into_iter().step_by(step).map(|at| (at, Point::from(middle))));
    }
    let step = all.len().div_ceil(PLACES).max(1);
    all.into_iter().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::super::exact::{bands, by_itself};
    use super::*;
    use crate::estimate::exact::rows;
    use crate::geometry::Frame;

    #[test]
    fn the_deviation_of_a_line_is_the_jackknife_of_its_places() {
        let at = (Point::new(5.0, 7.0), Point::new(9.0, 8.0));
        let of = |shifts: &[f64]| {
            let left: Vec<_> = shifts.iter().map(|shift| rows(*shift)).collect();
            line_deviation(&left, &rows(0.0), at).unwrap()
        };
        // √((n − 1)/n Σ (d − d̄)²)
        assert!((of(&[-1.0, 1.0]) - 1.0).abs() < 1e-9);
        assert!(
            (of(&[3.0, 5.0, 7.0, 9.0]) - (0.75f64 * 20.0).sqrt()).abs() < 1e-9,
            "their mean is taken off"
        );
        // A reversed line is the same line.
        let turned = FundamentalMatrix::from_rank_two(-rows(2.0).matrix()).unwrap();
        assert!(line_deviation(&[rows(2.0), turned], &rows(0.0), at).unwrap() < 1e-9);
    }

    #[test]
    fn places_have_motion_and_the_middle_of_the_motion_in_the_other_image() {
        let small = Frame::new(8, 6);
        // A block of nine pixels in one frame. Its corners are removed as specks.
        let block = |x: usize, y: usize, when: usize| {
            let mask = |time: usize| -> Vec<bool> {
                let is_in = |k: usize| (k % 8).abs_diff(x) < 2 && (k / 8).abs_diff(y) < 2;
                (0..48).map(|k| time == when && is_in(k)).collect()
            };
            Silhouettes::from_masks("block", small, Frame::new(16, 12), (0..20).map(mask).collect()).unwrap()
        };
        let places = moving_places([&block(3, 2, 4), &block(5, 3, 4)]);
        assert_eq!(places.len(), 5, "{places:?}");
        assert!(places.iter().any(|(at, _)| *at == Point::new(6.5, 4.5)), "pixel centres, twice as large");
        assert!(places.iter().all(|(_, seen)| (seen - Point::new(10.5, 6.5)).norm() < 1e-9));
        assert!(moving_places([&block(3, 2, 4), &block(5, 3, 9)]).is_empty(), "nothing moves in the other");
    }

    #[test]
    fn too_few_frames_give_no_deviation_and_independent_rows_a_small_one() {
        let measured = |frames: usize| {
            let seen = bands(frames, by_itself);
            let objective =
                Objective { silhouettes: [&seen, &seen], clicks: &[], click_sigma: 1.0, events: 50.0 };
            deviation(&objective, &rows(0.0), 1, &CancelFlag::default()).unwrap()
        };
        assert_eq!(measured(FEWEST_FRAMES), None);
        let held = measured(200).unwrap();
        assert!(held < 0.5, "{held} px");
    }
}
