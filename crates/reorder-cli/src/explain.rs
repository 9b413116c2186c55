//! What speaks for and against an order, for a person.

use planner::reorder::{Ordering, Topology, Verdict};

/// Doubts that are written out; the rest is counted.
const SHOWN: usize = 12;

pub(crate) fn explain(ordering: &Ordering) -> String {
    let topology = match ordering.topology {
        Topology::Open => "an open curve",
        Topology::Closed => "a closed curve",
    };
    let verdict = match ordering.verdict {
        Verdict::Certified => "certified: the hypotheses of a reconstruction theorem hold with margin",
        Verdict::Plausible => "plausible: every test agrees, nothing is proven",
        Verdict::Ambiguous => "ambiguous: something speaks against this order",
    };
    let mut lines = vec![format!("{} points on {topology}", ordering.n), format!("verdict     {verdict}")];
    lines.push(match &ordering.repaired {
        Some(repaired) => format!(
            "method      short path of little turning: it leaves {} edges of the minimum spanning tree and has {} of its own",
            repaired.dropped.len(),
            repaired.added.len()
        ),
        None => "method      minimum spanning tree".to_owned(),
    });
    if let Some(length) = ordering.metres_per_radian {
        let kept = if ordering.weight_stable == Some(true) { "the same" } else { "another" };
        lines.push(format!(
            "weight      one radian counts as {length:.4} m; with half or twice of it the order is {kept}"
        ));
    }
    let certificate = &ordering.certificate;
    lines.push(format!("gaps        {:.6} at most", certificate.max_gap));
    if let Some((reach, epsilon)) = certificate.reach.zip(certificate.epsilon) {
        lines.push(format!(
            "reach       {reach:.6} estimated; epsilon = gap/(2 reach) = {epsilon:.3}, theorems ask for < 1"
        ));
    }
    if let Some((radius, margin)) = certificate.injectivity_radius.zip(certificate.margin) {
        lines.push(format!("geodesics   unique within {radius:.6}: {margin:.6} more than the longest gap"));
    }
    if !ordering.duplicates.is_empty() {
        lines.push(format!("equal       {} groups of equal points", ordering.duplicates.len()));
    }
    for doubt in ordering.doubts.iter().take(SHOWN) {
        lines.push(format!("doubt       points {} and {}: {}", doubt.at[0], doubt.at[1], doubt.why));
    }
    if ordering.doubts.len() > SHOWN {
        lines.push(format!("            and {} more", ordering.doubts.len() - SHOWN));
    }
    lines.join("\n") + "\n"
}
