//! What the figures are drawn with: panels of lines and labels, in the plane or projected from space.

#![allow(dead_code)] // each figure uses a part

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

pub(crate) type Drawn = Result<(), Box<dyn Error>>;

const PANEL_PIXELS: (u32, u32) = (700, 640);
/// Height of the title and width of the margins, in pixels.
const MARGIN_PIXELS: i32 = 36;

/// A polyline, in the coordinates of its panel.
pub(crate) struct Line {
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) colour: RGBColor,
    pub(crate) width: u32,
}

/// One picture of a figure, with the same scale along both axes.
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) lines: Vec<Line>,
    /// Texts with a dot at their place.
    pub(crate) labels: Vec<([f64; 2], String)>,
}

impl Panel {
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), lines: Vec::new(), labels: Vec::new() }
    }
    pub(crate) fn line(&mut self, points: impl IntoIterator<Item = [f64; 2]>, colour: RGBColor, width: u32) {
        self.lines.push(Line { points: points.into_iter().collect(), colour, width });
    }
    pub(crate) fn label(&mut self, place: [f64; 2], text: impl Into<String>) {
        self.labels.push((place, text.into()));
    }
    /// The coordinate lines of a surface over a rectangle, `lines` in each direction, seen from `view`.
    pub(crate) fn wireframe(
        &mut self,
        view: View,
        surface: impl Fn(f64, f64) -> [f64; 3],
        sides: [[f64; 2]; 2],
        lines: u32,
    ) {
        const PIECES: u32 = 60;
        let along = |[low, high]: [f64; 2], part: f64| low + (high - low) * part;
        for i in 0..lines {
            let across = f64::from(i) / f64::from(lines - 1);
            let parts = (0..=PIECES).map(|k| f64::from(k) / f64::from(PIECES));
            let [x, y] = [along(sides[0], across), along(sides[1], across)];
            self.line(parts.clone().map(|part| view.project(surface(x, along(sides[1], part)))), GREY, 1);
            self.line(parts.map(|part| view.project(surface(along(sides[0], part), y))), GREY, 1);
        }
    }
}

pub(crate) const GREY: RGBColor = RGBColor(190, 190, 190);

/// Where an orthographic picture of space is taken from.
#[derive(Clone, Copy)]
pub(crate) struct View {
    /// Turn about the z axis, in radians; zero looks along +y.
    pub(crate) azimuth: f64,
    /// Above the xy plane, in radians.
    pub(crate) elevation: f64,
}

impl View {
    pub(crate) fn project(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let ((sa, ca), (se, ce)) = (self.azimuth.sin_cos(), self.elevation.sin_cos());
        let (right, away) = (ca * x + sa * y, ca * y - sa * x);
        [right, z * ce + away * se]
    }
}

/// Writes the panels side by side as an SVG file, and its folder where there is none.
pub(crate) fn draw_panels(path: &Path, panels: &[Panel]) -> Drawn {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let root = SVGBackend::new(path, (PANEL_PIXELS.0 * panels.len() as u32, PANEL_PIXELS.1)).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, panel) in root.split_evenly((1, panels.len())).iter().zip(panels) {
        draw_panel(area, panel)?;
    }
    root.present()?;
    Ok(())
}

fn draw_panel(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Drawn {
    let places = || panel.lines.iter().flat_map(|line| &line.points).chain(panel.labels.iter().map(|(place, _)| place));
    let reach = |axis: usize| {
        let bounds = (f64::INFINITY, f64::NEG_INFINITY);
        places().fold(bounds, |(low, high), place| (low.min(place[axis]), high.max(place[axis])))
    };
    let [(left, right), (bottom, top)] = [reach(0), reach(1)];
    let (width, height) = area.dim_in_pixel();
    let [free_width, free_height] = [width, height].map(|size| f64::from(size) - 2.0 * f64::from(MARGIN_PIXELS));
    let scale = (free_width / (right - left)).min(free_height / (top - bottom));
    let [middle_x, middle_y] = [0.5 * (left + right), 0.5 * (bottom + top)];
    let pixel = |[x, y]: [f64; 2]| {
        let (x, y) = (scale * (x - middle_x), scale * (middle_y - y));
        ((0.5 * f64::from(width) + x).round() as i32, (0.5 * f64::from(height) + y).round() as i32)
    };
    for line in &panel.lines {
        let points: Vec<_> = line.points.iter().map(|&point| pixel(point)).collect();
        area.draw(&PathElement::new(points, line.colour.stroke_width(line.width)))?;
    }
    for (place, text) in &panel.labels {
        let (x, y) = pixel(*place);
        area.draw(&Circle::new((x, y), 3, BLACK.filled()))?;
        area.draw(&Text::new(text.as_str(), (x + 6, y - 16), ("sans-serif", 15)))?;
    }
    area.draw(&Text::new(panel.title.as_str(), (MARGIN_PIXELS / 2, 8), ("sans-serif", 17)))?;
    Ok(())
}

/// From dark blue (0) over red to yellow (1), lighter and lighter.
pub(crate) fn shade(share: f64) -> RGBColor {
    const STOPS: [[f64; 3]; 3] = [[20.0, 40.0, 140.0], [220.0, 50.0, 50.0], [240.0, 190.0, 40.0]];
    let place = 2.0 * share.clamp(0.0, 1.0);
    let (from, part) = if place < 1.0 { (0, place) } else { (1, place - 1.0) };
    let [r, g, b] = [0, 1, 2].map(|k| (STOPS[from][k] + (STOPS[from + 1][k] - STOPS[from][k]) * part) as u8);
    RGBColor(r, g, b)
}
