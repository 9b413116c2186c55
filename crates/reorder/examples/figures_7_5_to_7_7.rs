//! Thesis Figures 7.5 to 7.7: shuffled frames in SE(3), put in order by the distance (4.17) and interpolated by the partial
//! geodesic scheme (slerp, and the closed cubic spline of eq. 6.10) with two granularities.

#[allow(dead_code)]
#[path = "../../se3-geom/examples/drawing/mod.rs"]
mod drawing;
#[path = "shuffled/mod.rs"]
mod shuffled;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use drawing::{Panel, View, gallery_path, write};
use plotters::style::BLACK;
use reorder::{Options, Ordering, order_poses};
use se3_geom::nalgebra::{UnitQuaternion, Vector3};
use se3_geom::{CubicEnds, Curve, PartialGeodesic, Pose, Se3, centripetal_knots};
use shuffled::{follows, shuffle};

const FRAMES: usize = 30;
/// Poses that are drawn of each interpolation.
const GRANULARITIES: [usize; 2] = [90, 360];

/// The experiment.
pub(crate) struct Numbers {
    /// The frames, shuffled.
    pub(crate) poses: Vec<Pose>,
    /// Their recovered order.
    pub(crate) ordering: Ordering,
    /// Whether that is the order along the curve.
    pub(crate) recovered: bool,
    /// The interpolated curve, coarse and fine.
    pub(crate) interpolated: [Vec<Pose>; 2],
    /// Greatest distance of a frame from the curve at its knot, in metres and radians at once.
    pub(crate) miss: f64,
}

/// The closed curve at u ∈ \[0, 1\]: a saddle-shaped loop of 2 m, on which the frame tips and turns.
fn frame(u: f64) -> Pose {
    let a = TAU * u;
    let position = Vector3::new(2.0 * a.cos(), 2.0 * a.sin(), 0.5 * (2.0 * a).cos());
    Pose::from_parts(position.into(), UnitQuaternion::from_euler_angles(0.6 * a.sin(), 0.5 * a.cos(), a))
}

/// Shuffles, orders and interpolates.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let places = shuffle(FRAMES, 75);
    let poses: Vec<_> = places.iter().map(|&k| frame(k as f64 / FRAMES as f64)).collect();
    let ordering = order_poses(&poses, 1.0, &Options::default())?;
    let recovered = follows(&ordering, &places, true);
    let mut closed: Vec<Pose> = ordering.order.iter().map(|&row| poses[row]).collect();
    closed.push(closed[0]);
    let knots = centripetal_knots(&Se3::default(), &closed);
    closed.pop();
    let curve = PartialGeodesic::through(&closed, &knots, CubicEnds::Periodic)?;
    let (first, last) = curve.domain();
    let sample = |n: usize| (0..=n).map(|k| curve.point(first + (last - first) * k as f64 / n as f64)).collect();
    let apart = |(pose, &knot): (&Pose, &f64)| {
        let there = curve.point(knot);
        (there.translation.vector - pose.translation.vector).norm() + there.rotation.angle_to(&pose.rotation)
    };
    let miss = closed.iter().zip(&knots).map(apart).fold(0.0, f64::max);
    Ok(Numbers { interpolated: GRANULARITIES.map(sample), poses, ordering, recovered, miss })
}

/// The frames without order, then the curve with its frames, coarse and fine.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let view = View::from_angles(0.5, 0.6);
    let mut sample = Panel::new("Figure 7.5: a sample of a curve in SE(3)");
    for pose in &numbers.poses {
        sample.frame(&view, pose, 0.4);
    }
    let interpolation = |title: &str, poses: &[Pose]| {
        let mut panel = Panel::new(title);
        panel.line(poses.iter().map(|p| view.project(&p.translation.vector)), BLACK, "");
        for pose in poses {
            panel.frame(&view, pose, 0.3);
        }
        panel
    };
    let [coarse, fine] = &numbers.interpolated;
    let coarse = interpolation("Figure 7.6: the reconstructed curve", coarse);
    write(&[sample, coarse, interpolation("Figure 7.7: finer", fine)], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    println!("recovered {}, {:?}", numbers.recovered, numbers.ordering.verdict);
    println!("epsilon {:?}, the curve misses its frames by {:.1e}", numbers.ordering.certificate.epsilon, numbers.miss);
    let path = gallery_path("figures_7_5_to_7_7")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}
