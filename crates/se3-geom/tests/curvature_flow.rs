//! Curvature flow with fixed ends (thesis Example 4.1).
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};
use se3_geom::{CurvatureFlow, FlowError, nalgebra};

/// An arch of a sine over [0, 1], at equal steps of x.
fn arch(height: f64, edges: u32) -> CurvatureFlow<2> {
    let x = |i: u32| f64::from(i) / f64::from(edges);
    CurvatureFlow::new((0..=edges).map(|i| Vector2::new(x(i), height * (PI * x(i)).sin())).collect()).unwrap()
}

/// A low arch decays as exp(−π²t). With n edges and the step τ the scheme's own factor is (1 + τλ)⁻¹ a step,
/// λ = 4n²·sin²(π/2n); the slope's square, 1e-9, is left out. With τ ∝ n⁻² the error against the exponential is of second order.
#[test]
fn a_low_arch_decays_exponentially() {
    let (height, end) = (1e-5, 0.1);
    let errors = [8_u32, 16, 32, 64].map(|edges| {
        let steps = edges * edges / 8;
        let tau = end / f64::from(steps);
        let mut flow = arch(height, edges);
        for _ in 0..steps {
            flow.advance(tau).unwrap();
        }
        let amplitude = flow.points()[edges as usize / 2].y / height;
        let n = f64::from(edges);
        let eigenvalue = 4.0 * n * n * (PI / (2.0 * n)).sin().powi(2);
        let of_the_scheme = (1.0 + tau * eigenvalue).powi(-(steps as i32));
        assert!((amplitude / of_the_scheme - 1.0).abs() < 1e-8, "{edges}: {amplitude} {of_the_scheme}");
        assert!((flow.time() - end).abs() < 1e-12);
        (amplitude - (-PI * PI * end).exp()).abs()
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.9..2.2).contains(&order), "{order} {errors:?}");
    }
}

/// A high arch: the area under it shrinks by the angle that the tangent turns, ∫κ ds, whatever the height. The turn is read off
/// the end edges, where the curve has no curvature (error l²), and integrated by the trapezoidal rule along with the scheme's
/// own error of first order in τ: of the 0.13 rad·s of the integral at the relative size τ·λ = 0.1 % · π².
#[test]
fn a_high_arch_loses_area_at_the_rate_of_its_turn() {
    let mut flow = arch(0.5, 200);
    let area = |flow: &CurvatureFlow<2>| -> f64 {
        flow.points().windows(2).map(|pair| 0.5 * (pair[0].y + pair[1].y) * (pair[1].x - pair[0].x)).sum()
    };
    let turn = |flow: &CurvatureFlow<2>| {
        let points = flow.points();
        let slope = |p: Vector2<f64>, q: Vector2<f64>| (q - p).y.atan2((q - p).x);
        slope(points[0], points[1]) - slope(points[199], points[200])
    };
    let (before, tau) = (area(&flow), 1e-4);
    let mut lost = 0.0;
    for _ in 0..1000 {
        let turn_before = turn(&flow);
        flow.advance(tau).unwrap();
        lost += 0.5 * tau * (turn_before + turn(&flow));
    }
    let difference = before - area(&flow);
    assert!(difference > 0.1, "{difference}");
    assert!((difference - lost).abs() < 1e-2 * lost, "{difference} {lost}");
}

/// Every step shortens, by as much as the movements say, however rough the curve and large the step; the limit is the segment.
#[test]
fn every_step_shortens_to_the_segment() {
    let (p, q) = (Vector3::new(0.0, 0.0, 0.0), Vector3::new(1.0, 1.0, 0.0));
    for step in [1e-5, 1e-2, 1.0, 1e6] {
        let noise = |i: usize, k: f64| ((i as f64 * k).sin() * 43758.5453).fract() - 0.5;
        let inner = (1..60).map(|i| Vector3::new(noise(i, 12.9898), noise(i, 78.233), noise(i, 37.719)));
        let mut flow = CurvatureFlow::new(std::iter::once(p).chain(inner).chain([q]).collect()).unwrap();
        for _ in 0..30 {
            let old = flow.clone();
            flow.advance(step).unwrap();
            assert_eq!((flow.points()[0], flow.points()[60]), (p, q));
            let edges: Vec<f64> = old.points().windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
            let moved = |i: usize| (flow.points()[i] - old.points()[i]).norm_squared();
            let at_least: f64 = (1..60).map(|i| 0.5 * (edges[i - 1] + edges[i]) * moved(i) / step).sum();
            // But for rounding, of 60 edges.
            assert!(flow.length() <= old.length() - at_least + 1e-13 * old.length(), "{step}");
        }
        if step >= 1.0 {
            assert!((flow.length() - 2f64.sqrt()).abs() < 1e-12);
            let off = flow.points().iter().map(|x| (x.x - x.y).abs().max(x.z.abs())).fold(0.0, f64::max);
            assert!(off < 1e-9, "{off}");
        }
    }
}

/// A curve that doubles back is drawn together: 2 − 1 over 1 + 2·1e20 vanishes in 1. And a step of 1e250 over edges of 1e-100
/// overflows. Either way the flow stays as it was.
#[test]
fn a_step_that_leaves_no_curve_is_refused() {
    let on_a_line = |x: [f64; 3]| CurvatureFlow::new(x.map(|x| Vector2::new(x, 0.0)).to_vec()).unwrap();
    let [mut doubling_back, mut tiny] = [on_a_line([1.0, 2.0, 1.0]), on_a_line([0.0, 1e-100, 3e-100])];
    let before = (doubling_back.clone(), tiny.clone());
    assert_eq!(doubling_back.advance(1e20), Err(FlowError::Coincident { index: 0, time: 1e20 }));
    assert!(matches!(tiny.advance(1e250), Err(FlowError::NonFinitePoint { .. })));
    assert_eq!((doubling_back, tiny), before);
}

/// Curves that do not flow.
#[test]
fn refuses_what_is_no_curve() {
    let point = |x: f64| Vector2::new(x, 0.0);
    assert_eq!(CurvatureFlow::new(vec![point(0.0)]), Err(FlowError::TooFewPoints { given: 1 }));
    let twice = CurvatureFlow::new([0.0, 1.0, 1.0].map(point).to_vec());
    assert_eq!(twice, Err(FlowError::Coincident { index: 1, time: 0.0 }));
    assert_eq!(CurvatureFlow::new([0.0, f64::NAN].map(point).to_vec()), Err(FlowError::NonFinitePoint { index: 1 }));
    let mut flow = arch(0.1, 4);
    let before = flow.clone();
    for step in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(flow.advance(step), Err(FlowError::Step { step }));
    }
    assert!(matches!(flow.advance(f64::NAN), Err(FlowError::Step { .. })));
    assert_eq!(flow, before);
}
