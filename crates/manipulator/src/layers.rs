//! Candidates for the configuration at every station, and which of them are joined.

use nalgebra::DVector;

use crate::branches::first_configurations;
use crate::continuation::{Sample, Stopped, Tracker};
use crate::ik::{IkOptions, descend};
use crate::posture::{discomfort, first_violation, self_motions, separation, turns_freely, unwound};
use crate::robot::Robot;
use crate::route::{Link, cheapest};
use crate::stations::Station;

/// Spacing of the candidates along a self-motion, in rad or m of the joint that moves most.
const SELF_MOTION_STEP: f64 = 0.4;
/// Two candidates of neighbouring layers are joined where no joint has farther to go than this beyond what the tool's way asks.
const LONGEST_LINK: f64 = 0.8;
/// Candidates a layer that are kept at most.
const MOST_CANDIDATES: usize = 64;
/// What a unit of discomfort costs against a second of motion, a metre or radian of the tool's way.
pub(crate) const DISCOMFORT_COST: f64 = 0.05;
/// Nearer than this, in rad or m, two configurations are one.
pub(crate) const SAME: f64 = 1e-5;

/// The candidates of every station with their links to the next.
pub(crate) struct Layers {
    candidates: Vec<Vec<DVector<f64>>>,
    links: Vec<Vec<Link>>,
    starts: Vec<f64>,
    closed: bool,
}

/// A choice of one candidate a station, whole turns resolved, with its place in the layers.
pub(crate) struct Route {
    pub(crate) configurations: Vec<DVector<f64>>,
    indices: Vec<usize>,
}

impl Layers {
    /// From the configurations `first` at the first station on. Without redundancy every candidate has one continuation, which is
    /// followed. With it the self-motions are sampled, and near candidates joined: whether they are so continuously shows when the
    /// route is followed.
    pub(crate) fn build(
        tracker: &Tracker<'_>,
        stations: &[Station],
        first: Vec<DVector<f64>>,
        reference: &DVector<f64>,
        afresh: bool,
        stops: &mut Vec<Stopped>,
    ) -> Self {
        let robot = tracker.robot;
        let redundant = robot.chain.dof() > 6;
        let closed = tracker.curve.is_closed();
        let mut samples: Vec<Sample> = Vec::new();
        for q in first {
            match tracker.sample(stations[0].s, &q) {
                Ok(sample) => samples.push(sample),
                Err(error) => stops.push(tracker.stopped(stations[0].s, error)),
            }
        }
        let approach = |q: &DVector<f64>| (q - reference).component_div(&robot.limits.velocity).norm();
        if redundant {
            spread(tracker, stations[0].s, &mut samples);
        }
        let starts = samples.iter().map(|sample| approach(&sample.q)).collect();
        let mut layers = Self { candidates: Vec::new(), links: Vec::new(), starts, closed };
        for (k, pair) in stations.windows(2).enumerate() {
            let last = k + 2 == stations.len();
            let next = if redundant && closed && last {
                // A lap that ends where it began.
                layers
                    .candidates
                    .first()
                    .unwrap_or(&Vec::new())
                    .iter()
                    .filter_map(|q| tracker.sample(pair[1].s, q).ok())
                    .collect()
            } else if redundant {
                carried(tracker, &samples, pair[1].s, afresh, stops)
            } else {
                Vec::new()
            };
            let (next, links) = if redundant {
                let links = near_links(robot, &samples, &next, pair[0].length);
                (next, links)
            } else {
                continued(tracker, &samples, pair[0].length, pair[1].s, stops)
            };
            layers.candidates.push(samples.into_iter().map(|sample| sample.q).collect());
            layers.links.push(links);
            samples = next;
            if samples.is_empty() {
                break;
            }
        }
        layers.candidates.push(samples.into_iter().map(|sample| sample.q).collect());
        layers
    }

    /// The cheapest route; on a closed curve of those that end where they began, whole turns apart.
    pub(crate) fn cheapest(&self, robot: &Robot) -> Option<Route> {
        let last = self.candidates.last()?;
        let indices = if self.closed {
            let from = |start: usize| {
                let mut starts = vec![f64::INFINITY; self.starts.len()];
                starts[start] = self.starts[start];
                let back = |end: usize| separation(robot, &last[end], &self.candidates[0][start]) < SAME;
                cheapest(&starts, &self.links, back)
            };
            (0..self.starts.len()).filter_map(from).min_by(|a, b| a.1.total_cmp(&b.1))?.0
        } else {
            cheapest(&self.starts, &self.links, |_| true)?.0
        };
        Some(self.route(robot, indices))
    }

    /// The cheapest route whether it ends where it began or not.
    pub(crate) fn cheapest_open(&self, robot: &Robot) -> Option<Route> {
        Some(self.route(robot, cheapest(&self.starts, &self.links, |_| true)?.0))
    }

    fn route(&self, robot: &Robot, indices: Vec<usize>) -> Route {
        let mut configurations: Vec<DVector<f64>> = Vec::with_capacity(indices.len());
        for (layer, &index) in self.candidates.iter().zip(&indices) {
            let q = &layer[index];
            let unwound = configurations.last().map_or_else(|| q.clone(), |before| unwound(robot, q, before));
            configurations.push(unwound);
        }
        Route { configurations, indices }
    }

    /// Takes the link that leads a route out of station `station` away: it is no continuous path.
    pub(crate) fn cut(&mut self, route: &Route, station: usize) {
        let station = station.min(self.links.len() - 1);
        let (from, to) = (route.indices[station], route.indices[station + 1]);
        self.links[station].retain(|link| (link.from, link.to) != (from, to));
    }

    /// Takes the candidate at which a route begins away.
    pub(crate) fn cut_start(&mut self, route: &Route) {
        self.starts[route.indices[0]] = f64::INFINITY;
    }

    /// Configurations of the first station that may be begun from, nearest to the reference first.
    pub(crate) fn first_by_approach(&self) -> Vec<&DVector<f64>> {
        let mut order: Vec<usize> = (0..self.starts.len()).filter(|&i| self.starts[i].is_finite()).collect();
        order.sort_by(|&a, &b| self.starts[a].total_cmp(&self.starts[b]));
        order.into_iter().map(|i| &self.candidates[0][i]).collect()
    }
}

/// Motion at constant rate over a way of `length`, ½‖Δq/v‖²/length, and discomfort at both ends: the integral of both along the
/// curve does not depend on how finely it is divided.
fn cost(robot: &Robot, way: &DVector<f64>, length: f64, discomforts: [f64; 2]) -> f64 {
    let effort = 0.5 * way.component_div(&robot.limits.velocity).norm_squared() / length;
    effort + 0.5 * DISCOMFORT_COST * length * (discomforts[0] + discomforts[1])
}

/// The continuation of every sample to parameter `to`.
fn continued(
    tracker: &Tracker<'_>,
    samples: &[Sample],
    length: f64,
    to: f64,
    stops: &mut Vec<Stopped>,
) -> (Vec<Sample>, Vec<Link>) {
    let robot = tracker.robot;
    let (mut next, mut links) = (Vec::new(), Vec::new());
    for (from, sample) in samples.iter().enumerate() {
        let mut way = vec![sample.clone()];
        if let Err(error) = tracker.advance(&mut way, to, 0) {
            stops.push(tracker.stopped(way[way.len() - 1].s, error));
            continue;
        }
        let pull = |sample: &Sample| discomfort(robot, &sample.q, &sample.jacobian);
        let pulls = way.iter().map(pull).collect::<Vec<_>>();
        let whole = way[way.len() - 1].s - sample.s;
        let step_cost = |k: usize| {
            let part = length * (way[k + 1].s - way[k].s) / whole;
            cost(robot, &(&way[k + 1].q - &way[k].q), part, [pulls[k], pulls[k + 1]])
        };
        let cost = (0..way.len() - 1).map(step_cost).sum();
        links.push(Link { from, to: next.len(), cost });
        next.extend(way.pop());
    }
    (next, links)
}

/// The samples carried on to parameter `to` with least motion, and what of their self-motions is not among them. One that would pass
/// a limit is held at it. With `afresh` configurations found from seeds all over the joints' ranges come to these: what limits part
/// from all that was before.
fn carried(tracker: &Tracker<'_>, samples: &[Sample], to: f64, afresh: bool, stops: &mut Vec<Stopped>) -> Vec<Sample> {
    let mut next: Vec<Sample> = Vec::new();
    for sample in samples {
        let there = tracker.sample(to, &sample.q).or_else(|error| {
            let held = held_within_limits(tracker, to, &sample.q).ok_or(error)?;
            tracker.sample(to, &held)
        });
        match there {
            Ok(there) if is_apart(tracker.robot, &next, &there.q) => next.push(there),
            Ok(_) => {}
            Err(error) => stops.push(tracker.stopped(sample.s, error)),
        }
    }
    if afresh {
        let seen = first_configurations(tracker.robot, &tracker.curve.pose(to), &tracker.robot.preferred);
        for q in seen.unwrap_or_default() {
            if let Ok(sample) = tracker.sample(to, &q)
                && is_apart(tracker.robot, &next, &sample.q)
            {
                next.push(sample);
            }
        }
    }
    spread(tracker, to, &mut next);
    next
}

/// A configuration of the tool's pose next to `q` whose joints go no farther than their limits, if there is one.
fn held_within_limits(tracker: &Tracker<'_>, s: f64, q: &DVector<f64>) -> Option<DVector<f64>> {
    let robot = tracker.robot;
    let mut limits = robot.limits.clone();
    for joint in (0..q.len()).filter(|&joint| turns_freely(robot, joint)) {
        (limits.lower[joint], limits.upper[joint]) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    descend(&robot.chain, &tracker.curve.pose(s), q, &IkOptions::default(), Some(&limits)).ok()
}

fn is_apart(robot: &Robot, samples: &[Sample], q: &DVector<f64>) -> bool {
    samples.iter().all(|known| separation(robot, &known.q, q) > 0.5 * SELF_MOTION_STEP)
}

/// Adds samples along the self-motions of those given, until these are covered as far as limits and singularities let them.
fn spread(tracker: &Tracker<'_>, s: f64, samples: &mut Vec<Sample>) {
    let robot = tracker.robot;
    let mut index = 0;
    while index < samples.len() && samples.len() < MOST_CANDIDATES {
        let Some(basis) = self_motions(&samples[index].jacobian) else {
            index += 1;
            continue;
        };
        for direction in basis.column_iter() {
            for sign in [-1.0, 1.0] {
                let seed = &samples[index].q + direction * (sign * SELF_MOTION_STEP / direction.amax());
                if first_violation(robot, &seed).is_some() || !is_apart(robot, samples, &seed) {
                    continue;
                }
                if let Ok(sample) = tracker.sample(s, &seed)
                    && is_apart(robot, samples, &sample.q)
                {
                    samples.push(sample);
                }
            }
        }
        index += 1;
    }
}

/// Links between all candidates that are near enough.
fn near_links(robot: &Robot, samples: &[Sample], next: &[Sample], length: f64) -> Vec<Link> {
    let pulls = |samples: &[Sample]| {
        samples.iter().map(|sample| discomfort(robot, &sample.q, &sample.jacobian)).collect::<Vec<f64>>()
    };
    let (pulls_from, pulls_to) = (pulls(samples), pulls(next));
    let mut links = Vec::new();
    for (from, a) in samples.iter().enumerate() {
        for (to, b) in next.iter().enumerate() {
            if separation(robot, &a.q, &b.q) < LONGEST_LINK {
                let way = unwound(robot, &b.q, &a.q) - &a.q;
                links.push(Link { from, to, cost: cost(robot, &way, length, [pulls_from[from], pulls_to[to]]) });
            }
        }
    }
    links
}

/// A configuration of the tool's pose next to `q`, if there is one.
pub(crate) fn settled(tracker: &Tracker<'_>, s: f64, q: &DVector<f64>) -> Option<DVector<f64>> {
    descend(&tracker.robot.chain, &tracker.curve.pose(s), q, &IkOptions::default(), None).ok()
}
