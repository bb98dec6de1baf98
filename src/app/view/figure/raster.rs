//! The figure as PNG, drawn without a graphics card, in any size.

use egui::epaint::{Mesh, Primitive, Vertex};
use egui::{ColorImage, Pos2, Rect, Vec2};
use image::imageops::{FilterType, overlay, resize};
use image::{Rgba, RgbaImage};

use super::sheet::Sheet;
use crate::io::{PictureFormat, described, encode_picture};

/// The whole file.
pub fn write(sheet: &Sheet) -> Result<Vec<u8>, String> {
    let size = (sheet.size * sheet.scale).round();
    let [red, green, blue, _] = sheet.background.to_array();
    let mut canvas = RgbaImage::from_pixel(size.x as u32, size.y as u32, Rgba([red, green, blue, 255]));
    for k in 0..2 {
        place(&mut canvas, sheet, k);
    }
    let shapes = sheet.shapes().cloned().collect();
    for clipped in sheet.context.tessellate(shapes, sheet.scale) {
        if let Primitive::Mesh(mesh) = &clipped.primitive {
            let clip = (clipped.clip_rect * sheet.scale).intersect(Rect::from_min_size(Pos2::ZERO, size));
            draw(&mut canvas, mesh, sheet.letters.get(&mesh.texture_id), sheet.scale, clip);
        }
    }
    let png = encode_picture(&image::DynamicImage::from(canvas).into_rgb8().into(), PictureFormat::Png)
        .map_err(|e| e.to_string())?;
    Ok(sheet.trust.iter().fold(png, |png, trust| described(png, &trust.in_words())))
}

/// Draws what is seen of an image in its place.
fn place(canvas: &mut RgbaImage, sheet: &Sheet, k: usize) {
    let (pixels, rect) = sheet.picture(k);
    let pixels = pixels.into_rgba8();
    let rect = rect * sheet.scale;
    let area = sheet.places[k].transform.rect * sheet.scale;
    let size = rect.size().round().max(Vec2::splat(1.0));
    let size = [size.x as u32, size.y as u32];
    let scaled = if size == [pixels.width(), pixels.height()] {
        pixels
    } else {
        let enlarged = size[0] > pixels.width() * 3 / 2;
        resize(&pixels, size[0], size[1], if enlarged { FilterType::Nearest } else { FilterType::Triangle })
    };
    // A magnified pixel at the edge reaches beyond its place.
    let (left, top) = (
        (area.min.x - rect.min.x).max(0.0).round() as u32,
        (area.min.y - rect.min.y).max(0.0).round() as u32,
    );
    let corner = rect.min.max(area.min).round();
    let end = rect.max.min(area.max).round();
    let (width, height) = ((end.x - corner.x).max(0.0) as u32, (end.y - corner.y).max(0.0) as u32);
    let inside = image::imageops::crop_imm(&scaled, left, top, width, height).to_image();
    overlay(canvas, &inside, corner.x as i64, corner.y as i64);
}

/// Draws triangles of colours, multiplied by a texture: that of the letters, which has a white place for all else.
fn draw(canvas: &mut RgbaImage, mesh: &Mesh, texture: Option<&ColorImage>, scale: f32, clip: Rect) {
    for corners in mesh.indices.as_chunks::<3>().0 {
        let mut corners = corners.map(|k| mesh.vertices[k as usize]);
        for corner in &mut corners {
            corner.pos = (corner.pos.to_vec2() * scale).to_pos2();
        }
        triangle(canvas, corners, texture, clip);
    }
}

/// Twice the area of a triangle, positive one way round.
fn area(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

fn triangle(canvas: &mut RgbaImage, mut corners: [Vertex; 3], texture: Option<&ColorImage>, clip: Rect) {
    let whole = area(corners[0].pos, corners[1].pos, corners[2].pos);
    if whole == 0.0 || !whole.is_finite() {
        return;
    }
    if whole < 0.0 {
        corners.swap(1, 2);
    }
    let whole = whole.abs();
    let [a, b, c] = corners.map(|corner| corner.pos);
    let bounds = Rect::from_points(&[a, b, c]).intersect(clip);
    if !bounds.is_positive() {
        return;
    }
    // A pixel on an edge that two triangles share belongs to one of them.
    #[expect(clippy::float_cmp, reason = "the same edge has the very same ends in both")]
    let owns = |from: Pos2, to: Pos2| to.y > from.y || to.y == from.y && to.x < from.x;
    let edges = [(b, c), (c, a), (a, b)];
    for y in bounds.min.y.floor().max(0.0) as u32..(bounds.max.y.ceil() as u32).min(canvas.height()) {
        let row = y as f32 + 0.5;
        // Where the row crosses the triangle: long thin ones have most of their bounds outside.
        let crossings = edges.iter().filter(|(from, to)| (from.y <= row) != (to.y <= row));
        let crossings =
            crossings.map(|(from, to)| from.x + (row - from.y) / (to.y - from.y) * (to.x - from.x));
        let (low, high) = crossings.fold((f32::MAX, f32::MIN), |(low, high), x| (low.min(x), high.max(x)));
        if low > high {
            continue;
        }
        let first = (low.max(clip.min.x) - 1.0).floor().max(0.0) as u32;
        let end = ((high.min(clip.max.x) + 1.0).ceil().max(0.0) as u32).min(canvas.width());
        for x in first..end {
            let at = Pos2::new(x as f32 + 0.5, row);
            if !clip.contains(at) {
                continue;
            }
            let parts = edges.map(|(from, to)| area(from, to, at));
            let inside = |k: usize| parts[k] > 0.0 || parts[k] == 0.0 && owns(edges[k].0, edges[k].1);
            if !(0..3).all(inside) {
                continue;
            }
            let share = |value: &dyn Fn(&Vertex) -> f32| {
                corners.iter().zip(parts).map(|(corner, part)| value(corner) * part / whole).sum::<f32>()
            };
            let texel = texture.map_or([255; 4], |texture| {
                let [u, v] = [share(&|corner| corner.uv.x), share(&|corner| corner.uv.y)];
                let place =
                    |part: f32, size: usize| ((part * size as f32) as usize).min(size.saturating_sub(1));
                texture[(place(u, texture.width()), place(v, texture.height()))].to_array()
            });
            let color: [f32; 4] = std::array::from_fn(|k| {
                share(&|corner| f32::from(corner.color.to_array()[k])) * f32::from(texel[k]) / 255.0
            });
            let pixel = canvas.get_pixel_mut(x, y);
            for (below, above) in pixel.0.iter_mut().zip(color).take(3) {
                *below =
                    (above + f32::from(*below) * (1.0 - color[3] / 255.0)).round().clamp(0.0, 255.0) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Color32;

    #[test]
    fn two_triangles_make_a_square_without_a_seam_or_an_overlap() {
        let mut canvas = RgbaImage::from_pixel(20, 20, Rgba([0, 0, 0, 255]));
        let mut mesh = Mesh::default();
        mesh.add_colored_rect(
            Rect::from_min_max(Pos2::new(2.0, 3.0), Pos2::new(7.0, 9.0)),
            Color32::from_rgba_premultiplied(100, 0, 0, 100),
        );
        let clip = Rect::from_min_size(Pos2::ZERO, Vec2::splat(20.0));
        draw(&mut canvas, &mesh, None, 2.0, clip);
        let red = canvas.pixels().filter(|pixel| pixel[0] == 100).count();
        assert_eq!(red, 10 * 12, "each pixel once");
        assert!(canvas.pixels().all(|pixel| pixel[0] == 0 || pixel[0] == 100));
    }
}
