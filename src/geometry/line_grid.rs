//! Lines spread evenly over an image.

use std::f64::consts::PI;

use super::{AnchoredLine, Frame};

/// Returns the distance in px between neighbours among about `count` lines of an image.
pub fn line_spacing(frame: Frame, count: usize) -> f64 {
    // Directions and offsets are both `spacing` px apart at the corners. The mean width of a
    // rectangle over all directions is 2 (w + h) / π.
    let half = 0.5 * frame.diagonal();
    let width = 2.0 * (frame.right() + frame.bottom()) / PI;
    (PI * half * width / count.max(1) as f64).sqrt().max(1.0)
}

/// Returns about `count` lines of an image, evenly spread over direction (radians, `[0, π)`) and
/// over distance from the image centre.
pub fn line_grid(frame: Frame, count: usize) -> Vec<AnchoredLine> {
    let middle = frame.centre();
    let half = 0.5 * frame.diagonal();
    let spacing = line_spacing(frame, count);
    let directions = (PI * half / spacing).round().max(4.0) as usize;
    let mut lines = Vec::with_capacity(count + directions);
    for k in 0..directions {
        let angle = PI * k as f64 / directions as f64;
        let through = AnchoredLine::at_angle(middle, angle);
        let across = AnchoredLine::at_angle(middle, angle + 0.5 * PI);
        let reach = frame
            .corners()
            .iter()
            .map(|corner| (corner - middle).dot(&across.direction).abs())
            .fold(0.0, f64::max);
        let steps = (reach / spacing).floor() as i32;
        lines.extend((-steps..=steps).map(|step| AnchoredLine {
            anchor: across.point_at(spacing * f64::from(step)),
            direction: through.direction,
        }));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_spread_evenly_and_are_about_as_many_as_asked_for() {
        let frame = Frame::new(192, 144);
        for count in [100, 500, 2000] {
            let lines = line_grid(frame, count);
            assert!(
                lines.len() * 10 > count * 8 && lines.len() * 10 < count * 12,
                "{} of {count}",
                lines.len()
            );
            assert!(lines.iter().all(|line| frame.clip(&line.line()).is_some()));
        }
    }
}
