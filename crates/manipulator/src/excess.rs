//! By how much a limit is broken, in digits that show it.

/// Where `value` is, and by how much beyond which of its limits, in words.
pub(crate) fn beyond(value: f64, lower: f64, upper: f64) -> String {
    let (by, which, limit) =
        if value < lower { (lower - value, "lower", lower) } else { (value - upper, "upper", upper) };
    format!("{value:.4}, {} rad (or m) beyond its {which} limit of {limit:.4}", figure(by))
}

/// Four decimals, or as many as it takes to tell an excess from nothing.
pub(crate) fn figure(excess: f64) -> String {
    if (1e-2..1e6).contains(&excess) { format!("{excess:.4}") } else { format!("{excess:.1e}") }
}
