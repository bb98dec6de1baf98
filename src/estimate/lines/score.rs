//! Full validation: how well corresponding lines of a hypothesis match, over the whole of both images (paper,
//! section 5.1, step 4).
//!
//! The score is the stereo cost per sample over many epipolar lines of both images, each line weighted by its
//! length. As published that is all ([`LineScore::Cost`]); the raw cost prefers geometries whose lines cross
//! little texture, so [`LineScore::AgainstMismatched`] divides it by the cost of deliberately mismatched lines
//! of the same pencils.

use rayon::prelude::*;

use super::pencil_pair::PencilPair;
use crate::estimate::{LineScore, Monitor};
use crate::geometry::{AnchoredLine, Frame};
use crate::similarity::LineSimilarity;

/// Hypotheses whose lines are compared at once: enough to fill the vector units, few enough to stop soon.
const AT_ONCE: usize = 64;

/// A line pair, the length of its line in the image that it was spread over, px, and whether it is mismatched.
struct Weighed {
    pair: (AnchoredLine, AnchoredLine),
    length: f64,
    mismatched: bool,
}

/// Full-validation score of each geometry, lower is better; infinite when its lines cannot be compared. `lines` are
/// compared an image. Fewer scores when stopped.
pub(super) fn line_scores(
    similarity: &dyn LineSimilarity,
    geometries: &[PencilPair],
    frames: [Frame; 2],
    lines: usize,
    kind: LineScore,
    monitor: &Monitor,
) -> Vec<f64> {
    let outside = similarity.outside_cost();
    let mut scores = Vec::with_capacity(geometries.len());
    for few in geometries.chunks(AT_ONCE).take_while(|_| !monitor.is_cancelled()) {
        let spread: Vec<Vec<Weighed>> =
            few.par_iter().map(|pencils| spread(pencils, frames, lines, kind)).collect();
        let pairs: Vec<_> = spread.iter().flatten().map(|weighed| weighed.pair).collect();
        let costs = similarity.pair_costs(&pairs);
        let mut costs = costs.iter();
        scores.extend(spread.iter().map(|own| {
            let [mut matched, mut mismatched] = [(0.0, 0.0); 2];
            for (weighed, cost) in own.iter().zip(&mut costs) {
                let (sum, weight) = if weighed.mismatched { &mut mismatched } else { &mut matched };
                // A line without a partner in the other image is outside it in every sample.
                *sum += weighed.length * f64::from(if cost.is_finite() { *cost } else { outside });
                *weight += weighed.length;
            }
            let mean = |(sum, weight): (f64, f64)| if weight > 0.0 { sum / weight } else { f64::INFINITY };
            match kind {
                LineScore::Cost => mean(matched),
                LineScore::AgainstMismatched => mean(matched) / mean(mismatched).max(1e-6),
            }
        }));
    }
    scores
}

/// The line pairs that a geometry is scored on.
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
        // A third of the way round the list: far enough to be unrelated, near enough to overlap.
        let shift = if kind == LineScore::AgainstMismatched { pairs.len() / 3 } else { 0 };
        all.extend((0..pairs.len()).filter(|_| shift > 0).map(|k| {
            let other = pairs[(k + shift) % pairs.len()];
            weighed(if image == 0 { (pairs[k].0, other.1) } else { (other.0, pairs[k].1) }, true)
        }));
    }
    all
}
