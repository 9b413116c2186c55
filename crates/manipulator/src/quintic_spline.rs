//! The C⁴ quintic spline through configurations.

use nalgebra::{DVector, Matrix2, Matrix2xX};

use crate::error::{ManipulatorError, Result};
use crate::quintic::Quintic;

/// First and second derivative at one end of a spline, each of shape (dof).
#[derive(Debug, Clone, PartialEq)]
pub struct EndDerivatives {
    /// dq/ds.
    pub first: DVector<f64>,
    /// d²q/ds².
    pub second: DVector<f64>,
}

/// A piecewise quintic q(s) with four continuous derivatives that passes given configurations.
///
/// First and second derivatives are given at both ends (the "complete" spline), which makes it sixth order accurate everywhere.
#[derive(Debug, Clone)]
pub(crate) struct QuinticSpline {
    knots: Vec<f64>,
    /// Per segment, one polynomial a joint.
    segments: Vec<Vec<Quintic>>,
}

impl QuinticSpline {
    pub(crate) fn through(knots: &[f64], values: &[DVector<f64>], ends: [&EndDerivatives; 2]) -> Result<Self> {
        check(knots, values, ends)?;
        let n = knots.len();
        let dof = values[0].len();
        // In units of the mean spacing both kinds of unknowns are of the size of the data.
        let unit = (knots[n - 1] - knots[0]) / (n - 1) as f64;
        let lengths: Vec<f64> = knots.windows(2).map(|k| (k[1] - k[0]) / unit).collect();
        let derivatives = solve(&lengths, values, ends, unit)
            .filter(|d| d.iter().all(|block| block.iter().all(|x| x.is_finite())))
            .ok_or(ManipulatorError::SplineSingular)?;
        let segments = (0..n - 1)
            .map(|i| {
                let h = knots[i + 1] - knots[i];
                (0..dof)
                    .map(|j| {
                        let state = |k: usize| {
                            let d = &derivatives[k];
                            [values[k][j], d[(0, j)] / unit, d[(1, j)] / (unit * unit)]
                        };
                        Quintic::hermite(h, state(i), state(i + 1))
                    })
                    .collect()
            })
            .collect();
        Ok(Self { knots: knots.to_vec(), segments })
    }

    pub(crate) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// q and its first three derivatives; beyond the ends the spline stays at its end.
    pub(crate) fn at(&self, s: f64) -> [DVector<f64>; 4] {
        let (segment, local) = self.place(s);
        self.in_segment(segment, local)
    }

    /// The polynomials of the segment in which `s` lies, one a joint, and how far into it.
    pub(crate) fn polynomials_at(&self, s: f64) -> (&[Quintic], f64) {
        let (segment, local) = self.place(s);
        (&self.segments[segment], local)
    }

    fn place(&self, s: f64) -> (usize, f64) {
        let n = self.knots.len();
        let s = s.clamp(self.knots[0], self.knots[n - 1]);
        let segment = self.knots.partition_point(|&k| k <= s).clamp(1, n - 1) - 1;
        (segment, s - self.knots[segment])
    }

    /// The polynomials of a segment, one a joint.
    pub(crate) fn polynomials(&self, segment: usize) -> &[Quintic] {
        &self.segments[segment]
    }

    /// The same spline, moved by a constant.
    pub(crate) fn moved_by(mut self, offset: &DVector<f64>) -> Self {
        for segment in &mut self.segments {
            segment.iter_mut().zip(offset.iter()).for_each(|(polynomial, by)| polynomial.move_by(*by));
        }
        self
    }

    pub(crate) fn in_segment(&self, segment: usize, local: f64) -> [DVector<f64>; 4] {
        let polynomials = &self.segments[segment];
        let mut values = [(); 4].map(|()| DVector::zeros(polynomials.len()));
        for (j, polynomial) in polynomials.iter().enumerate() {
            for (value, d) in values.iter_mut().zip(polynomial.at(local)) {
                value[j] = d;
            }
        }
        values
    }
}

fn check(knots: &[f64], values: &[DVector<f64>], ends: [&EndDerivatives; 2]) -> Result<()> {
    let wrong = |what, expected, given| Err(ManipulatorError::WrongSize { what, expected, given });
    if knots.len() < 2 || knots.len() != values.len() {
        return wrong("the list of path parameters", values.len().max(2), knots.len());
    }
    let dof = values[0].len();
    for q in values.iter().chain(ends.iter().flat_map(|e| [&e.first, &e.second])) {
        if q.len() != dof {
            return wrong("a configuration of the path", dof, q.len());
        }
        if !q.iter().all(|x| x.is_finite()) {
            return Err(ManipulatorError::NonFinite { what: "the joint path" });
        }
    }
    let out_of_order = |(_, k): &(usize, &[f64])| !(k[0].is_finite() && k[1].is_finite() && k[1] > k[0]);
    match knots.windows(2).enumerate().find(out_of_order) {
        Some((i, k)) => Err(ManipulatorError::ParametersNotIncreasing { index: i + 1, value: k[1] }),
        None => Ok(()),
    }
}

/// First and second derivatives at every knot, rows of a 2 × dof matrix, such that third and fourth derivatives are continuous.
///
/// With Δ the difference of values over a segment of length h, v and w first and second derivatives at its ends:
/// h³q‴(0) = 60Δ − h(36v₀ + 24v₁) − h²(9w₀ − 3w₁), h³q‴(h) = 60Δ − h(24v₀ + 36v₁) − h²(3w₀ − 9w₁),
/// h⁴q⁗(0) = −360Δ + h(192v₀ + 168v₁) + h²(36w₀ − 24w₁), h⁴q⁗(h) = 360Δ − h(168v₀ + 192v₁) − h²(24w₀ − 36w₁).
fn solve(
    lengths: &[f64],
    values: &[DVector<f64>],
    ends: [&EndDerivatives; 2],
    unit: f64,
) -> Option<Vec<Matrix2xX<f64>>> {
    let n = values.len();
    let end_rows = |end: &EndDerivatives| {
        let second = &end.second * (unit * unit);
        Matrix2xX::from_rows(&[(&end.first * unit).transpose(), second.transpose()])
    };
    let mut ratios = vec![Matrix2::zeros(); n];
    let mut solution = vec![end_rows(ends[0])];
    for i in 1..n - 1 {
        let (l, r) = (lengths[i - 1], lengths[i]);
        let (l2, l3, l4) = (l.powi(-2), l.powi(-3), l.powi(-4));
        let (r2, r3, r4) = (r.powi(-2), r.powi(-3), r.powi(-4));
        let lower = Matrix2::new(-24.0 * l2, -3.0 / l, -168.0 * l3, -24.0 * l2);
        let diagonal = Matrix2::new(36.0 * (r2 - l2), 9.0 / l + 9.0 / r, -192.0 * (l3 + r3), 36.0 * (l2 - r2));
        let upper = Matrix2::new(24.0 * r2, -3.0 / r, -168.0 * r3, 24.0 * r2);
        let left = &values[i] - &values[i - 1];
        let right = &values[i + 1] - &values[i];
        let third = (&right * (60.0 * r3) - &left * (60.0 * l3)).transpose();
        let fourth = (&right * (-360.0 * r4) - &left * (360.0 * l4)).transpose();
        let target = Matrix2xX::from_rows(&[third, fourth]) - lower * &solution[i - 1];
        let pivot = (diagonal - lower * ratios[i - 1]).try_inverse()?;
        ratios[i] = pivot * upper;
        solution.push(pivot * target);
    }
    solution.push(end_rows(ends[1]));
    for i in (1..n - 1).rev() {
        let next = solution[i + 1].clone();
        solution[i] -= ratios[i] * next;
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sin(2s + j) with its derivatives.
    fn wave(s: f64, order: i32) -> DVector<f64> {
        let phase = std::f64::consts::FRAC_PI_2 * f64::from(order);
        DVector::from_fn(3, |j, _| 2.0_f64.powi(order) * (2.0 * s + j as f64 + phase).sin())
    }

    /// Through samples of the wave on uneven knots: neighbouring spacings differ by up to a factor two.
    fn spline(n: usize) -> QuinticSpline {
        let warp = |u: f64| 3.0 * (u + 0.1 * (9.0 * u).sin() / 3.0);
        let knots: Vec<f64> = (0..=n).map(|i| warp(i as f64 / n as f64)).collect();
        let values: Vec<_> = knots.iter().map(|&s| wave(s, 0)).collect();
        let end = |s: f64| EndDerivatives { first: wave(s, 1), second: wave(s, 2) };
        QuinticSpline::through(&knots, &values, [&end(knots[0]), &end(knots[n])]).unwrap()
    }

    #[test]
    fn four_derivatives_are_continuous_at_every_knot() {
        let spline = spline(17);
        for i in 1..17 {
            let h = spline.knots[i] - spline.knots[i - 1];
            let (left, right) = (spline.in_segment(i - 1, h), spline.in_segment(i, 0.0));
            for joint in 0..3 {
                for order in 0..4 {
                    // Differences of sines over spacings of 0.1, to the third power: some rounding over 1e-3.
                    assert!((left[order][joint] - right[order][joint]).abs() < 1e-11, "order {order}");
                }
                let [before, after] = [(i - 1, h), (i, 0.0)].map(|(k, t)| spline.segments[k][joint].fourth_at(t));
                assert!((before - after).abs() < 1e-9, "{before} {after}");
            }
        }
    }

    #[test]
    fn sixth_order_in_value_and_third_in_the_third_derivative() {
        let error = |n: usize, order: usize| {
            let spline = spline(n);
            let last = spline.knots[n];
            let at = |i: usize| last * i as f64 / 997.0;
            (0..=997).map(|i| (&spline.at(at(i))[order] - wave(at(i), order as i32)).amax()).fold(0.0, f64::max)
        };
        for (order, power) in [(0, 6), (1, 5), (2, 4), (3, 3)] {
            let slope = (error(20, order) / error(40, order)).log2();
            // The greatest error moves about among the uneven segments, which leaves a third of an order to chance.
            assert!((slope - f64::from(power)).abs() < 0.35, "derivative {order}: order {slope}");
        }
    }

    #[test]
    fn ends_have_the_given_derivatives_and_two_knots_suffice() {
        for n in [1, 2, 9] {
            let spline = spline(n);
            for s in [spline.knots[0], spline.knots[n]] {
                for order in 0..3 {
                    assert!((&spline.at(s)[order] - wave(s, order as i32)).amax() < 1e-11);
                }
            }
        }
    }
}
