//! Comparison of the result with other methods and with the truth, and the judgement of an imported geometry.

use std::ops::Deref;

use super::revision;
use super::shared::Shared;
pub use crate::comparison::{Contestant, Measure, PointSet, Subject};
use crate::comparison::{Distances, KnownPair, MethodComparison, MethodQuestion, Spread};
use crate::estimate::Match;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::io::GroundTruth;
use crate::judge::{GivenGeometry, Judgement, LIMIT, judge};
use crate::study::ShownGeometry;

#[derive(Clone, PartialEq)]
pub struct ComparisonQuestion {
    pub result: Option<ShownGeometry>,
    pub shown: Option<FundamentalMatrix>,
    pub imported: Option<GivenGeometry>,
    pub pairs: Vec<PointPair>,
    /// Places of the excluded pairs among the clicked ones.
    pub excluded: Vec<usize>,
    pub used: Vec<PointPair>,
    pub given: Option<Shared<Vec<Match>>>,
    pub frames: [Frame; 2],
    /// Ground truth, if known and in use.
    pub truth: Option<Shared<GroundTruth>>,
    pub subject: Subject,
}

#[derive(Debug, Clone)]
pub struct Comparison {
    pub number: u64,
    /// The geometry of the result that was compared.
    pub of: Option<FundamentalMatrix>,
    methods: MethodComparison,
    /// The imported geometry, and what the images say of it.
    pub judgement: Option<(FundamentalMatrix, Judgement)>,
    /// Mean symmetric epipolar distance of all true matches to the shown geometry, px.
    pub true_error: Option<f64>,
    /// Mean symmetric epipolar distance of all true matches to the true geometry, px: a practical
    /// lower limit.
    pub truth_error: Option<f64>,
}

impl Deref for Comparison {
    type Target = MethodComparison;

    fn deref(&self) -> &MethodComparison {
        &self.methods
    }
}

impl ComparisonQuestion {
    pub fn answer(&self) -> Comparison {
        let truth = self.truth.as_deref().map(|truth| KnownPair {
            name: &truth.name,
            frames: self.frames,
            truth: &truth.fundamental,
            matches: &truth.matches,
        });
        let methods = MethodQuestion {
            result: self.result.as_ref().map(|found| (&found.fundamental, found.matches.as_slice())),
            imported: self.imported.as_ref().map(|given| &given.fundamental),
            pairs: &self.pairs,
            excluded: &self.excluded,
            used: &self.used,
            given: self.given.iter().flat_map(|given| given.iter()).map(|found| found.pair).collect(),
            truth,
            subject: self.subject,
        };
        let error = |f: &FundamentalMatrix| {
            Spread::of(&Distances::of(f, truth?.matches).symmetric).map(|spread| spread.mean)
        };
        Comparison {
            number: revision::fresh(),
            of: self.result.as_ref().map(|found| found.fundamental),
            methods: methods.answer(),
            judgement: self.judgement(),
            true_error: self.shown.as_ref().and_then(error),
            truth_error: truth.and_then(|truth| error(truth.truth)),
        }
    }

    /// Judges the imported geometry by the result and its matches.
    fn judgement(&self) -> Option<(FundamentalMatrix, Judgement)> {
        let given = self.imported?;
        let reference = self.result.as_ref()?.reference(self.frames, None);
        judge(&given, &reference, LIMIT).map(|judgement| (given.fundamental, judgement))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::sample::sample_pair;
    use crate::judge::Finding;
    use crate::synthetic::Sample;

    #[test]
    fn distinctive_matches_of_a_trusted_result_judge_an_imported_geometry() {
        let sample = sample_pair(Sample::Courtyard);
        let (truth, matches) = (sample.truth.fundamental, sample.truth.matches.clone());
        let mut question = ComparisonQuestion {
            result: Some(ShownGeometry {
                fundamental: truth,
                matches: matches.clone(),
                witnesses: Vec::new(),
                is_trusted: true,
                has_epipoles: true,
                verdict: None,
                covariance: None,
            }),
            shown: Some(truth),
            imported: Some(truth.into()),
            pairs: sample.show_me.to_vec(),
            excluded: Vec::new(),
            used: sample.show_me.to_vec(),
            given: None,
            frames: sample.pictures.each_ref().map(|opened| opened.picture.frame()),
            truth: Some(Shared::new(sample.truth)),
            subject: Subject::default(),
        };
        let finding = |question: &ComparisonQuestion| question.answer().judgement.unwrap().1.finding;
        assert_eq!(finding(&question), Finding::Fits);
        question.imported = Some(truth.swapped().into());
        assert_eq!(finding(&question), Finding::Undecided);
        question.result.as_mut().unwrap().witnesses = matches;
        assert_eq!(finding(&question), Finding::DoesNotFit);
        question.result.as_mut().unwrap().is_trusted = false;
        assert_eq!(finding(&question), Finding::Undecided);
        question.imported = None;
        let comparison = question.answer();
        assert!(comparison.judgement.is_none());
        assert!(comparison.true_error.unwrap() < 1e-6 && comparison.truth_error.unwrap() < 1e-6);
    }
}
