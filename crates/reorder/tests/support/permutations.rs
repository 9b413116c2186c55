//! Every order of a few things.

/// All n! orders of 0..n.
pub(crate) fn permutations(n: usize) -> Vec<Vec<usize>> {
    if n == 0 {
        return vec![Vec::new()];
    }
    let shorter = permutations(n - 1);
    let insert = |rows: &Vec<usize>, at: usize| [&rows[..at], &[n - 1], &rows[at..]].concat();
    shorter.iter().flat_map(|rows| (0..n).map(move |at| insert(rows, at))).collect()
}
