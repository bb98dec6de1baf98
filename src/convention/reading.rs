//! One possible meaning of a matrix.

use std::fmt;

use serde::Serialize;

use crate::geometry::{FundamentalMatrix, rescaling};

/// How the numbers of a matrix are to be taken. A point `x` of this program is in the file the point
/// `u = A((x + ½) s − ½) + o` with the scale `s`, the origin `o`, and `A` the exchange of x and y.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reading {
    /// `x1ᵀ F x2 = 0`; the same as images 1 and 2 exchanged.
    pub transposed: bool,
    /// Points are (y, x), or (row, column).
    pub axes_exchanged: bool,
    /// Both coordinates of the centre of the upper left pixel, px.
    pub origin: f64,
    /// Size of the images that the matrix is for, over the size of those in which the matches are.
    pub scale: f64,
}

impl Reading {
    /// The matrix means what it was taken for.
    pub(super) const AS_READ: Self =
        Self { transposed: false, axes_exchanged: false, origin: 0.0, scale: 1.0 };

    /// Number of things that differ from how the matrix was read.
    pub fn changes(&self) -> usize {
        [self.transposed, self.axes_exchanged, self.origin > 0.0, self.scale.to_bits() != 1f64.to_bits()]
            .into_iter()
            .filter(|changed| *changed)
            .count()
    }

    /// Whether two readings differ in the origin at most.
    pub(super) fn differs_in_origin_only(&self, other: &Self) -> bool {
        Self { origin: other.origin, ..*self } == *other
    }

    /// `F` in the convention of this program, if the given one, taken as it stands, is to be read like this. `None`
    /// where numbers overflow.
    pub fn apply(&self, given: &FundamentalMatrix) -> Option<FundamentalMatrix> {
        let mut given_from_ours = rescaling(self.scale);
        given_from_ours[(0, 2)] += self.origin;
        given_from_ours[(1, 2)] += self.origin;
        if self.axes_exchanged {
            given_from_ours.swap_rows(0, 1);
        }
        let matrix = if self.transposed { given.matrix().transpose() } else { *given.matrix() };
        FundamentalMatrix::from_rank_two(given_from_ours.transpose() * matrix * given_from_ours)
    }

    /// The reading in a few words, for lists in which its full name would be too long.
    pub fn brief(&self) -> String {
        self.in_words("transposed")
    }

    fn in_words(&self, transposed: &str) -> String {
        if self.changes() == 0 {
            return "as read".to_owned();
        }
        let mut words = Vec::new();
        if self.transposed {
            words.push(transposed.to_owned());
        }
        if self.axes_exchanged {
            words.push("x and y exchanged".to_owned());
        }
        if self.origin > 0.0 {
            words.push(format!("pixels counted from ({0}, {0})", self.origin));
        }
        if self.scale.to_bits() != 1f64.to_bits() {
            let percent = 100.0 * self.scale;
            // Three digits are what a few dozen matches can tell.
            let digits = usize::from(percent < 100.0) + usize::from(percent < 10.0);
            words.push(format!("for images of {percent:.digits$} % of this size"));
        }
        words.join("; ")
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.in_words("transposed, or images 1 and 2 exchanged"))
    }
}
