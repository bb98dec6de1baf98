//! JSON with the field names of a result of `epiline estimate`. JSON written by OpenCV is read too.

use std::fmt::{self, Formatter};

use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3};
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::content::CalibratedNote;
use super::coordinates::{NamedTable, WrittenGeometry};
use super::fields::{Fields, table};
use super::{ImageNote, Problem};
use crate::camera::{PicturesOf, RelativePose};
use crate::estimate::Verdict;
use crate::geometry::{Frame, PointPair};
use crate::io::values::{Quantity, insert};

#[derive(Serialize)]
struct File<'a> {
    convention: Vec<String>,
    #[serde(flatten)]
    matrices: Map<String, Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pairs: Vec<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    images: Option<&'a [ImageNote; 2]>,
    /// Pictures that the coordinates belong to, and their views without distortion.
    #[serde(flatten)]
    pictures: &'a PicturesOf,
    #[serde(skip_serializing_if = "Option::is_none")]
    self_check: Option<Value>,
    /// What the geometry is.
    #[serde(skip_serializing_if = "Option::is_none")]
    geometry: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<&'a str>,
    /// Reasons of the verdict, names and origins of the pairs.
    #[serde(flatten)]
    words: Map<String, Value>,
}

pub(super) fn write(written: &WrittenGeometry) -> String {
    let value = |NamedTable { quantity, columns, values }: &NamedTable| match quantity {
        Quantity::Epipole1 | Quantity::Epipole2 => json!(values),
        _ => values.chunks(*columns).collect(),
    };
    let file = File {
        convention: written.preamble(),
        matrices: written.matrices.iter().map(|m| (m.quantity.word().to_owned(), value(m))).collect(),
        pairs: written.pairs.iter().map(PointPair::numbers).collect(),
        images: written.images,
        pictures: written.pictures,
        self_check: written
            .check
            .map(|c| json!({ "pairs": c.pairs, "mean_distance": c.mean, "max_distance": c.max })),
        geometry: written.trust.map(|trust| trust.geometry.as_str()),
        verdict: written.trust.map(|trust| trust.verdict.as_str()),
        words: written.words().into_iter().map(|(name, words)| (name.to_owned(), json!(words))).collect(),
    };
    let mut text = serde_json::to_string_pretty(&file).expect("names are texts and no number is refused");
    text.push('\n');
    text
}

pub(super) fn read(text: &str) -> Result<Fields, Problem> {
    let value = if text.trim_start().starts_with('{') {
        serde_json::from_str::<Object>(text).map(|object| Value::Object(object.0))
    } else {
        serde_json::from_str(text)
    };
    let value = value.map_err(|e| {
        Problem::whole(if e.is_data() { e.to_string() } else { format!("this is not valid JSON: {e}") })
    })?;
    let mut fields = Fields::from_value(&value)?;
    fields.covariance =
        value.get("covariance").and_then(|rows| numbers(rows, 9, 9)).map(|n| SMatrix::from_row_slice(&n));
    fields.calibrated = value.get("calibrated").map(calibrated);
    let verdict = value.get("verdict").and_then(Value::as_str).unwrap_or_default();
    // Results have the verdict as a name, exports of the window in words.
    fields.is_of_different_scenes = verdict.replace('-', " ") == Verdict::DifferentScenes.label();
    Ok(fields)
}

/// Reads the calibrated part of a result. Anything else is left out.
fn calibrated(value: &Value) -> CalibratedNote {
    let pose = &value["pose"];
    let side = |k: usize, name: &str| Some(value["views"][k][name].as_u64()? as usize);
    let frame = |k| Some(Frame::new(side(k, "original_width")?, side(k, "original_height")?));
    let pair = |value: &Value| match numbers(value, 1, 4)?[..] {
        [x1, y1, x2, y2] => Some(PointPair::new(x1, y1, x2, y2)),
        _ => None,
    };
    let originals = ["original_pairs", "original_matches"].iter().filter_map(|name| value[name].as_array());
    CalibratedNote {
        frames: frame(0).zip(frame(1)).map(<[Frame; 2]>::from),
        originals: originals.flatten().map(pair).collect(),
        pose: relative_pose(pose),
        pose_covariance: numbers(&pose["covariance"], 6, 6).map(|n| SMatrix::from_row_slice(&n)),
    }
}

fn relative_pose(value: &Value) -> Option<RelativePose> {
    let rotation = Matrix3::from_row_slice(&numbers(&value["rotation"], 3, 3)?);
    let translation = Vector3::from_row_slice(&numbers(&value["translation"], 1, 3)?);
    let is_rotation =
        (rotation.transpose() * rotation - Matrix3::identity()).norm() < 1e-6 && rotation.determinant() > 0.0;
    let is_unit = (translation.norm() - 1.0).abs() < 1e-6;
    (is_rotation && is_unit)
        .then(|| RelativePose { rotation: Rotation3::from_matrix_unchecked(rotation), translation })
}

/// Returns the numbers of a matrix of a given shape, row by row.
fn numbers(value: &Value, rows: usize, columns: usize) -> Option<Vec<f64>> {
    table(value).ok()?.matrix(rows, columns).ok().map(<[f64]>::to_vec)
}

/// Object of the file. [`Value`] would silently keep the last of repeated names.
struct Object(Map<String, Value>);

impl<'de> Deserialize<'de> for Object {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ObjectVisitor;

        impl<'de> Visitor<'de> for ObjectVisitor {
            type Value = Object;

            fn expecting(&self, text: &mut Formatter) -> fmt::Result {
                text.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Object, A::Error> {
                let mut object = Map::new();
                while let Some((name, value)) = entries.next_entry()? {
                    insert(&mut object, name, value).map_err(A::Error::custom)?;
                }
                Ok(Object(object))
            }
        }

        deserializer.deserialize_map(ObjectVisitor)
    }
}
