//! Where an order begins.

use se3_geom::Manifold;

use crate::ordering::{Ordering, Topology};

impl Ordering {
    /// The same order from where it comes nearest to `from`: from the nearer end of an open curve, or from the nearest point of a
    /// closed one, toward the neighbour with the smaller row. Of several curves that were ordered apart, the one that
    /// can start nearest comes first. Equal points stand together, by row, as before.
    ///
    /// ```
    /// use reorder::{Options, order};
    /// use se3_geom::{R2, nalgebra::Vector2};
    /// # fn main() -> Result<(), reorder::OrderError> {
    /// let points = [0.0, 2.0, 1.0, 3.0].map(|x| Vector2::new(x, 0.0));
    /// let found = order(&R2::default(), &points, &Options::default())?;
    /// assert_eq!(found.order, [0, 2, 1, 3]);
    /// assert_eq!(found.starting_near(&R2::default(), &points, &Vector2::new(2.5, 9.0)).order, [3, 1, 2, 0]);
    /// # Ok(()) }
    /// ```
    #[must_use]
    pub fn starting_near<M: Manifold>(mut self, manifold: &M, points: &[M::Point], from: &M::Point) -> Self {
        let name = self.names();
        let away = |row: usize| manifold.distance(from, &points[row]);
        if self.parts.is_empty() {
            self.order = turned(&self.order, self.topology, &name, away);
            self.sort_components();
            return self;
        }
        for (rows, part) in self.components.iter_mut().zip(&self.parts) {
            *rows = turned(rows, part.topology, &name, away);
        }
        let starts = self.components.iter().map(|rows| away(rows[0])).enumerate();
        if let Some((first, _)) = starts.min_by(|a, b| a.1.total_cmp(&b.1)) {
            self.components[..=first].rotate_right(1);
            self.parts[..=first].rotate_right(1);
        }
        self.order = self.components.iter().flatten().chain(&self.outliers).copied().collect();
        self
    }
}

fn turned(rows: &[usize], topology: Topology, name: &[usize], away: impl Fn(usize) -> f64) -> Vec<usize> {
    let mut groups: Vec<&[usize]> = rows.chunk_by(|&a, &b| name[a] == name[b]).collect();
    let last = groups.len() - 1;
    match topology {
        Topology::Open if away(groups[last][0]) < away(groups[0][0]) => groups.reverse(),
        Topology::Open => {}
        Topology::Closed => {
            let distances: Vec<f64> = groups.iter().map(|group| away(group[0])).collect();
            let nearest = (0..=last).min_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap_or(0);
            groups.rotate_left(nearest);
            if last > 0 && groups[1][0] > groups[last][0] {
                groups[1..].reverse();
            }
        }
    }
    groups.concat()
}
