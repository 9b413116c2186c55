//! Passes of a curve exactly over each other, as nothing but the gaps can show them.
//!
//! The points of all passes are those of one honest curve, and no distance tells which pass a point is of. But a pass spaces its points
//! smoothly, and where two or three are mixed, every second or third point is of one.

use std::f64::consts::PI;

use se3_geom::Manifold;

use crate::curve::Curve;
use crate::ordering::Doubt;

/// How many gaps in a row must alternate between longer and shorter before that is a doubt. A curve that runs back beside itself
/// interleaves two passes, and then they all do; twelve gaps in random order alternate by chance once in ninety times, and then
/// rarely pass the test of evenness too.
const ALTERNATING_GAPS: usize = 12;
/// Mean change from gap to gap, as the logarithm of their ratio, that counts as uneven: a factor of 1.2.
const UNEVEN: f64 = 0.18;
/// By how many times every second point alone must be more evenly spaced than all together. Independent jitter of the points
/// gains a factor of 2 that way, two interleaved passes as much as each of them is even.
const MORE_EVEN: f64 = 4.0;

/// Every second and every third point are looked at alone, over this many gaps.
const STRIDES: [usize; 2] = [2, 3];
const STRIDING_GAPS: usize = 20;
/// Smaller mean changes than this may be the rounding of coordinates.
const LEAST_CHANGE: f64 = 0.05;
const ROUNDED_CHANGE: f64 = 0.005;

/// Gaps on either side of where a second pass may begin or end.
const SIDE: usize = 5;
/// Up to this ratio of the longest to the shortest, the gaps of one pass are even.
const EVEN: f64 = 1.2;
/// By this share the gaps of one pass of two may differ from those of the one before.
const SAME_PACE: f64 = 0.1;

/// A gap much longer or much shorter than both beside it, as the logarithm of the smaller ratio: a factor of 1.57. No smooth motion makes
/// many, which speeds up and slows down.
const JERK: f64 = 0.45;
/// Where most gaps change by less than this, as the logarithm of the ratio, so many jerks in so many gaps are a doubt. None of 566 recordings of
/// pens, cars, arms, boats, flights and storms in the right order has as many; of pens that turned back over their own line some have.
const SMOOTH: f64 = 0.1;
const JERKS: usize = 2;
const JERKING_GAPS: usize = 12;
/// A curve that turns by less than this altogether is a line or an axis, which machines run along to and fro. There so many jerks are a
/// doubt wherever they are.
const STRAIGHT_RAD: f64 = 0.3;
const JERKS_OF_A_LINE: usize = 3;

/// The first of these that is found. `explained` gaps are those of independent points, which no pattern of gaps tells.
pub(crate) fn of_passes<M: Manifold>(curve: &Curve<M>, gaps: &[f64], explained: bool) -> Option<Doubt> {
    let patterns = || {
        of_alternation(curve, gaps)
            .or_else(|| of_strides(curve, gaps))
            .or_else(|| of_pace(curve, gaps, true))
            .or_else(|| of_pace(curve, gaps, false))
    };
    let pattern = if explained { None } else { patterns() };
    pattern.or_else(|| of_jerks(curve, gaps))
}

fn doubt<M: Manifold>(curve: &Curve<M>, k: usize, why: &str) -> Doubt {
    let n = curve.len();
    Doubt { at: curve.rows_at(k % n, (k + 1) % n), why: why.to_owned() }
}

/// How many stretches of `length` gaps there are, none of which needs a point past the end; around a loop a stretch may begin anywhere.
fn stretches<M: Manifold>(curve: &Curve<M>, gaps: &[f64], length: usize) -> usize {
    match gaps.len().checked_sub(length) {
        None => 0,
        Some(_) if curve.closed => curve.len(),
        Some(last) => last + 1,
    }
}

/// Gaps that alternate, while every second point alone is spaced far more evenly.
fn of_alternation<M: Manifold>(curve: &Curve<M>, gaps: &[f64]) -> Option<Doubt> {
    let n = curve.len();
    let looks_interleaved = |first: usize| {
        let gaps: Vec<f64> = (first..first + ALTERNATING_GAPS).map(|k| gaps[k % gaps.len()]).collect();
        let alternates = gaps.windows(3).all(|g| (g[1] > g[0]) == (g[1] > g[2]) && g[1] != g[0]);
        let strides: Vec<f64> =
            (first..first + ALTERNATING_GAPS - 1).map(|k| curve.distance(k % n, (k + 2) % n)).collect();
        let together = mean_change(gaps.iter().zip(&gaps[1..]));
        let apart = mean_change(strides.iter().zip(&strides[2..]));
        alternates && together > UNEVEN && MORE_EVEN * apart < together
    };
    let first = (0..stretches(curve, gaps, ALTERNATING_GAPS)).find(|&first| looks_interleaved(first))?;
    let why = "the gaps alternate here, and every second point alone is spaced far more evenly: the curve may run back beside itself";
    Some(doubt(curve, first + ALTERNATING_GAPS / 2, why))
}

/// Root mean square of the logarithm of the ratios.
fn mean_change<'a>(pairs: impl Iterator<Item = (&'a f64, &'a f64)>) -> f64 {
    let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (a, b)| (sum + (b / a).ln().powi(2), count + 1.0));
    f64::sqrt(sum / count)
}

/// Uneven gaps, while every second or third point alone is spaced so much more evenly as chance makes it once in 200 sets: of n points in
/// even steps that are off by up to 0.4 of a step, independently, by up to 7.3, 8.6 and 10 times at n = 50, 200 and 1000 (400, 400
/// and 100 random sets), which 4 + 2 log₁₀ n describes.
fn of_strides<M: Manifold>(curve: &Curve<M>, gaps: &[f64]) -> Option<Doubt> {
    let n = curve.len();
    let chance = 4.0 + 2.0 * (n as f64).log10();
    let logs: Vec<f64> = gaps.iter().map(|gap| gap.ln()).collect();
    let change = |of: &[f64], k: usize, step: usize| (of[(k + step) % of.len()] - of[k % of.len()]).abs();
    let all: Vec<f64> = (0..logs.len()).map(|k| change(&logs, k, 1)).collect();
    for stride in STRIDES {
        let apart: Vec<f64> = (0..n).map(|k| curve.distance(k, (k + stride) % n).ln()).collect();
        // Of passes at one pace the next point of another one is as far on; of those at several, the next of the same one is.
        for step in [1, stride] {
            let apart: Vec<f64> = (0..n).map(|k| change(&apart, k, step)).collect();
            let mut sums = Sums::default();
            // A change of the last stride ends so many gaps past its beginning.
            for first in 0..stretches(curve, gaps, STRIDING_GAPS + stride + step) {
                let [together, apart] = sums.over(first, [&all, &apart]);
                if together > LEAST_CHANGE && together > chance * (apart + ROUNDED_CHANGE) {
                    let which = if stride == 2 { "second" } else { "third" };
                    let why = format!(
                        "every {which} point alone is spaced {:.0} times more evenly here than all together: the curve may run over itself",
                        together / (apart + ROUNDED_CHANGE)
                    );
                    return Some(doubt(curve, first + STRIDING_GAPS / 2, &why));
                }
            }
        }
    }
    None
}

/// Means over a window that moves on by one.
#[derive(Default)]
struct Sums([f64; 2]);

impl Sums {
    fn over(&mut self, first: usize, of: [&Vec<f64>; 2]) -> [f64; 2] {
        let at = |of: &Vec<f64>, k: usize| of[k % of.len()];
        for (sum, of) in self.0.iter_mut().zip(of) {
            // Anew now and then: differences of sums pile up rounding.
            if first.is_multiple_of(STRIDING_GAPS) {
                *sum = (first..first + STRIDING_GAPS).map(|k| at(of, k)).sum();
            } else {
                *sum += at(of, first + STRIDING_GAPS - 1) - at(of, first - 1);
            }
        }
        self.0.map(|sum| sum / STRIDING_GAPS as f64)
    }
}

/// Even gaps, and next to them others that are as long two by two: where a second pass begins, its points fall between those of the first.
fn of_pace<M: Manifold>(curve: &Curve<M>, gaps: &[f64], forward: bool) -> Option<Doubt> {
    let n = curve.len();
    let at = |first: usize, k: usize| if forward { first + k } else { first + 2 * SIDE - k };
    let begins = |first: usize| {
        let even: [f64; SIDE] = std::array::from_fn(|k| gaps[at(first, k) % gaps.len()]);
        let (least, most) = even.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &g| (a.min(g), b.max(g)));
        if most > EVEN * least {
            return false;
        }
        let pace = even.iter().sum::<f64>() / SIDE as f64;
        (SIDE..2 * SIDE).all(|k| {
            let [here, next] = [k, k + 1].map(|k| at(first, k));
            let from = here.min(next);
            let both = curve.distance(from % n, (from + 2) % n);
            gaps[here % gaps.len()] < (1.0 - SAME_PACE) * pace && (both / pace - 1.0).abs() < SAME_PACE
        })
    };
    let first = (0..stretches(curve, gaps, 2 * SIDE + 1)).find(|&first| begins(first))?;
    let why = "from here on the gaps are as long two by two as each is before: a second pass of the curve may begin or end here";
    Some(doubt(curve, at(first, SIDE), why))
}

/// Gaps that jump between long and short where the others change smoothly, or along a line, whose bends show nothing.
fn of_jerks<M: Manifold>(curve: &Curve<M>, gaps: &[f64]) -> Option<Doubt> {
    let changes: Vec<f64> = gaps.windows(2).map(|w| (w[1] / w[0]).ln()).collect();
    let jerk = |w: &[f64]| if w[0] * w[1] < 0.0 { w[0].abs().min(w[1].abs()) } else { 0.0 };
    let jerks: Vec<usize> = (0..).zip(changes.windows(2)).filter(|(_, w)| jerk(w) > JERK).map(|(k, _)| k).collect();
    let mut sizes: Vec<f64> = changes.iter().map(|change| change.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    // Gap k + 1 is the one that jumps.
    if sizes.get(sizes.len() / 2).is_some_and(|&usual| usual < SMOOTH)
        && let Some(w) = jerks.windows(JERKS).find(|w| w[JERKS - 1] - w[0] < JERKING_GAPS)
    {
        let why = "the gaps jump between long and short here, and change smoothly elsewhere: the curve may run back over itself";
        return Some(doubt(curve, w[0] + 1, why));
    }
    let why = "the points lie on a straight line (a geodesic) in uneven steps: the curve may run to and fro along it";
    (jerks.len() >= JERKS_OF_A_LINE && is_straight(curve)).then(|| doubt(curve, jerks[0] + 1, why))
}

fn is_straight<M: Manifold>(curve: &Curve<M>) -> bool {
    let turn = |k: usize| Some(PI - curve.cosine(k, curve.previous(k)?, curve.next(k)?)?.clamp(-1.0, 1.0).acos());
    let mut turned = 0.0;
    (0..curve.len()).all(|k| {
        turned += turn(k).unwrap_or(0.0);
        turned < STRAIGHT_RAD
    })
}
