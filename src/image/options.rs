//! Options for reading pictures.

use super::LoadError;
use super::limit::{DAMAGED_VARIABLE, MEGAPIXELS_VARIABLE, weight};

/// Limits and tolerances for reading pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoadOptions {
    /// Maximum number of pixels. Pixels wider than 8 bytes (floating-point colours) count for more.
    pub most_pixels: u64,
    /// Whether damaged or incomplete pictures are read as far as possible. Missing parts are black
    /// or grey.
    pub accept_damaged: bool,
}

impl Default for LoadOptions {
    /// Returns a limit of 250 million pixels, which takes about 6 GB for a pair, without damaged
    /// pictures.
    fn default() -> Self {
        Self { most_pixels: 250_000_000, accept_damaged: false }
    }
}

impl LoadOptions {
    /// Returns the default options, overridden by the environment variables [`MEGAPIXELS_VARIABLE`]
    /// and [`DAMAGED_VARIABLE`].
    pub fn from_environment() -> Result<Self, LoadError> {
        let value = |name| std::env::var_os(name).map(|value| value.to_string_lossy().into_owned());
        Self::of(value(MEGAPIXELS_VARIABLE).as_deref(), value(DAMAGED_VARIABLE).as_deref())
    }

    fn of(megapixels: Option<&str>, damaged: Option<&str>) -> Result<Self, LoadError> {
        let wrong = |name, value: &str, expected| LoadError::Setting {
            name,
            value: crate::foreign::excerpt(value),
            expected,
        };
        let mut options = Self::default();
        match megapixels.map(|value| (value, value.trim().parse::<f64>())) {
            None | Some(("", _)) => {}
            Some((_, Ok(number))) if (0.0001..=100_000.0).contains(&number) => {
                options.most_pixels = (number * 1e6) as u64;
            }
            Some((value, _)) => {
                return Err(wrong(MEGAPIXELS_VARIABLE, value, "millions of pixels, 0.0001 to 100000"));
            }
        }
        match damaged {
            None | Some("" | "0") => {}
            Some("1") => options.accept_damaged = true,
            Some(value) => return Err(wrong(DAMAGED_VARIABLE, value, "1 or 0")),
        }
        Ok(options)
    }

    /// Returns an error if a picture of the given size exceeds the limit or has no pixels.
    pub(crate) fn check(
        self,
        path: &str,
        width: u32,
        height: u32,
        bytes_a_pixel: u64,
    ) -> Result<(), LoadError> {
        let path = path.to_owned();
        if width == 0 || height == 0 {
            return Err(LoadError::Empty { path });
        }
        let (width, height) = (u64::from(width), u64::from(height));
        if self.allows(width * height, bytes_a_pixel) {
            return Ok(());
        }
        let most_pixels = self.most_pixels;
        Err(LoadError::TooLarge { path, width, height, bytes_a_pixel, most_pixels })
    }

    /// Returns whether so many pixels of the given width in bytes are within the limit.
    pub(super) fn allows(self, pixels: u64, bytes_a_pixel: u64) -> bool {
        weight(pixels, bytes_a_pixel) <= u128::from(self.most_pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_changes_the_default_or_is_refused() {
        assert_eq!(LoadOptions::of(None, None).unwrap(), LoadOptions::default());
        assert_eq!(LoadOptions::of(Some("0.5"), Some("1")).unwrap().most_pixels, 500_000);
        assert!(LoadOptions::of(None, Some("1")).unwrap().accept_damaged);
        for (megapixels, damaged) in [("much", "0"), ("-1", "0"), ("nan", "0"), ("1", "yes")] {
            let message = LoadOptions::of(Some(megapixels), Some(damaged)).unwrap_err().to_string();
            assert!(message.contains("EPILINE_") && message.contains("expected"), "{message}");
        }
    }

    #[test]
    fn wide_pixels_count_for_more() {
        let options = LoadOptions { most_pixels: 100, accept_damaged: false };
        assert!(options.allows(100, 1) && options.allows(100, 8) && !options.allows(101, 1));
        assert!(options.allows(50, 16) && !options.allows(51, 16));
        assert!(!options.allows(u64::MAX, u64::MAX));
    }
}
