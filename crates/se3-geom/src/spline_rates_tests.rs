//! Where the equations of the rates are hardly solved, or not.

use super::*;

/// Newton with a poor matrix, here one without the couplings, converges slowly (its error shrinks by cos(π/(n + 1))/2 a step) and
/// runs out of steps at defects of every size. Only what keeps far inside the promised 1e-11 may pass for a solution, and the
/// others are refused with the defect that is left.
#[test]
fn a_defect_that_stays_is_no_solution() {
    let (mut solved, mut near_misses) = (0, 0);
    for unknown in 1..14 {
        let turn = |i: usize| Vector3::new((i as f64).sin(), (2.0 * i as f64).cos(), 0.3);
        let segments = (0..=unknown).map(|i| Segment::new(&turn(i), 1.0)).collect();
        let equations = Equations { segments, knots: unknown + 2, unknown: 1..unknown + 1 };
        let mut poor = BlockTridiagonal::new(unknown, vec![Matrix3::zeros(); unknown - 1]);
        match equations.newton(&mut poor, vec![Vector3::zeros(); unknown + 2], 0.0) {
            Ok(rates) => {
                let mut found = Trial::new(rates);
                equations.evaluate(&mut found, 0.0);
                assert!(found.worst < 5e-12, "{unknown}: {:e}", found.worst);
                solved += 1;
            }
            Err(residual) => {
                assert!((1e-12..1e-6).contains(&residual), "{unknown}: {residual:e}");
                near_misses += usize::from(residual < 1e-9);
            }
        }
    }
    assert!(solved >= 3 && near_misses >= 2, "{solved} {near_misses}");
}
