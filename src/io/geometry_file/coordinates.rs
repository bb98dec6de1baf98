//! Content of a file in the coordinates of its format.
//!
//! With the centre of the upper left pixel at `(o, o)`, a point is `x' = T x` with the shift `T` by
//! `o`. Then `F' = T⁻ᵀ F T⁻¹` and `P' = T P`. A homography from pixels to pixels becomes
//! `H' = T H T⁻¹`.

use nalgebra::{Matrix3, SMatrix};

use super::{Format, GeometryFile, ImageNote, PairLabel, TrustNote};
use crate::camera::PicturesOf;
use crate::geometry::{FundamentalMatrix, Point, PointPair, symmetric_epipolar_distance};
use crate::io::values::Quantity;
use crate::presentation::pictures_in_words;

/// Returns the shift from the pixels of this program to the pixels of a format.
pub(in crate::io) fn shift(origin: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, origin, 0.0, 1.0, origin, 0.0, 0.0, 1.0)
}

/// Named matrix.
#[derive(Clone)]
pub(super) struct NamedTable {
    pub(super) quantity: Quantity,
    pub(super) columns: usize,
    /// Entries, row by row.
    pub(super) values: Vec<f64>,
}

/// Fit of the point pairs to F, computed from the numbers in the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SelfCheck {
    pub(super) pairs: usize,
    /// Mean symmetric epipolar distance, px.
    pub(super) mean: f64,
    /// Maximum symmetric epipolar distance, px.
    pub(super) max: f64,
}

/// Content converted and rounded as in the file.
pub(super) struct WrittenGeometry<'a> {
    pub(super) format: Format,
    /// Matrices, and vectors as one row.
    pub(super) matrices: Vec<NamedTable>,
    pub(super) pairs: Vec<PointPair>,
    pub(super) images: Option<&'a [ImageNote; 2]>,
    pub(super) check: Option<SelfCheck>,
    /// Name and origin, one per pair; may be empty.
    pub(super) labels: &'a [PairLabel],
    pub(super) trust: Option<&'a TrustNote>,
    pub(super) pictures: &'a PicturesOf,
}

impl<'a> WrittenGeometry<'a> {
    pub(super) fn new(file: &'a GeometryFile, format: Format) -> Self {
        let origin = format.origin();
        let (there, back) = (shift(origin), shift(-origin));
        let fundamental = file.geometry().and_then(|f| moved_fundamental(&f, origin));
        let mut matrices = Vec::new();
        let mut add = |quantity, (columns, values)| matrices.push(NamedTable { quantity, columns, values });
        if let Some(f) = &fundamental {
            add(Quantity::Fundamental, by_rows(f.matrix()));
            add(Quantity::Epipole1, by_rows(&f.epipole1().transpose()));
            add(Quantity::Epipole2, by_rows(&f.epipole2().transpose()));
        }
        if let Some([camera1, camera2]) = &file.cameras {
            add(Quantity::Camera1, by_rows(&(there * camera1.matrix())));
            add(Quantity::Camera2, by_rows(&(there * camera2.matrix())));
        }
        if let Some([h1, h2]) = &file.homographies {
            add(Quantity::Homography1, by_rows(&(there * h1 * back)));
            add(Quantity::Homography2, by_rows(&(there * h2 * back)));
        }
        if let Some(h) = &file.homography21 {
            add(Quantity::PlaneHomography, by_rows(&(there * h * back)));
        }
        let pairs: Vec<_> = file.pairs.iter().map(|p| moved_pair(p, origin)).collect();
        let check = fundamental.and_then(|f| SelfCheck::new(&f, &pairs));
        let labels = if file.labels.len() == pairs.len() { &file.labels[..] } else { &[] };
        let trust = file.trust.as_ref();
        let (pictures, images) = (&file.pictures, file.images.as_ref());
        Self { format, matrices, pairs, images, check, labels, trust, pictures }
    }

    /// Returns all matrices, vectors as columns, and the points of each image as a separate table.
    pub(super) fn tables(&self) -> Vec<NamedTable> {
        let mut tables = self.matrices.clone();
        for table in &mut tables {
            if table.values.len() == table.columns {
                table.columns = 1;
            }
        }
        if !self.pairs.is_empty() {
            for (quantity, side) in [(Quantity::Points1, 0), (Quantity::Points2, 2)] {
                let values = self.pairs.iter().flat_map(|p| [p.numbers()[side], p.numbers()[side + 1]]);
                tables.push(NamedTable { quantity, columns: 2, values: values.collect() });
            }
        }
        tables
    }

    /// Returns the text fields of the file with their names.
    pub(super) fn words(&self) -> Vec<(&'static str, Vec<String>)> {
        let reasons =
            self.trust.map(|trust| ("reasons", trust.reasons.iter().map(|r| one_line(r)).collect()));
        let named = !self.labels.is_empty();
        let names =
            named.then(|| ("pair_names", self.labels.iter().map(|label| one_line(&label.name)).collect()));
        let origins =
            named.then(|| ("pair_origins", self.labels.iter().map(|l| l.origin.name().to_owned()).collect()));
        [reasons, names, origins].into_iter().flatten().collect()
    }

    /// Returns the header lines: the program, the convention and the self-check.
    pub(super) fn preamble(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "Epipolar geometry of two images, written by epiline {}.",
            env!("CARGO_PKG_VERSION")
        )];
        lines.extend(self.format.convention());
        lines.extend(pictures_in_words(self.pictures, self.format.origin()));
        if let Some(check) = &self.check {
            lines.push(check.sentence());
        }
        lines
    }
}

impl SelfCheck {
    fn new(f: &FundamentalMatrix, pairs: &[PointPair]) -> Option<Self> {
        let distances: Vec<f64> = pairs.iter().map(|p| symmetric_epipolar_distance(f, p)).collect();
        let max = distances.iter().copied().reduce(f64::max)?;
        let mean = distances.iter().sum::<f64>() / distances.len() as f64;
        // A pair at an epipole has an infinite distance, which no format can hold.
        max.is_finite().then_some(Self { pairs: pairs.len(), mean, max })
    }

    fn sentence(&self) -> String {
        format!(
            "Self-check of the {} point pairs under this F: their symmetric epipolar distance (mean of both images) is {:.3e} px on average and {:.3e} px at most.",
            self.pairs, self.mean, self.max
        )
    }
}

/// Returns `F` for pixels shifted by `origin` along both axes.
pub(in crate::io) fn moved_fundamental(f: &FundamentalMatrix, origin: f64) -> Option<FundamentalMatrix> {
    if origin == 0.0 {
        return Some(*f);
    }
    let back = shift(-origin);
    FundamentalMatrix::from_rank_two(back.transpose() * f.matrix() * back)
}

/// Returns a pair in pixels shifted by `origin`.
pub(in crate::io) fn moved_pair(pair: &PointPair, origin: f64) -> PointPair {
    let moved = |p: Point| Point::new(p.x + origin, p.y + origin);
    PointPair { point1: moved(pair.point1), point2: moved(pair.point2) }
}

/// Returns the number of columns of a matrix, and its entries row by row.
fn by_rows<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> (usize, Vec<f64>) {
    (C, matrix.transpose().iter().copied().collect())
}

/// Formats numbers with the fewest digits that read back exactly, always with a point or an
/// exponent.
pub(super) fn numbers(values: &[f64], separator: &str) -> String {
    values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(separator)
}

/// Replaces control characters, which would break the line, with spaces.
pub(super) fn one_line(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
