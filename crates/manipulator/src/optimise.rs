//! The time-optimal speed along a joint path, by the crate `copp`.

use copp::diag::CoppError;
use copp::solver::topp2_ra::{ReachSet2OptionsBuilder, Topp2ProblemBuilder, s_to_t_topp2, topp2_ra};
use copp::solver::topp3_socp::{ClarabelOptionsBuilder, Topp3ProblemBuilder, Topp3Profile, s_to_t_topp3, topp3_socp};
use nalgebra::{DMatrix, DVector};

use crate::bounds::Bounds;
use crate::error::{ManipulatorError, Result};
use crate::joint_path::JointPath;
use crate::rows::{Derivatives, ToolRows, TorqueRows};
use crate::speed_profile::SpeedProfile;

/// The floor under the speeds about which the jerk constraints are linearised, as a part of the greatest squared speed.
const LINEARISATION_FLOOR: f64 = 1e-3;
/// Accuracy asked of the cone programmes; the audit's corrections are a hundred times larger.
const SOLVER_TOLERANCE: f64 = 1e-6;

/// Gridpoints on a path with what the joints may do at each, scaled so that the speed along the path is about 1.
pub(crate) struct Grid {
    /// Path parameters of the gridpoints.
    pub(crate) parameters: Vec<f64>,
    /// Optimiser's parameter = scale·(path parameter − first).
    scale: f64,
    derivatives: Derivatives,
    /// Velocity, acceleration and jerk limits, joint × gridpoint.
    pub(crate) limits: [DMatrix<f64>; 3],
    pub(crate) tool: Option<ToolRows>,
    pub(crate) torque: Option<TorqueRows>,
}

fn failed(what: &str) -> impl Fn(CoppError) -> ManipulatorError + '_ {
    move |error| ManipulatorError::Timing { reason: format!("{what}: {}", crate::urdf::one_line(&error.to_string())) }
}

impl Grid {
    /// `tool_speed`, in m/s, is the tool's greatest; torques are left out until [`Grid::limit_torque`].
    pub(crate) fn new(
        path: &JointPath,
        parameters: Vec<f64>,
        scale: f64,
        bounds: &Bounds<'_>,
        tool_speed: Option<f64>,
    ) -> Result<Self> {
        let (dof, n) = (bounds.limits.lower.len(), parameters.len());
        let mut derivatives = [(); 4].map(|()| DMatrix::zeros(dof, n));
        let per_scale = [0, 1, 2, 3].map(|order| f64::powi(scale, -order));
        for (k, &s) in parameters.iter().enumerate() {
            for (joint, values) in path.joints_at(s).enumerate() {
                for (order, value) in values.into_iter().enumerate() {
                    derivatives[order][(joint, k)] = value * per_scale[order];
                }
            }
        }
        // A path of NaN would make the reachability analysis return nonsense without a word.
        if !derivatives.iter().all(|m| m.iter().all(|x| x.is_finite())) {
            return Err(ManipulatorError::NonFinite { what: "the joint path" });
        }
        let spread = |v: &DVector<f64>| DMatrix::from_fn(dof, n, |joint, _| v[joint]);
        let limits = [&bounds.limits.velocity, &bounds.limits.acceleration, &bounds.limits.jerk].map(spread);
        let tool_is_limited = tool_speed.is_some() || bounds.rules.tool_acceleration_m_s2.is_some();
        let tool = tool_is_limited.then(|| ToolRows::new(bounds, &derivatives, tool_speed));
        Ok(Self { parameters, scale, derivatives, limits, tool, torque: None })
    }

    /// From here on torques count too.
    ///
    /// # Errors
    /// [`ManipulatorError::HoldingTorque`].
    pub(crate) fn limit_torque(&mut self, bounds: &Bounds<'_>) -> Result<()> {
        if let (None, Some(dynamics)) = (&self.torque, bounds.dynamics) {
            self.torque = Some(TorqueRows::new(bounds, dynamics, &self.derivatives)?);
        }
        Ok(())
    }

    fn stations(&self) -> Vec<f64> {
        self.parameters.iter().map(|s| (s - self.parameters[0]) * self.scale).collect()
    }

    /// The problem, with what is not linear in it taken at the squared speeds `about`.
    fn robot(&self, with_jerk: bool, about: Option<&[f64]>) -> Result<copp::robot::Robot<usize>> {
        let build =
            || -> std::result::Result<copp::robot::Robot<usize>, CoppError> {
                let n = self.parameters.len();
                let [q, dq, ddq, dddq] = &self.derivatives;
                let [velocity, acceleration, jerk] = &self.limits;
                // The container keeps room for twice the gridpoints, and for third-order rows of as many joints as it is told of.
                let mut robot = copp::robot::Robot::with_capacity(if with_jerk { q.nrows() } else { 0 }, 2 * n);
                let rows = &mut robot.constraints;
                rows.with_s(self.stations().as_slice())?
                    .with_constraint_1order(greatest_squared_speeds(dq, velocity).as_slice(), 0)?
                    .with_constraint_2order(&ddq.as_view(), &dq.as_view(), &acceleration.as_view(), 0, false)?
                    .with_constraint_2order(&ddq.as_view(), &dq.as_view(), &(-acceleration).as_view(), 0, true)?;
                if let Some(tool) = &self.tool {
                    tool.add(rows)?;
                }
                if let Some(torque) = &self.torque {
                    // The scale makes speeds about 1.
                    let ones = vec![1.0; n];
                    torque.add(rows, about.unwrap_or(&ones))?;
                }
                if with_jerk {
                    robot
                        .with_q(&q.as_view(), &dq.as_view(), &ddq.as_view(), Some(&dddq.as_view()), 0)?
                        .with_axial_jerk(&jerk.as_view(), &(-jerk).as_view(), 0)?;
                }
                Ok(robot)
            };
        build().map_err(failed("the path was refused"))
    }

    /// Squared speeds ṡ² at the gridpoints and the times, without jerk limits (TOPP2-RA).
    pub(crate) fn second_order(&self, about: Option<&[f64]>) -> Result<(Vec<f64>, Vec<f64>)> {
        let speeds = self.reachability(&self.robot(false, about)?)?;
        let (_, times) = s_to_t_topp2(&self.stations(), &speeds, 0.0).map_err(failed("TOPP2-RA"))?;
        Ok((speeds, times))
    }

    /// The profile without jerk limits, and its squared speeds.
    pub(crate) fn second_order_profile(&self, about: Option<&[f64]>) -> Result<(SpeedProfile, Vec<f64>)> {
        let (squared, times) = self.second_order(about)?;
        let speeds: Vec<f64> = squared.iter().map(|a| a.max(0.0).sqrt() / self.scale).collect();
        let stuck = times.windows(2).any(|pair| !(pair[1] > pair[0] && pair[1].is_finite()));
        if stuck {
            return Err(ManipulatorError::Timing { reason: "TOPP2-RA: the speed is zero within the path".into() });
        }
        Ok((SpeedProfile::of_constant_accelerations(times, &self.parameters, &speeds), squared))
    }

    fn reachability(&self, robot: &copp::robot::Robot<usize>) -> Result<Vec<f64>> {
        let solve = || -> std::result::Result<Vec<f64>, CoppError> {
            let problem = Topp2ProblemBuilder::new(robot, (0, self.parameters.len() - 1), (0.0, 0.0)).build()?;
            topp2_ra(&problem, &ReachSet2OptionsBuilder::new().build()?)
        };
        solve().map_err(failed("TOPP2-RA"))
    }

    /// The profile under all limits, and its squared speeds: TOPP3 as a second-order cone programme, linearised about given squared
    /// speeds, else about TOPP2-RA. What it returns is legal at the gridpoints whatever it was linearised about.
    pub(crate) fn third_order(&self, about: Option<&[f64]>) -> Result<(SpeedProfile, Vec<f64>)> {
        let mut robot = self.robot(true, about)?;
        let seed = match about {
            Some(speeds) => floored(speeds.to_vec()),
            None => floored(self.reachability(&robot)?),
        };
        let mut solve = || -> std::result::Result<Topp3Profile, CoppError> {
            let mut options = ClarabelOptionsBuilder::new().allow_almost_solved(true);
            options.clarabel_settings.tol_gap_abs = SOLVER_TOLERANCE;
            options.clarabel_settings.tol_gap_rel = SOLVER_TOLERANCE;
            options.clarabel_settings.tol_feas = SOLVER_TOLERANCE;
            let problem =
                Topp3ProblemBuilder::new(&mut robot, 0, &seed, (0.0, 0.0), (0.0, 0.0)).build_with_linearization()?;
            topp3_socp(&problem, &options.build()?)
        };
        let profile = solve().map_err(failed("TOPP3-SOCP"))?;
        Ok((self.in_time(&profile)?, profile.a))
    }

    fn in_time(&self, profile: &Topp3Profile) -> Result<SpeedProfile> {
        let (_, times) =
            s_to_t_topp3(&self.stations(), profile.as_parts(), 0.0).map_err(failed("times of TOPP3-SOCP"))?;
        let last = self.parameters.len() - 1;
        let states: Vec<[f64; 3]> = (0..=last)
            .map(|k| {
                let at_end = k == 0 || k == last;
                let speed = if at_end { 0.0 } else { profile.a[k].max(0.0).sqrt() };
                let acceleration = if at_end { 0.0 } else { profile.b[k] };
                [self.parameters[k], speed / self.scale, acceleration / self.scale]
            })
            .collect();
        Ok(SpeedProfile::through(times, &states))
    }
}

/// The greatest ṡ² at each gridpoint for which every |q′ṡ| is at most its limit.
fn greatest_squared_speeds(first: &DMatrix<f64>, velocity: &DMatrix<f64>) -> Vec<f64> {
    let of_joint = |(dq, limit): (&f64, &f64)| (limit / dq).powi(2);
    let columns = first.column_iter().zip(velocity.column_iter());
    columns.map(|(dq, limit)| dq.iter().zip(&limit).map(of_joint).fold(f64::INFINITY, f64::min)).collect()
}

fn floored(mut speeds: Vec<f64>) -> Vec<f64> {
    let floor = LINEARISATION_FLOOR * speeds.iter().copied().fold(0.0, f64::max);
    speeds.iter_mut().for_each(|a| *a = a.max(floor));
    speeds
}
