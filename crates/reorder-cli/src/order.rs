//! `reorder order`.

use clap::{Args, ValueEnum};
use planner::Config;
use planner::reorder::{Options, OrderError, Ordering, TopologyChoice, Verdict, order, order_poses};
use planner::se3_geom::{Pose, R2, R3, So3, xyzw_from_rotation};

use crate::failure::Failure;
use crate::output::print;
use crate::source::{Manifold, Points, Source};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// The space the points live in; told from the columns where it is not given
    #[arg(long)]
    manifold: Option<Manifold>,
    /// How many metres count as much as one radian when poses are compared
    #[arg(long, value_name = "L", default_value_t = Config::default().metres_per_radian)]
    metres_per_radian: f64,
    /// How to order
    #[arg(long, default_value = "auto")]
    method: Method,
    /// Open curve, closed curve, or told from the points
    #[arg(long, default_value = "auto")]
    topology: Topology,
    /// Row (counted from 0) at which the order starts
    #[arg(long, value_name = "INDEX")]
    start: Option<usize>,
    /// What to print
    #[arg(long, default_value = "json")]
    format: Format,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// The best method there is
    Auto,
    /// Minimum spanning tree
    Mst,
}

/// As [`TopologyChoice`].
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Topology {
    Auto,
    Open,
    Closed,
}

impl From<Topology> for TopologyChoice {
    fn from(topology: Topology) -> Self {
        match topology {
            Topology::Auto => Self::Auto,
            Topology::Open => Self::Open,
            Topology::Closed => Self::Closed,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// One object with the order, the verdict and its doubts
    Json,
    /// One row index a line, in recovered order
    Indices,
    /// The input's points in recovered order
    Csv,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let points = arguments.source.points(arguments.manifold)?;
    let mut ordering = order_points(arguments, &points)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", arguments.source.input.display())))?;
    // Without rotations and translations to weigh against each other, there is no weight that the order could hang on.
    ordering.weight_stable.get_or_insert(true);
    if ordering.verdict == Verdict::Ambiguous && !matches!(arguments.format, Format::Json) {
        // The other formats have no place for it, and an order that is in doubt must not pass for a sure one.
        let first = ordering.doubts.first().map_or("", |doubt| &doubt.why);
        eprintln!(
            "reorder: warning: {}: the order is ambiguous ({} doubts): {first}",
            arguments.source.input.display(),
            ordering.doubts.len()
        );
    }
    print(&match arguments.format {
        Format::Json => serde_json::to_string(&ordering).map_err(Failure::bad_input)? + "\n",
        Format::Indices => ordering.order.iter().map(|row| format!("{row}\n")).collect(),
        Format::Csv => csv(&points, &ordering.order),
    })
}

fn order_points(arguments: &Arguments, points: &Points) -> Result<Ordering, OrderError> {
    // Both mean the same as long as there is one method.
    let (Method::Auto | Method::Mst) = arguments.method;
    let options = Options { topology: arguments.topology.into(), start: arguments.start };
    match points {
        Points::Plane(points) => order(&R2::default(), points, &options),
        Points::Space(points) => order(&R3::default(), points, &options),
        Points::Rotations(points) => order(&So3, points, &options),
        Points::Poses(points) => order_poses(points, arguments.metres_per_radian, &options),
    }
}

fn csv(points: &Points, order: &[usize]) -> String {
    let (header, rows): (&str, Vec<Vec<f64>>) = match points {
        Points::Plane(p) => ("x,y", p.iter().map(|p| p.as_slice().to_vec()).collect()),
        Points::Space(p) => ("x,y,z", p.iter().map(|p| p.as_slice().to_vec()).collect()),
        Points::Rotations(r) => ("qx,qy,qz,qw", r.iter().map(|r| xyzw_from_rotation(r).to_vec()).collect()),
        Points::Poses(p) => {
            let row = |p: &Pose| [p.translation.vector.as_slice(), &xyzw_from_rotation(&p.rotation)].concat();
            ("x,y,z,qx,qy,qz,qw", p.iter().map(row).collect())
        }
    };
    let mut text = format!("{header}\n");
    for &i in order {
        let fields: Vec<String> = rows[i].iter().map(f64::to_string).collect();
        text += &(fields.join(",") + "\n");
    }
    text
}
