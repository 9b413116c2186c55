//! Limits that are linear in the squared speed a = ṡ² and the acceleration b = s̈ along a path.

use copp::constraints::Constraints;
use copp::diag::CoppError;
use nalgebra::{DMatrix, DVector, Vector3};

use crate::bounds::Bounds;
use crate::dynamics::Dynamics;
use crate::error::Result;
use crate::holding::{SlowTorque, lacking};

/// Path derivatives q, q′, q″, q‴ by the optimiser's parameter, joint × gridpoint.
pub(crate) type Derivatives = [DMatrix<f64>; 4];

/// τ = m·b + c·a + g + d·q′·√a + f·sgn(q′), joint × gridpoint, of the joints whose effort is limited.
pub(crate) struct TorqueRows {
    of_acceleration: DMatrix<f64>,
    of_squared_speed: DMatrix<f64>,
    /// g + f·sgn(q′).
    slow: DMatrix<f64>,
    viscous: DMatrix<f64>,
    /// What each joint may give, in N·m (N for prismatic joints).
    effort: DMatrix<f64>,
}

/// Part of the torque left over beside slow motion that tightening leaves at least.
const LEAST_SHARE: f64 = 0.05;

impl TorqueRows {
    /// # Errors
    /// [`crate::ManipulatorError::HoldingTorque`] where a joint cannot move the arm however slowly.
    pub(crate) fn new(bounds: &Bounds<'_>, dynamics: &Dynamics, derivatives: &Derivatives) -> Result<Self> {
        let [q, first, second, _] = derivatives;
        let (dof, n) = q.shape();
        let zeros = || DMatrix::zeros(dof, n);
        let mut rows = Self {
            of_acceleration: zeros(),
            of_squared_speed: zeros(),
            slow: zeros(),
            viscous: zeros(),
            effort: DMatrix::from_fn(dof, n, |joint, _| bounds.limits.effort[joint]),
        };
        let rest = vec![0.0; dof];
        for k in 0..n {
            let [q, first, second] = [q, first, second].map(|matrix| matrix.column(k).clone_owned());
            let torque = |rates: &[f64], accelerations: &[f64]| {
                let mut torque = DVector::zeros(dof);
                dynamics.rigid_torque(q.as_slice(), rates, accelerations, torque.as_mut_slice());
                torque
            };
            let slow = SlowTorque::new(dynamics, &q, &first);
            if let Some((_, refusal)) = lacking(bounds, &q, &slow, None) {
                return Err(refusal);
            }
            rows.of_acceleration.set_column(k, &(torque(&rest, first.as_slice()) - &slow.holding));
            rows.of_squared_speed.set_column(k, &(torque(first.as_slice(), second.as_slice()) - &slow.holding));
            rows.slow.set_column(k, &slow.moving);
            for (joint, drive) in dynamics.drives().enumerate() {
                rows.viscous[(joint, k)] = drive.damping_n_m_s * first[joint];
            }
        }
        Ok(rows)
    }

    /// Takes off the effort of a joint at a gridpoint what the audit found too much.
    pub(crate) fn tighten(&mut self, joint: usize, station: usize, ratio: f64) {
        let effort = &mut self.effort[(joint, station)];
        let left = *effort - self.slow[(joint, station)].abs();
        *effort -= ((ratio - 0.99) * *effort).min((1.0 - LEAST_SHARE) * left);
    }

    /// Adds both directions of every joint. Damping is concave in a; above its tangent at `about` it never lies, and where it acts
    /// against the limit's direction it is left out.
    pub(crate) fn add(&self, constraints: &mut Constraints, about: &[f64]) -> std::result::Result<(), CoppError> {
        let limited: Vec<usize> =
            (0..self.effort.nrows()).filter(|&joint| self.effort[(joint, 0)].is_finite()).collect();
        for direction in [1.0, -1.0] {
            let shape = |value: &dyn Fn(usize, usize) -> f64| {
                DMatrix::from_fn(limited.len(), about.len(), |row, station| value(limited[row], station))
            };
            let room = |joint: usize, k: usize| self.effort[(joint, k)] - direction * self.slow[(joint, k)];
            // Half the tangent's rise at rest; small enough to leave half of the room.
            let rise = |joint: usize, k: usize| {
                let viscous = (direction * self.viscous[(joint, k)]).max(0.0);
                let root = about[k].max(0.0).sqrt().min(room(joint, k) / viscous.max(1e-12)).max(1e-9);
                (viscous * root / 2.0, viscous / (2.0 * root))
            };
            constraints.with_constraint_2order(
                &shape(&|j, k| direction * self.of_squared_speed[(j, k)] + rise(j, k).1).as_view(),
                &shape(&|j, k| direction * self.of_acceleration[(j, k)]).as_view(),
                &shape(&|j, k| room(j, k) - rise(j, k).0).as_view(),
                0,
                false,
            )?;
        }
        Ok(())
    }
}

/// The tool's velocity and acceleration along the path: p′ and p″, so that ṗ = p′·√a and p̈ = p″·a + p′·b.
pub(crate) struct ToolRows {
    first: Vec<Vector3<f64>>,
    second: Vec<Vector3<f64>>,
    /// Greatest speed in m/s at each gridpoint, infinite without a limit.
    pub(crate) speed: Vec<f64>,
    /// Greatest acceleration in m/s² at each gridpoint, infinite without a limit.
    pub(crate) acceleration: Vec<f64>,
}

/// Pairs of sides of the polygon that stands for the circle of accelerations; inscribed, it is smaller by 1.9 %.
const SIDE_PAIRS: usize = 8;

impl ToolRows {
    pub(crate) fn new(bounds: &Bounds<'_>, derivatives: &Derivatives, speed: Option<f64>) -> Self {
        let [q, first, second, _] = derivatives;
        let n = q.ncols();
        let column = |matrix: &DMatrix<f64>, k: usize| matrix.column(k).clone_owned();
        let motion = |k: usize| bounds.chain.tool_motion(&column(q, k), &column(first, k), &column(second, k));
        let (first, second) = (0..n).map(motion).unzip();
        let acceleration = bounds.rules.tool_acceleration_m_s2.unwrap_or(f64::INFINITY);
        Self { first, second, speed: vec![speed.unwrap_or(f64::INFINITY); n], acceleration: vec![acceleration; n] }
    }

    pub(crate) fn add(&self, constraints: &mut Constraints) -> std::result::Result<(), CoppError> {
        let n = self.first.len();
        // A tool that stands still may be driven at any speed: 1e12 is far above all others, which lie about 1.
        let greatest = |k: usize| (self.speed[k] / self.first[k].norm()).powi(2).min(1e12);
        if self.speed[0].is_finite() {
            let greatest: Vec<f64> = (0..n).map(greatest).collect();
            constraints.with_constraint_1order(greatest.as_slice(), 0)?;
        }
        if !self.acceleration[0].is_finite() {
            return Ok(());
        }
        let inscribed = (std::f64::consts::PI / (2 * SIDE_PAIRS) as f64).cos();
        let side = |row: usize, k: usize| {
            let along = self.first[k].try_normalize(1e-12).unwrap_or_else(Vector3::x);
            let across = self.second[k] - along * along.dot(&self.second[k]);
            let across = across.try_normalize(1e-12).unwrap_or_else(Vector3::zeros);
            let (sin, cos) = (std::f64::consts::PI * row as f64 / SIDE_PAIRS as f64).sin_cos();
            along * cos + across * sin
        };
        let shape = |value: &dyn Fn(usize, usize) -> f64| DMatrix::from_fn(SIDE_PAIRS, n, value);
        for direction in [1.0, -1.0] {
            constraints.with_constraint_2order(
                &shape(&|row, k| direction * side(row, k).dot(&self.second[k])).as_view(),
                &shape(&|row, k| direction * side(row, k).dot(&self.first[k])).as_view(),
                &shape(&|_, k| inscribed * self.acceleration[k]).as_view(),
                0,
                false,
            )?;
        }
        Ok(())
    }
}
