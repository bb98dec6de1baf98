//! Geometry files as input and output of commands.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::calibration::CalibrationArguments;
use super::console::{print, tell};
use super::output::Output;
use crate::camera::PicturesOf;
use crate::estimate::Match;
use crate::foreign::shown_path;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::Picture;
use crate::io::{
    CalibratedCamera, Format, GeometryFile, ImageNote, MatchFile, OutputFile, cloud_as_ply,
    fundamental_as_npy, refuse_clashes,
};
use crate::presentation::lenses_in_words;

/// Source of a geometry.
#[derive(Debug, Args)]
pub(super) struct GeometryInput {
    /// File with F, two cameras or a stereo calibration, in any format; or the camera (.P) or the calibration
    /// of image 1
    file: PathBuf,
    /// Camera (.P) or calibration of image 2
    camera2: Option<PathBuf>,
    /// File with point pairs: rows of x1 y1 x2 y2, or any of the formats
    #[arg(long, value_name = "FILE")]
    matches: Option<PathBuf>,
    #[command(flatten)]
    calibration: CalibrationArguments,
    /// Both images, for their names and sizes
    #[arg(long, num_args = 2, value_names = ["LEFT", "RIGHT"])]
    images: Option<Vec<PathBuf>>,
}

impl GeometryInput {
    /// Reads the geometry and returns the format of the file. Separate matches and images replace
    /// those in the file.
    pub(super) fn read(&self) -> Result<(GeometryFile, Format), CliError> {
        let (mut file, format) = match &self.camera2 {
            Some(camera2) => match GeometryFile::read_cameras([&self.file, camera2]) {
                Ok((_, file)) => (file, Format::Text),
                Err(error) => {
                    let files = CalibrationArguments::of_files([&self.file, camera2]);
                    let pair = files.read().ok().flatten();
                    let file = pair.and_then(|pair| GeometryFile::of_calibration(&pair)).ok_or(error)?;
                    (file, Format::OpencvYaml)
                }
            },
            None => GeometryFile::read(&self.file)?,
        };
        tell_remarks(&self.file, &file.remarks);
        if let Some(matches) = &self.matches {
            let pairs = read_matches(matches)?.into_iter().map(|found| found.pair).collect();
            file.pairs = in_pictures_of(&file.pictures, pairs)
                .ok_or_else(|| CliError::Arguments(format!(
                    "{} belongs to pictures without distortion, which it does not describe, so the matches of the \
                     pictures have no place in it. Export it again",
                    shown_path(&self.file)
                )))?;
        }
        if let Some([left, right]) = self.images.as_deref() {
            file.images = Some([&Picture::open(left)?, &Picture::open(right)?].map(ImageNote::from));
        }
        if let Some(cameras) = self.calibration.read()? {
            let missing = || {
                CliError::Arguments(format!(
                    "a calibration makes F of an essential matrix, and {} has none",
                    shown_path(&self.file)
                ))
            };
            let frames = file.images.as_ref().map(|images| images.each_ref().map(|image| image.frame));
            let cameras = self.calibration.scaled(cameras, frames)?;
            CalibratedCamera::check_settled(&cameras).map_err(CliError::Arguments)?;
            file = file.calibrated_essential(&cameras).ok_or_else(missing)?;
            tell_remarks(&self.file, &file.remarks);
        }
        Ok((file, format))
    }

    pub(super) fn inputs(&self) -> Vec<&Path> {
        let images = self.images.iter().flatten();
        let files = [&self.file].into_iter().chain(&self.camera2).chain(&self.matches).chain(images);
        files.map(PathBuf::as_path).chain(self.calibration.files()).collect()
    }

    pub(super) fn path(&self) -> &Path {
        &self.file
    }
}

/// Reads matches, and tells what was read and what was left out.
pub(super) fn read_matches(path: &Path) -> Result<Vec<Match>, CliError> {
    let file = MatchFile::read(path)?;
    tell_remarks(path, &file.remarks);
    Ok(file.matches)
}

/// Tells that matches lie outside the pictures, if so: they may belong to pictures of another size.
pub(super) fn tell_outside(matches: &[Match], frames: [Frame; 2]) {
    let outside = matches.iter().filter(|found| !found.pair.is_inside(frames)).count();
    if outside > 0 {
        tell(format_args!(
            "note: {outside} of the {} given matches lie outside the pictures. They may belong to pictures of another size",
            matches.len()
        ));
    }
}

/// Tells how a file was read.
pub(super) fn tell_remarks(path: &Path, remarks: &[String]) {
    for remark in remarks {
        tell(format_args!("note: {}: {remark}", shown_path(path)));
    }
}

/// Returns point pairs of the pictures as they are in the pictures of a file. Pairs beyond the range of a lens
/// are left out. `None` for unknown views.
fn in_pictures_of(pictures: &PicturesOf, pairs: Vec<PointPair>) -> Option<Vec<PointPair>> {
    if !pictures.is_undistorted() {
        return Some(pairs);
    }
    let views = pictures.views()?;
    Some(pairs.iter().filter_map(|pair| views.undistorted_from_original(pair)).collect())
}

/// Reads a geometry for pictures that keep their distortion. A geometry of views without distortion
/// is refused.
pub(super) fn read_geometry(path: &Path) -> Result<(FundamentalMatrix, GeometryFile), CliError> {
    let (fundamental, file) = GeometryFile::read_geometry(path)?;
    tell_remarks(path, &file.remarks);
    if file.pictures.is_undistorted() {
        return Err(CliError::Arguments(format!(
            "{} belongs to pictures without distortion ({}), not to these. Draw such pictures with epiline estimate \
             --undistorted DIR, and use them with the geometry beside them",
            shown_path(path),
            lenses_in_words(&file.pictures)
        )));
    }
    Ok((fundamental, file))
}

/// Destination of a geometry: a file, checked before the work, or standard output.
#[derive(Debug)]
pub(super) struct GeometryOutput {
    /// Output file; `None` is standard output.
    file: Option<OutputFile>,
    content: Content,
}

/// Content of an output.
#[derive(Debug, Clone, Copy)]
enum Content {
    /// The geometry in a geometry format.
    Geometry(Format),
    /// F as a NumPy array.
    Array,
    /// F, R and t with their covariances as a NumPy archive.
    Covariances,
    /// Scene points and cameras as PLY.
    Cloud,
}

impl Content {
    /// Returns the content for a format or, without one, for a file extension.
    fn new(path: &Path, format: Option<Format>) -> Option<Self> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match (format, extension.as_deref()) {
            (None, Some("npy")) => Some(Self::Array),
            (None, Some("npz")) => Some(Self::Covariances),
            (None, Some("ply")) => Some(Self::Cloud),
            _ => format.or_else(|| Format::of_path(path)).map(Self::Geometry),
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Geometry(format) => format.label(),
            Self::Array => "NumPy array of F",
            Self::Covariances => "NumPy archive of covariances",
            Self::Cloud => "PLY",
        }
    }
}

impl GeometryOutput {
    /// Prepares an output. Without `format`, the file extension decides.
    pub(super) fn prepare(path: &Path, format: Option<Format>) -> Result<Self, CliError> {
        let is_piped = path == Path::new("-");
        let content = Content::new(path, format).ok_or_else(|| {
            let known = Format::ALL.map(|f| format!("{} (.{})", f.name(), f.extension())).join(", ");
            CliError::Arguments(format!(
                "the format is not clear from the name {}. Add --format with one of {known}",
                shown_path(path)
            ))
        })?;
        Ok(Self { file: if is_piped { None } else { Some(OutputFile::prepare(path)?) }, content })
    }

    /// Prepares the geometry of a command beside its JSON and text. `option` names the option of the
    /// geometry. Fails if the outputs would overwrite each other or an input.
    pub(super) fn prepare_beside(
        json: Option<&Path>,
        (option, path, format): (&str, Option<&Path>, Option<Format>),
        inputs: &[&Path],
    ) -> Result<(Output, Option<Self>), CliError> {
        let output = Output::prepare(json)?;
        let geometry = path.map(|path| Self::prepare(path, format)).transpose()?;
        if geometry.as_ref().is_some_and(Self::is_piped) && matches!(output, Output::Piped) {
            return Err(CliError::Arguments(format!("--json and {option} cannot both be -")));
        }
        let outputs = output.file().into_iter().chain(geometry.as_ref().and_then(Self::file));
        refuse_clashes(&outputs.collect::<Vec<_>>(), inputs)?;
        Ok((output, geometry))
    }

    pub(super) fn file(&self) -> Option<&Path> {
        self.file.as_ref().map(OutputFile::path)
    }

    pub(super) fn is_cloud(&self) -> bool {
        matches!(self.content, Content::Cloud)
    }

    /// Returns whether the output is standard output, which then has no other use.
    pub(super) fn is_piped(&self) -> bool {
        self.file.is_none()
    }

    pub(super) fn place(&self) -> String {
        let label = self.content.label();
        match &self.file {
            Some(file) => format!("{} ({label})", shown_path(file.path())),
            None => format!("standard output ({label})"),
        }
    }

    /// Writes the geometry, with a note if the target program cannot use the file name.
    pub(super) fn write(&self, file: &GeometryFile) -> Result<(), CliError> {
        let content = match self.content {
            Content::Geometry(format) => file.to_text(format).into_bytes(),
            Content::Array => {
                let missing = "there is no F, and a NumPy array holds nothing else";
                let geometry = file.geometry().ok_or_else(|| CliError::Arguments(missing.into()))?;
                fundamental_as_npy(&geometry, &file.pictures).map_err(CliError::Arguments)?
            }
            Content::Cloud => {
                let missing = "there are no scene points. Make them with epiline estimate --calibration … --export cloud.ply";
                let cloud = file.cloud.as_ref().ok_or_else(|| CliError::Arguments(missing.into()))?;
                cloud_as_ply(cloud, file.trust.as_ref()).into_bytes()
            }
            Content::Covariances => file.covariances_as_npz().map_err(CliError::Arguments)?,
        };
        let Some(output) = &self.file else { return print(&String::from_utf8_lossy(&content)) };
        output.write(&content)?;
        if let Content::Geometry(format) = self.content
            && let Some(note) = format.note_on_name(output.path())
        {
            tell(format_args!("note: {note}"));
        }
        Ok(())
    }
}
