//! What RViz or Foxglove draws of a set of poses: the poses, their order by colour, the curve, and what is doubtful in red.

use pose_bag::msg::{ColorRgba, Header, Marker, MarkerArray, Point, Vector3};
use reorder::{Ordering, Topology};
use se3_geom::{Pose, nalgebra};

use crate::exchange::Outcome;

type Place = nalgebra::Vector3<f64>;

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

/// What is drawn of a set of poses.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<'a> {
    /// As they came; nothing at all is drawn where there are none.
    pub poses: &'a [Pose],
    /// Whose rows are those of `poses`.
    pub ordering: Option<&'a Ordering>,
    /// Along the curve through them; may be empty.
    pub curve: &'a [Pose],
    /// Why nothing is executed.
    pub refusal: Option<&'a str>,
}

impl Drawn<'_> {
    /// Markers in the frame and with the stamp of `header`: namespaces `poses`, `order`, `spline`, `doubts` and `refusal`. What was drawn
    /// before goes.
    pub fn markers(&self, header: &Header) -> MarkerArray {
        let mut markers = vec![Marker { action: Marker::DELETEALL, ..Marker::new(header.clone(), "", 0, 0) }];
        if !self.poses.is_empty() {
            let canvas = Canvas::around(self.poses, header);
            markers.extend(canvas.inputs(self.poses));
            if !self.curve.is_empty() {
                let curve: Vec<Place> = self.curve.iter().map(place).collect();
                markers.push(canvas.line("spline", 0, Marker::LINE_STRIP, &curve, WHITE, 0.5));
            }
            if let Some(why) = self.refusal {
                markers.push(canvas.text("refusal", 0, canvas.top, why));
            }
            if let Some(ordering) = self.ordering {
                markers.push(canvas.order(ordering));
                markers.extend(canvas.doubts(ordering));
            }
        }
        MarkerArray { markers }
    }
}

/// All of an outcome, in the frame and with the stamp of `header`.
pub fn markers(outcome: &Outcome, header: &Header) -> MarkerArray {
    let poses = &outcome.request.poses;
    match &outcome.result {
        Ok(plan) => Drawn { poses, ordering: Some(&plan.ordering), curve: &plan.path(), refusal: None }.markers(header),
        Err(refusal) => {
            let why = refusal.to_string();
            Drawn { poses, ordering: refusal.ordering(), curve: &[], refusal: Some(&why) }.markers(header)
        }
    }
}

/// Where it is drawn, and how large.
struct Canvas<'a> {
    header: &'a Header,
    places: Vec<Place>,
    width_m: f64,
    /// Above the middle of all poses.
    top: Place,
}

impl<'a> Canvas<'a> {
    fn around(poses: &[Pose], header: &'a Header) -> Self {
        let places: Vec<Place> = poses.iter().map(place).collect();
        let least = places.iter().fold(Place::repeat(f64::INFINITY), |least, place| least.inf(place));
        let most = places.iter().fold(Place::repeat(f64::NEG_INFINITY), |most, place| most.sup(place));
        let width_m = (WIDTH * (most - least).norm()).max(LEAST_WIDTH_M);
        let middle = 0.5 * (least + most);
        Self { header, places, width_m, top: Place::new(middle.x, middle.y, most.z + 10.0 * width_m) }
    }

    fn line(&self, ns: &str, id: usize, kind: i32, places: &[Place], color: [f32; 3], widths: f64) -> Marker {
        let mut marker = self.marker(ns, id, kind, color);
        marker.scale.x = widths * self.width_m;
        marker.points = places.iter().map(point).collect();
        marker
    }

    fn text(&self, ns: &str, id: usize, place: Place, text: &str) -> Marker {
        let mut marker = self.marker(ns, id, Marker::TEXT_VIEW_FACING, RED);
        marker.scale.z = 5.0 * self.width_m;
        marker.pose.position = point(&place);
        marker.text = text.to_owned();
        marker
    }

    fn marker(&self, ns: &str, id: usize, kind: i32, color: [f32; 3]) -> Marker {
        Marker { color: opaque(color), ..Marker::new(self.header.clone(), ns, id as i32, kind) }
    }

    /// The poses as they came: where, and how they stand.
    fn inputs(&self, poses: &[Pose]) -> Vec<Marker> {
        let mut points = self.line("poses", 0, Marker::SPHERE_LIST, &self.places, GREY, 2.0);
        points.scale = Vector3 { x: points.scale.x, y: points.scale.x, z: points.scale.x };
        let mut shown = vec![points];
        if poses.len() <= MOST_FRAMES {
            for (axis, color) in [RED, GREEN, BLUE].into_iter().enumerate() {
                let mut arm = Place::zeros();
                arm[axis] = 6.0 * self.width_m;
                let ends = |pose: &Pose| [place(pose), place(pose) + pose.rotation * arm];
                let places: Vec<Place> = poses.iter().flat_map(ends).collect();
                shown.push(self.line("poses", axis + 1, Marker::LINE_LIST, &places, color, 0.5));
            }
        }
        shown
    }

    /// The recovered order as a line whose colour tells first from last.
    fn order(&self, ordering: &Ordering) -> Marker {
        let mut rows = ordering.distinct();
        if ordering.topology == Topology::Closed {
            rows.extend(rows.first().copied());
        }
        let places: Vec<Place> = rows.iter().map(|&row| self.places[row]).collect();
        let mut marker = self.line("order", 0, Marker::LINE_STRIP, &places, WHITE, 1.0);
        let last = places.len().saturating_sub(1).max(1) as f32;
        marker.colors = (0..places.len()).map(|place| opaque(along(place as f32 / last))).collect();
        marker
    }

    /// Where the order could be another one, and why.
    fn doubts(&self, ordering: &Ordering) -> Vec<Marker> {
        let ends: Vec<Place> = ordering.doubts.iter().flat_map(|doubt| doubt.at.map(|row| self.places[row])).collect();
        if ends.is_empty() {
            return Vec::new();
        }
        let mut shown = vec![self.line("doubts", 0, Marker::LINE_LIST, &ends, RED, 1.5)];
        for (id, doubt) in ordering.doubts.iter().take(MOST_REASONS).enumerate() {
            let [from, to] = doubt.at;
            let middle = 0.5 * (self.places[from] + self.places[to]) + Place::z() * (3.0 * self.width_m);
            shown.push(self.text("doubts", id + 1, middle, &format!("{from}–{to}: {}", doubt.why)));
        }
        shown
    }
}

fn place(pose: &Pose) -> Place {
    pose.translation.vector
}

fn point(place: &Place) -> Point {
    Point { x: place.x, y: place.y, z: place.z }
}

fn opaque([r, g, b]: [f32; 3]) -> ColorRgba {
    ColorRgba { r, g, b, a: 1.0 }
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

    #[test]
    fn what_was_drawn_before_goes_also_where_nothing_comes() {
        let nothing =
            Drawn { poses: &[], ordering: None, curve: &[], refusal: Some("why") }.markers(&Header::default());
        assert_eq!(nothing.markers.iter().map(|marker| marker.action).collect::<Vec<_>>(), [Marker::DELETEALL]);
    }
}
