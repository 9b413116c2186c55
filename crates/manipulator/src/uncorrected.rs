//! What a trajectory would take if nobody looked between its gridpoints.

use crate::audit::against;
use crate::error::Result;
use crate::gridpoints::Coarse;
use crate::joint_path::JointPath;
use crate::options::TimingOptions;
use crate::robot::Robot;
use crate::sampling::{Sampling, sample};
use crate::timing::{Solver, TOO_COARSE};

/// Solutions about the one before after which there is nothing left to gain.
const MOST_SOLUTIONS: usize = 8;
/// Part of the duration by which a further solution must be shorter to count.
const GAIN: f64 = 1e-3;

/// The duration of the solution that [`time_path`](crate::time_path) corrects, in s: on the same gridpoints and as smooth, but legal at
/// these alone, with no limit tightened, and solved again about the last solution until that gains nothing. What the audit's
/// corrections cost is the duration of the trajectory over this.
///
/// Takes several times as long as the timing itself; for benchmarks.
///
/// # Errors
/// Those of [`time_path`](crate::time_path); also where the optimiser fails on a path of hardly any length.
pub fn uncorrected_duration_s(robot: &Robot, path: &JointPath, options: &TimingOptions) -> Result<f64> {
    let bounds = options.bounds(robot)?;
    robot.check_configuration("the joint path", &path.at(path.domain().0)[0])?;
    let sampling = Sampling { rate_hz: options.rate_hz, joint_names: robot.chain.joint_names() };
    let solver = Solver::new(options);
    let coarse = Coarse::new(path, &bounds, options)?;
    let mut gridpoints = coarse.grid(1)?;
    let (mut profile, mut speeds) = solver.solve(&gridpoints, None)?;
    let found = against(&bounds, &sample(path, &profile, profile.duration(), &sampling)?);
    let too_strong = bounds.rules.torque && found.audit.max_ratio.torque.is_some_and(|ratio| ratio > 1.0);
    if too_strong {
        gridpoints.limit_torque(&bounds)?;
    } else if found.slowdown > TOO_COARSE {
        gridpoints = coarse.grid(2)?;
    }
    if too_strong || found.slowdown > TOO_COARSE {
        (profile, speeds) = solver.solve(&gridpoints, None)?;
    }
    for _ in 0..MOST_SOLUTIONS {
        let (next, next_speeds) = solver.solve(&gridpoints, Some(&speeds))?;
        let gains = next.duration() < (1.0 - GAIN) * profile.duration();
        if next.duration() < profile.duration() {
            (profile, speeds) = (next, next_speeds);
        }
        if !gains {
            break;
        }
    }
    Ok(profile.duration())
}
