//! A folder with both pictures drawn without the distortion of their lens, and the geometry that belongs to
//! them.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::geometry_file::{Format, GeometryFile, ImageNote};
use super::identity::refuse_clashes;
use super::output::OutputFile;
use super::picture_file::{PictureFormat, encode_picture};
use super::rectified::{RectifiedError, create_folder};
use crate::camera::PicturesOf;
use crate::image::Picture;

/// Files of pictures without distortion, found writable.
#[derive(Debug)]
pub struct UndistortedFiles {
    pictures: [OutputFile; 2],
    geometry: OutputFile,
}

/// Names of the drawn pictures.
const NAMES: [&str; 2] = ["left.png", "right.png"];

impl UndistortedFiles {
    /// Creates the folder if necessary and checks, before the work, that `left.png`, `right.png` and
    /// `geometry.json` can be written. `inputs` are files that none of them replaces.
    pub fn prepare(folder: &Path, inputs: &[&Path]) -> Result<Self, RectifiedError> {
        create_folder(folder)?;
        let file = |name: &str| OutputFile::prepare(&folder.join(name));
        let [left, right] = NAMES;
        let files = Self { pictures: [file(left)?, file(right)?], geometry: file("geometry.json")? };
        refuse_clashes(&files.paths(), inputs)?;
        Ok(files)
    }

    /// Writes both pictures, drawn without distortion, and the geometry of their views. `geometry.json` names the
    /// drawn pictures, and `drawn_from` in it has the lens and the names of the pictures they were drawn from.
    pub fn write(&self, drawn: [&Picture; 2], geometry: GeometryFile) -> Result<(), RectifiedError> {
        let mut staged = Vec::new();
        for (file, picture) in self.pictures.iter().zip(drawn) {
            staged.push(file.stage(&encode_picture(&picture.pixels, PictureFormat::Png)?)?);
        }
        let names = geometry.images.as_ref().map(|images| images.each_ref().map(|image| image.name.clone()));
        let failed = |error: serde_json::Error| RectifiedError::Encode(error.to_string());
        let mut origin = serde_json::to_value(&geometry.pictures).map_err(failed)?;
        origin["images"] = json!(names);
        let images = [0, 1].map(|k| ImageNote::new(NAMES[k].to_owned(), drawn[k].frame()));
        // In the drawn pictures, all coordinates are those of the pictures as they are.
        let own = GeometryFile { images: Some(images), pictures: PicturesOf::Original, ..geometry };
        let mut file: Value = serde_json::from_str(&own.to_text(Format::Json)).map_err(failed)?;
        file["drawn_from"] = origin;
        let text = serde_json::to_string_pretty(&file).map_err(failed)? + "\n";
        staged.push(self.geometry.stage(text.as_bytes())?);
        for file in staged {
            file.put()?;
        }
        Ok(())
    }

    /// Returns the paths of all files, in the order of writing.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.pictures.iter().chain([&self.geometry]).map(|file| file.path().to_owned()).collect()
    }
}
