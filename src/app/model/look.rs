//! Visible overlays, tabs and panels. They do not affect the edited state and are kept between
//! runs.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::comparison::Subject;
use super::ids::{OverlayId, TabId, Visibility};
use super::rectified::RectifiedLook;

/// Effect of a click in an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// A click places a point.
    #[default]
    Points,
    /// A click pins the pair of epipolar lines through its position.
    Inspect,
    /// A click marks an end of a measured distance.
    Measure,
}

/// Visible overlays, tabs and panels.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct Look {
    /// Whether each overlay is shown, in the order of their list.
    #[serde(serialize_with = "overlays_by_name", deserialize_with = "overlays_from_names")]
    pub overlays: [bool; OverlayId::COUNT],
    /// Whether zoom and position of the two images are linked.
    pub linked: bool,
    /// Whether the map of the epipoles is shown.
    pub map: bool,
    /// Whether a magnifier follows the cursor while a point is placed.
    pub loupe: bool,
    /// The tab of the bottom panel.
    #[serde(serialize_with = "tab_by_title", deserialize_with = "tab_from_title")]
    pub tab: TabId,
    /// Whether the bottom panel is folded.
    pub tabs_folded: bool,
    /// Whether the bottom panel takes most of the window.
    pub tabs_enlarged: bool,
    /// Whether the side panel is folded.
    pub side_folded: bool,
    /// Whether the row of overlays is folded.
    pub overlays_folded: bool,
    /// Whether the small images of the folder are folded.
    pub strip_folded: bool,
    /// Whether given names of pairs are shown in the images.
    pub names: bool,
    /// Whether the images are stacked.
    pub stacked: bool,
    /// Subject of the residuals.
    pub compared: Subject,
    /// Layout and guide lines of the rectified pair.
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
    /// Returns whether an overlay is shown.
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

/// Serialises overlays by name, so that versions with other overlays can read them.
fn overlays_by_name<S: Serializer>(
    overlays: &[bool; OverlayId::COUNT],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let named: BTreeMap<&str, bool> =
        OverlayId::all().map(OverlayId::name).zip(overlays.iter().copied()).collect();
    named.serialize(serializer)
}

fn overlays_from_names<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<[bool; OverlayId::COUNT], D::Error> {
    let named = BTreeMap::<String, bool>::deserialize(deserializer)?;
    let mut overlays = shown_at_first();
    for (overlay, shown) in OverlayId::all().zip(&mut overlays) {
        let saved = named.get(overlay.name());
        if let Some(saved) = saved.filter(|_| overlay.visibility() != Visibility::Always) {
            *shown = *saved;
        }
    }
    Ok(overlays)
}

/// Serialises the tab by its title. Unknown titles become the first tab.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn tab_by_title<S: Serializer>(tab: &TabId, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(tab.title())
}

fn tab_from_title<'de, D: Deserializer<'de>>(deserializer: D) -> Result<TabId, D::Error> {
    let title = String::deserialize(deserializer)?;
    Ok(TabId::ALL.into_iter().find(|tab| tab.title() == title).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_look_is_restored_whatever_is_missing_or_unknown() {
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
