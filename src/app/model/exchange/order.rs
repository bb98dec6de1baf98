//! Kinds and options of exports.

use std::path::PathBuf;

use crate::app::model::ids::OverlayId;
use crate::io::{Format, PictureFormat, RectifiedOptions};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ExportKind {
    /// F and epipoles of the shown geometry, point pairs and rectifying homographies.
    #[default]
    Geometry,
    /// F of the shown geometry as an array for NumPy.
    Array,
    /// Homography of the plane, where nothing else is certain.
    Plane,
    Pairs,
    /// Point pairs with names, origins, roles and distances.
    Table,
    /// The result of the estimate with all its figures.
    Report,
    /// The matches as scene points, and both cameras.
    Cloud,
    /// Intensities along the inspected line pair.
    Profile,
    /// Both images with overlays, for a paper.
    Figure,
    /// Picture of the screen.
    View,
    /// A copy of a database of COLMAP with the shown geometry and its matches.
    Colmap,
    /// The rectified pair: a folder with both pictures.
    Rectified,
    /// Both pictures without the distortion of their lens: a folder with their geometry.
    Undistorted,
}

impl ExportKind {
    /// All kinds in the order of the dialog: names, endings of suggested file names, tooltips.
    const TABLE: [(Self, &'static str, &'static str, &'static str); 13] = [
        (
            Self::Geometry,
            "Geometry",
            "geometry",
            "F and epipoles of the shown geometry, the point pairs, and the homographies that \
             rectify the images, if homographies suffice.",
        ),
        (Self::Array, "NumPy array", "F", "F of the shown geometry alone, as a file that numpy.load reads."),
        (
            Self::Plane,
            "Homography of the plane",
            "plane",
            "Homography from the left image to the right one. Nothing more is certain when \
             everything lies on one plane or the camera only rotated.",
        ),
        (Self::Pairs, "Pairs alone", "pairs", "The point pairs that are not left out."),
        (
            Self::Table,
            "Table",
            "points",
            "The point pairs with name, origin, role and distance, as comma-separated values for a spreadsheet.",
        ),
        (
            Self::Report,
            "Report",
            "report",
            "The result of the estimate: F, verdict, figures, matches, parameters and times.",
        ),
        (
            Self::Cloud,
            "3-D points",
            "cloud",
            "The matches as coloured scene points and both cameras, as PLY. Geometry and Report have the pose.",
        ),
        (
            Self::Profile,
            "Profile",
            "profile",
            "Intensities, shifts and costs along the inspected line pair, as a table.",
        ),
        (
            Self::Figure,
            "Figure",
            "figure",
            "Both images with the visible overlays, for a paper: SVG or PDF with lines and text.",
        ),
        (Self::View, "Picture", "view", "Both images as on the screen, with all overlays."),
        (
            Self::Colmap,
            "COLMAP database",
            "epiline",
            "A copy of a database of COLMAP with the shown geometry, the point pairs and the matches added, for the \
             mapper of COLMAP. The database needs both pictures, under the same names and with the same sizes.",
        ),
        (
            Self::Rectified,
            "Rectified pair",
            "rectified",
            "A folder with both rectified pictures at full size, one picture of both with guide lines, and \
             rectification.json.",
        ),
        (
            Self::Undistorted,
            "Without distortion",
            "undistorted",
            "A folder with both pictures drawn without the distortion of their lens, and geometry.json with F and \
             the point pairs of these pictures. Any program can use F with them as it is.",
        ),
    ];

    pub const COUNT: usize = Self::TABLE.len();

    /// Returns all kinds, in the order of the dialog.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::TABLE.into_iter().map(|(kind, ..)| kind)
    }

    /// Returns whether this is written as a folder.
    pub fn is_folder(self) -> bool {
        matches!(self, Self::Rectified | Self::Undistorted)
    }

    pub fn name(self) -> &'static str {
        Self::TABLE[self as usize].1
    }

    /// Returns the ending of suggested file names, without the extension.
    pub fn file_name(self) -> &'static str {
        Self::TABLE[self as usize].2
    }

    pub fn tooltip(self) -> &'static str {
        Self::TABLE[self as usize].3
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FigureFormat {
    /// SVG with embedded PNG images, vector lines and text.
    #[default]
    Svg,
    /// PDF with the same contents, for typesetting.
    Pdf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FigureChoices {
    pub format: FigureFormat,
    /// Whether points and lines are labelled.
    pub labels: bool,
    pub dark: bool,
    /// Whether only the visible part of the images is included.
    pub seen: bool,
    /// Overlays that are excluded although the window shows them.
    left_out: [bool; OverlayId::COUNT],
}

impl FigureChoices {
    /// Returns whether the figure includes a visible overlay.
    pub fn has(&self, layer: OverlayId) -> bool {
        !self.left_out[layer as usize]
    }

    pub fn set(&mut self, layer: OverlayId, on: bool) {
        self.left_out[layer as usize] = !on;
    }
}

impl Default for FigureChoices {
    fn default() -> Self {
        let mut left_out = [false; OverlayId::COUNT];
        // Marks of a search mean nothing to readers who have not seen it.
        left_out[OverlayId::Hypotheses as usize] = true;
        Self { format: FigureFormat::default(), labels: true, dark: false, seen: false, left_out }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReportFormat {
    #[default]
    Text,
    Json,
}

#[derive(Debug, Clone, PartialEq)]
pub struct ExportOrder {
    /// Path of the file, or of the folder of a rectified pair.
    pub path: PathBuf,
    pub what: ExportKind,
    /// Database of COLMAP to copy.
    pub database: PathBuf,
    /// Format of geometry and point pairs.
    pub format: Format,
    /// Whether to add the matches behind the result to the point pairs.
    pub with_matches: bool,
    pub reported: ReportFormat,
    pub figure: FigureChoices,
    pub rectified: RectifiedOptions,
}

impl Default for ExportOrder {
    fn default() -> Self {
        Self {
            path: PathBuf::new(),
            database: PathBuf::new(),
            what: ExportKind::default(),
            format: Format::Json,
            with_matches: false,
            reported: ReportFormat::default(),
            figure: FigureChoices::default(),
            rectified: RectifiedOptions { format: PictureFormat::Png, guide_spacing: 40, maps: false },
        }
    }
}
