//! What RViz or Foxglove shows: input poses, recovered order, curve, and what is doubtful.

use planner::manipulator::nalgebra::Vector3;
use planner::reorder::{Ordering, Topology};
use planner::se3_geom::Pose;
use planner::{Outcome, Request};
use r2r::geometry_msgs::msg as geometry;
use r2r::std_msgs::msg::{ColorRGBA, Header};
use r2r::visualization_msgs::msg::{Marker, MarkerArray};

use crate::message::point;

/// More frames than these are one blot; the points alone are shown then.
const MOST_FRAMES: usize = 2000;
/// Texts over each other cannot be read.
const MOST_REASONS: usize = 20;
/// Widths as a part of the diagonal of the box around all poses, and the least in m.
const WIDTH: f64 = 0.004;
const LEAST_WIDTH_M: f64 = 5e-4;

const GREY: [f32; 3] = [0.7, 0.7, 0.7];
const WHITE: [f32; 3] = [1.0, 1.0, 1.0];
const RED: [f32; 3] = [1.0, 0.1, 0.1];
const GREEN: [f32; 3] = [0.1, 0.9, 0.2];
const BLUE: [f32; 3] = [0.2, 0.4, 1.0];
/// Along the order: from the first pose to the last.
const ALONG: [[f32; 3]; 3] = [[0.27, 0.0, 0.6], [0.1, 0.65, 0.6], [1.0, 0.9, 0.1]];

/// Everything that was shown before goes.
pub(crate) fn nothing() -> MarkerArray {
    MarkerArray { markers: vec![Marker { action: Marker::DELETEALL as i32, ..Marker::default() }] }
}

/// All of an outcome, in the frame and at the time of `header`.
pub(crate) fn markers(outcome: &Outcome, header: &Header) -> MarkerArray {
    let mut array = nothing();
    let request = &outcome.request;
    if request.poses.is_empty() {
        return array;
    }
    let canvas = Canvas::around(&request.poses, header);
    array.markers.extend(canvas.inputs(request));
    let ordering = match &outcome.result {
        Ok(plan) => {
            let curve: Vec<_> = plan.path().iter().map(|pose| pose.translation.vector).collect();
            array.markers.push(canvas.line("spline", 0, Marker::LINE_STRIP as i32, &curve, WHITE, 0.5));
            Some(&plan.ordering)
        }
        Err(refusal) => {
            array.markers.push(canvas.text("refusal", 0, canvas.top, &refusal.to_string()));
            refusal.ordering()
        }
    };
    if let Some(ordering) = ordering {
        array.markers.push(canvas.order(request, ordering));
        array.markers.extend(canvas.doubts(request, ordering));
    }
    array
}

/// Where it is drawn, and how large.
struct Canvas<'a> {
    header: &'a Header,
    width_m: f64,
    /// Above the middle of all poses.
    top: Vector3<f64>,
}

impl<'a> Canvas<'a> {
    fn around(poses: &[Pose], header: &'a Header) -> Self {
        let places = || poses.iter().map(|pose| pose.translation.vector);
        let least = places().fold(Vector3::repeat(f64::INFINITY), |least, place| least.inf(&place));
        let most = places().fold(Vector3::repeat(f64::NEG_INFINITY), |most, place| most.sup(&place));
        let width_m = (WIDTH * (most - least).norm()).max(LEAST_WIDTH_M);
        let middle = 0.5 * (least + most);
        Self { header, width_m, top: Vector3::new(middle.x, middle.y, most.z + 10.0 * width_m) }
    }

    fn marker(&self, ns: &str, id: usize, kind: i32, color: [f32; 3]) -> Marker {
        let mut marker = Marker { header: self.header.clone(), ns: ns.into(), id: id as i32, ..Marker::default() };
        marker.type_ = kind;
        marker.pose.orientation.w = 1.0;
        marker.color = opaque(color);
        marker
    }

    fn line(&self, ns: &str, id: usize, kind: i32, places: &[Vector3<f64>], color: [f32; 3], widths: f64) -> Marker {
        let mut marker = self.marker(ns, id, kind, color);
        marker.scale.x = widths * self.width_m;
        marker.points = places.iter().map(point).collect();
        marker
    }

    fn text(&self, ns: &str, id: usize, place: Vector3<f64>, text: &str) -> Marker {
        let mut marker = self.marker(ns, id, Marker::TEXT_VIEW_FACING as i32, RED);
        marker.scale.z = 5.0 * self.width_m;
        marker.pose.position = point(&place);
        marker.text = text.into();
        marker
    }

    /// The poses as they came: where, and how they stand.
    fn inputs(&self, request: &Request) -> Vec<Marker> {
        let places: Vec<_> = request.poses.iter().map(|pose| pose.translation.vector).collect();
        let mut points = self.line("poses", 0, Marker::SPHERE_LIST as i32, &places, GREY, 2.0);
        points.scale = geometry::Vector3 { x: points.scale.x, y: points.scale.x, z: points.scale.x };
        let mut shown = vec![points];
        if request.poses.len() <= MOST_FRAMES {
            for (axis, color) in [RED, GREEN, BLUE].into_iter().enumerate() {
                let mut arm = Vector3::zeros();
                arm[axis] = 6.0 * self.width_m;
                let ends = |pose: &Pose| [pose.translation.vector, pose.translation.vector + pose.rotation * arm];
                let places: Vec<_> = request.poses.iter().flat_map(ends).collect();
                shown.push(self.line("poses", axis + 1, Marker::LINE_LIST as i32, &places, color, 0.5));
            }
        }
        shown
    }

    /// The recovered order as a line whose colour tells first from last.
    fn order(&self, request: &Request, ordering: &Ordering) -> Marker {
        let mut rows = ordering.distinct();
        if ordering.topology == Topology::Closed {
            rows.extend(rows.first().copied());
        }
        let places: Vec<_> = rows.iter().map(|&row| request.poses[row].translation.vector).collect();
        let mut marker = self.line("order", 0, Marker::LINE_STRIP as i32, &places, WHITE, 1.0);
        let last = places.len().saturating_sub(1).max(1) as f32;
        marker.colors = (0..places.len()).map(|place| opaque(along(place as f32 / last))).collect();
        marker
    }

    /// Where the order could be another one, and why.
    fn doubts(&self, request: &Request, ordering: &Ordering) -> Vec<Marker> {
        let place = |row: usize| request.poses[row].translation.vector;
        let ends: Vec<_> = ordering.doubts.iter().flat_map(|doubt| doubt.at.map(place)).collect();
        if ends.is_empty() {
            return Vec::new();
        }
        let mut shown = vec![self.line("doubts", 0, Marker::LINE_LIST as i32, &ends, RED, 1.5)];
        for (id, doubt) in ordering.doubts.iter().take(MOST_REASONS).enumerate() {
            let [from, to] = doubt.at;
            let middle = 0.5 * (place(from) + place(to)) + Vector3::z() * (3.0 * self.width_m);
            shown.push(self.text("doubts", id + 1, middle, &format!("{from}–{to}: {}", doubt.why)));
        }
        shown
    }
}

fn opaque([r, g, b]: [f32; 3]) -> ColorRGBA {
    ColorRGBA { r, g, b, a: 1.0 }
}

/// The colour at a part of the way, from 0 to 1.
fn along(part: f32) -> [f32; 3] {
    let at = part.clamp(0.0, 1.0) * (ALONG.len() - 1) as f32;
    let from = (at as usize).min(ALONG.len() - 2);
    let between = at - from as f32;
    std::array::from_fn(|i| ALONG[from][i] + between * (ALONG[from + 1][i] - ALONG[from][i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_colour_runs_from_the_first_pose_to_the_last() {
        let same = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(same(along(0.0), ALONG[0]) && same(along(0.5), ALONG[1]) && same(along(1.0), ALONG[2]));
        assert!(along(0.25)[1] > ALONG[0][1] && along(0.25)[1] < ALONG[1][1]);
        assert!(same(along(2.0), ALONG[2]) && same(along(-1.0), ALONG[0]));
    }
}
