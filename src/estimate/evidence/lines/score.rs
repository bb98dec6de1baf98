//! Full validation (paper, section 5.1, step 4): how well corresponding lines of a hypothesis
//! match, over the whole of both images.
//!
//! The score is the stereo cost per sample over many epipolar lines of both images, weighted by
//! length. The paper uses this cost ([`LineScore::Cost`]). It prefers geometries whose lines cross
//! little texture, so [`LineScore::AgainstMismatched`] divides by the cost of deliberately
//! mismatched lines of the same pencils.

use rayon::prelude::*;

use super::pencil_pair::PencilPair;
use crate::cancel::CancelFlag;
use crate::estimate::LineScore;
use crate::geometry::{AnchoredLine, Frame};
use crate::similarity::LineSimilarity;

/// Number of hypotheses whose lines are compared in one call. A stop is noticed between calls. No
/// result depends on it.
const AT_ONCE: usize = 64;

/// A line pair with its weight: the length of the line in the image over which it was spread, px.
struct Weighed {
    pair: (AnchoredLine, AnchoredLine),
    length: f64,
    mismatched: bool,
}

/// Returns the full-validation score of each geometry; lower is better. A score is infinite when
/// the lines cannot be compared. `lines` is the number of lines per image. When stopped, returns
/// fewer scores.
pub(in crate::estimate) fn line_scores(
    similarity: &dyn LineSimilarity,
    geometries: &[PencilPair],
    frames: [Frame; 2],
    lines: usize,
    kind: LineScore,
    cancel: &CancelFlag,
) -> Vec<f64> {
    let outside = similarity.outside_cost();
    let mut scores = Vec::with_capacity(geometries.len());
    for few in geometries.chunks(AT_ONCE).take_while(|_| !cancel.is_cancelled()) {
        let spread: Vec<Vec<Weighed>> =
            few.par_iter().map(|pencils| spread(pencils, frames, lines, kind)).collect();
        let pairs: Vec<_> = spread.iter().flatten().map(|weighed| weighed.pair).collect();
        let costs = similarity.pair_costs(&pairs);
        let mut costs = costs.iter();
        scores.extend(spread.iter().map(|own| {
            let [mut matched, mut mismatched] = [(0.0, 0.0); 2];
            for (weighed, cost) in own.iter().zip(&mut costs) {
                let (sum, weight) = if weighed.mismatched { &mut mismatched } else { &mut matched };
                // A line without a partner counts as outside the other image in every sample.
                *sum += weighed.length * f64::from(if cost.is_finite() { *cost } else { outside });
                *weight += weighed.length;
            }
            let mean = |(sum, weight): (f64, f64)| if weight > 0.0 { sum / weight } else { f64::INFINITY };
            match kind {
                LineScore::Cost => mean(matched),
                // Too few lines to mismatch any.
                LineScore::AgainstMismatched if mismatched.1 <= 0.0 => f64::INFINITY,
                LineScore::AgainstMismatched => mean(matched) / mean(mismatched).max(1e-6),
            }
        }));
    }
    scores
}

/// Returns the line pairs on which a geometry is scored.
fn spread(pencils: &PencilPair, frames: [Frame; 2], lines: usize, kind: LineScore) -> Vec<Weighed> {
    let mut all = Vec::new();
    let of_images =
        [pencils.spread_over_image1(frames[0], lines), pencils.spread_over_image2(frames[1], lines)];
    for (image, pairs) in of_images.iter().enumerate() {
        let weighed = |pair: (AnchoredLine, AnchoredLine), mismatched| {
            let line = if image == 0 { pair.0 } else { pair.1 };
            let length = frames[image].clip(&line.line()).map_or(0.0, |s| s.length());
            Weighed { pair, length, mismatched }
        };
        all.extend(pairs.iter().map(|pair| weighed(*pair, false)));
        // Mismatched by a third of the list: far enough to be unrelated, near enough to overlap.
        let shift = if kind == LineScore::AgainstMismatched { pairs.len() / 3 } else { 0 };
        all.extend((0..pairs.len()).filter(|_| shift > 0).map(|k| {
            let other = pairs[(k + shift) % pairs.len()];
            weighed(if image == 0 { (pairs[k].0, other.1) } else { (other.0, pairs[k].1) }, true)
        }));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::evidence::lines::PencilAngles;
    use crate::estimate::exact::{ExactScene, FRAME, LinesBy, OUTSIDE, exact_lines};

    const FRAMES: [Frame; 2] = [FRAME; 2];
    const LINES: usize = 24;

    /// Returns the true geometry, and others with directions turned or κ changed.
    fn geometries(scene: &ExactScene) -> Vec<PencilPair> {
        let PencilAngles { p, q, kappa } = scene.angles();
        let all = [
            PencilAngles { p, q, kappa },
            PencilAngles { p, q, kappa: 1.3 * kappa },
            PencilAngles { p, q, kappa: 0.7 * kappa },
            PencilAngles { p: [p[0], p[1] + 0.1], q, kappa },
            PencilAngles { p, q: [q[0] - 0.1, q[1]], kappa },
        ];
        all.iter().map(|angles| PencilPair::new(angles, scene.clicks()).unwrap()).collect()
    }

    fn scores(similarity: &dyn LineSimilarity, of: &[PencilPair], lines: usize, kind: LineScore) -> Vec<f64> {
        line_scores(similarity, of, FRAMES, lines, kind, &CancelFlag::default())
    }

    #[test]
    fn the_true_geometry_scores_best_either_way() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let similarity = exact_lines(scene.fundamental(), FRAMES);
            for kind in [LineScore::Cost, LineScore::AgainstMismatched] {
                let scores = scores(&similarity, &geometries(&scene), LINES, kind);
                // Costs are 32-bit areas of some ten thousand square pixels over the width.
                assert!(scores[0] < 1e-3, "{kind:?}: {scores:?}");
                assert!(scores[1..].iter().all(|score| *score > 0.02), "{kind:?}: {scores:?}");
            }
        }
    }

    #[test]
    fn lines_are_weighted_by_length_and_count_as_outside_without_a_partner() {
        let scene = ExactScene::aside();
        let pencils = &geometries(&scene)[0];
        // Lines left of the middle cost 3; the others have no partner.
        let is_left = |line: &AnchoredLine| line.anchor.x < FRAME.centre().x;
        let similarity = LinesBy(
            |line1: &AnchoredLine, _: &AnchoredLine| {
                if is_left(line1) { 3.0 } else { f32::INFINITY }
            },
        );
        let (mut sum, mut weight) = (0.0, 0.0);
        let mut add = |line1: &AnchoredLine, own: &AnchoredLine| {
            let length = FRAME.clip(&own.line()).unwrap().length();
            sum += length * if is_left(line1) { 3.0 } else { f64::from(OUTSIDE) };
            weight += length;
        };
        pencils.spread_over_image1(FRAME, LINES).iter().for_each(|(line1, _)| add(line1, line1));
        pencils.spread_over_image2(FRAME, LINES).iter().for_each(|(line1, line2)| add(line1, line2));
        let found = scores(&similarity, std::slice::from_ref(pencils), LINES, LineScore::Cost)[0];
        assert!(found > 4.0 && found < 49.0, "both kinds are among them: {found}");
        assert!((found - sum / weight).abs() < 1e-9, "{found} {}", sum / weight);
        let nowhere = LinesBy(|_: &AnchoredLine, _: &AnchoredLine| f32::INFINITY);
        for (kind, expected) in [(LineScore::Cost, f64::from(OUTSIDE)), (LineScore::AgainstMismatched, 1.0)] {
            let found = scores(&nowhere, std::slice::from_ref(pencils), LINES, kind)[0];
            assert!((found - expected).abs() < 1e-9, "{kind:?}: {found}");
        }
    }

    #[test]
    fn mismatched_lines_belong_to_the_same_pencils() {
        let scene = ExactScene::aside();
        let f = scene.fundamental();
        let all = spread(&geometries(&scene)[0], FRAMES, LINES, LineScore::AgainstMismatched);
        let similarity = exact_lines(f, FRAMES);
        let pairs: Vec<_> = all.iter().map(|weighed| weighed.pair).collect();
        let (mut matched, mut mismatched) = (0, 0);
        for (weighed, cost) in all.iter().zip(similarity.pair_costs(&pairs)) {
            // A third of the image away, or outside.
            let is_as_told = if weighed.mismatched { cost > 20.0 } else { cost < 1e-3 };
            assert!(is_as_told, "{cost} px, mismatched: {}", weighed.mismatched);
            *if weighed.mismatched { &mut mismatched } else { &mut matched } += 1;
            let epipole2 = f.epipole2();
            assert!(weighed.pair.1.line().coefficients().dot(&epipole2).abs() < 1e-9);
        }
        assert_eq!((matched, mismatched), (2 * LINES, 2 * LINES));
        assert!(spread(&geometries(&scene)[0], FRAMES, LINES, LineScore::Cost).iter().all(|w| !w.mismatched));
    }

    #[test]
    fn lines_that_cannot_be_compared_score_infinitely() {
        let scene = ExactScene::aside();
        let (all, similarity) = (geometries(&scene), exact_lines(scene.fundamental(), FRAMES));
        for kind in [LineScore::Cost, LineScore::AgainstMismatched] {
            assert_eq!(scores(&similarity, &[], LINES, kind), [0.0; 0]);
            let none = scores(&similarity, &all, 0, kind);
            assert!(none.iter().all(|score| score.is_infinite()), "{kind:?}: {none:?}");
        }
        // Two lines are too few to mismatch.
        let two = scores(&similarity, &all, 2, LineScore::AgainstMismatched);
        assert!(two.iter().all(|score| score.is_infinite()), "{two:?}");
        let flag = crate::cancel::CancelFlag::default();
        flag.cancel();
        let stopped = flag;
        assert_eq!(line_scores(&similarity, &all, FRAMES, LINES, LineScore::Cost, &stopped), [0.0; 0]);
    }

    #[test]
    fn geometries_are_scored_independently() {
        let scene = ExactScene::aside();
        let similarity = exact_lines(scene.fundamental(), FRAMES);
        let few = geometries(&scene);
        let many: Vec<PencilPair> = few.iter().cycle().take(AT_ONCE + 11).cloned().collect();
        let bits = |scores: Vec<f64>| scores.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        let own = bits(scores(&similarity, &few, LINES, LineScore::Cost));
        let all = bits(scores(&similarity, &many, LINES, LineScore::Cost));
        assert_eq!(all.len(), many.len());
        assert!(all.iter().enumerate().all(|(k, score)| *score == own[k % few.len()]));
    }
}
