//! What the names of arrays of matches say.
//!
//! A name such as `mkpts0_f` consists of words: a kind of points (`kpts`, `keypoints`, `points`, `pts`), before it
//! perhaps `m`, `matched` or `inlier`, an image (0 and 1, 1 and 2, `left` and `right`), and `orig` or `f`.

use super::matrix_name::name_parts;

/// What the name of an array of points says about them, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Matched points in the pictures as they are.
    MatchedOriginal,
    Matched,
    /// Matches that a robust fit of the matcher kept.
    InlierOriginal,
    Inlier,
    KeypointsOriginal,
    Keypoints,
    /// All keypoints: matches only with indices.
    All,
    /// Places on a coarse grid.
    Coarse,
    /// Coordinates from −1 to 1, or in a resized picture.
    Scaled,
}

/// Points of one image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PointsName {
    pub kind: Kind,
    /// Side as written: 0 and 1, or 1 and 2.
    pub side: usize,
}

/// Words for points. `m` before them means matched.
const POINTS: [&str; 10] =
    ["kpts", "kpt", "kps", "kp", "keypoints", "keypoint", "points", "point", "pts", "pt"];

impl PointsName {
    pub fn of(name: &str) -> Option<Self> {
        let (mut is_points, mut side, mut kind, mut is_original) = (false, None, None, false);
        for part in name_parts(name) {
            let lower = part.to_lowercase();
            let word = lower.trim_end_matches(|c: char| c.is_ascii_digit());
            let digits = &lower[word.len()..];
            match digits {
                "" => {}
                "0" | "1" | "2" if side.is_none() => side = digits.parse().ok(),
                _ => return None,
            }
            match word {
                "m" | "matched" | "match" | "matches" | "matching" => kind = Some(Kind::Matched),
                "inlier" | "inliers" | "ransac" | "verified" => kind = Some(Kind::Inlier),
                "all" | "raw" | "detected" => kind = Some(Kind::All),
                "c" | "coarse" => kind = Some(Kind::Coarse),
                "norm" | "normalized" | "normalised" | "resized" | "scaled" => kind = Some(Kind::Scaled),
                "" | "f" | "fine" | "final" | "xy" => {}
                "orig" | "original" => is_original = true,
                "left" | "l" | "a" | "src" if side.is_none() => side = Some(0),
                "right" | "r" | "b" | "dst" | "tgt" if side.is_none() => side = Some(1),
                _ if POINTS.contains(&word) => is_points = true,
                _ if word.strip_prefix('m').is_some_and(|word| POINTS.contains(&word)) => {
                    is_points = true;
                    kind = kind.or(Some(Kind::Matched));
                }
                _ => return None,
            }
        }
        let kind = match (kind.unwrap_or(Kind::Keypoints), is_original) {
            (Kind::Matched, true) => Kind::MatchedOriginal,
            (Kind::Inlier, true) => Kind::InlierOriginal,
            (Kind::Keypoints, true) => Kind::KeypointsOriginal,
            (kind, _) => kind,
        };
        Some(Self { kind, side: side? }).filter(|_| is_points)
    }
}

/// Returns whether a name is that of matches in one array: indices, or rows of coordinates.
pub(super) fn names_matches(name: &str) -> bool {
    let lower = name.to_lowercase();
    matches!(
        &*lower,
        "matches"
            | "matches0"
            | "match"
            | "indices0"
            | "match_indices"
            | "matches_idx"
            | "matched_indices"
            | "idxs"
            | "pairs"
            | "correspondences"
            | "corres"
            | "corrs"
            | "point_pairs"
    )
}

/// Returns whether a name is that of the scores of matches. Scores of keypoints are none.
pub(in crate::io) fn names_scores(name: &str) -> bool {
    let lower = name.to_lowercase();
    matches!(
        &*lower,
        "matching_scores"
            | "matching_scores0"
            | "match_confidence"
            | "match_scores"
            | "match_score"
            | "mscores"
            | "mconf"
            | "scores"
            | "score"
            | "confidence"
            | "confidences"
            | "conf"
            | "certainty"
            | "certainties"
            | "probabilities"
    )
}

/// Returns whether a name is that of the points of one image.
pub(in crate::io) fn names_points(name: &str) -> bool {
    PointsName::of(name).is_some()
}

/// Returns whether the name of an array concerns matches.
pub(in crate::io) fn concerns_matches(name: &str) -> bool {
    PointsName::of(name).is_some()
        || names_matches(name)
        || names_scores(name)
        || matches!(name, "covariances" | "covariance" | "batch_indexes" | "batch_indices")
}
