//! Visible overlays, stage, tab and dock. They do not affect the edited state and are kept between
//! runs.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::comparison::Subject;
use super::dock::DockLook;
use super::ids::{OverlayId, StageId, TabId, Visibility};
use super::rectified::RectifiedLook;
use super::replay::Speed;

/// Effect of a click in an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// A click places a point.
    #[default]
    Points,
    /// A click pins the pair of epipolar lines through its position.
    Inspect,
}

/// Visible overlays, stage and tab, and the place of the dock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Look {
    /// Whether each overlay is kept on, in the order of their list.
    #[serde(serialize_with = "overlays_by_name", deserialize_with = "overlays_from_names")]
    pub overlays: [bool; OverlayId::COUNT],
    /// Whether zoom and position of the two images are linked.
    pub linked: bool,
    /// The stage. Every start begins with the pictures.
    #[serde(skip)]
    pub stage: StageId,
    #[serde(serialize_with = "tab_by_title", deserialize_with = "tab_from_title")]
    pub tab: TabId,
    pub speed: Speed,
    /// Whether the replay shows only the last moment of each step.
    pub still_steps: bool,
    pub dock: DockLook,
    /// Whether the images are stacked; `None` chooses what shows them larger.
    #[serde(rename = "stacking")]
    pub stacked: Option<bool>,
    pub compared: Subject,
    /// Layout and guide lines of the rectified pair.
    pub rectified: RectifiedLook,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            overlays: shown_at_first(),
            linked: false,
            stage: StageId::default(),
            tab: TabId::default(),
            speed: Speed::default(),
            still_steps: false,
            dock: DockLook::default(),
            stacked: None,
            compared: Subject::default(),
            rectified: RectifiedLook::default(),
        }
    }
}

impl Look {
    /// Returns whether an overlay is drawn: kept on, or switched on by its open tab.
    pub fn shows(&self, overlay: OverlayId) -> bool {
        let is_open = |tab: TabId| !self.dock.folded && self.tab == tab;
        self.overlays[overlay as usize] || overlay.tab().is_some_and(is_open)
    }
}

fn shown_at_first() -> [bool; OverlayId::COUNT] {
    let mut shown = [false; OverlayId::COUNT];
    for (overlay, shown) in OverlayId::ALL.into_iter().zip(&mut shown) {
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
        OverlayId::ALL.into_iter().map(OverlayId::name).zip(overlays.iter().copied()).collect();
    named.serialize(serializer)
}

fn overlays_from_names<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<[bool; OverlayId::COUNT], D::Error> {
    let named = BTreeMap::<String, bool>::deserialize(deserializer)?;
    let mut overlays = shown_at_first();
    for (overlay, shown) in OverlayId::ALL.into_iter().zip(&mut overlays) {
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
    use crate::app::model::dock::DockEdge;

    #[test]
    fn a_look_is_restored_whatever_is_missing_or_unknown() {
        let dock = DockLook { folded: true, edge: Some(DockEdge::Right), ..DockLook::default() };
        let mut look = Look { linked: true, tab: TabId::Residuals, dock, ..Look::default() };
        look.overlays[OverlayId::Points as usize] = false;
        let text = serde_json::to_string(&look).unwrap();
        assert_eq!(serde_json::from_str::<Look>(&text).unwrap(), look);
        let partial = r#"{"overlays": {"Points": false, "Of another version": true}, "map": false, "linked": true,
                "tab": "Residuals", "dock": {"edge": "right", "folded": true}, "drawer": true,
                "rectified": {"layout": "wipe"}}"#;
        assert_eq!(serde_json::from_str::<Look>(partial).unwrap(), look);
        let unknown = serde_json::from_str::<Look>(r#"{"tab": "Of another version"}"#);
        assert_eq!(unknown.unwrap(), Look::default());
        assert_eq!(serde_json::from_str::<Look>("{}").unwrap(), Look::default());
    }
}
