//! Decoding of untrusted pictures in any format.
//!
//! The size in a header is compared with the limit before memory of that size is allocated. The
//! decoders have a memory limit of their own.
//!
//! # Pitfalls
//! - Not every decoder keeps to its limit, and the JPEG decoder fills in missing data.

use std::io::{BufRead, ErrorKind, Read, Seek};

use image::metadata::Orientation;
use image::{
    ColorType, DynamicImage, ImageBuffer, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits,
};

use super::brightness::Decoded;
use super::foreign_format::{CONVERT, ForeignFormat, START};
use super::limit::WIDE_PIXEL;
use super::tiff_file::{self, TiffFault};
use super::tiff_header::TiffHeader;
use super::tiff_tags::TiffTags;
use super::webp::WebpClaims;
use super::whole::what_is_missing;
use super::{LoadError, LoadOptions};
use crate::foreign::{excerpt, reason};
use tiff::TiffError;

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
) -> Result<Decoded, LoadError> {
    let job = Job { path, options };
    if let Some(foreign) = job.foreign_format(&mut reader)? {
        return Err(foreign.error(path));
    }
    // The content alone decides: a file with a misleading name is not damaged.
    let guessed = ImageReader::new(&mut reader).with_guessed_format().map_err(|e| job.io(&e))?;
    let guessed = guessed.format();
    let tiff = TiffHeader::read(&mut reader).map_err(|e| job.io(&e))?;
    // The guess does not know BigTIFF.
    let Some(format) = guessed.or(tiff.is_some().then_some(ImageFormat::Tiff)) else {
        return Err(LoadError::Format(job.path()));
    };
    if !KNOWN.contains(&format) {
        let format = format.extensions_str()[0].to_uppercase();
        return Err(LoadError::OtherFormat { path: job.path(), format, way: CONVERT });
    }
    if let Some(missing) = what_is_missing(format, &mut reader).map_err(|e| job.io(&e))? {
        // A size above the limit is the more useful error.
        job.check_header(format, &mut reader)?;
        return Err(job.damaged(missing));
    }
    if format == ImageFormat::Png {
        job.check_png(&mut reader)?;
    }
    let mut no_data = None;
    if let Some(header) = tiff.filter(|_| format == ImageFormat::Tiff) {
        let tags = job.tiff_tags(&header, &mut reader)?;
        if !tags.is_ordinary() {
            return job.special_tiff(&header, &tags, reader);
        }
        no_data = tags.no_data;
    }
    let mut says_which_way_is_up = true;
    if format == ImageFormat::WebP {
        let claims = WebpClaims::read(&mut reader).map_err(|e| job.io(&e))?;
        claims.pictures.iter().try_for_each(|[width, height]| job.check(*width, *height, 4))?;
        says_which_way_is_up = claims.metadata_is_there;
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
    Ok(Decoded { pixels, range: None, no_data, bands: None })
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

    /// Recognises a format that is not read by its first bytes.
    fn foreign_format(&self, reader: &mut (impl BufRead + Seek)) -> Result<Option<ForeignFormat>, LoadError> {
        let mut start = Vec::new();
        reader.take(START as u64).read_to_end(&mut start).map_err(|e| self.io(&e))?;
        reader.rewind().map_err(|e| self.io(&e))?;
        Ok(ForeignFormat::recognise(&start))
    }

    /// Reads what a TIFF file says about its picture, and refuses kinds that are not read.
    fn tiff_tags(
        &self,
        header: &TiffHeader,
        reader: &mut (impl BufRead + Seek),
    ) -> Result<TiffTags, LoadError> {
        if !header.lists_fit() {
            return Err(self.damaged("a list in its header is longer than the file"));
        }
        let tags = TiffTags::read(header, reader).map_err(|e| self.io(&e))?;
        if let Some(raw) = tags.camera_raw() {
            return Err(raw.error(self.path));
        }
        if let Some(name) = tags.unread_compression() {
            return Err(LoadError::Compression { path: self.path(), name });
        }
        if !tags.webp_fits(header, reader).map_err(|e| self.io(&e))? {
            return Err(self.damaged("a part of it is larger than the picture"));
        }
        Ok(tags)
    }

    /// Reads a TIFF file that the general decoder does not support.
    fn special_tiff(
        &self,
        header: &TiffHeader,
        tags: &TiffTags,
        reader: impl BufRead + Seek,
    ) -> Result<Decoded, LoadError> {
        let [width, height] = tags.size;
        self.check(width, height, tags.bytes_a_pixel())?;
        let most_bytes = self.options.most_pixels.saturating_mul(WIDE_PIXEL);
        let mut decoded = tiff_file::read(header, tags, reader, most_bytes).map_err(|fault| match fault {
            TiffFault::Decoder(TiffError::UnsupportedError(error)) => {
                LoadError::Unsupported(self.path(), plain(&error.to_string()))
            }
            TiffFault::Decoder(TiffError::LimitsExceeded) => LoadError::Memory(self.path()),
            TiffFault::Decoder(TiffError::IoError(error)) => self.failed(ImageError::IoError(error)),
            TiffFault::Decoder(error) => self.damaged(&error.to_string()),
            TiffFault::Damaged(reason) => self.damaged(reason),
            TiffFault::Pixels(kind) => LoadError::Unsupported(self.path(), kind),
            TiffFault::NotFinite => LoadError::NotFinite(self.path()),
        })?;
        let upright = Orientation::from_exif(tags.orientation).unwrap_or(Orientation::NoTransforms);
        decoded.pixels.apply_orientation(upright);
        Ok(decoded)
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
