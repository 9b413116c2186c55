//! One cubic piece.

use nalgebra::SVector;

/// A cubic c₀ + c₁τ + c₂τ² + c₃τ³ of a vector.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cubic<const N: usize>([SVector<f64, N>; 4]);

impl<const N: usize> Cubic<N> {
    /// The cubic on \[0, h\] with the given end values and end slopes (thesis eq. 6.4).
    #[cfg(test)]
    pub(crate) fn hermite(h: f64, [x0, x1]: [SVector<f64, N>; 2], [v0, v1]: [SVector<f64, N>; 2]) -> Self {
        let slope = (x1 - x0) / h;
        Self([x0, v0, (slope * 3.0 - v0 * 2.0 - v1) / h, (v0 + v1 - slope * 2.0) / (h * h)])
    }

    /// The cubic on \[0, h\] with the given end values and second derivatives there.
    pub(crate) fn bent(h: f64, [x0, x1]: [SVector<f64, N>; 2], [a0, a1]: [SVector<f64, N>; 2]) -> Self {
        Self([x0, (x1 - x0) / h - (a0 * 2.0 + a1) * (h / 6.0), a0 * 0.5, (a1 - a0) / (6.0 * h)])
    }

    #[inline]
    pub(crate) fn value(&self, t: f64) -> SVector<f64, N> {
        let [a, b, c, d] = self.0;
        a + (b + (c + d * t) * t) * t
    }

    /// Value and the first three derivatives.
    #[inline]
    pub(crate) fn at(&self, t: f64) -> [SVector<f64, N>; 4] {
        let [a, b, c, d] = self.0;
        [a + (b + (c + d * t) * t) * t, b + (c * 2.0 + d * (3.0 * t)) * t, c * 2.0 + d * (6.0 * t), d * 6.0]
    }

    /// No less than the length of the curve on \[0, h\]: the length of its Bézier control polygon.
    pub(crate) fn length_bound(&self, h: f64) -> f64 {
        let [_, b, c, d] = self.0;
        let (first, curve) = (b * (h / 3.0), c * (h * h / 3.0));
        first.norm() + (first + curve).norm() + (first + curve * 2.0 + d * h.powi(3)).norm()
    }
}
