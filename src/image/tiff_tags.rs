//! What a TIFF file says about its first picture.

use std::io::{BufRead, Read, Result, Seek, SeekFrom};

use super::foreign_format::{DNG, ForeignFormat, RAW};
use super::tiff_header::{COMPRESSION, PHOTOMETRIC, TiffHeader};
use super::tiff_overlay::Chunks;
use super::webp::WebpClaims;

const STRIPS: [u16; 2] = [273, 279];
const TILES: [u16; 2] = [324, 325];

pub(super) const ZSTD: u64 = 50000;
const WEBP: u64 = 50001;
const CFA: u64 = 32803;
const LINEAR_RAW: u64 = 34892;

/// Colours of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Colours {
    Gray,
    Rgb,
    Palette,
    Cmyk,
    YCbCr,
    Other,
}

/// Kind of the numbers.
const UNSIGNED: u64 = 1;

#[derive(Debug, Clone)]
pub(super) struct TiffTags {
    pub size: [u32; 2],
    /// Bits of a sample.
    pub bits: u64,
    /// Samples per pixel.
    pub samples: u64,
    pub colours: Colours,
    /// Whether the first sample besides the colours is alpha.
    pub has_alpha: bool,
    /// Number of samples that are declared to be no colours.
    pub extra: usize,
    pub compression: u64,
    /// The value that the file declares as missing data.
    pub no_data: Option<f64>,
    /// Direction of up, as in EXIF.
    pub orientation: u8,
    /// Red, green and blue of each index, 16 bits.
    pub palette: Vec<u64>,
    photometric: u64,
    format: u64,
    is_dng: bool,
    is_preview: bool,
    chunk_rows: u64,
    tile: Option<[u64; 2]>,
}

impl TiffTags {
    pub fn read(header: &TiffHeader, reader: &mut (impl BufRead + Seek)) -> Result<Self> {
        const NO_DATA: u16 = 42113;
        const PALETTE: u16 = 320;
        const DNG_VERSION: u16 = 50706;
        const SUB_PICTURES: u16 = 330;
        let no_data = header.text(reader, NO_DATA)?.and_then(|text| text.trim().parse().ok());
        let palette = header.numbers(reader, PALETTE)?;
        let extra = header.numbers(reader, 338)?;
        let mut first =
            |tag: u16| -> Result<Option<u64>> { Ok(header.numbers(reader, tag)?.first().copied()) };
        let side = |value: Option<u64>| value.and_then(|v| u32::try_from(v).ok()).unwrap_or(0);
        let photometric = first(PHOTOMETRIC)?.unwrap_or(0);
        let tile = first(322)?.zip(first(323)?).map(|(width, height)| [width, height]);
        // Bit 0 marks a reduced version of another picture.
        let is_preview =
            first(254)?.is_some_and(|kind| kind & 1 == 1) && header.entry(SUB_PICTURES).is_some();
        Ok(Self {
            size: [side(first(256)?), side(first(257)?)],
            bits: first(258)?.unwrap_or(1),
            samples: first(277)?.unwrap_or(1),
            colours: match photometric {
                0 | 1 => Colours::Gray,
                2 => Colours::Rgb,
                3 => Colours::Palette,
                5 => Colours::Cmyk,
                6 => Colours::YCbCr,
                _ => Colours::Other,
            },
            // Premultiplied or not.
            has_alpha: extra.first().is_some_and(|kind| [1, 2].contains(kind)),
            extra: extra.len(),
            compression: first(COMPRESSION)?.unwrap_or(1),
            no_data,
            orientation: first(274)?.and_then(|v| u8::try_from(v).ok()).unwrap_or(1),
            palette,
            photometric,
            format: first(339)?.unwrap_or(UNSIGNED),
            is_dng: header.entry(DNG_VERSION).is_some(),
            is_preview,
            chunk_rows: first(278)?.unwrap_or(u64::MAX),
            tile,
        })
    }

    /// Returns the format of a file with the raw data of a camera. Its first picture is a preview, or
    /// the pixels of one colour each.
    pub fn camera_raw(&self) -> Option<ForeignFormat> {
        let is_raw = self.is_preview || [CFA, LINEAR_RAW].contains(&self.photometric);
        if self.is_dng { Some(DNG) } else { is_raw.then_some(RAW) }
    }

    /// Returns the name of a compression that is not read.
    pub fn unread_compression(&self) -> Option<String> {
        let name = match self.compression {
            1 | 4 | 5 | 7 | 8 | 32773 | 32946 | ZSTD | WEBP => return None,
            2 => "CCITT RLE",
            3 => "CCITT Group 3",
            6 => "old-style JPEG",
            32809 => "ThunderScan",
            32908 | 32909 => "Pixar",
            33003 | 33005 | 34712 => "JPEG 2000",
            34676 | 34677 => "SGI Log",
            34887 => "LERC",
            34925 => "LZMA",
            50002 | 52546 => "JPEG XL",
            other => return Some(format!("unknown ({other})")),
        };
        Some(name.to_owned())
    }

    /// Returns whether the general decoder reads the picture: unsigned grey or colour of usual depth.
    pub fn is_ordinary(&self) -> bool {
        let is_known = match self.colours {
            Colours::Gray => self.samples == 1 && [1, 8, 16].contains(&self.bits),
            // A fourth sample of unknown meaning is no alpha.
            Colours::Rgb => (self.samples == 3 || self.extra > 0) && [8, 16].contains(&self.bits),
            Colours::Cmyk => [8, 16].contains(&self.bits),
            Colours::Palette | Colours::YCbCr => false,
            // The general decoder has the messages.
            Colours::Other => true,
        };
        is_known && self.format == UNSIGNED && self.compression != ZSTD
    }

    /// Returns bytes per pixel, in the file without compression.
    pub fn bytes_a_pixel(&self) -> u64 {
        self.samples.saturating_mul(self.bits).div_ceil(8).max(1)
    }

    /// Returns the sizes of the compressed parts.
    pub fn chunks(&self) -> Chunks {
        let [width, height] = self.size.map(u64::from);
        let [columns, rows] = self.tile.unwrap_or([width, self.chunk_rows.min(height)]);
        let row = columns.saturating_mul(self.bytes_a_pixel());
        let longest = row.saturating_mul(rows);
        // Tiles reach beyond the picture by less than their own size.
        let (across, down) = (width.div_ceil(columns.max(1)), height.div_ceil(rows.max(1)));
        let most = longest.saturating_mul(across).saturating_mul(down);
        Chunks { tags: if self.tile.is_some() { TILES } else { STRIPS }, longest, most }
    }

    /// Returns whether each part that is compressed as WebP is as large as the file says. The decoder
    /// allocates a picture of any size.
    pub fn webp_fits(&self, header: &TiffHeader, reader: &mut (impl BufRead + Seek)) -> Result<bool> {
        if self.compression != WEBP {
            return Ok(true);
        }
        let [places, lengths] = self.chunks().tags;
        let (places, lengths) = (header.numbers(reader, places)?, header.numbers(reader, lengths)?);
        let [width, height] = self.tile.unwrap_or(self.size.map(u64::from));
        for (place, length) in places.iter().zip(lengths) {
            let mut bytes = Vec::new();
            reader.seek(SeekFrom::Start(*place))?;
            reader.take(length).read_to_end(&mut bytes)?;
            let claims = WebpClaims::read(&mut std::io::Cursor::new(bytes))?;
            if claims.pictures.iter().any(|[w, h]| u64::from(*w) > width || u64::from(*h) > height) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
