//! Contenders: named methods that turn clicks into an F.
//!
//! A new method needs one [`Contender`] and one row of [`METHODS`].

use std::time::Instant;

use serde_json::{Value, json};

use super::{EvaluateError, KnownScene};
use epiline::estimate::{
    Estimate, Method, Monitor, Parameters, PreparedPair, Preset, Search, Verdict, estimate_prepared, examine,
};
use epiline::geometry::{FundamentalMatrix, PointPair, eight_point};
use epiline::internals::comparison::fit_seven;
use epiline::presentation::{reason_in_words, warning_in_words};

/// Result of a contender in one trial.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Estimated F.
    pub fundamental: FundamentalMatrix,
    /// Total time, s.
    pub seconds: f64,
    /// Time until the first F, s.
    pub first_seconds: f64,
    /// Score computed by the contender, if any.
    pub score: Option<f64>,
    /// Margin to the next best geometry, if known.
    pub margin: Option<f64>,
    /// Verdict of the contender on its result, if any.
    pub verdict: Option<Verdict>,
    /// Warnings for the user, and reasons against the result.
    pub warnings: Vec<String>,
    /// Hypotheses of the search, if there was one.
    pub choice: Option<Choice>,
}

impl Outcome {
    /// Returns the outcome of a method that does not assess its result.
    pub(super) fn unassessed(fundamental: FundamentalMatrix, seconds: f64) -> Self {
        Self {
            fundamental,
            seconds,
            first_seconds: seconds,
            score: None,
            margin: None,
            verdict: None,
            warnings: Vec::new(),
            choice: None,
        }
    }
}

/// Hypotheses of one trial.
#[derive(Debug, Clone)]
pub struct Choice {
    /// Generated hypotheses.
    pub generated: Vec<Estimate>,
    /// True geometry with the same scores; `None` if it has none.
    pub truth: Option<Estimate>,
}

/// Method with its parameters.
pub trait Contender: Sync {
    /// Returns the name of the method.
    fn method(&self) -> &'static str;

    /// Returns the preset, if the method has presets, with a suffix if refinement differs from the
    /// preset.
    fn preset(&self) -> Option<&'static str> {
        None
    }

    /// Returns the number of point pairs to click.
    fn clicks_needed(&self) -> usize;

    /// Returns the parameters, for the record.
    fn parameters(&self) -> Value {
        Value::Null
    }

    /// Estimates F in one trial. The error is one sentence.
    fn estimate(&self, scene: &KnownScene, clicks: &[PointPair]) -> Result<Outcome, String>;

    /// Returns the method and preset, for tables and progress.
    fn label(&self) -> String {
        match self.preset() {
            Some(preset) => format!("{} {preset}", self.method()),
            None => self.method().to_owned(),
        }
    }
}

/// Method that can be selected by name.
pub struct MethodEntry {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Whether the method depends on the preset. Otherwise it takes part once.
    pub has_presets: bool,
    /// Constructor from the name and the parameters of a preset.
    build: fn(&'static str, Parameters) -> Box<dyn Contender>,
}

/// All methods.
pub const METHODS: [MethodEntry; 8] = [
    MethodEntry { name: "no-clicks", has_presets: true, build: without_clicks },
    MethodEntry { name: "two-point", has_presets: true, build: |n, p| clicked(n, 2, Method::TwoPoint, p) },
    MethodEntry {
        name: "three-point",
        has_presets: true,
        build: |n, p| clicked(n, 3, Method::ThreePoint, p),
    },
    MethodEntry { name: "four-clicks", has_presets: true, build: |n, p| clicked(n, 4, Method::TwoPoint, p) },
    MethodEntry { name: "five-clicks", has_presets: true, build: |n, p| clicked(n, 5, Method::TwoPoint, p) },
    MethodEntry { name: "eight-clicks", has_presets: true, build: |n, p| clicked(n, 8, Method::TwoPoint, p) },
    MethodEntry { name: "seven-point", has_presets: false, build: |_, _| Box::new(SevenPoint) },
    MethodEntry { name: "eight-point", has_presets: false, build: |_, _| Box::new(EightPoint) },
];

/// Returns the names of all methods.
pub fn method_names() -> Vec<&'static str> {
    METHODS.iter().map(|m| m.name).collect()
}

/// Creates every named method with every given preset, methods outermost, without repetition.
pub fn contenders(
    names: &[String],
    presets: &[Parameters],
) -> Result<Vec<Box<dyn Contender>>, EvaluateError> {
    let mut chosen = Vec::new();
    for (k, name) in names.iter().enumerate() {
        let unknown = || EvaluateError::UnknownMethod(name.clone(), method_names().join(", "));
        let entry = METHODS.iter().find(|m| m.name == name).ok_or_else(unknown)?;
        if names[..k].contains(name) {
            continue;
        }
        let takes_part = if entry.has_presets { presets } else { &presets[..presets.len().min(1)] };
        chosen.extend(takes_part.iter().map(|parameters| (entry.build)(entry.name, parameters.clone())));
    }
    Ok(chosen)
}

/// Estimator of this program.
struct Clicked {
    name: &'static str,
    clicks: usize,
    parameters: Parameters,
}

/// Creates this program's estimator with a number of clicks.
fn clicked(
    name: &'static str,
    clicks: usize,
    method: Method,
    mut parameters: Parameters,
) -> Box<dyn Contender> {
    parameters.method = method;
    Box::new(Clicked { name, clicks, parameters })
}

/// Creates this program's estimator without clicks. The published search then compares all lines.
fn without_clicks(name: &'static str, parameters: Parameters) -> Box<dyn Contender> {
    let lines_alone = parameters.search == Search::Lines;
    clicked(name, 0, if lines_alone { Method::LinesAlone } else { Method::TwoPoint }, parameters)
}

impl Clicked {
    fn choice(
        &self,
        scene: &KnownScene,
        clicks: &[PointPair],
        prepared: &PreparedPair,
        found: &Estimate,
    ) -> Option<Choice> {
        let [p, q, ..] = clicks else { return None };
        let truth = examine(prepared, [*p, *q], &scene.truth, found, &self.parameters);
        Some(Choice { generated: found.hypotheses().to_vec(), truth })
    }
}

impl Contender for Clicked {
    fn method(&self) -> &'static str {
        self.name
    }

    fn preset(&self) -> Option<&'static str> {
        Some(match (self.parameters.preset, self.parameters.refinement.refine) {
            (Preset::Paper, false) => "paper",
            (Preset::Paper, true) => "paper refined",
            (Preset::Robust, true) => "robust",
            (Preset::Robust, false) => "robust unrefined",
        })
    }

    fn clicks_needed(&self) -> usize {
        self.clicks
    }

    fn parameters(&self) -> Value {
        serde_json::to_value(&self.parameters).unwrap_or(Value::Null)
    }

    fn estimate(&self, scene: &KnownScene, clicks: &[PointPair]) -> Result<Outcome, String> {
        let begun = Instant::now();
        let prepared = scene.prepared();
        let preparation = begun.elapsed().as_secs_f64();
        let found = estimate_prepared(&prepared, clicks, &self.parameters, &Monitor::silent())
            .map_err(|e| e.to_string())?;
        let (seconds, first_seconds) =
            found.trace.as_ref().map_or((0.0, 0.0), |t| (t.seconds, t.first_seconds));
        let assessment = &found.assessment;
        let reasons = assessment.trust.iter().flat_map(|t| t.reasons.iter().map(reason_in_words));
        Ok(Outcome {
            choice: self.choice(scene, clicks, &prepared, &found),
            fundamental: *found.fundamental(),
            seconds: preparation + seconds,
            first_seconds: preparation + first_seconds,
            score: found.line_score(),
            margin: assessment.margin,
            verdict: assessment.trust.as_ref().map(|t| t.verdict),
            warnings: assessment.warnings.iter().map(warning_in_words).chain(reasons).collect(),
        })
    }
}

/// Seven-point algorithm on seven clicks. The solution nearest to all true matches is selected, as
/// in the published experiment. That selection uses the ground truth.
struct SevenPoint;

impl Contender for SevenPoint {
    fn method(&self) -> &'static str {
        "seven-point"
    }

    fn clicks_needed(&self) -> usize {
        7
    }

    fn parameters(&self) -> Value {
        json!({ "solution": "the one with the smallest mean distance of all true matches (uses the ground truth)" })
    }

    fn estimate(&self, scene: &KnownScene, clicks: &[PointPair]) -> Result<Outcome, String> {
        let begun = Instant::now();
        let fit = fit_seven(clicks, &scene.matches).map_err(|e| e.to_string())?;
        Ok(Outcome::unassessed(fit.fundamental, begun.elapsed().as_secs_f64()))
    }
}

/// Normalised eight-point algorithm on eight clicks.
struct EightPoint;

impl Contender for EightPoint {
    fn method(&self) -> &'static str {
        "eight-point"
    }

    fn clicks_needed(&self) -> usize {
        8
    }

    fn estimate(&self, _: &KnownScene, clicks: &[PointPair]) -> Result<Outcome, String> {
        let begun = Instant::now();
        let fundamental = eight_point(clicks).map_err(|e| e.to_string())?;
        Ok(Outcome::unassessed(fundamental, begun.elapsed().as_secs_f64()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mean;
    use crate::scene::tests::example_scene;
    use epiline::geometry::seven_point;

    fn only(name: &str) -> Box<dyn Contender> {
        contenders(&[name.to_owned()], &[Parameters::default()]).unwrap().remove(0)
    }

    #[test]
    fn every_method_takes_part_once_with_every_preset() {
        let presets = [Preset::Paper, Preset::Robust].map(Parameters::from);
        let names =
            ["three-point", "two-point", "eight-point", "three-point", "seven-point"].map(str::to_owned);
        let labels: Vec<_> = contenders(&names, &presets).unwrap().iter().map(|c| c.label()).collect();
        assert_eq!(
            labels,
            [
                "three-point paper",
                "three-point robust",
                "two-point paper",
                "two-point robust",
                "eight-point",
                "seven-point"
            ]
        );
    }

    #[test]
    fn the_label_tells_refinement_where_it_is_not_that_of_the_preset() {
        for preset in [Preset::Paper, Preset::Robust] {
            let own = Parameters::from(preset);
            let mut other = own.clone();
            other.refinement.refine = !own.refinement.refine;
            let label = |p: Parameters| contenders(&["two-point".into()], &[p]).unwrap().remove(0).label();
            let plain = label(own);
            assert!(plain == "two-point paper" || plain == "two-point robust");
            assert!(label(other).starts_with(&format!("{plain} ")));
        }
    }

    #[test]
    fn an_unknown_method_is_named_with_the_known_ones() {
        let Err(error) = contenders(&["magic".into()], &[Parameters::default()]) else {
            panic!("there is no such method")
        };
        assert_eq!(
            error.to_string(),
            "there is no method magic. Choose one of no-clicks, two-point, three-point, four-clicks, five-clicks, \
             eight-clicks, seven-point, eight-point"
        );
    }

    #[test]
    fn the_baselines_find_exact_geometry_and_say_why_they_cannot() {
        let scene = example_scene("scene", 40);
        for (name, clicks) in [("seven-point", 7), ("eight-point", 8)] {
            let who = only(name);
            assert_eq!((who.clicks_needed(), who.label().as_str()), (clicks, name));
            let outcome = who.estimate(&scene, &scene.matches[3..3 + clicks]).unwrap();
            assert!(mean(&scene.distances(&outcome.fundamental)) < 1e-3, "{name}");
            let failure = who.estimate(&scene, &vec![scene.matches[0]; clicks]).unwrap_err();
            assert!(failure.contains("spread them over the images"), "{failure}");
        }
    }

    #[test]
    fn of_three_solutions_the_one_nearest_to_all_true_matches_counts() {
        let scene = example_scene("scene", 60);
        let mut several = 0;
        for start in 0..50 {
            let clicks = &scene.matches[start..start + 7];
            let solutions = seven_point(clicks).unwrap();
            several += usize::from(solutions.len() == 3);
            let outcome = only("seven-point").estimate(&scene, clicks).unwrap();
            let chosen = mean(&scene.distances(&outcome.fundamental));
            assert!(solutions.iter().all(|f| chosen <= mean(&scene.distances(f))));
        }
        assert!(several > 5, "{several}");
    }
}
