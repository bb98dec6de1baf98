//! Homogeneous linear equations in nine unknowns, solved by elimination with complete pivoting.
//!
//! Elimination is about ten times as fast as a singular value decomposition, and a search draws
//! thousands of samples of seven or eight equations.

use nalgebra::SVector;

/// The unknowns of an equation, in the order of its coefficients.
pub(crate) type Unknowns = SVector<f64, 9>;

/// Equations in reduced form: each equation has one pivot unknown, and all share the free unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Eliminated<const EQUATIONS: usize> {
    rows: [[f64; 9]; EQUATIONS],
    /// Unknown of each column; the free unknowns come last.
    unknowns: [usize; 9],
}

impl<const EQUATIONS: usize> Eliminated<EQUATIONS> {
    /// Reduces the equations. Returns `None` when a pivot is at most `least`, so that the equations
    /// are (nearly) dependent.
    pub(crate) fn new(mut rows: [[f64; 9]; EQUATIONS], least: f64) -> Option<Self> {
        let mut unknowns: [usize; 9] = std::array::from_fn(|k| k);
        for step in 0..EQUATIONS {
            let (mut largest, mut at) = (0.0, (step, step));
            for (r, row) in rows.iter().enumerate().skip(step) {
                for (c, value) in row.iter().enumerate().skip(step) {
                    if value.abs() > largest {
                        (largest, at) = (value.abs(), (r, c));
                    }
                }
            }
            // Comparisons with NaN are false, so NaN entries end here too.
            if largest <= least {
                return None;
            }
            rows.swap(step, at.0);
            for row in &mut rows {
                row.swap(step, at.1);
            }
            unknowns.swap(step, at.1);
            let pivot = rows[step];
            for (r, row) in rows.iter_mut().enumerate() {
                if r != step {
                    let factor = row[step] / pivot[step];
                    for c in step..9 {
                        row[c] -= factor * pivot[c];
                    }
                }
            }
        }
        Some(Self { rows, unknowns })
    }

    /// Returns a basis of the solutions: in each, one free unknown is 1 and the other free unknowns
    /// are 0. `FREE` is nine minus the number of equations.
    pub(crate) fn solutions<const FREE: usize>(&self) -> [Unknowns; FREE] {
        const { assert!(EQUATIONS + FREE == 9, "an unknown is free or has an equation of its own") };
        std::array::from_fn(|free| {
            let mut solution = Unknowns::zeros();
            solution[self.unknowns[EQUATIONS + free]] = 1.0;
            for (k, row) in self.rows.iter().enumerate() {
                solution[self.unknowns[k]] = -row[EQUATIONS + free] / row[k];
            }
            solution
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Returns equations with coefficients of several scales, as image points produce.
    fn equations<const N: usize>(seed: u64) -> [[f64; 9]; N] {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        std::array::from_fn(|_| {
            std::array::from_fn(|k| 10f64.powi(k as i32 % 4) * (rng.random::<f64>() - 0.5))
        })
    }

    fn solved<const N: usize, const FREE: usize>(seed: u64) {
        let rows = equations::<N>(seed);
        let solutions: [Unknowns; FREE] = Eliminated::new(rows, 1e-9).unwrap().solutions();
        for solution in &solutions {
            for row in rows {
                let row = Unknowns::from(row);
                assert!(row.dot(solution).abs() < 1e-9 * row.norm() * solution.norm(), "seed {seed}");
            }
        }
        // The solutions span the null space: none is a linear combination of the others.
        let gram = nalgebra::DMatrix::from_fn(FREE, FREE, |i, j| {
            solutions[i].normalize().dot(&solutions[j].normalize())
        });
        assert!(gram.symmetric_eigenvalues().min() > 1e-6, "seed {seed}");
    }

    #[test]
    fn solutions_satisfy_all_equations_and_span_what_is_left_free() {
        for seed in 0..50 {
            solved::<7, 2>(seed);
            solved::<8, 1>(seed);
        }
    }

    #[test]
    fn an_unknown_that_no_equation_holds_is_free_wherever_it_stands() {
        for missing in 0..9 {
            let mut rows = equations::<8>(3);
            for row in &mut rows {
                row[missing] = 0.0;
            }
            let [solution] = Eliminated::new(rows, 1e-9).unwrap().solutions();
            let mut expected = Unknowns::zeros();
            expected[missing] = 1.0;
            assert_eq!(solution, expected);
        }
    }

    #[test]
    fn equations_that_depend_on_each_other_and_nonsense_have_no_solution() {
        let mut dependent = equations::<8>(4);
        dependent[5] = std::array::from_fn(|k| 2.0 * dependent[1][k] - dependent[6][k]);
        assert!(Eliminated::new(dependent, 1e-9).is_none());
        assert!(Eliminated::new([[0.0; 9]; 7], 0.0).is_none());
        assert!(Eliminated::new([[f64::NAN; 9]; 7], 1e-9).is_none());
    }
}
