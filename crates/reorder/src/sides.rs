//! Two passes of a curve beside each other, taken for one that steps from side to side.

use se3_geom::Manifold;

use crate::curve::Curve;
use crate::ordering::Doubt;

/// Points in a row that must step from side to side: of noisy points, three in four do so at each, ten in a row seldom.
const STEPS: usize = 10;
/// By how much every second point alone must be smoother than all. Noise is as rough either way, and what is smooth is eight times
/// rougher at twice the step.
const SMOOTHER: f64 = 4.0;

/// A doubt at the middle of the first stretch whose third differences change sign at every point, while every second point alone is
/// smooth: the way out of a curve and the way back beside it, whose points fall between each other. The curve's own bend
/// does not hide this, as it hides turns back and forth.
pub(crate) fn of_sides<M: Manifold>(curve: &Curve<M>) -> Option<Doubt> {
    let n = curve.len();
    let steps: Vec<bool> = (0..n).map(|k| steps_across(curve, k).unwrap_or(false)).collect();
    let last = n.checked_sub(STEPS)?;
    let window = |first: usize| (first..first + STEPS).map(move |k| k % n);
    let looks_like_two = |first: usize| {
        let rms = |stride: usize| {
            let squares = window(first).map(|k| {
                let third = third_difference(curve, k, stride)?;
                Some(curve.manifold.inner(curve.point(k), third, third))
            });
            squares.sum::<Option<f64>>().map(f64::sqrt)
        };
        // A third difference goes with the third power of the step.
        window(first).all(|k| steps[k]) && rms(1).zip(rms(2)).is_some_and(|(all, half)| SMOOTHER * 8.0 * half < all)
    };
    // Around a loop a stretch may begin at any point.
    let first = (0..if curve.closed { n } else { last + 1 }).find(|&first| looks_like_two(first))?;
    let middle = first + STEPS / 2;
    let why = "the order steps from side to side here, and every second point alone is smooth: the curve may run back beside itself";
    Some(Doubt { at: curve.rows_at(middle % n, (middle + 1) % n), why: why.to_owned() })
}

/// Whether the third difference changes its sign from the point before.
fn steps_across<M: Manifold>(curve: &Curve<M>, k: usize) -> Option<bool> {
    let before = curve.previous(k)?;
    let (there, here) = (third_difference(curve, before, 1)?, third_difference(curve, k, 1)?);
    let along = curve.log(before, k)?;
    let there = curve.manifold.transport(curve.point(before), along, there);
    Some(curve.manifold.inner(curve.point(k), there, here) < 0.0)
}

/// The third divided difference of the points two strides and one before a point, itself, and one after, as a tangent there, less
/// its part along the curve: of an arc of a circle, whose third derivative is along it, nothing is left.
fn third_difference<M: Manifold>(curve: &Curve<M>, k: usize, stride: usize) -> Option<M::Tangent> {
    let step = |from: usize, to: &dyn Fn(usize) -> Option<usize>| (0..stride).try_fold(from, |k, _| to(k));
    let back = |from| step(from, &|k| curve.previous(k));
    let b = back(k)?;
    let (a, d) = (back(b)?, step(k, &|k| curve.next(k))?);
    let bend = |a: usize, b: usize, c: usize| {
        let (g, h) = (curve.distance(a, b), curve.distance(b, c));
        Some((curve.log(b, c)? * (1.0 / h) + curve.log(b, a)? * (1.0 / g)) * (1.0 / (g + h)))
    };
    let before = curve.manifold.transport(curve.point(b), curve.log(b, k)?, bend(a, b, k)?);
    let whole = curve.distance(a, b) + curve.distance(b, k) + curve.distance(k, d);
    let third = (bend(b, k, d)? - before) * (1.0 / whole);
    // The middle of the four is between these two.
    let (along, p) = (curve.log(k, b)?, curve.point(k));
    let share = curve.manifold.inner(p, third, along) / curve.manifold.inner(p, along, along);
    Some(third - along * share)
}
