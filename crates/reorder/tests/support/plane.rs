//! Orders of points in the plane, and what speaks against them.
#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use reorder::{Options, Ordering, Repair, Verdict, order};
use se3_geom::R2;
use se3_geom::nalgebra::Vector2;

pub(crate) fn in_plane(points: &[(f64, f64)]) -> Ordering {
    let points: Vec<_> = points.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
    order(&R2::default(), &points, &Options::default()).unwrap()
}

/// What speaks against the tree's order by itself.
pub(crate) fn tree_in_plane(points: &[(f64, f64)]) -> Ordering {
    let points: Vec<_> = points.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
    order(&R2::default(), &points, &Options { repair: Repair::Off, ..Options::default() }).unwrap()
}

pub(crate) fn line(xs: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    xs.into_iter().map(|x| (x, 0.0)).collect()
}

pub(crate) fn reasons(found: &Ordering) -> String {
    found.doubts.iter().map(|d| format!("{:?} {}\n", d.at, d.why)).collect()
}

pub(crate) fn doubted(found: &Ordering, at: [usize; 2], why: &str) -> bool {
    found.verdict == Verdict::Ambiguous && found.doubts.iter().any(|d| d.at == at && d.why.contains(why))
}
