//! Fonts of the system, for letters that the fonts of the program lack: names of files in other scripts.
//!
//! A font is read when the first such letter appears, so the start of the program costs nothing.

use std::sync::OnceLock;

use egui::{FallbackRequest, FontData, FontFamily, FontInsert, FontProvider};
use skrifa::{FontRef, MetadataProvider};

/// Usual files of fonts, in groups of which the first one found is read. Small files come first.
#[cfg(target_os = "windows")]
const GROUPS: [&[&str]; 3] = [
    &["C:/Windows/Fonts/segoeui.ttf", "C:/Windows/Fonts/arial.ttf"],
    &["C:/Windows/Fonts/malgun.ttf"],
    &["C:/Windows/Fonts/msyh.ttc", "C:/Windows/Fonts/simsun.ttc", "C:/Windows/Fonts/msgothic.ttc"],
];
#[cfg(target_os = "macos")]
const GROUPS: [&[&str]; 3] = [
    &["/System/Library/Fonts/Supplemental/Arial Unicode.ttf", "/Library/Fonts/Arial Unicode.ttf"],
    &["/System/Library/Fonts/AppleSDGothicNeo.ttc"],
    &["/System/Library/Fonts/Hiragino Sans GB.ttc", "/System/Library/Fonts/PingFang.ttc"],
];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const GROUPS: [&[&str]; 2] = [
    &[
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
        "/usr/share/fonts/TTF/DejaVuSans.ttf",
        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
        "/usr/share/fonts/dejavu/DejaVuSans.ttf",
    ],
    &[
        "/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc",
        "/usr/share/fonts/noto-cjk/NotoSansCJK-Regular.ttc",
        "/usr/share/fonts/google-noto-cjk/NotoSansCJK-Regular.ttc",
        "/usr/share/fonts/google-noto-sans-cjk-fonts/NotoSansCJK-Regular.ttc",
        "/usr/share/fonts/google-noto-sans-cjk-vf-fonts/NotoSansCJK-VF.ttc",
        "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",
        "/usr/share/fonts/truetype/wqy/wqy-microhei.ttc",
        "/usr/share/fonts/truetype/wqy/wqy-zenhei.ttc",
    ],
];

type FontFile = (&'static str, &'static [u8]);

/// The fonts of the system, as far as they were read.
#[derive(Default)]
pub struct SystemFonts {
    /// The font of each group, once read. The inner `None`: there is none.
    read: [OnceLock<Option<FontFile>>; GROUPS.len()],
}

impl FontProvider for SystemFonts {
    fn font_for(&self, request: &FallbackRequest<'_>) -> Option<FontInsert> {
        let letter =
            request.cluster.chars().next().filter(|_| *request.family == FontFamily::Proportional)?;
        let fonts =
            GROUPS.iter().zip(&self.read).filter_map(|(files, read)| *read.get_or_init(|| found(files)));
        let (name, bytes) = fonts.into_iter().find(|(_, bytes)| has(bytes, letter))?;
        Some(FontInsert { name: name.to_owned(), data: FontData::from_static(bytes), families: Vec::new() })
    }
}

/// Reads the first file that is there. The toolkit keeps fonts as long as the window is open.
fn found(files: &[&'static str]) -> Option<FontFile> {
    files.iter().find_map(|name| Some((*name, &*std::fs::read(name).ok()?.leak())))
}

/// Returns whether a font has a letter; a damaged font has none.
fn has(bytes: &[u8], letter: char) -> bool {
    FontRef::from_index(bytes, 0).is_ok_and(|font| font.charmap().map(letter).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_font_is_given_only_for_letters_that_it_has() {
        let fonts = SystemFonts::default();
        let given = |cluster, family| {
            fonts.font_for(&FallbackRequest { cluster, family: &family }).map(|font| font.name)
        };
        assert_eq!(given("語", FontFamily::Monospace), None);
        assert_eq!(given("\u{10ffff}", FontFamily::Proportional), None);
        // The machine may have no font at all.
        for letter in ["ش", "語", "한"] {
            if let Some(name) = given(letter, FontFamily::Proportional) {
                assert!(has(&std::fs::read(name).unwrap(), letter.chars().next().unwrap()));
            }
        }
        assert!(found(&["/no/such/font.ttf"]).is_none() && !has(b"no font", 'a'));
    }
}
