//! Who touched whom.

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::MjContact;

/// One point at which two bodies touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Touch {
    /// Names of the two bodies; `world` is what does not move.
    pub bodies: [String; 2],
    /// How far they are inside each other, in m; negative where they are apart.
    pub depth_m: f64,
}

/// An unbroken span of time during which the same two shapes touch, or are nearer than was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEvent {
    /// Names of the two bodies.
    pub bodies: [String; 2],
    /// When it began, in s.
    pub from_s: f64,
    /// The last time at which they still did, in s.
    pub until_s: f64,
    /// Greatest depth in m; negative where they stay apart.
    pub depth_max_m: f64,
}

/// The points at which shapes are no farther apart than `within_m` in the present state.
pub(crate) fn touches(model: &MjModel, contacts: &[MjContact], within_m: f64) -> Vec<([i32; 2], Touch)> {
    let body_of = |geom: i32| {
        // Contacts of flexible bodies have no geom; such models have no rigid arm to name.
        let body = model.geom_bodyid().get(geom as usize).copied().unwrap_or_default() as usize;
        let name = model.id_to_name(MjtObjBase::mjOBJ_BODY, body).filter(|name| !name.is_empty());
        name.map_or_else(|| format!("body {body}"), str::to_owned)
    };
    let touching = contacts.iter().filter(|contact| contact.dist <= within_m);
    touching
        .map(|contact| (contact.geom, Touch { bodies: contact.geom.map(body_of), depth_m: -contact.dist }))
        .collect()
}

/// Joins the touches of successive steps to events.
#[derive(Debug, Default)]
pub(crate) struct ContactLog {
    events: Vec<ContactEvent>,
    /// The pairs of shapes that touched in the last step, with their events.
    open: Vec<([i32; 2], usize)>,
}

impl ContactLog {
    pub(crate) fn record(&mut self, time_s: f64, touches: Vec<([i32; 2], Touch)>) {
        let mut open: Vec<([i32; 2], usize)> = Vec::new();
        for (pair, touch) in touches {
            let known = open.iter().chain(&self.open).find(|(other, _)| *other == pair).map(|(_, event)| *event);
            let event = known.unwrap_or_else(|| {
                let Touch { bodies, depth_m } = touch.clone();
                self.events.push(ContactEvent { bodies, from_s: time_s, until_s: time_s, depth_max_m: depth_m });
                self.events.len() - 1
            });
            self.events[event].until_s = time_s;
            self.events[event].depth_max_m = self.events[event].depth_max_m.max(touch.depth_m);
            if !open.contains(&(pair, event)) {
                open.push((pair, event));
            }
        }
        self.open = open;
    }

    pub(crate) fn into_events(self) -> Vec<ContactEvent> {
        self.events
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touch(depth_m: f64) -> Touch {
        Touch { bodies: ["a".into(), "b".into()], depth_m }
    }

    #[test]
    fn an_event_lasts_until_the_touch_is_broken() {
        let mut log = ContactLog::default();
        // Two points of one pair are one event; a gap of one step ends it.
        log.record(0.1, vec![([1, 2], touch(0.01)), ([1, 2], touch(0.03))]);
        log.record(0.2, vec![([1, 2], touch(0.02)), ([1, 3], touch(0.0))]);
        log.record(0.3, vec![]);
        log.record(0.4, vec![([1, 2], touch(0.005))]);
        let spans: Vec<_> = log.into_events().iter().map(|e| (e.from_s, e.until_s, e.depth_max_m)).collect();
        assert_eq!(spans, [(0.1, 0.2, 0.03), (0.2, 0.2, 0.0), (0.4, 0.4, 0.005)]);
    }
}
