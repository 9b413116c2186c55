//! Tracks of poses, numbers separated by blanks, `#` for comments: TUM, `t x y z qx qy qz qw`, and KITTI, twelve numbers.

use std::io::BufRead;
use std::path::Path;

use se3_geom::Pose;
use se3_geom::nalgebra::{Matrix3, Matrix3x4, Rotation3, Translation3, UnitQuaternion};

use crate::BagError;
use crate::lines::{finite, for_each_line};
use crate::pending::write_text;
use crate::table::{POSE_COLUMNS, pose_from_row, row_from_pose};

const NANOSECONDS: i64 = 1_000_000_000;
/// As loose as for the norm of a quaternion.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// Numbers on a line of KITTI.
const KITTI_NUMBERS: usize = 12;

/// Stamps in nanoseconds (of TUM), and poses, line by line; the first line tells the format.
pub(crate) fn read_track(reader: impl BufRead, file: &str) -> Result<(Option<Vec<i64>>, Vec<Pose>), BagError> {
    let (mut stamps_ns, mut poses) = (Vec::new(), Vec::new());
    for_each_line(reader, file, |line, text| {
        let row: Vec<&str> = text.split_whitespace().collect();
        let is_kitti = if poses.is_empty() { row.len() == KITTI_NUMBERS } else { stamps_ns.is_empty() };
        poses.push(if is_kitti {
            kitti_pose(&row, file, line)?
        } else {
            let (stamp_ns, pose) = tum_pose(&row, file, line)?;
            stamps_ns.push(stamp_ns);
            pose
        });
        Ok(())
    })?;
    if poses.is_empty() {
        return Err(BagError::Empty { file: file.into() });
    }
    Ok((Some(stamps_ns).filter(|stamps| !stamps.is_empty()), poses))
}

fn tum_pose(row: &[&str], file: &str, line: usize) -> Result<(i64, Pose), BagError> {
    let expected = 1 + POSE_COLUMNS.len();
    let Some((stamp, numbers)) = row.split_first().filter(|_| row.len() == expected) else {
        return Err(BagError::FieldCount { file: file.into(), line, expected, found: row.len() });
    };
    let number = |(text, column): (&&str, &&str)| finite(text, file, line, column);
    let values = numbers.iter().zip(&POSE_COLUMNS).map(number).collect::<Result<Vec<_>, _>>()?;
    let invalid = |reason| BagError::InvalidPoseInLine { file: file.into(), line, reason };
    Ok((nanoseconds(stamp, file, line)?, pose_from_row(&values).map_err(invalid)?))
}

/// The matrix (R | t), row by row.
fn kitti_pose(row: &[&str], file: &str, line: usize) -> Result<Pose, BagError> {
    let number = |(k, text): (usize, &&str)| finite(text, file, line, &format!("number {}", k + 1));
    let values = row.iter().enumerate().map(number).collect::<Result<Vec<_>, _>>()?;
    let (expected, found) = (KITTI_NUMBERS, values.len());
    let values: [f64; KITTI_NUMBERS] =
        values.try_into().map_err(|_| BagError::FieldCount { file: file.into(), line, expected, found })?;
    let matrix = Matrix3x4::from_row_slice(&values);
    let rotation: Matrix3<f64> = matrix.fixed_columns::<3>(0).into();
    let deviation =
        if rotation.determinant() > 0.0 { (rotation * rotation.transpose() - Matrix3::identity()).amax() } else { 2.0 };
    // Files have six digits; what is farther away is no rounding.
    if deviation.is_nan() || deviation > ROTATION_TOLERANCE {
        return Err(BagError::NotARotation { file: file.into(), line, deviation });
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    Ok(Pose::from_parts(Translation3::new(values[3], values[7], values[11]), rotation))
}

/// Seconds as written, in nanoseconds. Plain decimals are taken digit by digit: a double resolves today's epoch only to 240 ns.
fn nanoseconds(text: &str, file: &str, line: usize) -> Result<i64, BagError> {
    let seconds = finite(text, file, line, "t")?;
    let rounded = (seconds * NANOSECONDS as f64).round();
    // As a double, i64::MAX is 2⁶³, one too many.
    let fitting = Some(rounded as i64).filter(|_| rounded.abs() < i64::MAX as f64);
    exact_nanoseconds(text).or(fitting).ok_or_else(|| BagError::StampRange {
        file: file.into(),
        line,
        stamp: text.chars().take(40).collect(),
    })
}

fn exact_nanoseconds(text: &str) -> Option<i64> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let (sign, whole) = whole.strip_prefix('-').map_or((1, whole), |rest| (-1, rest));
    if fraction.len() > 9 || !fraction.bytes().chain(whole.bytes()).all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let fraction: i64 = format!("{fraction:0<9}").parse().ok()?;
    let seconds: i64 = whole.parse().ok()?;
    seconds.checked_mul(NANOSECONDS)?.checked_add(fraction).map(|nanos| sign * nanos)
}

/// Writes stamps (nanoseconds) and poses as TUM; an existing file is replaced as a whole.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_tum(path: impl AsRef<Path>, stamped_poses: &[(i64, Pose)]) -> Result<(), BagError> {
    write_text(path.as_ref(), |out| {
        stamped_poses.iter().try_for_each(|(stamp_ns, pose)| {
            let (sign, nanos) = (if *stamp_ns < 0 { "-" } else { "" }, stamp_ns.unsigned_abs());
            let (seconds, fraction) = (nanos / NANOSECONDS.unsigned_abs(), nanos % NANOSECONDS.unsigned_abs());
            writeln!(out, "{sign}{seconds}.{fraction:09} {}", row_from_pose(pose, " "))
        })
    })
}
