//! Fonts of a PDF, each embedded with only the letters used.
//!
//! Each letter of a font has a number (PDF 2.0, 9.7), in the order of first use. One map leads from
//! the numbers to the glyphs. Another leads to the letters, so that text can be selected and
//! searched.

use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Finish, Name, Pdf, Rect, Ref, Str};
use skrifa::instance::{LocationRef, Size};
use skrifa::raw::TableProvider;
use skrifa::string::StringId;
use skrifa::{FontRef, GlyphId, MetadataProvider};
use subsetter::GlyphRemapper;

/// Replacements for a letter that no font has, best first, as in the window.
const REPLACEMENTS: [char; 2] = ['◻', '?'];
/// Number of PDF objects per font.
const OBJECTS: i32 = 6;
const IDENTITY: SystemInfo =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// A font of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureFont {
    /// Content of the font file.
    pub file: Vec<u8>,
    /// Number of the font in the file.
    pub index: u32,
    /// Size over the size of the text.
    pub scale: f32,
    /// Drop below the baseline, points, and as a share of the size of the text.
    pub drop: [f32; 2],
}

/// The fonts of a figure, with the letters used so far.
pub struct Fonts {
    faces: Vec<Face>,
}

struct Face {
    font: FigureFont,
    letters: Vec<(char, GlyphId)>,
}

/// Consecutive letters written with one font.
#[derive(Debug, PartialEq, Eq)]
pub struct Run {
    font: usize,
    /// Numbers of the letters in the font, two bytes each.
    pub codes: Vec<u8>,
}

impl Fonts {
    /// Takes the fonts, with no letters used yet.
    pub fn new(fonts: Vec<FigureFont>) -> Self {
        Self { faces: fonts.into_iter().map(|font| Face { font, letters: Vec::new() }).collect() }
    }

    /// Encodes a text, using for each letter the first font that has it.
    pub fn write(&mut self, words: &str) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for letter in words.chars().filter(|letter| !letter.is_control()) {
            let Some((font, glyph)) = std::iter::once(letter).chain(REPLACEMENTS).find_map(|c| self.find(c))
            else {
                continue;
            };
            let code = self.faces[font].code(letter, glyph).to_be_bytes();
            match runs.last_mut().filter(|run| run.font == font) {
                Some(run) => run.codes.extend(code),
                None => runs.push(Run { font, codes: code.to_vec() }),
            }
        }
        runs
    }

    /// Returns the first font that has a letter, and the glyph.
    fn find(&self, letter: char) -> Option<(usize, GlyphId)> {
        self.faces.iter().enumerate().find_map(|(number, face)| {
            // Only TrueType outlines are embedded.
            let font = face.font().filter(|font| font.glyf().is_ok())?;
            Some((number, font.charmap().map(letter)?))
        })
    }

    /// Returns the name, the size and the rise above the baseline of a run's font, for text of the
    /// given size.
    pub fn style(&self, run: &Run, size: f32) -> (String, f32, f32) {
        let FigureFont { scale, drop, .. } = &self.faces[run.font].font;
        (name(run.font), size * scale, -(drop[0] + drop[1] * size))
    }

    /// Embeds the fonts that were used, in objects numbered from `first`. Returns their names and
    /// references.
    pub fn embed(&self, pdf: &mut Pdf, first: i32) -> Result<Vec<(String, Ref)>, String> {
        let written = self.faces.iter().enumerate().filter(|(_, face)| !face.letters.is_empty());
        written
            .zip((first..).step_by(OBJECTS as usize))
            .map(|((number, face), at)| {
                face.embed(pdf, at)?;
                Ok((name(number), Ref::new(at)))
            })
            .collect()
    }
}

fn name(number: usize) -> String {
    format!("Font{number}")
}

impl Face {
    fn font(&self) -> Option<FontRef<'_>> {
        FontRef::from_index(&self.font.file, self.font.index).ok()
    }

    /// Returns the number of a letter, starting at 1; code 0 is never used.
    fn code(&mut self, letter: char, glyph: GlyphId) -> u16 {
        let known = self.letters.iter().position(|(other, _)| *other == letter);
        let place = known.unwrap_or_else(|| {
            self.letters.push((letter, glyph));
            self.letters.len() - 1
        });
        (place + 1) as u16
    }

    /// Writes the font and its used letters into the objects from `at` on.
    fn embed(&self, pdf: &mut Pdf, at: i32) -> Result<(), String> {
        let [font_at, numbered_at, about_at, file_at, letters_at, glyphs_at] =
            [0, 1, 2, 3, 4, 5].map(|k| Ref::new(at + k));
        let font = self.font().ok_or("A font of Epiline cannot be read.")?;
        let mut kept = GlyphRemapper::new();
        let glyphs: Vec<u16> =
            self.letters.iter().map(|(_, glyph)| kept.remap(glyph.to_u32() as u16)).collect();
        let file = subsetter::subset(&self.font.file, self.font.index, &kept)
            .map_err(|e| format!("The font could not be embedded: {e}."))?;
        let postscript = font.localized_strings(StringId::POSTSCRIPT_NAME).english_or_first();
        let postscript = postscript.map_or_else(|| "Font".to_owned(), |name| name.chars().collect());
        let base = format!("{}+{postscript}", tag(&self.letters));
        let base = Name(base.as_bytes());

        pdf.type0_font(font_at)
            .base_font(base)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(numbered_at)
            .to_unicode(letters_at);
        let metrics = font.metrics(Size::unscaled(), LocationRef::default());
        let advances = font.glyph_metrics(Size::unscaled(), LocationRef::default());
        // Thousandths of the font size.
        let unit = 1000.0 / f32::from(metrics.units_per_em.max(1));
        let width = |(_, glyph): &(char, GlyphId)| unit * advances.advance_width(*glyph).unwrap_or(0.0);
        let mut numbered = pdf.cid_font(numbered_at);
        numbered.subtype(CidFontType::Type2).base_font(base).system_info(IDENTITY);
        numbered.font_descriptor(about_at).default_width(0.0).cid_to_gid_map_stream(glyphs_at);
        numbered.widths().consecutive(1, self.letters.iter().map(width));
        numbered.finish();
        let bounds = metrics.bounds.unwrap_or_default();
        let [left, bottom, right, top] =
            [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|v| v * unit);
        let weight = font.attributes().weight.value();
        let mut about = pdf.font_descriptor(about_at);
        about.name(base).flags(FontFlags::SYMBOLIC).bbox(Rect::new(left, bottom, right, top));
        about
            .italic_angle(metrics.italic_angle)
            .ascent(metrics.ascent * unit)
            .descent(metrics.descent * unit);
        about.cap_height(metrics.cap_height.unwrap_or(metrics.ascent) * unit);
        // Fonts do not store the width of their stems. This estimates it from the weight.
        about.stem_v(10.0 + 0.244 * (weight - 50.0)).font_file2(file_at);
        about.finish();
        pdf.stream(file_at, &file).pair(Name(b"Length1"), file.len() as i32);

        let name = Name(b"Letters");
        let mut letters = UnicodeCmap::new(name, IDENTITY);
        for (code, (letter, _)) in (1u16..).zip(&self.letters) {
            letters.pair(code, *letter);
        }
        pdf.cmap(letters_at, &letters.finish()).name(name).system_info(IDENTITY);
        let glyphs: Vec<u8> = std::iter::once(0).chain(glyphs).flat_map(u16::to_be_bytes).collect();
        pdf.stream(glyphs_at, &glyphs);
        Ok(())
    }
}

/// Returns six capitals that identify this subset of the font.
fn tag(letters: &[(char, GlyphId)]) -> String {
    // FNV-1a gives the same tag in every build, so that the file is reproducible.
    let seed = 0xcbf2_9ce4_8422_2325_u64;
    let mut hash = letters.iter().fold(seed, |hash, (letter, _)| {
        (hash ^ u64::from(u32::from(*letter))).wrapping_mul(0x0100_0000_01b3)
    });
    let mut capital = || {
        let capital = b'A' + (hash % 26) as u8;
        hash /= 26;
        char::from(capital)
    };
    std::iter::repeat_with(&mut capital).take(6).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{FontDefinitions, FontFamily};

    /// Returns fonts with all letters of labels.
    fn fonts() -> Fonts {
        let fonts = FontDefinitions::default();
        let names = fonts.families[&FontFamily::Proportional].iter().map(String::as_str).chain(["Hack"]);
        let font = |name: &str| FigureFont {
            file: (*fonts.font_data[name].font).as_ref().to_vec(),
            index: fonts.font_data[name].index,
            scale: 1.0,
            drop: [0.0; 2],
        };
        Fonts::new(names.map(font).collect())
    }

    #[test]
    fn every_letter_of_a_label_has_a_glyph() {
        let mut fonts = fonts();
        let named = ('!'..='~').chain('À'..='ÿ').chain("αβκλπ′″−–—…€×²→".chars());
        for letter in named {
            let (face, glyph) = fonts.find(letter).unwrap_or_else(|| panic!("no font has {letter}"));
            assert_ne!(glyph, GlyphId::NOTDEF, "{letter}");
            let font = fonts.faces[face].font().unwrap();
            let bounds = font.glyph_metrics(Size::unscaled(), LocationRef::default()).bounds(glyph).unwrap();
            assert!(bounds.x_max > bounds.x_min, "{letter} is empty");
        }
        // A letter that no font has is replaced, and can still be selected as itself.
        let runs = fonts.write("p語");
        assert_eq!(runs.iter().map(|run| run.codes.len()).sum::<usize>(), 4);
        assert!(fonts.faces.iter().flat_map(|face| &face.letters).any(|(letter, _)| *letter == '語'));
    }

    #[test]
    fn letters_of_a_font_are_numbered_and_embedded_with_their_widths() {
        let mut fonts = fonts();
        let runs = fonts.write("abba");
        assert_eq!(runs, [Run { font: 0, codes: vec![0, 1, 0, 2, 0, 2, 0, 1] }]);
        let mut pdf = Pdf::new();
        let [(name, _)] = &fonts.embed(&mut pdf, 5).unwrap()[..] else { panic!("one font") };
        assert_eq!(*name, fonts.style(&runs[0], 13.0).0);
        let bytes = pdf.finish();
        let has = |what: &str| bytes.windows(what.len()).any(|part| part == what.as_bytes());
        for what in ["/FontFile2 8 0 R", "+Ubuntu-Light", "<0001> <0061>", "<0002> <0062>", "/Identity-H"] {
            assert!(has(what), "{what}");
        }
        let font = fonts.faces[0].font().unwrap();
        let width = font.glyph_metrics(Size::new(1000.0), LocationRef::default());
        let widths =
            ['a', 'b'].map(|letter| width.advance_width(font.charmap().map(letter).unwrap()).unwrap());
        assert!(has(&format!("/W [1 [{} {}]]", widths[0], widths[1])), "{widths:?}");
        assert!(bytes.len() < 40_000, "only the letters that were written: {}", bytes.len());
    }
}
