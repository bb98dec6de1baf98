//! Shapes of the overlays, reduced to what vector formats know: lines, circles, polygons and text.

use egui::epaint::{CircleShape, ColorMode, Mesh, PathShape, RectShape, TextShape};
use egui::{Color32, Pos2, Shape, Stroke};

/// A primitive shape. Colours with alpha 0 are invisible.
pub enum Piece<'a> {
    Line([Pos2; 2], Stroke),
    Circle(&'a CircleShape),
    /// A rectangle, all of whose corners are rounded alike.
    Rect(&'a RectShape),
    Path {
        points: &'a [Pos2],
        /// Whether the last corner is joined to the first.
        closed: bool,
        fill: Color32,
        stroke: Stroke,
    },
    /// Text in one row.
    Letters {
        /// Start of the text on the baseline.
        at: Pos2,
        size: f32,
        color: Color32,
        words: String,
    },
}

/// Breaks a shape up into primitives.
pub fn take_apart(shape: &Shape, each: &mut dyn FnMut(Piece)) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|inner| take_apart(inner, each)),
        Shape::LineSegment { points, stroke } => each(Piece::Line(*points, *stroke)),
        Shape::Circle(circle) => each(Piece::Circle(circle)),
        Shape::Rect(rect) => each(Piece::Rect(rect)),
        Shape::Path(PathShape { points, closed, fill, stroke }) => {
            let color = match &stroke.color {
                ColorMode::Solid(color) => *color,
                ColorMode::UV(_) => Color32::TRANSPARENT,
            };
            let stroke = Stroke::new(stroke.width, color);
            each(Piece::Path { points, closed: *closed, fill: *fill, stroke });
        }
        Shape::Mesh(mesh) => match outline(mesh) {
            Some((points, fill)) => {
                each(Piece::Path { points: &points, closed: true, fill, stroke: Stroke::NONE });
            }
            None => triangles(mesh, each),
        },
        Shape::Text(letters) => rows(letters, each),
        // No other shapes are drawn over the images.
        _ => {}
    }
}

/// Returns the outline and the colour of a mesh of one colour that is a strip or a fan of
/// triangles.
fn outline(mesh: &Mesh) -> Option<(Vec<Pos2>, Color32)> {
    let fill = mesh.vertices.first()?.color;
    if fill.a() == 0 || mesh.vertices.iter().any(|vertex| vertex.color != fill) {
        return None;
    }
    let (triangles, _) = mesh.indices.as_chunks::<3>();
    let is = |shape: fn(u32) -> [u32; 3]| (0..).zip(triangles).all(|(k, corners)| *corners == shape(k));
    let points = || mesh.vertices.iter().map(|vertex| vertex.pos);
    let points = if is(|k| [k, k + 1, k + 2]) {
        // Along one edge, and back along the other.
        points().step_by(2).chain(points().skip(1).step_by(2).rev()).collect()
    } else if is(|k| [0, k + 1, k + 2]) {
        points().collect()
    } else {
        return None;
    };
    Some((points, fill))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(mesh: Mesh) -> Vec<Vec<Pos2>> {
        let mut paths = Vec::new();
        take_apart(&Shape::mesh(mesh), &mut |piece| match piece {
            Piece::Path { points, closed: true, .. } => paths.push(points.to_vec()),
            _ => panic!("not an area"),
        });
        paths
    }

    #[test]
    fn strips_and_fans_become_one_area_and_other_triangles_stay_separate() {
        let corners = [(0.0, 0.0), (0.0, 5.0), (10.0, 0.0), (10.0, 6.0), (20.0, 0.0)].map(Pos2::from);
        let mesh = |triangles: &[[u32; 3]]| {
            let mut mesh = Mesh::default();
            for at in corners {
                mesh.colored_vertex(at, Color32::RED);
            }
            for [a, b, c] in triangles {
                mesh.add_triangle(*a, *b, *c);
            }
            mesh
        };
        let [a, b, c, d, e] = corners;
        assert_eq!(paths(mesh(&[[0, 1, 2], [1, 2, 3], [2, 3, 4]])), [[a, c, e, d, b]]);
        assert_eq!(paths(mesh(&[[0, 1, 2], [0, 2, 3], [0, 3, 4]])), [corners]);
        assert_eq!(paths(mesh(&[[0, 1, 2], [2, 3, 4]])).len(), 2);
        let mut shaded = mesh(&[[0, 1, 2], [1, 2, 3], [2, 3, 4]]);
        shaded.vertices[4].color = Color32::BLUE;
        assert_eq!(paths(shaded).len(), 3);
    }
}
