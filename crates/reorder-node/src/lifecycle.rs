//! The states of a managed node, as `rcl_lifecycle` has them.
//!
//! Nothing that the node does in a transition can fail or take time, so it is never seen in a transition state; the graph has them all
//! the same, because tools read it.

/// Id and label.
pub(crate) type State = (u8, &'static str);

const UNCONFIGURED: State = (1, "unconfigured");
const INACTIVE: State = (2, "inactive");
const ACTIVE: State = (3, "active");
const FINALIZED: State = (4, "finalized");
const CONFIGURING: State = (10, "configuring");
const CLEANING_UP: State = (11, "cleaningup");
const SHUTTING_DOWN: State = (12, "shuttingdown");
const ACTIVATING: State = (13, "activating");
const DEACTIVATING: State = (14, "deactivating");
const PROCESSING_ERROR: State = (15, "errorprocessing");

/// All states.
pub(crate) const STATES: [State; 11] = [
    (0, "unknown"),
    UNCONFIGURED,
    INACTIVE,
    ACTIVE,
    FINALIZED,
    CONFIGURING,
    CLEANING_UP,
    SHUTTING_DOWN,
    ACTIVATING,
    DEACTIVATING,
    PROCESSING_ERROR,
];

/// An edge of the graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Transition {
    pub(crate) id: u8,
    pub(crate) label: &'static str,
    pub(crate) from: State,
    pub(crate) to: State,
}

const fn edge(id: u8, label: &'static str, from: State, to: State) -> Transition {
    Transition { id, label, from, to }
}

const SUCCESS: &str = "transition_success";
const FAILURE: &str = "transition_failure";
const ERROR: &str = "transition_error";

/// All transitions, in the order in which `rcl_lifecycle` lists them.
pub(crate) const TRANSITIONS: [Transition; 25] = [
    edge(1, "configure", UNCONFIGURED, CONFIGURING),
    edge(10, SUCCESS, CONFIGURING, INACTIVE),
    edge(11, FAILURE, CONFIGURING, UNCONFIGURED),
    edge(12, ERROR, CONFIGURING, PROCESSING_ERROR),
    edge(2, "cleanup", INACTIVE, CLEANING_UP),
    edge(20, SUCCESS, CLEANING_UP, UNCONFIGURED),
    edge(21, FAILURE, CLEANING_UP, INACTIVE),
    edge(22, ERROR, CLEANING_UP, PROCESSING_ERROR),
    edge(3, "activate", INACTIVE, ACTIVATING),
    edge(30, SUCCESS, ACTIVATING, ACTIVE),
    edge(31, FAILURE, ACTIVATING, INACTIVE),
    edge(32, ERROR, ACTIVATING, PROCESSING_ERROR),
    edge(4, "deactivate", ACTIVE, DEACTIVATING),
    edge(40, SUCCESS, DEACTIVATING, INACTIVE),
    edge(41, FAILURE, DEACTIVATING, ACTIVE),
    edge(42, ERROR, DEACTIVATING, PROCESSING_ERROR),
    edge(5, "shutdown", UNCONFIGURED, SHUTTING_DOWN),
    edge(6, "shutdown", INACTIVE, SHUTTING_DOWN),
    edge(7, "shutdown", ACTIVE, SHUTTING_DOWN),
    edge(50, SUCCESS, SHUTTING_DOWN, FINALIZED),
    edge(51, FAILURE, SHUTTING_DOWN, FINALIZED),
    edge(52, ERROR, SHUTTING_DOWN, PROCESSING_ERROR),
    edge(60, SUCCESS, PROCESSING_ERROR, UNCONFIGURED),
    edge(61, FAILURE, PROCESSING_ERROR, FINALIZED),
    edge(62, ERROR, PROCESSING_ERROR, FINALIZED),
];

/// Where a node stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LifeCycle(State);

impl LifeCycle {
    pub(crate) fn unconfigured() -> Self {
        Self(UNCONFIGURED)
    }

    pub(crate) fn state(self) -> State {
        self.0
    }

    pub(crate) fn is_active(self) -> bool {
        self.0 == ACTIVE
    }

    /// What may be asked for now.
    pub(crate) fn available(self) -> impl Iterator<Item = Transition> {
        TRANSITIONS.into_iter().filter(move |transition| transition.from == self.0)
    }

    /// Makes the transition with that id, or that label where the id is 0 and a label is given; the two steps that it took, or none where
    /// it is not to be had from here.
    pub(crate) fn change(&mut self, id: u8, label: &str) -> Option<[Transition; 2]> {
        let by_label = id == 0 && !label.is_empty();
        let wanted = |t: &Transition| if by_label { t.label == label } else { t.id == id };
        let begun = self.available().find(wanted)?;
        let ended = TRANSITIONS.into_iter().find(|t| t.from == begun.to && t.label == SUCCESS)?;
        self.0 = ended.to;
        Some([begun, ended])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_goes_round_its_life() {
        let mut life = LifeCycle::unconfigured();
        for (id, label, state) in [
            (1, "", "inactive"),
            (0, "activate", "active"),
            (4, "", "inactive"),
            (3, "", "active"),
            (4, "", "inactive"),
            (2, "", "unconfigured"),
            (0, "shutdown", "finalized"),
        ] {
            let [begun, ended] = life.change(id, label).unwrap();
            assert_eq!((begun.to, ended.to.1, life.state().1), (ended.from, state, state));
        }
        assert_eq!(life.available().count(), 0);
    }

    #[test]
    fn what_is_not_to_be_had_changes_nothing() {
        let mut life = LifeCycle::unconfigured();
        for (id, label) in [(3, ""), (0, "deactivate"), (0, ""), (99, "configure"), (10, "")] {
            assert_eq!(life.change(id, label), None);
            assert_eq!(life, LifeCycle::unconfigured());
        }
        let ids: Vec<_> = life.available().map(|transition| transition.id).collect();
        assert_eq!(ids, [1, 5]);
    }
}
