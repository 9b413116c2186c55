//! How a recovered order compares with the recorded one.

use std::collections::{HashMap, HashSet};

use planner::reorder::{Ordering, Topology};
use planner::se3_geom::{Pose, xyzw_from_rotation};
use serde::{Deserialize, Serialize};

/// How near a recovered order comes to the recorded one. Equal poses count as one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Share of the recorded consecutive pairs that are neighbours in the recovered order.
    pub adjacency: f64,
    /// Whether all of them are.
    pub exact: bool,
    /// Kendall's τ of the two orders, the recovered one turned round, and a closed one begun, so that it is greatest.
    pub kendall_tau: f64,
    /// The first recorded pair that the recovered order does not follow, as rows of the set.
    pub first_difference: Option<[usize; 2]>,
}

impl Score {
    /// Recorded is the order of the stamps, and of the rows where there are none.
    pub fn of(poses: &[Pose], stamps_ns: Option<&[i64]>, ordering: &Ordering) -> Self {
        let mut recorded: Vec<usize> = (0..poses.len()).collect();
        if let Some(stamps_ns) = stamps_ns {
            recorded.sort_by_key(|&row| stamps_ns[row]);
        }
        Self::compare(&names(poses), &recorded, &ordering.order, ordering.topology == Topology::Closed)
    }

    fn compare(names: &[usize], recorded: &[usize], found: &[usize], closed: bool) -> Self {
        let collapsed = |rows: &[usize]| {
            let mut rows = rows.to_vec();
            rows.dedup_by_key(|row| names[*row]);
            rows
        };
        let (recorded, found) = (collapsed(recorded), collapsed(found));
        let pair = |a: usize, b: usize| [names[a].min(names[b]), names[a].max(names[b])];
        let mut neighbours: HashSet<_> = found.windows(2).map(|w| pair(w[0], w[1])).collect();
        if let Some((&first, &last)) = found.first().zip(found.last()).filter(|_| closed && found.len() > 2) {
            neighbours.insert(pair(first, last));
        }
        let follows = |w: &&[usize]| neighbours.contains(&pair(w[0], w[1]));
        let kept = recorded.windows(2).filter(follows).count();
        let pairs = recorded.len().saturating_sub(1);
        Self {
            adjacency: if pairs == 0 { 0.0 } else { kept as f64 / pairs as f64 },
            exact: kept == pairs && pairs > 0,
            kendall_tau: kendall_tau(names, &recorded, &found, closed),
            first_difference: recorded.windows(2).find(|w| !follows(w)).map(|w| [w[0], w[1]]),
        }
    }
}

/// The same number for equal poses.
fn names(poses: &[Pose]) -> Vec<usize> {
    let mut known = HashMap::new();
    let name = |pose: &Pose| {
        let t = pose.translation;
        let [x, y, z, w] = xyzw_from_rotation(&pose.rotation);
        let next = known.len();
        *known.entry([t.x, t.y, t.z, x, y, z, w].map(f64::to_bits)).or_insert(next)
    };
    poses.iter().map(name).collect()
}

/// |1 − 4 inversions / (n (n − 1))|, each point where it first comes; of a closed order the greatest over all its beginnings.
fn kendall_tau(names: &[usize], recorded: &[usize], found: &[usize], closed: bool) -> f64 {
    let mut rank = HashMap::new();
    for &row in recorded {
        let next = rank.len();
        rank.entry(names[row]).or_insert(next);
    }
    let mut seen = HashSet::new();
    let firsts = found.iter().map(|&row| names[row]).filter(|&name| seen.insert(name));
    let ranks: Vec<usize> = firsts.filter_map(|name| rank.get(&name).copied()).collect();
    let n = ranks.len() as f64;
    if ranks.len() < 2 {
        return 1.0;
    }
    let mut inversions = inversions(&mut ranks.clone()) as f64;
    let tau = |inversions: f64| (1.0 - 4.0 * inversions / (n * (n - 1.0))).abs();
    let mut greatest = tau(inversions);
    if closed {
        for &first in &ranks {
            // Moved from the front to the back, it inverts the others the other way round.
            inversions += n - 1.0 - 2.0 * first as f64;
            greatest = greatest.max(tau(inversions));
        }
    }
    greatest
}

/// Pairs that stand the wrong way round, counted while they are merged into order.
fn inversions(ranks: &mut [usize]) -> u64 {
    if ranks.len() < 2 {
        return 0;
    }
    let (left, right) = ranks.split_at_mut(ranks.len() / 2);
    let mut count = inversions(left) + inversions(right);
    let (mut a, mut b, mut merged) = (0, 0, Vec::with_capacity(left.len() + right.len()));
    while let (Some(&low), Some(&high)) = (left.get(a), right.get(b)) {
        if low <= high {
            merged.push(low);
            a += 1;
        } else {
            merged.push(high);
            b += 1;
            count += (left.len() - a) as u64;
        }
    }
    merged.extend_from_slice(&left[a..]);
    merged.extend_from_slice(&right[b..]);
    ranks.copy_from_slice(&merged);
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(names: &[usize], found: &[usize], closed: bool) -> Score {
        let recorded: Vec<usize> = (0..names.len()).collect();
        Score::compare(names, &recorded, found, closed)
    }

    #[test]
    fn turned_round_and_begun_elsewhere_it_is_the_same() {
        let names = [0, 1, 2, 3, 4, 5];
        for (found, closed) in [([5, 4, 3, 2, 1, 0], false), ([2, 3, 4, 5, 0, 1], true), ([2, 1, 0, 5, 4, 3], true)] {
            let score = score(&names, &found, closed);
            assert_eq!(score, Score { adjacency: 1.0, exact: true, kendall_tau: 1.0, first_difference: None });
        }
        let opened = score(&names, &[2, 3, 4, 5, 0, 1], false);
        // The pair 1, 2 is parted, and each of 0, 1 stands behind each of 2 to 5.
        assert_eq!((opened.adjacency, opened.first_difference), (0.8, Some([1, 2])));
        assert_eq!(opened.kendall_tau, (1.0_f64 - 4.0 * 8.0 / 30.0).abs());
    }

    #[test]
    fn equal_poses_are_one() {
        // Rows 1 and 2 are equal, and 4 comes back to 0.
        let score = score(&[0, 1, 1, 2, 0], &[0, 4, 2, 1, 3], false);
        // Recorded are the pairs 0-1, 1-2, 2-0; found are 0-1, 1-2.
        assert_eq!((score.adjacency, score.first_difference, score.kendall_tau), (2.0 / 3.0, Some([3, 4]), 1.0));
    }

    #[test]
    fn tau_counts_every_pair() {
        let found = [3, 0, 4, 1, 2];
        let by_hand = (0..5).flat_map(|j| (0..j).map(move |i| (i, j))).filter(|&(i, j)| found[i] > found[j]).count();
        assert_eq!(score(&[0, 1, 2, 3, 4], &found, false).kendall_tau, (1.0 - 4.0 * by_hand as f64 / 20.0).abs());
        // Closed, every rotation is tried: here against each of them, counted pair by pair.
        let rotated = |k: usize| -> Vec<usize> { (0..5).map(|i| found[(i + k) % 5]).collect() };
        let best = (0..5).map(|k| score(&[0, 1, 2, 3, 4], &rotated(k), false).kendall_tau).fold(0.0, f64::max);
        assert_eq!(score(&[0, 1, 2, 3, 4], &found, true).kendall_tau, best);
    }
}
