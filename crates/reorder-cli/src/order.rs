//! `reorder order`.

use clap::{Args, ValueEnum};
use planner::reorder::{
    MethodChoice, Options, OrderError, Ordering, Repair, TopologyChoice, Verdict, Weight, order, order_weighted,
};
use planner::se3_geom::{Euclidean, Se2, Se3, Sim2, So3, Sphere};

use crate::explain::explain;
use crate::failure::Failure;
use crate::output::print;
use crate::source::{Manifold, Points, Rows, Source};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// The space the points live in; told from the columns where it is not given
    #[arg(long)]
    manifold: Option<Manifold>,
    /// How many metres count as much as one radian when poses are compared: a number, or `auto` to tell it from the poses
    #[arg(long, value_name = "L", default_value = "auto", value_parser = weight)]
    metres_per_radian: Weight,
    /// How to order
    #[arg(long, default_value = "auto")]
    method: Method,
    /// Open curve, closed curve, or told from the points
    #[arg(long, default_value = "auto")]
    topology: Topology,
    /// Row (counted from 0) at which the order starts
    #[arg(long, value_name = "INDEX")]
    start: Option<usize>,
    /// Search for a shorter and smoother order where the minimum spanning tree is none to trust
    #[arg(long, default_value = "auto")]
    repair: RepairChoice,
    /// Move noisy points onto the line of their neighbours before they are ordered; what is handed on stays as it was
    #[arg(long)]
    denoise: bool,
    /// Print what speaks for and against the order, for a person, in place of the order
    #[arg(long, conflicts_with = "format")]
    explain: bool,
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

/// As [`Repair`].
#[derive(Clone, Copy, ValueEnum)]
enum RepairChoice {
    /// Up to 3000 points
    Auto,
    /// However long it takes
    Always,
    /// Never
    Off,
}

fn weight(text: &str) -> Result<Weight, String> {
    match text {
        "auto" => Ok(Weight::Auto),
        number => number.parse().map(Weight::MetresPerRadian).map_err(|_| "neither a number nor auto".to_owned()),
    }
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
    let rows = arguments.source.rows(arguments.manifold)?;
    let mut ordering = order_points(arguments, &rows.points)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", arguments.source.input.display())))?;
    // Without rotations and translations to weigh against each other, there is no weight that the order could hang on.
    ordering.weight_stable.get_or_insert(true);
    if arguments.explain {
        return print(&explain(&ordering));
    }
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
        Format::Csv => csv(&rows, &ordering.order),
    })
}

fn order_points(arguments: &Arguments, points: &Points) -> Result<Ordering, OrderError> {
    let options = Options {
        topology: arguments.topology.into(),
        start: arguments.start,
        method: match arguments.method {
            Method::Auto => MethodChoice::Auto,
            Method::Mst => MethodChoice::Mst,
        },
        repair: match arguments.repair {
            RepairChoice::Auto => Repair::Auto,
            RepairChoice::Always => Repair::Always,
            RepairChoice::Off => Repair::Off,
        },
        denoise: arguments.denoise,
    };
    let weight = arguments.metres_per_radian;
    match points {
        Points::Plane(points) => order(&Euclidean::<2>, points, &options),
        Points::Space(points) => order(&Euclidean::<3>, points, &options),
        Points::Flat4(points) => order(&Euclidean::<4>, points, &options),
        Points::Flat5(points) => order(&Euclidean::<5>, points, &options),
        Points::Flat6(points) => order(&Euclidean::<6>, points, &options),
        Points::Flat7(points) => order(&Euclidean::<7>, points, &options),
        Points::Flat8(points) => order(&Euclidean::<8>, points, &options),
        Points::Sphere(points) => order(&Sphere, points, &options),
        Points::Rotations(points) => order(&So3, points, &options),
        Points::PlanarPoses(points) => order_weighted::<Se2>(points, weight, &options),
        Points::Poses(points) => order_weighted::<Se3>(points, weight, &options),
        Points::Similarities(points) => order_weighted::<Sim2>(points, weight, &options),
    }
}

fn csv(rows: &Rows, order: &[usize]) -> String {
    let mut text = rows.columns.join(",") + "\n";
    for &i in order {
        let fields: Vec<String> = rows.values[i].iter().map(f64::to_string).collect();
        text += &(fields.join(",") + "\n");
    }
    text
}
