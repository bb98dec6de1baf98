//! How a person looks at the images: which overlays and which tab are shown, whether the views are linked. None
//! of it changes what is edited; it is remembered from one run to the next.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::comparison::Subject;
use super::panels::tabs::TABS;
use super::panes::overlays::{OVERLAYS, Visibility};
use super::rectified::RectifiedLook;

/// What a click in an image does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    /// It places a point.
    #[default]
    Points,
    /// It pins the pair of epipolar lines through that place.
    Inspect,
}

/// Choices about what is drawn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Saved", into = "Saved")]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct Look {
    /// Which overlays are shown, in the order of their list.
    pub overlays: [bool; OVERLAYS.len()],
    /// Whether zooming and moving one image does the same to the other.
    pub linked: bool,
    /// Whether the map of the epipoles is shown.
    pub map: bool,
    /// Whether a loupe follows the cursor while a point is placed.
    pub loupe: bool,
    /// The tab of the bottom panel.
    pub tab: usize,
    /// Whether the bottom panel is folded away.
    pub tabs_folded: bool,
    /// Whether the bottom panel takes most of the window.
    pub tabs_enlarged: bool,
    /// What the residuals compare.
    pub compared: Subject,
    /// How the rectified pair is shown.
    pub rectified: RectifiedLook,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            overlays: OVERLAYS.each_ref().map(|overlay| overlay.visibility != Visibility::OnRequest),
            linked: false,
            map: true,
            loupe: true,
            tab: 0,
            tabs_folded: false,
            tabs_enlarged: false,
            compared: Subject::default(),
            rectified: RectifiedLook::default(),
        }
    }
}

/// [`Look`] as it is saved: overlays and the tab by name, so that another list of them finds its own.
#[derive(Clone, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
struct Saved {
    overlays: BTreeMap<String, bool>,
    linked: bool,
    map: bool,
    loupe: bool,
    tab: String,
    tabs_folded: bool,
    tabs_enlarged: bool,
    compared: Subject,
    rectified: RectifiedLook,
}

impl Default for Saved {
    fn default() -> Self {
        Look::default().into()
    }
}

impl From<Look> for Saved {
    fn from(look: Look) -> Self {
        let Look { overlays, linked, map, loupe, tab, tabs_folded, tabs_enlarged, compared, rectified } =
            look;
        let overlays = OVERLAYS.iter().map(|overlay| overlay.name.to_owned()).zip(overlays).collect();
        let tab = TABS.get(tab).map_or(String::new(), |tab| tab.title.to_owned());
        Self { overlays, linked, map, loupe, tab, tabs_folded, tabs_enlarged, compared, rectified }
    }
}

impl From<Saved> for Look {
    fn from(saved: Saved) -> Self {
        let Saved { overlays, linked, map, loupe, tab, tabs_folded, tabs_enlarged, compared, rectified } =
            saved;
        let tab = TABS.iter().position(|other| other.title == tab).unwrap_or(0);
        let mut look = Self {
            linked,
            map,
            loupe,
            tab,
            tabs_folded,
            tabs_enlarged,
            compared,
            rectified,
            ..Self::default()
        };
        for (overlay, shown) in OVERLAYS.iter().zip(&mut look.overlays) {
            if let Some(saved) =
                overlays.get(overlay.name).filter(|_| overlay.visibility != Visibility::Always)
            {
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
        let mut look = Look { linked: true, map: false, tab: 2, tabs_folded: true, ..Look::default() };
        let points = OVERLAYS.iter().position(|overlay| overlay.name == "Points").unwrap();
        look.overlays[points] = false;
        let text = serde_json::to_string(&look).unwrap();
        assert_eq!(serde_json::from_str::<Look>(&text).unwrap(), look);
        let partial = r#"{"overlays": {"Points": false, "Of another version": true}, "map": false, "linked": true,
                "tab": "Pencils", "tabs_folded": true}"#;
        assert_eq!(serde_json::from_str::<Look>(partial).unwrap(), look);
        let unknown = serde_json::from_str::<Look>(r#"{"tab": "Of another version"}"#);
        assert_eq!(unknown.unwrap(), Look::default());
        assert_eq!(serde_json::from_str::<Look>("{}").unwrap(), Look::default());
    }
}
