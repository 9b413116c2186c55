//! `reorder order`.

use ::report::{counted, explain};
use clap::{Args, ValueEnum};
use planner::reorder::{
    ComponentsChoice, EdgeFigures, MethodChoice, Options, Ordering, Repair, TopologyChoice, Verdict, Weight,
};
use serde::Serialize;
use tracing::debug_span;

use crate::ask::Ask;
use crate::failure::Failure;
use crate::output::print;
use crate::progress::with_progress;
use crate::source::{Manifold, Rows, Source};

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
    /// Start at the end of the curve (of a closed one: at the point) nearest to these values of the manifold's columns, as
    /// x,y,z,qx,qy,qz,qw of a pose
    #[arg(long, value_name = "VALUES", value_delimiter = ',', allow_hyphen_values = true, conflicts_with = "start")]
    start_at: Option<Vec<f64>>,
    /// One curve through all points, or as many as are clearly apart, with outliers in none
    #[arg(long, default_value = "one")]
    components: Components,
    /// Search for a shorter and smoother order where the minimum spanning tree is none to trust
    #[arg(long, default_value = "auto")]
    repair: RepairChoice,
    /// Move noisy points toward the curve of their neighbours before they are ordered; what is handed on stays as it was
    #[arg(long)]
    denoise: bool,
    /// Print what speaks for and against the order, for a person, in place of the order
    #[arg(long, conflicts_with = "format")]
    explain: bool,
    /// Add gap, reach and epsilon of every edge to the JSON object
    #[arg(long, conflicts_with = "explain")]
    edges: bool,
    /// What to print
    #[arg(long, default_value = "json")]
    format: Format,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// Minimum spanning tree, repaired where needed
    Auto,
    /// Minimum spanning tree
    Mst,
    /// Nearest neighbours on either side of every point; time grows with the square of their number
    NnCrust,
    /// Voronoi and Delaunay edges, in the plane
    Crust,
    /// Always on to the nearest point left, from --start or else row 0; mostly wrong from within an arc, and as slow as nn-crust
    Nearest,
}

/// As [`ComponentsChoice`].
#[derive(Clone, Copy, ValueEnum)]
enum Components {
    /// One curve; several are named in the answer
    One,
    /// Each curve by itself where gaps jump by a factor of 3
    Auto,
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

pub(crate) fn weight(text: &str) -> Result<Weight, String> {
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

/// The object of `--edges`.
#[derive(Serialize)]
struct WithEdges<'a> {
    #[serde(flatten)]
    ordering: &'a Ordering,
    edges: &'a [EdgeFigures],
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (rows, ordering, edges) = with_progress(|| {
        let rows = debug_span!("reading").in_scope(|| arguments.source.rows(arguments.manifold))?;
        let (ordering, edges) = ask(arguments)
            .order(&rows)
            .map_err(|why| Failure::BadInput(format!("{}: {why}", arguments.source.name())))?;
        Ok((rows, ordering, edges))
    })?;
    if arguments.explain {
        return print(&explain(&ordering, &edges));
    }
    if ordering.verdict == Verdict::Ambiguous && !matches!(arguments.format, Format::Json) {
        // The other formats have no place for it, and an order that is in doubt must not pass for a sure one.
        let first = ordering.doubts.first().map_or("", |doubt| &doubt.why);
        eprintln!(
            "reorder: warning: {}: the order is ambiguous ({}): {first}",
            arguments.source.name(),
            counted(ordering.doubts.len(), "doubt")
        );
    }
    print(&match arguments.format {
        Format::Json if arguments.edges => json(&WithEdges { ordering: &ordering, edges: &edges })?,
        Format::Json => json(&ordering)?,
        Format::Indices => ordering.order.iter().map(|row| format!("{row}\n")).collect(),
        Format::Csv => csv(&rows, &ordering.order),
    })
}

fn json(object: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string(object).map_err(Failure::bad_input)? + "\n")
}

fn ask(arguments: &Arguments) -> Ask<'_> {
    let options = Options {
        topology: arguments.topology.into(),
        start: arguments.start,
        method: match arguments.method {
            Method::Auto => MethodChoice::Auto,
            Method::Mst => MethodChoice::Mst,
            Method::NnCrust => MethodChoice::NnCrust,
            Method::Crust => MethodChoice::Crust,
            Method::Nearest => MethodChoice::Nearest,
        },
        repair: match arguments.repair {
            RepairChoice::Auto => Repair::Auto,
            RepairChoice::Always => Repair::Always,
            RepairChoice::Off => Repair::Off,
        },
        denoise: arguments.denoise,
        components: match arguments.components {
            Components::One => ComponentsChoice::One,
            Components::Auto => ComponentsChoice::Auto,
        },
    };
    let with_edges = arguments.edges || arguments.explain;
    Ask { options, weight: arguments.metres_per_radian, from: arguments.start_at.as_deref(), with_edges }
}

/// A table's rows whole, with the columns that no point was made of.
fn csv(rows: &Rows, order: &[usize]) -> String {
    if let Some(table) = &rows.table {
        let lines = order.iter().map(|&row| table.row_text(row));
        return std::iter::once(table.columns().join(",").as_str())
            .chain(lines)
            .map(|line| format!("{line}\n"))
            .collect();
    }
    let mut text = rows.columns.join(",") + "\n";
    for &i in order {
        let fields: Vec<String> = rows.values[i].iter().map(f64::to_string).collect();
        text += &(fields.join(",") + "\n");
    }
    text
}
