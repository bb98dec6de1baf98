//! Figures for papers: two images with lines and text over them, as SVG or PDF.
//!
//! Lengths are in points, x right, y down, from the upper left corner of the sheet.

mod font;
mod pdf;
mod svg;

use image::DynamicImage;

use super::geometry_file::TrustNote;

pub use self::font::FigureFont;
pub use self::pdf::write_pdf;
pub use self::svg::write_svg;

/// Red, green, blue and alpha, not premultiplied. Alpha 0 is invisible.
pub type FigureColor = [u8; 4];

/// Place and size of a rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureArea {
    /// Upper left corner.
    pub at: [f32; 2],
    pub size: [f32; 2],
}

/// A line along an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureStroke {
    pub width: f32,
    pub color: FigureColor,
}

/// A shape over an image.
#[derive(Debug, Clone, PartialEq)]
pub enum FigureShape {
    Line([[f32; 2]; 2], FigureStroke),
    Circle {
        centre: [f32; 2],
        radius: f32,
        fill: FigureColor,
        stroke: FigureStroke,
    },
    /// A rectangle, all of whose corners are rounded alike.
    Rect {
        area: FigureArea,
        rounding: f32,
        fill: FigureColor,
        stroke: FigureStroke,
    },
    Path {
        points: Vec<[f32; 2]>,
        /// Whether the last corner is joined to the first.
        closed: bool,
        fill: FigureColor,
        stroke: FigureStroke,
    },
    /// Text in one row.
    Text {
        /// Start of the text on the baseline.
        at: [f32; 2],
        size: f32,
        color: FigureColor,
        words: String,
    },
}

/// An image on the sheet, with the shapes over it.
pub struct FigurePicture {
    /// Visible part of the sheet. It clips the pixels and the shapes.
    pub area: FigureArea,
    /// Pixels, with colours premultiplied by alpha.
    pub pixels: DynamicImage,
    /// Place of the pixels.
    pub place: FigureArea,
    /// Whether single pixels can be told apart.
    pub is_magnified: bool,
    pub shapes: Vec<FigureShape>,
}

/// The whole content of a figure.
pub struct Figure {
    pub title: String,
    /// What the geometry is, with its verdict.
    pub trust: Option<TrustNote>,
    pub size: [f32; 2],
    pub background: FigureColor,
    pub pictures: [FigurePicture; 2],
}
