//! What can be written for other programs, and how.

use std::path::PathBuf;

use crate::app::model::ids::OverlayId;
use crate::io::Format;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExportKind {
    /// F and the epipoles of the geometry shown, the point pairs, the homographies that rectify.
    #[default]
    Geometry,
    /// The homography of the plane that all lies on, where that is all that is certain.
    Plane,
    /// The point pairs alone.
    Pairs,
    /// The point pairs with their names, origins, roles and distances.
    Table,
    /// The result of the estimate with everything about it.
    Report,
    /// The intensities along the inspected line pair.
    Profile,
    /// Both images with what is drawn over them, for a paper.
    Figure,
    /// What is on the screen.
    View,
}

impl ExportKind {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 8] = [
        Self::Geometry,
        Self::Plane,
        Self::Pairs,
        Self::Table,
        Self::Report,
        Self::Profile,
        Self::Figure,
        Self::View,
    ];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "Geometry",
            Self::Plane => "Homography of the plane",
            Self::Pairs => "Pairs alone",
            Self::Table => "Table",
            Self::Report => "Report",
            Self::Profile => "Profile",
            Self::Figure => "Figure",
            Self::View => "Picture",
        }
    }

    /// One sentence about what is in the file.
    pub fn tooltip(self) -> &'static str {
        match self {
            Self::Geometry => {
                "F and epipoles of the geometry that the window shows, the point pairs, and the homographies that \
                 rectify the images where one each does."
            }
            Self::Plane => {
                "The homography that takes the left image to the right one: all that is certain where everything lies on \
                 one plane or the camera only turned."
            }
            Self::Pairs => "The point pairs that are not left out.",
            Self::Table => {
                "The point pairs with name, origin, role and distance, as comma-separated values for a spreadsheet."
            }
            Self::Report => "The result of the estimate: F, verdict, figures, matches, parameters, times.",
            Self::Profile => "Intensities, shifts and costs along the inspected line pair, as a table.",
            Self::Figure => {
                "Both images with the overlays that are shown, for a paper: as SVG or PDF with lines and letters, or as PNG of any size."
            }
            Self::View => "What is on the screen, as a picture.",
        }
    }
}

/// Which part of the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ViewPart {
    /// Both images with what is drawn over them.
    #[default]
    Images,
    /// All of it.
    Window,
}

/// How a figure is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FigureFormat {
    /// The images as PNG inside it, lines and letters as such.
    #[default]
    Svg,
    /// The same for programs that set type.
    Pdf,
}

impl FigureFormat {
    /// The extension of its files, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Pdf => "pdf",
        }
    }
}

/// What is on a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FigureChoices {
    /// How it is written.
    pub format: FigureFormat,
    /// Whether points and lines have their names.
    pub labels: bool,
    /// Whether the paper is dark.
    pub dark: bool,
    /// Whether only what is seen of the images is on it.
    pub seen: bool,
    /// Which layers over the images are not on it although the window shows them.
    left_out: [bool; OverlayId::COUNT],
}

impl FigureChoices {
    /// Whether it has a layer that the window shows.
    pub fn has(&self, layer: OverlayId) -> bool {
        !self.left_out[layer as usize]
    }

    /// Takes a layer in, or leaves it out.
    pub fn set(&mut self, layer: OverlayId, on: bool) {
        self.left_out[layer as usize] = !on;
    }
}

impl Default for FigureChoices {
    fn default() -> Self {
        let mut left_out = [false; OverlayId::COUNT];
        // Marks of a search, which say nothing to who has not seen it.
        left_out[OverlayId::Hypotheses as usize] = true;
        Self { format: FigureFormat::default(), labels: true, dark: false, seen: false, left_out }
    }
}

/// How the report is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReportFormat {
    /// Sentences for people.
    #[default]
    Text,
    /// JSON for scripts.
    Json,
}

/// What is to be written, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportOrder {
    /// The file.
    pub path: PathBuf,
    /// What is written.
    pub what: ExportKind,
    /// The format of geometry and point pairs.
    pub format: Format,
    /// Whether the matches that the result rests on go along with the point pairs.
    pub with_matches: bool,
    /// How the report is written.
    pub reported: ReportFormat,
    /// Which part of the screen is the view.
    pub part: ViewPart,
    /// What is on a figure.
    pub figure: FigureChoices,
}

impl Default for ExportOrder {
    fn default() -> Self {
        Self {
            path: PathBuf::new(),
            what: ExportKind::default(),
            format: Format::Json,
            with_matches: false,
            reported: ReportFormat::default(),
            part: ViewPart::default(),
            figure: FigureChoices::default(),
        }
    }
}
