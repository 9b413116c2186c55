//! The posture that a redundant arm keeps to along a curve.

use nalgebra::DVector;

use crate::continuation::Tracker;
use crate::ik::rates_for;
use crate::quintic_spline::{EndDerivatives, QuinticSpline};
use crate::stations::Station;

/// The C⁴ spline through configurations on the curve. At its ends it moves as the arm must, J·q′ = V and J·q″ = V′ − J′·q′, so that the
/// configuration nearest to it moves there exactly as it does; on a closed curve both ends move alike.
pub(crate) fn posture_through(
    tracker: &Tracker<'_>,
    stations: &[Station],
    configurations: &[DVector<f64>],
) -> Option<QuinticSpline> {
    let knots: Vec<f64> = stations.iter().map(|station| station.s).collect();
    let last = knots.len() - 1;
    let way = |k: usize| (&configurations[k + 1] - &configurations[k], knots[k + 1] - knots[k]);
    // The slope of the parabola through three stations, so far behind the middle of the first two.
    let parabola = |first: (DVector<f64>, f64), second: (DVector<f64>, f64), behind: f64| {
        let (a, b) = (first.0 / first.1, second.0 / second.1);
        let bend = (b - &a) / (0.5 * (first.1 + second.1));
        a + bend * behind
    };
    let (wanted_first, wanted_last) = if tracker.curve.is_closed() {
        let h = way(last - 1).1;
        let through = parabola(way(last - 1), way(0), 0.5 * h);
        (through.clone(), through)
    } else {
        let (h0, h1) = (way(0).1, way(last - 1).1);
        (parabola(way(0), way(1), -0.5 * h0), parabola(way(last - 2), way(last - 1), 0.5 * way(last - 2).1 + h1))
    };
    let end = |s: f64, q: &DVector<f64>, wanted: DVector<f64>| {
        let mut sample = tracker.sample(s, q).ok()?;
        sample.rate = rates_for(&sample.jacobian, &tracker.curve.at(s).twist.to_vector(), wanted)?;
        let second = tracker.second_derivative(&sample);
        Some(EndDerivatives { first: sample.rate, second })
    };
    let start = end(knots[0], &configurations[0], wanted_first)?;
    let stop = end(knots[last], &configurations[last], wanted_last)?;
    QuinticSpline::through(&knots, configurations, [&start, &stop]).ok()
}
