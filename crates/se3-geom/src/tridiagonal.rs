//! Linear solver for chains of numbers.

use nalgebra::SVector;

/// Row i holds the factors of unknowns i−1, i, i+1, cyclically.
pub(crate) struct Tridiagonal {
    pub(crate) rows: Vec<[f64; 3]>,
}

impl Tridiagonal {
    /// Makes the first and the last row say what the first and the last unknown are.
    pub(crate) fn fix_ends<const N: usize>(
        &mut self,
        right: &mut [SVector<f64, N>],
        start: SVector<f64, N>,
        end: SVector<f64, N>,
    ) {
        let last = self.rows.len() - 1;
        (self.rows[0], self.rows[last]) = ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]);
        (right[0], right[last]) = (start, end);
    }

    /// Elimination without pivoting: stable, for the rows are diagonally dominant but for those of not-a-knot ends, whose
    /// pivots stay positive too.
    pub(crate) fn solve<const N: usize>(&self, x: &mut [SVector<f64, N>], closed: bool) {
        if !closed {
            return self.eliminate(x, &mut []);
        }
        // With the last unknown z held back the rest is a chain, x = y − z·r; the last row then gives z.
        let last = x.len() - 1;
        let mut response = vec![0.0; last];
        response[0] += self.rows[0][0];
        response[last - 1] += self.rows[last - 1][2];
        let (chain, rest) = x.split_at_mut(last);
        self.eliminate(chain, &mut response);
        let [lower, diagonal, corner] = self.rows[last];
        let pivot = diagonal - corner * response[0] - lower * response[last - 1];
        let z = (rest[0] - chain[0] * corner - chain[last - 1] * lower) / pivot;
        for (x, r) in chain.iter_mut().zip(&response) {
            *x -= z * *r;
        }
        rest[0] = z;
    }

    fn eliminate<const N: usize>(&self, x: &mut [SVector<f64, N>], response: &mut [f64]) {
        let rows = x.len();
        let mut ratios = vec![0.0; rows];
        for i in 0..rows {
            let [lower, diagonal, upper] = self.rows[i];
            let (lower, before) = if i > 0 { (lower, i - 1) } else { (0.0, 0) };
            let pivot = diagonal - lower * ratios[before];
            x[i] = (x[i] - x[before] * lower) / pivot;
            if !response.is_empty() {
                response[i] = (response[i] - lower * response[before]) / pivot;
            }
            ratios[i] = upper / pivot;
        }
        for i in (0..rows.saturating_sub(1)).rev() {
            let next = x[i + 1];
            x[i] -= next * ratios[i];
            if !response.is_empty() {
                response[i] -= ratios[i] * response[i + 1];
            }
        }
    }
}
