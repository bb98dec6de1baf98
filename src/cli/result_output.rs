//! Destinations of a result: text, JSON, and a file for another program.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::geometry_file::{GeometryOutput, image_notes};
use super::output::Output;
use crate::estimate::{Estimate, Parameters};
use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::{
    Format, GeometryFile, PairLabel, PairOrigin, ResultFile, TrustNote, refuse_clashes, result_in_words,
};

/// Output options of a result.
#[derive(Debug, Args)]
pub(super) struct ResultArguments {
    /// Write the result as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write F, the epipoles, the points and the matched patches for another program; if only a
    /// plane or a rotation of the camera is certain, also its homography H21
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,
    /// Format of the export, by default from the file extension
    #[arg(long, value_enum, requires = "export")]
    format: Option<Format>,
}

/// Outputs of a result, checked before the work.
pub(super) struct ResultOutput {
    output: Output,
    export: Option<GeometryOutput>,
}

impl ResultArguments {
    /// Checks the outputs. Fails if one cannot be written, or would overwrite an input or the other
    /// output.
    pub(super) fn prepare(&self, inputs: &[&Path]) -> Result<ResultOutput, CliError> {
        let output = Output::prepare(self.json.as_deref())?;
        let export = GeometryOutput::prepare_optional(self.export.as_deref(), self.format)?;
        if export.as_ref().is_some_and(GeometryOutput::is_piped) && matches!(output, Output::Piped) {
            return Err(CliError::Arguments("--json and --export cannot both be -".into()));
        }
        let outputs: Vec<&Path> =
            output.file().into_iter().chain(export.as_ref().and_then(GeometryOutput::file)).collect();
        refuse_clashes(&outputs, inputs)?;
        Ok(ResultOutput { output, export })
    }
}

impl ResultOutput {
    /// Writes the result. `offset` is the time offset of two sequences.
    pub(super) fn write(
        self,
        found: &Estimate,
        pairs: &[PointPair],
        pictures: &[Picture; 2],
        parameters: &Parameters,
        offset: Option<i32>,
    ) -> Result<(), CliError> {
        if let Some(export) = self.export {
            export.write(&geometry_file(found, pairs, pictures))?;
        }
        let images = image_notes(pictures);
        let result = ResultFile::new(found, pairs, &images, parameters).at_offset(offset);
        self.output.write(&result, &result_in_words(found, &images))
    }
}

/// Returns the content of the export: the clicks followed by the matches of the refinement. If the
/// epipoles are undetermined, it includes the homography.
fn geometry_file(found: &Estimate, pairs: &[PointPair], pictures: &[Picture; 2]) -> GeometryFile {
    let label = |origin| PairLabel { origin, ..PairLabel::default() };
    let given = pairs.iter().map(|_| label(PairOrigin::Clicked));
    let matched = found.matches().iter().map(|_| label(PairOrigin::Automatic));
    GeometryFile {
        fundamental: Some(*found.fundamental()),
        pairs: pairs.iter().copied().chain(found.matches().iter().map(|m| m.pair)).collect(),
        labels: given.chain(matched).collect(),
        trust: found.assessment.trust.as_ref().map(TrustNote::from),
        images: Some(image_notes(pictures)),
        homography21: found.assessment.plane.map(|plane| plane.homography21),
        ..GeometryFile::default()
    }
}
