//! Named tables of numbers found in a file, and their meaning.

mod arrays;

use nalgebra::{Matrix3, Matrix3x4, SMatrix};
use serde_json::Value;

use super::Problem;
use super::content::{BareNumbers, CalibratedNote, GeometryFile, ImageNote};
use super::printed::{PrintedMatrix, ROW_BY_ROW};
use super::views::PicturesRead;
use crate::estimate::Match;
use crate::foreign::excerpt;
use crate::geometry::{Camera, FundamentalMatrix, PointPair, looks_essential};
use crate::io::npy::Array;
use crate::io::number::finite_number;
use crate::io::point_pairs::{check_more_columns, first_four};
use crate::io::values::{FoundMatches, Quantity, check_pixels, names_points, names_scores, there_twice};

/// Rectangular table of finite numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NumberTable {
    rows: usize,
    columns: usize,
    /// Entries, row by row.
    numbers: Vec<f64>,
}

impl NumberTable {
    /// Creates a table of `columns` columns, or returns the error in words.
    pub(super) fn new(rows: usize, columns: usize, numbers: Vec<f64>) -> Result<Self, String> {
        match numbers.iter().find(|v| !v.is_finite()) {
            Some(other) => Err(format!("\"{other}\" is not a finite number")),
            None if rows.checked_mul(columns) == Some(numbers.len()) => Ok(Self { rows, columns, numbers }),
            None => Err(format!("expected {rows}×{columns} numbers, found {}", numbers.len())),
        }
    }

    /// Creates a table from rows of equal length.
    pub(super) fn from_rows(rows: &[Vec<f64>]) -> Result<Self, String> {
        let columns = rows.first().map_or(0, Vec::len);
        match rows.iter().position(|r| r.len() != columns) {
            Some(k) => Err(format!("row {} has {} numbers, row 1 has {columns}", k + 1, rows[k].len())),
            None => Self::new(rows.len(), columns, rows.concat()),
        }
    }

    fn shape(&self) -> String {
        format!("{}×{}", self.rows, self.columns)
    }

    /// Returns the numbers of a matrix of a given shape; one row or one column with all numbers is
    /// accepted.
    pub(super) fn matrix(&self, rows: usize, columns: usize) -> Result<&[f64], String> {
        let is_list = (self.rows == 1 || self.columns == 1) && self.numbers.len() == rows * columns;
        if is_list || (self.rows, self.columns) == (rows, columns) {
            return Ok(&self.numbers);
        }
        Err(format!("expected a {rows}×{columns} matrix, found {}", self.shape()))
    }

    fn matrix3(&self) -> Result<Matrix3<f64>, String> {
        Ok(Matrix3::from_row_slice(self.matrix(3, 3)?))
    }

    /// Returns the rows, of `columns` numbers each.
    fn rows_of(&self, columns: usize) -> Result<std::slice::ChunksExact<'_, f64>, String> {
        if self.columns != columns && !self.numbers.is_empty() {
            return Err(format!("expected rows of {columns} numbers, found {}", self.shape()));
        }
        Ok(self.numbers.chunks_exact(columns))
    }
}

/// Tables found in a file, in the coordinates of the file.
#[derive(Debug, Default)]
pub(super) struct Fields {
    tables: Vec<(Quantity, NumberTable)>,
    pub(super) images: [Option<ImageNote>; 2],
    pub(super) pictures: PicturesRead,
    /// Matches of a result.
    found: Vec<PointPair>,
    /// Covariance of `F` of a result.
    pub(super) covariance: Option<SMatrix<f64, 9, 9>>,
    /// Calibrated part of a result.
    pub(super) calibrated: Option<CalibratedNote>,
    /// Whether the verdict of a result says that the pictures show different scenes.
    pub(super) is_of_different_scenes: bool,
    /// Matches in arrays with the names of matchers.
    matches: Option<FoundMatches>,
    /// Reason why arrays with the names of matchers give no matches.
    no_matches: Option<String>,
    /// Reason why a matrix is not taken for `F`.
    not_fundamental: Option<String>,
    /// Clauses about how the file was read.
    pub(super) notes: Vec<String>,
}

impl Fields {
    /// Adds a table. A repeated quantity must have the same numbers.
    pub(super) fn add(&mut self, quantity: Quantity, table: NumberTable) -> Result<(), Problem> {
        match self.table(quantity) {
            Some(known) if known.numbers != table.numbers => {
                return Err(Problem::whole(there_twice(quantity.symbol())));
            }
            Some(_) => {}
            None => self.tables.push((quantity, table)),
        }
        Ok(())
    }

    /// Adds numbers without a name: nine are `F`, rows of four are point pairs.
    pub(super) fn add_bare(&mut self, table: NumberTable, wanted: BareNumbers) -> Result<(), Problem> {
        let quantity = match (table.numbers.len(), table.columns) {
            (9, _) => Quantity::Fundamental,
            (24, 4) if wanted == BareNumbers::Geometry => {
                let (first, second) = table.numbers.split_at(12);
                for (quantity, numbers) in [(Quantity::Camera1, first), (Quantity::Camera2, second)] {
                    self.add(quantity, NumberTable { rows: 3, columns: 4, numbers: numbers.to_vec() })?;
                }
                return Ok(());
            }
            (_, 4) if wanted == BareNumbers::Anything => Quantity::Pairs,
            (count, _) => {
                return Err(Problem::whole(format!(
                    "expected the nine numbers of a fundamental matrix, found {count}"
                )));
            }
        };
        self.add(quantity, table)
    }

    /// Adds the nine numbers of a printed matrix.
    pub(super) fn add_printed(&mut self, printed: PrintedMatrix) -> Result<(), Problem> {
        self.notes.extend(printed.notes);
        self.add(
            Quantity::Fundamental,
            NumberTable { rows: 3, columns: 3, numbers: printed.numbers.to_vec() },
        )
    }

    /// Returns whether nothing was found.
    fn is_empty(&self) -> bool {
        self.tables.is_empty() && self.found.is_empty() && self.matches.is_none()
    }

    fn table(&self, quantity: Quantity) -> Option<&NumberTable> {
        self.tables.iter().find(|(q, _)| *q == quantity).map(|(_, t)| t)
    }

    /// Reads the fields of an object that name a [`Quantity`]; others are skipped.
    pub(super) fn from_value(value: &Value) -> Result<Self, Problem> {
        let mut fields = Self::default();
        let Some(object) = value.as_object() else {
            let is_table = |array: &Array| array.shape.len() > 1 && array.numbers.len() != 9;
            if let Some(array) = arrays::array_of(value).filter(is_table) {
                return Self::from_arrays(&[(String::new(), Ok(array))]);
            }
            fields.add_bare(table(value).map_err(Problem::whole)?, BareNumbers::Anything)?;
            return Ok(fields);
        };
        let arrays = arrays::named_arrays(object);
        // Beside keypoints, `matches` has their indices.
        let has = |named: fn(&str) -> bool| arrays.iter().any(|(name, _)| named(name));
        let has_keypoints = has(|name| Quantity::named(name).is_none() && names_points(name))
            || (has(names_points) && has(names_scores));
        let mut others = Vec::new();
        for (name, value) in object {
            match (Quantity::named(name), &name[..]) {
                (Some(quantity), _) if has_keypoints && quantity.is_points() => {}
                (Some(_), _) if value.is_null() => {}
                // In a result of `estimate` the matches are objects with more than coordinates, or
                // there are none.
                (Some(Quantity::Pairs), "matches") if !is_rows(value) || object.contains_key("pairs") => {
                    fields.found = found_pairs(value);
                }
                (Some(quantity), _) => {
                    let table = table(value).map_err(|e| Problem::whole(format!("{name}: {e}")))?;
                    fields.add(quantity, table)?;
                }
                (None, name) if fields.pictures.read(name, value).map_err(Problem::whole)? => {}
                (None, "image1") => fields.images[0] = image(value),
                (None, "image2") => fields.images[1] = image(value),
                (None, "images") => {
                    let listed = value.as_array().map_or(&[][..], Vec::as_slice);
                    for (place, value) in fields.images.iter_mut().zip(listed) {
                        *place = image(value);
                    }
                }
                (None, _) => arrays::matrices_in(name, value, &mut others),
            }
        }
        if has_keypoints {
            fields.add_matches(&arrays);
        }
        fields.add_named_matrix(&others);
        Ok(fields)
    }

    /// Converts the tables to geometry.
    pub(super) fn interpret(self) -> Result<GeometryFile, Problem> {
        let [image1, image2] = self.images.clone();
        let images = image1.zip(image2).map(<[ImageNote; 2]>::from);
        let frames = images.as_ref().map(|images| images.each_ref().map(|image| image.frame));
        let fundamental = self.get(Quantity::Fundamental, |table| {
            FundamentalMatrix::from_numbers(table.matrix3()?, frames).map_err(|e| e.to_string())
        })?;
        let camera = |table: &NumberTable| {
            Camera::from_matrix(Matrix3x4::from_row_slice(table.matrix(3, 4)?))
                .ok_or_else(|| "this matrix is not a camera (its rank is below 3)".to_owned())
        };
        let pictures = self.pictures.known(&numbers_of).map_err(Problem::whole)?;
        let file = GeometryFile {
            found: self.found.clone(),
            covariance: self.covariance,
            calibrated: self.calibrated.clone(),
            is_of_different_scenes: self.is_of_different_scenes,
            fundamental,
            essential: self.get(Quantity::Fundamental, NumberTable::matrix3)?.filter(looks_essential),
            cameras: self.both([Quantity::Camera1, Quantity::Camera2], camera)?,
            homographies: self.both([Quantity::Homography1, Quantity::Homography2], NumberTable::matrix3)?,
            homography21: self.get(Quantity::PlaneHomography, NumberTable::matrix3)?,
            pairs: self.pairs()?,
            images,
            remarks: self.notes.clone(),
            not_fundamental: self.not_fundamental.clone(),
            ..GeometryFile::of(pictures.clone())
        };
        let mut file = self.with_matches(file)?;
        let is_list = |table: &NumberTable| table.rows == 1 || table.columns == 1;
        if self.table(Quantity::Fundamental).is_some_and(is_list) {
            file.remarks.push(ROW_BY_ROW.to_owned());
        }
        let is_finite = |h: &Matrix3<f64>| h.iter().all(|v| v.is_finite());
        let mut homographies = file.homographies.iter().flatten().chain(&file.homography21);
        if !file.pairs.iter().all(PointPair::is_finite) || !homographies.all(is_finite) {
            return Err(Problem::whole("the numbers are too large"));
        }
        let empty = GeometryFile {
            calibrated: self.calibrated,
            is_of_different_scenes: self.is_of_different_scenes,
            covariance: self.covariance,
            remarks: file.remarks.clone(),
            not_fundamental: file.not_fundamental.clone(),
            ..GeometryFile::of(pictures)
        };
        if file == empty {
            if let Some(problem) = self.not_fundamental {
                return Err(Problem::whole(problem));
            }
            return Err(Problem::whole(
                "no fundamental matrix, cameras or point pairs found. Known names are F or fundamental, P1 and P2, points1 and points2, pairs",
            ));
        }
        Ok(file)
    }

    /// Adds the matches of arrays, or the reason why there are none. Without anything else the reason is an error.
    fn with_matches(&self, mut file: GeometryFile) -> Result<GeometryFile, Problem> {
        if let Some(found) = &self.matches {
            file.pairs = found.matches.iter().map(|found| found.pair).collect();
            let is_weighted = |found: &Match| *found != Match::from(found.pair);
            if found.matches.iter().any(is_weighted) {
                file.weighted.clone_from(&found.matches);
            }
            file.remarks.extend(found.notes.iter().cloned());
        } else if let Some(table) = self.table(Quantity::Pairs).filter(|table| table.columns > 4) {
            file.remarks.push(first_four(table.columns));
        }
        let problem = self.no_matches.clone().or_else(|| check_pixels(&file.pairs).err());
        let Some(problem) = problem else { return Ok(file) };
        if file.geometry().is_none() {
            return Err(Problem::whole(problem));
        }
        file.pairs.clear();
        file.weighted.clear();
        file.remarks.push(format!("its matches were left out: {problem}"));
        Ok(file)
    }

    /// Reads a quantity, if present.
    fn get<T>(
        &self,
        quantity: Quantity,
        read: impl Fn(&NumberTable) -> Result<T, String>,
    ) -> Result<Option<T>, Problem> {
        let named = |e: String| {
            // A file that holds only a matrix needs no name in the message.
            let is_alone = self.tables.len() == 1 && quantity == Quantity::Fundamental;
            Problem::whole(if is_alone { e } else { format!("{}: {e}", quantity.symbol()) })
        };
        self.table(quantity).map(|table| read(table).map_err(named)).transpose()
    }

    /// Reads two quantities that must occur together.
    fn both<T>(
        &self,
        [first, second]: [Quantity; 2],
        read: impl Fn(&NumberTable) -> Result<T, String>,
    ) -> Result<Option<[T; 2]>, Problem> {
        match (self.get(first, &read)?, self.get(second, &read)?) {
            (Some(a), Some(b)) => Ok(Some([a, b])),
            (None, None) => Ok(None),
            (found, _) => {
                let (there, missing) = if found.is_some() { (first, second) } else { (second, first) };
                let (there, missing) = (there.symbol(), missing.symbol());
                Err(Problem::whole(format!("{there} is given, but {missing} is missing")))
            }
        }
    }

    /// Reads point pairs, from rows of four or from a list per image.
    fn pairs(&self) -> Result<Vec<PointPair>, Problem> {
        let four = |table: &NumberTable| {
            let rows: Vec<&[f64]> = table.numbers.chunks(table.columns.max(1)).collect();
            match table.columns {
                5.. => check_more_columns(&rows)?,
                _ => drop(table.rows_of(4)?),
            }
            Ok(rows.iter().map(|r| PointPair::new(r[0], r[1], r[2], r[3])).collect::<Vec<_>>())
        };
        if let Some(pairs) = self.get(Quantity::Pairs, four)? {
            return Ok(pairs);
        }
        let two = |table: &NumberTable| Ok(table.rows_of(2)?.map(|r| [r[0], r[1]]).collect::<Vec<_>>());
        let Some([points1, points2]) = self.both([Quantity::Points1, Quantity::Points2], two)? else {
            return Ok(Vec::new());
        };
        if points1.len() != points2.len() {
            return Err(Problem::whole(format!(
                "there are {} points in image 1 and {} in image 2. The numbers must be equal",
                points1.len(),
                points2.len()
            )));
        }
        Ok(points1.iter().zip(&points2).map(|(a, b)| PointPair::new(a[0], a[1], b[0], b[1])).collect())
    }
}

/// Returns whether the value is a list of lists.
fn is_rows(value: &Value) -> bool {
    value.as_array().is_some_and(|rows| rows.iter().all(Value::is_array))
}

/// Reads a table from nested rows, a flat list or an OpenCV matrix.
pub(super) fn table(value: &Value) -> Result<NumberTable, String> {
    match value {
        Value::Object(_) => opencv_matrix(value),
        // Pairs of points: N×2×2.
        Value::Array(rows) if rows.iter().all(is_rows) && !rows.is_empty() => {
            let Some(Array { shape, numbers }) =
                arrays::array_of(value).filter(|array| array.shape[1..] == [2, 2])
            else {
                return Err("this is not a list of rows".into());
            };
            NumberTable::new(shape[0], 4, numbers)
        }
        Value::Array(rows) if !rows.is_empty() && is_rows(value) => {
            let rows = rows.iter().map(list).collect::<Result<Vec<_>, _>>()?;
            NumberTable::from_rows(&rows)
        }
        // Rows as texts: `- 1 2 3`.
        Value::Array(rows) if rows.len() > 1 && rows.iter().all(Value::is_string) => {
            let rows = rows.iter().map(list).collect::<Result<Vec<_>, _>>()?;
            NumberTable::from_rows(&rows)
        }
        Value::Array(_) | Value::String(_) => {
            let numbers = list(value)?;
            NumberTable::new(1, numbers.len(), numbers)
        }
        _ => Err("this is not a list of rows".into()),
    }
}

/// Reads a number, or the entries of a table row by row.
fn numbers_of(value: &Value) -> Option<Vec<f64>> {
    match value {
        Value::Number(_) => Some(vec![cell(value).ok()?]),
        other => Some(table(other).ok()?.numbers),
    }
}

/// Reads `{rows, cols, dt, data}`, with `sizes` accepted in place of rows and columns. Channels
/// count as columns.
fn opencv_matrix(value: &Value) -> Result<NumberTable, String> {
    let size = |name: &str| value.get(name).and_then(whole);
    let numbers = list(value.get("data").ok_or("this is not a matrix: the field data is missing")?)?;
    let channels = match value.get("dt") {
        Some(Value::String(kind)) => {
            let digits: String = kind.chars().take_while(char::is_ascii_digit).collect();
            if digits.is_empty() { Some(1) } else { digits.parse().ok() }
        }
        _ => Some(1),
    };
    let sizes = value.get("sizes").map(list).transpose()?;
    let (rows, columns) = match sizes.as_deref() {
        Some([count]) => (Some(1), Some(*count as usize)),
        Some([rows, columns]) => (Some(*rows as usize), Some(*columns as usize)),
        Some(_) => return Err("the matrix has more than two dimensions".into()),
        None => (size("rows"), size("cols")),
    };
    let (Some(rows), Some(columns), Some(channels)) = (rows, columns, channels) else {
        return Err("this is not a matrix: the number of rows or columns is missing".into());
    };
    // OpenCV treats N×1 and 1×N points of two channels alike.
    let (rows, columns) = if rows == 1 && channels > 1 { (columns, rows) } else { (rows, columns) };
    NumberTable::new(rows, columns.checked_mul(channels).ok_or("the matrix is too large")?, numbers)
}

/// Reads a count.
fn whole(value: &Value) -> Option<usize> {
    match value {
        Value::String(text) => text.trim().parse().ok(),
        other => other.as_u64().and_then(|v| usize::try_from(v).ok()),
    }
}

/// Reads a list of numbers, or a text of numbers separated by spaces.
fn list(value: &Value) -> Result<Vec<f64>, String> {
    match value {
        Value::Array(cells) => cells.iter().map(cell).collect(),
        Value::String(text) => text.split_whitespace().map(finite_number).collect(),
        other => Ok(vec![cell(other)?]),
    }
}

fn cell(value: &Value) -> Result<f64, String> {
    match value {
        Value::String(text) => finite_number(text.trim()),
        Value::Number(number) => {
            number.as_f64().ok_or_else(|| format!("\"{number}\" is not a finite number"))
        }
        other => Err(format!("{} is not a number", excerpt(&other.to_string()))),
    }
}

/// Returns the matches of a result, which are objects. Others are left out.
fn found_pairs(value: &Value) -> Vec<PointPair> {
    let pair = |found: &Value| match list(found.get("pair")?).ok()?[..] {
        [x1, y1, x2, y2] => Some(PointPair::new(x1, y1, x2, y2)).filter(PointPair::is_finite),
        _ => None,
    };
    value.as_array().map_or(&[][..], Vec::as_slice).iter().filter_map(pair).collect()
}

/// Reads the name and the size of an image.
fn image(value: &Value) -> Option<ImageNote> {
    let name = value.get("name")?.as_str()?.to_owned();
    let side = |name: &str| value.get(name).and_then(whole);
    Some(ImageNote::new(name, crate::geometry::Frame::new(side("width")?, side("height")?)))
}
