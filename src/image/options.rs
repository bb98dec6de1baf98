//! Options for reading pictures.

use super::LoadError;
use super::limit::{MEGAPIXELS_VARIABLE, weight};

/// Limits for reading pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoadOptions {
    /// Maximum number of pixels. Pixels wider than 8 bytes (floating-point colours) count for more.
    pub most_pixels: u64,
}

impl Default for LoadOptions {
    /// Returns a limit of 250 million pixels, which takes about 6 GB for a pair.
    fn default() -> Self {
        Self { most_pixels: 250_000_000 }
    }
}

impl LoadOptions {
    /// Returns the default options, overridden by the environment variable [`MEGAPIXELS_VARIABLE`].
    pub fn from_environment() -> Result<Self, LoadError> {
        Self::of(std::env::var_os(MEGAPIXELS_VARIABLE).map(|value| value.to_string_lossy().into_owned()))
    }

    fn of(megapixels: Option<String>) -> Result<Self, LoadError> {
        let Some(value) = megapixels.filter(|value| !value.is_empty()) else { return Ok(Self::default()) };
        match value.trim().parse::<f64>() {
            Ok(number) if (0.0001..=100_000.0).contains(&number) => {
                Ok(Self { most_pixels: (number * 1e6) as u64 })
            }
            _ => Err(LoadError::Setting {
                name: MEGAPIXELS_VARIABLE,
                value: crate::foreign::excerpt(&value),
                expected: "millions of pixels, 0.0001 to 100000",
            }),
        }
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
            return Err(LoadError::Empty(path));
        }
        let (width, height) = (u64::from(width), u64::from(height));
        if self.allows(width * height, bytes_a_pixel) {
            return Ok(());
        }
        let most_pixels = self.most_pixels;
        Err(LoadError::TooLarge { path, width, height, bytes_a_pixel, most_pixels })
    }

    /// Returns whether a number of pixels, of a width in bytes, is within the limit.
    pub(super) fn allows(self, pixels: u64, bytes_a_pixel: u64) -> bool {
        weight(pixels, bytes_a_pixel) <= u128::from(self.most_pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_changes_the_default_or_is_refused() {
        let of = |value: &str| LoadOptions::of(Some(value.to_owned()));
        for unset in [LoadOptions::of(None), of("")] {
            assert_eq!(unset.unwrap(), LoadOptions::default());
        }
        assert_eq!(of("0.5").unwrap().most_pixels, 500_000);
        for wrong in ["much", "-1", "nan"] {
            let message = of(wrong).unwrap_err().to_string();
            assert!(message.contains("EPILINE_") && message.contains("expected"), "{message}");
        }
    }

    #[test]
    fn wide_pixels_count_for_more() {
        let options = LoadOptions { most_pixels: 100 };
        assert!(options.allows(100, 1) && options.allows(100, 8) && !options.allows(101, 1));
        assert!(options.allows(50, 16) && !options.allows(51, 16));
        assert!(!options.allows(u64::MAX, u64::MAX));
    }
}
