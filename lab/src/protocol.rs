//! Selection of the true matches that are clicked in a trial.
//!
//! All valid combinations of two matches are listed and shuffled, seeded by the run and the name of
//! the pair. Trial `t` takes combination `t`. Trials are therefore distinct and independent of the
//! number requested. Further clicks (a third pair and so on) and the click noise have separate
//! generators per trial, so contenders with more clicks share the first ones with the others.

use std::f64::consts::TAU;

use epiline::geometry::{Frame, FundamentalMatrix, Point, PointPair};
use epiline::internals::comparison::{KnownPair, Purpose, SPACING, apart, generator};
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

/// Minimum distance of well-posed clicks from each other's epipolar line, as a fraction of the
/// longer side.
const OFF_LINE: f64 = 0.12;

/// Rule for choosing clicks among the true matches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// Matches at least 30 px apart in both images.
    Paper,
    /// Matches as in `Paper`, each also at least 12 % of the longer side from the other's true
    /// epipolar line in both images. Closer matches leave the epipoles nearly undetermined.
    WellPosed,
    /// Well-posed clicks with a wrong second pair: its point in image 2 belongs to another match.
    /// No geometry fits such clicks, so this protocol tests the verdicts.
    WrongClick,
}

impl Protocol {
    /// Returns the name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::WellPosed => "well-posed",
            Self::WrongClick => "wrong-click",
        }
    }

    /// Returns whether two true matches may be clicked together.
    pub fn allows(self, known: &KnownPair, p: &PointPair, q: &PointPair) -> bool {
        apart(p, q) && (self == Self::Paper || off_lines(known, p, q))
    }
}

/// Plan of the trials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Plan {
    /// Rule for choosing clicks.
    pub protocol: Protocol,
    /// Number of trials per pair.
    pub trials: usize,
    /// Standard deviation of the click noise in each coordinate, px.
    pub noise: f64,
    /// Seed of the draws.
    pub seed: u64,
    /// Number of trials that run at the same time.
    pub trials_at_once: usize,
    /// Number of threads per trial. Separate pools keep the times of trials independent.
    pub threads_per_trial: usize,
}

/// Returns whether each point is far enough from the other's true epipolar line, in both images.
fn off_lines(known: &KnownPair, p: &PointPair, q: &PointPair) -> bool {
    let limits = known.frames.map(|frame| OFF_LINE * frame.longer_side());
    let far = |distance: Option<f64>, limit: f64| distance.is_some_and(|d| d >= limit);
    distances_off_lines(known.truth, p, q).chunks(2).all(|d| far(d[0], limits[0]) && far(d[1], limits[1]))
}

/// Returns the distances of `q` from the true epipolar lines of `p` in image 1 and image 2, then of
/// `p` from the lines of `q`, px. `None` for a point at the epipole, which has no line.
fn distances_off_lines(truth: &FundamentalMatrix, p: &PointPair, q: &PointPair) -> [Option<f64>; 4] {
    let line1 =
        |of: &PointPair, to: &PointPair| Some(truth.line1_from_point2(of.point2)?.distance(to.point1));
    let line2 =
        |of: &PointPair, to: &PointPair| Some(truth.line2_from_point1(of.point1)?.distance(to.point2));
    [line1(p, q), line2(p, q), line1(q, p), line2(q, p)]
}

/// Clicks of all trials on one image pair.
#[derive(Debug)]
pub struct Draws<'a> {
    known: KnownPair<'a>,
    protocol: Protocol,
    seed: u64,
    /// Standard deviation of the click noise, px.
    noise: f64,
    /// Indices of the first two matches of each trial.
    firsts: Vec<[usize; 2]>,
}

impl<'a> Draws<'a> {
    /// Selects the matches of up to `trials` trials, or of all combinations if there are fewer.
    /// Time and memory are quadratic in the number of matches.
    pub fn new(known: KnownPair<'a>, protocol: Protocol, trials: usize, noise: f64, seed: u64) -> Self {
        let matches = known.matches;
        let visible: Vec<_> = (0..matches.len()).filter(|k| matches[*k].is_inside(known.frames)).collect();
        let mut firsts: Vec<[usize; 2]> = visible
            .iter()
            .enumerate()
            .flat_map(|(n, i)| visible[n + 1..].iter().map(move |j| [*i, *j]))
            .filter(|[i, j]| protocol.allows(&known, &matches[*i], &matches[*j]))
            .collect();
        let mut random = generator(seed, known.name, Purpose::Combinations, 0);
        let count = trials.min(firsts.len());
        for k in 0..count {
            let other = random.random_range(k..firsts.len());
            firsts.swap(k, other);
        }
        firsts.truncate(count);
        Self { known, protocol, seed, noise, firsts }
    }

    /// Returns the number of trials.
    pub fn trials(&self) -> usize {
        self.firsts.len()
    }

    /// Returns the indices of the first `count` matches clicked in a trial. `None` if no further
    /// match is far enough from the others.
    pub fn matches(&self, trial: usize, count: usize) -> Option<Vec<usize>> {
        let mut chosen = self.firsts.get(trial)?.to_vec();
        chosen.truncate(count);
        let first: Vec<PointPair> = chosen.iter().map(|k| self.known.matches[*k]).collect();
        chosen.extend(self.known.further(&first, count, self.seed, trial)?);
        Some(chosen)
    }

    /// Returns the clicks on the given matches, with noise, clamped to the images, and with the
    /// mistake of the protocol.
    pub fn clicks(&self, trial: usize, matches: &[usize]) -> Vec<PointPair> {
        let mut random = generator(self.seed, self.known.name, Purpose::Noise, trial);
        let [frame1, frame2] = self.known.frames;
        let mut meant: Vec<PointPair> = matches.iter().map(|k| self.known.matches[*k]).collect();
        if let (Protocol::WrongClick, Some(second)) = (self.protocol, meant.get_mut(1)) {
            second.point2 = self.mistake(trial, second.point2);
        }
        meant
            .into_iter()
            .map(|exact| {
                if self.noise <= 0.0 {
                    return exact;
                }
                PointPair {
                    point1: disturbed(exact.point1, self.noise, frame1, &mut random),
                    point2: disturbed(exact.point2, self.noise, frame2, &mut random),
                }
            })
            .collect()
    }

    /// Returns a point of another match in image 2, away from the right one.
    fn mistake(&self, trial: usize, right: Point) -> Point {
        let mut random = generator(self.seed, self.known.name, Purpose::Mistake, trial);
        let others: Vec<Point> = self
            .known
            .matches
            .iter()
            .filter(|m| m.is_inside(self.known.frames) && (m.point2 - right).norm() >= SPACING)
            .map(|m| m.point2)
            .collect();
        // Never empty: the other clicked match qualifies.
        others[random.random_range(0..others.len())]
    }
}

/// Adds Gaussian noise to both coordinates (Box and Muller) and clamps to pixel centres.
fn disturbed(point: Point, sigma: f64, frame: Frame, random: &mut impl Rng) -> Point {
    // 1 − u is never 0, so the logarithm is finite.
    let radius = sigma * (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    let angle = TAU * random.random::<f64>();
    Point::new(
        (point.x + radius * angle.cos()).clamp(0.0, frame.right().max(0.0)),
        (point.y + radius * angle.sin()).clamp(0.0, frame.bottom().max(0.0)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::KnownScene;
    use crate::scene::tests::example_scene;

    const BOTH: [Protocol; 2] = [Protocol::Paper, Protocol::WellPosed];

    #[test]
    fn spacing_rules_hold_for_all_clicks() {
        let scene = example_scene("scene", 60);
        for protocol in BOTH {
            let draws = Draws::new(scene.known(), protocol, 200, 0.0, 7);
            assert!(draws.trials() >= 50, "{}", draws.trials());
            for trial in 0..draws.trials() {
                let clicks = draws.clicks(trial, &draws.matches(trial, 3).unwrap());
                for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                    assert!((clicks[a].point1 - clicks[b].point1).norm() >= 30.0);
                    assert!((clicks[a].point2 - clicks[b].point2).norm() >= 30.0);
                }
                if protocol == Protocol::WellPosed {
                    for (a, b) in [(0, 1), (1, 0)] {
                        let line2 = scene.truth.line2_from_point1(clicks[a].point1).unwrap();
                        let line1 = scene.truth.line1_from_point2(clicks[a].point2).unwrap();
                        assert!(line2.distance(clicks[b].point2) >= 0.12 * 768.0);
                        assert!(line1.distance(clicks[b].point1) >= 0.12 * 768.0);
                    }
                }
            }
        }
    }

    #[test]
    fn trials_do_not_depend_on_their_number_or_on_further_clicks() {
        let scene = example_scene("scene", 40);
        for noise in [0.0, 1.5] {
            let few = Draws::new(scene.known(), Protocol::Paper, 5, noise, 3);
            let many = Draws::new(scene.known(), Protocol::Paper, 50, noise, 3);
            for trial in (0..5).rev() {
                let two = few.matches(trial, 2).unwrap();
                let three = many.matches(trial, 3).unwrap();
                assert_eq!(two, three[..2]);
                assert_eq!(few.clicks(trial, &two), many.clicks(trial, &three)[..2]);
            }
        }
    }

    #[test]
    fn trials_are_all_different_and_follow_seed_and_name() {
        let scene = example_scene("scene", 40);
        let draw =
            |scene: &KnownScene, seed| Draws::new(scene.known(), Protocol::Paper, 30, 0.0, seed).firsts;
        let first = draw(&scene, 1);
        let mut distinct = first.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), 30);
        assert_eq!(first, draw(&scene, 1));
        assert_ne!(first, draw(&scene, 2));
        assert_ne!(first, draw(&example_scene("another", 40), 1));
    }

    #[test]
    fn no_more_trials_than_combinations_and_no_third_where_there_is_none() {
        let mut scene = example_scene("scene", 60);
        scene.matches.truncate(2);
        let draws = Draws::new(scene.known(), Protocol::Paper, 10, 0.0, 0);
        assert_eq!(draws.trials(), 1);
        assert_eq!(draws.matches(0, 3), None);
        assert_eq!(draws.matches(1, 2), None);
        scene.matches.truncate(1);
        assert_eq!(Draws::new(scene.known(), Protocol::Paper, 10, 0.0, 0).trials(), 0);
    }

    #[test]
    fn a_wrong_click_is_on_another_match_and_nothing_else_changes() {
        let scene = example_scene("scene", 60);
        let right = Draws::new(scene.known(), Protocol::WellPosed, 40, 0.0, 5);
        let wrong = Draws::new(scene.known(), Protocol::WrongClick, 40, 0.0, 5);
        assert!(right.trials() >= 20 && right.trials() == wrong.trials());
        for trial in 0..right.trials() {
            let matches = right.matches(trial, 3).unwrap();
            let (meant, clicked) = (right.clicks(trial, &matches), wrong.clicks(trial, &matches));
            assert_eq!([meant[0], meant[2]], [clicked[0], clicked[2]]);
            assert_eq!(meant[1].point1, clicked[1].point1);
            assert!((meant[1].point2 - clicked[1].point2).norm() >= SPACING);
            assert!(scene.matches.iter().any(|m| m.point2 == clicked[1].point2));
        }
    }

    #[test]
    fn noise_has_the_asked_size_and_stays_inside() {
        let scene = example_scene("scene", 60);
        let draws = Draws::new(scene.known(), Protocol::Paper, 400, 2.0, 11);
        let mut squares = Vec::new();
        for trial in 0..draws.trials() {
            let matches = draws.matches(trial, 2).unwrap();
            for (k, click) in matches.iter().zip(draws.clicks(trial, &matches)) {
                assert!(click.is_inside(scene.known().frames));
                let exact = scene.matches[*k];
                squares.push((click.point1 - exact.point1).norm_squared() / 2.0);
                squares.push((click.point2 - exact.point2).norm_squared() / 2.0);
            }
        }
        let sigma = crate::mean(&squares).sqrt();
        // 3,200 numbers determine σ to about 1.3 %. Clamping at the border lowers it slightly.
        assert!((sigma - 2.0).abs() < 0.15, "{sigma}");

        let wild = Draws::new(scene.known(), Protocol::Paper, 50, 5000.0, 11);
        for trial in 0..wild.trials() {
            assert!(
                wild.clicks(trial, &wild.matches(trial, 2).unwrap())
                    .iter()
                    .all(|c| c.is_inside(scene.known().frames))
            );
        }
    }
}
