//! What Foxglove or RViz draws of a set: the poses, their order by colour, the curve, and what is doubtful in red.

use planner::pose_bag::msg::{ColorRgba, Header, Marker, MarkerArray, Point, Vector3};
use planner::reorder::{Ordering, Topology};
use planner::se3_geom::Pose;
use planner::se3_geom::nalgebra;

type Place = nalgebra::Vector3<f64>;

/// Texts over each other cannot be read.
const MOST_REASONS: usize = 20;
/// Widths as a part of the diagonal of the box around all poses, and the least in m.
const WIDTH: f64 = 0.004;
const LEAST_WIDTH_M: f64 = 5e-4;

const GREY: [f32; 3] = [0.7, 0.7, 0.7];
const WHITE: [f32; 3] = [1.0, 1.0, 1.0];
const RED: [f32; 3] = [1.0, 0.1, 0.1];
/// Along the order: from the first pose to the last.
const ALONG: [[f32; 3]; 3] = [[0.27, 0.0, 0.6], [0.1, 0.65, 0.6], [1.0, 0.9, 0.1]];

/// Draws `poses` and what was found of them; what was drawn before goes.
pub(crate) fn markers(header: &Header, poses: &[Pose], ordering: &Ordering, curve: &[Pose]) -> MarkerArray {
    let places: Vec<Place> = poses.iter().map(|pose| pose.translation.vector).collect();
    let least = places.iter().fold(Place::repeat(f64::INFINITY), |least, place| least.inf(place));
    let most = places.iter().fold(Place::repeat(f64::NEG_INFINITY), |most, place| most.sup(place));
    let canvas = Canvas { header, width_m: (WIDTH * (most - least).norm()).max(LEAST_WIDTH_M) };

    let mut everything = Marker::new(header.clone(), "", 0, 0);
    everything.action = Marker::DELETEALL;
    let mut points = canvas.line("poses", Marker::SPHERE_LIST, places.iter(), GREY, 2.0);
    points.scale = Vector3 { x: points.scale.x, y: points.scale.x, z: points.scale.x };
    let curve: Vec<Place> = curve.iter().map(|pose| pose.translation.vector).collect();
    let spline = canvas.line("spline", Marker::LINE_STRIP, curve.iter(), WHITE, 0.5);
    let mut markers = vec![everything, points, spline, canvas.order(&places, ordering)];
    markers.extend(canvas.doubts(&places, ordering));
    MarkerArray { markers }
}

struct Canvas<'a> {
    header: &'a Header,
    width_m: f64,
}

impl Canvas<'_> {
    fn line<'p>(
        &self,
        ns: &str,
        kind: i32,
        places: impl Iterator<Item = &'p Place>,
        color: [f32; 3],
        widths: f64,
    ) -> Marker {
        let mut marker = Marker::new(self.header.clone(), ns, 0, kind);
        marker.scale.x = widths * self.width_m;
        marker.color = opaque(color);
        marker.points = places.map(point).collect();
        marker
    }

    fn order(&self, places: &[Place], ordering: &Ordering) -> Marker {
        let mut rows = ordering.distinct();
        if ordering.topology == Topology::Closed {
            rows.extend(rows.first().copied());
        }
        let mut marker = self.line("order", Marker::LINE_STRIP, rows.iter().map(|&row| &places[row]), WHITE, 1.0);
        let last = rows.len().saturating_sub(1).max(1) as f32;
        marker.colors = (0..rows.len()).map(|place| opaque(along(place as f32 / last))).collect();
        marker
    }

    fn doubts(&self, places: &[Place], ordering: &Ordering) -> Vec<Marker> {
        let ends: Vec<usize> = ordering.doubts.iter().flat_map(|doubt| doubt.at).collect();
        if ends.is_empty() {
            return Vec::new();
        }
        let mut shown = vec![self.line("doubts", Marker::LINE_LIST, ends.iter().map(|&row| &places[row]), RED, 1.5)];
        for (id, doubt) in (1..).zip(ordering.doubts.iter().take(MOST_REASONS)) {
            let [from, to] = doubt.at;
            let middle = 0.5 * (places[from] + places[to]) + Place::z() * (3.0 * self.width_m);
            let mut text = Marker::new(self.header.clone(), "doubts", id, Marker::TEXT_VIEW_FACING);
            text.scale.z = 5.0 * self.width_m;
            text.color = opaque(RED);
            text.pose.position = point(&middle);
            text.text = format!("{from}–{to}: {}", doubt.why);
            shown.push(text);
        }
        shown
    }
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
