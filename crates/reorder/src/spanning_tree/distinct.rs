//! Points that differ, found by hashing.

/// Distinct points in the order of their first rows.
pub(super) struct Distinct<'a> {
    /// Each with its first row.
    pub(super) points: Vec<(&'a [f64], u32)>,
    /// [first row, row] of every other occurrence.
    pub(super) repeats: Vec<[u32; 2]>,
}

impl<'a> Distinct<'a> {
    pub(super) fn of(points: impl Iterator<Item = (&'a [f64], u32)>, count: usize) -> Self {
        let mut distinct = Self { points: Vec::new(), repeats: Vec::new() };
        // Open addressing: 1 + index of a distinct point, or 0.
        let mut table = vec![0_u32; (2 * count).next_power_of_two()];
        let last = table.len() - 1;
        for (point, row) in points {
            let mut place = hash(point) as usize & last;
            while let Some(index) = table[place].checked_sub(1) {
                let (known, first_row) = distinct.points[index as usize];
                if known == point {
                    distinct.repeats.push([first_row, row]);
                    break;
                }
                place = (place + 1) & last;
            }
            if table[place] == 0 {
                distinct.points.push((point, row));
                table[place] = distinct.points.len() as u32;
            }
        }
        distinct
    }
}

/// Multiplies and rotates, word after word: the high bits of a product depend on all bits below.
fn hash(point: &[f64]) -> u64 {
    point.iter().fold(0, |state: u64, x| (state ^ x.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29))
}
