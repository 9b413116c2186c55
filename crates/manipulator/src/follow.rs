//! From a curve of tool poses to a path of the joints.

use nalgebra::DVector;
use se3_geom::PoseSpline;
use serde::Deserialize;

use crate::branches::first_configurations;
use crate::continuation::{Sample, Stopped, Tracker};
use crate::error::{ManipulatorError, Result};
use crate::joint_path::JointPath;
use crate::layers::{Layers, Route, SAME};
use crate::posture::{separation, turns_freely};
use crate::posture_spline::posture_through;
use crate::reach::out_of_reach;
use crate::relaxation::relax;
use crate::robot::Robot;
use crate::stations::{Station, stations};
use crate::tolerance::spline_within_tolerance;

/// How closely the joints follow the curve.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PathOptions {
    /// Greatest distance of the tool from the curve, also between samples, in m.
    pub tolerance_m: f64,
    /// Greatest angle of the tool from the curve, in rad.
    pub tolerance_rad: f64,
    /// Least singular value of the body Jacobian (rows in m and rad) that is not yet a singularity. At 5e-3 some joint turns 200 rad
    /// for each rad or m of the tool.
    pub least_singular_value: f64,
    /// How many different configurations at the first pose are tried.
    pub max_branches: usize,
}

impl Default for PathOptions {
    fn default() -> Self {
        Self { tolerance_m: 1e-4, tolerance_rad: 1e-3, least_singular_value: 5e-3, max_branches: 16 }
    }
}

impl PathOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// [`ManipulatorError::InvalidOption`].
    pub fn check(&self) -> Result<()> {
        // Samples are solved to 1e-9: tolerances far above that can be met by refinement.
        let bounded = [
            ("tolerance_m", self.tolerance_m, 1e-7),
            ("tolerance_rad", self.tolerance_rad, 1e-7),
            ("least_singular_value", self.least_singular_value, 1e-9),
            ("max_branches", self.max_branches as f64, 1.0),
        ];
        match bounded.into_iter().find(|(_, value, least)| !(value.is_finite() && value >= least)) {
            Some((name, value, _)) => {
                Err(ManipulatorError::InvalidOption { name, value, must_be: "finite and not that small" })
            }
            None => Ok(()),
        }
    }
}

/// Routes that are tried before an arm counts as unable to follow a curve.
const MAX_ROUTES: usize = 48;
/// Starts from which a redundant arm that found no route is led with least motion from sample to sample.
const LEAST_MOTION_STARTS: usize = 8;
/// How many times more stations a redundant arm without a route gets: narrow ways between limits and singularities show to close ones
/// only.
const CLOSER: f64 = 4.0;
/// Places between two poses that are looked at for being out of reach.
const PLACES: usize = 8;
/// Nearer than this to the first configuration, in rad or m, the robot stands there already.
const STANDS_THERE: f64 = 1e-3;

/// The joint path that keeps the tool on `curve` (poses `base_from_tool`).
///
/// The way is chosen over the whole curve: at stations along it the arm's configurations (elbows, wrists, and samples of the self-motion
/// where it has more than six joints) are found and joined, and dynamic programming takes the route with the least motion at the
/// velocity limits that stays away from position limits and singularities, the approach from the reference included. The
/// reference is `start` where given, else the robot's preferred configuration. A route that turns out not to be
/// continuous is taken out and the next one tried.
///
/// What self-motion is left is made smooth (least energy) and becomes a posture along the curve, a C⁴ function; the arm takes at each
/// parameter the configuration nearest to it, which is a smooth function again. Joints that turn freely get whole turns that
/// suit the whole path. At its ends the path has the first and second derivatives that the curve's twist and acceleration ask for.
///
/// On a closed curve the joints end where they began with the same rates, joints that turn freely perhaps by whole turns apart.
///
/// # Errors
/// [`ManipulatorError::TooFewJoints`] for an arm with fewer than six; [`ManipulatorError::Unreachable`] where some poses are out of reach; else the reason of the attempt that came farthest:
/// [`ManipulatorError::UnreachableBetween`], [`ManipulatorError::CutOff`], [`ManipulatorError::JointLimit`], [`ManipulatorError::Singular`], [`ManipulatorError::Jump`],
/// [`ManipulatorError::PathTolerance`] or [`ManipulatorError::NotCyclic`], with the index of the pose.
pub fn follow(
    robot: &Robot,
    curve: &PoseSpline,
    start: Option<&DVector<f64>>,
    options: &PathOptions,
) -> Result<JointPath> {
    options.check()?;
    if robot.chain.dof() < 6 {
        return Err(ManipulatorError::TooFewJoints { joints: robot.chain.dof() });
    }
    let reference = start.unwrap_or(&robot.preferred);
    robot.check_configuration("the start configuration", reference)?;
    robot.check_configuration("the preferred configuration", &robot.preferred)?;
    let tracker = Tracker { robot, curve, least_singular_value: options.least_singular_value, posture: None };
    let request = Request { tracker, stations: stations(curve, 1.0), afresh: false, reference, options };
    request.path().or_else(|stopped| {
        if let Some(misses) = out_of_reach(robot, curve, reference) {
            return Err(ManipulatorError::Unreachable(misses));
        }
        let thorough = || Request { stations: stations(curve, CLOSER), afresh: true, ..request.clone() }.path();
        let last = if robot.chain.dof() > 6 { thorough() } else { Err(stopped.clone()) };
        last.map_err(|last| {
            let farther = if last.parameter > stopped.parameter { last } else { stopped };
            true_reason(robot, curve, reference, farther.error).at_pose(farther.pose)
        })
    })
}

/// That one posture cannot go on does not say that none reaches the curve there.
fn true_reason(
    robot: &Robot,
    curve: &PoseSpline,
    reference: &DVector<f64>,
    error: ManipulatorError,
) -> ManipulatorError {
    let ManipulatorError::UnreachableBetween { pose, .. } = error else { return error };
    let knots = curve.knots();
    let to = pose.clamp(1, knots.len() - 1);
    let place = |part: usize| knots[to - 1] + (knots[to] - knots[to - 1]) * part as f64 / PLACES as f64;
    let missed = (0..=PLACES).find_map(|part| {
        let found = first_configurations(robot, &curve.pose(place(part)), reference);
        found.err().filter(|error| matches!(error, ManipulatorError::UnreachableBetween { .. }))
    });
    missed.unwrap_or(ManipulatorError::CutOff { pose })
}

#[derive(Clone)]
struct Request<'a> {
    tracker: Tracker<'a>,
    stations: Vec<Station>,
    /// Whether a redundant arm's configurations are looked for anew at every station: some appear only on the way.
    afresh: bool,
    reference: &'a DVector<f64>,
    options: &'a PathOptions,
}

impl Request<'_> {
    fn path(&self) -> std::result::Result<JointPath, Stopped> {
        let (tracker, robot) = (&self.tracker, self.tracker.robot);
        let begin = self.stations[0].s;
        let mut first = first_configurations(robot, &tracker.curve.pose(begin), self.reference)
            .map_err(|error| tracker.stopped(begin, error))?;
        let redundant = robot.chain.dof() > 6;
        if !redundant {
            first.truncate(self.options.max_branches);
        }
        let mut stops = Vec::new();
        let mut layers = Layers::build(tracker, &self.stations, first, self.reference, self.afresh, &mut stops);
        if self.afresh {
            // What was found anew may not be joined to the start: where it ends says nothing.
            stops.clear();
        }
        let one_way = layers.cheapest_open(robot);
        for _ in 0..MAX_ROUTES {
            let Some(route) = layers.cheapest(robot) else { break };
            match self.along(&route, redundant) {
                Ok(path) => return Ok(path),
                Err(NoPath::Stopped(stopped)) => {
                    let station = self.stations.partition_point(|station| station.s <= stopped.parameter);
                    layers.cut(&route, station.saturating_sub(1));
                    stops.push(stopped);
                }
                Err(NoPath::WoundUp(stopped)) => {
                    layers.cut_start(&route);
                    stops.push(stopped);
                }
            }
        }
        if redundant && tracker.curve.is_closed() {
            let ends = one_way.as_ref().and_then(|route| route.configurations.first().zip(route.configurations.last()));
            stops.extend(ends.and_then(|(first, last)| self.not_cyclic(first, last)));
        }
        let most = match redundant {
            false => usize::MAX,
            true if tracker.curve.is_closed() && !stops.is_empty() => 0,
            true => LEAST_MOTION_STARTS,
        };
        let mut ends = Vec::new();
        for q in layers.first_by_approach().into_iter().take(most) {
            match self.pose_by_pose(q) {
                Ok(path) => return Ok(path),
                Err(NoPath::Stopped(stopped) | NoPath::WoundUp(stopped)) => ends.push(stopped),
            }
        }
        // A link between stations may have stepped over a singularity: without redundancy these alone are where the branches end.
        if !redundant && !ends.is_empty() {
            stops.clear();
        }
        stops.append(&mut ends);
        let farthest = stops.into_iter().max_by(|a, b| a.parameter.total_cmp(&b.parameter));
        // Without any configuration at the first pose there was an error before.
        Err(farthest.unwrap_or_else(|| tracker.stopped(begin, ManipulatorError::NonFinite { what: "the curve" })))
    }

    /// The path along a route.
    fn along(&self, route: &Route, redundant: bool) -> std::result::Result<JointPath, NoPath> {
        let mut tracker = self.tracker.clone();
        let mut configurations = route.configurations.clone();
        if redundant {
            let hold_first = (&configurations[0] - self.reference).amax() < STANDS_THERE;
            relax(&tracker, &self.stations, &mut configurations, hold_first);
            tracker.posture = posture_through(&tracker, &self.stations, &configurations);
        }
        let samples = tracker.track(&configurations[0]);
        self.through(&tracker, samples)
    }

    /// The path with least motion from pose to pose, from a configuration at the first.
    fn pose_by_pose(&self, first: &DVector<f64>) -> std::result::Result<JointPath, NoPath> {
        let samples = self.tracker.track(first).map_err(NoPath::Stopped)?;
        let open = samples.last().filter(|_| self.tracker.curve.is_closed());
        if let Some(stopped) = open.and_then(|last| self.not_cyclic(&samples[0].q, &last.q)) {
            return Err(NoPath::Stopped(stopped));
        }
        self.through(&self.tracker, Ok(samples))
    }

    fn through(
        &self,
        tracker: &Tracker<'_>,
        samples: std::result::Result<Vec<Sample>, Stopped>,
    ) -> std::result::Result<JointPath, NoPath> {
        let mut samples = samples.map_err(NoPath::Stopped)?;
        let turns = whole_turns(tracker, &samples, self.reference).map_err(NoPath::WoundUp)?;
        let mut tracker = tracker.clone();
        if turns.amax() > 0.0 {
            samples.iter_mut().for_each(|sample| sample.q += &turns);
            tracker.posture = tracker.posture.map(|posture| posture.moved_by(&turns));
        }
        spline_within_tolerance(&tracker, samples, self.options).map_err(NoPath::Stopped)
    }

    /// The arm comes back in another configuration than it set out in.
    fn not_cyclic(&self, first: &DVector<f64>, last: &DVector<f64>) -> Option<Stopped> {
        let robot = self.tracker.robot;
        if separation(robot, first, last) < SAME {
            return None;
        }
        let apart = |joint: &usize| (last[*joint] - first[*joint]).abs();
        let joint = (0..first.len()).max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        let error = ManipulatorError::NotCyclic {
            joint: robot.chain.joint_names()[joint].clone(),
            from: first[joint],
            to: last[joint],
        };
        Some(self.tracker.stopped(self.tracker.curve.domain().1, error))
    }
}

/// Why a route is none.
enum NoPath {
    /// It cannot be followed from a station to the next.
    Stopped(Stopped),
    /// It can, but no choice of whole turns keeps a joint within its limits all along.
    WoundUp(Stopped),
}

/// The whole turns, in rad, that bring every freely turning joint within its limits all along and its start nearest to `reference`.
fn whole_turns(
    tracker: &Tracker<'_>,
    samples: &[Sample],
    reference: &DVector<f64>,
) -> std::result::Result<DVector<f64>, Stopped> {
    let (robot, turn) = (tracker.robot, std::f64::consts::TAU);
    let mut turns = DVector::zeros(reference.len());
    for joint in (0..reference.len()).filter(|&joint| turns_freely(robot, joint)) {
        let (lower, upper) = (robot.limits.lower[joint], robot.limits.upper[joint]);
        let range = samples.iter().map(|sample| sample.q[joint]);
        let (least, most) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), q| (lo.min(q), hi.max(q)));
        let fewest = ((lower - least - 1e-9) / turn).ceil();
        let greatest = ((upper - most + 1e-9) / turn).floor();
        let wanted = ((reference[joint] - samples[0].q[joint]) / turn).round();
        turns[joint] = turn * wanted.max(fewest).min(greatest);
        if fewest > greatest {
            // Beyond by more than rounding, which the turns allow for: there is one below, as they are as many as fit above.
            let beyond = |sample: &&Sample| {
                let q = sample.q[joint] + turns[joint];
                q < lower - 1e-9 || q > upper + 1e-9
            };
            let at = samples.iter().find(beyond).unwrap_or(&samples[0]);
            let error = ManipulatorError::JointLimit {
                pose: tracker.pose_after(at.s),
                joint: robot.chain.joint_names()[joint].clone(),
                value: at.q[joint] + turns[joint],
                lower,
                upper,
            };
            return Err(Stopped { parameter: at.s, pose: tracker.pose_after(at.s), error });
        }
    }
    Ok(turns)
}
