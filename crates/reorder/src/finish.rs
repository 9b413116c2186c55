//! From what is asked for to an answer: which method, how many curves, and what is said last.

use se3_geom::Manifold;

use crate::agreement::Variant;
use crate::error::OrderError;
use crate::forest::order_apart;
use crate::named::order_named;
use crate::order::order_among;
use crate::ordering::{ComponentsChoice, Doubt, MethodChoice, Options, Ordering, Verdict};
use crate::settling::say_what_would_settle;

/// The order as asked for; it must be the same under every variant of the metric.
pub(crate) fn ordered<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Ordering, OrderError> {
    let mut found = match options.components {
        ComponentsChoice::One => order_as_one(manifold, variants, points, options)?,
        ComponentsChoice::Auto => order_apart(manifold, variants, points, options)?,
    };
    if found.parts.is_empty() {
        name_components(manifold, points, &mut found);
    }
    say_what_would_settle(manifold, points, &mut found);
    Ok(found)
}

/// The order along one curve, by the method that is asked for.
pub(crate) fn order_as_one<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Ordering, OrderError> {
    match options.method {
        MethodChoice::Auto | MethodChoice::Mst => order_among(manifold, variants, points, options),
        // Noise is taken away first, by a way that comes back here.
        _ if options.denoise => order_among(manifold, variants, points, options),
        MethodChoice::NnCrust | MethodChoice::Crust | MethodChoice::Nearest => {
            order_named(manifold, variants, points, options)
        }
    }
}

/// Puts the rows of each curve in order. Where the points look like several, that speaks against an order along one, unless nothing
/// else does: then a long gap is one that independent points have.
fn name_components<M: Manifold>(manifold: &M, points: &[M::Point], found: &mut Ordering) {
    let is_one = found.components.is_empty() || found.components.len() == 1 && found.outliers.is_empty();
    if is_one || found.verdict > Verdict::Ambiguous {
        found.components = vec![found.order.clone()];
        found.outliers.clear();
        return;
    }
    found.sort_components();
    let mut piece = vec![0; found.n];
    for (k, rows) in found.components.iter().enumerate() {
        rows.iter().for_each(|&row| piece[row] = k);
    }
    for (k, &row) in found.outliers.iter().enumerate() {
        piece[row] = found.components.len() + k;
    }
    let jumps = found.order.windows(2).filter(|w| piece[w[0]] != piece[w[1]]);
    let length = |w: &[usize]| manifold.distance(&points[w[0]], &points[w[1]]);
    if let Some(w) = jumps.max_by(|a, b| length(a).total_cmp(&length(b))) {
        let why = format!(
            "the points look like {} separate curves and {} points apart from them, and the order jumps from one to another here",
            found.components.len(),
            found.outliers.len()
        );
        found.doubts.push(Doubt { at: [w[0], w[1]], why });
    }
}
