//! The run in figures.

use std::fmt::Write;

use mujoco_sim::{ContactEvent, Execution, PoseErrors, Sample, Sweep};
use serde::Serialize;

/// The JSON object of the command.
#[derive(Debug, Serialize)]
pub(crate) struct Summary {
    duration_s: f64,
    tracking_rms_rad: f64,
    tracking_max_rad: f64,
    /// Null where no report says when the poses are due.
    pose_error_max_m: Option<f64>,
    pose_error_max_rad: Option<f64>,
    contacts: usize,
    contact_events: Vec<Contact>,
    /// Null where no clearance was asked for.
    sweep: Option<Swept>,
    realtime_factor: f64,
    max_torque_ratio: f64,
    saturated_steps: usize,
    joints: Vec<Joint>,
    tracking: Tracking,
}

/// The tracking error over time, in a thousand rows at most.
#[derive(Debug, Serialize)]
struct Tracking {
    time_s: Vec<f64>,
    /// For each joint, in their order above: of all errors until the next time the one that is greatest in size.
    error_rad: Vec<Vec<f32>>,
}

const TRACKING_ROWS: usize = 1000;

/// What is met along the trajectory as it was planned.
#[derive(Debug, Serialize)]
struct Swept {
    contacts: Vec<Contact>,
    approaches: Vec<Contact>,
    checks: usize,
}

#[derive(Debug, Serialize)]
struct Contact {
    bodies: [String; 2],
    from_s: f64,
    until_s: f64,
    depth_max_m: f64,
}

#[derive(Debug, Serialize)]
struct Joint {
    name: String,
    tracking_rms_rad: f64,
    tracking_max_rad: f64,
    max_torque_ratio: f64,
}

impl Summary {
    pub(crate) fn of(execution: &Execution, errors: Option<PoseErrors>, sweep: Option<&Sweep>) -> Self {
        let events = |events: &[ContactEvent]| events.iter().map(Contact::of).collect::<Vec<_>>();
        let sweep = sweep.map(|sweep| Swept {
            contacts: events(&sweep.contacts),
            approaches: events(&sweep.approaches),
            checks: sweep.checks,
        });
        let joints = execution.joints.iter().map(|joint| Joint {
            name: joint.name.clone(),
            tracking_rms_rad: joint.rms_rad,
            tracking_max_rad: joint.max_rad,
            max_torque_ratio: joint.max_torque_ratio,
        });
        Self {
            duration_s: execution.duration_s,
            tracking_rms_rad: execution.tracking_rms_rad,
            tracking_max_rad: execution.tracking_max_rad,
            pose_error_max_m: errors.map(|errors| errors.max_m),
            pose_error_max_rad: errors.map(|errors| errors.max_rad),
            contacts: execution.contacts.len(),
            contact_events: events(&execution.contacts),
            sweep,
            realtime_factor: execution.realtime_factor,
            max_torque_ratio: execution.max_torque_ratio,
            saturated_steps: execution.saturated_steps,
            joints: joints.collect(),
            tracking: Tracking::of(execution),
        }
    }

    pub(crate) fn to_json(&self) -> String {
        // Numbers, strings and lists always have a JSON form.
        serde_json::to_string(self).unwrap_or_default()
    }

    pub(crate) fn to_text(&self) -> String {
        let mut text = format!(
            "trajectory   {:.3} s, simulated {:.0} times as fast as real time\n\
             tracking     {:.2e} rad rms, {:.2e} rad at worst\n\
             torque       {:.1} % of the limit at most, {} steps saturated\n",
            self.duration_s,
            self.realtime_factor,
            self.tracking_rms_rad,
            self.tracking_max_rad,
            100.0 * self.max_torque_ratio,
            self.saturated_steps,
        );
        if let (Some(metres), Some(radians)) = (self.pose_error_max_m, self.pose_error_max_rad) {
            text += &format!("poses        {metres:.2e} m and {radians:.2e} rad off at worst\n");
        }
        text += &format!("contacts     {}\n", self.contacts);
        list(&mut text, &self.contact_events);
        if let Some(sweep) = &self.sweep {
            let (contacts, approaches) = (sweep.contacts.len(), sweep.approaches.len());
            let _ =
                writeln!(text, "planned path {contacts} contacts, {approaches} approaches in {} checks", sweep.checks);
            list(&mut text, &sweep.approaches);
        }
        text
    }
}

/// A line an event. Writing to a string cannot fail.
fn list(text: &mut String, events: &[Contact]) {
    for Contact { bodies: [one, other], from_s, until_s, depth_max_m } in events {
        let how = if *depth_max_m >= 0.0 { "deep" } else { "apart" };
        let depth_mm = 1e3 * depth_max_m.abs();
        let _ = writeln!(text, "  {one} and {other}, {from_s:.3} to {until_s:.3} s, {depth_mm:.2} mm {how}");
    }
}

impl Tracking {
    fn of(execution: &Execution) -> Self {
        let rows = execution.samples.chunks(execution.samples.len().div_ceil(TRACKING_ROWS).max(1));
        let greatest = |row: &[Sample], joint: usize| {
            let errors = row.iter().map(|sample| sample.position[joint] - sample.reference[joint]);
            errors.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0) as f32
        };
        let of_joint = |joint| rows.clone().map(|row| greatest(row, joint)).collect();
        Self {
            time_s: rows.clone().map(|row| row[0].time_s).collect(),
            error_rad: (0..execution.joints.len()).map(of_joint).collect(),
        }
    }
}

impl Contact {
    fn of(event: &ContactEvent) -> Self {
        let ContactEvent { bodies, from_s, until_s, depth_max_m } = event.clone();
        Self { bodies, from_s, until_s, depth_max_m }
    }
}
