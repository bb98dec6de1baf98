//! The pictures that a file belongs to: `pictures` and, without distortion, both views.
//!
//! JSON has `"pictures": "undistorted"` and two `views`; YAML, plain text and MATLAB have `view1` and `view2`. A
//! view has `model`, `coefficients`, `centre`, `matrix`, `width`, `height`, `original_matrix`, `original_width` and
//! `original_height`. Results have the views in `calibrated`.

use std::fmt::Write;

use nalgebra::Matrix3;
use serde_json::{Map, Value, json};

use super::coordinates::numbers;
use super::mapping::{Language, mapping};
use crate::camera::{CameraModel, Lens, PicturesOf, UndistortedView, ViewPair};
use crate::foreign::excerpt;
use crate::geometry::Frame;
use crate::io::number::finite_number;

/// Numbers of a view: name, columns of a row (0 for a whole number), and the values.
type Entry = (&'static str, usize, Vec<f64>);

/// Returns the model of the lens and the numbers of a view, with pixels counted from `origin`.
fn entries(view: &UndistortedView, origin: f64) -> (&'static str, Vec<Entry>) {
    let (model, coefficients) = view.camera().lens().named();
    let rows = |mut matrix: Matrix3<f64>| {
        matrix[(0, 2)] += origin;
        matrix[(1, 2)] += origin;
        matrix.transpose().as_slice().to_vec()
    };
    let own = view.camera().calibration();
    let side = |side: usize| vec![side as f64];
    let (frame, original) = (view.frame(), view.original());
    let all = vec![
        ("coefficients", coefficients.len().max(1), coefficients),
        ("centre", 2, vec![own[(0, 2)] + origin, own[(1, 2)] + origin]),
        ("matrix", 3, rows(*view.calibration())),
        ("width", 0, side(frame.width)),
        ("height", 0, side(frame.height)),
        ("original_matrix", 3, rows(own)),
        ("original_width", 0, side(original.width)),
        ("original_height", 0, side(original.height)),
    ];
    (model.name(), all)
}

/// Returns the views, with their numbers from 1.
fn numbered(pictures: &PicturesOf) -> impl Iterator<Item = (usize, &UndistortedView)> {
    (1..).zip(pictures.views().into_iter().flat_map(|views| &views.views))
}

pub(super) fn as_yaml(pictures: &PicturesOf) -> String {
    let Some(name) = pictures.name() else { return String::new() };
    let mut text = format!("pictures: {name}\n");
    for (k, view) in numbered(pictures) {
        let (model, entries) = entries(view, 0.0);
        let _ = write!(text, "view{k}:\n   model: \"{model}\"\n");
        for (name, columns, values) in entries {
            if columns == 0 {
                let _ = writeln!(text, "   {name}: {}", values[0]);
                continue;
            }
            let _ = write!(
                text,
                "   {name}: !!opencv-matrix\n      rows: {}\n      cols: {columns}\n      dt: d\n      data: [ {} ]\n",
                values.len() / columns,
                numbers(&values, ", ")
            );
        }
    }
    if let Some(views) = pictures.views() {
        // Comments keep the code beside the numbers.
        for line in mapping(views, Language::Python, 0.0).lines() {
            let _ = writeln!(text, "# {line}");
        }
    }
    text
}

pub(super) fn as_text(pictures: &PicturesOf) -> String {
    let Some(name) = pictures.name() else { return String::new() };
    let mut text = format!("pictures {name}\n");
    for (k, view) in numbered(pictures) {
        let (model, entries) = entries(view, 0.0);
        let _ = write!(text, "view{k} model {model}");
        for (name, columns, values) in entries {
            let values = if columns == 0 { values[0].to_string() } else { numbers(&values, " ") };
            let _ = write!(text, " {name} {values}");
        }
        text.push('\n');
    }
    text
}

pub(super) fn as_matlab(pictures: &PicturesOf, origin: f64) -> String {
    let Some(name) = pictures.name() else { return String::new() };
    let mut text = format!("pictures = '{name}';\n");
    for (k, view) in numbered(pictures) {
        let (model, entries) = entries(view, origin);
        let _ = write!(text, "view{k} = struct('model', '{model}'");
        for (name, columns, values) in entries {
            let rows =
                values.chunks(columns.max(1)).map(|row| numbers(row, ", ")).collect::<Vec<_>>().join("; ");
            let _ = write!(text, ", '{name}', [{rows}]");
        }
        text.push_str(");\n");
    }
    if let Some(views) = pictures.views() {
        text += &mapping(views, Language::Matlab, origin);
    }
    text
}

/// Returns whether a line of plain text names the pictures or describes a view.
pub(super) fn is_named(row: &str) -> bool {
    matches!(row.split_whitespace().next(), Some("pictures" | "view1" | "view2"))
}

/// Reads the numbers of a value, row by row.
type Numbers<'a> = &'a dyn Fn(&Value) -> Option<Vec<f64>>;

/// What a file tells of its pictures.
#[derive(Debug, Clone, Default)]
pub(super) struct PicturesRead {
    name: Option<String>,
    views: [Option<Value>; 2],
    /// Mark of older files.
    is_marked: bool,
}

impl PicturesRead {
    /// Takes a field of an object, and returns whether it is one of these.
    pub(super) fn read(&mut self, name: &str, value: &Value) -> Result<bool, String> {
        match (name, value) {
            ("pictures", Value::String(pictures)) => self.name = Some(pictures.clone()),
            ("pictures", other) => {
                return Err(format!("pictures: {} is no name of pictures", excerpt(&other.to_string())));
            }
            ("undistorted", value) => {
                self.is_marked |= *value == Value::Bool(true) || value.as_u64() == Some(1);
            }
            ("views", value) => self.take(value),
            ("calibrated", value) => {
                let views = value.get("views").unwrap_or(&Value::Null);
                self.is_marked |= views.as_array().is_some_and(|views| {
                    views.iter().any(|view| view.get("is_original") == Some(&false.into()))
                });
                self.take(views);
            }
            ("view1", value) => self.views[0] = Some(value.clone()),
            ("view2", value) => self.views[1] = Some(value.clone()),
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn take(&mut self, views: &Value) {
        for (place, view) in self.views.iter_mut().zip(views.as_array().into_iter().flatten()) {
            *place = Some(view.clone());
        }
    }

    /// Takes a line of plain text: `pictures NAME`, or `view1` and pairs of names and numbers.
    pub(super) fn read_row(&mut self, row: &str) -> Result<(), String> {
        let mut words = row.split_whitespace();
        let head = words.next().unwrap_or_default();
        if head == "pictures" {
            return self.read(head, &json!(words.next().unwrap_or_default())).map(|_| ());
        }
        let mut fields = Map::new();
        let mut name = None;
        for word in words {
            if name == Some("model") {
                fields.insert("model".to_owned(), json!(word));
                name = None;
            } else if word.starts_with(|c: char| c.is_ascii_alphabetic()) {
                if word != "model" {
                    fields.insert(word.to_owned(), json!([]));
                }
                name = Some(word);
            } else if let Some(Value::Array(numbers)) = name.and_then(|name| fields.get_mut(name)) {
                numbers.push(json!(finite_number(word)?));
            }
        }
        self.read(head, &Value::Object(fields)).map(|_| ())
    }

    /// Returns the pictures.
    ///
    /// # Errors
    /// A clause for the user: an unknown name, or a view that is not complete.
    pub(super) fn known(&self, numbers: Numbers) -> Result<PicturesOf, String> {
        let is_undistorted = match self.name.as_deref() {
            Some(PicturesOf::UNDISTORTED) => true,
            Some(PicturesOf::ORIGINAL) if !self.is_marked => return Ok(PicturesOf::Original),
            None => self.is_marked,
            Some(other) => {
                return Err(format!(
                    "its pictures are called {}. Known are {} and {}",
                    excerpt(other),
                    PicturesOf::ORIGINAL,
                    PicturesOf::UNDISTORTED
                ));
            }
        };
        if !is_undistorted {
            return Ok(PicturesOf::Untold);
        }
        let [Some(first), Some(second)] = &self.views else { return Ok(PicturesOf::Undistorted(None)) };
        Ok(PicturesOf::Undistorted(
            view(first, numbers)
                .zip(view(second, numbers))
                .map(|(first, second)| Box::new(ViewPair { views: [first, second] })),
        ))
    }
}

/// Reads a view. `None` for an unknown lens and for missing or impossible numbers.
fn view(value: &Value, numbers: Numbers) -> Option<UndistortedView> {
    let matrix = |name: &str| {
        let entries = numbers(value.get(name)?)?;
        (entries.len() == 9).then(|| Matrix3::from_row_slice(&entries))
    };
    let side = |name: &str| {
        let [number] = numbers(value.get(name)?)?[..] else { return None };
        (number >= 1.0 && number.fract() == 0.0 && number <= f64::from(u32::MAX)).then_some(number as usize)
    };
    let coefficients = match value.get("coefficients")? {
        Value::Array(none) if none.is_empty() => Vec::new(),
        Value::Object(empty) if empty.get("data") == Some(&json!([])) => Vec::new(),
        other => numbers(other)?,
    };
    let lens = Lens::of_model(value.get("model")?.as_str()?, &coefficients)?;
    let camera = CameraModel::new(&matrix("original_matrix")?, lens)?;
    let original = Frame::new(side("original_width")?, side("original_height")?);
    UndistortedView::described(
        camera,
        original,
        matrix("matrix")?,
        Frame::new(side("width")?, side("height")?),
    )
}
