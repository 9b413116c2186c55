//! Any coordinates on several spaces: an error, or every row once. Bytes make coarse numbers, so that ties, duplicates and
//! collinear points are common, and now and then an extreme one.
#![no_main]

use libfuzzer_sys::fuzz_target;
use reorder::{Options, OrderError, Ordering, Repair, TopologyChoice, order, order_poses};
use se3_geom::nalgebra::{Quaternion, UnitQuaternion, Vector2, Vector3};
use se3_geom::{Pose, R2, R3, So3, Sphere};

fn number(byte: u8) -> f64 {
    match byte {
        255 => f64::NAN,
        254 => f64::INFINITY,
        253 => f64::MAX,
        252 => f64::MIN_POSITIVE,
        251 => 1e-160,
        250 => -1e155,
        _ => f64::from(byte as i8) / 16.0,
    }
}

fn rotation([x, y, z]: [f64; 3]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(0.3, x, y, z))
}

fn judge(n: usize, answer: Result<Ordering, OrderError>) {
    let Ok(ordering) = answer else { return };
    let mut rows = ordering.order.clone();
    rows.sort_unstable();
    assert!(rows.into_iter().eq(0..n), "{ordering:?}");
    assert!(ordering.certificate.max_gap.is_finite());
    for doubt in &ordering.doubts {
        assert!(doubt.at.iter().all(|&row| row < n));
    }
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&[space, choices, start], coordinates)) = bytes.split_first_chunk::<3>() else { return };
    if coordinates.len() > 600 {
        return;
    }
    let topology = [TopologyChoice::Auto, TopologyChoice::Open, TopologyChoice::Closed][usize::from(choices % 3)];
    let start = (choices & 4 != 0).then_some(usize::from(start));
    // The search of a repair costs as much as hundreds of trees: every eighth choice, of few points.
    let repair = if choices & 56 == 8 && coordinates.len() < 90 { Repair::Auto } else { Repair::Off };
    let options = Options { topology, start, repair, denoise: choices & 64 != 0, ..Options::default() };
    let numbers: Vec<f64> = coordinates.iter().map(|&byte| number(byte)).collect();
    let triples = || numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]);
    match space % 5 {
        0 => {
            let points: Vec<_> = numbers.chunks_exact(2).map(|c| Vector2::new(c[0], c[1])).collect();
            judge(points.len(), order(&R2::default(), &points, &options));
        }
        1 => {
            let points: Vec<_> = triples().map(Vector3::from).collect();
            judge(points.len(), order(&R3::default(), &points, &options));
        }
        2 => {
            let points: Vec<_> = triples().map(|c| Vector3::from(c).normalize()).collect();
            judge(points.len(), order(&Sphere, &points, &options));
        }
        3 => {
            let points: Vec<_> = triples().map(rotation).collect();
            judge(points.len(), order(&So3, &points, &options));
        }
        _ => {
            let pose =
                |c: &[f64]| Pose::from_parts(Vector3::new(c[0], c[1], c[2]).into(), rotation([c[3], c[4], c[5]]));
            let poses: Vec<_> = numbers.chunks_exact(6).map(pose).collect();
            judge(poses.len(), order_poses(&poses, 0.1, &options));
        }
    }
});
