//! Distances that are chords and angles of an embedding in ℝⁿ.

/// A space whose squared distance is, in coordinates, that of a flat factor plus that of a round one:
///
/// d(p, q)² = `flat_weight`·‖x_q − x_p‖² + `round.weight`·∠(u_p, u_q)².
///
/// Either factor may be missing. [`Manifold::embed`](crate::Manifold::embed) writes x, then the unit vector u. A spatial search
/// tree bounds such distances by boxes around coordinates, which it cannot do with a distance that is only a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Embedding {
    /// How many flat coordinates a point has.
    pub flat_dimension: usize,
    /// What a squared unit of them counts.
    pub flat_weight: f64,
    /// The round factor.
    pub round: Option<RoundFactor>,
}

/// A sphere, or the lines through its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundFactor {
    /// How many coordinates the unit vector has: k + 1 on the k-sphere.
    pub dimension: usize,
    /// What a squared radian between two unit vectors counts.
    pub weight: f64,
    /// Whether u and −u are the same point, as with quaternions: the angle is then that of the lines, at most π/2.
    pub antipodes_identified: bool,
}

impl Embedding {
    pub(crate) fn flat(dimension: usize, weight: f64) -> Self {
        Self { flat_dimension: dimension, flat_weight: weight, round: None }
    }

    /// The coordinates themselves on the unit sphere of ℝᵏ, with `weight` for a squared radian.
    pub(crate) fn with_sphere(self, dimension: usize, weight: f64) -> Self {
        Self { round: Some(RoundFactor { dimension, weight, antipodes_identified: false }), ..self }
    }

    /// Rotations of space as quaternions ±u, with `weight` for a squared radian of rotation: twice the angle of the lines.
    pub(crate) fn with_rotations(self, weight: f64) -> Self {
        Self { round: Some(RoundFactor { dimension: 4, weight: 4.0 * weight, antipodes_identified: true }), ..self }
    }

    /// How many numbers a point has in all.
    pub fn dimension(&self) -> usize {
        self.flat_dimension + self.round.map_or(0, |round| round.dimension)
    }

    /// d(p, q)² from the coordinates of p and q; the angle is 2·atan2(‖u_q − u_p‖, ‖u_q + u_p‖), accurate everywhere.
    ///
    /// # Panics
    /// If a slice is shorter than [`Self::dimension`].
    ///
    /// ```
    /// use se3_geom::{Manifold, So2, nalgebra::UnitComplex};
    /// let embedding = So2.embedding().unwrap();
    /// let coordinates = |angle: f64| {
    ///     let mut coordinates = [0.0; 2];
    ///     So2.embed(&UnitComplex::new(angle), &mut coordinates);
    ///     coordinates
    /// };
    /// assert!((embedding.squared_distance(&coordinates(1.0), &coordinates(3.0)) - 4.0).abs() < 1e-15);
    /// ```
    pub fn squared_distance(&self, p: &[f64], q: &[f64]) -> f64 {
        let squares = |range: std::ops::Range<usize>, sign: f64| -> f64 {
            range.map(|k| q[k] - sign * p[k]).map(|difference| difference * difference).sum()
        };
        let flat = self.flat_weight * squares(0..self.flat_dimension, 1.0);
        let Some(round) = self.round else { return flat };
        let [near, far] = [1.0, -1.0].map(|sign| squares(self.flat_dimension..self.dimension(), sign).sqrt());
        let [near, far] = if round.antipodes_identified { [near.min(far), near.max(far)] } else { [near, far] };
        let angle = 2.0 * near.atan2(far);
        flat + round.weight * angle * angle
    }
}
