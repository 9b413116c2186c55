//! TUM trajectories: `t x y z qx qy qz qw` separated by blanks, `#` for comments.

use std::io::BufRead;
use std::path::Path;

use se3_geom::Pose;

use crate::BagError;
use crate::lines::{finite, for_each_line};
use crate::pending::write_text;
use crate::table::{POSE_COLUMNS, pose_from_row, row_from_pose};

const NANOSECONDS: i64 = 1_000_000_000;

/// Stamps in nanoseconds, and poses, line by line.
pub(crate) fn read_tum(reader: impl BufRead, file: &str) -> Result<(Vec<i64>, Vec<Pose>), BagError> {
    let (mut stamps_ns, mut poses) = (Vec::new(), Vec::new());
    for_each_line(reader, file, |line, text| {
        let row: Vec<&str> = text.split_whitespace().collect();
        let Some((stamp, numbers)) = row.split_first().filter(|_| row.len() == 1 + POSE_COLUMNS.len()) else {
            let expected = 1 + POSE_COLUMNS.len();
            return Err(BagError::FieldCount { file: file.into(), line, expected, found: row.len() });
        };
        let number = |(text, column): (&&str, &&str)| finite(text, file, line, column);
        let values = numbers.iter().zip(&POSE_COLUMNS).map(number).collect::<Result<Vec<_>, _>>()?;
        let invalid = |reason| BagError::InvalidPoseInLine { file: file.into(), line, reason };
        stamps_ns.push(nanoseconds(stamp, file, line)?);
        poses.push(pose_from_row(&values).map_err(invalid)?);
        Ok(())
    })?;
    if poses.is_empty() {
        return Err(BagError::Empty { file: file.into() });
    }
    Ok((stamps_ns, poses))
}

/// Seconds as written, in nanoseconds. Plain decimals are taken digit by digit: a double resolves today's epoch only to 240 ns.
fn nanoseconds(text: &str, file: &str, line: usize) -> Result<i64, BagError> {
    let seconds = finite(text, file, line, "t")?;
    Ok(exact_nanoseconds(text).unwrap_or((seconds * NANOSECONDS as f64).round() as i64))
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
