//! CSV: a header that names the columns, then numbers.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::num::{IntErrorKind, ParseIntError};
use std::path::Path;

use se3_geom::{Pose, pose_from_xyzw, xyzw_from_rotation};

use crate::BagError;
use crate::lines::{finite, for_each_line_and_comment};
use crate::pending::write_text;

/// The columns of a pose: metres, and a unit quaternion in the order x, y, z, w.
pub const POSE_COLUMNS: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

/// The path that stands for standard input.
pub(crate) const STANDARD_INPUT: &str = "-";

/// A table of named columns. Fields are checked when a column is asked for, so columns nobody asks for may hold anything.
#[derive(Debug, Clone)]
pub struct Table {
    file: String,
    columns: Vec<String>,
    /// The rows' text, one after the other: a million rows are one allocation.
    text: String,
    rows: Vec<Row>,
    is_euroc: bool,
}

#[derive(Debug, Clone, Copy)]
struct Row {
    line: usize,
    /// Where its text ends; it begins where that of the row before ends.
    end: usize,
}

/// Reads a CSV file, or standard input where the path is `-`.
///
/// Blank lines and lines that begin with `#` are skipped, but for the header of a EuRoC track (`#timestamp [ns],p_RS_R_x [m],…`), whose
/// columns then have the names used here.
///
/// # Errors
/// Where the file cannot be read, is empty, has no header, or a line has another number of fields than the header.
pub fn read_table(path: impl AsRef<Path>) -> Result<Table, BagError> {
    let path = path.as_ref();
    if path == Path::new(STANDARD_INPUT) {
        return Table::from_reader(std::io::stdin().lock(), "standard input");
    }
    let file = path.display().to_string();
    let opened = File::open(path).map_err(BagError::io(&file))?;
    Table::from_reader(BufReader::new(opened), &file)
}

impl Table {
    /// Reads a table; `file` names it in errors.
    ///
    /// # Errors
    /// As [`read_table`].
    pub fn from_reader(reader: impl BufRead, file: &str) -> Result<Self, BagError> {
        let mut columns: Option<Vec<String>> = None;
        let (mut rows, mut all) = (Vec::new(), String::new());
        let mut is_euroc = false;
        for_each_line_and_comment(reader, file, |line, text| match &columns {
            None if text.starts_with('#') => {
                columns = euroc_columns(text);
                is_euroc = columns.is_some();
                Ok(())
            }
            None => {
                columns = Some(parse_header(file, line, text)?);
                Ok(())
            }
            Some(_) if text.starts_with('#') => Ok(()),
            Some(columns) => {
                let (found, expected) = (text.split(',').count(), columns.len());
                if found != expected {
                    return Err(BagError::FieldCount { file: file.into(), line, expected, found });
                }
                all.push_str(text);
                rows.push(Row { line, end: all.len() });
                Ok(())
            }
        })?;
        match columns {
            Some(columns) if !rows.is_empty() => Ok(Self { file: file.into(), columns, text: all, rows, is_euroc }),
            _ => Err(BagError::NoRows { file: file.into() }),
        }
    }

    /// Whether it is a EuRoC track, whose columns are `t` in nanoseconds, [`POSE_COLUMNS`], and others by their own names.
    pub fn is_euroc(&self) -> bool {
        self.is_euroc
    }

    /// When each pose of a EuRoC track held, in nanoseconds since the epoch; `None` of any other table.
    ///
    /// # Errors
    /// Where a stamp is not a whole number.
    pub fn stamps_ns(&self) -> Result<Option<Vec<i64>>, BagError> {
        if !self.is_euroc {
            return Ok(None);
        }
        let index = self.index_of(EUROC[0].1)?;
        let stamp = |row: usize| {
            let text = fields(self.row_text(row)).nth(index).unwrap_or_default();
            let (file, line) = (self.file.clone(), self.rows[row].line);
            let stamp = || text.chars().take(40).collect();
            text.parse().map_err(|error: ParseIntError| match error.kind() {
                IntErrorKind::PosOverflow | IntErrorKind::NegOverflow => {
                    BagError::StampRange { file, line, stamp: stamp() }
                }
                _ => BagError::NotANumber { file, line, column: EUROC[0].1.into(), text: stamp() },
            })
        };
        (0..self.len()).map(stamp).collect::<Result<_, _>>().map(Some)
    }

    /// What the table is called in errors.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Names of the columns, in the order of the file.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Whether there is a column of that name.
    pub fn has_column(&self, name: &str) -> bool {
        self.columns.iter().any(|column| column == name)
    }

    /// Rows of data.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Never: a table without rows is refused.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The text of a row, counted from 0, as it stands in the file.
    pub fn row_text(&self, row: usize) -> &str {
        let start = if row == 0 { 0 } else { self.rows[row - 1].end };
        self.text[start..self.rows[row].end].trim_end()
    }

    /// Line of the file, from 1, on which each row stands.
    pub fn line_numbers(&self) -> impl Iterator<Item = usize> {
        self.rows.iter().map(|row| row.line)
    }

    /// The named columns, row by row, in the order of `names`; every number is finite.
    ///
    /// # Errors
    /// Where a column is missing or a field is not a finite number.
    pub fn select(&self, names: &[&str]) -> Result<Vec<Vec<f64>>, BagError> {
        self.read_rows(names, <[f64]>::to_vec)
    }

    /// As [`Table::select`], for a number of columns known beforehand.
    ///
    /// # Errors
    /// As [`Table::select`].
    pub fn select_array<const N: usize>(&self, names: [&str; N]) -> Result<Vec<[f64; N]>, BagError> {
        self.read_rows(&names, |row| std::array::from_fn(|i| row[i]))
    }

    fn read_rows<R>(&self, names: &[&str], make: impl Fn(&[f64]) -> R) -> Result<Vec<R>, BagError> {
        let indices = names.iter().map(|name| self.index_of(name)).collect::<Result<Vec<_>, _>>()?;
        let (mut texts, mut numbers) = (Vec::with_capacity(self.columns.len()), vec![0.0; names.len()]);
        let mut start = 0;
        let read_row = |row: &Row| {
            texts.clear();
            texts.extend(fields(&self.text[std::mem::replace(&mut start, row.end)..row.end]));
            for ((number, &index), name) in numbers.iter_mut().zip(&indices).zip(names) {
                *number = finite(texts[index], &self.file, row.line, name)?;
            }
            Ok(make(&numbers))
        };
        self.rows.iter().map(read_row).collect()
    }

    /// The poses in the columns [`POSE_COLUMNS`].
    ///
    /// # Errors
    /// As [`Table::select`], and where a quaternion is no rotation.
    pub fn poses(&self) -> Result<Vec<Pose>, BagError> {
        let pose = |(values, row): ([f64; 7], &Row)| {
            let invalid = |reason| BagError::InvalidPoseInLine { file: self.file.clone(), line: row.line, reason };
            pose_from_row(&values).map_err(invalid)
        };
        self.select_array(POSE_COLUMNS)?.into_iter().zip(&self.rows).map(pose).collect()
    }

    fn index_of(&self, name: &str) -> Result<usize, BagError> {
        self.columns.iter().position(|column| column == name).ok_or_else(|| BagError::MissingColumn {
            file: self.file.clone(),
            column: name.into(),
            present: self.columns.join(", "),
        })
    }
}

/// The pose in seven numbers in the order of [`POSE_COLUMNS`].
pub(crate) fn pose_from_row(row: &[f64]) -> Result<Pose, se3_geom::InvalidPose> {
    pose_from_xyzw([row[0], row[1], row[2]], [row[3], row[4], row[5], row[6]])
}

/// The seven numbers of a pose in the order of [`POSE_COLUMNS`], each as the shortest text that reads back to the same double.
pub(crate) fn row_from_pose(pose: &Pose, separator: &str) -> String {
    let [qx, qy, qz, qw] = xyzw_from_rotation(&pose.rotation);
    let t = pose.translation;
    [t.x, t.y, t.z, qx, qy, qz, qw].map(|value| value.to_string()).join(separator)
}

fn fields(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(|field| field.trim().trim_matches('"'))
}

/// The columns of EuRoC that have a name here. Its header is a comment, and its quaternions have w first.
const EUROC: [(&str, &str); 8] = [
    ("timestamp", "t"),
    ("p_RS_R_x", "x"),
    ("p_RS_R_y", "y"),
    ("p_RS_R_z", "z"),
    ("q_RS_x", "qx"),
    ("q_RS_y", "qy"),
    ("q_RS_z", "qz"),
    ("q_RS_w", "qw"),
];

/// The columns that a comment names, where it is the header of a EuRoC track.
fn euroc_columns(comment: &str) -> Option<Vec<String>> {
    // Units stand behind the names, in brackets.
    let bare = |field: &str| field.split('[').next().unwrap_or_default().trim().to_owned();
    let named: Vec<String> = fields(comment.trim_start_matches('#')).map(bare).collect();
    let known = |name: &String| EUROC.iter().find(|(theirs, _)| theirs == name).map(|(_, ours)| (*ours).to_owned());
    let has_all = EUROC.iter().all(|(theirs, _)| named.iter().filter(|name| name == theirs).count() == 1);
    has_all.then(|| named.iter().map(|name| known(name).unwrap_or_else(|| name.clone())).collect())
}

fn parse_header(file: &str, line: usize, text: &str) -> Result<Vec<String>, BagError> {
    let columns: Vec<String> = fields(text).map(str::to_owned).collect();
    if columns.iter().all(|column| column.parse::<f64>().is_ok()) {
        return Err(BagError::NoHeader { file: file.into(), line });
    }
    for (i, column) in columns.iter().enumerate() {
        if columns[..i].contains(column) {
            return Err(BagError::DuplicateColumn { file: file.into(), line, column: column.clone() });
        }
    }
    Ok(columns)
}

/// Writes poses as CSV with the header [`POSE_COLUMNS`]; an existing file is replaced as a whole.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_csv(path: impl AsRef<Path>, poses: &[Pose]) -> Result<(), BagError> {
    write_text(path.as_ref(), |out| {
        writeln!(out, "{}", POSE_COLUMNS.join(","))?;
        poses.iter().try_for_each(|pose| writeln!(out, "{}", row_from_pose(pose, ",")))
    })
}
