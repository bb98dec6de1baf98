//! Files from and for other programs: exports, and imports of point pairs and geometries.

mod exporting;
mod importing;
mod order;
mod profile;
mod source;
mod table;
mod taking;
mod trust;

pub use exporting::{ExportContent, colmap, content, undistorted};
pub use importing::{ImportFound, ImportQuestion, ImportedFile, ImportedMatrix, PendingImport};
pub use order::{ExportKind, ExportOrder, FigureChoices, FigureFormat, ReportFormat, ViewPart};
pub use profile::CONVENTION as PROFILE_CONVENTION;
use source::is_archive;
pub use source::{ImportSource, is_importable, sources};
pub use trust::{result_note, trust_note};
