//! Decoding of untrusted pictures in any format.
//!
//! The size in a header is compared with the limit before memory of that size is allocated. The
//! decoders have a memory limit of their own.
//!
//! # Pitfalls
//! - Not every decoder keeps to its limit, and the JPEG decoder fills in missing data.

use std::io::{BufRead, ErrorKind, Seek};

use image::metadata::Orientation;
use image::{
    ColorType, DynamicImage, ImageBuffer, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits,
};

use super::deep_tiff::{DeepTiff, within_unit};
use super::tiff_header::lists_fit;
use super::webp::WebpClaims;
use super::whole::what_is_missing;
use super::{LoadError, LoadOptions};
use crate::foreign::{excerpt, reason};

/// Memory the decoders may use for texts, colour profiles and rows, bytes.
const SLACK: u64 = 64 << 20;

/// Supported formats.
const KNOWN: [ImageFormat; 6] = [
    ImageFormat::Png,
    ImageFormat::Jpeg,
    ImageFormat::Tiff,
    ImageFormat::Bmp,
    ImageFormat::Pnm,
    ImageFormat::WebP,
];

/// Decodes the pixels of a file, upright. `path` is the name used in messages.
pub(super) fn decode(
    mut reader: impl BufRead + Seek,
    path: &str,
    options: LoadOptions,
) -> Result<DynamicImage, LoadError> {
    let job = Job { path, options };
    // The content alone decides: a file with a misleading name is not damaged.
    let guessed = ImageReader::new(&mut reader).with_guessed_format().map_err(|e| job.io(&e))?;
    let Some(format) = guessed.format() else {
        return Err(LoadError::Format(job.path()));
    };
    if !KNOWN.contains(&format) {
        let format = format.extensions_str()[0].to_uppercase();
        return Err(LoadError::OtherFormat { path: job.path(), format });
    }
    if let Some(missing) = what_is_missing(format, &mut reader).map_err(|e| job.io(&e))? {
        // A size above the limit is the more useful error.
        job.check_header(format, &mut reader)?;
        return Err(job.damaged(missing));
    }
    if format == ImageFormat::Png {
        job.check_png(&mut reader)?;
    }
    if format == ImageFormat::Tiff && !lists_fit(&mut reader).map_err(|e| job.io(&e))? {
        return Err(job.damaged("a list in its header is longer than the file"));
    }
    let mut says_which_way_is_up = true;
    if format == ImageFormat::WebP {
        let claims = WebpClaims::read(&mut reader).map_err(|e| job.io(&e))?;
        claims.pictures.iter().try_for_each(|[width, height]| job.check(*width, *height, 4))?;
        says_which_way_is_up = claims.metadata_is_there;
    }
    reader.rewind().map_err(|e| job.io(&e))?;
    if format == ImageFormat::Tiff
        && let Some(deep) = DeepTiff::open(&mut reader)
    {
        let [width, height] = deep.size;
        job.check(width, height, deep.bytes_a_pixel)?;
        let pixels = deep.read().map_err(|error| job.damaged(&error.to_string()))?;
        return pixels.ok_or_else(|| LoadError::NotFinite(job.path()));
    }
    reader.rewind().map_err(|e| job.io(&e))?;
    let mut decoder = job.decoder(format, &mut reader)?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    job.check(width, height, u64::from(color.bytes_per_pixel()))?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(decoder.total_bytes().saturating_mul(2).saturating_add(SLACK));
    decoder.set_limits(limits).map_err(|e| job.failed(e))?;
    let orientation = if says_which_way_is_up { decoder.orientation().ok() } else { None };
    let orientation = orientation.unwrap_or(Orientation::NoTransforms);
    let mut pixels = job.pixels(decoder, color)?;
    pixels.apply_orientation(orientation);
    within_unit(pixels).ok_or_else(|| LoadError::NotFinite(job.path()))
}

/// Name and options of the file being decoded, for checks and messages.
struct Job<'a> {
    path: &'a str,
    options: LoadOptions,
}

impl Job<'_> {
    fn path(&self) -> String {
        self.path.to_owned()
    }

    fn damaged(&self, reason: &str) -> LoadError {
        let reason = plain(reason);
        // Each decoder words its complaint about dimensions differently.
        if ["too large", "dimensions"].iter().any(|words| reason.contains(words)) {
            return LoadError::Enormous(self.path());
        }
        LoadError::Damaged(self.path(), reason)
    }

    fn io(&self, error: &std::io::Error) -> LoadError {
        match error.kind() {
            ErrorKind::UnexpectedEof => self.damaged("it ends too early"),
            _ => LoadError::Open(self.path(), reason(error)),
        }
    }

    fn failed(&self, error: ImageError) -> LoadError {
        match error {
            ImageError::IoError(error) => match error.kind() {
                // Decoders also report their own problems as input errors.
                ErrorKind::UnexpectedEof => self.damaged("it ends too early"),
                ErrorKind::InvalidData | ErrorKind::InvalidInput | ErrorKind::Other => {
                    self.damaged(&error.to_string())
                }
                _ => self.io(&error),
            },
            ImageError::Unsupported(error) => match self.damaged(&error.to_string()) {
                LoadError::Damaged(path, reason) => LoadError::Unsupported(path, reason),
                enormous => enormous,
            },
            ImageError::Limits(_) => LoadError::Memory(self.path()),
            other => self.damaged(&other.to_string()),
        }
    }

    /// Checks a size against the limit.
    fn check(&self, width: u32, height: u32, bytes_a_pixel: u64) -> Result<(), LoadError> {
        self.options.check(self.path, width, height, bytes_a_pixel)
    }

    /// Checks the size in the header. An unreadable header passes.
    fn check_header(&self, format: ImageFormat, reader: &mut (impl BufRead + Seek)) -> Result<(), LoadError> {
        reader.rewind().map_err(|e| self.io(&e))?;
        let Ok(decoder) = self.decoder(format, reader) else { return Ok(()) };
        let (width, height) = decoder.dimensions();
        self.check(width, height, u64::from(decoder.color_type().bytes_per_pixel()))
    }

    /// Checks the size at the start of a PNG header, because the PNG decoder allocates its rows
    /// before it reports their length.
    fn check_png(&self, reader: &mut (impl BufRead + Seek)) -> Result<(), LoadError> {
        let mut header = [0; 24];
        reader.rewind().map_err(|e| self.io(&e))?;
        if reader.read_exact(&mut header).is_err() || &header[12..16] != b"IHDR" {
            return Ok(());
        }
        let side =
            |at: usize| u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        self.check(side(16), side(20), 1)
    }

    fn decoder<'r>(
        &self,
        format: ImageFormat,
        reader: &'r mut (impl BufRead + Seek),
    ) -> Result<impl ImageDecoder + 'r, LoadError> {
        let mut reader = ImageReader::with_format(reader, format);
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(SLACK);
        reader.limits(limits);
        reader.into_decoder().map_err(|e| self.failed(e))
    }

    /// Reads the pixels in the file's own format.
    fn pixels(&self, decoder: impl ImageDecoder, color: ColorType) -> Result<DynamicImage, LoadError> {
        type Kind = DynamicImage;
        match color {
            ColorType::L8 => self.buffer(decoder).map(Kind::ImageLuma8),
            ColorType::La8 => self.buffer(decoder).map(Kind::ImageLumaA8),
            ColorType::Rgb8 => self.buffer(decoder).map(Kind::ImageRgb8),
            ColorType::Rgba8 => self.buffer(decoder).map(Kind::ImageRgba8),
            ColorType::L16 => self.buffer(decoder).map(Kind::ImageLuma16),
            ColorType::La16 => self.buffer(decoder).map(Kind::ImageLumaA16),
            ColorType::Rgb16 => self.buffer(decoder).map(Kind::ImageRgb16),
            ColorType::Rgba16 => self.buffer(decoder).map(Kind::ImageRgba16),
            ColorType::Rgb32F => self.buffer(decoder).map(Kind::ImageRgb32F),
            ColorType::Rgba32F => self.buffer(decoder).map(Kind::ImageRgba32F),
            other => Err(LoadError::Unsupported(self.path(), format!("pixels of the kind {other:?}"))),
        }
    }

    fn buffer<P>(&self, decoder: impl ImageDecoder) -> Result<ImageBuffer<P, Vec<P::Subpixel>>, LoadError>
    where
        P: image::Pixel<Subpixel: bytemuck::Pod>,
    {
        let (width, height) = decoder.dimensions();
        let memory = |_| LoadError::Memory(self.path());
        let count = width as usize * height as usize;
        // The grey plane needs memory next. An error here is better than an abort there.
        Vec::<f32>::new().try_reserve_exact(count).map_err(memory)?;
        let mut values: Vec<P::Subpixel> = Vec::new();
        let length = count * usize::from(P::CHANNEL_COUNT);
        values.try_reserve_exact(length).map_err(memory)?;
        values.resize(length, bytemuck::Zeroable::zeroed());
        decoder.read_image(bytemuck::cast_slice_mut(&mut values)).map_err(|e| self.failed(e))?;
        ImageBuffer::from_raw(width, height, values)
            .ok_or_else(|| self.damaged("its pixels are not all there"))
    }
}

/// Shortens a decoder's message and removes the part about the decoder.
fn plain(reason: &str) -> String {
    let reason = reason.trim().trim_end_matches('.');
    let known = ["does not support the format features ", "does not support the color type "];
    let behind = known.iter().find_map(|words| reason.split_once(words)).map(|(_, rest)| rest);
    let behind = behind.or_else(|| {
        let (start, rest) = reason.split_once(": ")?;
        start.starts_with("Format error decoding").then_some(rest)
    });
    let reason = behind.unwrap_or(reason);
    excerpt(reason.strip_prefix("format error: ").unwrap_or(reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_that_is_not_read_is_named_with_a_way_around() {
        for (content, name) in [(&b"\x76\x2f\x31\x01\x02\0\0\0"[..], "EXR"), (b"GIF89a\x01\0\x01\0", "GIF")] {
            let error = decode(std::io::Cursor::new(content), "a.dat", LoadOptions::default()).unwrap_err();
            let message = error.to_string();
            assert!(message.contains(&format!("has the format {name}")), "{message}");
            assert!(message.contains("Convert it to TIFF or PNG"), "{message}");
        }
    }
}
