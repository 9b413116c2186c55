//! Orders by a method that is asked for by name, examined like any other order.

use se3_geom::Manifold;
use se3_geom::nalgebra::Vector2;

use crate::agreement::Variant;
use crate::certificate::closes;
use crate::crust::crust;
use crate::curve::Curve;
use crate::duplicates::Distinct;
use crate::error::OrderError;
use crate::nearest::nearest_chain;
use crate::nn_crust::nn_crust;
use crate::order::examine_rows;
use crate::ordering::{Doubt, Method, MethodChoice, Options, Ordering, TopologyChoice};
use crate::recovery::{Recovery, distinct_points};
use crate::thread::{Thread, thread};
use crate::topology::{Closing, closing, may_be_open, rotate_to};

/// Places of one kind that are written out as doubts.
const MOST_DOUBTS: usize = 20;

/// The order by NN-CRUST, CRUST or the nearest-neighbour chain. Where its edges are no single curve, where the minimum spanning tree has
/// others, or where it gives other ones under a variant of the metric, that speaks against it, besides all that is asked of every
/// order.
pub(crate) fn order_named<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Ordering, OrderError> {
    let distinct = distinct_points(manifold, points, options.topology, options.start)?;
    let (recovery, pieced) = recover_named(manifold, points, distinct, options)?;
    let edges = recovery.edges();
    let mut examined = examine_rows(manifold, points, &recovery);
    examined.doubts.firm.extend(pieced);
    let of_tree = recovery.tree_edges().into_iter().filter(|edge| edges.binary_search(edge).is_err());
    examined.doubts.firm.extend(of_tree.take(MOST_DOUBTS).map(|(i, j)| Doubt {
        at: [i, j],
        why: "the minimum spanning tree joins these two, which are no neighbours in this order".to_owned(),
    }));
    // A chain is what comes of its start; elsewhere the start may be an end at one weight alone.
    let anyhow = Options { start: options.start.filter(|_| options.method == MethodChoice::Nearest), ..*options };
    let mut stable = true;
    for Variant { manifold, change } in variants {
        let distinct = distinct_points(manifold, points, options.topology, options.start)?;
        let kept = recover_named(manifold, points, distinct, &anyhow)?.0.edges();
        let lost = edges.iter().filter(|edge| kept.binary_search(edge).is_err());
        if let Some(&(i, j)) = lost.chain(kept.iter().filter(|edge| edges.binary_search(edge).is_err())).next() {
            stable = false;
            let why = format!("{change} this method gives another order, which differs here first");
            examined.doubts.firm.push(Doubt { at: [i, j], why });
        }
    }
    let mut answer = examined.answer(points.len(), recovery, (!variants.is_empty()).then_some(stable));
    answer.method = match options.method {
        MethodChoice::Auto | MethodChoice::Mst => Method::Mst,
        MethodChoice::NnCrust => Method::NnCrust,
        MethodChoice::Crust => Method::Crust,
        MethodChoice::Nearest => Method::Nearest,
    };
    Ok(answer)
}

/// The order, and what speaks against it because the method's edges are no single curve.
fn recover_named<M: Manifold>(
    manifold: &M,
    points: &[M::Point],
    distinct: Distinct,
    options: &Options,
) -> Result<(Recovery, Vec<Doubt>), OrderError> {
    let own: Vec<M::Point> = distinct.groups.iter().map(|group| points[group[0]].clone()).collect();
    let start = options.start.map(|row| distinct.node_of(row).index());
    let is_chain = options.method == MethodChoice::Nearest;
    let Thread { nodes, closed, left_out, joins } = match options.method {
        MethodChoice::Nearest => {
            let nodes = nearest_chain(manifold, &own, start.unwrap_or(0));
            Thread { nodes, closed: false, left_out: Vec::new(), joins: Vec::new() }
        }
        MethodChoice::Crust => {
            let drawing = crust(&in_plane(manifold, &own)?).map_err(|reason| OrderError::NoTriangulation { reason })?;
            thread(&drawing, |a, b| manifold.distance(&own[a], &own[b]))
        }
        _ => thread(&nn_crust(manifold, &own), |a, b| manifold.distance(&own[a], &own[b])),
    };
    let row_of = |node: usize| distinct.groups[node][0];
    let doubts = |places: Vec<[usize; 2]>, why: &'static str| {
        places.into_iter().take(MOST_DOUBTS).map(move |at| Doubt { at: at.map(row_of), why: why.to_owned() })
    };
    let pieced = doubts(joins.clone(), "the method draws no edge between these two, whose pieces are nearest here")
        .chain(doubts(left_out, "more than two edges meet at one of these two, and the edge between them is left out"))
        .collect();

    let mut rows: Vec<usize> = nodes.into_iter().map(row_of).collect();
    if closed {
        cut_at_longest(&Curve::new(manifold, points, &rows, true).gaps(), &mut rows);
    }
    let path = Curve::new(manifold, points, &rows, false);
    let ends = closing(&path);
    let is_loop = match options.topology {
        // Both ends of an arc that bends back draw the edge between them.
        TopologyChoice::Auto if closed => ends != Closing::Apart || closes(&path),
        // A curve that the method drew with two ends has them.
        TopologyChoice::Auto => (is_chain || !joins.is_empty()) && (ends == Closing::Meets || closes(&path)),
        TopologyChoice::Open => false,
        TopologyChoice::Closed => true,
    };
    let unsure = if is_loop { may_be_open(&path.joined().gaps()) } else { ends != Closing::Apart };
    let unsure_of_ends = options.topology == TopologyChoice::Auto && unsure;
    let start_row = start.map(row_of);
    let ends = [rows[0], rows[rows.len() - 1]];
    match start_row {
        _ if is_chain => {}
        _ if is_loop => rotate_to(&mut rows, start_row.unwrap_or(0)),
        Some(start) if start == ends[0] => {}
        Some(start) if start == ends[1] => rows.reverse(),
        Some(_) => return Err(OrderError::start_not_an_end(options.start.unwrap_or_default(), ends)),
        None if ends[0] > ends[1] => rows.reverse(),
        None => {}
    }
    Ok((Recovery { distinct, rows, closed: is_loop, unsure_of_ends }, pieced))
}

/// Gap k leads from position k to the next.
fn cut_at_longest(gaps: &[f64], rows: &mut [usize]) {
    let longest = (0..gaps.len()).reduce(|a, b| if gaps[b] > gaps[a] { b } else { a }).unwrap_or(0);
    rows.rotate_left((longest + 1) % gaps.len());
}

/// Coordinates in which distances are those of the plane.
fn in_plane<M: Manifold>(manifold: &M, points: &[M::Point]) -> Result<Vec<Vector2<f64>>, OrderError> {
    let is_plane = manifold.embedding().is_some_and(|e| e.flat_dimension == 2 && e.round.is_none());
    if !is_plane {
        return Err(OrderError::NotPlanar);
    }
    let coordinates = |p: &M::Point| {
        let mut place = Vector2::zeros();
        manifold.embed(p, place.as_mut_slice());
        place
    };
    Ok(points.iter().map(coordinates).collect())
}
