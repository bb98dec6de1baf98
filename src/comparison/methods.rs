//! Comparison of a result with other methods and with the truth, on the same points.

use serde::{Deserialize, Serialize};

use super::fits::{Distances, FitError, PointFit, Spread, fit_eight, fit_seven};
use super::known_pair::KnownPair;
use super::robust::{fit_least_median, fit_msac};
use crate::geometry::{FundamentalMatrix, PointPair};

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

/// Data of a comparison.
pub struct MethodQuestion<'a> {
    /// The result with its matches.
    pub result: Option<(&'a FundamentalMatrix, &'a [PointPair])>,
    pub imported: Option<&'a FundamentalMatrix>,
    pub pairs: &'a [PointPair],
    /// Places of the excluded pairs among the clicked ones.
    pub excluded: &'a [usize],
    pub used: &'a [PointPair],
    /// Matches from elsewhere.
    pub given: Vec<PointPair>,
    /// Ground truth, if known and in use.
    pub truth: Option<KnownPair<'a>>,
    pub subject: Subject,
}

/// One row of a comparison.
#[derive(Debug, Clone)]
pub struct Compared {
    /// The geometry, or the reason why there is none.
    pub fit: Result<PointFit, String>,
    /// Distance of every point, px. Empty without a geometry.
    pub distances: Vec<f64>,
    /// Spread of the distances of all points that are not excluded.
    pub spread: Option<Spread>,
}

/// All methods on the same points.
#[derive(Debug, Clone)]
pub struct MethodComparison {
    pub measured: PointSet,
    pub fitted: PointSet,
    pub points: Vec<PointPair>,
    /// Rows in the order of [`Contestant::ALL`].
    rows: [Compared; Contestant::ALL.len()],
}

impl MethodComparison {
    /// Returns the geometry of a contestant.
    pub fn fundamental(&self, contestant: Contestant) -> Option<&FundamentalMatrix> {
        self.of(contestant).fit.as_ref().ok().map(|fit| &fit.fundamental)
    }

    /// Returns the row of a contestant.
    pub fn of(&self, contestant: Contestant) -> &Compared {
        &self.rows[contestant as usize]
    }
}

impl MethodQuestion<'_> {
    /// Fits all methods and measures them.
    pub fn answer(&self) -> MethodComparison {
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
                self.result.map(|(f, _)| known(f, self.used.len())).ok_or_else(none)
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
                self.imported.map(|f| known(f, 0)).ok_or_else(none)
            }
            Contestant::Truth => {
                let none = || "not in use".to_owned();
                self.truth.map(|truth| known(truth.truth, truth.matches.len())).ok_or_else(none)
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
        MethodComparison { measured, fitted: self.fitted_to(), points, rows }
    }

    fn points(&self, set: PointSet) -> Vec<PointPair> {
        match set {
            PointSet::Pairs => self.pairs.to_vec(),
            PointSet::Matches => self.result.map_or_else(Vec::new, |(_, matches)| matches.to_vec()),
            PointSet::Given => self.given.clone(),
            PointSet::TrueMatches => self.truth.map_or_else(Vec::new, |truth| truth.matches.to_vec()),
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
        let truth = match (self.fitted_to(), self.truth) {
            (PointSet::TrueMatches, Some(truth)) => truth,
            (set @ (PointSet::Matches | PointSet::Given), _) => return Ok(self.points(set)),
            _ => {
                let included = self.pairs.iter().enumerate().filter(|(k, _)| !self.excluded.contains(k));
                return Ok(included.map(|(_, pair)| *pair).collect());
            }
        };
        let further = truth.further(self.used, 8, 0, 0);
        let further = further.ok_or("there are no eight true matches 30 px apart")?;
        Ok(self.used.iter().copied().chain(further.into_iter().map(|k| truth.matches[k])).collect())
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
    use crate::synthetic::Sample;

    /// Runs a comparison on a sample whose result is the true geometry.
    fn on_sample<T>(run: impl FnOnce(MethodQuestion, &[PointPair]) -> T) -> T {
        let sample = Sample::Courtyard.load();
        let frames = sample.pictures.each_ref().map(crate::image::Picture::frame);
        let (truth, matches) = (&sample.fundamental, sample.matches.as_slice());
        let question = MethodQuestion {
            result: Some((truth, &[])),
            imported: Some(truth),
            pairs: &sample.show_me,
            excluded: &[],
            used: &sample.show_me,
            given: Vec::new(),
            truth: Some(KnownPair { name: "courtyard", frames, truth, matches }),
            subject: Subject::default(),
        };
        run(question, matches)
    }

    #[test]
    fn on_exact_matches_all_methods_agree_with_the_truth() {
        let (comparison, count) = on_sample(|question, matches| (question.answer(), matches.len()));
        assert_eq!((comparison.measured, comparison.points.len()), (PointSet::TrueMatches, count));
        for contestant in Contestant::ALL {
            let row = comparison.of(contestant);
            assert_eq!(row.distances.len(), count);
            let spread = row.spread.unwrap();
            // The eight-point algorithm is a least-squares fit on conditioned coordinates.
            assert!(spread.max < 1e-2 && spread.count == count, "{contestant:?}: {spread:?}");
        }
        assert_eq!(comparison.of(Contestant::SevenPoint).fit.as_ref().unwrap().pairs, 7);
        assert_eq!(comparison.of(Contestant::EightPoint).fit.as_ref().unwrap().pairs, 8);
    }

    #[test]
    fn matches_of_the_images_come_first_unless_clicked_pairs_are_asked_for_or_are_enough() {
        on_sample(|question, matches| {
            let result = question.result.map(|(truth, _)| (truth, matches));
            let few = question.pairs;
            let mut question = MethodQuestion { result, truth: None, pairs: &[], ..question };
            let comparison = question.answer();
            assert_eq!((comparison.measured, comparison.points.len()), (PointSet::Matches, matches.len()));
            for contestant in [Contestant::SevenPoint, Contestant::EightPoint, Contestant::Ransac] {
                assert!(comparison.of(contestant).spread.unwrap().max < 1e-2, "{contestant:?}");
            }
            let sets = |question: &MethodQuestion| {
                let answer = question.answer();
                (answer.measured, answer.fitted)
            };
            question.pairs = few;
            assert_eq!(sets(&question), (PointSet::Matches, PointSet::Matches));
            question.subject.measured = PointSet::Pairs;
            assert_eq!(sets(&question), (PointSet::Pairs, PointSet::Matches));
            question.pairs = &matches[..ENOUGH];
            assert_eq!(sets(&question), (PointSet::Pairs, PointSet::Pairs));
            question.pairs = few;
            question.subject =
                Subject { measured: PointSet::Matches, fitted: PointSet::Pairs, ..question.subject };
            assert_eq!(sets(&question), (PointSet::Matches, PointSet::Pairs));
        });
    }

    #[test]
    fn an_excluded_pair_has_distances_but_does_not_count() {
        on_sample(|question, _| {
            let pairs = [question.pairs, &[PointPair::new(10.0, 10.0, 500.0, 400.0)]].concat();
            let subject = Subject { measured: PointSet::Pairs, ..question.subject };
            let mut question = MethodQuestion { pairs: &pairs, subject, ..question };
            let with = question.answer().of(Contestant::Result).spread.unwrap();
            question.excluded = &[2];
            let comparison = question.answer();
            let without = comparison.of(Contestant::Result);
            assert!(with.max > 10.0 && without.spread.unwrap().max < 1e-6);
            assert!(without.distances[2] > 10.0);
        });
    }
}
