//! The rates at the knots that make a piecewise curve C².
//!
//! With body rates ωᵢ at the knots, continuity of the body acceleration at knot i reads
//!
//! (2/hᵢ₋₁)Eᵢ₋₁ᵀωᵢ₋₁ + 4(1/hᵢ₋₁ + 1/hᵢ)ωᵢ + (2/hᵢ)Eᵢωᵢ₊₁ + λ\[N(ωᵢ; θᵢ₋₁/2) − N(ωᵢ; −θᵢ/2)\] = 6(θᵢ₋₁/hᵢ₋₁² + θᵢ/hᵢ²)
//!
//! with Eᵢ = Exp(θᵢ/2). Positions obey the same equations with E = I and N = 0: the ordinary C² cubic spline.

use nalgebra::{Matrix3, Vector3};

use crate::block_tridiagonal::BlockTridiagonal;
use crate::group::{LieGroup, So3Group};
use crate::rotation_segment::quadratic_acceleration;

/// What holds at the two ends of a chain of segments.
#[derive(Debug, Clone, Copy)]
pub(crate) enum EndRates {
    /// Acceleration vanishes.
    Natural,
    /// The rates are given.
    Clamped([Vector3<f64>; 2]),
    /// The last segment leads back to the first knot.
    Periodic,
}

/// The space the chain lives in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Chain {
    Positions,
    Rotations,
}

/// The greatest defect of a row relative to the row's largest term that counts as solved: a few hundred roundings.
const SOLVED: f64 = 1e-13;
/// Newton stalls at rounding; a stall below this is still far inside the promised 1e-11.
const ACCEPTABLE: f64 = 2e-12;
const NEWTON_STEPS: usize = 30;
const SMALLEST_HOMOTOPY_STEP: f64 = 1.0 / 256.0;

pub(crate) struct Problem<'a> {
    /// Displacement of each segment (rotation vector, or difference of positions).
    pub(crate) displacements: &'a [Vector3<f64>],
    /// Length of each segment in the parameter.
    pub(crate) lengths: &'a [f64],
    pub(crate) ends: EndRates,
    pub(crate) chain: Chain,
}

impl Problem<'_> {
    fn knots(&self) -> usize {
        self.displacements.len() + usize::from(!matches!(self.ends, EndRates::Periodic))
    }

    /// The segments on the left and on the right of a knot.
    fn neighbours(&self, knot: usize) -> (Option<usize>, Option<usize>) {
        let segments = self.displacements.len();
        if matches!(self.ends, EndRates::Periodic) {
            return (Some((knot + segments - 1) % segments), Some(knot));
        }
        (knot.checked_sub(1), (knot < segments).then_some(knot))
    }

    fn carry(&self, segment: usize) -> Matrix3<f64> {
        match self.chain {
            Chain::Positions => Matrix3::identity(),
            Chain::Rotations => So3Group::adjoint(&So3Group::exp(self.displacements[segment] * 0.5)),
        }
    }

    /// The linear part of the equations and their right-hand side.
    fn linear_system(&self) -> (BlockTridiagonal, Vec<Vector3<f64>>) {
        let n = self.knots();
        let zero = vec![Matrix3::zeros(); n];
        let mut system = BlockTridiagonal { lower: zero.clone(), diagonal: zero.clone(), upper: zero, corners: None };
        let mut right = vec![Vector3::zeros(); n];
        let mut corners = (Matrix3::zeros(), Matrix3::zeros());
        for (knot, row) in right.iter_mut().enumerate() {
            let is_end = knot == 0 || knot + 1 == n;
            if let (EndRates::Clamped([first, last]), true) = (self.ends, is_end) {
                system.diagonal[knot] = Matrix3::identity();
                *row = if knot == 0 { first } else { last };
                continue;
            }
            let (before, after) = self.neighbours(knot);
            if let Some(segment) = before {
                let h = self.lengths[segment];
                let block = self.carry(segment).transpose() * (2.0 / h);
                system.diagonal[knot] += Matrix3::identity() * (4.0 / h);
                *row += self.displacements[segment] * (6.0 / (h * h));
                match knot {
                    0 => corners.0 += block,
                    _ => system.lower[knot] += block,
                }
            }
            if let Some(segment) = after {
                let h = self.lengths[segment];
                let block = self.carry(segment) * (2.0 / h);
                system.diagonal[knot] += Matrix3::identity() * (4.0 / h);
                *row += self.displacements[segment] * (6.0 / (h * h));
                if knot + 1 < n {
                    system.upper[knot] += block;
                } else {
                    corners.1 += block;
                }
            }
        }
        if matches!(self.ends, EndRates::Periodic) {
            system.corners = Some(corners);
        }
        (system, right)
    }

    /// Adds λN to the defect and its derivative to the system's diagonal.
    fn add_quadratic(
        &self,
        rates: &[Vector3<f64>],
        weight: f64,
        defect: &mut [Vector3<f64>],
        diagonal: &mut [Matrix3<f64>],
    ) {
        let n = rates.len();
        for (knot, rate) in rates.iter().enumerate() {
            if matches!(self.ends, EndRates::Clamped(_)) && (knot == 0 || knot + 1 == n) {
                continue;
            }
            let (before, after) = self.neighbours(knot);
            for (segment, sign) in [(before, 1.0), (after, -1.0)] {
                let Some(segment) = segment else { continue };
                let (value, derivative) = quadratic_acceleration(rate, &(self.displacements[segment] * (0.5 * sign)));
                defect[knot] += value * (sign * weight);
                diagonal[knot] += derivative * (sign * weight);
            }
        }
    }

    /// The rates at the knots.
    ///
    /// # Errors
    /// The greatest relative defect that was left, where Newton with homotopy does not come to a solution.
    pub(crate) fn solve(&self) -> Result<Vec<Vector3<f64>>, f64> {
        let (system, right) = self.linear_system();
        let start = system.solve(&right).filter(|rates| finite(rates)).ok_or(f64::INFINITY)?;
        if self.chain == Chain::Positions {
            return Ok(start);
        }
        if let Ok(rates) = self.newton(&system, &right, start.clone(), 1.0) {
            return Ok(rates);
        }
        let (mut reached, mut rates, mut step, mut defect) = (0.0, start, 0.25, f64::INFINITY);
        while reached < 1.0 {
            let target = f64::min(1.0, reached + step);
            match self.newton(&system, &right, rates.clone(), target) {
                Ok(solution) => (reached, rates, step) = (target, solution, step * 2.0),
                Err(left) if step < SMALLEST_HOMOTOPY_STEP => return Err(left.min(defect)),
                Err(left) => (step, defect) = (0.5 * step, left),
            }
        }
        Ok(rates)
    }

    /// Newton with halving line search on the equations with weight λ on N.
    fn newton(
        &self,
        system: &BlockTridiagonal,
        right: &[Vector3<f64>],
        mut rates: Vec<Vector3<f64>>,
        weight: f64,
    ) -> Result<Vec<Vector3<f64>>, f64> {
        let evaluate = |rates: &[Vector3<f64>]| {
            let mut jacobian = system.clone();
            let mut defect = multiply(system, rates);
            // What a row's defect is a rounding of: the greatest term that it is the sum of.
            let scale = largest_terms(system, rates, right);
            for (d, r) in defect.iter_mut().zip(right) {
                *d -= r;
            }
            self.add_quadratic(rates, weight, &mut defect, &mut jacobian.diagonal);
            let worst = greatest(defect.iter().zip(&scale).map(|(d, s)| d.norm() / s));
            (defect, jacobian, worst)
        };
        let (mut defect, mut jacobian, mut worst) = evaluate(&rates);
        for _ in 0..NEWTON_STEPS {
            if worst < SOLVED {
                return Ok(rates);
            }
            let Some(step) = jacobian.solve(&defect) else { break };
            let mut fraction = 1.0;
            let improved = loop {
                let trial: Vec<_> = rates.iter().zip(&step).map(|(r, s)| r - s * fraction).collect();
                let (trial_defect, trial_jacobian, trial_worst) = evaluate(&trial);
                if trial_worst < worst {
                    (rates, defect, jacobian, worst) = (trial, trial_defect, trial_jacobian, trial_worst);
                    break true;
                }
                fraction *= 0.5;
                if fraction < 1e-3 {
                    break false;
                }
            };
            if !improved {
                break;
            }
        }
        if worst < ACCEPTABLE { Ok(rates) } else { Err(worst) }
    }
}

fn finite(rates: &[Vector3<f64>]) -> bool {
    rates.iter().all(|rate| rate.iter().all(|x| x.is_finite()))
}

/// The maximum, which is NaN where any value is: what is not a number is never small enough.
fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |max, value| if value.is_nan() || value > max { value } else { max })
}

fn largest_terms(system: &BlockTridiagonal, x: &[Vector3<f64>], right: &[Vector3<f64>]) -> Vec<f64> {
    let n = x.len();
    let corners = system.corners.unwrap_or_else(|| (Matrix3::zeros(), Matrix3::zeros()));
    let term = |block: &Matrix3<f64>, x: &Vector3<f64>| block.norm() * x.norm();
    let row = |i: usize| {
        let before = if i > 0 { term(&system.lower[i], &x[i - 1]) } else { term(&corners.0, &x[n - 1]) };
        let after = if i + 1 < n { term(&system.upper[i], &x[i + 1]) } else { term(&corners.1, &x[0]) };
        before.max(after).max(term(&system.diagonal[i], &x[i])).max(right[i].norm()).max(f64::MIN_POSITIVE)
    };
    (0..n).map(row).collect()
}

fn multiply(system: &BlockTridiagonal, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let n = x.len();
    let mut product: Vec<_> = (0..n)
        .map(|i| {
            let mut row = system.diagonal[i] * x[i];
            if i > 0 {
                row += system.lower[i] * x[i - 1];
            }
            if i + 1 < n {
                row += system.upper[i] * x[i + 1];
            }
            row
        })
        .collect();
    if let Some((top_right, bottom_left)) = system.corners {
        product[0] += top_right * x[n - 1];
        product[n - 1] += bottom_left * x[0];
    }
    product
}
