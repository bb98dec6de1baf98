//! Commands to the replay, and its speed.

use serde::{Deserialize, Serialize};

use crate::app::model::focus::Target;
use crate::app::model::ids::MethodStep;

/// Replay speed, times the usual one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "f64", into = "f64")]
pub struct Speed(f64);

impl Speed {
    const ALL: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
    /// Speed of the first replay, at which steps can be followed.
    pub const SLOW: Self = Self(0.5);

    /// Returns the next speed; after the fastest comes the slowest.
    #[must_use]
    pub fn next(self) -> Self {
        Self(Self::ALL.into_iter().find(|speed| *speed > self.0).unwrap_or(Self::ALL[0]))
    }

    /// Returns the number of times the usual speed.
    pub fn times(self) -> f64 {
        self.0
    }

    pub fn label(self) -> &'static str {
        ["¼×", "½×", "1×", "2×", "4×"][Self::ALL.iter().position(|speed| *speed >= self.0).unwrap_or(2)]
    }
}

impl From<f64> for Speed {
    /// Returns the nearest speed.
    fn from(times: f64) -> Self {
        let away = |speed: &f64| (speed - times).abs();
        let nearest = Self::ALL.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.filter(|_| times.is_finite()).map_or_else(Self::default, Self)
    }
}

impl From<Speed> for f64 {
    fn from(speed: Speed) -> Self {
        speed.0
    }
}

impl Default for Speed {
    fn default() -> Self {
        Self(1.0)
    }
}

/// A command to the replay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReplayCommand {
    /// Play from here, or pause. At the result, play from the beginning.
    TogglePlay,
    /// The same at half the usual speed.
    PlaySlowly,
    /// Show a moment of the whole course, s, and pause.
    Seek(f64),
    /// Move by about one line or crossing.
    Nudge {
        forward: bool,
    },
    /// Play a step alone.
    Play(MethodStep),
    /// Play the next or the previous step alone.
    Step {
        forward: bool,
    },
    /// Pause, keep a part of the moment lit, and show the hypothesis of the result that it belongs to, if any.
    Show(Target),
    /// Show the beginning, paused.
    Begin,
    /// Show the result.
    Finish,
    NextSpeed,
    /// Show only the last moment of each step, for people who avoid motion.
    ToggleStill,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_in_the_settings_is_a_speed() {
        for (times, label) in [(0.5, "½×"), (-3.0, "¼×"), (1e9, "4×"), (f64::NAN, "1×"), (1.1, "1×")] {
            assert_eq!(Speed::from(times).label(), label);
        }
        let all: Vec<&str> = std::iter::successors(Some(Speed::from(0.25)), |own| Some(own.next()))
            .map(Speed::label)
            .take(6)
            .collect();
        assert_eq!(all, ["¼×", "½×", "1×", "2×", "4×", "¼×"]);
    }
}
