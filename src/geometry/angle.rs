//! Angles modulo full turns, radians.

use std::f64::consts::TAU;

/// Returns the angle between two directions, 0 to π.
pub(crate) fn angle_between(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// Returns an angle without its full turns, −π to π.
pub(crate) fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn directions_on_both_sides_of_a_full_turn_are_near() {
        assert!((angle_between(PI - 0.1, 0.1 - PI) - 0.2).abs() < 1e-12);
        assert!((wrapped(2.0 * PI - 0.2) + 0.2).abs() < 1e-12);
    }
}
