//! Curves that straighten.

use nalgebra::SVector;

use crate::tridiagonal::Tridiagonal;

/// Why a curve does not flow.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// No curve.
    #[error("a curve needs at least 2 points, {given} given")]
    TooFewPoints {
        /// How many there are.
        given: usize,
    },
    /// A point has a coordinate that is not finite.
    #[error("point {index} of the curve has a coordinate that is not a finite number")]
    NonFinitePoint {
        /// Which.
        index: usize,
    },
    /// Two successive points are equal, or were drawn together by the flow.
    #[error("points {index} and {next} of the curve coincide at time {time}: remove one", next = index + 1)]
    Coincident {
        /// The first of the pair.
        index: usize,
        /// When.
        time: f64,
    },
    /// No step in time.
    #[error("the time step must be positive and finite, {step} given")]
    Step {
        /// What was asked for.
        step: f64,
    },
}

/// Curvature flow ∂C/∂t = κN of a curve with fixed ends (thesis eq. 4.1, Example 4.1), by a polygon in ℝᴺ; in the limit the
/// straight segment between the ends.
///
/// κN = d²C/ds² in arc length s. With edges lᵢ of the present polygon a step τ solves, for all inner points at once (Dziuk 1990),
///
/// ½(lᵢ₋₁ + lᵢ)(xᵢ' − xᵢ)/τ = (x'ᵢ₊₁ − x'ᵢ)/lᵢ − (x'ᵢ − x'ᵢ₋₁)/lᵢ₋₁,
///
/// a tridiagonal system that is diagonally dominant whatever the step. It is of first order in τ, of second in the edges.
/// Multiplied by the movements and summed it says, with a(a − l)/l ≥ a − l for the new edges a, that **every step of any size
/// shortens the polygon** by Σ ½(lᵢ₋₁ + lᵢ)‖xᵢ' − xᵢ‖²/τ at least.
///
/// Points are not redistributed: where the flow contracts the curve, they come closer together.
///
/// ```
/// use se3_geom::{nalgebra::Vector2, CurvatureFlow};
/// let mut flow = CurvatureFlow::new([[0.0, 0.0], [0.0, 0.7], [1.0, 1.0]].map(Vector2::from).to_vec())?;
/// for _ in 0..20 {
///     flow.advance(0.5)?;
/// }
/// assert!((flow.length() - 2f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), se3_geom::FlowError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CurvatureFlow<const N: usize> {
    points: Vec<SVector<f64, N>>,
    time: f64,
}

impl<const N: usize> CurvatureFlow<N> {
    /// The flow at time zero. The first and the last point stay where they are.
    ///
    /// # Errors
    /// [`FlowError`] for fewer than two points, numbers that are not finite, and equal successive points.
    pub fn new(points: Vec<SVector<f64, N>>) -> Result<Self, FlowError> {
        if points.len() < 2 {
            return Err(FlowError::TooFewPoints { given: points.len() });
        }
        let flow = Self { points, time: 0.0 };
        flow.checked_edges()?;
        Ok(flow)
    }

    /// Goes on by `step`, whose unit is that of length squared. On an error the flow stays as it was.
    ///
    /// # Errors
    /// [`FlowError::Step`], [`FlowError::Coincident`] where points were drawn together, [`FlowError::NonFinitePoint`] where the step
    /// divided by an edge is more than a number holds.
    pub fn advance(&mut self, step: f64) -> Result<(), FlowError> {
        if !(step.is_finite() && step > 0.0) {
            return Err(FlowError::Step { step });
        }
        let edges = self.checked_edges()?;
        let mut next = self.points.clone();
        let mut system = Tridiagonal { rows: vec![[0.0, 1.0, 0.0]; next.len()] };
        for (i, pair) in edges.windows(2).enumerate() {
            // Multiplied by the step, so that neither a long nor a short one overflows.
            let [pull_back, pull_on] = [step / pair[0], step / pair[1]];
            let weight = 0.5 * (pair[0] + pair[1]);
            system.rows[i + 1] = [-pull_back, weight + pull_back + pull_on, -pull_on];
            next[i + 1] *= weight;
        }
        system.solve(&mut next, false);
        let advanced = Self { points: next, time: self.time + step };
        advanced.checked_edges()?;
        *self = advanced;
        Ok(())
    }

    /// The corners of the polygon.
    pub fn points(&self) -> &[SVector<f64, N>] {
        &self.points
    }

    /// The sum of the steps so far.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The length of the polygon.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    fn checked_edges(&self) -> Result<Vec<f64>, FlowError> {
        if let Some(index) = self.points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            return Err(FlowError::NonFinitePoint { index });
        }
        let edge = |(index, pair): (usize, &[SVector<f64, N>])| match (pair[1] - pair[0]).norm() {
            length if length > 0.0 => Ok(length),
            _ => Err(FlowError::Coincident { index, time: self.time }),
        };
        self.points.windows(2).enumerate().map(edge).collect()
    }
}
