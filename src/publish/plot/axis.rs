//! Axis scales with ticks, and the frame of a plot.

use maud::{Markup, html as markup};

use super::{FAINT, GRID, INK, TEXT, n};

/// Range of values, linear or logarithmic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisScale {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl AxisScale {
    /// Creates a linear scale. An empty range becomes one of length 1.
    pub fn linear(low: f64, high: f64) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        Self { low, high, logarithmic: false }
    }

    /// Creates a logarithmic scale of whole decades around the finite positive values, between
    /// 0.001 and 100,000. Other values are placed at its ends.
    pub fn decades(values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|v| v.is_finite() && *v > 0.0) {
            let decade = value.log10().clamp(-3.0, 5.0);
            low = low.min(decade);
            high = high.max(decade);
        }
        if low > high {
            (low, high) = (-1.0, 1.0);
        }
        let low = low.floor();
        Self { low: 10_f64.powf(low), high: 10_f64.powf(high.ceil().max(low + 1.0)), logarithmic: true }
    }

    /// Returns the position of a value, 0 to 1, clamped to the scale.
    pub fn place(&self, value: f64) -> f64 {
        let share = if self.logarithmic {
            (value / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        // The logarithm of zero is −∞. NaN does not occur.
        share.clamp(0.0, 1.0)
    }

    /// Returns whether a value lies on the scale.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Returns the values of labelled ticks.
    fn labelled(&self) -> Vec<f64> {
        if self.logarithmic {
            let decades = (self.high / self.low).log10().round() as i32;
            let factors: &[f64] = if decades <= 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
            let all = (0..=decades).flat_map(|d| factors.iter().map(move |f| f * 10_f64.powi(d)));
            return all.map(|v| v * self.low).filter(|v| *v <= self.high * 1.0001).collect();
        }
        let step = round_step((self.high - self.low) / 7.0);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last).map(|k| k as f64 * step).collect()
    }

    /// Returns the values of ticks without label.
    fn minor(&self) -> Vec<f64> {
        if !self.logarithmic {
            return Vec::new();
        }
        let decades = (self.high / self.low).log10().round() as i32;
        (0..decades)
            .flat_map(|d| (2..10).map(move |k| f64::from(k) * 10_f64.powi(d)))
            .map(|v| v * self.low)
            .collect()
    }
}

/// Rounds a step up to 1, 2 or 5 times a power of ten.
fn round_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * decade >= step * 0.999).unwrap_or(10.0);
    factor * decade
}

/// Formats a label without trailing zeros, with a minus sign (U+2212).
fn label(value: f64) -> String {
    // The smallest scale begins at 0.001.
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').replace('-', "\u{2212}")
}

/// Rectangle of a plot.
#[derive(Debug, Clone, Copy)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

impl Area {
    /// Returns the position of a value on the horizontal scale.
    pub(super) fn x(&self, scale: &AxisScale, value: f64) -> f64 {
        self.left + scale.place(value) * (self.right - self.left)
    }

    /// Returns the position of a value on the vertical scale.
    pub(super) fn y(&self, scale: &AxisScale, value: f64) -> f64 {
        self.bottom - scale.place(value) * (self.bottom - self.top)
    }

    /// Draws the vertical grid lines and the ticks below.
    pub(super) fn ticks(&self, scale: &AxisScale) -> Markup {
        let at = |value: f64| n(self.x(scale, value));
        markup! {
            @for value in scale.labelled() {
                line x1=(at(value)) x2=(at(value)) y1=(n(self.top)) y2=(n(self.bottom)) stroke=(GRID) {}
                line x1=(at(value)) x2=(at(value)) y1=(n(self.bottom)) y2=(n(self.bottom + 6.0)) stroke=(INK) {}
            }
            @for value in scale.minor() {
                line x1=(at(value)) x2=(at(value)) y1=(n(self.bottom)) y2=(n(self.bottom + 3.0)) stroke=(INK) {}
            }
            line x1=(n(self.left)) x2=(n(self.right)) y1=(n(self.bottom)) y2=(n(self.bottom)) stroke=(INK) {}
        }
    }

    /// Draws grid, ticks and labels below, and the name of the quantity with its unit.
    pub(super) fn horizontal(&self, scale: &AxisScale, name: &str) -> Markup {
        markup! {
            (self.ticks(scale))
            @for value in scale.labelled() {
                text x=(n(self.x(scale, value))) y=(n(self.bottom + 8.0 + TEXT)) text-anchor="middle" { (label(value)) }
            }
            text x=(n(f64::midpoint(self.left, self.right))) y=(n(self.bottom + 14.0 + 2.0 * TEXT)) text-anchor="middle" {
                (name)
            }
        }
    }

    /// Draws grid, ticks, labels and name at the left; `unit` follows every label.
    pub(super) fn vertical(&self, scale: &AxisScale, name: &str, unit: &str) -> Markup {
        let at = |value: f64| self.y(scale, value);
        let middle = f64::midpoint(self.top, self.bottom);
        let beside = 14.0;
        markup! {
            @for value in scale.labelled() {
                line x1=(n(self.left)) x2=(n(self.right)) y1=(n(at(value))) y2=(n(at(value))) stroke=(GRID) {}
                line x1=(n(self.left - 6.0)) x2=(n(self.left)) y1=(n(at(value))) y2=(n(at(value))) stroke=(INK) {}
                text x=(n(self.left - 9.0)) y=(n(at(value) + 0.35 * TEXT)) text-anchor="end" { (label(value)) (unit) }
            }
            line x1=(n(self.left)) x2=(n(self.left)) y1=(n(self.top)) y2=(n(self.bottom)) stroke=(INK) {}
            text x=(beside) y=(n(middle)) text-anchor="middle" transform={ "rotate(-90 " (beside) " " (n(middle)) ")" } {
                (name)
            }
        }
    }

    /// Draws dotted lines at those `values` that lie on the scale.
    pub(super) fn limits(&self, scale: &AxisScale, values: &[f64]) -> Markup {
        markup! {
            @for value in values.iter().filter(|v| scale.contains(**v)) {
                line x1=(n(self.x(scale, *value))) x2=(n(self.x(scale, *value))) y1=(n(self.top)) y2=(n(self.bottom))
                    stroke=(FAINT) stroke-dasharray="2 3" {}
                text x=(n(self.x(scale, *value))) y=(n(self.top - 5.0)) text-anchor="middle" fill=(FAINT) {
                    (label(*value)) " px"
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_hold_the_values_and_leave_out_what_is_no_length() {
        let scale = AxisScale::decades([0.23, 45.0, f64::INFINITY, 0.0, f64::NAN].into_iter());
        let labels: Vec<_> = scale.labelled().into_iter().map(label).collect();
        assert_eq!(labels, ["0.1", "1", "10", "100"]);
        assert!((scale.place(1.0) - 1.0 / 3.0).abs() < 1e-9);
        assert!(scale.place(0.0).abs() < 1e-12 && (scale.place(f64::INFINITY) - 1.0).abs() < 1e-12);
        assert_eq!(scale.minor().len(), 24);
        assert_eq!(AxisScale::decades(std::iter::empty()).labelled().len(), 7, "0.1 0.2 0.5 1 2 5 10");
        assert!(AxisScale::decades([1.0].into_iter()).contains(9.0), "never without length");
        assert!(!AxisScale::decades([1e-9, 1e12].into_iter()).contains(1e-4));
    }

    #[test]
    fn linear_ticks_are_round_and_inside() {
        let ticks = AxisScale::linear(-130.0, 400.0).labelled();
        assert_eq!(ticks, [-100.0, 0.0, 100.0, 200.0, 300.0, 400.0]);
        assert_eq!(AxisScale::linear(0.0, 255.0).labelled(), [0.0, 50.0, 100.0, 150.0, 200.0, 250.0]);
        assert!(AxisScale::linear(3.0, 3.0).place(3.5) < 1.0);
    }
}
