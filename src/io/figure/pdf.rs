//! The figure as PDF: one page of the sheet's size, with lossless images, vector lines and text,
//! and embedded fonts.

use std::collections::BTreeMap;

use image::{DynamicImage, RgbImage};
use pdf_writer::types::Predictor;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Ref, Str, TextStr};

use super::font::{FigureFont, Fonts};
use super::{Figure, FigureArea, FigureColor, FigurePicture, FigureShape, FigureStroke};
use crate::io::picture_file::{PictureFormat, encode_picture};

/// Distance of the Bézier handles of a quarter circle from its ends, in radii.
const QUARTER: f32 = 0.552_285;

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const ABOUT: Ref = Ref::new(5);
const IMAGES: [Ref; 2] = [Ref::new(6), Ref::new(7)];
/// Object of the first opacity; the fonts follow the opacities.
const OPACITIES: i32 = 8;
const IMAGE_NAMES: [Name; 2] = [Name(b"Left"), Name(b"Right")];

/// Returns the figure as PDF. Each letter has the first of these fonts that has it.
pub fn write_pdf(figure: &Figure, fonts: Vec<FigureFont>) -> Result<Vec<u8>, String> {
    let mut pdf = Pdf::new();
    let fonts = Fonts::new(fonts);
    let [width, height] = figure.size;
    let mut page = Page { content: Content::new(), opacities: BTreeMap::new(), fonts };
    // PDF has its origin at the lower left, with y upwards; the sheet has it at the upper left.
    page.content.transform([1.0, 0.0, 0.0, -1.0, 0.0, height]);
    page.fill(figure.background);
    page.content.rect(0.0, 0.0, width, height).fill_nonzero();
    for (k, picture) in figure.pictures.iter().enumerate() {
        let FigurePicture { area, pixels, place, shapes, .. } = picture;
        image(&mut pdf, IMAGES[k], &on_paper(pixels, figure.background))?;
        page.content.save_state().rect(area.at[0], area.at[1], area.size[0], area.size[1]);
        page.content.clip_nonzero().end_path();
        // A PDF image fills the unit square upright, so this undoes the flip of the page.
        let (below, FigureArea { at, size }) = (place.at[1] + place.size[1], place);
        page.content.save_state().transform([size[0], 0.0, 0.0, -size[1], at[0], below]);
        page.content.x_object(IMAGE_NAMES[k]).restore_state();
        for shape in shapes {
            page.shape(shape);
        }
        page.content.restore_state();
    }
    let Page { content, opacities, fonts } = page;
    pdf.stream(CONTENT, &content.finish());
    for ((painted, alpha), (number, _)) in &opacities {
        let share = f32::from(*alpha) / 255.0;
        let mut state = pdf.ext_graphics(Ref::new(OPACITIES + number));
        match painted {
            Painted::Inside => state.non_stroking_alpha(share),
            Painted::Line => state.stroking_alpha(share),
        };
    }
    let fonts = fonts.embed(&mut pdf, OPACITIES + opacities.len() as i32)?;
    pdf.catalog(CATALOG).pages(PAGES);
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let mut written = pdf.page(PAGE);
    written.media_box(pdf_writer::Rect::new(0.0, 0.0, width, height));
    written.parent(PAGES).contents(CONTENT);
    let mut resources = written.resources();
    resources.x_objects().pairs(IMAGE_NAMES.into_iter().zip(IMAGES));
    resources.fonts().pairs(fonts.iter().map(|(name, at)| (Name(name.as_bytes()), *at)));
    let mut states = resources.ext_g_states();
    for (number, name) in opacities.values() {
        states.pair(Name(name.as_bytes()), Ref::new(OPACITIES + number));
    }
    states.finish();
    resources.finish();
    written.finish();
    let mut about = pdf.document_info(ABOUT);
    about.title(TextStr(&figure.title));
    about.creator(TextStr(concat!("epiline ", env!("CARGO_PKG_VERSION"))));
    if let Some(trust) = &figure.trust {
        about.subject(TextStr(&trust.in_words()));
    }
    about.finish();
    Ok(pdf.finish())
}

/// The page and the resources it uses: fonts, and opacities of fills and strokes, each with a
/// number and a name.
struct Page {
    content: Content,
    opacities: BTreeMap<(Painted, u8), (i32, String)>,
    fonts: Fonts,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Painted {
    Inside,
    Line,
}

impl Page {
    fn shape(&mut self, shape: &FigureShape) {
        const NONE: FigureColor = [0; 4];
        match shape {
            FigureShape::Line([[x1, y1], [x2, y2]], stroke) => self.paint(NONE, *stroke, |content| {
                content.move_to(*x1, *y1).line_to(*x2, *y2);
            }),
            FigureShape::Circle { centre: [x, y], radius, fill, stroke } => {
                let square = FigureArea { at: [x - radius, y - radius], size: [2.0 * radius; 2] };
                self.paint(*fill, *stroke, |content| rounded(content, &square, *radius));
            }
            FigureShape::Rect { area, rounding, fill, stroke } => {
                let rounding = rounding.min(area.size[0] / 2.0).min(area.size[1] / 2.0);
                self.paint(*fill, *stroke, |content| rounded(content, area, rounding));
            }
            FigureShape::Path { points, closed, fill, stroke } => {
                let Some(([x, y], rest)) = points.split_first() else { return };
                self.paint(*fill, *stroke, |content| {
                    content.move_to(*x, *y);
                    for [x, y] in rest {
                        content.line_to(*x, *y);
                    }
                    if *closed {
                        content.close_path();
                    }
                });
            }
            FigureShape::Text { at, size, color, words } => self.letters(*at, *size, *color, words),
        }
    }

    /// Fills and strokes a path. The colours come first: PDF allows nothing between a path and its
    /// painting operator.
    fn paint(&mut self, fill: FigureColor, stroke: FigureStroke, path: impl FnOnce(&mut Content)) {
        let (filled, drawn) = (fill[3] > 0, stroke.width > 0.0 && stroke.color[3] > 0);
        if filled {
            self.fill(fill);
        }
        if drawn {
            self.stroke(stroke);
        }
        if filled || drawn {
            path(&mut self.content);
        }
        match (filled, drawn) {
            (false, false) => {}
            (true, false) => drop(self.content.fill_nonzero()),
            (false, true) => drop(self.content.stroke()),
            (true, true) => drop(self.content.fill_nonzero_and_stroke()),
        }
    }

    fn letters(&mut self, [x, y]: [f32; 2], size: f32, color: FigureColor, words: &str) {
        self.fill(color);
        let runs = self.fonts.write(words);
        // The text matrix undoes the flip of the page. Each run starts where the previous one ends.
        self.content.begin_text().set_text_matrix([1.0, 0.0, 0.0, -1.0, x, y]);
        for run in &runs {
            let (font, size, rise) = self.fonts.style(run, size);
            self.content.set_font(Name(font.as_bytes()), size).set_rise(rise).show(Str(&run.codes));
        }
        self.content.end_text();
    }

    fn fill(&mut self, color: FigureColor) {
        let [red, green, blue, alpha] = shares(color);
        self.opacity(Painted::Inside, alpha);
        self.content.set_fill_rgb(red, green, blue);
    }

    fn stroke(&mut self, stroke: FigureStroke) {
        let [red, green, blue, alpha] = shares(stroke.color);
        self.opacity(Painted::Line, alpha);
        self.content.set_stroke_rgb(red, green, blue).set_line_width(stroke.width);
    }

    fn opacity(&mut self, painted: Painted, share: f32) {
        let number = self.opacities.len() as i32;
        let alpha = (share * 255.0).round() as u8;
        let fresh = || (number, format!("{painted:?}{alpha}"));
        let (_, name) = self.opacities.entry((painted, alpha)).or_insert_with(fresh);
        self.content.set_parameters(Name(name.as_bytes()));
    }
}

fn shares(color: FigureColor) -> [f32; 4] {
    color.map(|v| f32::from(v) / 255.0)
}

/// Describes a rectangle with rounded corners. It is a circle if its size is twice the radius.
fn rounded(content: &mut Content, area: &FigureArea, radius: f32) {
    let FigureArea { at: [left, top], size: [width, height] } = *area;
    if radius <= 0.0 {
        content.rect(left, top, width, height);
        return;
    }
    let (right, bottom, handle) = (left + width, top + height, radius * (1.0 - QUARTER));
    content.move_to(left + radius, top).line_to(right - radius, top);
    content.cubic_to(right - handle, top, right, top + handle, right, top + radius);
    content.line_to(right, bottom - radius);
    content.cubic_to(right, bottom - handle, right - handle, bottom, right - radius, bottom);
    content.line_to(left + radius, bottom);
    content.cubic_to(left + handle, bottom, left, bottom - handle, left, bottom - radius);
    content.line_to(left, top + radius);
    content.cubic_to(left, top + handle, left + handle, top, left + radius, top).close_path();
}

/// Blends transparent pixels with the colour of the paper.
fn on_paper(pixels: &DynamicImage, paper: FigureColor) -> RgbImage {
    let pixels = pixels.to_rgba8();
    RgbImage::from_fn(pixels.width(), pixels.height(), |x, y| {
        // Colours are premultiplied by alpha.
        let [colors @ .., alpha] = pixels.get_pixel(x, y).0;
        let rest = 255 - u32::from(alpha);
        image::Rgb(std::array::from_fn(|k| {
            (u32::from(colors[k]) + (u32::from(paper[k]) * rest + 127) / 255).min(255) as u8
        }))
    })
}

/// Writes a picture with the compression of PNG, which PDF supports.
fn image(pdf: &mut Pdf, at: Ref, pixels: &RgbImage) -> Result<(), String> {
    let (width, height) = (pixels.width() as i32, pixels.height() as i32);
    let png = encode_picture(&pixels.clone().into(), PictureFormat::Png).map_err(|e| e.to_string())?;
    let data = compressed(&png);
    let mut image = pdf.image_xobject(at, &data);
    image.width(width).height(height).bits_per_component(8).filter(Filter::FlateDecode);
    image.color_space().device_rgb();
    image.decode_parms().predictor(Predictor::PngOptimum).colors(3).bits_per_component(8).columns(width);
    image.finish();
    Ok(())
}

/// Returns the compressed pixels of a PNG file.
fn compressed(png: &[u8]) -> Vec<u8> {
    let mut data = Vec::new();
    let mut rest = png.get(8..).unwrap_or_default();
    while let Some((head, behind)) = rest.split_first_chunk::<8>() {
        let [a, b, c, d, name @ ..] = *head;
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        if &name == b"IDAT" {
            data.extend_from_slice(behind.get(..length).unwrap_or_default());
        }
        // A checksum of four bytes follows.
        rest = behind.get(length + 4..).unwrap_or_default();
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pixels_of_a_png_file_are_found() {
        let pixels = RgbImage::from_fn(300, 200, |x, y| image::Rgb([x as u8, y as u8, (x * y) as u8]));
        let png = encode_picture(&pixels.into(), PictureFormat::Png).unwrap();
        let data = compressed(&png);
        assert!(data.len() > 1000 && data.len() < png.len());
        assert_eq!(data[0] & 0x0f, 8, "a zlib stream");
        assert!(compressed(&png[..20]).is_empty() && compressed(&[]).is_empty());
    }

    #[test]
    fn transparent_pixels_show_the_paper() {
        let pixels = image::RgbaImage::from_raw(2, 1, vec![0, 0, 0, 0, 100, 50, 0, 127]).unwrap();
        let seen = on_paper(&pixels.into(), [255; 4]);
        assert_eq!(seen.as_raw(), &[255, 255, 255, 228, 178, 128]);
    }
}
