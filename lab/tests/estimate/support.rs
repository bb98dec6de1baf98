//! Pairs with ground truth, and the error of an estimate on them.

use std::sync::LazyLock;

use epiline::estimate::{
    Estimate, EstimateError, Method, Monitor, Parameters, PreparedPair, Preset, estimate_prepared,
};
use epiline::geometry::{FundamentalMatrix, Point, PointPair, symmetric_epipolar_distance};
use epiline::synthetic::Sample;
use epiline_lab::{Draws, KnownScene, Protocol, mean};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Built-in pair with pyramids and corners, computed once for all tests.
pub struct Known {
    pub name: &'static str,
    pub scene: KnownScene,
    pub prepared: PreparedPair,
    pub show_me: [PointPair; 2],
    pub third: PointPair,
}

pub static COURTYARD: LazyLock<Known> = LazyLock::new(|| Known::new(Sample::Courtyard));
pub static ALLEY: LazyLock<Known> = LazyLock::new(|| Known::new(Sample::Alley));

/// Returns both built-in pairs: epipoles far outside, and epipoles inside.
pub fn both() -> [&'static Known; 2] {
    [&COURTYARD, &ALLEY]
}

impl Known {
    fn new(sample: Sample) -> Self {
        let pair = sample.load();
        let (show_me, third) = (pair.show_me, pair.third);
        let scene = KnownScene::of_sample(sample.name(), pair);
        Self { name: sample.name(), prepared: scene.prepared(), scene, show_me, third }
    }

    pub fn estimate(&self, clicks: &[PointPair], parameters: &Parameters) -> Result<Estimate, EstimateError> {
        estimate_prepared(&self.prepared, clicks, parameters, &Monitor::silent())
    }

    /// Returns the mean symmetric epipolar distance of the true matches under the estimate, px.
    pub fn error(&self, clicks: &[PointPair], parameters: &Parameters) -> f64 {
        let found = self.estimate(clicks, parameters).expect("true clicks give a geometry");
        mean_distance(found.fundamental(), &self.scene.matches)
    }

    /// Returns two or three well-posed true matches for each trial: the first two are at least 12 %
    /// of the image away from each other's epipolar lines.
    pub fn well_posed(&self, trials: usize, count: usize) -> Vec<Vec<PointPair>> {
        let draws = Draws::new(self.scene.known(), Protocol::WellPosed, trials, 0.0, 1);
        assert_eq!(draws.trials(), trials, "the sample has so many well-posed pairs");
        (0..trials).map(|t| draws.clicks(t, &draws.matches(t, count).expect("a further match"))).collect()
    }
}

pub fn mean_distance(f: &FundamentalMatrix, matches: &[PointPair]) -> f64 {
    mean(&matches.iter().map(|m| symmetric_epipolar_distance(f, m)).collect::<Vec<_>>())
}

/// Shifts every coordinate of the clicks by up to 0.5 px, as a careful hand would.
pub fn disturbed(clicks: &[PointPair], seed: u64) -> Vec<PointPair> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut moved =
        |p: Point| Point::new(p.x + random.random_range(-0.5..=0.5), p.y + random.random_range(-0.5..=0.5));
    clicks.iter().map(|c| PointPair { point1: moved(c.point1), point2: moved(c.point2) }).collect()
}

pub fn three_point() -> Parameters {
    Parameters { method: Method::ThreePoint, ..Parameters::default() }
}

pub fn paper() -> Parameters {
    Parameters::from(Preset::Paper)
}
