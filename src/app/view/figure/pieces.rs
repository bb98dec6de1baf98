//! What overlays draw, taken apart into what a drawing program knows: lines, circles, polygons, letters.

use egui::epaint::{ColorMode, Mesh, PathShape, RectShape, TextShape};
use egui::{Color32, Pos2, Rect, Shape, Stroke};

/// One of them; colours with alpha 0 are not to be seen.
pub enum Piece<'a> {
    /// A straight line.
    Line([Pos2; 2], Stroke),
    /// A circle with its inside.
    Circle {
        /// Middle of the circle.
        centre: Pos2,
        /// Radius of the circle.
        radius: f32,
        /// The colour inside.
        fill: Color32,
        /// Rim of the circle.
        stroke: Stroke,
    },
    /// A rectangle with rounded corners.
    Rect {
        /// Where it is.
        rect: Rect,
        /// The radius of its corners.
        rounding: f32,
        /// The colour inside.
        fill: Color32,
        /// Rim of the rectangle.
        stroke: Stroke,
    },
    /// A polygon, or a line with corners.
    Path {
        /// The corners.
        points: &'a [Pos2],
        /// Whether the last one is joined to the first.
        closed: bool,
        /// The colour inside.
        fill: Color32,
        /// The line.
        stroke: Stroke,
    },
    /// Letters in one row.
    Letters {
        /// Where they begin, on the line that they stand on.
        at: Pos2,
        /// Their size.
        size: f32,
        /// Their colour.
        color: Color32,
        /// What they say.
        words: String,
    },
}

/// Takes a shape apart.
pub fn take_apart(shape: &Shape, each: &mut dyn FnMut(Piece)) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|inner| take_apart(inner, each)),
        Shape::LineSegment { points, stroke } => each(Piece::Line(*points, *stroke)),
        Shape::Circle(circle) => each(Piece::Circle {
            centre: circle.center,
            radius: circle.radius,
            fill: circle.fill,
            stroke: circle.stroke,
        }),
        Shape::Rect(RectShape { rect, corner_radius, fill, stroke, .. }) => each(Piece::Rect {
            rect: *rect,
            rounding: f32::from(corner_radius.nw),
            fill: *fill,
            stroke: *stroke,
        }),
        Shape::Path(PathShape { points, closed, fill, stroke }) => {
            let color = match &stroke.color {
                ColorMode::Solid(color) => *color,
                ColorMode::UV(_) => Color32::TRANSPARENT,
            };
            let stroke = Stroke::new(stroke.width, color);
            each(Piece::Path { points, closed: *closed, fill: *fill, stroke });
        }
        Shape::Mesh(mesh) => triangles(mesh, each),
        Shape::Text(letters) => rows(letters, each),
        // Nothing else is drawn over the images.
        _ => {}
    }
}

fn triangles(mesh: &Mesh, each: &mut dyn FnMut(Piece)) {
    for corners in mesh.indices.as_chunks::<3>().0 {
        let corners = corners.map(|k| mesh.vertices[k as usize]);
        let channel =
            |k: usize| (corners.iter().map(|v| u32::from(v.color.to_array()[k])).sum::<u32>() / 3) as u8;
        let fill = Color32::from_rgba_premultiplied(channel(0), channel(1), channel(2), channel(3));
        if fill.a() > 0 {
            let points = &corners.map(|corner| corner.pos);
            each(Piece::Path { points, closed: true, fill, stroke: Stroke::NONE });
        }
    }
}

fn rows(letters: &TextShape, each: &mut dyn FnMut(Piece)) {
    let galley = &letters.galley;
    let format = galley.job.sections.first().map(|section| &section.format);
    let color = letters.override_text_color.or(format.map(|format| format.color)).unwrap_or(Color32::WHITE);
    let color = if color == Color32::PLACEHOLDER { letters.fallback_color } else { color };
    let size = format.map_or(13.0, |format| format.font_id.size);
    for row in &galley.rows {
        let Some(glyph) = row.row.glyphs.first() else { continue };
        let at = letters.pos + row.pos.to_vec2() + glyph.pos.to_vec2();
        let words = row.row.glyphs.iter().map(|glyph| glyph.chr).collect();
        each(Piece::Letters { at, size, color, words });
    }
}
