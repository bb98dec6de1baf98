//! Picture formats that are not read, recognised by their first bytes.

use super::LoadError;

/// Number of bytes that tell the format.
pub(super) const START: usize = 136;

/// A format that is not read, and what to do with such a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ForeignFormat {
    pub name: &'static str,
    pub way: &'static str,
}

/// Advice for a format without any of its own.
pub(super) const CONVERT: &str = "Convert it to TIFF or PNG";
const DEVELOP: &str =
    "It holds the raw data of a camera. Develop it to TIFF or PNG, for example: darktable-cli IN.NEF OUT.tif";
const GDAL: &str = "Convert it to TIFF, for example: gdal_translate IN OUT.tif";
const HEIF: &str = "Convert it to TIFF or PNG, for example: heif-convert IN.heic OUT.png";

/// Raw data of a camera in a TIFF file, whose only ordinary picture is a small preview.
pub(super) const RAW: ForeignFormat = ForeignFormat { name: "camera raw", way: DEVELOP };
pub(super) const DNG: ForeignFormat = ForeignFormat { name: "DNG (camera raw)", way: DEVELOP };

/// Position and bytes of the signature, name, advice.
const SIGNATURES: [(usize, &[u8], &str, &str); 31] = [
    (8, b"CR\x02", "CR2 (camera raw)", DEVELOP),
    (0, b"FUJIFILMCCD-RAW", "RAF (camera raw)", DEVELOP),
    (0, b"IIRO", "ORF (camera raw)", DEVELOP),
    (0, b"IIRS", "ORF (camera raw)", DEVELOP),
    (0, b"IIU\0", "RW2 (camera raw)", DEVELOP),
    (0, b"FOVb", "X3F (camera raw)", DEVELOP),
    (4, b"ftypcrx ", "CR3 (camera raw)", DEVELOP),
    (4, b"ftypheic", "HEIC", HEIF),
    (4, b"ftypheix", "HEIC", HEIF),
    (4, b"ftyphevc", "HEIC", HEIF),
    (4, b"ftypmif1", "HEIF", HEIF),
    (4, b"ftypmsf1", "HEIF", HEIF),
    (4, b"ftypavi", "AVIF", HEIF),
    (0, b"\0\0\0\x0cjP  ", "JPEG 2000", GDAL),
    (0, b"\xff\x4f\xff\x51", "JPEG 2000", GDAL),
    (0, b"\0\0\0\x0cJXL ", "JPEG XL", "Convert it to TIFF or PNG, for example: djxl IN.jxl OUT.png"),
    (0, b"\xff\x0a", "JPEG XL", "Convert it to TIFF or PNG, for example: djxl IN.jxl OUT.png"),
    (0, b"\x76\x2f\x31\x01", "EXR", CONVERT),
    (0, b"#?RADIANCE", "Radiance HDR", CONVERT),
    (0, b"#?RGBE", "Radiance HDR", CONVERT),
    (0, b"PF\n", "PFM", CONVERT),
    (0, b"Pf\n", "PFM", CONVERT),
    (
        0,
        b"GIF8",
        "GIF",
        "Convert it to TIFF or PNG, an animation to a video or to numbered pictures in a folder",
    ),
    (0, b"%PDF", "PDF", "Convert it to PNG, for example: pdftoppm -png IN.pdf OUT"),
    (0, b"SIMPLE  =", "FITS", GDAL),
    (128, b"DICM", "DICOM", CONVERT),
    (
        0,
        b"\x93NUMPY",
        "NumPy array",
        "Save it as TIFF, in Python: tifffile.imwrite('OUT.tif', numpy.load('IN.npy'))",
    ),
    (0, b"\x89HDF\r\n\x1a\n", "HDF5", GDAL),
    (0, b"CDF\x01", "netCDF", GDAL),
    (0, b"MATLAB 5.0 MAT-file", "MATLAB", "Save it as TIFF, in MATLAB: imwrite(IMAGE, 'OUT.tif')"),
    (0, b"8BPS", "Photoshop", CONVERT),
];

impl ForeignFormat {
    /// Recognises a file by its first bytes.
    pub fn recognise(start: &[u8]) -> Option<Self> {
        let is_it = |(at, bytes): (usize, &[u8])| start.get(at..).is_some_and(|rest| rest.starts_with(bytes));
        let (_, _, name, way) = SIGNATURES.into_iter().find(|(at, bytes, ..)| is_it((*at, bytes)))?;
        Some(Self { name, way })
    }

    pub fn error(self, path: &str) -> LoadError {
        let Self { name, way } = self;
        LoadError::OtherFormat { path: path.to_owned(), format: name.to_owned(), way }
    }
}
