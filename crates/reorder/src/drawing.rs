//! Edges that a method draws, and the curve they make up, if they do.

/// Edges between input rows, each as (smaller row, greater row), ascending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    count: usize,
    edges: Vec<[usize; 2]>,
}

/// A connected piece of a drawing that is a path or a loop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Strand {
    /// Input rows in order: from the end with the smaller row, or from the smallest row toward its smaller neighbour.
    pub rows: Vec<usize>,
    /// Whether the last row is followed by the first.
    pub closed: bool,
}

/// Why a drawing is no single curve.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoCurve {
    /// A point with more than two edges.
    #[error("{edges} edges meet at point {at}, where a curve has two")]
    Branch {
        /// Input row of the first such point.
        at: usize,
        /// How many edges meet there.
        edges: usize,
    },
    /// Several pieces.
    #[error("the edges make up {} separate curves or points", strands.len())]
    Pieces {
        /// The pieces, by their smallest row; a point without edges is a strand of one row.
        strands: Vec<Strand>,
    },
}

impl Drawing {
    /// Edges among `count` points; repeated ones and those from a point to itself are dropped.
    pub(crate) fn new(count: usize, edges: impl IntoIterator<Item = [usize; 2]>) -> Self {
        let mut edges: Vec<_> = edges.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).filter(|[a, b]| a != b).collect();
        edges.sort_unstable();
        edges.dedup();
        Self { count, edges }
    }

    /// How many points there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The edges as (smaller row, greater row), ascending.
    pub fn edges(&self) -> &[[usize; 2]] {
        &self.edges
    }

    /// The pieces, if no point has more than two edges.
    ///
    /// # Errors
    /// [`NoCurve::Branch`].
    pub fn strands(&self) -> Result<Vec<Strand>, NoCurve> {
        let mut neighbours = vec![Vec::new(); self.count];
        for &[a, b] in &self.edges {
            neighbours[a].push(b);
            neighbours[b].push(a);
        }
        if let Some(at) = neighbours.iter().position(|some| some.len() > 2) {
            return Err(NoCurve::Branch { at, edges: neighbours[at].len() });
        }
        let mut seen = vec![false; self.count];
        let mut strands = Vec::new();
        // Ends first, so that what is left are loops.
        let ends = (0..self.count).filter(|&row| neighbours[row].len() < 2);
        for first in ends.chain(0..self.count) {
            if seen[first] {
                continue;
            }
            let mut rows = Vec::new();
            let mut next = Some(first);
            while let Some(row) = next {
                seen[row] = true;
                rows.push(row);
                // Edges ascend, and so do the neighbours of a row: a loop sets out toward the smaller one.
                next = neighbours[row].iter().copied().filter(|&other| !seen[other]).min();
            }
            strands.push(Strand { rows, closed: neighbours[first].len() == 2 });
        }
        strands.sort_by_key(|strand| strand.rows.iter().copied().min());
        Ok(strands)
    }

    /// The one curve through all points.
    ///
    /// # Errors
    /// [`NoCurve`].
    pub fn curve(&self) -> Result<Strand, NoCurve> {
        let mut strands = self.strands()?;
        match (strands.pop(), strands.is_empty()) {
            (Some(only), true) => Ok(only),
            (last, _) => Err(NoCurve::Pieces { strands: strands.into_iter().chain(last).collect() }),
        }
    }
}
