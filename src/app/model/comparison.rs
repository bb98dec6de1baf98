//! Comparison of the result with other methods and with the truth, on the same points.

use serde::{Deserialize, Serialize};

use super::revision;
use super::shared::Shared;
use crate::comparison::{
    Distances, FitError, KnownPair, PointFit, Spread, fit_eight, fit_least_median, fit_msac, fit_seven,
};
use crate::estimate::Match;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::io::GroundTruth;
use crate::judge::{GivenGeometry, Judgement, LIMIT, judge};
use crate::study::ShownGeometry;

named! {
    fn name;

    /// A geometry of the comparison, in the order of the rows.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Contestant {
        /// The result of the estimate.
        Result = "Result",
        /// A geometry from a file.
        Imported = "Imported",
        SevenPoint = "7-point",
        /// The normalised eight-point algorithm.
        EightPoint = "8-point",
        /// RANSAC with MSAC scores.
        Ransac = "RANSAC",
        LeastMedian = "LMedS",
        Truth = "Ground truth",
    }
}

/// Number of pairs that every method can be fitted to.
const ENOUGH: usize = 8;
/// Seed of the samples of robust methods.
const SEED: u64 = 0;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointSet {
    /// Clicked pairs.
    Pairs,
    /// Matches that the program found in the images.
    Matches,
    /// Matches from elsewhere.
    Given,
    #[default]
    TrueMatches,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Mean distance of the two points from each other's epipolar lines.
    #[default]
    Symmetric,
    /// First-order distance to an exact fit.
    Sampson,
}

/// Points, fits and measure of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct Subject {
    /// Points at which distances are measured, if there are any of this kind.
    pub measured: PointSet,
    /// Points that the other methods are fitted to, if there are any of this kind.
    pub fitted: PointSet,
    pub measure: Measure,
}

#[derive(Clone, PartialEq)]
pub struct ComparisonQuestion {
    /// The result with its matches.
    pub result: Option<ShownGeometry>,
    /// Geometry shown by the window.
    pub shown: Option<FundamentalMatrix>,
    pub imported: Option<GivenGeometry>,
    pub pairs: Vec<PointPair>,
    /// Places of the excluded pairs among the clicked ones.
    pub excluded: Vec<usize>,
    pub used: Vec<PointPair>,
    /// Matches from elsewhere.
    pub given: Option<Shared<Vec<Match>>>,
    pub frames: [Frame; 2],
    /// Ground truth, if known and in use.
    pub truth: Option<Shared<GroundTruth>>,
    pub subject: Subject,
}

#[derive(Debug, Clone)]
pub struct Compared {
    /// The geometry, or the reason why there is none.
    pub fit: Result<PointFit, String>,
    /// Distance of every point, px. Empty without a geometry.
    pub distances: Vec<f64>,
    /// Spread of the distances of all points that are not excluded.
    pub spread: Option<Spread>,
}

#[derive(Debug, Clone)]
pub struct Comparison {
    /// Unique number of this comparison.
    pub number: u64,
    pub measured: PointSet,
    pub fitted: PointSet,
    pub points: Vec<PointPair>,
    /// Rows in the order of [`Contestant::ALL`].
    pub rows: [Compared; Contestant::ALL.len()],
    /// The imported geometry, and what the images say of it.
    pub judgement: Option<(FundamentalMatrix, Judgement)>,
    /// Mean symmetric epipolar distance of all true matches to the shown geometry, px.
    pub true_error: Option<f64>,
    /// Mean symmetric epipolar distance of all true matches to the true geometry, px: a practical
    /// lower limit.
    pub truth_error: Option<f64>,
}

impl Comparison {
    pub fn fundamental(&self, contestant: Contestant) -> Option<&FundamentalMatrix> {
        self.of(contestant).fit.as_ref().ok().map(|fit| &fit.fundamental)
    }

    pub fn of(&self, contestant: Contestant) -> &Compared {
        &self.rows[contestant as usize]
    }
}

impl ComparisonQuestion {
    pub fn answer(&self) -> Comparison {
        let truth = self.truth.as_deref();
        let measured = self.present(self.subject.measured);
        let points = self.points(measured);
        let counts = |k: usize| measured != PointSet::Pairs || !self.excluded.contains(&k);
        let counted: Vec<PointPair> = (0..points.len()).filter(|k| counts(*k)).map(|k| points[k]).collect();
        let known = |fundamental: &FundamentalMatrix, pairs: usize| PointFit {
            fundamental: *fundamental,
            pairs,
            solutions: 1,
        };
        let fitted = self.fitted();
        // Seven of many matches, evenly spread over the list.
        let seven = fitted.clone().map(|pairs| match self.fitted_to() {
            PointSet::Matches | PointSet::Given if pairs.len() > 7 => {
                (0..7).map(|k| pairs[k * pairs.len() / 7]).collect()
            }
            _ => pairs,
        });
        let fits = Contestant::ALL.map(|contestant| match contestant {
            Contestant::Result => {
                let none = || "no result yet".to_owned();
                self.result.as_ref().map(|found| known(&found.fundamental, self.used.len())).ok_or_else(none)
            }
            Contestant::SevenPoint => {
                seven.clone().and_then(|pairs| self.in_words(fit_seven(&pairs, &counted)))
            }
            Contestant::EightPoint => fitted.clone().and_then(|pairs| self.in_words(fit_eight(&pairs))),
            Contestant::Ransac => fitted.clone().and_then(|pairs| self.in_words(fit_msac(&pairs, SEED))),
            Contestant::LeastMedian => {
                fitted.clone().and_then(|pairs| self.in_words(fit_least_median(&pairs, SEED)))
            }
            Contestant::Imported => {
                let none = || "nothing was imported".to_owned();
                self.imported.as_ref().map(|given| known(&given.fundamental, 0)).ok_or_else(none)
            }
            Contestant::Truth => {
                let none = || "not in use".to_owned();
                truth.map(|truth| known(&truth.fundamental, truth.matches.len())).ok_or_else(none)
            }
        });
        let rows = fits.map(|fit| {
            let all = fit.as_ref().map(|fit| Distances::of(&fit.fundamental, &points)).unwrap_or_default();
            let distances = match self.subject.measure {
                Measure::Symmetric => all.symmetric,
                Measure::Sampson => all.sampson,
            };
            let counted = distances.iter().enumerate().filter(|(k, _)| counts(*k));
            let spread = Spread::of(&counted.map(|(_, distance)| *distance).collect::<Vec<_>>());
            Compared { fit, distances, spread }
        });
        let error = |f: &FundamentalMatrix| {
            Spread::of(&Distances::of(f, &truth?.matches).symmetric).map(|spread| spread.mean)
        };
        Comparison {
            number: revision::fresh(),
            measured,
            fitted: self.fitted_to(),
            points,
            rows,
            judgement: self.judgement(),
            true_error: self.shown.as_ref().and_then(error),
            truth_error: truth.and_then(|truth| error(&truth.fundamental)),
        }
    }

    /// Judges the imported geometry by the result and its matches.
    fn judgement(&self) -> Option<(FundamentalMatrix, Judgement)> {
        let given = self.imported?;
        let reference = self.result.as_ref()?.reference(self.frames, None);
        judge(&given, &reference, LIMIT).map(|judgement| (given.fundamental, judgement))
    }

    fn points(&self, set: PointSet) -> Vec<PointPair> {
        match set {
            PointSet::Pairs => self.pairs.clone(),
            PointSet::Matches => self.result.as_ref().map_or_else(Vec::new, |found| found.matches.clone()),
            PointSet::Given => {
                self.given.iter().flat_map(|given| given.iter()).map(|found| found.pair).collect()
            }
            PointSet::TrueMatches => {
                self.truth.as_deref().map_or_else(Vec::new, |truth| truth.matches.clone())
            }
        }
    }

    /// Returns the wanted set if it has points, and else the first set that has some. Two clicked pairs say
    /// less than hundreds of matches.
    fn present(&self, wanted: PointSet) -> PointSet {
        let order = [wanted, PointSet::Matches, PointSet::Given, PointSet::Pairs];
        order.into_iter().find(|set| !self.points(*set).is_empty()).unwrap_or(PointSet::Pairs)
    }

    /// Returns the set that the other methods are fitted to: the wanted one if it has points. Else
    /// the clicked pairs, if they are enough for every method, and else the matches.
    fn fitted_to(&self) -> PointSet {
        match self.present(self.subject.fitted) {
            PointSet::Matches if self.subject.fitted != PointSet::Matches && self.pairs.len() >= ENOUGH => {
                PointSet::Pairs
            }
            set => set,
        }
    }

    /// Returns the points that the other methods are fitted to: the clicked pairs, the matches of
    /// the result, or the used pairs and further true matches up to eight, drawn as in an evaluation.
    fn fitted(&self) -> Result<Vec<PointPair>, String> {
        let truth = match (self.fitted_to(), self.truth.as_deref()) {
            (PointSet::TrueMatches, Some(truth)) => truth,
            (set @ (PointSet::Matches | PointSet::Given), _) => return Ok(self.points(set)),
            _ => {
                let included = self.pairs.iter().enumerate().filter(|(k, _)| !self.excluded.contains(k));
                return Ok(included.map(|(_, pair)| *pair).collect());
            }
        };
        let GroundTruth { name, fundamental, matches, .. } = truth;
        let known = KnownPair { name, frames: self.frames, truth: fundamental, matches };
        let further = known.further(&self.used, 8, 0, 0);
        let further = further.ok_or("there are no eight true matches 30 px apart")?;
        Ok(self.used.iter().copied().chain(further.into_iter().map(|k| matches[k])).collect())
    }

    fn in_words(&self, fit: Result<PointFit, FitError>) -> Result<PointFit, String> {
        fit.map_err(|error| match (error, self.fitted_to()) {
            (error @ FitError::TooFew { .. }, _) => error.to_string(),
            (_, PointSet::Pairs) => {
                "these pairs do not determine a geometry: spread them over the images and over depth"
                    .to_owned()
            }
            _ => "these matches do not determine a geometry".to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::sample::sample_pair;
    use crate::judge::Finding;
    use crate::synthetic::Sample;

    fn question() -> ComparisonQuestion {
        let sample = sample_pair(Sample::Courtyard);
        ComparisonQuestion {
            result: Some(ShownGeometry {
                fundamental: sample.truth.fundamental,
                matches: Vec::new(),
                witnesses: Vec::new(),
                is_trusted: true,
                has_epipoles: true,
                verdict: None,
                covariance: None,
            }),
            shown: Some(sample.truth.fundamental),
            imported: Some(sample.truth.fundamental.into()),
            pairs: sample.show_me.to_vec(),
            excluded: Vec::new(),
            used: sample.show_me.to_vec(),
            given: None,
            frames: sample.pictures.each_ref().map(|opened| opened.picture.frame()),
            truth: Some(Shared::new(sample.truth)),
            subject: Subject::default(),
        }
    }

    #[test]
    fn on_exact_matches_all_methods_agree_with_the_truth() {
        let question = question();
        let comparison = question.answer();
        let matches = question.truth.as_ref().unwrap().matches.len();
        assert_eq!((comparison.measured, comparison.points.len()), (PointSet::TrueMatches, matches));
        for contestant in Contestant::ALL {
            let row = comparison.of(contestant);
            assert_eq!(row.distances.len(), matches);
            let spread = row.spread.unwrap();
            // The eight-point algorithm is a least-squares fit on conditioned coordinates.
            assert!(spread.max < 1e-2 && spread.count == matches, "{contestant:?}: {spread:?}");
        }
        assert!(comparison.true_error.unwrap() < 1e-6 && comparison.truth_error.unwrap() < 1e-6);
        assert_eq!(comparison.of(Contestant::SevenPoint).fit.as_ref().unwrap().pairs, 7);
        assert_eq!(comparison.of(Contestant::EightPoint).fit.as_ref().unwrap().pairs, 8);
    }

    #[test]
    fn matches_of_the_images_are_measured_and_fitted() {
        let matches: Vec<PointPair> = question().truth.as_ref().unwrap().matches.clone();
        let count = matches.len();
        let mut question = ComparisonQuestion { truth: None, pairs: Vec::new(), ..question() };
        question.result.as_mut().unwrap().matches.clone_from(&matches);
        let comparison = question.answer();
        assert_eq!(
            (comparison.measured, comparison.points.len()),
            (PointSet::Matches, count),
            "nothing else is there"
        );
        for contestant in [Contestant::SevenPoint, Contestant::EightPoint, Contestant::Ransac] {
            assert!(comparison.of(contestant).spread.unwrap().max < 1e-2, "{contestant:?}");
        }
        // Matches come first, unless the clicked pairs are asked for, or are enough for every method.
        question.pairs = question.used.clone();
        let sets = |question: &ComparisonQuestion| {
            let answer = question.answer();
            (answer.measured, answer.fitted)
        };
        assert_eq!(sets(&question), (PointSet::Matches, PointSet::Matches));
        question.subject.measured = PointSet::Pairs;
        assert_eq!(sets(&question), (PointSet::Pairs, PointSet::Matches));
        let few = std::mem::replace(&mut question.pairs, matches[..ENOUGH].to_vec());
        assert_eq!(sets(&question), (PointSet::Pairs, PointSet::Pairs));
        question.pairs = few;
        question.subject.measured = PointSet::Matches;
        question.subject.fitted = PointSet::Pairs;
        let asked = question.answer();
        assert_eq!((asked.measured, asked.fitted), (PointSet::Matches, PointSet::Pairs));
        // They judge what was imported, and the distinctive ones alone refute it.
        let finding = |question: &ComparisonQuestion| question.answer().judgement.unwrap().1.finding;
        assert_eq!(finding(&question), Finding::Fits);
        question.imported = question
            .imported
            .map(|given| GivenGeometry { fundamental: given.fundamental.swapped(), ..given });
        assert_eq!(finding(&question), Finding::Undecided);
        question.result.as_mut().unwrap().witnesses = matches;
        assert_eq!(finding(&question), Finding::DoesNotFit);
        question.result.as_mut().unwrap().is_trusted = false;
        assert_eq!(finding(&question), Finding::Undecided);
        question.imported = None;
        assert!(question.answer().judgement.is_none());
    }

    #[test]
    fn an_excluded_pair_has_distances_but_does_not_count() {
        let mut question = question();
        question.subject.measured = PointSet::Pairs;
        question.pairs.push(PointPair::new(10.0, 10.0, 500.0, 400.0));
        let with = question.answer().of(Contestant::Result).spread.unwrap();
        question.excluded = vec![2];
        let comparison = question.answer();
        let without = comparison.of(Contestant::Result);
        assert!(with.max > 10.0 && without.spread.unwrap().max < 1e-6);
        assert!(without.distances[2] > 10.0);
    }
}
