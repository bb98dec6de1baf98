//! How a person looks at the images: which overlays and which tab are shown, whether the views are linked. None
//! of it changes what is edited; it is remembered from one run to the next.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

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
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct Look {
    /// Which overlays are shown, in the order of their list.
    #[serde(serialize_with = "overlays_by_name", deserialize_with = "overlays_from_names")]
    pub overlays: [bool; OverlayId::COUNT],
    /// Whether zooming and moving one image does the same to the other.
    pub linked: bool,
    /// Whether the map of the epipoles is shown.
    pub map: bool,
    /// Whether a loupe follows the cursor while a point is placed.
    pub loupe: bool,
    /// The tab of the bottom panel.
    #[serde(serialize_with = "tab_by_title", deserialize_with = "tab_from_title")]
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

/// Overlays are saved by name, so that another list of them finds its own.
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

/// The tab is saved by its title; in place of one that is no more comes the first.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
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
