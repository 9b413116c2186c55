//! Where one more point would answer a doubt.

use se3_geom::Manifold;

use crate::ordering::{Ordering, Topology};

/// A gap so many times longer than the one beside it is the one to look into.
const FAR_LONGER: f64 = 3.0;

/// Adds to every doubt between which two neighbours of the order one more point of the curve would settle it: the two that the doubt
/// is about, unless a gap beside them is far longer, or else the longer gap at the point between them, or the longest next to either.
pub(crate) fn say_what_would_settle<M: Manifold>(manifold: &M, points: &[M::Point], found: &mut Ordering) {
    if found.doubts.is_empty() {
        return;
    }
    let name = found.names();
    let mut neighbours = vec![Vec::new(); found.n];
    let closed = |k: usize| found.parts.get(k).map_or(found.topology, |part| part.topology) == Topology::Closed;
    let whole = [&found.order];
    let runs = if found.parts.is_empty() { &whole[..] } else { &[] };
    for (k, rows) in runs.iter().copied().chain(found.components.iter().filter(|_| runs.is_empty())).enumerate() {
        let closing = closed(k).then(|| (rows[rows.len() - 1], rows[0]));
        for (a, b) in rows.windows(2).map(|w| (w[0], w[1])).chain(closing).map(|(a, b)| (name[a], name[b])) {
            if a != b {
                neighbours[a].push(b);
                neighbours[b].push(a);
            }
        }
    }
    let length = |&[a, b]: &[usize; 2]| manifold.distance(&points[a], &points[b]);
    for doubt in found.doubts.iter_mut().filter(|doubt| !doubt.why.ends_with("would settle it")) {
        let [i, j] = doubt.at.map(|row| name[row]);
        let gaps_at = |row: usize| neighbours[row].iter().map(move |&other| [row, other]);
        let common = gaps_at(i).filter(|[_, k]| neighbours[j].contains(k)).flat_map(|[_, k]| [[i, k], [k, j]]);
        let longest = || gaps_at(i).chain(gaps_at(j)).max_by(|a, b| length(a).total_cmp(&length(b)));
        let between = if neighbours[i].contains(&j) {
            longest().map(|beside| if length(&beside) > FAR_LONGER * length(&[i, j]) { beside } else { [i, j] })
        } else {
            common.max_by(|a, b| length(a).total_cmp(&length(b))).or_else(longest)
        };
        if let Some([a, b]) = between {
            doubt.why += &format!("; a point of the curve between points {a} and {b} would settle it");
        }
    }
}
