//! Requests to import files.

use crate::app::model::rectified::MatchesAtHand;
use crate::camera::ViewPair;
use crate::geometry::Frame;
use crate::io::{Import, ImportSource, ImportedFile};

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PendingImport {
    pub source: ImportSource,
    /// Message that the file is not a session, if it was first opened as one.
    pub prelude: Option<String>,
}

impl From<ImportSource> for PendingImport {
    fn from(source: ImportSource) -> Self {
        Self { source, prelude: None }
    }
}

pub struct ImportQuestion {
    pub pending: PendingImport,
    /// Sizes of the open images.
    pub frames: [Frame; 2],
    /// Sizes of the pictures on the screen, for which a calibration is.
    pub shown: [Frame; 2],
    /// Views without distortion, if a lens is corrected. Points found belong to them.
    pub views: Option<ViewPair>,
    pub matches: MatchesAtHand,
}

impl ImportQuestion {
    /// Reads the files. The error names the problem and the action.
    pub fn answer(&self) -> Result<ImportedFile, String> {
        let PendingImport { source, prelude } = &self.pending;
        let matches = (&*self.matches.pairs(), self.matches.name());
        let import =
            Import { source, frames: self.frames, shown: self.shown, views: self.views.as_ref(), matches };
        import.read().map_err(|problem| match prelude {
            Some(prelude) => format!(
                "{prelude}, and it cannot be imported either: {problem}. Nothing was changed. Try another file."
            ),
            None => format!(
                "{} could not be imported: {problem}. Nothing was changed. Import F, two cameras, point pairs or a \
                 calibration, but no model of many images.",
                source.name()
            ),
        })
    }
}
