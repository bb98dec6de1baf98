//! What is measured: methods by name, each turning clicks into an F.
//!
//! A new method is one [`Contender`] and one row of [`METHODS`].

use std::time::Instant;

use serde_json::Value;

use super::{EvaluateError, Scene};
use crate::estimate::{
    Estimate, Hypothesis, Method, Monitor, Parameters, PreparedPair, Preset, Verdict, estimate_prepared,
    examine,
};
use crate::geometry::{FundamentalMatrix, PointPair};

/// What a contender found in one trial.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The estimated F.
    pub fundamental: FundamentalMatrix,
    /// Seconds in all.
    pub seconds: f64,
    /// Seconds until the first F.
    pub first_seconds: f64,
    /// Its own score, if it has one.
    pub score: Option<f64>,
    /// Its distance to the next best answer, if it knows.
    pub margin: Option<f64>,
    /// Its own verdict on the result, if it gives one.
    pub verdict: Option<Verdict>,
    /// What a user would be told: warnings and what speaks against the result.
    pub warnings: Vec<String>,
    /// What it chose among, if it chooses.
    pub choice: Option<Choice>,
}

/// Hypotheses of one trial.
#[derive(Debug, Clone)]
pub struct Choice {
    /// Those generated.
    pub generated: Vec<Hypothesis>,
    /// The true geometry with the same figures; `None` where it has none.
    pub truth: Option<Hypothesis>,
}

/// A method with its parameters.
pub trait Contender: Sync {
    /// The name of the method.
    fn method(&self) -> &'static str;

    /// The preset, if the method has presets.
    fn preset(&self) -> Option<&'static str> {
        None
    }

    /// Point pairs it wants clicked.
    fn clicks_needed(&self) -> usize;

    /// Its parameters, for the record.
    fn parameters(&self) -> Value {
        Value::Null
    }

    /// The F of one trial, or in one sentence why there is none.
    fn estimate(&self, scene: &Scene, clicks: &[PointPair]) -> Result<Outcome, String>;

    /// Method and preset for tables and progress.
    fn label(&self) -> String {
        match self.preset() {
            Some(preset) => format!("{} {preset}", self.method()),
            None => self.method().to_owned(),
        }
    }
}

/// A method that can be asked for by name.
pub struct MethodEntry {
    /// Its name on the command line and in files.
    pub name: &'static str,
    /// Whether it differs between presets; one that does not takes part once.
    pub has_presets: bool,
    /// Makes it with the parameters of a preset.
    build: fn(Parameters) -> Box<dyn Contender>,
}

/// All methods.
pub const METHODS: [MethodEntry; 2] = [
    MethodEntry {
        name: "two-point",
        has_presets: true,
        build: |parameters| {
            Box::new(Clicked { parameters: Parameters { method: Method::TwoPoint, ..parameters } })
        },
    },
    MethodEntry {
        name: "three-point",
        has_presets: true,
        build: |parameters| {
            Box::new(Clicked { parameters: Parameters { method: Method::ThreePoint, ..parameters } })
        },
    },
];

/// The names of all methods.
pub fn method_names() -> Vec<&'static str> {
    METHODS.iter().map(|m| m.name).collect()
}

/// Every named method with the parameters of every preset given, methods outermost, each once.
pub fn contenders(
    names: &[String],
    presets: &[Parameters],
) -> Result<Vec<Box<dyn Contender>>, EvaluateError> {
    let mut chosen = Vec::new();
    for (k, name) in names.iter().enumerate() {
        let entry = METHODS.iter().find(|m| m.name == name).ok_or_else(|| EvaluateError::UnknownMethod {
            name: name.clone(),
            known: method_names().join(", "),
        })?;
        if names[..k].contains(name) {
            continue;
        }
        let takes_part = if entry.has_presets { presets } else { &presets[..presets.len().min(1)] };
        chosen.extend(takes_part.iter().map(|parameters| (entry.build)(parameters.clone())));
    }
    Ok(chosen)
}

/// The program's own estimator.
struct Clicked {
    parameters: Parameters,
}

impl Clicked {
    fn choice(
        &self,
        scene: &Scene,
        clicks: &[PointPair],
        prepared: &PreparedPair,
        found: &Estimate,
    ) -> Choice {
        let turn = found.hypotheses.first().map_or(0.0, |h| h.construction.turn());
        let truth = examine(prepared, [clicks[0], clicks[1]], &scene.truth, turn, &self.parameters);
        Choice { generated: found.hypotheses.clone(), truth }
    }
}

impl Contender for Clicked {
    fn method(&self) -> &'static str {
        match self.parameters.method {
            Method::TwoPoint => "two-point",
            Method::ThreePoint => "three-point",
        }
    }

    fn preset(&self) -> Option<&'static str> {
        Some(match self.parameters.preset {
            Preset::Paper => "paper",
            Preset::Robust => "robust",
        })
    }

    fn clicks_needed(&self) -> usize {
        self.parameters.method.pairs_needed()
    }

    fn parameters(&self) -> Value {
        serde_json::to_value(&self.parameters).unwrap_or(Value::Null)
    }

    fn estimate(&self, scene: &Scene, clicks: &[PointPair]) -> Result<Outcome, String> {
        let [image1, image2] = &scene.images;
        let begun = Instant::now();
        let prepared = PreparedPair::new(image1, image2);
        let preparation = begun.elapsed().as_secs_f64();
        let found = estimate_prepared(&prepared, clicks, &self.parameters, &Monitor::silent())
            .map_err(|e| e.to_string())?;
        Ok(Outcome {
            choice: Some(self.choice(scene, clicks, &prepared, &found)),
            fundamental: found.fundamental,
            seconds: preparation + found.seconds,
            first_seconds: preparation + found.first_seconds,
            score: Some(found.score),
            margin: found.margin,
            verdict: found.trust.as_ref().map(|t| t.verdict),
            warnings: found
                .warnings
                .iter()
                .map(ToString::to_string)
                .chain(found.trust.iter().flat_map(|t| t.reasons.iter().map(ToString::to_string)))
                .collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_takes_part_once_with_every_preset() {
        let presets = [Preset::Paper, Preset::Robust].map(Parameters::from);
        let names = ["three-point", "two-point", "three-point"].map(str::to_owned);
        let labels: Vec<_> = contenders(&names, &presets).unwrap().iter().map(|c| c.label()).collect();
        assert_eq!(
            labels,
            ["three-point paper", "three-point robust", "two-point paper", "two-point robust"]
        );
    }

    #[test]
    fn an_unknown_method_is_named_with_the_known_ones() {
        let Err(error) = contenders(&["magic".into()], &[Parameters::default()]) else {
            panic!("there is no such method")
        };
        assert_eq!(error.to_string(), "there is no method called magic; there are two-point, three-point");
    }
}
