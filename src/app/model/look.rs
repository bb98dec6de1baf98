//! How a person looks at the images: which overlays and which tab are shown, whether the views are linked. None
//! of it changes what is edited; it is remembered from one run to the next.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::comparison::Subject;
use super::ids::{OverlayId, TabId, Visibility};
use super::rectified::RectifiedLook;

/// What a click in an image does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// A click places a point.
    #[default]
    Points,
    /// A click pins the pair of epipolar lines through that place.
    Inspect,
}

/// Choices about what is drawn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "SavedLook", into = "SavedLook")]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct Look {
    /// Which overlays are shown, in the order of their list.
    pub overlays: [bool; OverlayId::COUNT],
    /// Whether zooming and moving one image does the same to the other.
    pub linked: bool,
    /// Whether the map of the epipoles is shown.
    pub map: bool,
    /// Whether a loupe follows the cursor while a point is placed.
    pub loupe: bool,
    /// The tab of the bottom panel.
    pub tab: TabId,
    /// Whether the bottom panel is folded away.
    pub tabs_folded: bool,
    /// Whether the bottom panel takes most of the window.
    pub tabs_enlarged: bool,
    /// Whether the side panel is folded away.
    pub side_folded: bool,
    /// Whether the row of overlays is folded away.
    pub overlays_folded: bool,
    /// Whether the small images of the folder are folded away.
    pub strip_folded: bool,
    /// Whether the names that were given to pairs are shown in the images.
    pub names: bool,
    /// Whether the images are above each other.
    pub stacked: bool,
    /// What the residuals compare.
    pub compared: Subject,
    /// How the rectified pair is shown.
    pub rectified: RectifiedLook,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            overlays: shown_at_first(),
            linked: false,
            map: true,
            loupe: true,
            tab: TabId::Points,
            tabs_folded: false,
            tabs_enlarged: false,
            side_folded: false,
            overlays_folded: false,
            strip_folded: false,
            names: true,
            stacked: false,
            compared: Subject::default(),
            rectified: RectifiedLook::default(),
        }
    }
}

impl Look {
    /// Whether an overlay is shown.
    pub fn shows(&self, overlay: OverlayId) -> bool {
        self.overlays[overlay as usize]
    }
}

fn shown_at_first() -> [bool; OverlayId::COUNT] {
    let mut shown = [false; OverlayId::COUNT];
    for (overlay, shown) in OverlayId::all().zip(&mut shown) {
        *shown = overlay.visibility() != Visibility::OnRequest;
    }
    shown
}

/// [`Look`] as it is saved: overlays and the tab by name, so that another list of them finds its own.
#[derive(Clone, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
struct SavedLook {
    overlays: BTreeMap<String, bool>,
    linked: bool,
    map: bool,
    loupe: bool,
    tab: String,
    tabs_folded: bool,
    tabs_enlarged: bool,
    side_folded: bool,
    overlays_folded: bool,
    strip_folded: bool,
    names: bool,
    stacked: bool,
    compared: Subject,
    rectified: RectifiedLook,
}

impl Default for SavedLook {
    fn default() -> Self {
        Look::default().into()
    }
}

impl From<Look> for SavedLook {
    fn from(look: Look) -> Self {
        let Look {
            overlays,
            linked,
            map,
            loupe,
            tab,
            tabs_folded,
            tabs_enlarged,
            side_folded,
            overlays_folded,
            strip_folded,
            names,
            stacked,
            compared,
            rectified,
        } = look;
        let overlays = OverlayId::all().map(|overlay| overlay.name().to_owned()).zip(overlays).collect();
        let tab = tab.title().to_owned();
        Self {
            overlays,
            linked,
            map,
            loupe,
            tab,
            tabs_folded,
            tabs_enlarged,
            side_folded,
            overlays_folded,
            strip_folded,
            names,
            stacked,
            compared,
            rectified,
        }
    }
}

impl From<SavedLook> for Look {
    fn from(saved: SavedLook) -> Self {
        let SavedLook {
            overlays,
            linked,
            map,
            loupe,
            tab,
            tabs_folded,
            tabs_enlarged,
            side_folded,
            overlays_folded,
            strip_folded,
            names,
            stacked,
            compared,
            rectified,
        } = saved;
        let tab = TabId::ALL.into_iter().find(|other| other.title() == tab).unwrap_or_default();
        let mut look = Self {
            linked,
            map,
            loupe,
            tab,
            tabs_folded,
            tabs_enlarged,
            side_folded,
            overlays_folded,
            strip_folded,
            names,
            stacked,
            compared,
            rectified,
            ..Self::default()
        };
        for (overlay, shown) in OverlayId::all().zip(&mut look.overlays) {
            let saved = overlays.get(overlay.name());
            if let Some(saved) = saved.filter(|_| overlay.visibility() != Visibility::Always) {
                *shown = *saved;
            }
        }
        look
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_look_survives_saving_and_unknown_or_missing_things_do_no_harm() {
        let mut look =
            Look { linked: true, map: false, tab: TabId::Pencils, side_folded: true, ..Look::default() };
        look.overlays[OverlayId::Points as usize] = false;
        let text = serde_json::to_string(&look).unwrap();
        assert_eq!(serde_json::from_str::<Look>(&text).unwrap(), look);
        let partial = r#"{"overlays": {"Points": false, "Of another version": true}, "map": false, "linked": true,
                "tab": "Pencils", "side_folded": true}"#;
        assert_eq!(serde_json::from_str::<Look>(partial).unwrap(), look);
        let unknown = serde_json::from_str::<Look>(r#"{"tab": "Of another version"}"#);
        assert_eq!(unknown.unwrap(), Look::default());
        assert_eq!(serde_json::from_str::<Look>("{}").unwrap(), Look::default());
    }
}
