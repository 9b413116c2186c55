//! The order of poses, and whether it hangs on the weight between rotation and translation.

use se3_geom::{Pose, Se3};

use crate::agreement::Variant;
use crate::error::{OrderError, check_points};
use crate::finish::ordered;
use crate::ordering::{Options, Ordering};
use crate::weight::{Weight, Weighted, automatic_weight};

/// Orders poses in SE(3) where one radian counts as much as `metres_per_radian` metres, and checks that weight:
/// [`order_weighted`] on [`Se3`].
///
/// # Errors
/// As [`order_weighted`].
pub fn order_poses(poses: &[Pose], metres_per_radian: f64, options: &Options) -> Result<Ordering, OrderError> {
    order_weighted::<Se3>(poses, Weight::MetresPerRadian(metres_per_radian), options)
}

/// Orders points of a space of rotations and translations, and checks the weight of one against the other.
///
/// The metric is d² = L²‖rotation‖² + ‖translation‖², so that all lengths in the answer are metres. L is a choice that can change
/// the order; therefore the points are ordered at L/2 and 2L too, and `weight_stable` says whether all three agree on every
/// neighbourhood. Where they do not, that is a doubt and the verdict is [`Verdict::Ambiguous`](crate::Verdict::Ambiguous).
/// It says `None` where the tree branches in so many places that no order of it is to be trusted at any weight.
///
/// # Errors
/// Those of [`order`](crate::order), and [`OrderError::InvalidLengthScale`].
pub fn order_weighted<M: Weighted>(
    points: &[M::Point],
    weight: Weight,
    options: &Options,
) -> Result<Ordering, OrderError> {
    let length = match weight {
        Weight::Auto => automatic_weight::<M>(points)?,
        Weight::MetresPerRadian(length) => length,
    };
    let metric_at = |scale: f64| {
        let metric = M::with_metres_per_radian(scale * length);
        metric.ok_or(OrderError::InvalidLengthScale { value: length })
    };
    let metric = metric_at(1.0)?;
    check_points(&metric, points)?;
    let variants = [
        Variant { manifold: metric_at(0.5)?, change: "with half as many metres per radian" },
        Variant { manifold: metric_at(2.0)?, change: "with twice as many metres per radian" },
    ];
    let mut ordering = ordered(&metric, &variants, points, options)?;
    ordering.metres_per_radian = Some(length);
    Ok(ordering)
}
