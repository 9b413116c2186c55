//! Where points come from: tables with named columns, or poses in files and bags.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use planner::se3_geom::nalgebra::{Isometry2, SVector, Similarity2, UnitQuaternion, Vector2, Vector3};
use planner::se3_geom::{Pose, pose_from_xyzw, rotation_from_xyzw, xyzw_from_rotation};
use pose_bag::{Grouping, POSE_COLUMNS, PoseSet, Selection, Table, read_table, recover_poses};

use crate::failure::Failure;

#[derive(Args)]
pub(crate) struct Source {
    /// CSV with a header, EuRoC, TUM, KITTI, an MCAP or .db3 file or the folder of a rosbag2 bag; `-` reads CSV from standard input
    pub(crate) input: PathBuf,
    /// Topic, where a bag has several with poses
    #[arg(long)]
    topic: Option<String>,
    /// The frames whose transforms are meant, where the topic is of type TFMessage
    #[arg(long, value_name = "PARENT:CHILD", value_parser = frame_pair)]
    frames: Option<(String, String)>,
    /// Which PoseArray or Path message of the topic, counted from 0; needed where there are several
    #[arg(long)]
    message: Option<usize>,
}

/// The space the points live in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Manifold {
    /// Points in the plane: columns x, y
    R2,
    /// Points in space: columns x, y, z
    R3,
    /// Points of 2 to 8 dimensions: all columns but t
    Rn,
    /// Points on a sphere: columns lat, lon in degrees
    S2,
    /// Rotations: columns qx, qy, qz, qw
    So3,
    /// Poses in the plane: columns x, y, theta in radians
    Se2,
    /// Poses: columns x, y, z, qx, qy, qz, qw
    Se3,
    /// Poses in the plane with a scale: columns x, y, theta, scale
    Sim2,
}

pub(crate) enum Points {
    Plane(Vec<Vector2<f64>>),
    Space(Vec<Vector3<f64>>),
    /// Four to eight coordinates, the rest zeros, which change no distance: a space of its own each would be compiled for minutes.
    Flat(Vec<SVector<f64, 8>>),
    Sphere(Vec<Vector3<f64>>),
    Rotations(Vec<UnitQuaternion<f64>>),
    PlanarPoses(Vec<Isometry2<f64>>),
    Poses(Vec<Pose>),
    Similarities(Vec<Similarity2<f64>>),
}

/// Points, and the columns they were read from with every row of them.
pub(crate) struct Rows {
    pub(crate) points: Points,
    pub(crate) columns: Vec<String>,
    pub(crate) values: Vec<Vec<f64>>,
    /// What they were read from, where that is a table.
    pub(crate) table: Option<Table>,
}

/// `parent:child`, without leading slashes.
pub(crate) fn frame_pair(text: &str) -> Result<(String, String), String> {
    let bare = |frame: &str| frame.trim_start_matches('/').to_owned();
    let (parent, child) = text.split_once(':').ok_or("not two frames with a colon between")?;
    Ok((bare(parent), bare(child)))
}

impl Source {
    /// Standard input and `.csv` are tables; everything else holds poses.
    fn is_table(&self) -> bool {
        self.input == Path::new("-") || self.input.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"))
    }

    /// What the input is called in sentences.
    pub(crate) fn name(&self) -> String {
        if self.input == Path::new("-") { "standard input".to_owned() } else { self.input.display().to_string() }
    }

    /// The points of a manifold; where none is named, of the richest one that the columns allow.
    pub(crate) fn rows(&self, manifold: Option<Manifold>) -> Result<Rows, Failure> {
        if self.is_table() {
            let table = read_table(&self.input).map_err(Failure::bad_input)?;
            return Ok(Rows { table: Some(table.clone()), ..rows_of_table(&table, manifold)? });
        }
        let poses = self.poses()?.poses;
        let values: Vec<Vec<f64>> = poses
            .iter()
            .map(|p| [p.translation.vector.as_slice(), &xyzw_from_rotation(&p.rotation)].concat())
            .collect();
        let (chosen, points) = match manifold {
            None | Some(Manifold::Se3) => (0..7, Points::Poses(poses)),
            Some(Manifold::So3) => (3..7, Points::Rotations(poses.iter().map(|p| p.rotation).collect())),
            Some(Manifold::R2) => (0..2, Points::Plane(poses.iter().map(|p| p.translation.vector.xy()).collect())),
            Some(Manifold::R3 | Manifold::Rn) => {
                (0..3, Points::Space(poses.iter().map(|p| p.translation.vector).collect()))
            }
            Some(Manifold::S2 | Manifold::Se2 | Manifold::Sim2) => {
                let sentence = format!("{}: poses in space are no points of that manifold", self.input.display());
                return Err(Failure::BadInput(sentence));
            }
        };
        Ok(Rows {
            points,
            columns: POSE_COLUMNS[chosen.clone()].iter().map(|&column| column.to_owned()).collect(),
            values: values.into_iter().map(|row| row[chosen.clone()].to_vec()).collect(),
            table: None,
        })
    }

    /// The one set of poses that is meant.
    pub(crate) fn poses(&self) -> Result<PoseSet, Failure> {
        let name = self.input.display();
        let selection = Selection { topic: self.topic.clone(), frames: self.frames.clone(), grouping: Grouping::Whole };
        let (mut sets, losses) = recover_poses(&self.input, &selection).map_err(Failure::bad_input)?;
        if let Some(loss) = losses.first() {
            return Err(Failure::bad_input(loss));
        }
        let index = match self.message {
            // Sets come by the time at which they were recorded; messages count as they stand in the bag.
            Some(message) => {
                let set = sets.iter().position(|set| set.origin.message == Some(message));
                let only = (message == 0 && sets.len() == 1).then_some(0);
                set.or(only).ok_or_else(|| {
                    let sentence = format!("{name}: there is no message {message}, only {} counted from 0", sets.len());
                    Failure::BadInput(sentence)
                })?
            }
            None if sets.len() == 1 => 0,
            None => {
                let sentence = format!("{name} holds {} sets of poses: choose one with --message", sets.len());
                return Err(Failure::BadInput(sentence));
            }
        };
        Ok(sets.swap_remove(index))
    }
}

fn rows_of_table(table: &Table, manifold: Option<Manifold>) -> Result<Rows, Failure> {
    let manifold = match manifold {
        None => manifold_of_columns(table)?,
        Some(named) => named,
    };
    let columns = columns_of(table, manifold);
    let values = table.select(&columns).map_err(Failure::bad_input)?;
    let points = match manifold {
        Manifold::R2 => Points::Plane(flat(&values)),
        Manifold::R3 => Points::Space(flat(&values)),
        Manifold::Rn => match columns.len() {
            2 => Points::Plane(flat(&values)),
            3 => Points::Space(flat(&values)),
            4..=8 => Points::Flat(flat(&values)),
            dimension => {
                let (file, columns) = (table.file(), columns.join(", "));
                return Err(Failure::BadInput(format!(
                    "{file}: the {dimension} columns {columns} are not 2 to 8 coordinates"
                )));
            }
        },
        Manifold::S2 => Points::Sphere(checked(table, &values, direction)?),
        Manifold::So3 => Points::Rotations(checked(table, &values, rotation)?),
        Manifold::Se2 => Points::PlanarPoses(checked(table, &values, planar_pose)?),
        Manifold::Se3 => Points::Poses(checked(table, &values, |row| {
            pose_from_xyzw([row[0], row[1], row[2]], [row[3], row[4], row[5], row[6]])
                .map_err(|reason| reason.to_string())
        })?),
        Manifold::Sim2 => Points::Similarities(checked(table, &values, similarity)?),
    };
    Ok(Rows { points, columns: columns.into_iter().map(str::to_owned).collect(), values, table: None })
}

fn flat<const N: usize>(values: &[Vec<f64>]) -> Vec<SVector<f64, N>> {
    values.iter().map(|row| padded(row)).collect()
}

pub(crate) fn coordinates<const N: usize>(row: &[f64]) -> Result<SVector<f64, N>, String> {
    Ok(padded(row))
}

fn padded<const N: usize>(row: &[f64]) -> SVector<f64, N> {
    SVector::from_iterator(row.iter().copied().chain(std::iter::repeat(0.0)).take(N))
}

pub(crate) fn rotation(row: &[f64]) -> Result<UnitQuaternion<f64>, String> {
    rotation_from_xyzw([row[0], row[1], row[2], row[3]]).map_err(|reason| reason.to_string())
}

pub(crate) fn pose(row: &[f64]) -> Result<Pose, String> {
    Ok(Pose::from_parts(Vector3::new(row[0], row[1], row[2]).into(), rotation(&row[3..])?))
}

pub(crate) fn planar_pose(row: &[f64]) -> Result<Isometry2<f64>, String> {
    Ok(Isometry2::new(Vector2::new(row[0], row[1]), row[2]))
}

pub(crate) fn similarity(row: &[f64]) -> Result<Similarity2<f64>, String> {
    match row[3] {
        scale if scale > 0.0 => Ok(Similarity2::from_isometry(planar_pose(row)?, scale)),
        scale => Err(format!("scale is not positive: {scale}")),
    }
}

/// Latitude and longitude in degrees; longitudes may go round more than once.
pub(crate) fn direction(row: &[f64]) -> Result<Vector3<f64>, String> {
    let [latitude, longitude] = [row[0], row[1]];
    if latitude.abs() > 90.0 {
        return Err(format!("lat is beyond 90 degrees: {latitude}"));
    }
    let ((z, r), (y, x)) = (latitude.to_radians().sin_cos(), longitude.to_radians().sin_cos());
    Ok(Vector3::new(r * x, r * y, z))
}

fn checked<P>(
    table: &Table,
    values: &[Vec<f64>],
    point: impl Fn(&[f64]) -> Result<P, String>,
) -> Result<Vec<P>, Failure> {
    let named = |(row, line): (&Vec<f64>, usize)| {
        point(row).map_err(|reason| Failure::BadInput(format!("{}, line {line}: {reason}", table.file())))
    };
    values.iter().zip(table.line_numbers()).map(named).collect()
}

/// The columns of each manifold that is known by its columns; of flat spaces only those with named axes.
const COLUMNS: [(&[&str], Manifold); 7] = [
    (&["x", "y"], Manifold::R2),
    (&["x", "y", "z"], Manifold::R3),
    (&["lat", "lon"], Manifold::S2),
    (&["qx", "qy", "qz", "qw"], Manifold::So3),
    (&["x", "y", "theta"], Manifold::Se2),
    (&POSE_COLUMNS, Manifold::Se3),
    (&["x", "y", "theta", "scale"], Manifold::Sim2),
];

/// A column that is no coordinate unless it is asked for.
const TIME: &str = "t";

fn columns_of(table: &Table, manifold: Manifold) -> Vec<&str> {
    match COLUMNS.iter().find(|(_, known)| *known == manifold) {
        Some((columns, _)) => columns.to_vec(),
        None => table.columns().iter().map(String::as_str).filter(|&column| column != TIME).collect(),
    }
}

/// The manifold whose columns these are, all of them and no others but `t`: a column that nobody looks at could be the one that
/// tells points apart.
fn manifold_of_columns(table: &Table) -> Result<Manifold, Failure> {
    if table.is_euroc() {
        return Ok(Manifold::Se3);
    }
    let present: Vec<&str> = table.columns().iter().map(String::as_str).filter(|&column| column != TIME).collect();
    let is_all = |columns: &[&str]| columns.len() == present.len() && columns.iter().all(|c| present.contains(c));
    let found = COLUMNS.iter().find(|(columns, _)| is_all(columns));
    found.map(|&(_, manifold)| manifold).ok_or_else(|| {
        let (file, columns) = (table.file(), present.join(", "));
        let known: Vec<String> = COLUMNS.iter().map(|(columns, _)| columns.join(",")).collect();
        let known = known.join(" · ");
        Failure::BadInput(format!(
            "{file}: the columns {columns} are not those of a manifold ({known}); name one with --manifold to use its columns \
             and ignore the others"
        ))
    })
}
