//! What is known of one parameter, and how it is read and written.

use r2r::ParameterValue;
use r2r::rcl_interfaces::msg::{FloatingPointRange, IntegerRange, ParameterDescriptor, ParameterType};

use super::Parameters;

/// One row of the table.
pub(crate) struct Declaration {
    pub(crate) name: &'static str,
    /// For whoever sets it: what it does, in what unit.
    pub(crate) about: &'static str,
    pub(crate) kind: Kind,
    /// Whether it is read at the start only.
    pub(crate) fixed: bool,
}

type Place<T> = fn(&mut Parameters) -> &mut T;

/// Type, range and place of a parameter.
pub(crate) enum Kind {
    Flag(Place<bool>),
    Real {
        range: [f64; 2],
        place: Place<f64>,
    },
    /// A number that may be absent; 0 says so.
    OptionalReal {
        range: [f64; 2],
        place: Place<Option<f64>>,
    },
    Count {
        range: [usize; 2],
        place: Place<usize>,
    },
    /// An index that may be absent; -1 says so.
    OptionalIndex(Place<Option<usize>>),
    Text(Place<String>),
    /// One of several words, which stand in the order of the values that they mean.
    Choice {
        words: &'static [&'static str],
        get: fn(&Parameters) -> usize,
        set: fn(&mut Parameters, usize),
    },
}

impl Declaration {
    pub(crate) fn get(&self, parameters: &Parameters) -> ParameterValue {
        // Places are mutable so that each is written down once; a copy is small.
        let mut copy = parameters.clone();
        match &self.kind {
            Kind::Flag(place) => ParameterValue::Bool(*place(&mut copy)),
            Kind::Real { place, .. } => ParameterValue::Double(*place(&mut copy)),
            Kind::OptionalReal { place, .. } => ParameterValue::Double(place(&mut copy).unwrap_or(0.0)),
            Kind::Count { place, .. } => ParameterValue::Integer(*place(&mut copy) as i64),
            Kind::OptionalIndex(place) => ParameterValue::Integer(place(&mut copy).map_or(-1, |index| index as i64)),
            Kind::Text(place) => ParameterValue::String(place(&mut copy).clone()),
            Kind::Choice { words, get, .. } => ParameterValue::String(words[get(parameters)].into()),
        }
    }

    /// Sets it, or says what is wrong; the sentence goes on after the parameter's name.
    pub(crate) fn set(&self, to: &mut Parameters, value: &ParameterValue, at_start: bool) -> Result<(), String> {
        if self.fixed && !at_start && *value != self.get(to) {
            return Err("is read at the start only: start the node with the new value".into());
        }
        let wrong_type = |wanted: &str| Err(format!("must be {wanted}, not a {}", value.type_name()));
        match (&self.kind, value) {
            (Kind::Flag(place), ParameterValue::Bool(flag)) => *place(to) = *flag,
            (Kind::Flag(_), _) => return wrong_type("true or false"),
            (Kind::Text(place), ParameterValue::String(text)) => place(to).clone_from(text),
            (Kind::Text(_), _) => return wrong_type("a string"),
            (Kind::Choice { words, set, .. }, ParameterValue::String(word)) => {
                let place = words.iter().position(|known| known == word);
                set(to, place.ok_or_else(|| format!("must be {}, not {word:?}", words.join(" or ")))?);
            }
            // YAML 1.1, which ROS reads, takes bare `on`, `off`, `yes` and `no` for booleans.
            (Kind::Choice { words, .. }, _) => return wrong_type(&format!("the string {}", words.join(" or "))),
            (Kind::Real { range, place }, _) => match number(value) {
                Some(x) => *place(to) = within(x, *range)?,
                None => return wrong_type("a number"),
            },
            (Kind::OptionalReal { range, place }, _) => match number(value) {
                Some(0.0) => *place(to) = None,
                Some(x) => *place(to) = Some(within(x, *range).map_err(|why| why + ", or 0 for none")?),
                None => return wrong_type("a number"),
            },
            (Kind::Count { range, place }, ParameterValue::Integer(n)) => {
                let allowed = usize::try_from(*n).ok().filter(|n| (range[0]..=range[1]).contains(n));
                let why = || format!("must be from {} to {}, not {n}", range[0], range[1]);
                *place(to) = allowed.ok_or_else(why)?;
            }
            (Kind::OptionalIndex(place), ParameterValue::Integer(n)) => {
                *place(to) = match n {
                    -1 => None,
                    n => Some(usize::try_from(*n).map_err(|_| format!("must be an index, or -1 for none, not {n}"))?),
                };
            }
            (Kind::Count { .. } | Kind::OptionalIndex(_), _) => return wrong_type("a whole number"),
        }
        Ok(())
    }

    /// The description with its range and when it is read, as one line.
    pub(crate) fn description(&self) -> String {
        let mut text = self.about.to_owned();
        match &self.kind {
            Kind::Real { range, .. } | Kind::OptionalReal { range, .. } => {
                text += &format!(" [{} … {}]", short(range[0]), short(range[1]));
            }
            Kind::Count { range, .. } => text += &format!(" [{} … {}]", range[0], range[1]),
            Kind::Choice { words, .. } => text = format!("{}: {text}", words.join(", ")),
            Kind::Flag(_) | Kind::OptionalIndex(_) | Kind::Text(_) => {}
        }
        if self.fixed { text + " (read at the start)" } else { text }
    }

    pub(crate) fn descriptor(&self) -> ParameterDescriptor {
        let (mut reals, mut integers, mut constraints) = (Vec::new(), Vec::new(), String::new());
        let kind = match &self.kind {
            Kind::Flag(_) => ParameterType::PARAMETER_BOOL as u8,
            Kind::Real { range: [from_value, to_value], .. } => {
                reals.push(FloatingPointRange { from_value: *from_value, to_value: *to_value, step: 0.0 });
                ParameterType::PARAMETER_DOUBLE as u8
            }
            Kind::OptionalReal { range, .. } => {
                constraints = format!("0, or from {} to {}", range[0], range[1]);
                ParameterType::PARAMETER_DOUBLE as u8
            }
            Kind::Count { range, .. } => {
                let [from_value, to_value] = range.map(|bound| bound as i64);
                integers.push(IntegerRange { from_value, to_value, step: 1 });
                ParameterType::PARAMETER_INTEGER as u8
            }
            Kind::OptionalIndex(_) => {
                integers.push(IntegerRange { from_value: -1, to_value: i64::MAX, step: 1 });
                ParameterType::PARAMETER_INTEGER as u8
            }
            Kind::Text(_) => ParameterType::PARAMETER_STRING as u8,
            Kind::Choice { words, .. } => {
                constraints = format!("one of {}", words.join(", "));
                ParameterType::PARAMETER_STRING as u8
            }
        };
        ParameterDescriptor {
            name: self.name.into(),
            type_: kind,
            description: self.description(),
            additional_constraints: constraints,
            read_only: self.fixed,
            floating_point_range: reals,
            integer_range: integers,
            ..ParameterDescriptor::default()
        }
    }
}

/// Integers are numbers too: `rate_hz:=100` is what people write.
fn number(value: &ParameterValue) -> Option<f64> {
    match value {
        ParameterValue::Double(x) => Some(*x),
        ParameterValue::Integer(n) => Some(*n as f64),
        _ => None,
    }
}

/// Without a row of zeros.
fn short(x: f64) -> String {
    if x != 0.0 && x < 1e-3 { format!("{x:e}") } else { x.to_string() }
}

fn within(x: f64, [least, most]: [f64; 2]) -> Result<f64, String> {
    if x >= least && x <= most { Ok(x) } else { Err(format!("must be from {least} to {most}, not {x}")) }
}
