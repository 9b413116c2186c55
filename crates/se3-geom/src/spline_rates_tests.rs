//! Where the equations of the rates are hardly solved, or not.

use super::*;

fn residual_of(turns: &[Vector3<f64>], lengths: &[f64], ends: [Vector3<f64>; 2]) -> Result<f64, f64> {
    let segments = turns.iter().zip(lengths).map(|(theta, &h)| Segment::new(theta, h)).collect();
    let knots = turns.len() + 1;
    let equations = Equations { segments, knots, unknown: 1..knots - 1 };
    let mut rates = vec![Vector3::zeros(); knots];
    (rates[0], rates[knots - 1]) = (ends[0], ends[1]);
    let mut solved = Trial::new(equations.solve(rates)?);
    equations.evaluate(&mut solved, 1.0);
    Ok(solved.worst)
}

/// The rate of a knot may vanish while its neighbours' do not: what rounding leaves there is relative to theirs.
#[test]
fn a_rate_that_vanishes_between_great_ones_is_solved() {
    let great = Vector3::new(1.0, 0.3, 0.2);
    for (first, second) in [(0.1, 0.3), (0.1, 0.7), (0.37, 0.11)] {
        // ω₀/h₀ + ω₂/h₁ = 0 up to rounding, which is all that determines ω₁.
        let ends = [great, great * (-second / first)];
        residual_of(&[Vector3::zeros(); 2], &[first, second], ends).unwrap_or_else(|left| panic!("{first}: {left:e}"));
    }
}

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
