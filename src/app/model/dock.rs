//! Place of the dock and arrangement of the two pictures.
//!
//! Of all combinations, the one that shows the pictures largest is taken, with the dock at its
//! smallest size. The dock then takes the room that the pictures cannot use. All sizes are in screen
//! points.

use serde::{Deserialize, Serialize};

use super::pane_view::LARGEST_SCALE;
use crate::geometry::Frame;

/// Space between the two pictures.
pub const BETWEEN: f32 = 2.0;
/// Largest share of the window for the dock.
const LARGEST_SHARE: f32 = 0.75;
/// Ratio of areas from which another arrangement replaces the present one, so that the dock does not
/// jump to and fro while the window is resized.
const CLEARLY_LARGER: f32 = 1.06;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the names say all")]
pub enum DockEdge {
    Bottom,
    Right,
}

impl DockEdge {
    const ALL: [Self; 2] = [Self::Bottom, Self::Right];

    /// Returns the smallest size of the dock in a window of this size: more in very large windows, where
    /// charts would be stripes.
    fn least(self, window: [f32; 2]) -> f32 {
        match self {
            Self::Bottom => (0.3 * window[1]).clamp(120.0, (0.13 * window[1]).max(190.0)),
            Self::Right => (0.264 * window[0]).clamp(252.0, (0.13 * window[0]).max(300.0)),
        }
    }

    /// Returns the dimension of a size in which the dock takes room.
    fn of(self, size: [f32; 2]) -> f32 {
        size[usize::from(self == Self::Bottom)]
    }
}

/// Choices of the user about the dock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct DockLook {
    /// Edge of the window; `None` takes the one that shows the pictures largest.
    pub edge: Option<DockEdge>,
    /// Height at the bottom edge, thousandths of the window; `None` takes the room that the
    /// pictures leave.
    pub height: Option<u16>,
    /// Width at the right edge, thousandths of the window.
    pub width: Option<u16>,
    /// Whether only the strip with the verdict is shown.
    pub folded: bool,
}

impl DockLook {
    /// Sets the size at an edge as a share of the window.
    pub fn set_share(&mut self, edge: DockEdge, share: Option<f32>) {
        let share = share.map(|share| (share.clamp(0.0, LARGEST_SHARE) * 1000.0).round() as u16);
        match edge {
            DockEdge::Bottom => self.height = share,
            DockEdge::Right => self.width = share,
        }
    }

    /// Returns the size that the user chose at an edge.
    fn chosen(&self, edge: DockEdge, window: [f32; 2]) -> Option<f32> {
        let share = match edge {
            DockEdge::Bottom => self.height,
            DockEdge::Right => self.width,
        };
        let size = f32::from(share?) / 1000.0 * edge.of(window);
        Some(size.clamp(edge.least(window), (LARGEST_SHARE * edge.of(window)).max(edge.least(window))))
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    pub edge: DockEdge,
    pub stacked: bool,
    /// Height or width of the dock.
    pub size: f32,
}

/// Returns the arrangement for a window. `room` is the part of the window that dock and pictures
/// share, and `before` the arrangement of the previous frame.
pub fn placed(
    window: [f32; 2],
    room: [f32; 2],
    frames: [Frame; 2],
    look: (&DockLook, Option<bool>),
    before: Option<Placement>,
) -> Placement {
    let (dock, stacking) = look;
    let size = |edge: DockEdge| dock.chosen(edge, window).unwrap_or_else(|| edge.least(window));
    let left = |edge: DockEdge| stage(room, edge, size(edge));
    let edges = DockEdge::ALL.into_iter().filter(|edge| dock.edge.is_none_or(|wanted| wanted == *edge));
    let all = edges.flat_map(|edge| [(edge, false), (edge, true)]);
    let all: Vec<_> = all
        .filter(|(_, stacked)| stacking.is_none_or(|wanted| wanted == *stacked))
        .map(|(edge, stacked)| (edge, stacked, pictures_area(left(edge), frames, stacked)))
        .collect();
    let area = |of: &(DockEdge, bool, f32)| of.2;
    let first = (dock.edge.unwrap_or(DockEdge::Bottom), stacking.unwrap_or(false), 0.0);
    let best =
        all.iter().copied().reduce(|best, other| if area(&other) > area(&best) { other } else { best });
    let best = best.unwrap_or(first);
    let same = |before: Placement| {
        all.iter().copied().find(|(edge, stacked, _)| (*edge, *stacked) == (before.edge, before.stacked))
    };
    let kept = before.and_then(same).filter(|kept| area(kept) * CLEARLY_LARGER >= area(&best));
    let (edge, stacked, _) = kept.unwrap_or(best);
    let size = dock.chosen(edge, window).unwrap_or_else(|| {
        let least = edge.least(window);
        let used = used(stage(room, edge, least), frames, stacked);
        (edge.of(room) - edge.of(used).ceil()).max(least)
    });
    Placement { edge, stacked, size }
}

/// Returns the size of the stage beside a dock.
fn stage(room: [f32; 2], edge: DockEdge, size: f32) -> [f32; 2] {
    match edge {
        DockEdge::Bottom => [room[0], (room[1] - size).max(1.0)],
        DockEdge::Right => [(room[0] - size).max(1.0), room[1]],
    }
}

/// Returns the size of each picture in a stage.
fn sizes(stage: [f32; 2], frames: [Frame; 2], stacked: bool) -> [[f32; 2]; 2] {
    let [width, height] = stage;
    let pane = if stacked { [width, (height - BETWEEN) / 2.0] } else { [(width - BETWEEN) / 2.0, height] };
    frames.map(|frame| {
        let [w, h] = [frame.width, frame.height].map(|side| side.max(1) as f32);
        let scale = (pane[0] / w).min(pane[1] / h).clamp(0.0, LARGEST_SCALE as f32);
        [w * scale, h * scale]
    })
}

pub fn pictures_area(stage: [f32; 2], frames: [Frame; 2], stacked: bool) -> f32 {
    sizes(stage, frames, stacked).iter().map(|[width, height]| width * height).sum()
}

/// Returns the part of a stage that the pictures need.
fn used(stage: [f32; 2], frames: [Frame; 2], stacked: bool) -> [f32; 2] {
    let [[w1, h1], [w2, h2]] = sizes(stage, frames, stacked);
    // Both panes are equally large.
    if stacked { [w1.max(w2), 2.0 * h1.max(h2) + BETWEEN] } else { [2.0 * w1.max(w2) + BETWEEN, h1.max(h2)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BARS: f32 = 62.0;

    /// Returns the area of the pictures as a share of a bare window.
    fn share(window: [f32; 2], frames: [Frame; 2]) -> f32 {
        let room = [window[0], window[1] - BARS];
        let placed = placed(window, room, frames, (&DockLook::default(), None), None);
        let best = [false, true].map(|stacked| pictures_area(window, frames, stacked));
        pictures_area(stage(room, placed.edge, placed.size), frames, placed.stacked) / best[0].max(best[1])
    }

    #[test]
    fn pictures_take_most_of_the_window() {
        let windows = [[1024.0, 640.0], [1280.0, 800.0], [1440.0, 900.0], [1920.0, 1080.0]];
        let kinds = [
            (Frame::new(1024, 768), [0.9; 4]),
            (Frame::new(768, 1024), [0.6, 0.65, 0.7, 0.7]),
            (Frame::new(1920, 1080), [0.8, 0.85, 0.85, 0.85]),
        ];
        for (frame, least) in kinds {
            for (window, least) in windows.into_iter().zip(least) {
                let share = share(window, [frame; 2]);
                assert!(share >= least, "{frame:?} in {window:?}: {share}");
            }
        }
    }

    #[test]
    fn the_dock_stays_where_it_is_while_the_window_grows() {
        let frames = [Frame::new(1600, 1200); 2];
        let look = DockLook::default();
        let mut before = None;
        let mut jumps = 0;
        // To a wide window and back again in small steps.
        for k in (0..200).chain((0..200).rev()) {
            let window = [900.0 + 8.0 * k as f32, 800.0];
            let now = placed(window, [window[0], window[1] - BARS], frames, (&look, None), before);
            jumps += usize::from(before.is_some_and(|before: Placement| before.edge != now.edge));
            before = Some(now);
        }
        // Right in a narrow window (stacked), bottom in a usual one, right in a very wide one.
        assert!(jumps <= 4, "{jumps} jumps");
    }

    #[test]
    fn a_chosen_edge_and_size_are_kept_as_a_share_of_the_window() {
        let mut look = DockLook { edge: Some(DockEdge::Right), ..DockLook::default() };
        look.set_share(DockEdge::Right, Some(0.4));
        let frames = [Frame::new(640, 480); 2];
        for width in [1000.0, 2000.0] {
            let placed = placed([width, 800.0], [width, 736.0], frames, (&look, Some(true)), None);
            assert_eq!(placed, Placement { edge: DockEdge::Right, stacked: true, size: 0.4 * width });
        }
    }
}
