//! Every parameter there is.

use planner::OnRefusal;
use planner::manipulator::JointLimits;
use planner::reorder::{TopologyChoice, Verdict};

use super::Execution;
use super::declaration::{Declaration, Kind};

/// The row of a choice: the words in the order of the values they mean.
macro_rules! choice {
    ($($path:ident).+, [$($word:literal => $value:expr),+ $(,)?]) => {
        Kind::Choice {
            words: &[$($word),+],
            get: |p| [$($value),+].iter().position(|value| *value == p.$($path).+).unwrap_or(0),
            set: |p, place| p.$($path).+ = [$($value),+][place],
        }
    };
}

const fn row(name: &'static str, kind: Kind, about: &'static str) -> Declaration {
    Declaration { name, about, kind, fixed: false }
}

const fn fixed(name: &'static str, kind: Kind, about: &'static str) -> Declaration {
    Declaration { name, about, kind, fixed: true }
}

/// A part of a robot's limits.
const SCALE: [f64; 2] = [1e-3, 1.0];
/// A speed or an acceleration of a tool, in m/s or m/s².
const OF_TOOL: [f64; 2] = [1e-4, 1e3];

/// In the order in which people read them.
pub(crate) static TABLE: &[Declaration] = &[
    fixed(
        "use_sim_time",
        Kind::Flag(|p| &mut p.use_sim_time),
        "Whether the node's clock is that on /clock, where a simulator publishes one.",
    ),
    fixed(
        "autostart",
        Kind::Flag(|p| &mut p.autostart),
        "Go to work at once. If false, the node waits, unconfigured, for a lifecycle manager.",
    ),
    fixed(
        "execution",
        choice!(execution, ["topic" => Execution::Topic, "action" => Execution::Action]),
        "trajectories are published on joint_trajectory, or sent as goals of the controller's FollowJointTrajectory action, which \
         answers, can be cancelled by ~/cancel, and says how it went.",
    ),
    fixed("action", Kind::Text(|p| &mut p.action), "Name of that action."),
    row(
        "quiet_s",
        Kind::Real { range: [0.0, 3600.0], place: |p| &mut p.quiet_s },
        "Poses that arrive one by one on ~/pose are planned when none has come for so long. 0: only when ~/replan is called.",
    ),
    row(
        "transform_timeout_s",
        Kind::Real { range: [0.0, 60.0], place: |p| &mut p.transform_timeout_s },
        "How long poses in another frame than the robot's base wait for /tf to say where that is at their stamp.",
    ),
    row(
        "max_poses",
        Kind::Count { range: [2, 1_000_000], place: |p| &mut p.config.max_poses },
        "More poses at a time are refused: their plan would take long, and nothing else is planned meanwhile.",
    ),
    row(
        "metres_per_radian",
        Kind::Real { range: [1e-6, 1e6], place: |p| &mut p.config.metres_per_radian },
        "One radian counts as much as this many metres when poses are compared. It changes the order, so it is reported.",
    ),
    row(
        "topology",
        choice!(config.topology, ["auto" => TopologyChoice::Auto, "open" => TopologyChoice::Open, "closed" => TopologyChoice::Closed]),
        "whether the recovered curve returns to its start.",
    ),
    row(
        "start",
        Kind::OptionalIndex(|p| &mut p.config.start),
        "The input index at which an open curve starts. -1: at the end nearer to the robot's tool.",
    ),
    row(
        "minimum_verdict",
        choice!(config.minimum_verdict, ["ambiguous" => Verdict::Ambiguous, "plausible" => Verdict::Plausible, "certified" => Verdict::Certified]),
        "an order below this is refused, not executed.",
    ),
    row(
        "approach",
        Kind::Flag(|p| &mut p.config.approach),
        "Begin with a straight joint move from the state on joint_states to the first pose. It is not checked for collisions.",
    ),
    row(
        "require_joint_state",
        Kind::Flag(|p| &mut p.config.require_joint_state),
        "Plan only when joint_states says where the robot stands. If false, and nothing was heard, the trajectory begins at the first \
         pose, wherever the robot is: only for simulators that start there.",
    ),
    row(
        "joint_state_max_age_s",
        Kind::Real { range: [1e-3, 3600.0], place: |p| &mut p.config.joint_state_max_age_s },
        "A joint state older than this no longer says where the robot stands: planning is refused until a new one arrives.",
    ),
    row(
        "handover",
        Kind::Flag(|p| &mut p.config.handover),
        "New poses take over from the trajectory under execution without a stop, and refusals may stop it. The controller must heed \
         header stamps, as joint_trajectory_controller does, and its clock must agree with that of this machine to milliseconds. If \
         false, trajectories start on arrival and a robot under way is refused. Off under use_sim_time.",
    ),
    row(
        "handover_lead_s",
        Kind::Real { range: [0.01, 3600.0], place: |p| &mut p.config.handover_lead_s },
        "How far ahead a new trajectory takes over. Planning that takes longer is done again with a longer lead.",
    ),
    row(
        "handover_tolerance_rad",
        Kind::Real { range: [1e-6, 10.0], place: |p| &mut p.config.handover_tolerance_rad },
        "A joint farther than this from where the trajectory under execution has it does not execute it.",
    ),
    row(
        "on_refusal",
        choice!(config.on_refusal, ["stop" => OnRefusal::Stop, "continue" => OnRefusal::Continue]),
        "what a robot under way does when new poses are refused. It stops on its planned path.",
    ),
    fixed(
        "robot.name",
        Kind::Text(|p| &mut p.robot.name),
        "A robot that is built in: ur5e, vx300s (ViperX 300) or panda; or give urdf_file and settings_file.",
    ),
    fixed("robot.urdf_file", Kind::Text(|p| &mut p.robot.urdf_file), "The URDF of another robot."),
    fixed(
        "robot.settings_file",
        Kind::Text(|p| &mut p.robot.settings_file),
        "Frames, acceleration and jerk limits, in the form of config/robots/ur5e.yaml; empty: those of the robot that is built in.",
    ),
    fixed(
        "robot.from_description",
        Kind::Flag(|p| &mut p.robot.from_description),
        "A URDF that is published on robot_description takes the place of the one above (a real arm's has its calibration); one that \
         does not fit the frames and joints of the settings is ignored, with a diagnostic.",
    ),
    row(
        "path.tolerance_m",
        Kind::Real { range: [1e-7, 1.0], place: |p| &mut p.config.path.tolerance_m },
        "How far the tool may be from the C2 curve, between poses too.",
    ),
    row(
        "path.tolerance_rad",
        Kind::Real { range: [1e-7, 3.2], place: |p| &mut p.config.path.tolerance_rad },
        "The same as an angle.",
    ),
    row(
        "path.least_singular_value",
        Kind::Real { range: [1e-9, 1.0], place: |p| &mut p.config.path.least_singular_value },
        "Where the Jacobian (rows in m and rad) has a singular value below this, the arm counts as singular.",
    ),
    row(
        "path.max_branches",
        Kind::Count { range: [1, 1000], place: |p| &mut p.config.path.max_branches },
        "How many configurations at the first pose are tried.",
    ),
    row(
        "timing.rate_hz",
        Kind::Real { range: [10.0, 10_000.0], place: |p| &mut p.config.timing.rate_hz },
        "Trajectory points a second.",
    ),
    row(
        "timing.velocity_scale",
        Kind::Real { range: SCALE, place: |p| &mut p.config.timing.velocity_scale },
        "Part of the robot's velocity limits that is used.",
    ),
    row(
        "timing.acceleration_scale",
        Kind::Real { range: SCALE, place: |p| &mut p.config.timing.acceleration_scale },
        "Part of the robot's acceleration limits that is used.",
    ),
    row(
        "timing.jerk_scale",
        Kind::Real { range: SCALE, place: |p| &mut p.config.timing.jerk_scale },
        "Part of the robot's jerk limits that is used.",
    ),
    row(
        "timing.limits",
        choice!(config.timing.limits, ["jerk" => JointLimits::Jerk, "acceleration" => JointLimits::Acceleration]),
        "velocity, acceleration and jerk limits, or no jerk limits (shorter, planned faster, harder on the arm).",
    ),
    row(
        "timing.torque",
        Kind::Flag(|p| &mut p.config.timing.torque),
        "Keep effort limits, where the URDF has inertias.",
    ),
    row(
        "timing.tool_speed_m_s",
        Kind::OptionalReal { range: OF_TOOL, place: |p| &mut p.config.timing.tool_speed_m_s },
        "Greatest speed of the tool; 0: no limit.",
    ),
    row(
        "timing.tool_acceleration_m_s2",
        Kind::OptionalReal { range: OF_TOOL, place: |p| &mut p.config.timing.tool_acceleration_m_s2 },
        "Greatest acceleration of the tool; 0: no limit.",
    ),
    row(
        "timing.constant_tool_speed_m_s",
        Kind::OptionalReal { range: OF_TOOL, place: |p| &mut p.config.timing.constant_tool_speed_m_s },
        "A speed to keep within 1 % between a ramp at each end (welding, gluing), or a refusal that says what can be held, and where; \
         0: none.",
    ),
];
