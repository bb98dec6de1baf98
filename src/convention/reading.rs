//! Possible meaning of a matrix.

use std::fmt;

use serde::Serialize;

use crate::geometry::{FundamentalMatrix, rescaling};

/// Pixel origins in use: the centre of the upper left pixel, its corner, and counting from 1.
const ORIGINS: [f64; 3] = [0.0, 0.5, 1.0];

/// Convention under which the numbers of a matrix are read. A point `x` of this program is the
/// point `u = A((x + ½) s − ½) + o` of the file, with the scale `s`, the origin `o` and the
/// exchange `A` of x and y.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reading {
    /// True for `x1ᵀ F x2 = 0`, which equals images 1 and 2 exchanged.
    pub transposed: bool,
    /// True if points are (y, x), or (row, column).
    pub axes_exchanged: bool,
    /// Coordinate of the centre of the upper left pixel in x and y, px.
    pub origin: f64,
    /// Size of the images of the matrix over the size of the images of the matches.
    pub scale: f64,
}

impl Reading {
    /// Convention of the file as it was read.
    pub(crate) const AS_READ: Self =
        Self { transposed: false, axes_exchanged: false, origin: 0.0, scale: 1.0 };

    /// Returns the readings for images of the same size.
    pub(crate) fn of_same_size() -> impl Iterator<Item = Self> {
        let orders = [(false, false), (true, false), (false, true), (true, true)];
        orders.into_iter().flat_map(|(transposed, axes_exchanged)| {
            ORIGINS.map(|origin| Self { transposed, axes_exchanged, origin, scale: 1.0 })
        })
    }

    /// Returns the number of differences from the matrix as read.
    pub fn changes(&self) -> usize {
        [self.transposed, self.axes_exchanged, self.origin > 0.0, self.scale.to_bits() != 1f64.to_bits()]
            .into_iter()
            .filter(|changed| *changed)
            .count()
    }

    /// Returns whether two readings differ at most in the origin.
    pub(super) fn differs_in_origin_only(&self, other: &Self) -> bool {
        Self { origin: other.origin, ..*self } == *other
    }

    /// Converts a matrix of this reading to the convention of this program. `None` on overflow.
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

    /// Returns the reading in a few words, for lists.
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
            // A few dozen matches determine the scale to three digits.
            let digits = usize::from(percent < 100.0) + usize::from(percent < 10.0);
            words.push(format!("for images of {percent:.digits$} % of this size"));
        }
        words.join("; ")
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.in_words("transposed, or left and right image exchanged"))
    }
}
