//! Points that differ, found by hashing.

/// Distinct points in the order of their first rows.
pub(super) struct Distinct {
    dimension: usize,
    values: Vec<f64>,
    /// The first input row of each.
    rows: Vec<u32>,
    /// [first row, row] of every other occurrence.
    pub(super) repeats: Vec<[u32; 2]>,
    seen: u32,
    /// Open addressing: 1 + index of a point, or 0.
    table: Vec<u32>,
}

impl Distinct {
    pub(super) fn with_capacity(dimension: usize, count: usize) -> Self {
        Self {
            dimension,
            values: Vec::with_capacity(dimension * count),
            rows: Vec::with_capacity(count),
            repeats: Vec::new(),
            seen: 0,
            table: vec![0; (2 * count).next_power_of_two()],
        }
    }

    /// The next row. At most as many as the capacity: the table does not grow.
    pub(super) fn push(&mut self, point: &[f64]) {
        let row = self.seen;
        self.seen += 1;
        let last = self.table.len() - 1;
        let mut place = hash(point) as usize & last;
        while let Some(index) = self.table[place].checked_sub(1) {
            if self.point(index as usize) == point {
                self.repeats.push([self.rows[index as usize], row]);
                return;
            }
            place = (place + 1) & last;
        }
        self.table[place] = self.rows.len() as u32 + 1;
        self.rows.push(row);
        self.values.extend(point);
    }

    fn point(&self, index: usize) -> &[f64] {
        &self.values[index * self.dimension..][..self.dimension]
    }

    /// Coordinates and first row of each distinct point.
    pub(super) fn points(&self) -> impl Iterator<Item = (&[f64], u32)> {
        self.values.chunks_exact(self.dimension).zip(self.rows.iter().copied())
    }
}

/// Multiplies and rotates, word after word: the high bits of a product depend on all bits below.
fn hash(point: &[f64]) -> u64 {
    point.iter().fold(0, |state: u64, x| (state ^ x.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29))
}
