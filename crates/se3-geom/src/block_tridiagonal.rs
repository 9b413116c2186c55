//! Linear solver for chains of 3-vectors.

use nalgebra::{Matrix3, Vector3};

/// A block-tridiagonal system, cyclic or not, whose couplings are mirror images: row i holds Bᵢ₋₁ᵀ, Dᵢ, Bᵢ.
///
/// Keeps its scratch space, so that solving again costs no allocation.
#[derive(Debug, Clone)]
pub(crate) struct BlockTridiagonal {
    /// Bᵢ: row i, column i+1. As many as rows where the last row couples back to the first; one fewer in an open chain.
    pub(crate) couplings: Vec<Matrix3<f64>>,
    /// Dᵢ.
    pub(crate) diagonal: Vec<Matrix3<f64>>,
    ratios: Vec<Matrix3<f64>>,
    responses: Vec<Matrix3<f64>>,
}

impl BlockTridiagonal {
    /// A system with these couplings and a zero diagonal; cyclic where there is a coupling for every row (three at least).
    pub(crate) fn new(rows: usize, couplings: Vec<Matrix3<f64>>) -> Self {
        let zero = vec![Matrix3::zeros(); rows];
        let responses = if couplings.len() == rows { zero.clone() } else { Vec::new() };
        Self { couplings, diagonal: zero.clone(), ratios: zero, responses }
    }

    /// Replaces the right-hand side by the solution, by block elimination without pivoting between blocks, which is stable for
    /// the diagonally dominant systems of splines. `None` where a pivot block is singular.
    pub(crate) fn solve(&mut self, x: &mut [Vector3<f64>]) -> Option<()> {
        let rows = x.len();
        if self.responses.is_empty() {
            return self.eliminate(x);
        }
        // Cyclic: with the last unknown z held back the rest is a chain, x = y − Y·z; the last row then gives z.
        let last = rows - 1;
        self.responses.fill(Matrix3::zeros());
        self.responses[0] += self.couplings[last].transpose();
        self.responses[last - 1] += self.couplings[last - 1];
        let (chain, rest) = x.split_at_mut(last);
        self.eliminate(chain)?;
        let (to_first, to_previous) = (self.couplings[last], self.couplings[last - 1].transpose());
        let pivot = self.diagonal[last] - to_first * self.responses[0] - to_previous * self.responses[last - 1];
        let z = pivot.try_inverse()? * (rest[0] - to_first * chain[0] - to_previous * chain[last - 1]);
        for (x, response) in chain.iter_mut().zip(&self.responses) {
            *x -= response * z;
        }
        rest[0] = z;
        Some(())
    }

    /// Solves the chain of the leading unknowns for `x`, and for the columns of the responses where there are any.
    fn eliminate(&mut self, x: &mut [Vector3<f64>]) -> Option<()> {
        let rows = x.len();
        let cyclic = !self.responses.is_empty();
        for i in 0..rows {
            let mut pivot = self.diagonal[i];
            if i > 0 {
                let lower = self.couplings[i - 1].transpose();
                pivot -= lower * self.ratios[i - 1];
                let carried = lower * x[i - 1];
                x[i] -= carried;
                if cyclic {
                    let carried = lower * self.responses[i - 1];
                    self.responses[i] -= carried;
                }
            }
            let inverse = pivot.try_inverse()?;
            x[i] = inverse * x[i];
            if cyclic {
                self.responses[i] = inverse * self.responses[i];
            }
            if i + 1 < rows {
                self.ratios[i] = inverse * self.couplings[i];
            }
        }
        for i in (0..rows.saturating_sub(1)).rev() {
            let carried = self.ratios[i] * x[i + 1];
            x[i] -= carried;
            if cyclic {
                let carried = self.ratios[i] * self.responses[i + 1];
                self.responses[i] -= carried;
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(seed: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|r, c| ((seed * 7 + r * 3 + c * 5) as f64).sin())
    }

    #[test]
    fn solves_open_and_cyclic_chains_again_and_again() {
        for (rows, cyclic) in [(1, false), (2, false), (9, false), (3, true), (9, true)] {
            let couplings: Vec<_> = (0..if cyclic { rows } else { rows - 1 }).map(block).collect();
            let mut system = BlockTridiagonal::new(rows, couplings);
            for round in 0..2 {
                for (i, d) in system.diagonal.iter_mut().enumerate() {
                    *d = Matrix3::identity() * 12.0 + block(i + 50 + round);
                }
                let expected: Vec<Vector3<f64>> = (0..rows).map(|i| block(i + 70).column(0).into_owned()).collect();
                let mut x: Vec<_> = (0..rows).map(|i| system.diagonal[i] * expected[i]).collect();
                for (i, coupling) in system.couplings.iter().enumerate() {
                    let next = (i + 1) % rows;
                    x[i] += coupling * expected[next];
                    x[next] += coupling.transpose() * expected[i];
                }
                system.solve(&mut x).unwrap();
                for (x, y) in x.iter().zip(&expected) {
                    // Diagonal dominance 12 against 6: condition below 3, so a few dozen roundings of O(1).
                    assert!((x - y).norm() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn a_singular_pivot_is_told() {
        let mut system = BlockTridiagonal::new(2, vec![block(1)]);
        assert!(system.solve(&mut [Vector3::x(), Vector3::y()]).is_none());
    }
}
