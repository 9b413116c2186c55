//! What a user asks for: a method by name, several curves, where to start, figures of every gap.

#![allow(clippy::unwrap_used, reason = "a helper of a test fails as the test does")]

use std::f64::consts::TAU;

use reorder::{
    ComponentsChoice, Method, MethodChoice, Options, OrderError, Ordering, Repair, Topology, TopologyChoice, Verdict,
    Weight, order, order_weighted,
};
use se3_geom::nalgebra::{Vector2, Vector3};
use se3_geom::{Manifold, Pose, R2, R3, Se3};

use crate::support::{Random, helix_pose, loop_pose, neighbours, shuffled, unshuffled};

fn by(method: MethodChoice) -> Options {
    Options { method, ..Options::default() }
}

fn apart() -> Options {
    Options { components: ComponentsChoice::Auto, ..Options::default() }
}

fn ring(x: f64, n: u32) -> Vec<Vector2<f64>> {
    (0..n).map(|k| TAU * f64::from(k) / f64::from(n)).map(|t| Vector2::new(x + 2.0 * t.cos(), 2.0 * t.sin())).collect()
}

fn arc(x: f64, n: u32) -> Vec<Vector2<f64>> {
    (0..n).map(|k| Vector2::new(x + f64::from(k), 30.0 + (f64::from(k) * 0.1).sin())).collect()
}

fn in_plane(points: &[Vector2<f64>], options: &Options) -> Ordering {
    order(&R2::default(), points, options).unwrap()
}

fn is_permutation(found: &Ordering) -> bool {
    let mut rows = found.order.clone();
    rows.sort_unstable();
    rows == (0..found.n).collect::<Vec<_>>()
}

const NAMED: [(MethodChoice, Method); 3] = [
    (MethodChoice::NnCrust, Method::NnCrust),
    (MethodChoice::Crust, Method::Crust),
    (MethodChoice::Nearest, Method::Nearest),
];

#[test]
fn every_method_orders_a_dense_ring_and_is_trusted_alike() {
    let mut random = Random::seeded(91);
    let rows = random.permutation(60);
    let points = shuffled(&ring(0.0, 60), &rows);
    let tree = in_plane(&points, &by(MethodChoice::Mst));
    assert_eq!((tree.topology, tree.verdict), (Topology::Closed, Verdict::Certified));
    for (choice, method) in NAMED {
        let found = in_plane(&points, &by(choice));
        assert_eq!((found.method, found.topology, found.verdict), (method, Topology::Closed, Verdict::Certified));
        let truth = neighbours(&(0..60).collect::<Vec<_>>(), true);
        assert_eq!(neighbours(&unshuffled(&found.order, &rows), true), truth);
        assert_eq!(found.order[0], 0);
    }
}

/// The same points by every method, with duplicates: only the chain does not start at an end.
#[test]
fn on_an_arc_the_chain_alone_is_wrong_and_says_so() {
    let mut points = arc(0.0, 30);
    points.push(points[7]);
    for (choice, _) in &NAMED[..2] {
        let found = in_plane(&points, &by(*choice));
        assert_eq!((found.topology, found.verdict), (Topology::Open, Verdict::Certified), "{:?}", found.doubts);
        assert_eq!(found.distinct(), (0..30).collect::<Vec<_>>());
        assert_eq!(found.duplicates, [[7, 30]]);
        let back = in_plane(&points, &Options { start: Some(29), ..by(*choice) });
        assert_eq!(back.distinct(), (0..30).rev().collect::<Vec<_>>());
        let inside = order(&R2::default(), &points, &Options { start: Some(4), ..by(*choice) });
        assert_eq!(inside, Err(OrderError::StartNotAnEnd { start: 4, ends: [0, 29] }));
    }
    let chain = |start| in_plane(&points, &Options { start, ..by(MethodChoice::Nearest) });
    assert_eq!((chain(None).distinct(), chain(None).verdict), ((0..30).collect(), Verdict::Certified));
    assert_eq!(chain(Some(29)).distinct(), (0..30).rev().collect::<Vec<_>>());
    let inside = chain(Some(4));
    assert!(is_permutation(&inside) && inside.order[0] == 4 && inside.verdict == Verdict::Ambiguous);
    // From 4 up to 29, where the arc is flatter, and then a jump: the tree joins 3 and 4.
    let of_tree = |doubt: &&reorder::Doubt| doubt.why.starts_with("the minimum spanning tree joins these two");
    assert_eq!(inside.doubts.iter().find(of_tree).map(|doubt| doubt.at), Some([3, 4]));
}

/// The ends of an arc that bends back are each other's nearest on the other side.
#[test]
fn an_arc_whose_ends_face_each_other_is_open() {
    let arc: Vec<_> = (0..200).map(|k| 0.02 * f64::from(k)).map(|t| Vector2::new(t.cos(), t.sin())).collect();
    for (choice, _) in NAMED {
        let found = in_plane(&arc, &by(choice));
        assert_eq!((found.topology, found.verdict), (Topology::Open, Verdict::Certified), "{choice:?}");
        assert_eq!(found.order, (0..200).collect::<Vec<_>>());
    }
}

#[test]
fn edges_that_are_no_single_curve_are_doubted_where_they_are_not() {
    let mut random = Random::seeded(92);
    let rings = [ring(0.0, 30), ring(9.0, 30)].concat();
    let arm = |turn: f64| (1..8).map(move |k| Vector2::new((TAU * turn).cos(), (TAU * turn).sin()) * f64::from(k));
    let star: Vec<_> = [Vector2::zeros()].into_iter().chain([0.0, 0.33, 0.66].into_iter().flat_map(arm)).collect();
    for choice in [MethodChoice::NnCrust, MethodChoice::Crust] {
        let found = in_plane(&rings, &by(choice));
        assert!(is_permutation(&found) && found.verdict == Verdict::Ambiguous);
        let join = found.doubts.iter().find(|doubt| doubt.why.contains("no edge")).unwrap();
        assert!(join.at.iter().any(|&row| row < 30) && join.at.iter().any(|&row| row >= 30), "{join:?}");
        let cloud: Vec<_> = (0..200).map(|_| Vector2::new(random.signed(), random.signed())).collect();
        let found = in_plane(&cloud, &by(choice));
        assert!(is_permutation(&found) && found.verdict == Verdict::Ambiguous);
    }
    let branched = in_plane(&star, &by(MethodChoice::Crust));
    let at_hub = |doubt: &reorder::Doubt| doubt.at[0] == 0 && doubt.why.contains("more than two edges");
    assert!(is_permutation(&branched) && branched.doubts.iter().any(at_hub), "{:?}", branched.doubts);
}

#[test]
fn poses_are_ordered_by_name_and_the_weight_is_checked() {
    let mut random = Random::seeded(93);
    let rows = random.permutation(80);
    let poses: Vec<Pose> = (0..80).map(|k| loop_pose(TAU * f64::from(k) / 80.0, 1.0)).collect();
    let mixed = shuffled(&poses, &rows);
    let found = order_weighted::<Se3>(&mixed, Weight::MetresPerRadian(0.3), &by(MethodChoice::NnCrust)).unwrap();
    assert_eq!((found.method, found.weight_stable), (Method::NnCrust, Some(true)));
    assert!(found.verdict > Verdict::Ambiguous, "{:?}", found.doubts);
    assert_eq!(neighbours(&unshuffled(&found.order, &rows), true), neighbours(&(0..80).collect::<Vec<_>>(), true));
    let denoised = Options { denoise: true, ..by(MethodChoice::NnCrust) };
    let denoised = order_weighted::<Se3>(&mixed, Weight::MetresPerRadian(0.3), &denoised).unwrap();
    assert_eq!((denoised.method, denoised.moved.len()), (Method::NnCrust, 80));
    // The chain at other weights starts where it starts at this one.
    for start in [7, 41] {
        let chain = Options { start: Some(start), topology: TopologyChoice::Closed, ..by(MethodChoice::Nearest) };
        let chain = order_weighted::<Se3>(&mixed, Weight::MetresPerRadian(0.3), &chain).unwrap();
        assert_eq!((chain.order[0], chain.weight_stable), (start, Some(true)), "{:?}", chain.doubts);
    }
    let refused = order_weighted::<Se3>(&mixed, Weight::Auto, &by(MethodChoice::Crust)).unwrap_err();
    assert_eq!(refused, OrderError::NotPlanar);
    assert_eq!(
        order(&R3::default(), &[Vector3::x(), Vector3::y()], &by(MethodChoice::Crust)),
        Err(OrderError::NotPlanar)
    );
    let huge = [Vector2::new(1e70, 0.0), Vector2::zeros()];
    let refused = order(&R2::default(), &huge, &by(MethodChoice::Crust)).unwrap_err().to_string();
    assert_eq!(refused, "CRUST cannot triangulate the points: a coordinate is beyond 1e60");
}

#[test]
fn few_points_by_every_method() {
    for (choice, _) in NAMED {
        for n in 2..6 {
            let found = in_plane(&arc(0.0, n), &by(choice));
            assert_eq!(found.order, (0..n as usize).collect::<Vec<_>>());
            if n > 2 {
                let closed = Options { topology: TopologyChoice::Closed, ..by(choice) };
                assert_eq!(in_plane(&arc(0.0, n), &closed).topology, Topology::Closed);
            }
        }
        let open = Options { topology: TopologyChoice::Open, ..by(choice) };
        assert_eq!(in_plane(&ring(0.0, 20), &open).topology, Topology::Open);
        assert_eq!(order(&R2::default(), &[Vector2::x(); 3], &by(choice)), Err(OrderError::AllEqual { count: 3 }));
    }
}

/// Two rings, an arc, a point that came twice and one that came once.
fn several(random: &mut Random) -> (Vec<Vector2<f64>>, Vec<usize>) {
    let mut points = [ring(0.0, 40), ring(9.0, 40), arc(0.0, 20)].concat();
    points.extend([Vector2::new(200.0, 0.0), Vector2::new(200.0, 0.0), Vector2::new(-150.0, 3.0)]);
    let rows = random.permutation(points.len());
    (shuffled(&points, &rows), rows)
}

#[test]
fn several_curves_are_named_unasked_and_ordered_apart_when_asked() {
    let mut random = Random::seeded(94);
    let (points, rows) = several(&mut random);
    let as_one = in_plane(&points, &Options::default());
    let found = in_plane(&points, &apart());
    assert_eq!(as_one.verdict, Verdict::Ambiguous);
    assert!(as_one.parts.is_empty() && is_permutation(&as_one));
    assert!(
        as_one.doubts.iter().any(|d| d.why.contains("3 separate curves and 3 points apart")),
        "{:?}",
        as_one.doubts
    );
    for named in [&as_one, &found] {
        assert_eq!((named.components.len(), named.outliers.len()), (3, 3));
        let mut outliers = unshuffled(&named.outliers, &rows);
        outliers.sort_unstable();
        assert_eq!(outliers, [100, 101, 102]);
    }
    assert!(is_permutation(&found));
    assert_eq!(found.order, [found.components.concat(), found.outliers.clone()].concat());
    assert_eq!(found.topology, Topology::Open);
    // Certified curves, but nothing says what the outliers are.
    assert_eq!((found.verdict, found.doubts.len()), (Verdict::Ambiguous, 3), "{:?}", found.doubts);
    for (doubt, jump) in found.doubts.iter().zip(found.order[found.n - 4..].windows(2)) {
        assert_eq!(doubt.at, jump);
    }
    assert_eq!(found.duplicates.len(), 1);
    for (component, part) in found.components.iter().zip(&found.parts) {
        let component = unshuffled(component, &rows);
        let first = component.iter().min().copied().unwrap();
        let (n, closed) = if first == 80 { (20, false) } else { (40, true) };
        let truth: Vec<usize> = (first..first + n).collect();
        assert_eq!(neighbours(&component, closed), neighbours(&truth, closed));
        assert_eq!(part.topology == Topology::Closed, closed);
        assert_eq!(part.verdict, Verdict::Certified);
    }
    let edges = found.edges(&R2::default(), &points);
    assert_eq!(edges.len(), 40 + 40 + 19);
    let nothing = order(&R2::default(), &points[..0], &apart());
    assert_eq!(nothing, Err(OrderError::TooFewPoints { count: 0, needed: 1 }));
}

#[test]
fn the_verdict_of_several_curves_is_the_least_and_doubts_name_input_rows() {
    // The figure eight crosses itself; its rows come after those of the ring.
    let eight =
        (0..60).map(|k| (TAU * f64::from(k) / 60.0 + 0.02).sin_cos()).map(|(s, c)| Vector2::new(50.0 + s, s * c));
    let points: Vec<_> = ring(0.0, 40).into_iter().chain(eight).collect();
    let unrepaired = Options { repair: Repair::Off, ..apart() };
    let found = in_plane(&points, &unrepaired);
    let verdicts: Vec<_> = found.parts.iter().map(|part| part.verdict).collect();
    assert_eq!((found.verdict, verdicts), (Verdict::Ambiguous, vec![Verdict::Certified, Verdict::Ambiguous]));
    assert!(!found.doubts.is_empty());
    for doubt in &found.doubts {
        assert!(doubt.at.iter().all(|&row| row >= 40), "{doubt:?}");
        let after = |word: &str| {
            doubt.why.split(word).nth(1).and_then(|rest| rest.split([' ', ':', ';', ',']).next()?.parse().ok())
        };
        for row in [after("at point "), after("back to point "), after("between points ")].into_iter().flatten() {
            let row: usize = row;
            assert!(row >= 40, "{}", doubt.why);
        }
        assert!(doubt.why.ends_with("would settle it"), "{}", doubt.why);
    }
}

#[test]
fn one_curve_is_the_same_whether_or_not_there_might_be_several() {
    for points in [ring(0.0, 40), arc(0.0, 30)] {
        let (one, several) = (in_plane(&points, &Options::default()), in_plane(&points, &apart()));
        assert_eq!(one, several);
        assert_eq!((one.components, one.outliers), (vec![one.order], vec![]));
    }
    let two = [arc(0.0, 20), arc(100.0, 20)].concat();
    let at = |start| order(&R2::default(), &two, &Options { start, ..apart() });
    assert_eq!(at(Some(39)).unwrap().order, (20..40).rev().chain(0..20).collect::<Vec<_>>());
    assert_eq!(at(Some(25)), Err(OrderError::StartNotAnEnd { start: 25, ends: [20, 39] }));
    assert_eq!(at(Some(40)), Err(OrderError::StartOutOfRange { start: 40, count: 40 }));
    let far = [arc(0.0, 20), vec![Vector2::new(500.0, 0.0)]].concat();
    let at_outlier = order(&R2::default(), &far, &Options { start: Some(20), ..apart() });
    assert_eq!(at_outlier, Err(OrderError::StartApart { start: 20 }));
    let beside = in_plane(&[ring(0.0, 40), vec![Vector2::new(500.0, 0.0)]].concat(), &apart());
    assert_eq!((beside.topology, beside.outliers), (Topology::Closed, vec![40]));
}

/// Wherever it starts, it is the order that the same start by row gives.
#[test]
fn starting_near_a_point_is_starting_at_its_nearest_row() {
    let mut random = Random::seeded(95);
    let metric = Se3::with_metres_per_radian(0.3).unwrap();
    let mut helix: Vec<Pose> = (0..30).map(|k| helix_pose(0.2 * f64::from(k))).collect();
    helix.extend([helix[0], helix[0], helix[29]]);
    let mut ring: Vec<Pose> = (0..60).map(|k| loop_pose(TAU * f64::from(k) / 60.0, 1.0)).collect();
    ring.extend([ring[5], ring[5], ring[20]]);
    for points in [helix, ring] {
        let mixed = shuffled(&points, &random.permutation(points.len()));
        let anywhere = order(&metric, &mixed, &Options::default()).unwrap();
        let closed = anywhere.topology == Topology::Closed;
        let groups = anywhere.distinct();
        let starts = if closed { groups.clone() } else { vec![groups[0], groups[29]] };
        assert_eq!(starts.len(), if closed { 60 } else { 2 });
        for row in starts.into_iter().step_by(if closed { 7 } else { 1 }) {
            let by_row = order(&metric, &mixed, &Options { start: Some(row), ..Options::default() }).unwrap();
            let near = metric.exp(&mixed[row], metric.log(&mixed[row], &mixed[groups[3]]).unwrap() * 0.01);
            assert_eq!(anywhere.clone().starting_near(&metric, &mixed, &near), by_row);
        }
    }
    let two = [arc(0.0, 20), arc(100.0, 20)].concat();
    let as_one = in_plane(&two, &Options::default()).starting_near(&R2::default(), &two, &Vector2::new(130.0, 0.0));
    assert_eq!(as_one.order, (0..40).rev().collect::<Vec<_>>());
    assert_eq!(as_one.components, [(0..20).rev().collect::<Vec<_>>(), (20..40).rev().collect()]);
    let found = in_plane(&two, &apart()).starting_near(&R2::default(), &two, &Vector2::new(130.0, 0.0));
    assert_eq!(found.order, (20..40).rev().chain((0..20).rev()).collect::<Vec<_>>());
    assert_eq!(found.components[0], (20..40).rev().collect::<Vec<_>>());
}

/// On a circle of radius r every ball is r: ε = gap/2r, gap by gap.
#[test]
fn edges_of_a_circle_have_their_own_epsilon() {
    let angles: Vec<f64> = (0..40).map(|k| TAU * (f64::from(k) + 0.3 * (f64::from(k) * 0.9).sin()) / 40.0).collect();
    let points: Vec<_> = angles.iter().map(|t| Vector2::new(2.5 * t.cos(), 2.5 * t.sin())).collect();
    let found = in_plane(&points, &Options::default());
    let edges = found.edges(&R2::default(), &points);
    assert_eq!(edges.len(), 40);
    for (k, edge) in edges.iter().enumerate() {
        assert_eq!(edge.at, [found.order[k], found.order[(k + 1) % 40]]);
        let chord = (points[edge.at[0]] - points[edge.at[1]]).norm();
        // A parabola's tangent through unevenly spaced points of a circle is off by terms of the gaps' square, 0.2² at most.
        assert!((edge.gap - chord).abs() < 1e-14 && (edge.epsilon * 5.0 / chord - 1.0).abs() < 0.04, "{edge:?}");
    }
    let worst = edges.iter().map(|edge| edge.epsilon).fold(0.0, f64::max);
    assert_eq!(Some(worst), found.certificate.edge_epsilon);
    let line: Vec<_> = (0..12).map(|k| Vector2::new(f64::from(k), 0.0)).collect();
    let edges = in_plane(&line, &Options::default()).edges(&R2::default(), &line);
    assert!(edges.len() == 11 && edges.iter().all(|edge| edge.reach.is_none() && edge.epsilon == 0.0));
}

#[test]
fn every_doubt_says_where_one_more_point_would_settle_it() {
    let gap = |k: u32| Vector2::new(f64::from(k) + if k > 9 { 4.0 } else { 0.0 }, 0.0);
    let found = in_plane(&(0..20).map(gap).collect::<Vec<_>>(), &Options::default());
    assert_eq!(found.doubts.len(), 2, "the gap, and two curves: {:?}", found.doubts);
    for doubt in &found.doubts {
        assert!(doubt.why.ends_with("; a point of the curve between points 9 and 10 would settle it"), "{doubt:?}");
    }
    let corner: Vec<_> = (0..=10)
        .map(|k| Vector2::new(f64::from(k), 0.0))
        .chain((1..=10).map(|k| Vector2::new(10.2, 1.3 * f64::from(k))))
        .collect();
    let found = in_plane(&corner, &Options { repair: Repair::Off, ..Options::default() });
    let turn = found.doubts.iter().find(|doubt| doubt.why.contains("turns by"));
    assert!(turn.is_none_or(|doubt| doubt.why.contains("between points 10 and 11")), "{turn:?}");
}

#[test]
fn an_arc_that_shall_be_closed_is_joined_at_its_ends() {
    let mut random = Random::seeded(96);
    let closed = Options { topology: TopologyChoice::Closed, ..Options::default() };
    for points in [arc(0.0, 40), (0..20).map(|k| Vector2::new(f64::from(k), 0.0)).collect()] {
        let rows = random.permutation(points.len());
        let found = in_plane(&shuffled(&points, &rows), &closed);
        let truth: Vec<usize> = (0..points.len()).collect();
        assert_eq!(neighbours(&unshuffled(&found.order, &rows), true), neighbours(&truth, true));
        assert_eq!((found.topology, found.method, found.verdict), (Topology::Closed, Method::Mst, Verdict::Ambiguous));
    }
}
