//! The run in figures.

use std::fmt::Write;

use mujoco_sim::{Execution, PoseErrors};
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
    realtime_factor: f64,
    max_torque_ratio: f64,
    saturated_steps: usize,
    joints: Vec<Joint>,
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
    pub(crate) fn of(execution: &Execution, errors: Option<PoseErrors>) -> Self {
        let contact_events = execution.contacts.iter().map(|event| Contact {
            bodies: event.bodies.clone(),
            from_s: event.from_s,
            until_s: event.until_s,
            depth_max_m: event.depth_max_m,
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
            contact_events: contact_events.collect(),
            realtime_factor: execution.realtime_factor,
            max_torque_ratio: execution.max_torque_ratio,
            saturated_steps: execution.saturated_steps,
            joints: joints.collect(),
        }
    }

    pub(crate) fn to_json(&self) -> String {
        // Numbers, strings and lists always have a JSON form.
        serde_json::to_string(self).unwrap_or_default()
    }

    pub(crate) fn to_text(&self, execution: &Execution) -> String {
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
        for event in &execution.contacts {
            let [one, other] = &event.bodies;
            let (from, until, depth_mm) = (event.from_s, event.until_s, 1e3 * event.depth_max_m);
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {one} and {other}, {from:.3} to {until:.3} s, {depth_mm:.2} mm deep");
        }
        text
    }
}
