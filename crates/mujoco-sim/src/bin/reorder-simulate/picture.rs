//! The run as one picture: the tool path in two projections, tracking error and velocities.

use std::error::Error;
use std::ops::Range;

use mujoco_sim::planner::manipulator::nalgebra::Vector3;
use mujoco_sim::planner::se3_geom::Pose;
use mujoco_sim::{Execution, Sample};
use plotters::coord::Shift;
use plotters::prelude::*;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn Error>>;

const SIZE_PIXELS: (u32, u32) = (1200, 1000);
/// What labels and margins take of a panel, in pixels.
const LABELS_PIXELS: (u32, u32) = (80, 75);
/// Pieces of one colour that the tool path is drawn in.
const PIECES: usize = 64;

/// Draws the run as the text of an SVG file.
pub(crate) fn draw(execution: &Execution, poses: &[Pose]) -> Result<String, String> {
    let mut svg = String::new();
    draw_into(&mut svg, execution, poses).map_err(|error| error.to_string())?;
    Ok(svg)
}

fn draw_into(svg: &mut String, execution: &Execution, poses: &[Pose]) -> Drawn {
    let root = SVGBackend::with_string(svg, SIZE_PIXELS).into_drawing_area();
    root.fill(&WHITE)?;
    let title = format!(
        "Executed in MuJoCo: {:.2} s, joints at worst {:.1e} rad off, {} contacts",
        execution.duration_s,
        execution.tracking_max_rad,
        execution.contacts.len()
    );
    let panels = root.titled(&title, ("sans-serif", 24))?.split_evenly((2, 2));
    let places: Vec<Vector3<f64>> = poses.iter().map(|pose| pose.translation.vector).collect();
    let tool = tool_path(execution);
    let [longest, middle, shortest] = axes_by_extent(tool.iter().chain(&places));
    // The arm stands still while it settles, so that colours tell when it moved.
    let moving = execution.samples.iter().filter(|sample| sample.time_s <= execution.duration_s).count();
    projection(&panels[0], &tool, moving, &places, [longest, middle])?;
    projection(&panels[1], &tool, moving, &places, [longest, shortest])?;
    curves(&panels[2], execution, "tracking error / rad", |sample, joint| {
        sample.position[joint] - sample.reference[joint]
    })?;
    curves(&panels[3], execution, "joint velocity / (rad/s)", |sample, joint| sample.velocity[joint])?;
    root.present()?;
    Ok(())
}

fn tool_path(execution: &Execution) -> Vec<Vector3<f64>> {
    let poses = execution.samples.iter().filter_map(|sample| execution.tool_at(sample.time_s));
    poses.map(|pose| pose.translation.vector).collect()
}

/// The axes x, y, z, widest extent first, so that the first two show most.
fn axes_by_extent<'a>(points: impl Iterator<Item = &'a Vector3<f64>> + Clone) -> [usize; 3] {
    let extent = |axis: usize| {
        let (low, high) = bounds(points.clone().map(|point| point[axis]));
        high - low
    };
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| extent(b).total_cmp(&extent(a)));
    axes
}

fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

fn projection(panel: &Area, tool: &[Vector3<f64>], moving: usize, poses: &[Vector3<f64>], axes: [usize; 2]) -> Drawn {
    let flat = |point: &Vector3<f64>| (point[axes[0]], point[axes[1]]);
    let (across, up) = same_scale(panel, tool.iter().chain(poses).map(flat));
    let [x, y] = axes.map(|axis| ["x / m", "y / m", "z / m"][axis]);
    let mut chart = ChartBuilder::on(panel)
        .caption("tool path, dark (start) to yellow (end), and poses (red)", ("sans-serif", 16))
        .margin(10)
        .x_label_area_size(35)
        .y_label_area_size(60)
        .build_cartesian_2d(across, up)?;
    chart.configure_mesh().light_line_style(TRANSPARENT).x_desc(x).y_desc(y).draw()?;
    chart.draw_series(poses.iter().map(|pose| Circle::new(flat(pose), 3, RED.mix(0.6))))?;
    let piece = tool.len().div_ceil(PIECES).max(1);
    let pieces = (0..tool.len().saturating_sub(1)).step_by(piece).map(|start| {
        let end = (start + piece).min(tool.len() - 1);
        let colour = colour_of_time(start as f64 / moving as f64);
        PathElement::new(tool[start..=end].iter().map(flat).collect::<Vec<_>>(), colour.stroke_width(2))
    });
    chart.draw_series(pieces)?;
    Ok(())
}

/// Ranges that hold all points with some air, and have the same number of metres a pixel in both directions.
fn same_scale(panel: &Area, points: impl Iterator<Item = (f64, f64)> + Clone) -> (Range<f64>, Range<f64>) {
    const AIR: f64 = 1.1;
    const LEAST_EXTENT_M: f64 = 1e-3;
    let (width, height) = panel.dim_in_pixel();
    let pixels = |size: u32, labels: u32| f64::from(size.saturating_sub(labels).max(1));
    let (width, height) = (pixels(width, LABELS_PIXELS.0), pixels(height, LABELS_PIXELS.1));
    let (left, right) = bounds(points.clone().map(|point| point.0));
    let (low, high) = bounds(points.map(|point| point.1));
    let metres_per_pixel = AIR * ((right - left) / width).max((high - low) / height).max(LEAST_EXTENT_M / width);
    let around = |low: f64, high: f64, pixels: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * pixels * metres_per_pixel);
        middle - half..middle + half
    };
    (around(left, right, width), around(low, high, height))
}

/// From dark violet over green to yellow: lightness grows with time, so that it reads without colour too.
fn colour_of_time(share: f64) -> RGBColor {
    const STOPS: [[f64; 3]; 5] =
        [[68.0, 1.0, 84.0], [59.0, 82.0, 139.0], [33.0, 145.0, 140.0], [94.0, 201.0, 98.0], [253.0, 231.0, 37.0]];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let before = (place as usize).min(STOPS.len() - 2);
    let [r, g, b] = [0, 1, 2].map(|channel| {
        let (from, to) = (STOPS[before][channel], STOPS[before + 1][channel]);
        (from + (to - from) * (place - before as f64)) as u8
    });
    RGBColor(r, g, b)
}

fn curves(panel: &Area, execution: &Execution, what: &str, value: impl Fn(&Sample, usize) -> f64) -> Drawn {
    let samples = &execution.samples;
    let joints = execution.joints.len();
    let all = samples.iter().flat_map(|sample| (0..joints).map(|joint| value(sample, joint)).collect::<Vec<_>>());
    let most = all.fold(1e-6, |most, value| f64::max(most, value.abs())) * 1.1;
    let end = samples.last().map_or(0.0, |sample| sample.time_s).max(1e-3);
    let mut chart = ChartBuilder::on(panel)
        .caption(what, ("sans-serif", 16))
        .margin(10)
        .x_label_area_size(35)
        .y_label_area_size(60)
        .build_cartesian_2d(0.0..end, -most..most)?;
    let number = |value: &f64| match value.abs() {
        size if size < 1e-9 * most => "0".to_owned(),
        _ if most < 0.1 => format!("{value:.0e}"),
        _ => format!("{value:.1}"),
    };
    chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("t / s").y_label_formatter(&number).draw()?;
    for (joint, tracking) in execution.joints.iter().enumerate() {
        let colour = Palette99::pick(joint).to_rgba();
        let line = LineSeries::new(samples.iter().map(|sample| (sample.time_s, value(sample, joint))), colour);
        let series = chart.draw_series(line)?;
        series
            .label(tracking.name.as_str())
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 16, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .label_font(("sans-serif", 11))
        .draw()?;
    Ok(())
}
