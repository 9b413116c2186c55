//! The body rates at the knots that make the midpoint-chart curve C².
//!
//! With body rates ωᵢ at the knots, continuity of the body acceleration at knot i reads
//!
//! (2/hᵢ₋₁)Eᵢ₋₁ᵀωᵢ₋₁ + 4(1/hᵢ₋₁ + 1/hᵢ)ωᵢ + (2/hᵢ)Eᵢωᵢ₊₁ + λ\[N(ωᵢ; θᵢ₋₁/2) − N(ωᵢ; −θᵢ/2)\] = 6(θᵢ₋₁/hᵢ₋₁² + θᵢ/hᵢ²)
//!
//! with Eᵢ = Exp(θᵢ/2): the linear part is symmetric, positive definite and block diagonally dominant. λ = 1 is wanted; λ = 0
//! is where the solution starts.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use crate::block_tridiagonal::BlockTridiagonal;
use crate::curve::longer_side;
use crate::group::{LieGroup, So3Group};
use crate::rotation_segment::QuadraticAcceleration;

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

/// The greatest defect of a row relative to the row's terms that counts as solved: a few hundred roundings.
const SOLVED: f64 = 1e-13;
/// Newton stalls at rounding; a stall below this is still far inside the promised 1e-11.
const ACCEPTABLE: f64 = 2e-12;
const NEWTON_STEPS: usize = 30;
const SMALLEST_LINE_FRACTION: f64 = 1e-3;
const SMALLEST_HOMOTOPY_STEP: f64 = 1.0 / 256.0;

struct Segment {
    /// 6θ/h².
    pull: Vector3<f64>,
    /// 2/h.
    stiffness: f64,
    /// (2/h)·E.
    carry: Matrix3<f64>,
    quadratic: QuadraticAcceleration,
}

impl Segment {
    fn new(theta: &Vector3<f64>, h: f64) -> Self {
        Self {
            pull: theta * (6.0 / (h * h)),
            stiffness: 2.0 / h,
            carry: So3Group::adjoint(&So3Group::exp(theta * 0.5)) * (2.0 / h),
            quadratic: QuadraticAcceleration::new(theta),
        }
    }

    /// Minus the body acceleration at the left end, N weighted: what the segment adds to the equation of its left knot.
    fn left_end(&self, left: &Vector3<f64>, right: &Vector3<f64>, weight: f64) -> Vector3<f64> {
        let linear = left * (2.0 * self.stiffness) + self.carry * right - self.pull;
        if weight > 0.0 { linear + self.quadratic.left(left) * weight } else { linear }
    }

    /// The body acceleration at the right end, likewise.
    fn right_end(&self, left: &Vector3<f64>, right: &Vector3<f64>, weight: f64) -> Vector3<f64> {
        let linear = right * (2.0 * self.stiffness) + self.carry.tr_mul(left) - self.pull;
        if weight > 0.0 { linear + self.quadratic.right(right) * weight } else { linear }
    }
}

/// The equations for segments of rotation vector θᵢ and length hᵢ.
struct Equations {
    segments: Vec<Segment>,
    knots: usize,
    /// The knots whose rates are unknown.
    unknown: Range<usize>,
}

/// Rates tried, and by how much they miss the equations.
struct Trial {
    rates: Vec<Vector3<f64>>,
    defect: Vec<Vector3<f64>>,
    /// Sum of the sizes of each row's terms.
    terms: Vec<f64>,
    /// Greatest defect relative to its row's terms.
    worst: f64,
}

impl Trial {
    fn new(rates: Vec<Vector3<f64>>) -> Self {
        let (defect, terms) = (vec![Vector3::zeros(); rates.len()], vec![0.0; rates.len()]);
        Self { rates, defect, terms, worst: f64::INFINITY }
    }
}

/// The second derivatives of every segment's chart coordinates at its two ends.
///
/// Of the body rates that solve the equations each knot's acceleration is taken on its longer side: see `cubic_bends`.
///
/// # Errors
/// The greatest relative defect that was left, where Newton with homotopy does not come to a solution.
pub(crate) fn spline_bends(
    turns: &[Vector3<f64>],
    lengths: &[f64],
    ends: EndRates,
) -> Result<Vec<[Vector3<f64>; 2]>, f64> {
    let closed = matches!(ends, EndRates::Periodic);
    let knots = turns.len() + usize::from(!closed);
    let mut rates = vec![Vector3::zeros(); knots];
    let mut unknown = 0..knots;
    if let EndRates::Clamped([first, last]) = ends {
        unknown = 1..knots - 1;
        rates[0] = first;
        rates[knots - 1] = last;
    }
    let segments = turns.iter().zip(lengths).map(|(theta, &h)| Segment::new(theta, h));
    let equations = Equations { segments: segments.collect(), knots, unknown };
    let rates = if equations.unknown.is_empty() { rates } else { equations.solve(rates)? };
    let accelerations: Vec<_> = (0..knots)
        .map(|knot| {
            let (index, at_start) = longer_side(knot, lengths, knots);
            let segment = &equations.segments[index];
            let (left, right) = (&rates[index], &rates[(index + 1) % knots]);
            if at_start { -segment.left_end(left, right, 1.0) } else { segment.right_end(left, right, 1.0) }
        })
        .collect();
    let bends = |(i, segment): (usize, &Segment)| {
        let j = (i + 1) % knots;
        [
            segment.quadratic.left_bend(&rates[i], &accelerations[i]),
            segment.quadratic.right_bend(&rates[j], &accelerations[j]),
        ]
    };
    Ok(equations.segments.iter().enumerate().map(bends).collect())
}

impl Equations {
    fn solve(&self, rates: Vec<Vector3<f64>>) -> Result<Vec<Vector3<f64>>, f64> {
        let mut system = self.linear_part();
        // The linear equations are solved by one Newton step from any rates.
        let linear = self.newton(&mut system, rates, 0.0)?;
        if let Ok(rates) = self.newton(&mut system, linear.clone(), 1.0) {
            return Ok(rates);
        }
        let (mut reached, mut rates, mut step, mut defect) = (0.0, linear, 0.25, f64::INFINITY);
        while reached < 1.0 {
            let target = f64::min(1.0, reached + step);
            match self.newton(&mut system, rates.clone(), target) {
                Ok(solution) => (reached, rates, step) = (target, solution, step * 2.0),
                Err(left) if step < SMALLEST_HOMOTOPY_STEP => return Err(left.min(defect)),
                Err(left) => (step, defect) = (0.5 * step, left),
            }
        }
        Ok(rates)
    }

    fn linear_part(&self) -> BlockTridiagonal {
        let closed = self.segments.len() == self.knots;
        let between_unknown = if closed { 0..self.knots } else { self.unknown.start..self.unknown.end - 1 };
        let couplings = self.segments[between_unknown].iter().map(|s| s.carry).collect();
        BlockTridiagonal::new(self.unknown.len(), couplings)
    }

    /// Newton with halving line search on the equations with weight λ on N.
    fn newton(
        &self,
        system: &mut BlockTridiagonal,
        rates: Vec<Vector3<f64>>,
        weight: f64,
    ) -> Result<Vec<Vector3<f64>>, f64> {
        let mut now = Trial::new(rates);
        self.evaluate(&mut now, weight);
        let mut next = Trial::new(now.rates.clone());
        for _ in 0..NEWTON_STEPS {
            if now.worst < SOLVED {
                break;
            }
            self.set_diagonal(system, &now.rates, weight);
            let unknown = self.unknown.clone();
            if system.solve(&mut now.defect[unknown.clone()]).is_none() {
                break;
            }
            let mut fraction = 1.0;
            while fraction > SMALLEST_LINE_FRACTION {
                for k in unknown.clone() {
                    next.rates[k] = now.rates[k] - now.defect[k] * fraction;
                }
                self.evaluate(&mut next, weight);
                if next.worst < now.worst {
                    break;
                }
                fraction *= 0.5;
            }
            // A defect that is not a number is no improvement either.
            let improved = next.worst < now.worst;
            if !improved {
                break;
            }
            std::mem::swap(&mut now, &mut next);
        }
        if now.worst < ACCEPTABLE { Ok(now.rates) } else { Err(now.worst) }
    }

    /// Left sides minus right sides, which are the jumps of the acceleration.
    fn evaluate(&self, trial: &mut Trial, weight: f64) {
        let Trial { rates, defect, terms, worst } = trial;
        defect.fill(Vector3::zeros());
        terms.fill(f64::MIN_POSITIVE);
        for (i, segment) in self.segments.iter().enumerate() {
            let j = (i + 1) % self.knots;
            let (left, right) = (&rates[i], &rates[j]);
            defect[i] += segment.left_end(left, right, weight);
            defect[j] += segment.right_end(left, right, weight);
            let pull = segment.pull.norm();
            terms[i] += pull + 2.0 * segment.stiffness * left.norm();
            terms[j] += pull + 2.0 * segment.stiffness * right.norm();
        }
        let relative = self.unknown.clone().map(|k| defect[k].norm() / terms[k]);
        // Not `max`, which drops what is not a number.
        *worst = relative.fold(0.0, |worst, r| if r <= worst { worst } else { r });
    }

    fn set_diagonal(&self, system: &mut BlockTridiagonal, rates: &[Vector3<f64>], weight: f64) {
        system.diagonal.fill(Matrix3::zeros());
        for (i, segment) in self.segments.iter().enumerate() {
            let j = (i + 1) % self.knots;
            if self.unknown.contains(&i) {
                let block = &mut system.diagonal[i - self.unknown.start];
                add_to_diagonal(block, 2.0 * segment.stiffness);
                if weight > 0.0 {
                    *block += segment.quadratic.left_by_rate(&rates[i]) * weight;
                }
            }
            if self.unknown.contains(&j) {
                let block = &mut system.diagonal[j - self.unknown.start];
                add_to_diagonal(block, 2.0 * segment.stiffness);
                if weight > 0.0 {
                    *block += segment.quadratic.right_by_rate(&rates[j]) * weight;
                }
            }
        }
    }
}

fn add_to_diagonal(block: &mut Matrix3<f64>, value: f64) {
    for k in 0..3 {
        block[(k, k)] += value;
    }
}

#[cfg(test)]
#[path = "spline_rates_tests.rs"]
mod tests;
