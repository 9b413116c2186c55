//! What a trajectory must keep, and how near it comes to each limit.

use nalgebra::DVector;

use crate::audit::{Audit, AuditRules};
use crate::chain::Chain;
use crate::dynamics::Dynamics;
use crate::error::ManipulatorError;
use crate::holding::SlowTorque;
use crate::quintic::Quintic;
use crate::robot::{Limits, Robot};
use crate::trajectory::JointTrajectory;

/// Limits, scaled by the options, and which of them count.
pub(crate) struct Bounds<'a> {
    pub(crate) limits: Limits,
    pub(crate) rules: AuditRules,
    pub(crate) chain: &'a Chain,
    /// None where no torque could be too great.
    pub(crate) dynamics: Option<&'a Dynamics>,
}

/// Peaks over limits that are sampled, not bounded.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sampled {
    pub(crate) torque: Option<f64>,
    pub(crate) tool_speed: Option<f64>,
    pub(crate) tool_acceleration: Option<f64>,
    pub(crate) slowdown: f64,
}

/// Parts of the time between two points at whose ends torque and tool are looked at.
const PARTS: usize = 10;

impl<'a> Bounds<'a> {
    pub(crate) fn new(robot: &'a Robot, limits: Limits, rules: AuditRules) -> Self {
        let limited = limits.effort.iter().any(|effort| effort.is_finite());
        Self { limits, rules, chain: &robot.chain, dynamics: robot.dynamics.as_ref().filter(|_| limited) }
    }

    /// Raises the peaks of velocity, acceleration and jerk over their limits, and lowers the margin to the position limits, to those of
    /// one polynomial of a joint. Exact where they change.
    pub(crate) fn raise(&self, joint: usize, quintic: &Quintic, ratios: &mut [f64; 3], margin: &mut f64) {
        let limits = &self.limits;
        let room = |(low, high): (f64, f64)| (low - limits.lower[joint]).min(limits.upper[joint] - high);
        // Written so that what is not finite is looked at: finite points can be so large that the polynomial between them overflows.
        let roomy = room(quintic.hull(0)) >= *margin;
        if !roomy {
            let exact = room(quintic.range(0));
            *margin = if exact.is_nan() { f64::NEG_INFINITY } else { margin.min(exact) };
        }
        let bounds = [limits.velocity[joint], limits.acceleration[joint], limits.jerk[joint]];
        for (k, (ratio, bound)) in ratios.iter_mut().zip(bounds).enumerate() {
            let peak = |(low, high): (f64, f64)| high.max(-low) / bound;
            let low_enough = peak(quintic.hull(k + 1)) <= *ratio && quintic.hull(k + 1).0.is_finite();
            if !low_enough {
                let exact = quintic.range(k + 1);
                let finite = exact.0.is_finite() && exact.1.is_finite();
                *ratio = if finite { ratio.max(peak(exact)) } else { f64::INFINITY };
            }
        }
    }

    /// Why a trajectory of which that was found is withheld.
    pub(crate) fn not_met(&self, found: Audit) -> ManipulatorError {
        ManipulatorError::LimitsNotMet { audit: Box::new(found), rules: Box::new(self.rules) }
    }

    pub(crate) fn samples_anything(&self) -> bool {
        self.dynamics.is_some() || self.rules.tool_speed_m_s.is_some() || self.rules.tool_acceleration_m_s2.is_some()
    }

    fn sampler(&self) -> Sampler<'_> {
        let dof = self.limits.lower.len();
        let zeros = DVector::zeros(dof);
        Sampler { bounds: self, q: zeros.clone(), rates: zeros.clone(), accelerations: zeros, torque: vec![0.0; dof] }
    }

    /// Torque and tool over the whole trajectory.
    pub(crate) fn sampled(&self, trajectory: &JointTrajectory) -> Sampled {
        let mut found = Sampled {
            torque: self.dynamics.map(|_| 0.0),
            tool_speed: self.rules.tool_speed_m_s.map(|_| 0.0),
            tool_acceleration: self.rules.tool_acceleration_m_s2.map(|_| 0.0),
            slowdown: 0.0,
        };
        if !self.samples_anything() {
            return found;
        }
        let mut sampler = self.sampler();
        if let [only] = &trajectory.points[..] {
            sampler.q.copy_from_slice(&only.positions);
            sampler.take(&mut found, &mut |_, _| ());
        }
        for interval in 0..trajectory.points.len().saturating_sub(1) {
            // Each begins where the one before ended.
            sampler.interval(trajectory, interval, usize::from(interval > 0), &mut found, &mut |_, _| ());
        }
        found
    }

    /// The peaks of torque over limit, joint by joint, and of the tool between point `interval` and the next.
    pub(crate) fn sampled_between(&self, trajectory: &JointTrajectory, interval: usize) -> (Vec<f64>, Sampled) {
        let mut torques = vec![0.0_f64; self.limits.lower.len()];
        let mut found = Sampled {
            tool_speed: self.rules.tool_speed_m_s.map(|_| 0.0),
            tool_acceleration: self.rules.tool_acceleration_m_s2.map(|_| 0.0),
            ..Sampled::default()
        };
        let mut note = |joint: usize, ratio: f64| torques[joint] = torques[joint].max(ratio);
        if self.samples_anything() {
            self.sampler().interval(trajectory, interval, 0, &mut found, &mut note);
        }
        (torques, found)
    }
}

struct Sampler<'a> {
    bounds: &'a Bounds<'a>,
    q: DVector<f64>,
    rates: DVector<f64>,
    accelerations: DVector<f64>,
    torque: Vec<f64>,
}

impl Sampler<'_> {
    fn interval(
        &mut self,
        trajectory: &JointTrajectory,
        interval: usize,
        first_part: usize,
        found: &mut Sampled,
        note: &mut impl FnMut(usize, f64),
    ) {
        let step = trajectory.points[interval + 1].time_s - trajectory.points[interval].time_s;
        let quintics: Vec<Quintic> = trajectory.quintics(interval).collect();
        for part in first_part..=PARTS {
            let t = step * part as f64 / PARTS as f64;
            for (joint, quintic) in quintics.iter().enumerate() {
                let [q, rate, acceleration, _] = quintic.at(t);
                (self.q[joint], self.rates[joint], self.accelerations[joint]) = (q, rate, acceleration);
            }
            self.take(found, note);
        }
    }

    fn take(&mut self, found: &mut Sampled, note: &mut impl FnMut(usize, f64)) {
        if let Some(dynamics) = self.bounds.dynamics {
            let (q, rates, accelerations) = (self.q.as_slice(), self.rates.as_slice(), self.accelerations.as_slice());
            dynamics.torque(q, rates, accelerations, &mut self.torque);
            let mut worst = found.torque.unwrap_or(0.0);
            let mut broken = false;
            for (joint, (torque, effort)) in self.torque.iter().zip(&self.bounds.limits.effort).enumerate() {
                let ratio = if torque.is_finite() { torque.abs() / effort } else { f64::INFINITY };
                note(joint, ratio);
                worst = worst.max(ratio);
                broken |= ratio > 1.0;
            }
            found.torque = Some(worst);
            if broken && self.bounds.rules.torque {
                found.slowdown = found.slowdown.max(self.torque_slowdown(dynamics));
            }
        }
        let rules = &self.bounds.rules;
        if rules.tool_speed_m_s.is_some() || rules.tool_acceleration_m_s2.is_some() {
            let (speed, acceleration) = self.bounds.chain.tool_motion(&self.q, &self.rates, &self.accelerations);
            let ratio = |value: f64, limit: f64| if value.is_finite() { value / limit } else { f64::INFINITY };
            if let (Some(worst), Some(limit)) = (&mut found.tool_speed, rules.tool_speed_m_s) {
                *worst = worst.max(ratio(speed.norm(), limit));
                found.slowdown = found.slowdown.max(*worst);
            }
            if let (Some(worst), Some(limit)) = (&mut found.tool_acceleration, rules.tool_acceleration_m_s2) {
                *worst = worst.max(ratio(acceleration.norm(), limit));
                found.slowdown = found.slowdown.max(worst.sqrt());
            }
        }
    }

    /// Slower by r, the part of the torque that moves the links falls by r² while what holds them stays; damping, which falls by r, is
    /// left to the next attempt. Infinite where the slowest motion takes too much.
    fn torque_slowdown(&self, dynamics: &Dynamics) -> f64 {
        let slow = SlowTorque::new(dynamics, &self.q, &self.rates).moving;
        let joints = self.torque.iter().zip(&slow).zip(&self.bounds.limits.effort);
        joints
            .filter(|((torque, _), effort)| torque.abs() > **effort)
            .map(|((torque, slow), effort)| {
                let still = slow * torque.signum();
                if still < *effort { ((torque.abs() - still) / (effort - still)).sqrt() } else { f64::INFINITY }
            })
            .fold(1.0, f64::max)
    }
}
