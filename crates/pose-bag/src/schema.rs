//! Message definitions as bags hold them (`ros2msg`: a `.msg` text, and those of its parts behind rulers), compared with ours.
//!
//! Only what ours has is descended into, so that a definition that contains itself, or unfolds to billions of fields, costs no more
//! than its text.

use std::collections::HashMap;

/// Longer than any definition; a longer text is not read.
const MAX_BYTES: usize = 1 << 18;

/// How the definition of a message in a bag differs from the one that is read here, as a phrase that names the field; `None` where
/// their CDR forms are the same. Constants, defaults, bounds and comments make no difference to it.
pub(crate) fn difference(message_type: &str, theirs: &str, ours: &str) -> Option<String> {
    if theirs.len() > MAX_BYTES {
        return Some(format!("its definition has {} bytes, more than the {MAX_BYTES} that are read", theirs.len()));
    }
    let root = short(message_type);
    let both = Both { theirs: parse(&root, theirs), ours: parse(&root, ours) };
    both.compare(&root, &root, "")
}

/// The fields of every type, by `package/Name`.
type Definitions<'a> = HashMap<String, Vec<Field<'a>>>;

struct Field<'a> {
    name: &'a str,
    /// Type without array brackets and bounds: a builtin, or `package/Name`.
    base: String,
    array: Array<'a>,
}

#[derive(PartialEq, Eq)]
enum Array<'a> {
    None,
    Fixed(&'a str),
    Sequence,
}

impl Field<'_> {
    fn kind(&self) -> String {
        match self.array {
            Array::None => self.base.clone(),
            Array::Fixed(length) => format!("{}[{length}]", self.base),
            Array::Sequence => format!("{}[]", self.base),
        }
    }
}

struct Both<'a> {
    theirs: Definitions<'a>,
    ours: Definitions<'a>,
}

impl Both<'_> {
    fn compare(&self, their_type: &str, our_type: &str, place: &str) -> Option<String> {
        let Some(theirs) = self.theirs.get(their_type) else {
            return Some(format!("its definition lacks that of {their_type}"));
        };
        let ours = self.ours.get(our_type).map_or(&[][..], Vec::as_slice);
        let lacks = |fields: &[Field<'_>], name: &str| fields.iter().all(|field| field.name != name);
        for at in 0..theirs.len().max(ours.len()) {
            match (theirs.get(at), ours.get(at)) {
                (Some(found), Some(expected)) if found.name == expected.name => {
                    let differs = self.compare_field(found, expected, &format!("{place}{}", found.name));
                    if differs.is_some() {
                        return differs;
                    }
                }
                (Some(extra), _) if lacks(ours, extra.name) => {
                    return Some(format!("it has the extra field {place}{}", extra.name));
                }
                (_, Some(missing)) if lacks(theirs, missing.name) => {
                    return Some(format!("the field {place}{} is missing", missing.name));
                }
                (Some(field), _) | (None, Some(field)) => {
                    return Some(format!("the field {place}{} is not in its place", field.name));
                }
                (None, None) => {}
            }
        }
        None
    }

    fn compare_field(&self, found: &Field<'_>, expected: &Field<'_>, place: &str) -> Option<String> {
        let is_message = self.ours.contains_key(&expected.base);
        let same_base = if is_message { !is_builtin(&found.base) } else { found.base == expected.base };
        if !same_base || found.array != expected.array {
            return Some(format!("the field {place} is {} instead of {}", found.kind(), expected.kind()));
        }
        if is_message { self.compare(&found.base, &expected.base, &format!("{place}.")) } else { None }
    }
}

/// What is no field of a message is passed over: where it should be one, that one is missing.
fn parse<'a>(root: &str, text: &'a str) -> Definitions<'a> {
    let mut types = HashMap::new();
    let mut of = root.to_owned();
    let mut fields = Vec::new();
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if let Some(name) = line.strip_prefix("MSG:") {
            types.insert(std::mem::replace(&mut of, short(name.trim())), std::mem::take(&mut fields));
        } else {
            fields.extend(field(line, &of));
        }
    }
    types.insert(of, fields);
    types
}

/// The field in a line; `None` for a constant and for what is neither.
fn field<'a>(line: &'a str, of: &str) -> Option<Field<'a>> {
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| c.is_whitespace() || c == '=').unwrap_or(rest.len());
    let (name, after) = rest.split_at(end);
    if name.is_empty() || after.trim_start().starts_with('=') {
        return None;
    }
    let (base, array) = match kind.split_once('[') {
        None => (kind, Array::None),
        Some((base, length)) => match length.trim_end_matches(']') {
            length if length.is_empty() || length.starts_with("<=") => (base, Array::Sequence),
            length => (base, Array::Fixed(length)),
        },
    };
    let base = match base.split("<=").next().unwrap_or_default() {
        "byte" | "char" => "uint8".to_owned(),
        "Header" => "std_msgs/Header".to_owned(),
        base if is_builtin(base) => base.to_owned(),
        base if base.contains('/') => short(base),
        base => format!("{}/{base}", of.split('/').next().unwrap_or_default()),
    };
    Some(Field { name, base, array })
}

fn is_builtin(name: &str) -> bool {
    const BUILTIN: [&str; 13] = [
        "bool", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64",
        "string", "wstring",
    ];
    BUILTIN.contains(&name)
}

/// `package/Name` of `package/msg/Name`.
fn short(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::{MarkerArray, Message, Odometry, PoseStamped};

    fn of(theirs: &str) -> Option<String> {
        difference(PoseStamped::TYPE, theirs, PoseStamped::DEFINITION)
    }

    #[test]
    fn the_same_layout_in_other_words() {
        let header = "# when and where\nHeader header  # stamp\nint32 VERSION = 3\nstring NAME=\"a # b\"";
        let theirs = PoseStamped::DEFINITION
            .replace("std_msgs/Header header", header)
            .replace("string frame_id", "string<=20 frame_id 'map'")
            .replace("Quaternion orientation", "geometry_msgs/msg/Quaternion orientation")
            .replace("float64 x 0", "float64  x");
        assert_ne!(theirs, PoseStamped::DEFINITION);
        assert_eq!(of(&theirs), None);
        for (ours, name) in [(Odometry::DEFINITION, Odometry::TYPE), (MarkerArray::DEFINITION, MarkerArray::TYPE)] {
            assert_eq!(difference(name, ours, ours), None);
        }
    }

    #[test]
    fn fields_that_differ_are_named() {
        let ours = PoseStamped::DEFINITION;
        let position = "Point position\n";
        let cases = [
            (ours.replace(position, &format!("{position}float32 quality\n")), "it has the extra field pose.quality"),
            (ours.replace(position, ""), "the field pose.position is missing"),
            (ours.replace("float64 z\n", ""), "the field pose.position.z is missing"),
            (
                ours.replace("float64 z 0\nfloat64 w 1\n", "float64 w\nfloat64 z\n"),
                "the field pose.orientation.w is not in its place",
            ),
            (ours.replace("float64 y\n", "float32 y\n"), "the field pose.position.y is float32 instead of float64"),
            (
                ours.replace("uint32 nanosec", "uint32[] nanosec"),
                "the field header.stamp.nanosec is uint32[] instead of uint32",
            ),
            (
                ours.replace("Pose pose", "Pose[3] pose"),
                "the field pose is geometry_msgs/Pose[3] instead of geometry_msgs/Pose",
            ),
            (ours.replace("Pose pose", "float64 pose"), "the field pose is float64 instead of geometry_msgs/Pose"),
            (
                ours.replace("MSG: geometry_msgs/Point", "MSG: geometry_msgs/Spot"),
                "its definition lacks that of geometry_msgs/Point",
            ),
            (format!("{ours}float64 v\n"), "it has the extra field pose.orientation.v"),
            (
                ours.replace("float64 w 1\n", "float64 w\nfloat64 w\n"),
                "the field pose.orientation.w is not in its place",
            ),
            ("x".repeat(MAX_BYTES + 1), "its definition has 262145 bytes, more than the 262144 that are read"),
        ];
        for (theirs, expected) in cases {
            assert_eq!(of(&theirs).as_deref(), Some(expected));
        }
    }

    #[test]
    fn a_definition_that_contains_itself_ends() {
        let cyclic = PoseStamped::DEFINITION.replace("Point position", "Pose position");
        assert_eq!(of(&cyclic).as_deref(), Some("it has the extra field pose.position.position"));
    }
}
