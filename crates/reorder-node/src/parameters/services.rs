//! The services that every ROS 2 node has for its parameters, and the topic that tells of changes.
//!
//! r2r has a handler of its own, but it declares no ranges, checks changes one by one also where all or none are asked for, and tells
//! nobody of them.

use futures::stream::{BoxStream, StreamExt, select_all};
use r2r::rcl_interfaces::msg::{
    ListParametersResult, Parameter, ParameterDescriptor, ParameterEvent, SetParametersResult,
};
use r2r::rcl_interfaces::srv::{
    DescribeParameters, GetParameterTypes, GetParameters, ListParameters, SetParameters, SetParametersAtomically,
};
use r2r::{Node, ParameterValue, Publisher, QosProfile, ServiceRequest};

use super::{Change, Parameters, TABLE, find};
use crate::message::{parameter_from_message, parameter_value_message, time};

/// Somebody asks about parameters, or wants them changed.
pub(crate) enum ParameterCall {
    Set(ServiceRequest<SetParameters::Service>),
    SetAtomically(ServiceRequest<SetParametersAtomically::Service>),
    Get(ServiceRequest<GetParameters::Service>),
    Types(ServiceRequest<GetParameterTypes::Service>),
    Describe(ServiceRequest<DescribeParameters::Service>),
    List(ServiceRequest<ListParameters::Service>),
}

pub(crate) struct ParameterServices {
    events: Publisher<ParameterEvent>,
    node: String,
}

impl ParameterServices {
    pub(crate) fn create(node: &mut Node) -> r2r::Result<(Self, BoxStream<'static, ParameterCall>)> {
        let qos = QosProfile::parameters;
        let calls = [
            node.create_service("~/set_parameters", qos())?.map(ParameterCall::Set).boxed(),
            node.create_service("~/set_parameters_atomically", qos())?.map(ParameterCall::SetAtomically).boxed(),
            node.create_service("~/get_parameters", qos())?.map(ParameterCall::Get).boxed(),
            node.create_service("~/get_parameter_types", qos())?.map(ParameterCall::Types).boxed(),
            node.create_service("~/describe_parameters", qos())?.map(ParameterCall::Describe).boxed(),
            node.create_service("~/list_parameters", qos())?.map(ParameterCall::List).boxed(),
        ];
        let events = node.create_publisher("/parameter_events", QosProfile::parameter_events())?;
        let name = node.fully_qualified_name()?;
        Ok((Self { events, node: name }, select_all(calls).boxed()))
    }

    /// Tells of all parameters, when the node starts.
    pub(crate) fn declare(&self, parameters: &Parameters, stamp_ns: i64) -> r2r::Result<()> {
        let new_parameters = TABLE.iter().map(|row| parameter_message(row.name, row.get(parameters))).collect();
        self.tell(ParameterEvent { new_parameters, ..ParameterEvent::default() }, stamp_ns)
    }

    /// Answers a call, changes the parameters if that was asked for and is allowed, and says which have become what.
    pub(crate) fn answer(
        &self,
        call: ParameterCall,
        parameters: &mut Parameters,
        stamp_ns: i64,
    ) -> r2r::Result<Vec<Change>> {
        let mut changed = Vec::new();
        match call {
            ParameterCall::Set(request) => {
                let changes: Vec<_> = request.message.parameters.iter().map(parameter_from_message).collect();
                let results = changes.into_iter().map(|change| apply(parameters, vec![change], &mut changed)).collect();
                request.respond(SetParameters::Response { results })?;
            }
            ParameterCall::SetAtomically(request) => {
                let changes = request.message.parameters.iter().map(parameter_from_message).collect();
                let result = apply(parameters, changes, &mut changed);
                request.respond(SetParametersAtomically::Response { result })?;
            }
            ParameterCall::Get(request) => {
                let value = |name: &String| parameter_value_message(parameters.get(name));
                let values = request.message.names.iter().map(value).collect();
                request.respond(GetParameters::Response { values })?;
            }
            ParameterCall::Types(request) => {
                let kind = |name: &String| find(name).map_or(0, |row| row.descriptor().type_);
                let types = request.message.names.iter().map(kind).collect();
                request.respond(GetParameterTypes::Response { types })?;
            }
            ParameterCall::Describe(request) => {
                let unknown = |name: &String| ParameterDescriptor { name: name.clone(), ..Default::default() };
                let describe = |name: &String| find(name).map_or_else(|| unknown(name), |row| row.descriptor());
                let descriptors = request.message.names.iter().map(describe).collect();
                request.respond(DescribeParameters::Response { descriptors })?;
            }
            ParameterCall::List(request) => {
                let result = list(&request.message.prefixes, request.message.depth);
                request.respond(ListParameters::Response { result })?;
            }
        }
        if !changed.is_empty() {
            let changed_parameters =
                changed.iter().map(|(name, value)| parameter_message(name, value.clone())).collect();
            self.tell(ParameterEvent { changed_parameters, ..ParameterEvent::default() }, stamp_ns)?;
        }
        Ok(changed)
    }

    fn tell(&self, event: ParameterEvent, stamp_ns: i64) -> r2r::Result<()> {
        self.events.publish(&ParameterEvent { stamp: time(stamp_ns), node: self.node.clone(), ..event })
    }
}

/// Makes all of the changes or none, and notes those that were made, as they now are.
fn apply(parameters: &mut Parameters, changes: Vec<Change>, changed: &mut Vec<Change>) -> SetParametersResult {
    match parameters.with(&changes) {
        Ok(next) => {
            let differs = |(name, _): Change| {
                let value = next.get(&name).filter(|value| parameters.get(&name).as_ref() != Some(value));
                value.map(|value| (name, value))
            };
            changed.extend(changes.into_iter().filter_map(differs));
            *parameters = next;
            SetParametersResult { successful: true, reason: String::new() }
        }
        Err(reason) => SetParametersResult { successful: false, reason },
    }
}

/// Names under any of the prefixes (all without prefixes), and the groups they are in; `depth` bounds the levels below a prefix, 0 does not.
fn list(prefixes: &[String], depth: u64) -> ListParametersResult {
    let shallow = |rest: &str| depth == 0 || (rest.matches('.').count() as u64) < depth;
    let wanted = |name: &str| {
        let under = |prefix: &String| {
            let below = name.strip_prefix(prefix.as_str()).and_then(|rest| rest.strip_prefix('.'));
            name == prefix || below.is_some_and(shallow)
        };
        if prefixes.is_empty() { shallow(name) } else { prefixes.iter().any(under) }
    };
    let names: Vec<String> = TABLE.iter().map(|row| row.name.to_owned()).filter(|name| wanted(name)).collect();
    let mut groups: Vec<String> =
        names.iter().filter_map(|name| name.rsplit_once('.')).map(|(group, _)| group.to_owned()).collect();
    groups.dedup();
    ListParametersResult { names, prefixes: groups }
}

fn parameter_message(name: &str, value: ParameterValue) -> Parameter {
    Parameter { name: name.into(), value: parameter_value_message(Some(value)) }
}
