//! Both images with their overlays as a figure for a paper.
//!
//! The overlays draw onto a sheet as they do in the window. The resulting list of shapes becomes
//! the SVG or the PDF.

mod font;
mod pdf;
mod pieces;
mod sheet;
mod svg;

use super::panes::PanePlace;
use crate::app::model::Model;
use crate::app::model::exchange::{ExportContent, FigureChoices, FigureFormat};

/// Composes a figure of the images and the visible overlays. `panes` are the views of the images.
pub fn figure(
    model: &Model,
    panes: [Option<PanePlace>; 2],
    choices: &FigureChoices,
) -> Option<ExportContent> {
    let sheet = sheet::sheet(model, panes, choices)?;
    let format = choices.format;
    Some(Box::new(move || match format {
        FigureFormat::Svg => svg::write(&sheet),
        FigureFormat::Pdf => pdf::write(&sheet),
    }))
}
