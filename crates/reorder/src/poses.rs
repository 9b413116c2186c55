//! The order of poses, and whether it hangs on the weight between rotation and translation.

use se3_geom::{Pose, Se3};

use crate::error::OrderError;
use crate::order::order;
use crate::ordering::{Doubt, Options, Ordering, Verdict};

pub fn order_poses(poses: &[Pose], metres_per_radian: f64, options: &Options) -> Result<Ordering, OrderError> {
    let at_scale = |length: f64| {
        let metric = Se3::with_metres_per_radian(length).ok_or(OrderError::InvalidLengthScale { value: length })?;
        order(&metric, poses, options)
    };
    let mut ordering = at_scale(metres_per_radian)?;
    ordering.metres_per_radian = Some(metres_per_radian);
    let edges = ordering.edges();
    let mut stable = true;
    for (length, change) in [(0.5 * metres_per_radian, "half"), (2.0 * metres_per_radian, "twice")] {
        // Whether the start is an end is a question to the order at the wanted scale only.
        let other = match at_scale(length) {
            Err(OrderError::StartNotAnEnd { .. }) => None,
            other => Some(other?.edges()),
        };
        let lost = other.map_or_else(|| edges.clone(), |other| missing_from(&other, &edges));
        if let Some(&(a, b)) = lost.first() {
            stable = false;
            ordering.doubts.push(Doubt {
                at: [a, b],
                why: format!(
                    "with {change} the metres per radian ({length} m) {} of the {} neighbourhoods are others, this one first",
                    lost.len(),
                    edges.len()
                ),
            });
        }
    }
    ordering.weight_stable = Some(stable);
    if !stable {
        ordering.verdict = Verdict::Ambiguous;
    }
    Ok(ordering)
}

/// The edges that are not among `others`; both ascending.
fn missing_from(others: &[(usize, usize)], edges: &[(usize, usize)]) -> Vec<(usize, usize)> {
    edges.iter().copied().filter(|edge| others.binary_search(edge).is_err()).collect()
}
