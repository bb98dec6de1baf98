//! Both images with their overlays as a figure for a paper.
//!
//! The overlays draw onto a sheet as they do in the window. The resulting list of shapes becomes
//! the SVG or the PDF.

mod pieces;
mod sheet;

use egui::FontFamily;

use super::panes::PanePlace;
use super::theme;
use crate::app::model::Model;
use crate::app::model::exchange::{ExportContent, FigureChoices, FigureFormat};
use crate::io::{FigureFont, write_pdf, write_svg};

/// Composes a figure of the images and the visible overlays. `panes` are the views of the images.
pub fn figure(
    model: &Model,
    panes: [Option<PanePlace>; 2],
    choices: &FigureChoices,
) -> Option<ExportContent> {
    let sheet = sheet::sheet(model, panes, choices)?;
    let format = choices.format;
    Some(Box::new(move || match format {
        FigureFormat::Svg => write_svg(&sheet.figure()),
        FigureFormat::Pdf => write_pdf(&sheet.figure(), fonts()),
    }))
}

fn fonts() -> Vec<FigureFont> {
    let mut fonts = theme::fonts();
    let names = fonts.families.remove(&FontFamily::Proportional).unwrap_or_default();
    let font = |name: &String| {
        let data = fonts.font_data.get(name)?;
        Some(FigureFont {
            file: (*data.font).as_ref().to_vec(),
            index: data.index,
            scale: data.tweak.scale,
            drop: [data.tweak.y_offset, data.tweak.y_offset_factor],
        })
    };
    names.iter().filter_map(font).collect()
}
