//! What speaks for and against an order, for a person.

use planner::reorder::{Condition, EdgeFigures, Method, Ordering, Topology, Verdict};

/// Doubts that are written out; the rest is counted.
const SHOWN: usize = 12;
/// Edges that are written out.
const WORST: usize = 5;

pub(crate) fn explain(ordering: &Ordering, edges: &[EdgeFigures]) -> String {
    let curve = |topology| match topology {
        Topology::Open => "an open curve",
        Topology::Closed => "a closed curve",
    };
    let shape = match ordering.parts.len() {
        0 => curve(ordering.topology).to_owned(),
        parts if ordering.outliers.is_empty() => counted(parts, "curve"),
        parts => format!("{}, {} on none", counted(parts, "curve"), counted(ordering.outliers.len(), "point")),
    };
    let verdict = match ordering.verdict {
        Verdict::Certified => "certified: the hypotheses of a reconstruction theorem hold with margin",
        Verdict::Plausible => "plausible: every test agrees, nothing is proven",
        Verdict::Ambiguous => "ambiguous: something speaks against this order",
    };
    let mut lines = vec![format!("{} on {shape}", counted(ordering.n, "point")), format!("verdict     {verdict}")];
    for (rows, part) in ordering.components.iter().zip(&ordering.parts) {
        let (n, first) = (counted(rows.len(), "point"), rows[0]);
        let verdict = format!("{:?}", part.verdict).to_lowercase();
        lines.push(format!("curve       {n} from point {first} on: {}, {verdict}", curve(part.topology)));
    }
    if !ordering.outliers.is_empty() {
        let rows: Vec<String> = ordering.outliers.iter().take(SHOWN).map(usize::to_string).collect();
        let more = if ordering.outliers.len() > SHOWN { ", …" } else { "" };
        lines.push(format!(
            "apart       {} on no curve: {}{more}",
            counted(ordering.outliers.len(), "point"),
            rows.join(", ")
        ));
    }
    lines.push(match (ordering.method, &ordering.repaired) {
        (_, Some(repaired)) => format!(
            "method      short path of little turning: it leaves {} of the minimum spanning tree and has {} of its own",
            counted(repaired.dropped.len(), "edge"),
            repaired.added.len()
        ),
        (Method::NnCrust, _) => "method      NN-CRUST: nearest neighbours on either side".to_owned(),
        (Method::Crust, _) => "method      CRUST: Voronoi and Delaunay edges".to_owned(),
        (Method::Nearest, _) => "method      nearest-neighbour chain".to_owned(),
        (Method::Mst | Method::Repaired, _) => "method      minimum spanning tree".to_owned(),
    });
    if let Some(length) = ordering.metres_per_radian {
        let kept = match ordering.weight_stable {
            Some(true) => "with half or twice of it the order is the same",
            Some(false) => "with half or twice of it the order is another",
            None => "others were not tried",
        };
        lines.push(format!("weight      one radian counts as {} m; {kept}", figure(length)));
    }
    let certificate = &ordering.certificate;
    lines.push(format!("gaps        {} at most", figure(certificate.max_gap)));
    if let Some((reach, epsilon)) = certificate.reach.zip(certificate.epsilon) {
        lines.push(format!(
            "reach       {} estimated; epsilon = gap/(2 reach) = {epsilon:.3}, the theorem asks for < 1",
            figure(reach)
        ));
    }
    let mut worst: Vec<&EdgeFigures> = edges.iter().filter(|edge| edge.epsilon > 0.0).collect();
    worst.sort_by(|a, b| b.epsilon.total_cmp(&a.epsilon));
    for EdgeFigures { at: [a, b], gap, epsilon, .. } in worst.into_iter().take(WORST) {
        lines.push(format!("edge        points {a} and {b}: gap {}, epsilon {epsilon:.3}", figure(*gap)));
    }
    if let Some((radius, margin)) = certificate.injectivity_radius.zip(certificate.margin) {
        lines.push(format!(
            "geodesics   unique within {}: {} more than the longest gap",
            figure(radius),
            figure(margin)
        ));
    }
    for Condition { what, value, bound, holds } in certificate.conditions(ordering.topology == Topology::Closed) {
        let holds = if holds { "holds" } else { "fails" };
        lines.push(format!("to certify  {what}: {}, bound {bound}: {holds}", figure(value)));
    }
    if !ordering.duplicates.is_empty() {
        lines.push(format!("equal       {} of equal points", counted(ordering.duplicates.len(), "group")));
    }
    for doubt in ordering.doubts.iter().take(SHOWN) {
        lines.push(format!("doubt       points {} and {}: {}", doubt.at[0], doubt.at[1], doubt.why));
    }
    if ordering.doubts.len() > SHOWN {
        lines.push(format!("            and {} more", ordering.doubts.len() - SHOWN));
    }
    lines.join("\n") + "\n"
}

/// Six decimals, or an exponent where they would be all zeros or none would matter.
fn figure(value: f64) -> String {
    if value == 0.0 || (1e-4..1e6).contains(&value.abs()) { format!("{value:.6}") } else { format!("{value:.6e}") }
}

/// "1 point", "2 points".
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
