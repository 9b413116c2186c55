//! Poses in bags and other files.

use std::path::{Path, PathBuf};

use bag_replay::planner::pose_bag::msg::{Header, PoseArray, PoseStamped, Time};
use bag_replay::planner::pose_bag::{self, BagWriter, Grouping, PoseSet, Selection, recover_poses};
use bag_replay::planner::se3_geom::{Pose, Se3};
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;

use crate::arrays::{Rows, array};
use crate::error::{BagError, ReorderError, raised};
use crate::space::{Space, points};

/// File, topic, message, frame, time of recording, poses and stamps.
type Read<'py> = (
    PathBuf,
    Option<String>,
    Option<usize>,
    String,
    u64,
    Bound<'py, PyArrayDyn<f64>>,
    Option<Bound<'py, PyArray1<i64>>>,
);

/// Windows and gaps are given in s.
pub(crate) fn grouping(window_s: Option<f64>, gap_s: Option<f64>) -> PyResult<Grouping> {
    let nanoseconds = |seconds: f64| {
        let is_time = seconds > 0.0 && seconds < 1e9;
        let refused = || raised::<ReorderError>(format!("{seconds} is no positive time in s"));
        is_time.then_some((seconds * 1e9) as u64).ok_or_else(refused)
    };
    match (window_s, gap_s) {
        (None, None) => Ok(Grouping::Whole),
        (Some(window), None) => Ok(Grouping::Window { length_ns: nanoseconds(window)? }),
        (None, Some(gap)) => Ok(Grouping::Gap { longest_ns: nanoseconds(gap)? }),
        (Some(_), Some(_)) => Err(raised::<ReorderError>("poses are taken together by window or by gap, not by both")),
    }
}

#[pyfunction]
#[pyo3(signature = (path, topic, *, frames, window_s, gap_s, damaged))]
pub(crate) fn read_poses<'py>(
    py: Python<'py>,
    path: PathBuf,
    topic: Option<String>,
    frames: Option<(String, String)>,
    window_s: Option<f64>,
    gap_s: Option<f64>,
    damaged: bool,
) -> PyResult<(Vec<Read<'py>>, Vec<String>)> {
    let selection = Selection { topic, frames, grouping: grouping(window_s, gap_s)? };
    let (sets, losses) = py.detach(|| recover_poses(&path, &selection)).map_err(raised::<BagError>)?;
    if let Some(loss) = losses.first().filter(|_| !damaged) {
        return Err(raised::<BagError>(loss));
    }
    let sets = sets.into_iter().map(|set| read(py, set)).collect::<PyResult<_>>()?;
    Ok((sets, losses.iter().map(ToString::to_string).collect()))
}

fn read(py: Python<'_>, set: PoseSet) -> PyResult<Read<'_>> {
    let mut numbers = Vec::with_capacity(set.poses.len() * Se3::POINT);
    set.poses.iter().for_each(|pose| Se3::put(pose, &mut numbers));
    let poses = array(py, numbers, &[set.poses.len()], Some(Se3::POINT))?;
    let stamps = set.stamps_ns.map(|stamps| PyArray1::from_vec(py, stamps));
    Ok((set.origin.file, set.origin.topic, set.origin.message, set.frame_id, set.log_time_ns, poses, stamps))
}

#[pyfunction]
#[pyo3(signature = (path, poses, *, topic, frame_id, stamps_ns))]
pub(crate) fn write_poses<'py>(
    py: Python<'py>,
    path: PathBuf,
    poses: Bound<'py, PyAny>,
    topic: &str,
    frame_id: &str,
    stamps_ns: Option<Vec<i64>>,
) -> PyResult<()> {
    let rows = Rows::of("poses", &poses, Se3::POINT, Se3::LAYOUT)?.listed("poses")?;
    let numbers = rows.numbers()?;
    let poses = points(Se3::default(), numbers, "pose").map_err(raised::<ReorderError>)?;
    if let Some(count) = stamps_ns.as_ref().map(Vec::len).filter(|&count| count != poses.len()) {
        return Err(raised::<ReorderError>(format!("{count} stamps_ns for {} poses", poses.len())));
    }
    py.detach(|| write(&path, &poses, (topic, frame_id), stamps_ns.as_deref())).map_err(raised::<BagError>)
}

fn write(
    path: &Path,
    poses: &[Pose],
    (topic, frame_id): (&str, &str),
    stamps_ns: Option<&[i64]>,
) -> Result<(), pose_bag::BagError> {
    let header =
        |stamp_ns: i64| Header { stamp: Time::from_nanos(stamp_ns).unwrap_or_default(), frame_id: frame_id.to_owned() };
    let mut bag = BagWriter::create(path)?;
    match stamps_ns {
        None => bag.write(topic, 0, &PoseArray { header: header(0), poses: poses.iter().map(Into::into).collect() })?,
        Some(stamps_ns) => {
            for (pose, &stamp_ns) in poses.iter().zip(stamps_ns) {
                let at_ns = u64::try_from(stamp_ns).unwrap_or_default();
                bag.write(topic, at_ns, &PoseStamped { header: header(stamp_ns), pose: pose.into() })?;
            }
        }
    }
    bag.finish()
}
