//! The figure as PDF: one page of the sheet's size, with lossless images, vector lines and text,
//! and embedded fonts.

use std::collections::BTreeMap;

use egui::epaint::RectShape;
use egui::{Color32, Pos2, Rect, Stroke, Vec2};
use image::{DynamicImage, RgbImage};
use pdf_writer::types::Predictor;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Ref, Str, TextStr};

use super::font::Fonts;
use super::pieces::{Piece, take_apart};
use super::sheet::Sheet;
use crate::app::view::theme;
use crate::io::{PictureFormat, encode_picture};

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

pub fn write(sheet: &Sheet) -> Result<Vec<u8>, String> {
    let mut pdf = Pdf::new();
    let fonts = Fonts::new(theme::fonts());
    let mut page = Page { content: Content::new(), opacities: BTreeMap::new(), fonts };
    // PDF has its origin at the lower left, with y upwards; the sheet has it at the upper left.
    page.content.transform([1.0, 0.0, 0.0, -1.0, 0.0, sheet.size.y]);
    page.fill(sheet.background);
    page.content.rect(0.0, 0.0, sheet.size.x, sheet.size.y).fill_nonzero();
    for (k, place) in sheet.places.iter().enumerate() {
        let area = place.transform.rect;
        let (pixels, rect) = sheet.picture(k);
        image(&mut pdf, IMAGES[k], &on_paper(&pixels, sheet.background))?;
        page.content.save_state().rect(area.min.x, area.min.y, area.width(), area.height());
        page.content.clip_nonzero().end_path();
        // A PDF image fills the unit square upright, so this undoes the flip of the page.
        page.content.save_state().transform([rect.width(), 0.0, 0.0, -rect.height(), rect.min.x, rect.max.y]);
        page.content.x_object(IMAGE_NAMES[k]).restore_state();
        for shape in sheet.shapes(k) {
            take_apart(shape, &mut |piece| page.piece(piece));
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
    written.media_box(pdf_writer::Rect::new(0.0, 0.0, sheet.size.x, sheet.size.y));
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
    about.title(TextStr(&sheet.title));
    about.creator(TextStr(concat!("epiline ", env!("CARGO_PKG_VERSION"))));
    if let Some(trust) = &sheet.trust {
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
    fn piece(&mut self, piece: Piece) {
        match piece {
            Piece::Line([a, b], stroke) => self.paint(Color32::TRANSPARENT, stroke, |content| {
                content.move_to(a.x, a.y).line_to(b.x, b.y);
            }),
            Piece::Circle(circle) => self.paint(circle.fill, circle.stroke, |content| {
                let square = Rect::from_center_size(circle.center, Vec2::splat(2.0 * circle.radius));
                rounded(content, square, circle.radius);
            }),
            Piece::Rect(RectShape { rect, corner_radius, fill, stroke, .. }) => {
                let rounding = f32::from(corner_radius.nw).min(rect.width() / 2.0).min(rect.height() / 2.0);
                self.paint(*fill, *stroke, |content| rounded(content, *rect, rounding));
            }
            Piece::Path { points: [first, rest @ ..], closed, fill, stroke } => {
                self.paint(fill, stroke, |content| {
                    content.move_to(first.x, first.y);
                    for point in rest {
                        content.line_to(point.x, point.y);
                    }
                    if closed {
                        content.close_path();
                    }
                });
            }
            Piece::Path { .. } => {}
            Piece::Letters { at, size, color, words } => self.letters(at, size, color, &words),
        }
    }

    /// Fills and strokes a path. The colours come first: PDF allows nothing between a path and its
    /// painting operator.
    fn paint(&mut self, fill: Color32, stroke: Stroke, path: impl FnOnce(&mut Content)) {
        let (filled, drawn) = (fill.a() > 0, stroke.width > 0.0 && stroke.color.a() > 0);
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

    fn letters(&mut self, at: Pos2, size: f32, color: Color32, words: &str) {
        self.fill(color);
        let runs = self.fonts.write(words);
        // The text matrix undoes the flip of the page. Each run starts where the previous one ends.
        self.content.begin_text().set_text_matrix([1.0, 0.0, 0.0, -1.0, at.x, at.y]);
        for run in &runs {
            let (font, size, rise) = self.fonts.style(run, size);
            self.content.set_font(Name(font.as_bytes()), size).set_rise(rise).show(Str(&run.codes));
        }
        self.content.end_text();
    }

    fn fill(&mut self, color: Color32) {
        let [red, green, blue, alpha] = shares(color);
        self.opacity(Painted::Inside, alpha);
        self.content.set_fill_rgb(red, green, blue);
    }

    fn stroke(&mut self, stroke: Stroke) {
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

fn shares(color: Color32) -> [f32; 4] {
    color.to_srgba_unmultiplied().map(|v| f32::from(v) / 255.0)
}

/// Describes a rectangle with rounded corners. It is a circle if its size is twice the radius.
fn rounded(content: &mut Content, rect: Rect, radius: f32) {
    if radius <= 0.0 {
        content.rect(rect.min.x, rect.min.y, rect.width(), rect.height());
        return;
    }
    let (Rect { min, max }, handle) = (rect, radius * (1.0 - QUARTER));
    content.move_to(min.x + radius, min.y).line_to(max.x - radius, min.y);
    content.cubic_to(max.x - handle, min.y, max.x, min.y + handle, max.x, min.y + radius);
    content.line_to(max.x, max.y - radius);
    content.cubic_to(max.x, max.y - handle, max.x - handle, max.y, max.x - radius, max.y);
    content.line_to(min.x + radius, max.y);
    content.cubic_to(min.x + handle, max.y, min.x, max.y - handle, min.x, max.y - radius);
    content.line_to(min.x, min.y + radius);
    content.cubic_to(min.x, min.y + handle, min.x + handle, min.y, min.x + radius, min.y).close_path();
}

/// Blends transparent pixels with the colour of the paper.
fn on_paper(pixels: &DynamicImage, paper: Color32) -> RgbImage {
    let pixels = pixels.to_rgba8();
    RgbImage::from_fn(pixels.width(), pixels.height(), |x, y| {
        // Colours are premultiplied by alpha.
        let [colors @ .., alpha] = pixels.get_pixel(x, y).0;
        let rest = 255 - u32::from(alpha);
        let paper = [paper.r(), paper.g(), paper.b()];
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
        let seen = on_paper(&pixels.into(), Color32::WHITE);
        assert_eq!(seen.as_raw(), &[255, 255, 255, 228, 178, 128]);
    }
}
