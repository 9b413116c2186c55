//! Figures as SVG: polylines in the plane with equal axes, and in space by orthographic projection.

use std::error::Error;
use std::path::{Path, PathBuf};

use plotters::coord::Shift;
use plotters::prelude::*;
use se3_geom::Pose;
use se3_geom::nalgebra::{Isometry2, Vector2, Vector3};

/// The side of a panel, in pixels.
const SIDE: u32 = 560;
/// Room for the numbers at the axes, and around the drawing, in pixels.
const NUMBERS: u32 = 36;
const MARGIN: u32 = 12;
/// Of the lines, in pixels; the axes and the lines of wireframes have 1.
const WIDTH: u32 = 2;
const THIN: u32 = 1;
const GREY: RGBColor = RGBColor(190, 190, 190);

/// One panel: a title, polylines and dots, in the order in which they are drawn.
pub(crate) struct Panel {
    title: String,
    lines: Vec<Line>,
    dots: Vec<(Vector2<f64>, RGBColor)>,
    labels: Vec<(Vector2<f64>, String)>,
}

struct Line {
    points: Vec<Vector2<f64>>,
    style: ShapeStyle,
    label: String,
}

impl Panel {
    /// An empty panel.
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), lines: Vec::new(), dots: Vec::new(), labels: Vec::new() }
    }
    /// A polyline; a label that is not empty goes into the legend.
    pub(crate) fn line(&mut self, points: impl IntoIterator<Item = Vector2<f64>>, colour: RGBColor, label: &str) {
        self.push(points, colour.stroke_width(WIDTH), label);
    }
    /// A thin polyline.
    pub(crate) fn thin(&mut self, points: impl IntoIterator<Item = Vector2<f64>>, colour: RGBColor) {
        self.push(points, colour.stroke_width(THIN), "");
    }
    fn push(&mut self, points: impl IntoIterator<Item = Vector2<f64>>, style: ShapeStyle, label: &str) {
        self.lines.push(Line { points: points.into_iter().collect(), style, label: label.into() });
    }
    /// A text with a dot at its place.
    pub(crate) fn label(&mut self, place: Vector2<f64>, text: &str) {
        self.dots.push((place, BLACK));
        self.labels.push((place, text.into()));
    }
    /// The coordinate lines of a surface over a rectangle, `lines` in each direction.
    pub(crate) fn wireframe(
        &mut self,
        view: &View,
        surface: impl Fn(f64, f64) -> Vector3<f64>,
        sides: [[f64; 2]; 2],
        lines: u32,
    ) {
        const PIECES: u32 = 60;
        let along = |[low, high]: [f64; 2], part: f64| low + (high - low) * part;
        for i in 0..lines {
            let across = f64::from(i) / f64::from(lines - 1);
            let parts = (0..=PIECES).map(|k| f64::from(k) / f64::from(PIECES));
            let [x, y] = [along(sides[0], across), along(sides[1], across)];
            self.thin(parts.clone().map(|part| view.project(&surface(x, along(sides[1], part)))), GREY);
            self.thin(parts.map(|part| view.project(&surface(along(sides[0], part), y))), GREY);
        }
    }
    /// A dot at each point.
    pub(crate) fn dots(&mut self, points: impl IntoIterator<Item = Vector2<f64>>, colour: RGBColor) {
        self.dots.extend(points.into_iter().map(|point| (point, colour)));
    }
    /// The axes of a pose in the plane: x red, y green.
    pub(crate) fn planar_frame(&mut self, pose: &Isometry2<f64>, size: f64) {
        let origin = pose.translation.vector;
        for (axis, colour) in [(Vector2::x(), RED), (Vector2::y(), GREEN)] {
            self.line([origin, origin + pose.rotation * axis * size], colour, "");
        }
    }
    /// The axes of a pose in space: x red, y green, z blue.
    pub(crate) fn frame(&mut self, view: &View, pose: &Pose, size: f64) {
        let origin = pose.translation.vector;
        for (axis, colour) in [(Vector3::x(), RED), (Vector3::y(), GREEN), (Vector3::z(), BLUE)] {
            self.line([origin, origin + pose.rotation * axis * size].map(|p| view.project(&p)), colour, "");
        }
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Box<dyn Error>> {
        let area = area.titled(&self.title, ("sans-serif", 18))?;
        let (width, height) = area.dim_in_pixel();
        let taken = f64::from(NUMBERS + 2 * MARGIN);
        let [x, y] = self.ranges((f64::from(width) - taken) / (f64::from(height) - taken));
        let mut chart = ChartBuilder::on(&area)
            .margin(MARGIN)
            .x_label_area_size(NUMBERS)
            .y_label_area_size(NUMBERS)
            .build_cartesian_2d(x, y)?;
        chart.configure_mesh().light_line_style(TRANSPARENT).max_light_lines(1).draw()?;
        for Line { points, style, label } in &self.lines {
            let style = *style;
            let drawn = chart.draw_series(LineSeries::new(points.iter().map(|p| (p.x, p.y)), style))?;
            if !label.is_empty() {
                drawn.label(label).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
            }
        }
        chart.draw_series(self.dots.iter().map(|(p, colour)| Circle::new((p.x, p.y), 3, colour.filled())))?;
        let text = |(place, text): &(Vector2<f64>, String)| {
            EmptyElement::at((place.x, place.y)) + Text::new(text.clone(), (6, -16), ("sans-serif", 15))
        };
        chart.draw_series(self.labels.iter().map(text))?;
        if self.lines.iter().any(|line| !line.label.is_empty()) {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperLeft)
                .background_style(WHITE.mix(0.8))
                .border_style(BLACK)
                .draw()?;
        }
        Ok(())
    }

    /// What the axes span: everything drawn and a tenth more, one unit as long on both; `aspect` is width to height.
    fn ranges(&self, aspect: f64) -> [std::ops::Range<f64>; 2] {
        let drawn = self.lines.iter().flat_map(|line| &line.points).chain(self.dots.iter().map(|(point, _)| point));
        let (mut low, mut high) = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
        for point in drawn {
            (low, high) = (low.inf(point), high.sup(point));
        }
        let (centre, size) = ((low + high) * 0.5, high - low);
        let half_height = 0.55 * size.y.max(size.x / aspect);
        [(centre.x, half_height * aspect), (centre.y, half_height)].map(|(middle, half)| middle - half..middle + half)
    }
}

/// A direction to look along; its picture has z pointing up.
pub(crate) struct View {
    right: Vector3<f64>,
    up: Vector3<f64>,
}

impl View {
    /// From the azimuth about z, counted from x, and the elevation above the xy-plane.
    pub(crate) fn from_angles(azimuth_rad: f64, elevation_rad: f64) -> Self {
        let ((sa, ca), (se, ce)) = (azimuth_rad.sin_cos(), elevation_rad.sin_cos());
        Self { right: Vector3::new(-sa, ca, 0.0), up: Vector3::new(-se * ca, -se * sa, ce) }
    }
    /// Where a point is in the picture.
    pub(crate) fn project(&self, point: &Vector3<f64>) -> Vector2<f64> {
        Vector2::new(self.right.dot(point), self.up.dot(point))
    }
    /// Whether the point lies on the viewer's side of the plane through the origin.
    pub(crate) fn faces(&self, point: &Vector3<f64>) -> bool {
        self.right.cross(&self.up).dot(point) >= 0.0
    }
}

/// Writes the panels side by side.
pub(crate) fn write(panels: &[Panel], path: &Path) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (SIDE * panels.len() as u32, SIDE)).into_drawing_area();
    root.fill(&WHITE)?;
    for (panel, area) in panels.iter().zip(root.split_evenly((1, panels.len()))) {
        panel.draw(&area)?;
    }
    Ok(root.present()?)
}

/// `target/gallery/name.svg` of the workspace.
pub(crate) fn gallery_path(name: &str) -> std::io::Result<PathBuf> {
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/gallery");
    std::fs::create_dir_all(&gallery)?;
    Ok(gallery.canonicalize()?.join(name).with_extension("svg"))
}

/// From dark blue (0) over red to yellow (1), lighter and lighter.
pub(crate) fn shade(share: f64) -> RGBColor {
    const STOPS: [[f64; 3]; 3] = [[20.0, 40.0, 140.0], [220.0, 50.0, 50.0], [240.0, 190.0, 40.0]];
    let place = 2.0 * share.clamp(0.0, 1.0);
    let (from, part) = if place < 1.0 { (0, place) } else { (1, place - 1.0) };
    let [r, g, b] = [0, 1, 2].map(|k| (STOPS[from][k] + (STOPS[from + 1][k] - STOPS[from][k]) * part) as u8);
    RGBColor(r, g, b)
}
