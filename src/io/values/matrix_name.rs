//! What the name of a 3×3 matrix says about it, in files of people and of other programs.

use super::quantity::Quantity;

/// Meaning of the name of a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum MatrixName {
    Fundamental,
    /// Another known matrix: a camera matrix, a homography, an essential matrix, a rotation.
    Other,
    Unknown,
}

/// Words that stand for a fundamental matrix.
const FUNDAMENTAL: [&str; 7] = ["f", "fm", "fmat", "fmatrix", "fundamental", "fundamentalmatrix", "fundmat"];

/// Words that stand for other matrices, or for a changed one.
const OTHER: [&str; 35] = [
    "e",
    "em",
    "emat",
    "essential",
    "essentialmatrix",
    "k",
    "camera",
    "cameramatrix",
    "mtx",
    "intrinsic",
    "intrinsics",
    "calibration",
    "h",
    "hmat",
    "homography",
    "homographies",
    "p",
    "projection",
    "r",
    "rot",
    "rotation",
    "t",
    "tr",
    "transposed",
    "transpose",
    "translation",
    "vgg",
    "inv",
    "inverse",
    "cov",
    "covariance",
    "jacobian",
    "identity",
    "mask",
    "q",
];

impl MatrixName {
    /// Classifies a name such as `F`, `F_est`, `fundamentalMatrix`, `K1`, `H_21`. Digits have no meaning. Single
    /// letters other than `f` count in capitals alone.
    pub(in crate::io) fn of(name: &str) -> Self {
        let mut found = Self::Unknown;
        for part in name_parts(name) {
            let word = part.trim_end_matches(|c: char| c.is_ascii_digit());
            let lower = word.to_lowercase();
            if word.len() == 1 && word == lower && word != "f" && part == name {
                continue;
            }
            if OTHER.contains(&&*lower) {
                // A fundamental matrix that is transposed or inverted, or E of F, is another matrix.
                return Self::Other;
            }
            if FUNDAMENTAL.contains(&&*lower) {
                found = Self::Fundamental;
            }
        }
        found
    }
}

/// Splits a name at marks and before capitals that follow small letters.
pub(in crate::io) fn name_parts(name: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut start, mut before) = (0, ' ');
    for (at, c) in name.char_indices() {
        if before.is_lowercase() && c.is_uppercase() {
            parts.push(&name[start..at]);
            start = at;
        }
        if !c.is_alphanumeric() {
            parts.push(&name[start..at]);
            start = at + c.len_utf8();
        }
        before = c;
    }
    parts.push(&name[start..]);
    parts.retain(|part| !part.is_empty());
    parts
}

/// Returns whether the name of an array is that of `F` or of another quantity of a geometry file.
pub(in crate::io) fn names_matrix(name: &str) -> bool {
    Quantity::named(name).is_some() || MatrixName::of(name) == MatrixName::Fundamental
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_classified() {
        for (names, meaning) in [
            (
                "F f F1 F12 F_est F_gt fm fmat Fmat fundamental fundamental_mat FundamentalMatrix F_21 f_matrix result.F",
                MatrixName::Fundamental,
            ),
            (
                "E K K1 H H21 homography essential_matrix cameraMatrix R P2 F_vgg F_inv F_transposed F.T intrinsics camera_matrix1",
                MatrixName::Other,
            ),
            ("M A matrix arr_0 x Fancy data fun k e r", MatrixName::Unknown),
        ] {
            for name in names.split(' ') {
                assert_eq!(MatrixName::of(name), meaning, "{name}");
            }
        }
    }
}
