//! x
mod support;
use manipulator::*;
use nalgebra::*;
use se3_geom::*;
#[test]
fn stress() {
    let robot = support::ur5e();
    let mut random = support::Random(99);
    for k in 0..40 {
        // a board somewhere around the arm, pen tilted, noisy poses
        let az = random.between(-3.0, 3.0);
        let r = random.between(0.3, 0.6);
        let z = random.between(0.05, 0.5);
        let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(
            random.between(-0.6, 0.6),
            random.between(-0.6, 0.6),
            random.between(-3.0, 3.0),
        ));
        let center = Vector3::new(r * f64::cos(az), r * f64::sin(az), z);
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let board = Isometry3::from_parts(center.into(), down * tilt);
        let noise = if k % 2 == 0 { 0.0 } else { 2e-4 };
        let (a, b, c) = (random.between(1.0, 3.0), random.between(1.0, 4.0), random.between(0.0, 3.0));
        let poses: Vec<Pose> = (0..300)
            .map(|i| {
                let u = i as f64 / 299.0 * 6.28;
                let p = Vector3::new(
                    0.1 * (a * u).sin() + noise * random.between(-1.0, 1.0),
                    0.1 * (b * u + c).sin() + noise * random.between(-1.0, 1.0),
                    0.0,
                );
                let lean =
                    UnitQuaternion::from_scaled_axis(Vector3::new(0.25 * (a * u).cos(), 0.25 * (b * u + c).cos(), 0.0));
                board * Isometry3::from_parts(p.into(), lean)
            })
            .collect();
        let curve = support::curves::spline(&poses);
        let t = std::time::Instant::now();
        let start = if k % 3 == 0 { None } else { Some(&robot.preferred) };
        match follow(&robot, &curve, start, &PathOptions::default()) {
            Err(e) => println!("{k}: {e} {:.2} (az {az:.2} r {r:.2} z {z:.2})", t.elapsed().as_secs_f64()),
            Ok(path) => {
                let f = t.elapsed().as_secs_f64();
                let t = std::time::Instant::now();
                match time_path(&robot, &path, &TimingOptions::default()) {
                    Err(e) => println!("{k}: timing {e}"),
                    Ok(timed) => println!(
                        "{k}: noise {noise} follow {f:.2} time {:.2} knots {} T {:.2} ra {:.2} {:?} {}",
                        t.elapsed().as_secs_f64(),
                        path.knots().len(),
                        timed.trajectory.duration_s(),
                        timed.second_order_duration_s,
                        timed.audit.max_ratio,
                        timed.audit.limits_ok
                    ),
                }
            }
        }
    }
}
