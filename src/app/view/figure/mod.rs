//! Both images with what is drawn over them as a figure for a paper.
//!
//! The overlays draw as they do in the window, but onto a sheet of paper: what they drew is one list, from which the SVG
//! and the PDF come.

mod font;
mod pdf;
mod pieces;
mod sheet;
mod svg;

use super::panes::PanePlace;
use crate::app::model::Model;
use crate::app::model::exchange::{ExportContent, FigureChoices, FigureFormat};

/// Composes a figure of the images and the overlays that are shown, as a file. `panes` are what is seen of them.
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
