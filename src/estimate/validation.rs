//! Full validation: how well corresponding lines of a hypothesis match, over the whole of both images (paper,
//! section 5.1, step 4).
//!
//! The score is the stereo cost per sample over many epipolar lines of both images, each line weighted by its
//! length. As published that is all ([`LineScore::Cost`]); the raw cost prefers geometries whose lines cross
//! little texture, so [`LineScore::AgainstMismatched`] divides it by the cost of deliberately mismatched lines
//! of the same pencils.

use super::bundle::Bundle;
use super::parameters::LineScore;
use crate::geometry::{AnchoredLine, Frame};
use crate::similarity::LineSimilarity;

/// Full-validation score of a geometry, lower is better; infinite when its lines cannot be compared.
pub(crate) fn line_score(
    similarity: &dyn LineSimilarity,
    bundle: &Bundle,
    frames: [Frame; 2],
    lines: usize,
    kind: LineScore,
) -> f64 {
    let mut cost = Weighted::default();
    let mut mismatched = Weighted::default();
    let outside = similarity.outside_cost();
    let spread = [bundle.spread_over_image1(frames[0], lines), bundle.spread_over_image2(frames[1], lines)];
    for (image, pairs) in spread.iter().enumerate() {
        let weight = |pair: &(AnchoredLine, AnchoredLine)| {
            let line = if image == 0 { pair.0 } else { pair.1 };
            frames[image].clip(&line.line()).map_or(0.0, |s| s.length())
        };
        cost.add(similarity, pairs, weight, outside);
        if kind == LineScore::AgainstMismatched {
            // A third of the way round the list: far enough to be unrelated, near enough to overlap.
            let shift = pairs.len() / 3;
            let wrong: Vec<_> = (0..pairs.len())
                .filter(|_| shift > 0)
                .map(|k| {
                    let other = pairs[(k + shift) % pairs.len()];
                    if image == 0 { (pairs[k].0, other.1) } else { (other.0, pairs[k].1) }
                })
                .collect();
            mismatched.add(similarity, &wrong, weight, outside);
        }
    }
    match kind {
        LineScore::Cost => cost.mean(),
        LineScore::AgainstMismatched => cost.mean() / mismatched.mean().max(1e-6),
    }
}

#[derive(Default)]
struct Weighted {
    sum: f64,
    weight: f64,
}

impl Weighted {
    fn add(
        &mut self,
        similarity: &dyn LineSimilarity,
        pairs: &[(AnchoredLine, AnchoredLine)],
        weight: impl Fn(&(AnchoredLine, AnchoredLine)) -> f64,
        outside: f32,
    ) {
        for (pair, cost) in pairs.iter().zip(similarity.pair_costs(pairs)) {
            let w = weight(pair);
            // A line without a partner in the other image is outside it in every sample.
            self.sum += w * f64::from(if cost.is_finite() { cost } else { outside });
            self.weight += w;
        }
    }

    fn mean(&self) -> f64 {
        if self.weight > 0.0 { self.sum / self.weight } else { f64::INFINITY }
    }
}
