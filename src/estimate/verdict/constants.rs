//! All constants of the verdict, with their origins.
//!
//! Three kinds: **statistics** follow from a probability, the noise, or the number of unknowns. **Measured** ones were
//! set on results with known truth, and measured at half and at twice (`lab/notes.md`). **Conventions** say what counts
//! as good. The fits of `estimate/fit` have their own numbers of steps and widths, and `fit/false_alarms` the
//! significance of all tests: one false alarm in a thousand results.

// --- Statistics --------------------------------------------------------------------------------------------------

/// Error of a coordinate, in standard deviations, that is more than noise: 99.7 % of Gaussian errors are below it.
pub(super) const DEVIATIONS: f64 = 3.0;
/// Sampson distance of a click, in standard deviations, beyond which the click or the result is
/// wrong: one Gaussian error in 16,000. Motions that differ by less are alike.
pub const CLICK_DEVIATIONS: f64 = 4.0;
/// Difference between two weights, in standard deviations, that chance explains: 95 % of Gaussian
/// differences are below it.
pub(super) const CHANCE_DEVIATIONS: f64 = 2.0;
/// Standard deviations below a share that its true value exceeds in 95 % of the cases (one-sided).
pub(super) const BOUND_DEVIATIONS: f64 = 1.645;
/// Number of motions that any epipole fits: two lines always meet.
pub(in crate::estimate) const ANY_EPIPOLE: usize = 2;
/// Minimum number of clicks that can overrule the best-supported geometry. One click may be a mistake.
pub(super) const OVERRULING_CLICKS: usize = 2;

// --- Measured ----------------------------------------------------------------------------------------------------

/// Log-odds of right lines where the evidence is that of chance, and their growth with the evidence. Fitted to
/// results with known truth, on either half of the scenes (`lab/trust.py`).
pub(super) const LOG_ODDS: [f64; 2] = [-1.6, 0.9];
/// Distance within which matches share their errors, as a share of the longer side. With twice the radius, the
/// Brier score of the probability is 0.072 in place of 0.053.
pub(super) const SHARED_ERRORS: f64 = 0.028;
/// Fewest matches of a reliable geometry that the images did not propose.
pub const ENOUGH_MATCHES: usize = 60;
/// Number of matches below which such a geometry is unreliable.
pub const FAR_TOO_FEW: usize = 25;
/// Least margin over a clearly different geometry, for a geometry that the images did not propose.
pub const CLEAR_MARGIN: f64 = 0.2;
/// Largest standard deviation of epipolar lines of a reliable result, as a share of the longer side: 2 px in 1,000.
pub(super) const LOOSEST: f64 = 0.002;
/// Share of the matches on one plane beyond which only a handful of matches would determine the
/// epipoles. As many must be beside a smooth warp.
pub(super) const ONE_PLANE: f64 = 0.95;
/// Share of the matches on one plane beyond which the agreeing matches must have more than
/// [`ANY_EPIPOLE`] motions: if two motions divide a picture, one has nearly half. Corners are matched
/// near their place on such a plane.
pub(in crate::estimate) const HALF_PLANE: f64 = 0.4;
/// Least share along the lines among the matches along and across, at the lower end of its interval:
/// three quarters. By chance, half are along and half across. The same share of the scene points of known cameras has
/// to be in front of them; by chance, half are.
pub(super) const MOSTLY_ALONG: f64 = 0.75;
/// Largest parallax of a match beside a plane or a smooth warp, as a share of the longer side. Wrong matches lie
/// anywhere, most of them farther off.
pub(super) const LARGEST_PARALLAX: f64 = 0.05;
/// Least probability of a match that is clearly likelier than all similar places together: by a half. On
/// wallpaper nearly all matches are equalled elsewhere. With 0.7 three of 50 wide pairs would be doubtful.
pub(super) const CLEARLY_LIKELY: f32 = 0.6;
/// Share of distinctive matches that a right geometry may leave off its lines: twice the 7 % that 161 right results of either
/// half of the scenes leave. With twice the share, as with this one, no right result is doubted, with half of it ten are.
pub(super) const OFF_RIGHT_LINES: f64 = 0.125;
/// Expected fraction of distinctive matches that agree on a wrong motion (repeated structure).
pub(super) const WRONG_TOGETHER: f64 = 0.005;
/// Standard deviation of a coordinate of a match between corners, px of the level. Corners are precise to a pixel.
pub(super) const CORNER_SIGMA: f64 = 0.7;
/// Largest distance between matches of one group, as a share of the longer side. Moving objects are
/// smaller, and a larger surface counts as several groups.
pub(super) const ONE_GROUP: f64 = 0.1;
/// Difference between motions, as a share of their length, below which they are one motion. If
/// moving objects tilt the homography, one motion varies across the image.
pub(super) const ONE_MOTION: f64 = 0.1;
/// Least share of the corners that match if one image is flipped. Mirror images have 20 to 43 %, a
/// facade seen from its left and from its right 3 %.
pub(super) const MIRRORED: f64 = 0.1;
/// Size of a pattern of residuals that the lens of a good camera leaves, px in images of up to [`USUAL_SIDE`] px.
pub(super) const PATTERN_SIZE: f64 = 0.3;
/// Longer side of an image, px, up to which positions are found equally precisely: right matches are within a pixel. In
/// larger images errors grow in proportion.
pub(in crate::estimate) const USUAL_SIDE: f64 = 800.0;

// --- Conventions -------------------------------------------------------------------------------------------------

/// Least probability of a result whose lines are not doubted.
pub const SURE_LINES: f64 = 0.8;
/// An even chance: the share of the majority, and the least probability of a result that is not unreliable, since it is
/// rather right than wrong.
pub const EVEN: f64 = 0.5;
/// Sampson distance of a click, in standard deviations, beyond which it makes a result unreliable,
/// unless all other tests support the result. Only a mistaken click is that far off.
pub const CLICK_DEVIATIONS_WRONG: f64 = 12.0;
/// Distance of right lines from the scene points, as a share of the longer side. Lines farther from each other are
/// clearly different. Of matches, which have smaller errors, half as much.
pub(super) const RIGHT: f64 = 0.01;
/// Largest ratio of the parts across and along a line of a displacement along the line: an angle of 18°.
pub(super) const ALONG: f64 = 1.0 / 3.0;

/// Returns the largest error of a right match in an image with this longer side, px.
pub(super) fn largest_error(side: f64) -> f64 {
    (side / USUAL_SIDE).max(1.0)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    fn sources(folder: &Path) -> Vec<PathBuf> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let below = |path: PathBuf| if path.is_dir() { sources(&path) } else { vec![path] };
        entries.flat_map(below).collect()
    }

    #[test]
    fn the_verdict_has_at_most_thirty_constants_and_all_are_in_this_table() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/estimate/verdict");
        let mut of_the_table = 0;
        for path in sources(&folder) {
            let code = fs::read_to_string(&path).unwrap();
            let code = code.split("#[cfg(test)]").next().unwrap_or_default();
            let is_test = path.ends_with("judge/examples.rs") || path.ends_with("trust/table.rs");
            let is_constant = |line: &&str| {
                let line = line.trim_start();
                let words: Vec<&str> = line.split_whitespace().take(3).collect();
                words.first() == Some(&"const") || line.starts_with("pub") && words.contains(&"const")
            };
            let count = code.lines().filter(is_constant).filter(|line| !line.contains(" fn ")).count();
            if path.ends_with("verdict/constants.rs") {
                of_the_table = count;
            } else if !is_test {
                assert_eq!(count, 0, "constants in {}", path.display());
            }
        }
        assert!((1..=30).contains(&of_the_table), "{of_the_table} constants");
    }
}
