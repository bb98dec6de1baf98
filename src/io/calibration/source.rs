//! Content of a calibration file: named values, or cameras of a format of its own.

use std::io::{Cursor, Read};

use serde_json::{Map, Value};
use zip::ZipArchive;

use super::super::npy::Array;
use super::super::number::{cells, finite_numbers, rows};
use super::super::values::{is_xml, xml_value, yaml_value};
use super::fields::fields;
use super::names::Role;
use super::{CalibratedCamera, NoCalibration, cameras, kalibr, tables, zed};
use crate::foreign::excerpt;

/// Content of a file.
pub(super) enum Source {
    /// Named values.
    Tree(Value),
    /// Cameras of KITTI, Middlebury or COLMAP.
    Cameras(Vec<CalibratedCamera>),
}

/// Largest array of an archive that is read, bytes. Calibrations have a few numbers; the corners of a board
/// beside them are left out when they are larger.
const MOST_BYTES: u64 = 16 << 20;
/// Least focal length of a matrix without a name, over its principal point: as much sees 168°. Shifts and changes of size
/// have smaller ones.
const LEAST_FOCAL: f64 = 0.1;
/// How MATLAB writes a calibration for other programs.
const MATLAB: &str = "this is a MATLAB file. Save the calibration as JSON in MATLAB: f = fopen('calibration.json', \
    'w'); fprintf(f, '%s', jsonencode(toStruct(stereoParams))); fclose(f)";

impl Source {
    /// Reads a file. `name` is its name without extension.
    ///
    /// # Errors
    /// A clause for the user.
    pub fn of_bytes(bytes: Vec<u8>, name: &str) -> Result<Self, String> {
        if bytes.starts_with(b"MATLAB ") || bytes.starts_with(b"\x89HDF\r\n") {
            return Err(MATLAB.into());
        }
        if bytes.starts_with(b"PK") {
            return archive(bytes);
        }
        if bytes.starts_with(b"\x93NUMPY") {
            let array = Array::parse(&bytes)?;
            return Ok(Self::Tree(Value::Object(Map::from_iter([(name.to_owned(), of_array(&array))]))));
        }
        if bytes.starts_with(b"\x80") {
            return Err(
                "this may be a Python pickle, which is not read. Save the arrays with numpy.savez".into()
            );
        }
        let text = String::from_utf8(bytes).map_err(|_| "this is not a text file")?;
        Self::of_text(text.strip_prefix('\u{feff}').unwrap_or(&text))
    }

    /// Reads a text; its content tells the format.
    ///
    /// # Errors
    /// A clause for the user.
    pub fn of_text(text: &str) -> Result<Self, String> {
        let first = rows(text).next().map_or("", |(_, row)| row);
        let has = |is_row: fn(&str) -> bool| rows(text).any(|(_, row)| is_row(row));
        Ok(if is_xml(text) {
            Self::Tree(xml_value(text).map_err(|problem| problem.problem)?)
        } else if first.starts_with('{') || first.starts_with("[{") || first == "[" {
            Self::Tree(serde_json::from_str(text).map_err(|e| format!("this is not valid JSON: {e}"))?)
        } else if has(|row| row.starts_with("cam0=[")) {
            Self::Cameras(tables::middlebury(text)?)
        } else if tables::is_kitti(text) {
            Self::Cameras(tables::kitti(text)?)
        } else if tables::is_colmap(first) {
            Self::Cameras(tables::colmap(text)?)
        } else if let Some(named) = bare_matrices(text) {
            Self::Tree(named)
        } else if text.contains("oST version") || has(|row| row == "camera matrix") {
            Self::Tree(ost(text)?)
        } else if has(zed::is_section) {
            Self::Cameras(zed::cameras(&sections(text)?)?)
        } else if first.starts_with('[') || has(is_section) {
            let value = toml::from_str(text);
            match (value, sections(text)) {
                (Ok(value), _) | (Err(_), Ok(value)) => Self::Tree(value),
                (Err(e), Err(_)) => return Err(format!("this is not valid TOML: {}", e.message())),
            }
        } else if !text.trim_start().starts_with("%YAML") && has(is_assignment) {
            Self::Tree(assignments(text)?)
        } else {
            Self::Tree(yaml_value(&spaced(text)).map_err(|problem| problem.problem)?)
        })
    }

    /// Returns the cameras.
    pub fn cameras(&self) -> Result<Vec<CalibratedCamera>, NoCalibration> {
        let root = match self {
            Self::Cameras(cameras) => return Ok(cameras.clone()),
            Self::Tree(root) => root,
        };
        if !root.is_object() && !root.is_array() {
            return Err(NoCalibration::NoCamera("there are no named values in it".into()));
        }
        // Geometry files of this program describe the views of their pictures.
        if root.get("pictures").is_some() {
            return Err(NoCalibration::NoCamera(
                "it is a geometry of two pictures, and no calibration".into(),
            ));
        }
        match kalibr::kalibr(root).map_err(NoCalibration::Wrong)? {
            Some(chain) => Ok(chain),
            None => cameras::cameras(root),
        }
    }

    /// Joins the named values of two files. `None` if a file has a format of its own.
    ///
    /// # Errors
    /// A clause for the user, if the same name has different numbers in both.
    pub fn merged(sources: &[Self]) -> Result<Option<Self>, String> {
        let mut both = Map::new();
        for source in sources {
            let Self::Tree(Value::Object(root)) = source else { return Ok(None) };
            for (name, value) in root {
                let is_used = || {
                    let alone = Value::Object(Map::from_iter([(name.clone(), value.clone())]));
                    fields(&alone).iter().any(|f| {
                        !matches!(f.meaning.role, Role::Harmless | Role::Unknown) && !f.numbers().is_empty()
                    })
                };
                match both.get(name) {
                    Some(other) if other != value && is_used() => {
                        return Err(format!("{} has other numbers in the other file", excerpt(name)));
                    }
                    Some(_) => {}
                    None => _ = both.insert(name.clone(), value.clone()),
                }
            }
        }
        Ok(Some(Self::Tree(Value::Object(both))))
    }
}

/// Returns the calibration matrices of a text without names, with names: one 3×3 matrix, or one for each camera.
fn bare_matrices(text: &str) -> Option<Value> {
    let numbers: Vec<Vec<f64>> =
        rows(text).map(|(_, row)| finite_numbers(row).ok()).collect::<Option<_>>()?;
    let is_calibration = |matrix: &[Vec<f64>]| match matrix {
        [first, second, third] => {
            let [&[fx, _, cx], &[lower, fy, cy]] = [first, second].map(Vec::as_slice) else { return false };
            let is_camera = |focal: f64, principal: f64| principal > 0.0 && focal > LEAST_FOCAL * principal;
            is_camera(fx, cx) && is_camera(fy, cy) && lower == 0.0 && third == &[0.0, 0.0, 1.0]
        }
        _ => false,
    };
    let matrices: Vec<&[Vec<f64>]> = numbers.chunks(3).collect();
    let names: &[&str] = match matrices.len() {
        1 => &["K"],
        2 => &["K1", "K2"],
        _ => return None,
    };
    let named =
        names.iter().zip(&matrices).map(|(name, matrix)| ((*name).to_owned(), Value::from(matrix.to_vec())));
    matrices.iter().all(|matrix| is_calibration(matrix)).then(|| Value::Object(named.collect()))
}

/// Reads a NumPy archive. Arrays of other kinds, such as texts, are left out.
fn archive(bytes: Vec<u8>) -> Result<Source, String> {
    let damaged = |e: zip::result::ZipError| format!("the archive is damaged: {e}");
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let mut root = Map::new();
    for k in 0..archive.len() {
        let file = archive.by_index(k).map_err(damaged)?;
        let name = file.name().map_err(damaged)?;
        let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else { continue };
        let mut content = Vec::new();
        let read = file.take(MOST_BYTES + 1).read_to_end(&mut content);
        read.map_err(|e| format!("{} cannot be unpacked: {e}", excerpt(&name)))?;
        let value = match Array::parse(&content) {
            _ if content.len() as u64 > MOST_BYTES => continue,
            Ok(array) => of_array(&array),
            // A list that cannot be read is told if its name has a role.
            Err(problem) => Value::Array(vec![Value::String(problem)]),
        };
        root.insert(name, value);
    }
    if root.is_empty() {
        Err("there are no NumPy arrays in it".into())
    } else {
        Ok(Source::Tree(root.into()))
    }
}

fn of_array(array: &Array) -> Value {
    // A number that is not finite becomes null, which no list of numbers may have.
    let mut numbers: Vec<Value> = array.numbers.iter().map(|v| Value::from(*v)).collect();
    if array.shape.is_empty() && numbers.len() == 1 { numbers.remove(0) } else { Value::Array(numbers) }
}

/// Reads the text of ROS's calibrator: sections, and headings above rows of numbers.
fn ost(text: &str) -> Result<Value, String> {
    let mut root = Map::new();
    let (mut section, mut heading) = (String::new(), String::new());
    for (line, row) in rows(text) {
        if let Some(name) = row.strip_prefix('[').and_then(|row| row.strip_suffix(']')) {
            (section, heading) = (name.to_owned(), String::new());
        } else if let Ok(numbers) = finite_numbers(row) {
            let of_section = root.entry(&section).or_insert_with(|| Value::Object(Map::new()));
            let Some(of_section) = of_section.as_object_mut() else { continue };
            let list = of_section.entry(&heading).or_insert_with(|| Value::Array(Vec::new()));
            let Some(list) = list.as_array_mut() else { continue };
            // The size stands before each camera.
            if section == "image" && !list.is_empty() {
                if *list != numbers.iter().map(|v| Value::from(*v)).collect::<Vec<_>>() {
                    return Err(format!(
                        "line {line}: the cameras have different sizes. Use a file for each"
                    ));
                }
                continue;
            }
            if heading.is_empty() || list.len() + numbers.len() > 16 {
                return Err(format!("line {line}: there is no name for these numbers"));
            }
            list.extend(numbers.into_iter().map(Value::from));
        } else {
            row.clone_into(&mut heading);
        }
    }
    // Width and height are single numbers.
    let image = root.remove("image");
    for (name, value) in image.iter().flat_map(|image| image.as_object().into_iter().flatten()) {
        if let Some([side]) = value.as_array().map(Vec::as_slice) {
            root.insert(name.clone(), side.clone());
        }
    }
    Ok(Value::Object(root))
}

/// Reads sections of `name=number` lines, as of ZED.
fn sections(text: &str) -> Result<Value, String> {
    let mut root = Map::new();
    let mut section = String::new();
    for (line, row) in rows(text).filter(|(_, row)| !row.starts_with(';')) {
        if let Some(name) = row.strip_prefix('[').and_then(|row| row.strip_suffix(']')) {
            name.clone_into(&mut section);
            continue;
        }
        let (name, value) =
            row.split_once('=').ok_or_else(|| format!("line {line}: expected NAME=NUMBER"))?;
        let value = match finite_numbers(value).as_deref() {
            Ok([number]) => Value::from(*number),
            Ok(numbers) => Value::from(numbers),
            Err(_) => Value::String(value.trim().to_owned()),
        };
        let of_section = root.entry(&section).or_insert_with(|| Value::Object(Map::new()));
        if let Some(of_section) = of_section.as_object_mut()
            && of_section.insert(name.trim().to_owned(), value).is_some()
        {
            return Err(format!("line {line}: {} is there twice", excerpt(name.trim())));
        }
    }
    Ok(Value::Object(root))
}

/// Returns whether a row begins the assignment of a matrix: `K = [`, `dist = np.array([`.
fn is_assignment(row: &str) -> bool {
    let Some((name, value)) = row.split_once('=') else { return false };
    let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let opens = ["[", "np.array(", "numpy.array(", "array(", "torch.tensor("];
    let name = name.trim();
    !name.is_empty() && name.chars().all(is_name) && opens.iter().any(|open| value.trim().starts_with(open))
}

/// Reads assignments of matrices, in MATLAB's notation or in Python's.
fn assignments(text: &str) -> Result<Value, String> {
    let mut root = Map::new();
    let mut rest = text.lines();
    while let Some(line) = rest.next() {
        let line = line.trim();
        if line.is_empty() || line.starts_with(['#', '%']) || line.starts_with("//") {
            continue;
        }
        if !is_assignment(line) {
            // A number, a word or a call is no matrix.
            if let Some((name, value)) = line.split_once('=')
                && let Ok([number]) = finite_numbers(value.trim_end_matches(';')).as_deref()
            {
                root.insert(name.trim().to_owned(), Value::from(*number));
            }
            continue;
        }
        let Some((name, value)) = line.split_once('=') else { continue };
        let mut value = value.to_owned();
        let depth = |text: &str| text.matches('[').count() as i64 - text.matches(']').count() as i64;
        while depth(&value) > 0 {
            let Some(next) = rest.next() else {
                return Err(format!("{}: ] is missing", excerpt(name.trim())));
            };
            value.push(' ');
            value.push_str(next);
        }
        let inside = value.find('[').zip(value.rfind(']')).map_or("", |(a, b)| &value[a..b]);
        let plain: String = inside.chars().map(|c| if "[]()".contains(c) { ' ' } else { c }).collect();
        let numbers: Vec<f64> = cells(&plain)
            .map(super::super::number::finite_number)
            .collect::<Result<_, _>>()
            .map_err(|e| format!("{}: {e}", excerpt(name.trim())))?;
        if root.insert(name.trim().to_owned(), Value::from(numbers)).is_some() {
            return Err(format!("{} is there twice", excerpt(name.trim())));
        }
    }
    Ok(Value::Object(root))
}

/// Returns whether a row opens a section of TOML.
fn is_section(row: &str) -> bool {
    row.starts_with('[') && row.ends_with(']') && row.chars().nth(1).is_some_and(char::is_alphabetic)
}

/// Adds the space after a colon that `cv::FileStorage` does without: `data:[1, 2]`.
fn spaced(text: &str) -> String {
    if !text.trim_start().starts_with("%YAML") {
        return text.to_owned();
    }
    let line = |line: &str| {
        let name = line.trim_start().split(':').next().unwrap_or("");
        let is_name = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || "_.-".contains(c));
        let end = line.len() - line.trim_start().len() + name.len();
        match line.get(end..).and_then(|rest| rest.strip_prefix(':')) {
            Some(value) if is_name && !value.is_empty() && !value.starts_with([' ', '\t']) => {
                format!("{}: {value}\n", &line[..end])
            }
            _ => format!("{line}\n"),
        }
    };
    // The first line is `%YAML:1.0`, which is no name.
    text.lines().map(line).collect()
}
