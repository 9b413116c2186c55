//! Thesis Figure 6.1: between two frames of SE(3), the geodesic, which knows no velocities, and de Casteljau's curve, which
//! leaves and arrives with given ones (eq. 6.15).

#[allow(dead_code)]
mod drawing;

use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use drawing::{Panel, View, gallery_path, write};
use plotters::style::{BLACK, CYAN, MAGENTA};
use se3_geom::nalgebra::Vector3;
use se3_geom::{
    Bezier, Curve, Derivatives, Geodesic, JetSpace, LieGroup, Manifold, Pose, Se3, Se3Group, So3Group, Twist,
    arc_length,
};

/// Poses computed of each curve, less one; a frame drawn every so many.
pub(crate) const STEPS: u32 = 60;
const FRAME_EVERY: usize = 6;

/// One curve of the figure.
pub(crate) struct Interpolation {
    /// Its poses at even steps of t from 0 to 1.
    pub(crate) poses: Vec<Pose>,
    /// The body twists with which it leaves and arrives.
    pub(crate) end_twists: [Twist; 2],
    /// Its length with one metre a radian.
    pub(crate) length: f64,
}

/// What the figure shows.
pub(crate) struct Numbers {
    /// g₀ = \[0, 0, 0\] ⋉ \[−5, 0, 0\] and g₁ = \[π/2, 0, 0\] ⋉ \[5, 0, 0\].
    pub(crate) frames: [Pose; 2],
    /// (ω, v) = (0, 0, 0, 3, 1, 1) and (π/2, 0, 0, −1, −3, −1), as body twists.
    pub(crate) given_twists: [Twist; 2],
    /// The exponential map: the geodesic of the product metric.
    pub(crate) geodesic: Interpolation,
    /// De Casteljau's construction with these geodesics.
    pub(crate) product: Interpolation,
    /// The same with the screw motions of the group, which the figure does not have.
    pub(crate) group: Interpolation,
    /// The distance of the frames.
    pub(crate) distance: f64,
}

fn interpolation(curve: &impl Curve<Point = Pose, Tangent = Twist>) -> Result<Interpolation, Box<dyn Error>> {
    let twist_at = |t| -> Twist {
        let Derivatives { velocity, .. } = curve.derivatives(t);
        velocity
    };
    Ok(Interpolation {
        poses: (0..=STEPS).map(|k| curve.point(f64::from(k) / f64::from(STEPS))).collect(),
        end_twists: [twist_at(0.0), twist_at(1.0)],
        length: arc_length(curve, &Se3::default())?,
    })
}

/// The three curves between the figure's frames.
pub(crate) fn compute() -> Result<Numbers, Box<dyn Error>> {
    let origin = |x: f64| Vector3::new(x, 0.0, 0.0);
    let frames = [Pose::from_parts(origin(-5.0).into(), So3Group::identity()), {
        Pose::from_parts(origin(5.0).into(), So3Group::exp(Vector3::x() * FRAC_PI_2))
    }];
    let given_twists = [
        Twist::new(Vector3::new(3.0, 1.0, 1.0), Vector3::zeros()),
        Twist::new(Vector3::new(-1.0, -3.0, -1.0), Vector3::x() * FRAC_PI_2),
    ];
    fn bezier<S>(space: S, frames: [Pose; 2], twists: [Twist; 2]) -> Result<Interpolation, Box<dyn Error>>
    where
        S: JetSpace<Point = Pose, Tangent = Twist>,
    {
        interpolation(&Bezier::from_end_velocities(space, frames, twists)?)
    }
    Ok(Numbers {
        frames,
        given_twists,
        geodesic: interpolation(&Geodesic::between(Se3::default(), frames[0], frames[1])?)?,
        product: bezier(Se3::default(), frames, given_twists)?,
        group: bezier(Se3Group, frames, given_twists)?,
        distance: Se3::default().distance(&frames[0], &frames[1]),
    })
}

/// The three lines of origins, with frames along them.
pub(crate) fn draw(numbers: &Numbers, path: &Path) -> Result<(), Box<dyn Error>> {
    let view = View::from_angles(-0.5, 0.35);
    let mut panel = Panel::new("Figure 6.1: geodesic and de Casteljau's curve in SE(3)");
    for (curve, colour, name) in [
        (&numbers.geodesic, BLACK, "geodesic"),
        (&numbers.product, MAGENTA, "de Casteljau"),
        (&numbers.group, CYAN, "de Casteljau with screws"),
    ] {
        let origins = curve.poses.iter().map(|pose| view.project(&pose.translation.vector));
        panel.line(origins, colour, &format!("{name}: {:.3}", curve.length));
        for pose in curve.poses.iter().step_by(FRAME_EVERY) {
            panel.frame(&view, pose, 0.4);
        }
    }
    panel.dots(numbers.frames.map(|pose| view.project(&pose.translation.vector)), BLACK);
    write(&[panel], path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = compute()?;
    println!("distance of the frames {:.12}", numbers.distance);
    print_twists("given", &numbers.given_twists);
    for (name, curve) in [
        ("geodesic", &numbers.geodesic),
        ("de Casteljau", &numbers.product),
        ("de Casteljau with screws", &numbers.group),
    ] {
        println!("{name}: length {:.12}", curve.length);
        print_twists(name, &curve.end_twists);
    }
    let path = gallery_path("figure_6_1")?;
    draw(&numbers, &path)?;
    println!("drawn to {}", path.display());
    Ok(())
}

fn print_twists(name: &str, twists: &[Twist; 2]) {
    for (when, twist) in ["leaving", "arriving"].iter().zip(twists) {
        println!("  {name}, {when}: ω = {:.6?}, v = {:.6?}", twist.angular.as_slice(), twist.linear.as_slice());
    }
}
