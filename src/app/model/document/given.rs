//! Matches of another program.

use serde::{Deserialize, Serialize};

use crate::app::model::shared::Shared;
use crate::estimate::Match;
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance};

/// Sampson distance below which a given match fits a geometry, px: the limit of `epiline judge`.
pub const GIVEN_FIT: f64 = crate::judge::LIMIT;

/// Matches of another program, in the coordinates of the window. The geometry that fits them
/// competes with that of the search, and the images judge both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct Given {
    pub file: String,
    pub matches: Shared<Vec<Match>>,
}

/// Given matches in a session file.
#[derive(Serialize, Deserialize)]
struct Written {
    file: String,
    /// Coordinates `x1 y1 x2 y2`, scale of the noise, and prior probability.
    matches: Vec<[f64; 6]>,
}

impl Given {
    pub fn new(file: String, matches: Vec<Match>) -> Self {
        Self { file, matches: Shared::new(matches) }
    }

    /// Returns how many matches fit a geometry.
    pub fn fitting(&self, f: &FundamentalMatrix) -> usize {
        self.pairs().filter(|pair| sampson_distance(f, pair) < GIVEN_FIT).count()
    }

    pub fn pairs(&self) -> impl ExactSizeIterator<Item = &PointPair> {
        self.matches.iter().map(|found| &found.pair)
    }
}

impl From<Given> for Written {
    fn from(given: Given) -> Self {
        let numbers = |Match { pair: PointPair { point1, point2 }, sigma, prior }: &Match| {
            [point1.x, point1.y, point2.x, point2.y, *sigma, *prior]
        };
        Self { matches: given.matches.iter().map(numbers).collect(), file: given.file }
    }
}

impl TryFrom<Written> for Given {
    type Error = &'static str;

    fn try_from(Written { file, matches }: Written) -> Result<Self, Self::Error> {
        let found = matches.iter().map(|[x1, y1, x2, y2, sigma, prior]| {
            let pair = PointPair::new(*x1, *y1, *x2, *y2);
            let is_sound =
                pair.is_finite() && sigma.is_finite() && *sigma > 0.0 && *prior > 0.0 && *prior <= 1.0;
            is_sound.then_some(Match { pair, sigma: *sigma, prior: *prior })
        });
        let matches: Option<Vec<Match>> = found.collect();
        Ok(Self::new(file, matches.ok_or("a given match is impossible")?))
    }
}
