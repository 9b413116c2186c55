//! How far the executed tool strays from the path between published points.

use nalgebra::DVector;

use crate::chain::Chain;
use crate::joint_path::JointPath;
use crate::speed_profile::Smoothed;
use crate::trajectory::JointTrajectory;

/// Places between two points that are looked at, as parts of the step. Quintics deviate there as u³(1 − u)³ where what they
/// interpolate is smooth, most in the middle; where a derivative of it jumps, somewhere beside.
const PLACES: [f64; 3] = [0.25, 0.5, 0.75];

/// The greatest distance of the executed tool from its path, in m, and the angle, in rad: bounds at the places looked at.
///
/// Whatever parameter s is compared with, the tool at q is no farther from the path than Σ Rⱼ·|qⱼ − qⱼ(s)|, Rⱼ the tool's greatest
/// distance from axis j, and Σ|qⱼ − qⱼ(s)| over the turning joints. The parameter is that of the profile, moved along the path by the
/// part of the deviation that only makes the motion early or late.
pub(crate) fn strays(chain: &Chain, path: &JointPath, profile: &Smoothed, trajectory: &JointTrajectory) -> (f64, f64) {
    let travel = |joint: usize| trajectory.points.iter().map(|p| p.positions[joint].abs()).fold(0.0, f64::max);
    let reach = chain.reach_bounds(&DVector::from_fn(chain.dof(), |joint, _| travel(joint)));
    let stretch = trajectory.duration_s() / profile.duration();
    let (mut worst_m, mut worst_rad) = (0.0_f64, 0.0_f64);
    for (interval, pair) in trajectory.points.windows(2).enumerate() {
        let quintics: Vec<_> = trajectory.quintics(interval).collect();
        for place in PLACES {
            let local = place * (pair[1].time_s - pair[0].time_s);
            let s = profile.at((pair[0].time_s + local) / stretch)[0];
            let (mut along, mut squared) = (0.0, 0.0);
            for (quintic, [q, dq, ..]) in quintics.iter().zip(path.joints_at(s)) {
                along += dq * (quintic.at(local)[0] - q);
                squared += dq * dq;
            }
            let moved = if squared > 0.0 { s + along / squared } else { s };
            let (mut metres, mut radians) = (0.0, 0.0);
            for (joint, (quintic, [q, ..])) in quintics.iter().zip(path.joints_at(moved)).enumerate() {
                let off = (quintic.at(local)[0] - q).abs();
                metres += reach[joint] * off;
                radians += if chain.is_rotary(joint) { off } else { 0.0 };
            }
            (worst_m, worst_rad) = (worst_m.max(metres), worst_rad.max(radians));
        }
    }
    (worst_m, worst_rad)
}
