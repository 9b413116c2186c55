//! Open or closed, and where to start.

use se3_geom::Manifold;

use crate::curve::Curve;
use crate::independence::look_independent;

/// How many gaps next to an end say what is usual there.
const LOCAL_GAPS: usize = 5;
/// The closing gap may be as many times the longest gap as the gaps next to the ends differ among themselves, but no less and no
/// more than this: a minimum spanning tree leaves out the longest edge of a loop, which on an even sample is hardly longer than
/// the next. An even arc whose ends are one and a half gaps apart is an open arc.
const CLOSING_TO_LONGEST: [f64; 2] = [1.1, 1.5];
/// Where the gaps look like those of independent points, the closing gap may exceed the longest other by this many mean gaps: the
/// greatest of exponential gaps does so once in e² = 7.4 times.
const EXCEEDING: f64 = 2.0;
/// Elsewhere it is at most this many times the longest of the gaps next to both ends.
const CLOSING_TO_LOCAL: f64 = 2.0;

/// A loop whose longest gap exceeds the next by more than this is doubted: in mean gaps where they look like those of independent points,
/// which exceed so once in e^3.5 = 33 loops.
const DOUBTFUL_EXCESS: f64 = 3.5;
/// And as a multiple of the next elsewhere.
const DOUBTFUL_RATIO: f64 = 1.5;

/// What the distance between both ends of a path says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Closing {
    /// The ends meet: the closing gap is like the gaps around it, and the curve goes straight on across it.
    Meets,
    /// The ends come so near that a loop with one long gap or one sharp corner would look the same.
    Near,
    /// The ends are apart.
    Apart,
}

/// The ends of independent points meet where the closing gap exceeds the longest gap by no more than two mean gaps. Those of other points
/// meet where the closing gap is ≤ 1.1 to 1.5 × the longest gap (the more, the less even the ten gaps next to the ends
/// are) and ≤ 2 × the longest of the five gaps next to either end. Either way the curve turns by less than 90° (by log) at both ends.
/// They are near if only the gap is short enough, or if the gap is up to twice 1.5 times those bounds and the curve goes on so.
pub(crate) fn closing<M: Manifold>(path: &Curve<M>) -> Closing {
    let last = path.len() - 1;
    if last < 2 {
        return Closing::Apart;
    }
    let gaps = path.gaps();
    let [local_first, local_last] = beyond_ends(&gaps);
    let [even, uneven] = CLOSING_TO_LONGEST;
    let within = |factor: f64| (factor * longest(&gaps)).min(local_first.max(local_last));
    let (mut allowed, suspicious) = (within(spread_at_ends(&gaps).clamp(even, uneven)), 2.0 * within(uneven));
    if look_independent(&gaps, false) {
        allowed = allowed.max(longest(&gaps) + EXCEEDING * gaps.iter().sum::<f64>() / gaps.len() as f64);
    }
    let closing_gap = path.distance(0, last);
    let goes_on = |at, before, after| path.cosine(at, before, after).is_some_and(|c| c < 0.0);
    let goes_on = goes_on(0, last, 1) && goes_on(last, last - 1, 0);
    match (closing_gap <= allowed, goes_on) {
        (true, true) => Closing::Meets,
        (true, false) => Closing::Near,
        (false, true) if closing_gap <= suspicious => Closing::Near,
        (false, _) => Closing::Apart,
    }
}

/// How many times the longest gap of a loop is longer than the next: it is where the loop may have been closed by mistake.
pub(crate) fn longest_to_next(gaps: &[f64]) -> f64 {
    let [longest, next] = two_longest(gaps);
    longest / next
}

/// Whether a loop with these gaps, the closing one included, may as well be an arc. The gaps between independent points of a loop are
/// uniform on a simplex, and by P. V. Sukhatme (1937) the longest exceeds the next by an exponential variable of one mean gap.
pub(crate) fn may_be_open(gaps: &[f64]) -> bool {
    let [longest, next] = two_longest(gaps);
    if look_independent(gaps, true) {
        longest - next > DOUBTFUL_EXCESS * gaps.iter().sum::<f64>() / gaps.len() as f64
    } else {
        longest > DOUBTFUL_RATIO * next
    }
}

/// How many times the next gap the longest gap of a loop may be, to be what such gaps are: even ones hardly differ, independent ones do.
pub(crate) fn closing_bound(gaps: &[f64]) -> f64 {
    let [even, _] = CLOSING_TO_LONGEST;
    if look_independent(gaps, true) {
        let [_, next] = two_longest(gaps);
        even.max(1.0 + DOUBTFUL_EXCESS * gaps.iter().sum::<f64>() / (gaps.len() as f64 * next))
    } else {
        even
    }
}

fn two_longest(gaps: &[f64]) -> [f64; 2] {
    gaps.iter().fold([0.0; 2], |[longest, next], &gap| [longest.max(gap), next.max(gap.min(longest))])
}

/// Turns a closed sequence so that it starts with `first` and goes toward the neighbour with the smaller row.
pub(crate) fn rotate_to(rows: &mut [usize], first: usize) {
    if let Some(k) = rows.iter().position(|&row| row == first) {
        rows.rotate_left(k);
        if rows[1] > rows[rows.len() - 1] {
            rows[1..].reverse();
        }
    }
}

/// How far from each end the curve would show again if it went on there: twice the longest of the gaps next to that end.
pub(crate) fn beyond_ends(gaps: &[f64]) -> [f64; 2] {
    let k = LOCAL_GAPS.min(gaps.len());
    [&gaps[..k], &gaps[gaps.len() - k..]].map(|some| CLOSING_TO_LOCAL * longest(some))
}

/// Ratio of the longest to the shortest of the gaps next to the ends.
fn spread_at_ends(gaps: &[f64]) -> f64 {
    let k = LOCAL_GAPS.min(gaps.len());
    let near = || gaps[..k].iter().chain(&gaps[gaps.len() - k..]).copied();
    near().fold(0.0, f64::max) / near().fold(f64::INFINITY, f64::min)
}

fn longest(gaps: &[f64]) -> f64 {
    gaps.iter().copied().fold(0.0, f64::max)
}
