//! Files from and for other programs: exports of what the window shows, and imports of point pairs and geometries.

mod exporting;
mod importing;
mod profile;
mod source;

pub use exporting::{ExportContent, ExportKind, ExportOrder, ReportFormat, ViewPart, content};
pub use importing::{ImportFound, ImportQuestion, ImportedMatrix, PendingImport};
pub use profile::CONVENTION as PROFILE_CONVENTION;
pub use source::{ImportSource, is_importable, sources};
