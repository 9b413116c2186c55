//! Linear solver for chains of 3-vectors.

use nalgebra::{Matrix3, Vector3};

/// A block-tridiagonal system, cyclic where `corners` is given: row i couples the unknowns i−1, i, i+1.
#[derive(Debug, Clone)]
pub(crate) struct BlockTridiagonal {
    /// Row i, column i−1; the first entry is unused.
    pub(crate) lower: Vec<Matrix3<f64>>,
    /// Row i, column i.
    pub(crate) diagonal: Vec<Matrix3<f64>>,
    /// Row i, column i+1; the last entry is unused.
    pub(crate) upper: Vec<Matrix3<f64>>,
    /// Row 0, column n−1 and row n−1, column 0. Needs n ≥ 3, as closed curves have.
    pub(crate) corners: Option<(Matrix3<f64>, Matrix3<f64>)>,
}

impl BlockTridiagonal {
    /// The solution by block elimination without pivoting between blocks, which is stable for the diagonally dominant
    /// systems of splines; `None` where a pivot block is singular.
    pub(crate) fn solve(&self, right: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let Some((top_right, bottom_left)) = self.corners else {
            return self.eliminate(right.len(), &[right.to_vec()]).map(|mut columns| columns.swap_remove(0));
        };
        // Cyclic: with the last unknown z held back the rest is a chain, x = y − Y·z; the last row then gives z.
        let m = right.len() - 1;
        let mut columns = vec![right[..m].to_vec()];
        for k in 0..3 {
            let mut column = vec![Vector3::zeros(); m];
            column[0] += top_right.column(k);
            column[m - 1] += self.upper[m - 1].column(k);
            columns.push(column);
        }
        let solved = self.eliminate(m, &columns)?;
        let response = |i: usize| Matrix3::from_columns(&[solved[1][i], solved[2][i], solved[3][i]]);
        let pivot = self.diagonal[m] - bottom_left * response(0) - self.lower[m] * response(m - 1);
        let residual = right[m] - bottom_left * solved[0][0] - self.lower[m] * solved[0][m - 1];
        let last = pivot.lu().solve(&residual)?;
        let mut solution: Vec<_> = (0..m).map(|i| solved[0][i] - response(i) * last).collect();
        solution.push(last);
        Some(solution)
    }

    /// Solves the leading chain of `n` unknowns for several right-hand sides.
    fn eliminate(&self, n: usize, rights: &[Vec<Vector3<f64>>]) -> Option<Vec<Vec<Vector3<f64>>>> {
        let mut solutions = rights.to_vec();
        let mut ratios = Vec::with_capacity(n);
        for i in 0..n {
            let mut pivot = self.diagonal[i];
            if i > 0 {
                pivot -= self.lower[i] * ratios[i - 1];
            }
            let pivot = pivot.lu();
            for x in &mut solutions {
                let carried = if i > 0 { self.lower[i] * x[i - 1] } else { Vector3::zeros() };
                x[i] = pivot.solve(&(x[i] - carried))?;
            }
            ratios.push(if i + 1 < n { pivot.solve(&self.upper[i])? } else { Matrix3::zeros() });
        }
        for x in &mut solutions {
            for i in (0..n.saturating_sub(1)).rev() {
                let next = x[i + 1];
                x[i] -= ratios[i] * next;
            }
        }
        Some(solutions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(seed: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|r, c| ((seed * 7 + r * 3 + c * 5) as f64).sin())
    }

    #[test]
    fn solves_open_and_cyclic_chains() {
        for corners in [None, Some((block(101), block(102)))] {
            let n = 9;
            let system = BlockTridiagonal {
                lower: (0..n).map(block).collect(),
                diagonal: (0..n).map(|i| Matrix3::identity() * 12.0 + block(i + 50)).collect(),
                upper: (0..n).map(|i| block(i + 20)).collect(),
                corners,
            };
            let expected: Vec<_> = (0..n).map(|i| block(i + 70).column(0).into_owned()).collect();
            let right: Vec<Vector3<f64>> = (0..n)
                .map(|i| {
                    let mut row = system.diagonal[i] * expected[i];
                    if i > 0 {
                        row += system.lower[i] * expected[i - 1];
                    }
                    if i + 1 < n {
                        row += system.upper[i] * expected[i + 1];
                    }
                    if let Some((top_right, bottom_left)) = corners {
                        if i == 0 {
                            row += top_right * expected[n - 1];
                        }
                        if i == n - 1 {
                            row += bottom_left * expected[0];
                        }
                    }
                    row
                })
                .collect();
            for (x, y) in system.solve(&right).unwrap().iter().zip(&expected) {
                // Diagonal dominance 12 against 6: condition below 3, so a few dozen roundings of O(1).
                assert!((x - y).norm() < 1e-14);
            }
        }
    }
}
