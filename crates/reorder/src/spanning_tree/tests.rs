//! Borůvka on the search tree against the dense Prim, which the integration tests hold against Kruskal.

use std::f64::consts::PI;

use se3_geom::nalgebra::{Isometry2, Isometry3, SVector, Similarity2, UnitComplex, UnitQuaternion, Vector2, Vector3};
use se3_geom::{Euclidean, Manifold, R2, R3, Se2, Se3, Sim2, So2, So3, Sphere};

use super::{coordinates::Coordinates, minimum_spanning_tree, prim, vectorised::PLAIN};

/// SplitMix64 (Steele, Lea, Flood 2014), in [−1, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    fn vector<const N: usize>(&mut self) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.next())
    }
    /// Of any angle, on either sign of the quaternion.
    fn rotation(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.vector::<3>() * 6.0)
    }
    /// Near a curve that turns fully.
    fn rotation_on_turn(&mut self, spread: f64) -> UnitQuaternion<f64> {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * (2.0 * PI * self.next()));
        let q = turn * UnitQuaternion::from_scaled_axis(self.vector::<3>() * spread);
        if self.next() < 0.0 { UnitQuaternion::new_unchecked(-q.into_inner()) } else { q }
    }
}

type Pairs = Vec<[u32; 2]>;

fn sorted(mut pairs: Pairs) -> Pairs {
    pairs.iter_mut().for_each(|pair| pair.sort_unstable());
    pairs.sort_unstable();
    pairs
}

fn weight<M: Manifold>(manifold: &M, points: &[M::Point], pairs: &[[u32; 2]]) -> f64 {
    let mut lengths: Vec<f64> =
        pairs.iter().map(|&[i, j]| manifold.distance(&points[i as usize], &points[j as usize])).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.iter().sum()
}

fn trees<M: Manifold>(manifold: &M, points: &[M::Point]) -> [Pairs; 2] {
    let searched = Coordinates::of(manifold, points).expect("the space has an embedding").spanning_pairs();
    [sorted(searched), sorted(prim::spanning_pairs(manifold, points))]
}

/// Lengths that differ at all differ by far more than rounding here, so that the trees must be the same edge for edge.
fn assert_same_tree<M: Manifold>(manifold: &M, points: &[M::Point]) {
    let [searched, dense] = trees(manifold, points);
    assert_eq!(searched.len() + 1, points.len());
    assert_eq!(searched, dense);
}

/// Lengths tie up to rounding: the trees weigh the same. Both weights are sums in ascending order of lengths that are equal up
/// to a few ε.
fn assert_same_weight<M: Manifold>(manifold: &M, points: &[M::Point]) {
    let [searched, dense] = trees(manifold, points).map(|pairs| weight(manifold, points, &pairs));
    assert!((searched - dense).abs() <= 1e-12 * dense, "{searched} {dense}");
    assert!(points.len() < 2 || dense > 0.0 || points.iter().all(|p| manifold.distance(p, &points[0]) == 0.0));
}

fn se3(metres_per_radian: f64) -> Se3 {
    Se3::with_metres_per_radian(metres_per_radian).expect("a positive length")
}

const COUNTS: [usize; 10] = [1, 2, 3, 4, 5, 16, 17, 33, 200, 1000];

#[test]
fn scattered_points_of_every_space() {
    let mut numbers = Numbers(1);
    for count in COUNTS {
        macro_rules! scattered {
            ($manifold:expr, $point:expr) => {
                assert_same_tree(&$manifold, &(0..count).map(|_| $point).collect::<Vec<_>>())
            };
        }
        scattered!(Euclidean::<1>, numbers.vector());
        scattered!(R2::default(), numbers.vector());
        scattered!(R3::default(), numbers.vector());
        scattered!(Euclidean::<4>, numbers.vector());
        scattered!(Euclidean::<5>, numbers.vector());
        scattered!(Euclidean::<6>, numbers.vector());
        scattered!(Euclidean::<7>, numbers.vector());
        scattered!(Euclidean::<8>, numbers.vector());
        scattered!(Euclidean::<11>, numbers.vector());
        scattered!(Euclidean::<20>, numbers.vector());
        scattered!(Sphere, numbers.vector::<3>().normalize());
        scattered!(So2, UnitComplex::new(PI * numbers.next()));
        scattered!(So3, numbers.rotation());
        for weight in [1e-12, 0.01, 1.0, 100.0, 1e12] {
            let planar = Se2::with_weights(weight, 1.0).expect("positive");
            scattered!(planar, Isometry2::new(numbers.vector(), PI * numbers.next()));
            let similar = Sim2::with_weights(weight, 2.0).expect("positive");
            scattered!(similar, Similarity2::new(numbers.vector(), PI * numbers.next(), numbers.next().exp()));
            let poses = Se3::with_weights(weight, 0.3).expect("positive");
            scattered!(poses, Isometry3::from_parts(numbers.vector::<3>().into(), numbers.rotation()));
        }
    }
}

#[test]
fn rotations_around_a_full_turn() {
    let mut numbers = Numbers(2);
    for count in COUNTS {
        for spread in [1e-9, 1e-4, 0.1] {
            let turn: Vec<_> = (0..count).map(|_| numbers.rotation_on_turn(spread)).collect();
            assert_same_tree(&So3, &turn);
            let moving = turn.iter().map(|&q| Isometry3::from_parts((numbers.vector::<3>() * 0.1).into(), q));
            assert_same_tree(&se3(0.3), &moving.collect::<Vec<_>>());
        }
    }
}

#[test]
fn clusters_near_and_far_small_and_large() {
    let mut numbers = Numbers(3);
    for extent in [1e-6, 1.0, 1e6] {
        for spread in [1e-3, 0.3] {
            let centres: Vec<_> = (0..7).map(|_| (numbers.vector::<3>() * extent, numbers.rotation())).collect();
            let near = |k: usize, numbers: &mut Numbers| centres[k % 7].0 + numbers.vector::<3>() * (extent * spread);
            let positions: Vec<_> = (0..700).map(|k| near(k, &mut numbers)).collect();
            assert_same_tree(&R3::default(), &positions);
            let poses: Vec<_> = (0..700)
                .map(|k| {
                    let turn = UnitQuaternion::from_scaled_axis(numbers.vector::<3>() * spread);
                    Isometry3::from_parts(near(k, &mut numbers).into(), centres[k % 7].1 * turn)
                })
                .collect();
            for metres_per_radian in [1e-6, 1.0, 1e6] {
                assert_same_tree(&se3(metres_per_radian), &poses);
            }
        }
    }
}

/// Where chords say nothing about angles any more: two clusters half a turn apart, joined by one edge of nearly π.
#[test]
fn bridges_of_half_a_turn() {
    let mut numbers = Numbers(4);
    for spread in [1e-7, 1e-3] {
        let side = |k: usize| if k.is_multiple_of(2) { 0.0 } else { PI };
        let turns: Vec<_> = (0..90).map(|k| UnitComplex::new(side(k) + spread * numbers.next())).collect();
        assert_same_weight(&So2, &turns);
        let ends: Vec<_> = (0..90)
            .map(|k| {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                (Vector3::z() * sign + numbers.vector::<3>() * spread).normalize()
            })
            .collect();
        assert_same_weight(&Sphere, &ends);
        let halves: Vec<_> = (0..90)
            .map(|k| UnitQuaternion::from_scaled_axis(Vector3::y() * (side(k) + spread * numbers.next())))
            .collect();
        assert_same_weight(&So3, &halves);
        // There and back in the plane, facing forward both times.
        let lawn = (0..200).map(|k| {
            let wobble = spread * numbers.next();
            Isometry2::new(Vector2::new(f64::from(k / 2) * 0.01, wobble), side(k as usize) + wobble)
        });
        assert_same_weight(&Se2::default(), &lawn.collect::<Vec<_>>());
    }
}

#[test]
fn ties_are_decided_by_the_smaller_rows() {
    // Integers: all squares are exact, so that ties are ties in either algorithm.
    let scramble = |k: u32, n: u32| (k * 7919) % n;
    let grid: Vec<_> = (0..1000)
        .map(|k| scramble(k, 1000))
        .map(|k| Vector3::new(f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)))
        .collect();
    assert_same_tree(&R3::default(), &grid);
    let line: Vec<_> = (0..500).map(|k| Vector3::new(1.0, 2.0, 3.0) * f64::from(scramble(k, 500))).collect();
    assert_same_tree(&R3::default(), &line);
    // Steps of equal angle tie up to rounding only.
    let circle: Vec<_> = (0..360).map(|k| UnitComplex::new(f64::from(scramble(k, 360)).to_radians())).collect();
    assert_same_weight(&So2, &circle);
    let stepped = (0..360)
        .map(|k| f64::from(scramble(k, 360)))
        .map(|k| Isometry3::new(Vector3::x() * (k * 0.01), Vector3::z() * k.to_radians()));
    assert_same_weight(&Se3::default(), &stepped.collect::<Vec<_>>());
}

#[test]
fn repeated_points_hang_on_their_first_row() {
    let mut numbers = Numbers(5);
    let seeds: Vec<_> =
        (0..40).map(|_| Isometry3::from_parts(numbers.vector::<3>().into(), numbers.rotation())).collect();
    let repeated: Vec<_> = (0..400)
        .map(|k| {
            let pose = seeds[(k * k + k / 3) % 40];
            let rotation = if k.is_multiple_of(3) { -pose.rotation.into_inner() } else { pose.rotation.into_inner() };
            Isometry3::from_parts(pose.translation, UnitQuaternion::new_unchecked(rotation))
        })
        .collect();
    assert_same_tree(&Se3::default(), &repeated);
    assert_same_tree(&R3::default(), &repeated.iter().map(|p| p.translation.vector).collect::<Vec<_>>());
    let identical = vec![seeds[0]; 300];
    assert_same_tree(&Se3::default(), &identical);
    let [searched, _] = trees(&Se3::default(), &identical);
    assert_eq!(searched, (1..300).map(|row| [0, row]).collect::<Vec<_>>());
}

#[test]
fn zeros_of_either_sign_are_equal() {
    let zeros: Vec<_> = (0..100).map(|k| Vector2::new(if k % 2 == 0 { 0.0 } else { -0.0 }, 1.0)).collect();
    let [searched, _] = trees(&R2::default(), &zeros);
    assert_eq!(searched, (1..100).map(|row| [0, row]).collect::<Vec<_>>());
}

#[test]
fn distances_that_overflow_are_refused_as_by_prim() {
    let mut numbers = Numbers(6);
    // Two heaps whose own distances are numbers, and whose distance is none.
    let mut heaps: Vec<_> = (0..200).map(|k| Vector3::x() * if k < 70 { 1e200 } else { -1e200 }).collect();
    heaps.iter_mut().for_each(|p| *p += numbers.vector::<3>() * 1e150);
    let expected = crate::OrderError::DistanceOverflow { at: [0, 70] };
    assert_eq!(minimum_spanning_tree(&R3::default(), &heaps).unwrap_err(), expected);
    let few: Vec<_> = heaps.iter().take(20).chain(&heaps[70..90]).copied().collect();
    let expected = crate::OrderError::DistanceOverflow { at: [0, 20] };
    assert_eq!(minimum_spanning_tree(&R3::default(), &few).unwrap_err(), expected);
    // A vector without a direction is left to the dense algorithm.
    let mut directions: Vec<_> = (0..100).map(|_| numbers.vector::<3>().normalize()).collect();
    directions[50] = Vector3::zeros();
    assert!(Coordinates::of(&Sphere, &directions).is_none());
    assert_eq!(minimum_spanning_tree(&Sphere, &directions).unwrap().edge_count(), 99);
}

#[test]
fn one_answer_on_any_number_of_threads() {
    let mut numbers = Numbers(7);
    let poses: Vec<_> = (0..20_000)
        .map(|_| Isometry3::from_parts(numbers.vector::<3>().into(), numbers.rotation_on_turn(0.01)))
        .collect();
    let edges = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let tree = pool.install(|| minimum_spanning_tree(&Se3::default(), &poses)).unwrap();
        let edges = tree.raw_edges().iter();
        edges.map(|edge| (edge.source(), edge.target(), edge.weight.to_bits())).collect::<Vec<_>>()
    };
    let alone = edges(1);
    assert_eq!(alone.len(), poses.len() - 1);
    for threads in [2, 2, 3, 4] {
        assert!(edges(threads) == alone, "{threads} threads");
    }
}

/// On one thread, and on that thread without vector instructions.
fn plainly<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        PLAIN.set(true);
        work()
    })
}

#[test]
fn without_vector_instructions_the_tree_is_the_same() {
    let bits = |points: &[Vector3<f64>]| {
        let tree = minimum_spanning_tree(&R3::default(), points).unwrap();
        tree.raw_edges().iter().map(|e| (e.source(), e.target(), e.weight.to_bits())).collect::<Vec<_>>()
    };
    // Squares and sums of integers are exact however they are rounded: not one bit differs, ties and all.
    let mut numbers = Numbers(8);
    let grid: Vec<_> = (0..3000).map(|_| (numbers.vector::<3>() * 100.0).map(f64::round)).collect();
    assert_eq!(bits(&grid).len(), 2999);
    assert!(plainly(|| bits(&grid)) == bits(&grid));
    let points: Vec<_> = (0..1000).map(|_| numbers.vector::<3>()).collect();
    let poses: Vec<_> = points.iter().map(|p| Isometry3::from_parts((*p).into(), numbers.rotation())).collect();
    plainly(|| {
        assert_same_tree(&R3::default(), &points);
        assert_same_tree(&Se3::default(), &poses);
    });
}
