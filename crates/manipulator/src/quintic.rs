//! Quintic polynomials: Hermite form, exact extremes.

/// A polynomial of degree five on \[0, h\], coefficients in the scaled variable u = t/h ∈ \[0, 1\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Quintic {
    h: f64,
    coefficients: [f64; 6],
}

impl Quintic {
    /// The quintic with value, first and second derivative `from` at 0 and `to` at `h`.
    pub(crate) fn hermite(h: f64, from: [f64; 3], to: [f64; 3]) -> Self {
        let rise = to[0] - from[0];
        let (v0, v1) = (h * from[1], h * to[1]);
        let (w0, w1) = (0.5 * h * h * from[2], 0.5 * h * h * to[2]);
        let coefficients = [
            from[0],
            v0,
            w0,
            10.0 * rise - 6.0 * v0 - 4.0 * v1 - 3.0 * w0 + w1,
            -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 3.0 * w0 - 2.0 * w1,
            6.0 * rise - 3.0 * (v0 + v1) - w0 + w1,
        ];
        Self { h, coefficients }
    }

    /// Adds a constant.
    pub(crate) fn move_by(&mut self, offset: f64) {
        self.coefficients[0] += offset;
    }

    /// Value and first three derivatives at `t`.
    pub(crate) fn at(&self, t: f64) -> [f64; 4] {
        let (u, rate) = (t / self.h, self.h.recip());
        let [_, c1, c2, c3, c4, c5] = self.coefficients;
        [
            evaluate(&self.coefficients, u),
            evaluate(&[c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5], u) * rate,
            evaluate(&[2.0 * c2, 6.0 * c3, 12.0 * c4, 20.0 * c5], u) * rate.powi(2),
            evaluate(&[6.0 * c3, 24.0 * c4, 60.0 * c5], u) * rate.powi(3),
        ]
    }

    /// The fourth derivative at `t`.
    #[cfg(test)]
    pub(crate) fn fourth_at(&self, t: f64) -> f64 {
        (24.0 * self.coefficients[4] + 120.0 * self.coefficients[5] * t / self.h) * self.h.powi(-4)
    }

    /// ∫ from 0 to `t` of the polynomial's deviation from `reference`.
    pub(crate) fn integral_from(&self, reference: f64, t: f64) -> f64 {
        let u = t / self.h;
        let terms = self.coefficients.iter().enumerate().rev();
        let sum = terms.fold(0.0, |sum, (k, &c)| {
            let c = if k == 0 { c - reference } else { c };
            (sum + c / (k + 1) as f64) * u
        });
        sum * self.h
    }

    /// The derivative of an order in u, and the factor that makes it one in t.
    fn derivative(&self, order: usize) -> (Vec<f64>, f64) {
        let polynomial = (0..order).fold(self.coefficients.to_vec(), |polynomial, _| differentiate(&polynomial));
        (polynomial, self.h.recip().powi(order as i32))
    }

    /// Least and greatest value of the derivative of an order from 0 to 3 on \[0, h\], exactly but for rounding.
    pub(crate) fn range(&self, order: usize) -> (f64, f64) {
        // Extremes lie where the next derivative vanishes; each list of zeros brackets those of the derivative before.
        let zeros = (order + 1..5)
            .rev()
            .fold(Vec::new(), |turning_points, k| zeros_between(&self.derivative(k).0, &turning_points));
        let (polynomial, scale) = self.derivative(order);
        let values = zeros.iter().chain(&[0.0, 1.0]).map(|&u| evaluate(&polynomial, u) * scale);
        // A value that is no number must not vanish in a minimum.
        if values.clone().any(f64::is_nan) {
            return (f64::NAN, f64::NAN);
        }
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
    }

    /// Bounds of the derivative of an order from 0 to 3 on \[0, h\] that cost little: the least and greatest of its Bernstein
    /// coefficients, between which a polynomial stays. NaN where one of them is.
    pub(crate) fn hull(&self, order: usize) -> (f64, f64) {
        const CHOOSE: [[f64; 6]; 6] = [
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 2.0, 1.0, 0.0, 0.0, 0.0],
            [1.0, 3.0, 3.0, 1.0, 0.0, 0.0],
            [1.0, 4.0, 6.0, 4.0, 1.0, 0.0],
            [1.0, 5.0, 10.0, 10.0, 5.0, 1.0],
        ];
        let degree = 5 - order;
        let mut coefficients = self.coefficients;
        for _ in 0..order {
            for k in 0..5 {
                coefficients[k] = coefficients[k + 1] * (k + 1) as f64;
            }
        }
        let (mut least, mut greatest, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for (i, row) in CHOOSE.iter().enumerate().take(degree + 1) {
            let value: f64 = (0..=i).map(|j| coefficients[j] * row[j] / CHOOSE[degree][j]).sum();
            (least, greatest, sum) = (least.min(value), greatest.max(value), sum + value);
        }
        let scale = self.h.recip().powi(order as i32);
        if sum.is_nan() { (f64::NAN, f64::NAN) } else { (least * scale, greatest * scale) }
    }
}

fn evaluate(polynomial: &[f64], u: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, c| sum * u + c)
}

fn differentiate(polynomial: &[f64]) -> Vec<f64> {
    polynomial.iter().enumerate().skip(1).map(|(k, c)| c * k as f64).collect()
}

/// Where a polynomial vanishes in (0, 1), given the zeros of its derivative there: between two of those it is monotone.
fn zeros_between(polynomial: &[f64], turning_points: &[f64]) -> Vec<f64> {
    let mut zeros = Vec::new();
    let mut low = 0.0;
    for &high in turning_points.iter().chain(&[1.0]) {
        let rising = evaluate(polynomial, high) > evaluate(polynomial, low);
        let (mut a, mut b) = (low, high);
        if evaluate(polynomial, a) * evaluate(polynomial, b) < 0.0 {
            while b - a > 1e-15 {
                let middle = 0.5 * (a + b);
                if middle <= a || middle >= b {
                    break;
                }
                if (evaluate(polynomial, middle) > 0.0) == rising { b = middle } else { a = middle }
            }
            zeros.push(0.5 * (a + b));
        }
        low = high;
    }
    zeros
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hermite_takes_the_given_derivatives_at_both_ends() {
        let (from, to) = ([0.3, -1.1, 2.0], [-0.7, 0.4, -3.0]);
        let quintic = Quintic::hermite(0.37, from, to);
        let (start, end) = (quintic.at(0.0), quintic.at(0.37));
        for k in 0..3 {
            // Coefficients reach 15·1 + …; their derivatives by t grow by h⁻ᵏ ≤ 7.3: some hundred roundings of O(100).
            assert!((start[k] - from[k]).abs() < 1e-12 && (end[k] - to[k]).abs() < 1e-12);
        }
    }

    #[test]
    fn reproduces_a_quintic_with_its_third_derivative_and_its_integral() {
        let f = |t: f64| 1.0 - t + t.powi(3) - 2.0 * t.powi(5);
        let state = |t: f64| [f(t), -1.0 + 3.0 * t * t - 10.0 * t.powi(4), 6.0 * t - 40.0 * t.powi(3)];
        let quintic = Quintic::hermite(0.8, state(0.0), state(0.8));
        let t: f64 = 0.3;
        assert!((quintic.at(t)[0] - f(t)).abs() < 1e-14);
        assert!((quintic.at(t)[3] - (6.0 - 120.0 * t * t)).abs() < 1e-11);
        let integral = t - t * t / 2.0 + t.powi(4) / 4.0 - t.powi(6) / 3.0;
        assert!((quintic.integral_from(0.25, t) - (integral - 0.25 * t)).abs() < 1e-15);
    }

    /// Exact extremes must dominate any grid, and a fine grid must come as close as its spacing allows.
    #[test]
    fn ranges_are_those_of_a_fine_grid() {
        for seed in 0..40 {
            let number = |k: usize| ((seed * 37 + k * 101) as f64).sin();
            let h = 0.01 + 0.3 * number(9).abs();
            let quintic = Quintic::hermite(
                h,
                [number(0), number(1), 5.0 * number(2)],
                [number(0) + 0.3 * h * number(3), number(4), 5.0 * number(5)],
            );
            const POINTS: usize = 4000;
            for k in 0..4 {
                let (least, greatest) = quintic.range(k);
                let hull = quintic.hull(k);
                let values = (0..=POINTS).map(|i| quintic.at(h * i as f64 / POINTS as f64)[k]);
                let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, u), v| (l.min(v), u.max(v)));
                let size = hi.abs().max(lo.abs());
                assert!(hull.0 <= least + 1e-12 * size && hull.1 >= greatest - 1e-12 * size, "{seed} {k} {hull:?}");
                // A parabola's peak between grid points is missed by at most f″·(1/2N)²/2 ≤ 40·size/N² here.
                let slack = 1e-12 * size + 40.0 * (hi - lo + size) / (POINTS * POINTS) as f64;
                assert!(least <= lo + 1e-12 * size && greatest >= hi - 1e-12 * size, "{seed} {k}");
                assert!(least >= lo - slack && greatest <= hi + slack, "{seed} {k}");
            }
        }
    }
}
