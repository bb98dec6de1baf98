//! Shapes of the overlays, reduced to what vector formats know: lines, circles, polygons and text.

use egui::epaint::{CircleShape, ColorMode, Mesh, PathShape, RectShape, TextShape};
use egui::{Color32, Pos2, Rect, Shape, Stroke};

use crate::io::{FigureArea, FigureColor, FigureShape, FigureStroke};

/// Appends the primitives of a shape.
pub fn take_apart(shape: &Shape, pieces: &mut Vec<FigureShape>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|inner| take_apart(inner, pieces)),
        Shape::LineSegment { points, stroke } => {
            pieces.push(FigureShape::Line(points.map(at), stroked(*stroke)));
        }
        Shape::Circle(CircleShape { center, radius, fill, stroke, .. }) => pieces.push(FigureShape::Circle {
            centre: at(*center),
            radius: *radius,
            fill: color(*fill),
            stroke: stroked(*stroke),
        }),
        // All corners are rounded alike.
        Shape::Rect(RectShape { rect, corner_radius, fill, stroke, .. }) => pieces.push(FigureShape::Rect {
            area: area(*rect),
            rounding: f32::from(corner_radius.nw),
            fill: color(*fill),
            stroke: stroked(*stroke),
        }),
        Shape::Path(PathShape { points, closed, fill, stroke }) => {
            let line = match &stroke.color {
                ColorMode::Solid(color) => *color,
                ColorMode::UV(_) => Color32::TRANSPARENT,
            };
            let stroke = stroked(Stroke::new(stroke.width, line));
            let points = points.iter().copied().map(at).collect();
            pieces.push(FigureShape::Path { points, closed: *closed, fill: color(*fill), stroke });
        }
        Shape::Mesh(mesh) => match outline(mesh) {
            Some((points, fill)) => pieces.push(filled(points, fill)),
            None => pieces.extend(triangles(mesh)),
        },
        Shape::Text(letters) => pieces.extend(rows(letters)),
        // No other shapes are drawn over the images.
        _ => {}
    }
}

fn at(at: Pos2) -> [f32; 2] {
    [at.x, at.y]
}

pub fn area(rect: Rect) -> FigureArea {
    FigureArea { at: at(rect.min), size: [rect.width(), rect.height()] }
}

pub fn color(color: Color32) -> FigureColor {
    color.to_srgba_unmultiplied()
}

fn stroked(stroke: Stroke) -> FigureStroke {
    FigureStroke { width: stroke.width, color: color(stroke.color) }
}

fn filled(points: impl IntoIterator<Item = Pos2>, fill: Color32) -> FigureShape {
    let points = points.into_iter().map(at).collect();
    FigureShape::Path { points, closed: true, fill: color(fill), stroke: stroked(Stroke::NONE) }
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

fn triangles(mesh: &Mesh) -> impl Iterator<Item = FigureShape> + '_ {
    mesh.indices.as_chunks::<3>().0.iter().filter_map(|corners| {
        let corners = corners.map(|k| mesh.vertices[k as usize]);
        let channel =
            |k: usize| (corners.iter().map(|v| u32::from(v.color.to_array()[k])).sum::<u32>() / 3) as u8;
        let fill = Color32::from_rgba_premultiplied(channel(0), channel(1), channel(2), channel(3));
        (fill.a() > 0).then(|| filled(corners.map(|corner| corner.pos), fill))
    })
}

fn rows(letters: &TextShape) -> impl Iterator<Item = FigureShape> + '_ {
    let galley = &letters.galley;
    let format = galley.job.sections.first().map(|section| &section.format);
    let own = letters.override_text_color.or(format.map(|format| format.color)).unwrap_or(Color32::WHITE);
    let own = if own == Color32::PLACEHOLDER { letters.fallback_color } else { own };
    let size = format.map_or(13.0, |format| format.font_id.size);
    galley.rows.iter().filter_map(move |row| {
        let start = letters.pos + row.pos.to_vec2() + row.row.glyphs.first()?.pos.to_vec2();
        let words = row.row.glyphs.iter().map(|glyph| glyph.chr).collect();
        Some(FigureShape::Text { at: at(start), size, color: color(own), words })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(mesh: Mesh) -> Vec<Vec<Pos2>> {
        let mut pieces = Vec::new();
        take_apart(&Shape::mesh(mesh), &mut pieces);
        let corners = |piece| match piece {
            FigureShape::Path { points, closed: true, .. } => points.into_iter().map(Pos2::from).collect(),
            _ => panic!("not an area"),
        };
        pieces.into_iter().map(corners).collect()
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
