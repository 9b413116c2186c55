//! Shuffling the samples of an experiment, and telling whether they came back in order.

use reorder::{Ordering, Topology};

/// The numbers 0 … n − 1 in an order that the seed decides (Fisher–Yates with a splitmix64 generator).
pub(crate) fn shuffle(n: usize, seed: u64) -> Vec<usize> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let mut places: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        places.swap(i, (next() % (i as u64 + 1)) as usize);
    }
    places
}

/// Whether the order visits every place along the curve after one of its neighbours: row r was sampled at `places[r]`.
pub(crate) fn follows(ordering: &Ordering, places: &[usize], closed: bool) -> bool {
    let n = places.len();
    let beside = |pair: &[usize]| {
        let apart = places[pair[0]].abs_diff(places[pair[1]]);
        apart == 1 || (closed && apart == n - 1)
    };
    let topology = if closed { Topology::Closed } else { Topology::Open };
    ordering.topology == topology && ordering.order.windows(2).all(beside)
}
