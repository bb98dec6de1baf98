//! Composes files for other programs. The model is read here; a thread composes and writes.

use std::path::{Path, PathBuf};

use super::order::{ExportKind, ExportOrder, ReportFormat};
use super::trust::{result_note, shown_in_words, trust_note};
use crate::app::model::Model;
use crate::app::model::document::{Given, Role, Side, counted};
use crate::app::model::rectified::RectifyQuestion;
use crate::camera::PicturesOf;
use crate::estimate::PlaneHomography;
use crate::geometry::PointPair;
use crate::io::{
    CalibratedNote, ColmapError, GeometryFile, ImageNote, OutputFile, PairLabel, PairOrigin, PairRow,
    ResultFile, UndistortedFiles, barcode_table, cloud_as_ply, fundamental_as_npy, line_table, pair_table,
    refuse_clashes, report_in_words,
};
use crate::presentation::{focal_lengths_in_words, pose_in_words};
use crate::rectify::Limits;
use crate::study::PoseOutcome;

impl ExportKind {
    /// Returns the reason why this cannot be exported now, if there is one.
    pub fn missing(self, model: &Model) -> Option<&'static str> {
        let is_apart = model.shown().is_some() && model.geometry_to_write().is_none();
        let shows_result = model.shown().is_none_or(|shown| shown.is_result());
        let (there, why) = match self {
            Self::Array if model.open.undistorted().is_some() => (
                false,
                "An array has no room for the lens that F belongs to. Choose Geometry or Without distortion.",
            ),
            Self::Undistorted => (
                model.open.undistorted().is_some() && model.geometry_to_write().is_some(),
                "No lens is corrected, or there is no geometry yet.",
            ),
            Self::Geometry | Self::Array | Self::Rectified | Self::Colmap if is_apart => {
                (false, "The pictures probably show different scenes, so there is no geometry to write.")
            }
            Self::Colmap if model.open.undistorted().is_some() && !shows_result => {
                (false, "With the lens corrected, COLMAP needs the pose of the result. Show the result (R).")
            }
            Self::Geometry | Self::Array | Self::Colmap => {
                (model.shown().is_some(), "There is no geometry yet: click two point pairs, or import one.")
            }
            Self::Plane => (
                plane(model).is_some(),
                "The result is not limited to one plane or a rotation of the camera.",
            ),
            Self::Pairs | Self::Table => (!model.document.pairs.is_empty(), "There are no point pairs yet."),
            Self::Cloud => (
                model.scene().is_some(),
                "There are no 3-D points: they need focal lengths or a calibration, and a determined epipole.",
            ),
            Self::Report => (model.result().is_some(), "There is no result yet: click two point pairs."),
            Self::Profile => (
                model.inspected_barcodes().is_some()
                    || model.open.inspection.as_ref().is_some_and(|found| !found.samples().is_empty()),
                "No line pair is inspected: click two point pairs, or pin a line pair with the inspect tool (I).",
            ),
            Self::Figure | Self::View => (model.document.pictures.is_some(), "No images are open."),
            Self::Rectified => {
                (model.shown().is_some(), "There is nothing to rectify yet: click two point pairs first.")
            }
        };
        (!there).then_some(why)
    }

    /// Returns whether to offer this export. The rare ones are hidden for most pairs of images.
    pub fn is_offered(self, model: &Model) -> bool {
        let is_rare = matches!(self, Self::Plane | Self::Undistorted);
        !is_rare || self.missing(model).is_none()
    }
}

/// A function that composes the bytes of a file.
pub type ExportContent = Box<dyn FnOnce() -> Result<Vec<u8>, String> + Send>;

/// Returns the composer of a file, and a short description of the file. Figures, pictures of the
/// screen and rectified pairs are made elsewhere. `rectified` supplies the rectifying homographies. The error says why
/// there is nothing to export.
pub fn content(
    order: &ExportOrder,
    model: &Model,
    rectified: Option<RectifyQuestion>,
) -> Result<(ExportContent, String), String> {
    if let Some(missing) = order.what.missing(model) {
        return Err(missing.to_owned());
    }
    let nothing = || "There is nothing to export yet: open two images first.".to_owned();
    let images = notes(model).ok_or_else(nothing)?;
    let format = order.format;
    let pictures_of = model.open.pictures_of();
    let mut file = GeometryFile { images: Some(images.clone()), ..GeometryFile::of(pictures_of.clone()) };
    if matches!(order.what, ExportKind::Geometry | ExportKind::Pairs | ExportKind::Table) {
        file.pairs = pairs(model, order.with_matches);
        file.labels = labels(model, order.with_matches);
    }
    if order.what == ExportKind::Pairs && pictures_of.is_undistorted() {
        // Pairs alone are places in the pictures.
        file.pairs = file.pairs.iter().map(|pair| model.open.pixels_of(pair)).collect();
        file.pictures = PicturesOf::Original;
        for (note, side) in file.images.iter_mut().flatten().zip(Side::BOTH) {
            note.frame = model.open.shown_frame(side).unwrap_or(note.frame);
        }
    }
    match order.what {
        ExportKind::Geometry => file.trust = trust_note(model),
        ExportKind::Plane => file.trust = result_note(model),
        _ => {}
    }
    let text = |text: String| -> ExportContent { Box::new(move || Ok(text.into_bytes())) };
    Ok(match order.what {
        ExportKind::Geometry => {
            file.fundamental = model.shown().map(|shown| *shown.fundamental);
            let is_result = model.shown().is_some_and(|shown| shown.is_result());
            if let Some(scene) = model.scene().filter(|_| is_result) {
                file.add_cameras(scene.views(), &scene.fit);
            }
            let what = format!("F and {}", counted(file.pairs.len()));
            let content: ExportContent = Box::new(move || {
                file.homographies = rectified.and_then(|question| homographies(&question));
                Ok(file.to_text(format).into_bytes())
            });
            (content, what)
        }
        ExportKind::Array => {
            let array = fundamental_as_npy(model.shown().ok_or_else(nothing)?.fundamental, &pictures_of);
            let array = array.map_err(|problem| format!("The array was not written: {problem}."))?;
            (Box::new(move || Ok(array)), "F as a NumPy array".to_owned())
        }
        ExportKind::Plane => {
            file.homography21 = plane(model).map(|plane| plane.homography21);
            (text(file.to_text(format)), "the homography of the plane".to_owned())
        }
        ExportKind::Pairs => (text(file.to_text(format)), counted(file.pairs.len())),
        ExportKind::Table => (text(table(model)), format!("a table of {}", counted(file.pairs.len()))),
        ExportKind::Cloud => {
            let cloud = &model.scene().ok_or_else(nothing)?.cloud;
            let note = result_note(model);
            (text(cloud_as_ply(cloud, note.as_ref())), format!("{} scene points", cloud.points.len()))
        }
        ExportKind::Report => {
            let report = report(order.reported, model, &images).ok_or_else(nothing)?;
            (text(report), "the report of the result".to_owned())
        }
        ExportKind::Profile => {
            let trust = trust_note(model);
            if let (Some(inspected), Some(compared)) =
                (model.inspected_barcodes(), model.compared_recordings())
            {
                let table =
                    barcode_table(&inspected.barcodes, inspected.first, compared.offset, trust.as_ref());
                return Ok((text(table), "the barcodes of the inspected line pair".to_owned()));
            }
            let inspection = model.open.inspection.as_ref().ok_or_else(nothing)?;
            (
                text(line_table(inspection, &pictures_of, trust.as_ref())),
                "the profile of the inspected line pair".to_owned(),
            )
        }
        ExportKind::Figure
        | ExportKind::View
        | ExportKind::Colmap
        | ExportKind::Rectified
        | ExportKind::Undistorted => {
            return Err("This is drawn, not composed.".to_owned());
        }
    })
}

/// Returns the homography of the plane, if only that is certain.
fn plane(model: &Model) -> Option<PlaneHomography> {
    model.result().and_then(|estimate| estimate.assessment.plane)
}

/// Returns the task that draws the pictures without distortion into a folder. `None` without a lens or a geometry.
pub fn undistorted(
    model: &Model,
    folder: PathBuf,
) -> Option<impl FnOnce() -> Result<String, String> + use<>> {
    let pictures = model.open.pictures()?;
    let geometry = GeometryFile {
        fundamental: Some(*model.shown()?.fundamental),
        pairs: pairs(model, true),
        labels: labels(model, true),
        images: notes(model),
        trust: trust_note(model),
        ..GeometryFile::of(model.open.pictures_of())
    };
    Some(move || {
        let inputs: Vec<&Path> = pictures.iter().filter_map(|picture| picture.path.as_deref()).collect();
        let files = UndistortedFiles::prepare(&folder, &inputs).map_err(|error| error.to_string())?;
        let drawn = pictures.each_ref().map(|picture| &**picture);
        files.write(drawn, geometry).map_err(|error| error.to_string())?;
        Ok("the pictures without distortion and their geometry".to_owned())
    })
}

/// Returns the task that adds the shown geometry to a copy of a database of COLMAP, as `epiline convert` does with a
/// result. The copy replaces none of the files `inputs`. `None` without a geometry.
pub fn colmap(
    order: &ExportOrder,
    model: &Model,
    mut inputs: Vec<PathBuf>,
) -> Option<impl FnOnce() -> Result<String, String> + use<>> {
    let shown = model.shown()?;
    let result = Some(shown.estimate).filter(|_| shown.is_result());
    let mut file = GeometryFile {
        fundamental: Some(*shown.fundamental),
        homography21: plane(model).filter(|_| result.is_some()).map(|plane| plane.homography21),
        pairs: pairs(model, false),
        found: model.matched_pairs().collect(),
        images: notes(model),
        ..GeometryFile::of(model.open.pictures_of())
    };
    file.calibrated = model.open.views().map(|views| {
        let pose = result.map(|result| PoseOutcome::new(result, &views));
        let note = CalibratedNote::new(pose.as_ref().and_then(PoseOutcome::fit));
        note.seen_by(&views, file.pairs.iter().chain(&file.found))
    });
    let (path, database) = (order.path.clone(), order.database.clone());
    Some(move || {
        let output = OutputFile::prepare(&path).map_err(|error| error.to_string())?;
        inputs.push(database.clone());
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        refuse_clashes(&[output.path()], &inputs).map_err(|error| error.to_string())?;
        let added = file.add_to_colmap(None, &database, &output).map_err(|error| match error {
            ColmapError::Names(_) => {
                format!("{error}. Open the two pictures under the names that they have in the database")
            }
            ColmapError::Read(_) | ColmapError::Write(_) => error.to_string(),
        })?;
        Ok(format!("{added},"))
    })
}

fn notes(model: &Model) -> Option<[ImageNote; 2]> {
    let pictures = model.document.pictures.as_ref()?;
    let open = model.open.pictures();
    Some([0, 1].map(|k| ImageNote {
        interpretation: open.as_ref().map(|open| open[k].interpretation).unwrap_or_default(),
        ..ImageNote::new(pictures[k].name.clone(), pictures[k].frame)
    }))
}

/// Returns the pairs that are not excluded, followed by the matches of the result if wanted.
fn pairs(model: &Model, with_matches: bool) -> Vec<PointPair> {
    let found = model.matched_pairs().filter(|_| with_matches);
    model.document.included().chain(found).collect()
}

/// Returns the pairs that are not excluded as a table, in the order of the list.
fn table(model: &Model) -> String {
    let document = &model.document;
    let included =
        document.labels().zip((0..document.pairs.len()).filter(|k| !document.excluded.contains(k)));
    let rows: Vec<PairRow> = included
        .map(|(label, k)| PairRow {
            pair: model.open.pixels_of(&document.pairs[k]),
            label,
            role: if document.role(k) == Role::Used { "used" } else { "check only" },
            distance: model.pair_distance(k),
        })
        .collect();
    pair_table(&rows, model.open.undistorted().is_some(), trust_note(model).as_ref())
}

/// Returns names and origins of the exported pairs, in the same order.
fn labels(model: &Model, with_matches: bool) -> Vec<PairLabel> {
    let found = if with_matches { model.matches().len() } else { 0 };
    let automatic = PairLabel { name: String::new(), origin: PairOrigin::Automatic };
    model.document.labels().chain(std::iter::repeat_n(automatic, found)).collect()
}

/// Returns the homographies of a planar rectification. A polar one has none.
fn homographies(question: &RectifyQuestion) -> Option<[nalgebra::Matrix3<f64>; 2]> {
    let rectification = question.rectification(&Limits::default()).ok()?;
    let [left, right] = rectification.maps.each_ref().map(|map| map.homography().copied());
    Some([left?, right?])
}

fn report(reported: ReportFormat, model: &Model, images: &[ImageNote; 2]) -> Option<String> {
    let estimate = model.result()?;
    let pictures_of = model.open.pictures_of();
    let pairs = pairs(model, false);
    Some(match reported {
        ReportFormat::Json => {
            let file = ResultFile::new(estimate, &pairs, images, &model.document.parameters, &pictures_of);
            let offset = model.compared_recordings().map(|compared| compared.offset);
            let given: Vec<PointPair> = model.document.given.iter().flat_map(Given::pairs).copied().collect();
            let mut file = file.at_offset(offset).labelled(&labels(model, false)).with_given(&given);
            file = result_note(model).iter().fold(file, ResultFile::told);
            let views = model.open.undistorted().or_else(|| model.open.posed_views());
            if let Some(views) = &views {
                file = file.calibrated(views, model.scene().map(|scene| &scene.fit), None);
            }
            serde_json::to_string_pretty(&file).ok()? + "\n"
        }
        ReportFormat::Text => {
            let pairs: Vec<_> = pairs.into_iter().zip(labels(model, false)).collect();
            let shown = model.shown().and_then(|shown| shown_in_words(model, &shown));
            let pose = model.scene().map_or_else(String::new, |scene| {
                focal_lengths_in_words(scene.views()) + &pose_in_words(&scene.fit)
            });
            let note = result_note(model);
            report_in_words(estimate, images, &pairs, &pictures_of, shown.as_deref(), note.as_ref()) + &pose
        }
    })
}
