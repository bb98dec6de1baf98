//! Suggested matches on real pairs.

use epiline::estimate::PreparedPair;
use epiline::geometry::{Point, PointPair};
use epiline::suggest::{ClickedImage, Known, SuggestParameters, suggest};
use epiline_lab::{KnownScene, pair_scenes, vgg_scenes};

use crate::skipping::shared;

const BOTH: [ClickedImage; 2] = [ClickedImage::First, ClickedImage::Second];

/// Returns the clicked point and the true match.
fn click(m: &PointPair, clicked: ClickedImage) -> (Point, Point) {
    match clicked {
        ClickedImage::First => (m.point1, m.point2),
        ClickedImage::Second => (m.point2, m.point1),
    }
}

/// Returns counts over the true matches of real pairs: clicks, clear ones, clear and correct ones.
fn tally(scenes: &[KnownScene], every: usize, with_f: bool) -> (usize, usize, usize) {
    let (mut clicks, mut clear, mut right) = (0, 0, 0);
    for scene in scenes {
        let prepared = PreparedPair::new(&scene.images[0], &scene.images[1]);
        for m in scene.matches.iter().step_by(every) {
            for clicked in BOTH {
                let (point, truth) = click(m, clicked);
                let known = Known { fundamental: with_f.then_some(scene.truth), ..Known::default() };
                clicks += 1;
                let found = suggest(&prepared, point, clicked, &known, &SuggestParameters::default());
                let Ok(found) = found else { continue };
                if let Some(best) = found.clear() {
                    clear += 1;
                    let near = 0.01 * scene.longer_side();
                    right += usize::from((best.position - truth).norm() <= near);
                }
            }
        }
    }
    (clicks, clear, right)
}

#[test]
fn clear_suggestions_on_real_pairs_are_right() {
    let (Some(house), Some(pairs)) = (shared("data/house"), shared("data/pairs")) else { return };
    let house = vgg_scenes(&house, 1, &[]).unwrap();
    let upright = ["Dresden", "castle", "corr", "dino2", "head", "kampa"].map(str::to_owned);
    let pairs = pair_scenes(&pairs, &upright).unwrap();
    // All clicks give 80 % clear (92 % with F) on the house and 56 % (66 %) on the upright pairs. A
    // sample of this size may lie 8 % lower.
    for (scenes, every, with_f, least_clear) in [
        (&house, 60, false, 0.72),
        (&house, 60, true, 0.84),
        (&pairs, 2, false, 0.45),
        (&pairs, 2, true, 0.55),
    ] {
        let (clicks, clear, right) = tally(scenes, every, with_f);
        println!("{clicks} clicks, F {with_f}: {clear} clear, {right} of them right");
        assert!(clear as f64 >= least_clear * clicks as f64, "{clear} of {clicks}");
        // At least 98 % are correct in measurements; a clear suggestion promises 95 %.
        assert!(right as f64 >= 0.95 * clear as f64, "{right} of {clear}");
    }
}
