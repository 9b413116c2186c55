//! Timed joint motion as it is published and executed.

use nalgebra::DVector;
use serde::Serialize;

use crate::quintic::Quintic;

/// The joints' state at one time; every vector in the order of the trajectory's joint names.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointPoint {
    /// Time from the start, in s: a whole number of nanoseconds, as ROS carries it.
    pub time_s: f64,
    /// In rad (m for prismatic joints).
    pub positions: Vec<f64>,
    /// Per s.
    pub velocities: Vec<f64>,
    /// Per s².
    pub accelerations: Vec<f64>,
}

/// Points in time, and between them the quintic that has their positions, velocities and accelerations: what a ROS
/// `joint_trajectory_controller` executes. Position, velocity and acceleration are continuous by construction.
///
/// Write positions with all their digits: the jerk between points 10 ms apart amplifies rounding by 6e7.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointTrajectory {
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// In order of time.
    pub points: Vec<JointPoint>,
}

impl JointTrajectory {
    /// Time of the last point, in s; 0 without points.
    pub fn duration_s(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.time_s)
    }

    /// Position, velocity, acceleration and jerk at time `t` in s, each of shape (dof). Before the first and after the last point
    /// the joints rest there. Without points the vectors are empty.
    pub fn at(&self, t: f64) -> [DVector<f64>; 4] {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else {
            return [(); 4].map(|()| DVector::zeros(0));
        };
        let resting =
            if t < first.time_s { Some(first) } else { (t > last.time_s || self.points.len() == 1).then_some(last) };
        if let Some(point) = resting {
            let zeros = DVector::zeros(point.positions.len());
            return [DVector::from_column_slice(&point.positions), zeros.clone(), zeros.clone(), zeros];
        }
        let interval = self.points.partition_point(|p| p.time_s <= t).clamp(1, self.points.len() - 1) - 1;
        let local = t - self.points[interval].time_s;
        let joints: Vec<[f64; 4]> = self.quintics(interval).map(|quintic| quintic.at(local)).collect();
        [0, 1, 2, 3].map(|order| DVector::from_iterator(joints.len(), joints.iter().map(|joint| joint[order])))
    }

    /// The state at time `t` in s, as the first point of a trajectory that takes over there: bit for bit that of a point whose time
    /// is `t`.
    pub fn state_at(&self, t: f64) -> JointPoint {
        if let Some(point) = self.points.iter().find(|point| point.time_s == t) {
            return JointPoint { time_s: 0.0, ..point.clone() };
        }
        let [positions, velocities, accelerations, _] = self.at(t).map(|v| v.as_slice().to_vec());
        JointPoint { time_s: 0.0, positions, velocities, accelerations }
    }

    /// What is executed from time `t` in s on, with times from there.
    pub fn after(&self, t: f64) -> Self {
        let later = self.points.iter().filter(|point| point.time_s > t);
        let later = later.map(|point| JointPoint { time_s: whole_ns(point.time_s - t), ..point.clone() });
        Self { joint_names: self.joint_names.clone(), points: [self.state_at(t)].into_iter().chain(later).collect() }
    }

    /// This trajectory until time `t` in s, and from there on `next`, whose first point is the state at `t`.
    pub fn switched(&self, t: f64, next: &Self) -> Self {
        let earlier = self.points.iter().filter(|point| point.time_s < t).cloned();
        let later = next.points.iter().map(|point| JointPoint { time_s: whole_ns(t + point.time_s), ..point.clone() });
        Self { joint_names: self.joint_names.clone(), points: earlier.chain(later).collect() }
    }

    /// Whether every point has `dof` finite values of each kind, and times start at 0 and increase.
    pub(crate) fn is_well_formed(&self, dof: usize) -> bool {
        let complete = |p: &JointPoint| {
            let lists = [&p.positions, &p.velocities, &p.accelerations];
            lists.iter().all(|list| list.len() == dof && list.iter().all(|x| x.is_finite())) && p.time_s.is_finite()
        };
        self.points.first().is_some_and(|first| first.time_s == 0.0)
            && self.points.iter().all(complete)
            && self.points.windows(2).all(|pair| pair[1].time_s > pair[0].time_s)
    }

    /// What is executed between point `interval` and the next, one polynomial a joint.
    pub(crate) fn quintics(&self, interval: usize) -> impl Iterator<Item = Quintic> + '_ {
        let (from, to) = (&self.points[interval], &self.points[interval + 1]);
        let h = to.time_s - from.time_s;
        let state = |p: &JointPoint, j: usize| [p.positions[j], p.velocities[j], p.accelerations[j]];
        // Anyone may build a trajectory: joints for which something is missing are left out here and fail the audit.
        let lengths = [from, to].map(|p| p.positions.len().min(p.velocities.len()).min(p.accelerations.len()));
        (0..lengths[0].min(lengths[1])).map(move |j| Quintic::hermite(h, state(from, j), state(to, j)))
    }
}

/// To the nearest nanosecond.
pub(crate) fn whole_ns(time_s: f64) -> f64 {
    (time_s * 1e9).round() * 1e-9
}
