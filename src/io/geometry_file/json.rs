//! JSON with the field names of a result of `epiline estimate`. JSON written by OpenCV is read too.

use std::fmt::{self, Formatter};

use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::coordinates::{WrittenGeometry, pair_numbers};
use super::fields::{Fields, insert};
use super::quantity::Quantity;
use super::{ImageNote, Problem};

#[derive(Serialize)]
struct File<'a> {
    convention: Vec<String>,
    #[serde(flatten)]
    matrices: Map<String, Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pairs: Vec<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    images: Option<&'a [ImageNote; 2]>,
    /// Whether the numbers belong to views without distortion.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    undistorted: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    self_check: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<&'a str>,
    /// Reasons of the verdict, names and origins of the pairs.
    #[serde(flatten)]
    words: Map<String, Value>,
}

pub(super) fn write(written: &WrittenGeometry) -> String {
    let value = |quantity, rows: &[Vec<f64>]| match quantity {
        Quantity::Epipole1 | Quantity::Epipole2 => json!(rows.concat()),
        _ => json!(rows),
    };
    let file = File {
        convention: written.preamble(),
        matrices: written
            .matrices
            .iter()
            .map(|m| (m.quantity.word().to_owned(), value(m.quantity, &m.rows)))
            .collect(),
        pairs: written.pairs.iter().map(pair_numbers).collect(),
        images: written.images,
        undistorted: written.is_undistorted,
        self_check: written
            .check
            .map(|c| json!({ "pairs": c.pairs, "mean_distance": c.mean, "max_distance": c.max })),
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
    Fields::from_value(&value)
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
