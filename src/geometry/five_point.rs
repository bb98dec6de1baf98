//! Essential matrices from five matches of calibrated cameras (Nistér 2004).
//!
//! Five matches leave four matrices, `E = x X + y Y + z Z + W`. An essential matrix satisfies ten cubic
//! equations in `x`, `y`, `z`:
//!
//! ```text
//!     det E = 0,        2 E Eᵀ E − tr(E Eᵀ) E = 0 .
//! ```
//!
//! Elimination leaves three equations that are linear in `x` and `y`, with polynomials in `z` as coefficients.
//! Their determinant is a polynomial of degree ten in `z`. Each of its real roots gives one essential matrix.
//! Unlike the fundamental matrix, the essential matrix of points on one plane is determined, up to two
//! solutions.

use nalgebra::Matrix3;

use super::Eliminated;
use super::minimal::Equation;

/// Largest pivot, for rays with coordinates near 1, that is rounding. The equations then depend on each other.
const SMALLEST_PIVOT: f64 = 1e-9;
/// Steps of bisection and of Newton's method for a root in an interval of length 2 or less.
const STEPS: usize = 60;

/// Number of monomials of degree up to three in three unknowns.
const CUBICS: usize = 20;
/// Exponents of `x`, `y`, `z` in the order of elimination: the last ten have no `x² … y` of their own.
const MONOMIALS: [[u8; 3]; CUBICS] = [
    [3, 0, 0],
    [0, 3, 0],
    [2, 1, 0],
    [1, 2, 0],
    [2, 0, 1],
    [2, 0, 0],
    [0, 2, 1],
    [0, 2, 0],
    [1, 1, 1],
    [1, 1, 0],
    [1, 0, 2],
    [1, 0, 1],
    [1, 0, 0],
    [0, 1, 2],
    [0, 1, 1],
    [0, 1, 0],
    [0, 0, 3],
    [0, 0, 2],
    [0, 0, 1],
    [0, 0, 0],
];

/// Returns the essential matrices of norm 1 that satisfy the equations `r2ᵀ E r1 = 0` of five matches, up to ten.
pub(crate) fn solve_five(equations: &[Equation; 5]) -> Vec<Matrix3<f64>> {
    let Some(basis) = null_space(equations) else { return Vec::new() };
    let Some(rows) = eliminated(&constraints(&basis)) else { return Vec::new() };
    // Each pair of rows eliminates x² z, y² z or x y z.
    let b = [[4, 5], [6, 7], [8, 9]].map(|[with_z, without]| linear_equation(&rows[with_z], &rows[without]));
    let determinant = determinant(&b);
    let essential = |z: f64| {
        let at = Matrix3::from_fn(|r, c| value(&b[r][c], z));
        // The vector (x, y, 1) is across all rows.
        let across =
            [(0, 1), (1, 2), (2, 0)].map(|(r, s)| at.row(r).transpose().cross(&at.row(s).transpose()));
        let across = across.into_iter().max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))?;
        let scaled = basis[0] * across.x + basis[1] * across.y + (basis[2] * z + basis[3]) * across.z;
        let norm = scaled.norm();
        (norm > 0.0 && norm.is_finite()).then(|| scaled / norm)
    };
    real_roots(&determinant).into_iter().filter_map(essential).collect()
}

fn null_space(equations: &[Equation; 5]) -> Option<[Matrix3<f64>; 4]> {
    let mut solutions = Eliminated::new(*equations, SMALLEST_PIVOT)?.solutions::<4>();
    // Orthonormal matrices keep the cubic equations well conditioned.
    for k in 0..4 {
        for j in 0..k {
            let along = solutions[j].dot(&solutions[k]);
            solutions[k] -= solutions[j] * along;
        }
        solutions[k].normalize_mut();
    }
    Some(solutions.map(|s| Matrix3::from_fn(|r, c| s[3 * r + c])))
}

/// A polynomial in `x`, `y`, `z` of degree at most three, by the index of its monomial.
type Cubic = [f64; CUBICS];

fn monomial(exponents: [u8; 3]) -> usize {
    MONOMIALS.iter().position(|m| *m == exponents).unwrap_or(0)
}

/// Returns the ten cubic equations.
fn constraints(basis: &[Matrix3<f64>; 4]) -> [Cubic; 10] {
    const UNKNOWNS: [[u8; 3]; 4] = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]];
    let mut all = [[0.0; CUBICS]; 10];
    // The products of three basis matrices with the same monomial add up.
    for (i, a) in basis.iter().enumerate() {
        for (j, b) in basis.iter().enumerate() {
            let product = a * b.transpose();
            let trace = product.trace();
            for (k, c) in basis.iter().enumerate() {
                let exponents = std::array::from_fn(|n| UNKNOWNS[i][n] + UNKNOWNS[j][n] + UNKNOWNS[k][n]);
                let at = monomial(exponents);
                let matrix = product * c * 2.0 - c * trace;
                for (equation, value) in all.iter_mut().zip(matrix.iter()) {
                    equation[at] += value;
                }
                let mixed = a.column(0).dot(&b.column(1).cross(&c.column(2)));
                all[9][at] += mixed;
            }
        }
    }
    all
}

/// Eliminates the first ten monomials. Returns the rows with their other ten coefficients. `None` if the
/// equations depend on each other.
fn eliminated(equations: &[Cubic; 10]) -> Option<[[f64; 10]; 10]> {
    let mut rows = *equations;
    for step in 0..10 {
        let largest = (step..10).max_by(|a, b| rows[*a][step].abs().total_cmp(&rows[*b][step].abs()))?;
        rows.swap(step, largest);
        let pivot = rows[step][step];
        if pivot.is_nan() || pivot.abs() < 1e-14 {
            return None;
        }
        rows[step].iter_mut().for_each(|v| *v /= pivot);
        let pivot = rows[step];
        for (r, row) in rows.iter_mut().enumerate() {
            let factor = row[step];
            if r != step && factor != 0.0 {
                row.iter_mut().zip(&pivot).skip(step).for_each(|(v, p)| *v -= factor * p);
            }
        }
    }
    Some(rows.map(|row| std::array::from_fn(|k| row[10 + k])))
}

/// A polynomial in `z`, from the constant coefficient up.
type Polynomial = [f64; 11];

/// Returns the coefficients of `x`, `y` and 1 of `with_z − z · without`, whose first monomials cancel.
fn linear_equation(with_z: &[f64; 10], without: &[f64; 10]) -> [Polynomial; 3] {
    let part = |from: usize, count: usize| {
        let mut polynomial = [0.0; 11];
        for k in 0..count {
            // Coefficients stand from the highest power down.
            polynomial[k] += with_z[from + count - 1 - k];
            polynomial[k + 1] -= without[from + count - 1 - k];
        }
        polynomial
    };
    [part(0, 3), part(3, 3), part(6, 4)]
}

fn determinant(b: &[[Polynomial; 3]; 3]) -> Polynomial {
    let minor =
        |c: usize, d: usize| subtracted(&multiplied(&b[1][c], &b[2][d]), &multiplied(&b[1][d], &b[2][c]));
    let terms = [(0, minor(1, 2)), (1, minor(2, 0)), (2, minor(0, 1))];
    terms.iter().fold([0.0; 11], |sum, (c, minor)| {
        let term = multiplied(&b[0][*c], minor);
        std::array::from_fn(|k| sum[k] + term[k])
    })
}

fn subtracted(a: &Polynomial, b: &Polynomial) -> Polynomial {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Returns the product. No product here has a degree above ten.
fn multiplied(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut product = [0.0; 11];
    for (i, a) in a.iter().enumerate().filter(|(_, a)| **a != 0.0) {
        for (sum, b) in product[i..].iter_mut().zip(b) {
            *sum += a * b;
        }
    }
    product
}

fn value(polynomial: &[f64], z: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, c| sum * z + c)
}

/// Returns the real roots. Those beyond ±1 are the inverses of the roots of the reversed polynomial.
fn real_roots(polynomial: &Polynomial) -> Vec<f64> {
    let mut reversed = *polynomial;
    reversed.reverse();
    let beyond =
        roots_near_zero(&reversed).into_iter().filter(|z| z.abs() < 1.0 && *z != 0.0).map(f64::recip);
    roots_near_zero(polynomial).into_iter().chain(beyond).collect()
}

/// Returns the roots from −1 to 1 in rising order. A polynomial is monotonic between the roots of its
/// derivative, so each interval between them has one root or none.
fn roots_near_zero(polynomial: &Polynomial) -> Vec<f64> {
    // All derivatives, up to constant factors.
    let mut derivatives = vec![polynomial.to_vec()];
    while let Some(last) = derivatives.last().filter(|last| last.len() > 2) {
        let next = last.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect();
        derivatives.push(next);
    }
    let mut roots: Vec<f64> = Vec::new();
    for polynomial in derivatives.iter().rev() {
        let ends: Vec<f64> = std::iter::once(-1.0).chain(roots).chain([1.0]).collect();
        roots = ends.windows(2).filter_map(|ends| root_between(polynomial, ends[0], ends[1])).collect();
    }
    roots
}

/// Returns the root of a polynomial that is monotonic in an interval: Newton's method, with bisection where a
/// step leaves the interval.
fn root_between(polynomial: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let (at_low, at_high) = (value(polynomial, low), value(polynomial, high));
    if at_low == 0.0 {
        return Some(low);
    }
    if (at_low > 0.0) == (at_high > 0.0) {
        return None;
    }
    let mut z = 0.5 * (low + high);
    for _ in 0..STEPS {
        let (at, slope) = polynomial.iter().rev().fold((0.0, 0.0), |(v, d), c| (v * z + c, d * z + v));
        if at == 0.0 {
            break;
        }
        if (at > 0.0) == (at_low > 0.0) {
            low = z;
        } else {
            high = z;
        }
        let newton = z - at / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let is_close = (next - z).abs() <= f64::EPSILON * (1.0 + z.abs());
        z = next;
        if is_close {
            break;
        }
    }
    Some(z)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::geometry::minimal::point_equation;

    /// Returns an essential matrix and five of its matches, on a plane if asked for.
    fn scene(seed: u64, on_plane: bool) -> (Matrix3<f64>, [Equation; 5]) {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut near = |size: f64| size * (2.0 * rng.random::<f64>() - 1.0);
        let turn = Vector3::new(near(0.5), near(0.5), near(0.5));
        let t = Vector3::new(near(1.0), near(1.0), near(1.0)).normalize();
        let rotation = *Rotation3::from_scaled_axis(turn).matrix();
        let e = t.cross_matrix() * rotation;
        let equations = std::array::from_fn(|_| {
            let (x, y) = (near(2.0), near(2.0));
            let z = if on_plane { 5.0 + 0.3 * x - 0.2 * y } else { 5.0 + near(1.5) };
            let first = Vector3::new(x, y, z);
            let second = rotation * first + t;
            point_equation([first.x / first.z, first.y / first.z, second.x / second.z, second.y / second.z])
        });
        (e / e.norm(), equations)
    }

    #[test]
    fn the_true_matrix_is_among_the_solutions_on_a_plane_too() {
        for on_plane in [false, true] {
            let mut missed = 0;
            for seed in 0..400 {
                let (e, equations) = scene(seed, on_plane);
                let solutions = solve_five(&equations);
                assert!(solutions.len() <= 10, "{}", solutions.len());
                let off = |s: &Matrix3<f64>| (s - e).norm().min((s + e).norm());
                missed += usize::from(solutions.iter().map(off).fold(f64::INFINITY, f64::min) > 1e-5);
            }
            // On a plane two solutions may come close to each other, and rounding moves them.
            assert!(missed < 20, "{missed} of 400 on a plane: {on_plane}");
        }
    }

    #[test]
    fn solutions_are_essential_and_satisfy_the_equations() {
        let (mut unequal, mut left): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for seed in 0..200 {
            let (_, equations) = scene(seed, false);
            for e in solve_five(&equations) {
                let mut values: Vec<f64> = e.singular_values().iter().copied().collect();
                values.sort_by(f64::total_cmp);
                unequal.push((values[2] - values[1]).max(values[0]));
                let by_rows =
                    |equation: &Equation| (0..9).map(|k| equation[k] * e[(k / 3, k % 3)]).sum::<f64>();
                left.push(equations.iter().map(|equation| by_rows(equation).abs()).fold(0.0, f64::max));
            }
        }
        unequal.sort_by(f64::total_cmp);
        assert!(unequal[unequal.len() * 95 / 100] < 1e-6, "{}", unequal[unequal.len() * 95 / 100]);
        assert!(left.into_iter().fold(0.0, f64::max) < 1e-6);
    }

    #[test]
    fn dependent_equations_and_nonsense_have_no_solution() {
        let (_, equations) = scene(1, false);
        assert!(solve_five(&[equations[0]; 5]).is_empty());
        assert!(solve_five(&[[f64::NAN; 9]; 5]).is_empty());
    }
}
