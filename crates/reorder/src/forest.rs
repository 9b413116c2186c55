//! Several curves in one answer.

use se3_geom::Manifold;

use crate::agreement::Variant;
use crate::components::{Component, Components, components_by};
use crate::duplicates::merge;
use crate::error::OrderError;
use crate::finish::order_as_one;
use crate::ordering::{Doubt, Method, Options, Ordering, Part, Repaired, Topology, Verdict};
use crate::spanning_tree::minimum_spanning_tree;

/// Each curve in its own order, the curve that holds the wanted start first and the others by their first row, then the outliers.
/// One curve is what it would be by itself.
pub(crate) fn order_apart<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Ordering, OrderError> {
    let distinct = merge(manifold, points, minimum_spanning_tree(manifold, points)?);
    let order_one = |own: &[M::Point], start| order_as_one(manifold, variants, own, &Options { start, ..*options });
    let Components { mut curves, outliers, .. } = components_by(points, &distinct, options.start, order_one)?;
    if curves.is_empty() {
        return order_as_one(manifold, variants, points, options);
    }
    if curves.len() == 1 && outliers.is_empty() {
        return Ok(curves.remove(0).ordering);
    }
    if let Some(first) = options.start.and_then(|start| curves.iter().position(|c| c.rows.contains(&start))) {
        curves[..=first].rotate_right(1);
    }
    let is_apart = |group: &Vec<usize>| group.len() > 1 && outliers.binary_search(&group[0]).is_ok();
    let equal_outliers = distinct.groups.into_iter().filter(is_apart).collect();
    Ok(together(points.len(), curves, outliers, equal_outliers))
}

fn together(n: usize, curves: Vec<Component>, outliers: Vec<usize>, equal_outliers: Vec<Vec<usize>>) -> Ordering {
    let components: Vec<Vec<usize>> = curves.iter().map(Component::order).collect();
    let own_doubts = curves.iter().flat_map(|c| c.ordering.doubts.iter().map(|doubt| in_input_rows(doubt, &c.rows)));
    let own_groups = curves.iter().flat_map(|c| {
        c.ordering.duplicates.iter().map(|group| group.iter().map(|&k| c.rows[k]).collect::<Vec<usize>>())
    });
    let mut duplicates: Vec<Vec<usize>> = own_groups.chain(equal_outliers).collect();
    duplicates.sort();
    let mut moved = vec![0.0; if curves.iter().any(|c| !c.ordering.moved.is_empty()) { n } else { 0 }];
    for curve in &curves {
        curve.ordering.moved.iter().zip(&curve.rows).for_each(|(&by, &row)| moved[row] = by);
    }
    let least = curves.iter().map(|c| c.ordering.verdict).min().unwrap_or(Verdict::Ambiguous);
    // What a point far from all curves stands for is not known.
    let verdict = if outliers.is_empty() { least } else { Verdict::Ambiguous };
    let last = components.last().and_then(|rows| rows.last()).copied();
    let jumps = last.into_iter().chain(outliers.iter().copied()).zip(&outliers).map(|(from, &to)| Doubt {
        at: [from, to],
        why: "the order jumps to a point that stands apart from every curve; points of a curve between the two would settle it"
            .to_owned(),
    });
    let doubts = own_doubts.chain(jumps).collect();
    let epsilon = |c: &&Component| c.ordering.certificate.epsilon.unwrap_or(0.0);
    let weakest = curves.iter().filter(|c| c.ordering.verdict == least);
    let weakest = weakest.max_by(|a, b| epsilon(a).total_cmp(&epsilon(b))).unwrap_or(&curves[0]);
    let own_method = curves[0].ordering.method;
    let repaired = curves.iter().any(|c| c.ordering.method == Method::Repaired);
    let stable = |a: Option<bool>, b: Option<bool>| Some(a? && b?);
    Ordering {
        n,
        order: components.iter().flatten().chain(&outliers).copied().collect(),
        topology: if curves.len() == 1 { curves[0].ordering.topology } else { Topology::Open },
        method: if repaired { Method::Repaired } else { own_method },
        verdict,
        weight_stable: curves.iter().map(|c| c.ordering.weight_stable).reduce(stable).flatten(),
        metres_per_radian: None,
        parts: curves.iter().map(part).collect(),
        duplicates,
        certificate: part(weakest).certificate,
        repaired: repaired_in_all(&curves),
        moved,
        doubts,
        components,
        outliers,
    }
}

fn part(curve: &Component) -> Part {
    let Ordering { topology, method, verdict, mut certificate, .. } = curve.ordering.clone();
    certificate.weakest = certificate.weakest.map(|at| at.map(|k| curve.rows[k]));
    Part { topology, method, verdict, certificate }
}

fn repaired_in_all(curves: &[Component]) -> Option<Repaired> {
    let mut all: Option<Repaired> = None;
    for curve in curves {
        let Some(own) = &curve.ordering.repaired else { continue };
        let rows = |edges: &[[usize; 2]]| edges.iter().map(|at| at.map(|k| curve.rows[k])).collect::<Vec<_>>();
        let all = all.get_or_insert(Repaired { dropped: Vec::new(), added: Vec::new() });
        all.dropped.extend(rows(&own.dropped));
        all.added.extend(rows(&own.added));
    }
    all
}

/// Doubts name points in words too: "point 3", "points 3 and 4".
fn in_input_rows(doubt: &Doubt, rows: &[usize]) -> Doubt {
    let mut why = String::with_capacity(doubt.why.len());
    let mut names_points = false;
    for word in doubt.why.split_inclusive(' ') {
        let digits = word.find(|c: char| !c.is_ascii_digit()).unwrap_or(word.len());
        match word[..digits].parse::<usize>().ok().and_then(|k| rows.get(k)) {
            Some(row) if names_points => {
                why += &row.to_string();
                why += &word[digits..];
            }
            _ => {
                why += word;
                names_points = matches!(word.trim_end(), "point" | "points") || names_points && word == "and ";
            }
        }
    }
    Doubt { at: doubt.at.map(|k| rows[k]), why }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_name_input_rows_too() {
        let rows = [10, 20, 30];
        let said = |why: &str| in_input_rows(&Doubt { at: [0, 2], why: why.to_owned() }, &rows);
        assert_eq!(said("").at, [10, 30]);
        for (own, input) in [
            ("point 1 comes as near to point 0 as a neighbour", "point 20 comes as near to point 10 as a neighbour"),
            ("back to point 2: epsilon is 1.00, above 2", "back to point 30: epsilon is 1.00, above 2"),
            ("2 of 1 points 0 and 1 would, and 2 more", "2 of 1 points 10 and 20 would, and 2 more"),
        ] {
            assert_eq!(said(own).why, input);
        }
    }
}
