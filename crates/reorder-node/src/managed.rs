//! The services and the topic of a managed (lifecycle) node, which r2r has not.

use futures::stream::{BoxStream, StreamExt, select_all};
use r2r::lifecycle_msgs::msg;
use r2r::lifecycle_msgs::srv::{ChangeState, GetAvailableStates, GetAvailableTransitions, GetState};
use r2r::{Node, Publisher, QosProfile, ServiceRequest};

use crate::lifecycle::{LifeCycle, STATES, State, TRANSITIONS, Transition};

/// Somebody asks about the node's state, or wants another.
pub(crate) enum LifeCycleCall {
    Change(ServiceRequest<ChangeState::Service>),
    State(ServiceRequest<GetState::Service>),
    States(ServiceRequest<GetAvailableStates::Service>),
    Available(ServiceRequest<GetAvailableTransitions::Service>),
    Graph(ServiceRequest<GetAvailableTransitions::Service>),
}

pub(crate) struct LifeCycleServices {
    events: Publisher<msg::TransitionEvent>,
}

impl LifeCycleServices {
    pub(crate) fn create(node: &mut Node) -> r2r::Result<(Self, BoxStream<'static, LifeCycleCall>)> {
        let qos = QosProfile::services_default;
        let calls = [
            node.create_service("~/change_state", qos())?.map(LifeCycleCall::Change).boxed(),
            node.create_service("~/get_state", qos())?.map(LifeCycleCall::State).boxed(),
            node.create_service("~/get_available_states", qos())?.map(LifeCycleCall::States).boxed(),
            node.create_service("~/get_available_transitions", qos())?.map(LifeCycleCall::Available).boxed(),
            node.create_service("~/get_transition_graph", qos())?.map(LifeCycleCall::Graph).boxed(),
        ];
        let events = node.create_publisher("~/transition_event", QosProfile::default().reliable().keep_last(10))?;
        Ok((Self { events }, select_all(calls).boxed()))
    }

    /// Answers a call. A change of state is made, told and answered here; what it means for the node is the caller's.
    pub(crate) fn answer(&self, call: LifeCycleCall, life: &mut LifeCycle, stamp_ns: i64) -> r2r::Result<()> {
        match call {
            LifeCycleCall::Change(request) => {
                let wanted = &request.message.transition;
                let success = self.change(life, wanted.id, &wanted.label, stamp_ns)?;
                request.respond(ChangeState::Response { success })
            }
            LifeCycleCall::State(request) => request.respond(GetState::Response { current_state: state(life.state()) }),
            LifeCycleCall::States(request) => {
                request.respond(GetAvailableStates::Response { available_states: STATES.map(state).into() })
            }
            LifeCycleCall::Available(request) => {
                let available_transitions = life.available().map(description).collect();
                request.respond(GetAvailableTransitions::Response { available_transitions })
            }
            LifeCycleCall::Graph(request) => {
                let available_transitions = TRANSITIONS.map(description).into();
                request.respond(GetAvailableTransitions::Response { available_transitions })
            }
        }
    }

    /// Makes a transition and tells of its two steps; whether it was to be had.
    pub(crate) fn change(&self, life: &mut LifeCycle, id: u8, label: &str, stamp_ns: i64) -> r2r::Result<bool> {
        let Some(steps) = life.change(id, label) else { return Ok(false) };
        for step in steps {
            let description = description(step);
            self.events.publish(&msg::TransitionEvent {
                timestamp: stamp_ns as u64,
                transition: description.transition,
                start_state: description.start_state,
                goal_state: description.goal_state,
            })?;
        }
        Ok(true)
    }
}

fn state((id, label): State) -> msg::State {
    msg::State { id, label: label.into() }
}

fn description(transition: Transition) -> msg::TransitionDescription {
    msg::TransitionDescription {
        transition: msg::Transition { id: transition.id, label: transition.label.into() },
        start_state: state(transition.from),
        goal_state: state(transition.to),
    }
}
