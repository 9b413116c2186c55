//! What is wrong with a trajectory, in words.

use crate::audit::{Audit, AuditRules};
use crate::excess::figure;

impl Audit {
    /// What speaks against a trajectory that was judged under `rules`, in words: every limit that is exceeded, with its value where
    /// the rules state it, and by how much. Empty where nothing does.
    pub fn faults(&self, rules: &AuditRules) -> String {
        if !self.times_increase {
            return "it cannot be judged: its joints, its times, its numbers or the limits are not as they must be"
                .into();
        }
        let peaks = &self.max_ratio;
        let of_tool = |limit: Option<f64>, unit| limit.map(|limit| format!(" of {limit} {unit}"));
        let ratios = [
            ("a joint's velocity", Some(peaks.velocity), None),
            ("a joint's acceleration", Some(peaks.acceleration), None),
            ("a joint's jerk", Some(peaks.jerk).filter(|_| rules.jerk), None),
            ("a joint's torque", peaks.torque.filter(|_| rules.torque), None),
            ("the tool's speed", peaks.tool_speed, of_tool(rules.tool_speed_m_s, "m/s")),
            ("the tool's acceleration", peaks.tool_acceleration, of_tool(rules.tool_acceleration_m_s2, "m/s²")),
        ];
        let mut faults: Vec<String> = ratios
            .into_iter()
            .filter_map(|(what, ratio, limit)| {
                let above = figure(100.0 * (ratio.filter(|ratio| *ratio > 1.0)? - 1.0));
                Some(format!("{what} goes {above} % above its limit{}", limit.unwrap_or_default()))
            })
            .collect();
        if self.position_margin < -1e-9 {
            faults.push(format!("a joint goes {} rad (or m) beyond a position limit", figure(-self.position_margin)));
        }
        if !self.starts_and_ends_at_rest {
            faults.push("it does not begin as it must or does not end at rest".into());
        }
        faults.join(", ")
    }
}
