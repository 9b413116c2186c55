//! The order of poses, and whether it hangs on the weight between rotation and translation.

use se3_geom::{Pose, Se3};

use crate::error::OrderError;
use crate::order::judge;
use crate::ordering::{Doubt, Options, Ordering, Verdict};
use crate::recovery::{Recovery, recover};

/// Orders poses in SE(3) where one radian counts as much as `metres_per_radian` metres, and checks that weight.
///
/// The metric is d² = L²‖log(R₁ᵀR₂)‖² + ‖p₂ − p₁‖² with L = `metres_per_radian`, so that all lengths in the answer are metres. L is a
/// choice that can change the order; therefore the poses are ordered at L/2 and 2L too, and `weight_stable` says whether all
/// three agree on every neighbourhood. Where they do not, that is a doubt and the verdict is [`Verdict::Ambiguous`].
///
/// # Errors
/// Those of [`order`](crate::order), and [`OrderError::InvalidLengthScale`].
pub fn order_poses(poses: &[Pose], metres_per_radian: f64, options: &Options) -> Result<Ordering, OrderError> {
    let metric_at = |length: f64| {
        let metric = Se3::with_metres_per_radian(length).filter(|_| length > 0.0);
        metric.ok_or(OrderError::InvalidLengthScale { value: length })
    };
    let metric = metric_at(metres_per_radian)?;
    let recovery = recover(&metric, poses, options)?;
    let edges = recovery.edges();
    let mut doubts = Vec::new();
    for (length, change) in [(0.5 * metres_per_radian, "half"), (2.0 * metres_per_radian, "twice")] {
        let kept = match recover(&metric_at(length)?, poses, options).map(|other: Recovery| other.edges()) {
            // The start is an end at the wanted scale, and none here: another order.
            Err(OrderError::StartNotAnEnd { .. }) => Vec::new(),
            kept => kept?,
        };
        let lost: Vec<_> = edges.iter().filter(|edge| kept.binary_search(edge).is_err()).collect();
        // A closing edge is the only one that a curve can gain without losing another.
        let gained = kept.iter().find(|edge| edges.binary_search(edge).is_err());
        if let Some(&(i, j)) = lost.first().copied().or(gained) {
            let why = if lost.is_empty() {
                format!("with {change} as many metres per radian the curve is closed here")
            } else {
                let (lost, all) = (lost.len(), edges.len());
                format!(
                    "with {change} as many metres per radian {lost} of {all} neighbourhoods are lost, this one first"
                )
            };
            doubts.push(Doubt { at: [i, j], why });
        }
    }
    let mut ordering = judge(&metric, poses, recovery);
    ordering.metres_per_radian = Some(metres_per_radian);
    ordering.weight_stable = Some(doubts.is_empty());
    if !doubts.is_empty() {
        ordering.verdict = Verdict::Ambiguous;
    }
    ordering.doubts.extend(doubts);
    Ok(ordering)
}
