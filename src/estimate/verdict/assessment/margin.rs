//! Margin: the advantage of a geometry over the best clearly different one.

use std::f64::consts::SQRT_2;

use crate::estimate::verdict::constants::{CHANCE_DEVIATIONS, CLEAR_MARGIN, RIGHT};
use crate::estimate::{Apart, Estimate, Search};
use crate::geometry::{
    Frame, FundamentalMatrix, PointPair, epipolar_difference, symmetric_epipolar_distance,
};

/// Returns the distances of hypotheses from a geometry, and the limit of clearly different ones.
pub(super) fn all_apart(
    fundamental: &FundamentalMatrix,
    hypotheses: &[Estimate],
    matches: &[PointPair],
    frames: [Frame; 2],
) -> Apart {
    let distance = |other: &Estimate| apart(fundamental, other.fundamental(), matches, frames);
    Apart {
        distances: hypotheses.iter().map(distance).collect(),
        limit: limit(matches, frames),
        matches: matches.len(),
    }
}

/// Returns the advantage of the best hypothesis over a rival, relative to the better of the two.
/// `None` without a rival, or if a figure of either is missing.
pub(super) fn margin(hypotheses: &[Estimate], rival: Option<usize>, search: Search) -> Option<f64> {
    let (best, other) = (hypotheses.first()?, hypotheses.get(rival?)?);
    Some(match search {
        Search::Patches => relative(best.support_score()?, other.support_score()?),
        // Lower scores of lines are better.
        Search::Lines => relative(other.line_score()?, best.line_score()?),
    })
}

/// Returns the advantage of `own` over `rival`, relative to the larger of the two: −1 to 1.
pub(super) fn relative(own: f64, rival: f64) -> f64 {
    (own - rival) / own.max(rival).max(1e-9)
}

/// Returns the smallest clear advantage of a geometry whose matches have this weight and standard
/// deviation. The rival's weight is taken to have the same deviation.
pub(super) fn least_clear(weight: f64, weight_deviation: f64) -> f64 {
    let by_chance = CHANCE_DEVIATIONS * SQRT_2 * weight_deviation / weight.max(f64::MIN_POSITIVE);
    by_chance.max(CLEAR_MARGIN)
}

/// Returns whether another geometry is clearly different. With supporting matches, more than half
/// of them must contradict it, since geometries that agree at the scene do not compete. Without
/// matches, the epipolar lines of both are compared.
pub(super) fn differs(
    fundamental: &FundamentalMatrix,
    other: &FundamentalMatrix,
    matches: &[PointPair],
    frames: [Frame; 2],
) -> bool {
    apart(fundamental, other, matches, frames) > limit(matches, frames)
}

/// Returns the distance beyond which a geometry is clearly different, px. Lines of a right geometry are nearer. Matches
/// have smaller errors than lines.
fn limit(matches: &[PointPair], frames: [Frame; 2]) -> f64 {
    let far = RIGHT * frames[0].longer_side();
    if matches.is_empty() { far } else { 0.5 * far }
}

/// Returns the distance of another geometry, px: see [`Apart::distances`].
fn apart(
    fundamental: &FundamentalMatrix,
    other: &FundamentalMatrix,
    matches: &[PointPair],
    frames: [Frame; 2],
) -> f64 {
    if matches.is_empty() {
        return epipolar_difference(fundamental, other, frames, frames[0].longer_side());
    }
    let mut distances: Vec<f64> = matches.iter().map(|m| symmetric_epipolar_distance(other, m)).collect();
    let half = (distances.len() - 1) / 2;
    *distances.select_nth_unstable_by(half, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::evidence::lines::{Construction, LineFigures};
    use crate::estimate::exact::rows;
    use crate::estimate::{Assessment, PatchSupport};
    use nalgebra::Matrix3;

    /// Geometries 4 px apart are clearly different in these images, and matches 2 px off
    /// contradict.
    const FRAMES: [Frame; 2] = [Frame { width: 400, height: 300 }; 2];

    fn supported(f: FundamentalMatrix, score: f64) -> Estimate {
        let support = Some(PatchSupport { matches: 100, score });
        let assessment = Assessment { support, ..Assessment::default() };
        Estimate { assessment, ..Estimate::from(f) }
    }

    fn with_lines(f: FundamentalMatrix, score: Option<f64>) -> Estimate {
        let clicks = [PointPair::new(100.0, 50.0, 90.0, 50.0), PointPair::new(300.0, 250.0, 280.0, 250.0)];
        let construction = Construction::of(&f, clicks, 0.0).unwrap();
        let lines = Some(LineFigures { score, round_trip_area: None, construction });
        Estimate { assessment: Assessment { lines, ..Assessment::default() }, ..Estimate::from(f) }
    }

    fn of(hypotheses: &[Estimate], matches: &[PointPair], search: Search) -> Option<f64> {
        let apart = all_apart(&rows(0.0), hypotheses, matches, FRAMES);
        assert_eq!(apart.distances.len(), hypotheses.len());
        margin(hypotheses, apart.rival(), search)
    }

    fn close(a: Option<f64>, b: f64) -> bool {
        a.is_some_and(|a| (a - b).abs() < 1e-12)
    }

    #[test]
    fn few_matches_need_a_larger_advantage() {
        // The weight of n equal matches has the standard deviation √n.
        let of = |matches: f64| least_clear(matches, matches.sqrt());
        assert!((of(50.0) - 0.4).abs() < 1e-12 && (of(128.0) - 0.25).abs() < 1e-12);
        assert!([of(200.1), of(1e4)].iter().all(|least| (least - CLEAR_MARGIN).abs() < 1e-12));
        assert!(least_clear(0.0, 0.1) > 1.0, "nothing is clear where nothing weighs");
    }

    #[test]
    fn near_copies_are_no_rivals_and_the_first_clearly_different_geometry_is() {
        assert_eq!(of(&[], &[], Search::Patches), None);
        // Rows that leave the image count less, so the threshold is precise to some tenths of a
        // pixel.
        let near = [supported(rows(0.0), 100.0), supported(rows(3.5), 95.0)];
        assert_eq!(of(&near, &[], Search::Patches), None);
        let [best, copy] = near;
        let all = [best, copy, supported(rows(4.5), 80.0), supported(rows(60.0), 90.0)];
        assert!(close(of(&all, &[], Search::Patches), 0.2));
        // A rival may have more support.
        let better = [supported(rows(0.0), 100.0), supported(rows(60.0), 125.0)];
        assert!(close(of(&better, &[], Search::Patches), -0.2));
        assert!(close(of(&[supported(rows(60.0), 0.0)], &[], Search::Patches), 0.0), "no support at all");
    }

    #[test]
    fn an_advantage_is_at_most_the_whole_of_either() {
        for (own, rival, expected) in
            [(4.0, 1.0, 0.75), (1.0, 4.0, -0.75), (0.0, 12.0, -1.0), (12.0, 0.0, 1.0), (0.0, 0.0, 0.0)]
        {
            assert!((relative(own, rival) - expected).abs() < 1e-12, "{own} {rival}");
        }
        let beaten = of(&[supported(rows(0.0), 0.0), supported(rows(9.0), 12.0)], &[], Search::Patches);
        assert!(close(beaten, -1.0), "{beaten:?}");
    }

    #[test]
    fn a_rival_contradicts_more_than_half_of_the_matches() {
        // All lines are 5 % farther from the top edge. Matches near the edge agree, lower ones do
        // not.
        let m = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.05, 0.0);
        let zoomed = FundamentalMatrix::from_rank_two(m).unwrap();
        let at = |y: f64| PointPair::new(100.0, y, 120.0, y);
        let hypotheses = [supported(rows(0.0), 100.0), supported(zoomed, 70.0)];
        let half = [at(10.0), at(20.0), at(200.0), at(250.0)];
        assert_eq!(of(&hypotheses, &half, Search::Patches), None);
        assert!(close(of(&hypotheses, &half[1..], Search::Patches), 0.3));
        let apart = all_apart(&rows(0.0), &hypotheses, &half, FRAMES);
        assert_eq!((apart.matches, apart.limit), (4, 2.0));
        // Of four matches, the second nearest gives the distance.
        assert!(apart.distances[0] == 0.0 && (0.9..1.0).contains(&apart.distances[1]), "{apart:?}");
        let shifted = |shift| [supported(rows(0.0), 100.0), supported(rows(shift), 70.0)];
        assert_eq!(of(&shifted(1.99), &half, Search::Patches), None);
        assert!(close(of(&shifted(2.01), &half, Search::Patches), 0.3));
    }

    #[test]
    fn lines_compare_costs_relative_to_the_worse_one() {
        let hypotheses = [with_lines(rows(0.0), Some(0.5)), with_lines(rows(60.0), Some(0.8))];
        assert!(close(of(&hypotheses, &[], Search::Lines), 0.375));
        let [best, other] = hypotheses;
        assert!(close(of(&[other, best], &[], Search::Lines), 0.0), "the first one is the rival itself");
        let missing = [with_lines(rows(0.0), None), with_lines(rows(60.0), Some(0.8))];
        assert_eq!(of(&missing, &[], Search::Lines), None, "a missing figure is no advantage");
        let unmeasured = [Estimate::from(rows(0.0)), supported(rows(60.0), 90.0)];
        assert_eq!(of(&unmeasured, &[], Search::Patches), None, "and no disadvantage");
    }
}
