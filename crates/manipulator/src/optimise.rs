//! The time-optimal speed along a joint path, by the crate `copp`.

use copp::diag::CoppError;
use copp::solver::topp2_ra::{ReachSet2OptionsBuilder, Topp2ProblemBuilder, s_to_t_topp2, topp2_ra};
use copp::solver::topp3_socp::{ClarabelOptionsBuilder, Topp3ProblemBuilder, Topp3Profile, s_to_t_topp3, topp3_socp};
use nalgebra::{DMatrix, DVector};

use crate::error::{ManipulatorError, Result};
use crate::joint_path::JointPath;
use crate::robot::Limits;
use crate::speed_profile::SpeedProfile;

/// The floor under the speeds about which the jerk constraints are linearised, as a part of the greatest squared speed.
const LINEARISATION_FLOOR: f64 = 1e-3;

/// Gridpoints on a path with what the joints may do at each, scaled so that the speed along the path is about 1.
pub(crate) struct Grid {
    /// Path parameters of the gridpoints.
    pub(crate) parameters: Vec<f64>,
    /// Optimiser's parameter = scale·(path parameter − first).
    pub(crate) scale: f64,
    derivatives: [DMatrix<f64>; 4],
    /// Velocity, acceleration and jerk limits, joint × gridpoint.
    pub(crate) limits: [DMatrix<f64>; 3],
}

fn failed(what: &str) -> impl Fn(CoppError) -> ManipulatorError + '_ {
    move |error| ManipulatorError::Timing { reason: format!("{what}: {}", crate::urdf::one_line(&error.to_string())) }
}

impl Grid {
    pub(crate) fn new(path: &JointPath, parameters: Vec<f64>, scale: f64, limits: &Limits) -> Result<Self> {
        let (dof, n) = (limits.lower.len(), parameters.len());
        let mut derivatives = [(); 4].map(|()| DMatrix::zeros(dof, n));
        for (k, &s) in parameters.iter().enumerate() {
            let mut factor = 1.0;
            for (matrix, value) in derivatives.iter_mut().zip(path.at(s)) {
                matrix.set_column(k, &(value * factor));
                factor /= scale;
            }
        }
        // A path of NaN would make the reachability analysis return nonsense without a word.
        if !derivatives.iter().all(|m| m.iter().all(|x| x.is_finite())) {
            return Err(ManipulatorError::NonFinite { what: "the joint path" });
        }
        let spread = |v: &DVector<f64>| DMatrix::from_fn(dof, n, |joint, _| v[joint]);
        let limits = [spread(&limits.velocity), spread(&limits.acceleration), spread(&limits.jerk)];
        Ok(Self { parameters, scale, derivatives, limits })
    }

    fn stations(&self) -> Vec<f64> {
        self.parameters.iter().map(|s| (s - self.parameters[0]) * self.scale).collect()
    }

    fn robot(&self, with_jerk: bool) -> Result<copp::robot::Robot<usize>> {
        let build = || -> std::result::Result<copp::robot::Robot<usize>, CoppError> {
            let n = self.parameters.len();
            let mut robot = copp::robot::Robot::with_capacity(self.limits[0].nrows(), n);
            let [q, dq, ddq, dddq] = &self.derivatives;
            let [velocity, acceleration, jerk] = &self.limits;
            let below = |m: &DMatrix<f64>| -m;
            robot
                .with_s(self.stations().as_slice())?
                .with_q(&q.as_view(), &dq.as_view(), &ddq.as_view(), Some(&dddq.as_view()), 0)?
                .with_axial_velocity(&velocity.as_view(), &below(velocity).as_view(), 0)?
                .with_axial_acceleration(&acceleration.as_view(), &below(acceleration).as_view(), 0)?;
            if with_jerk {
                robot.with_axial_jerk(&jerk.as_view(), &below(jerk).as_view(), 0)?;
            }
            Ok(robot)
        };
        build().map_err(failed("the path was refused"))
    }

    /// Squared speeds ṡ² at the gridpoints and the times, under velocity and acceleration limits alone (TOPP2-RA).
    pub(crate) fn second_order(&self) -> Result<(Vec<f64>, Vec<f64>)> {
        let robot = self.robot(false)?;
        let speeds = self.reachability(&robot)?;
        let (_, times) = s_to_t_topp2(&self.stations(), &speeds, 0.0).map_err(failed("TOPP2-RA"))?;
        Ok((speeds, times))
    }

    fn reachability(&self, robot: &copp::robot::Robot<usize>) -> Result<Vec<f64>> {
        let solve = || -> std::result::Result<Vec<f64>, CoppError> {
            let problem = Topp2ProblemBuilder::new(robot, (0, self.parameters.len() - 1), (0.0, 0.0)).build()?;
            topp2_ra(&problem, &ReachSet2OptionsBuilder::new().build()?)
        };
        solve().map_err(failed("TOPP2-RA"))
    }

    /// The profile under all limits (TOPP3 as a second-order cone programme, linearised about TOPP2-RA, then about its own solution).
    pub(crate) fn third_order(&self) -> Result<SpeedProfile> {
        let mut robot = self.robot(true)?;
        let seed = floored(self.reachability(&robot)?);
        let mut solve = |about: &[f64]| -> std::result::Result<Topp3Profile, CoppError> {
            let options = ClarabelOptionsBuilder::new().allow_almost_solved(true).build()?;
            let problem =
                Topp3ProblemBuilder::new(&mut robot, 0, about, (0.0, 0.0), (0.0, 0.0)).build_with_linearization()?;
            topp3_socp(&problem, &options)
        };
        let first = solve(&seed).map_err(failed("TOPP3-SOCP"))?;
        // The first solution is legal already; the second linearisation only makes it faster.
        let profile = solve(&floored(first.a.clone())).unwrap_or(first);
        self.in_time(&profile)
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

fn floored(mut speeds: Vec<f64>) -> Vec<f64> {
    let floor = LINEARISATION_FLOOR * speeds.iter().copied().fold(0.0, f64::max);
    speeds.iter_mut().for_each(|a| *a = a.max(floor));
    speeds
}
