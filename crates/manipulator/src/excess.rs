//! By how much a limit is broken, in digits that show it.

/// Where `value` is, and by how much beyond which of its limits, in words.
pub(crate) fn beyond(value: f64, lower: f64, upper: f64) -> String {
    let (by, which, limit) =
        if value < lower { (lower - value, "lower", lower) } else { (value - upper, "upper", upper) };
    let at = if value.abs() < 1e6 { format!("{value:.4}") } else { format!("{value:.1e}") };
    format!("{at}, {} rad (or m) beyond its {which} limit of {limit:.4}", figure(by))
}

/// What a joint lacks of the torque that it needs, both of which are given, to hold or to move the arm, in words.
pub(crate) fn too_weak(
    pose: Option<usize>,
    configuration: &[f64],
    moving: bool,
    [needed, effort]: [f64; 2],
    unit: &str,
) -> String {
    let what = if moving { "move the arm against gravity and dry friction" } else { "hold the arm still" };
    let place = pose.map_or_else(|| format!("at {configuration:.2?}"), |pose| format!("near pose {pose}"));
    let lacks = match needed > effort {
        true => format!("{} {unit} more than its limit", figure(needed - effort)),
        false => "all that its limit allows".into(),
    };
    format!("{needed:.2} {unit} to {what} {place}, {lacks}")
}

/// Four decimals, or as many as it takes to tell an excess from nothing.
pub(crate) fn figure(excess: f64) -> String {
    if (1e-2..1e6).contains(&excess) { format!("{excess:.4}") } else { format!("{excess:.1e}") }
}
