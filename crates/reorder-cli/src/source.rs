//! Where points come from: tables with named columns, or poses in files and bags.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use planner::se3_geom::nalgebra::{UnitQuaternion, Vector2, Vector3};
use planner::se3_geom::{Pose, rotation_from_xyzw};
use pose_bag::{PoseSet, Table, read_poses, read_table};

use crate::failure::Failure;

#[derive(Args)]
pub(crate) struct Source {
    /// CSV with a header, TUM, an MCAP file or the folder of a rosbag2 bag; `-` reads CSV from standard input
    pub(crate) input: PathBuf,
    /// Topic, where a bag has several with poses
    #[arg(long)]
    topic: Option<String>,
    /// Which PoseArray message of the topic, counted from 0; needed where there are several
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
    /// Points in the plane or in space, as the columns say
    Rn,
    /// Rotations: columns qx, qy, qz, qw
    So3,
    /// Poses: columns x, y, z, qx, qy, qz, qw
    Se3,
}

pub(crate) enum Points {
    Plane(Vec<Vector2<f64>>),
    Space(Vec<Vector3<f64>>),
    Rotations(Vec<UnitQuaternion<f64>>),
    Poses(Vec<Pose>),
}

impl Source {
    /// Standard input and `.csv` are tables; everything else holds poses.
    fn is_table(&self) -> bool {
        self.input == Path::new("-") || self.input.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"))
    }

    /// The points of a manifold; where none is named, of the richest one that the columns allow.
    pub(crate) fn points(&self, manifold: Option<Manifold>) -> Result<Points, Failure> {
        if self.is_table() {
            let table = read_table(&self.input).map_err(Failure::bad_input)?;
            return points_of_table(&table, manifold);
        }
        let poses = self.poses()?.poses;
        Ok(match manifold {
            None | Some(Manifold::Se3) => Points::Poses(poses),
            Some(Manifold::So3) => Points::Rotations(poses.iter().map(|p| p.rotation).collect()),
            Some(Manifold::R2) => Points::Plane(poses.iter().map(|p| p.translation.vector.xy()).collect()),
            Some(Manifold::R3 | Manifold::Rn) => Points::Space(poses.iter().map(|p| p.translation.vector).collect()),
        })
    }

    /// The one set of poses that is meant.
    pub(crate) fn poses(&self) -> Result<PoseSet, Failure> {
        let name = self.input.display();
        let mut sets = read_poses(&self.input, self.topic.as_deref()).map_err(Failure::bad_input)?;
        let index = match self.message {
            Some(index) if index < sets.len() => index,
            Some(index) => {
                let sentence = format!("{name}: there is no message {index}, only {} counted from 0", sets.len());
                return Err(Failure::BadInput(sentence));
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

fn points_of_table(table: &Table, manifold: Option<Manifold>) -> Result<Points, Failure> {
    let manifold = match manifold {
        None | Some(Manifold::Rn) => manifold_of_columns(table, manifold.is_some())?,
        Some(named) => named,
    };
    let select = |columns: &[&str]| table.select(columns).map_err(Failure::bad_input);
    Ok(match manifold {
        Manifold::R2 | Manifold::Rn => {
            Points::Plane(select(&["x", "y"])?.iter().map(|r| Vector2::new(r[0], r[1])).collect())
        }
        Manifold::R3 => {
            Points::Space(select(&["x", "y", "z"])?.iter().map(|r| Vector3::new(r[0], r[1], r[2])).collect())
        }
        Manifold::So3 => {
            let rows = select(&["qx", "qy", "qz", "qw"])?;
            let rotation = |(row, line): (&Vec<f64>, usize)| {
                rotation_from_xyzw([row[0], row[1], row[2], row[3]])
                    .map_err(|reason| Failure::BadInput(format!("{}, line {line}: {reason}", table.file())))
            };
            Points::Rotations(rows.iter().zip(table.line_numbers()).map(rotation).collect::<Result<_, _>>()?)
        }
        Manifold::Se3 => Points::Poses(table.poses().map_err(Failure::bad_input)?),
    })
}

/// The manifold whose columns these are, all of them and no others but `t`: a column that nobody looks at could be the one that
/// tells points apart.
fn manifold_of_columns(table: &Table, flat_only: bool) -> Result<Manifold, Failure> {
    let known: [(&[&str], Manifold); 4] = [
        (&["x", "y"], Manifold::R2),
        (&["x", "y", "z"], Manifold::R3),
        (&["qx", "qy", "qz", "qw"], Manifold::So3),
        (&["x", "y", "z", "qx", "qy", "qz", "qw"], Manifold::Se3),
    ];
    let present: Vec<&str> = table.columns().iter().map(String::as_str).filter(|&column| column != "t").collect();
    let is_all = |columns: &[&str]| columns.len() == present.len() && columns.iter().all(|c| present.contains(c));
    let allowed = |manifold: Manifold| !flat_only || matches!(manifold, Manifold::R2 | Manifold::R3);
    let found = known.iter().find(|(columns, manifold)| is_all(columns) && allowed(*manifold));
    found.map(|&(_, manifold)| manifold).ok_or_else(|| {
        let (file, columns) = (table.file(), present.join(", "));
        Failure::BadInput(format!(
            "{file}: the columns {columns} are not those of a manifold (x,y · x,y,z · qx,qy,qz,qw · x,y,z,qx,qy,qz,qw); \
             name one with --manifold to use its columns and ignore the others"
        ))
    })
}
