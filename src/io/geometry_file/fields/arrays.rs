//! Matrices and matches in arrays: of NumPy, and nested lists of JSON and YAML.

use serde_json::{Map, Value};

use super::{Fields, NumberTable, opencv_matrix, table};
use crate::camera::PicturesOf;
use crate::foreign::excerpt;
use crate::io::npy::Array;
use crate::io::read::Problem;
use crate::io::values::{MatrixName, NamedArray, Quantity, concerns_matches, matches_of, shape_in_words};

/// Maximum number of names in a message.
const MOST_NAMES: usize = 8;

/// Returns the table of an array of one or two sides.
fn table_of(array: &Result<Array, String>) -> Result<NumberTable, String> {
    let array = array.as_ref().map_err(Clone::clone)?;
    match *array.batchless() {
        [count] => NumberTable::new(1, count, array.numbers.clone()),
        [rows, columns] => NumberTable::new(rows, columns, array.numbers.clone()),
        _ => Err(format!("the array has the shape {}", shape_in_words(&array.shape))),
    }
}

/// Returns the arrays of numbers of an object.
pub(super) fn named_arrays(object: &Map<String, Value>) -> Vec<NamedArray> {
    let named = |(name, value): (&String, &Value)| {
        let array = array_of(value)?;
        concerns_matches(name).then(|| (name.clone(), Ok(array)))
    };
    object.iter().filter_map(named).collect()
}

/// Returns an array of one, two or three sides.
pub(super) fn array_of(value: &Value) -> Option<Array> {
    fn fill(value: &Value, depth: usize, array: &mut Array) -> Option<()> {
        let Some(list) = value.as_array() else {
            array.numbers.push(value.as_f64()?);
            return (depth == array.shape.len()).then_some(());
        };
        if array.numbers.is_empty() && depth == array.shape.len() && depth < 4 {
            array.shape.push(list.len());
        }
        let is_regular = array.shape.get(depth) == Some(&list.len());
        is_regular.then(|| list.iter().try_for_each(|value| fill(value, depth + 1, array)))?
    }
    if let Value::Object(_) = value {
        let NumberTable { rows, columns, numbers } = opencv_matrix(value).ok()?;
        return Some(Array { shape: vec![rows, columns], numbers });
    }
    let mut array = Array { shape: Vec::new(), numbers: Vec::new() };
    value.as_array()?;
    fill(value, 0, &mut array).map(|()| array)
}

/// Gathers the tables below a name that no quantity has, in maps within maps too.
pub(super) fn matrices_in(name: &str, value: &Value, found: &mut Vec<(String, NumberTable)>) {
    match value {
        Value::Object(object) if !object.contains_key("data") => {
            for (inner, value) in object {
                matrices_in(&format!("{name}.{inner}"), value, found);
            }
        }
        Value::Number(_) | Value::String(_) => {}
        _ => found.extend(table(value).ok().map(|table| (name.to_owned(), table))),
    }
}

impl Fields {
    /// Reads the arrays of an archive, by their names or by their shapes.
    pub(in crate::io) fn from_arrays(arrays: &[NamedArray]) -> Result<Self, Problem> {
        let mut fields = Self::default();
        let mut others = Vec::new();
        for (name, array) in arrays {
            if name == PicturesOf::UNDISTORTED {
                fields.pictures.read(name, &Value::Bool(true)).map_err(Problem::whole)?;
                continue;
            }
            let quantity = Quantity::named(name).filter(|quantity| !quantity.is_points());
            match (quantity, table_of(array)) {
                (Some(quantity), table) => {
                    let table = table.map_err(|e| Problem::whole(format!("{name}: {e}")))?;
                    fields.add(quantity, table)?;
                }
                (None, Ok(table)) => others.push((name.clone(), table)),
                (None, Err(_)) => {}
            }
        }
        fields.add_matches(arrays);
        fields.add_named_matrix(&others);
        if fields.is_empty() && fields.not_fundamental.is_none() {
            let unread = arrays.iter().find_map(|(name, array)| {
                let problem = array.as_ref().err()?;
                Some(if name.is_empty() { problem.clone() } else { format!("{name}: {problem}") })
            });
            let names: Vec<&str> = arrays.iter().map(|(name, _)| &**name).take(MOST_NAMES).collect();
            fields.not_fundamental = Some(unread.unwrap_or_else(|| match names[..] {
                [] => "there are no arrays in it".to_owned(),
                _ => format!(
                    "there are no matches and no fundamental matrix among its arrays {}. Expected mkpts0 and mkpts1, keypoints0, keypoints1 and matches, or F",
                    excerpt(&names.join(", "))
                ),
            }));
        }
        Ok(fields)
    }

    /// Adds the matches in arrays with the names of matchers.
    pub(super) fn add_matches(&mut self, arrays: &[NamedArray]) {
        match matches_of(arrays) {
            Ok(found) => self.matches = found,
            Err(problem) => self.no_matches = Some(problem),
        }
    }

    /// Adds `F` from matrices with names that no [`Quantity`] has: the one named like a fundamental matrix, or else
    /// the only one of nine numbers in a file without point pairs.
    pub(super) fn add_named_matrix(&mut self, others: &[(String, NumberTable)]) {
        if self.table(Quantity::Fundamental).is_some() || self.table(Quantity::Camera1).is_some() {
            return;
        }
        let named = |name: MatrixName| {
            // A table of fewer numbers is no matrix: `f` is a focal length.
            let is_matrix = move |table: &NumberTable| match name {
                MatrixName::Fundamental => table.numbers.len() > 3,
                _ => table.matrix(3, 3).is_ok(),
            };
            let of_name = others.iter().filter(move |(other, _)| MatrixName::of(other) == name);
            of_name.filter(move |(_, table)| is_matrix(table)).collect::<Vec<_>>()
        };
        let [own, other, unknown] =
            [MatrixName::Fundamental, MatrixName::Other, MatrixName::Unknown].map(named);
        let has_pairs = self.matches.is_some() || self.no_matches.is_some() || !self.is_empty();
        let (found, is_told) = match (&own[..], &unknown[..]) {
            ([], [found]) if other.is_empty() && !has_pairs => (*found, true),
            ([found], _) => (*found, false),
            ([], []) if other.is_empty() => return,
            ([], _) if has_pairs => return,
            _ => {
                let listed = if own.is_empty() { [&unknown[..], &other[..]].concat() } else { own.clone() };
                let names: Vec<&str> = listed.iter().map(|(name, _)| &**name).take(MOST_NAMES).collect();
                let names = excerpt(&names.join(", "));
                self.not_fundamental = Some(format!(
                    "none of its matrices is called F: {names}. Give the fundamental matrix this name"
                ));
                if own.len() > 1 {
                    self.not_fundamental =
                        Some(format!("it has several fundamental matrices: {names}. Leave one of them"));
                }
                return;
            }
        };
        let (name, table) = found;
        if is_told && !name.is_empty() {
            self.notes.push(format!("the matrix {} was read as F", excerpt(name)));
        }
        self.tables.push((Quantity::Fundamental, table.clone()));
    }
}
