//! Files from and for other programs: exports, and imports of point pairs and geometries.

mod exporting;
mod importing;
mod order;
mod taking;
mod trust;

pub use exporting::{ExportContent, colmap, content, undistorted};
pub use importing::{ImportQuestion, PendingImport};
pub use order::{ExportKind, ExportOrder, FigureChoices, FigureFormat, ReportFormat};
pub use trust::{result_note, trust_note};
