//! Appearance of the two pictures on the screen.

use super::document::Side;
use super::picture::Pictures;
use crate::image::Rendition;

/// Appearance of both pictures. It is discarded with the pictures.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tones {
    pub of: [Rendition; 2],
    /// The adjusted picture; `None` adjusts both.
    pub alone: Option<Side>,
}

/// A command about the appearance of the pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TonesCommand {
    /// Select the adjusted picture; `None` selects both.
    Adjust(Option<Side>),
    /// Set the appearance of the adjusted pictures.
    Set(Rendition),
    /// Stretch the adjusted pictures from black to white.
    Stretch,
    Reset,
}

impl Tones {
    /// Returns the appearance shown by the sliders.
    pub fn adjusted(&self) -> Rendition {
        self.of[self.alone.map_or(0, Side::index)]
    }

    pub fn apply(&mut self, command: TonesCommand, pictures: Option<&Pictures>) {
        let alone = self.alone;
        let wanted = |side: Side| alone.is_none_or(|alone| alone == side);
        match command {
            TonesCommand::Adjust(alone) => self.alone = alone,
            TonesCommand::Reset => self.of = Default::default(),
            TonesCommand::Set(rendition) => {
                for side in Side::BOTH.into_iter().filter(|side| wanted(*side)) {
                    let own = &mut self.of[side.index()];
                    // Sliders do not change black and white, which each picture has for itself.
                    let range = own.range;
                    *own = Rendition { range, ..rendition };
                }
            }
            TonesCommand::Stretch => {
                let Some(pictures) = pictures else { return };
                for side in Side::BOTH.into_iter().filter(|side| wanted(*side)) {
                    let own = &mut self.of[side.index()];
                    *own = own.stretched(&pictures[side.index()]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::shared::Shared;
    use crate::image::Picture;

    #[test]
    #[expect(clippy::float_cmp, reason = "these numbers are set, not computed")]
    fn one_or_both_pictures_are_adjusted_with_separate_ranges() {
        let flat = |from: u8| {
            let pixels = image::GrayImage::from_fn(64, 64, |x, _| image::Luma([from + x as u8]));
            Shared::new(Picture::from_pixels("test".into(), None, pixels.into()).unwrap())
        };
        let pictures = [flat(10), flat(100)];
        let mut tones = Tones::default();
        tones.apply(TonesCommand::Stretch, Some(&pictures));
        assert!(tones.of[0].range[1] < tones.of[1].range[0]);
        tones.apply(TonesCommand::Set(Rendition { stops: 2.0, ..tones.adjusted() }), Some(&pictures));
        assert!(tones.of.iter().all(|own| own.stops == 2.0) && tones.of[0].range != tones.of[1].range);
        tones.apply(TonesCommand::Adjust(Some(Side::Right)), None);
        tones.apply(TonesCommand::Set(Rendition { stops: -1.0, ..tones.adjusted() }), None);
        assert_eq!(tones.of.map(|own| own.stops), [2.0, -1.0]);
        tones.apply(TonesCommand::Reset, None);
        assert!(tones.of.iter().all(Rendition::is_plain));
    }
}
