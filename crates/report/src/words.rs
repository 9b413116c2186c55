//! What speaks for and against an order, for a person.

use planner::reorder::{Certificate, Condition, EdgeFigures, Method, Ordering, Topology, Verdict};
use serde::Serialize;

/// Doubts and rows that are written out; the rest is counted.
const SHOWN: usize = 12;
/// Edges that are written out.
const WORST: usize = 5;

/// One thing that is known, and the word it is found by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statement {
    /// What it is about.
    pub about: &'static str,
    /// What is known, without a full stop.
    pub says: String,
}

pub(crate) fn statement(about: &'static str, says: impl Into<String>) -> Statement {
    Statement { about, says: says.into() }
}

/// All that is known about an order as lines of text, doubts last.
pub fn explain(ordering: &Ordering, edges: &[EdgeFigures]) -> String {
    let mut lines = vec![shape(ordering)];
    lines.extend(certificate(ordering, edges).iter().map(|s| format!("{:<12}{}", s.about, s.says)));
    for doubt in ordering.doubts.iter().take(SHOWN) {
        lines.push(format!("doubt       points {} and {}: {}", doubt.at[0], doubt.at[1], doubt.why));
    }
    if ordering.doubts.len() > SHOWN {
        lines.push(format!("            and {} more", ordering.doubts.len() - SHOWN));
    }
    lines.join("\n") + "\n"
}

/// How many points on what: "200 points on an open curve".
pub(crate) fn shape(ordering: &Ordering) -> String {
    let shape = match ordering.parts.len() {
        0 => curve(ordering.topology).to_owned(),
        parts if ordering.outliers.is_empty() => counted(parts, "curve"),
        parts => format!("{}, {} on none", counted(parts, "curve"), counted(ordering.outliers.len(), "point")),
    };
    format!("{} on {shape}", counted(ordering.n, "point"))
}

/// Everything but the doubts.
pub(crate) fn certificate(ordering: &Ordering, edges: &[EdgeFigures]) -> Vec<Statement> {
    let verdict = match ordering.verdict {
        Verdict::Certified => "certified: the hypotheses of a reconstruction theorem hold with margin",
        Verdict::Plausible => "plausible: every test agrees, nothing is proven",
        Verdict::Ambiguous => "ambiguous: something speaks against this order",
    };
    let mut statements = vec![statement("verdict", verdict)];
    parts(&mut statements, ordering);
    statements.push(statement("method", method(ordering)));
    if let Some(length) = ordering.metres_per_radian {
        let kept = match ordering.weight_stable {
            Some(true) => "with half or twice of it the order is the same",
            Some(false) => "with half or twice of it the order is another",
            None => "others were not tried",
        };
        statements.push(statement("weight", format!("one radian counts as {} m; {kept}", figure(length))));
    }
    sampling(&mut statements, &ordering.certificate, edges);
    for Condition { what, value, bound, holds } in
        ordering.certificate.conditions(ordering.topology == Topology::Closed)
    {
        let holds = if holds { "holds" } else { "fails" };
        statements.push(statement("to certify", format!("{what}: {}, bound {bound}: {holds}", figure(value))));
    }
    if !ordering.duplicates.is_empty() {
        let groups = counted(ordering.duplicates.len(), "group");
        statements.push(statement("equal", format!("{groups} of equal points")));
    }
    statements
}

fn curve(topology: Topology) -> &'static str {
    match topology {
        Topology::Open => "an open curve",
        Topology::Closed => "a closed curve",
    }
}

fn parts(statements: &mut Vec<Statement>, ordering: &Ordering) {
    for (rows, part) in ordering.components.iter().zip(&ordering.parts) {
        let (n, first) = (counted(rows.len(), "point"), rows[0]);
        let verdict = format!("{:?}", part.verdict).to_lowercase();
        statements.push(statement("curve", format!("{n} from point {first} on: {}, {verdict}", curve(part.topology))));
    }
    if !ordering.outliers.is_empty() {
        let rows: Vec<String> = ordering.outliers.iter().take(SHOWN).map(usize::to_string).collect();
        let more = if ordering.outliers.len() > SHOWN { ", …" } else { "" };
        let apart = counted(ordering.outliers.len(), "point");
        statements.push(statement("apart", format!("{apart} on no curve: {}{more}", rows.join(", "))));
    }
}

fn method(ordering: &Ordering) -> String {
    match (ordering.method, &ordering.repaired) {
        (_, Some(repaired)) => format!(
            "short path of little turning: it leaves {} of the minimum spanning tree and has {} of its own",
            counted(repaired.dropped.len(), "edge"),
            repaired.added.len()
        ),
        (Method::NnCrust, _) => "NN-CRUST: nearest neighbours on either side".to_owned(),
        (Method::Crust, _) => "CRUST: Voronoi and Delaunay edges".to_owned(),
        (Method::Nearest, _) => "nearest-neighbour chain".to_owned(),
        (Method::Mst | Method::Repaired, _) => "minimum spanning tree".to_owned(),
    }
}

fn sampling(statements: &mut Vec<Statement>, certificate: &Certificate, edges: &[EdgeFigures]) {
    statements.push(statement("gaps", format!("{} at most", figure(certificate.max_gap))));
    if let Some((reach, epsilon)) = certificate.reach.zip(certificate.epsilon) {
        let reach = figure(reach);
        let says = format!("{reach} estimated; epsilon = gap/(2 reach) = {epsilon:.3}, the theorem asks for < 1");
        statements.push(statement("reach", says));
    }
    let mut worst: Vec<&EdgeFigures> = edges.iter().filter(|edge| edge.epsilon > 0.0).collect();
    worst.sort_by(|a, b| b.epsilon.total_cmp(&a.epsilon));
    for EdgeFigures { at: [a, b], gap, epsilon, .. } in worst.into_iter().take(WORST) {
        let says = format!("points {a} and {b}: gap {}, epsilon {epsilon:.3}", figure(*gap));
        statements.push(statement("edge", says));
    }
    if let Some((radius, margin)) = certificate.injectivity_radius.zip(certificate.margin) {
        let (radius, margin) = (figure(radius), figure(margin));
        statements.push(statement("geodesics", format!("unique within {radius}: {margin} more than the longest gap")));
    }
}

/// Six decimals, or an exponent where they would be all zeros or none would matter.
fn figure(value: f64) -> String {
    if value == 0.0 || (1e-4..1e6).contains(&value.abs()) { format!("{value:.6}") } else { format!("{value:.6e}") }
}

/// "1 point", "2 points".
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
