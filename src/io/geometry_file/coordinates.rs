//! The content of a file in the coordinates of its format.
//!
//! Where the centre of the upper left pixel is `(o, o)` a point is `x' = T x` with `T` a shift by `o`. Then
//! `F' = T⁻ᵀ F T⁻¹`, `P' = T P` and, for a homography from pixels to pixels, `H' = T H T⁻¹`.

use nalgebra::Matrix3;

use super::quantity::Quantity;
use super::{Format, GeometryFile, ImageNote, PairLabel, TrustNote};
use crate::geometry::{FundamentalMatrix, Point, PointPair, symmetric_epipolar_distance};

/// The shift from pixels of this program to those of a format.
fn shift(origin: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, origin, 0.0, 1.0, origin, 0.0, 0.0, 1.0)
}

/// A matrix with its name, row by row.
pub(super) struct NamedRows {
    pub(super) quantity: Quantity,
    pub(super) rows: Vec<Vec<f64>>,
}

/// A matrix with its name in one list, with the number of its columns.
pub(super) struct NamedTable {
    pub(super) quantity: Quantity,
    pub(super) columns: usize,
    /// Row by row.
    pub(super) values: Vec<f64>,
}

/// How far the point pairs of a file are from their epipolar lines, from the numbers in the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SelfCheck {
    /// Pairs measured.
    pub(super) pairs: usize,
    /// Mean symmetric epipolar distance, px.
    pub(super) mean: f64,
    /// The largest one, px.
    pub(super) max: f64,
}

/// The content, converted and rounded as it will stand in the file.
pub(super) struct WrittenGeometry<'a> {
    pub(super) format: Format,
    pub(super) matrices: Vec<NamedRows>,
    pub(super) pairs: Vec<PointPair>,
    pub(super) images: Option<&'a [ImageNote; 2]>,
    pub(super) check: Option<SelfCheck>,
    /// One a pair, or none at all.
    pub(super) labels: &'a [PairLabel],
    pub(super) trust: Option<&'a TrustNote>,
}

impl<'a> WrittenGeometry<'a> {
    pub(super) fn new(file: &'a GeometryFile, format: Format) -> Self {
        let origin = format.origin();
        let (there, back) = (shift(origin), shift(-origin));
        let fundamental = file.geometry().and_then(|f| moved_fundamental(&f, origin));
        let mut matrices = Vec::new();
        let mut add = |quantity, rows| matrices.push(NamedRows { quantity, rows });
        if let Some(f) = &fundamental {
            add(Quantity::Fundamental, rows(f.matrix()));
            add(Quantity::Epipole1, vec![f.epipole1().iter().copied().collect()]);
            add(Quantity::Epipole2, vec![f.epipole2().iter().copied().collect()]);
        }
        if let Some([camera1, camera2]) = &file.cameras {
            add(Quantity::Camera1, rows(&(there * camera1.matrix())));
            add(Quantity::Camera2, rows(&(there * camera2.matrix())));
        }
        if let Some([h1, h2]) = &file.homographies {
            add(Quantity::Homography1, rows(&(there * h1 * back)));
            add(Quantity::Homography2, rows(&(there * h2 * back)));
        }
        if let Some(h) = &file.homography21 {
            add(Quantity::PlaneHomography, rows(&(there * h * back)));
        }
        let pairs: Vec<_> = file.pairs.iter().map(|p| moved_pair(p, origin)).collect();
        let check = fundamental.and_then(|f| SelfCheck::new(&f, &pairs));
        let labels = if file.labels.len() == pairs.len() { &file.labels[..] } else { &[] };
        let trust = file.trust.as_ref();
        Self { format, matrices, pairs, images: file.images.as_ref(), check, labels, trust }
    }

    /// All matrices, vectors as columns, and the points of each image in a table of their own.
    pub(super) fn tables(&self) -> Vec<NamedTable> {
        let mut tables: Vec<_> = self
            .matrices
            .iter()
            .map(|m| NamedTable {
                quantity: m.quantity,
                columns: if m.rows.len() == 1 { 1 } else { m.rows.first().map_or(1, Vec::len) },
                values: m.rows.concat(),
            })
            .collect();
        if !self.pairs.is_empty() {
            for (quantity, side) in [(Quantity::Points1, 0), (Quantity::Points2, 2)] {
                let values =
                    self.pairs.iter().flat_map(|p| [pair_numbers(p)[side], pair_numbers(p)[side + 1]]);
                tables.push(NamedTable { quantity, columns: 2, values: values.collect() });
            }
        }
        tables
    }

    /// What the file says in words besides its numbers, with the names of these fields.
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

    /// Sentences about who wrote the file, its convention and the self-check, one a line.
    pub(super) fn preamble(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "Epipolar geometry of two images, written by epiline {}.",
            env!("CARGO_PKG_VERSION")
        )];
        lines.extend(self.format.convention());
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
        // A pair at an epipole has no line, and no format has a number for that.
        max.is_finite().then_some(Self { pairs: pairs.len(), mean, max })
    }

    fn sentence(&self) -> String {
        format!(
            "Self-check: under this F the {} point pairs of this file have a symmetric epipolar distance (mean of the distances in the two images) of {:.3e} px on average and {:.3e} px at most.",
            self.pairs, self.mean, self.max
        )
    }
}

/// `F` for pixels moved by `origin` along both axes.
fn moved_fundamental(f: &FundamentalMatrix, origin: f64) -> Option<FundamentalMatrix> {
    if origin == 0.0 {
        return Some(*f);
    }
    let back = shift(-origin);
    FundamentalMatrix::from_rank_two(back.transpose() * f.matrix() * back)
}

/// A pair for pixels moved by `origin`.
fn moved_pair(pair: &PointPair, origin: f64) -> PointPair {
    let moved = |p: Point| Point::new(p.x + origin, p.y + origin);
    PointPair { point1: moved(pair.point1), point2: moved(pair.point2) }
}

/// Nested rows.
fn rows<const C: usize>(matrix: &nalgebra::SMatrix<f64, 3, C>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// Numbers separated by something, each with the shortest digits that read back as the same number and always with a
/// point or an exponent.
pub(super) fn numbers(values: &[f64], separator: &str) -> String {
    values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(separator)
}

/// `x1 y1 x2 y2`.
pub(super) fn pair_numbers(pair: &PointPair) -> [f64; 4] {
    [pair.point1.x, pair.point1.y, pair.point2.x, pair.point2.y]
}

/// A name on one line, without characters that end a line or cannot be seen.
pub(super) fn one_line(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
