//! Lines of a text file that carry data, with their numbers.

use std::io::{BufRead, Read};

use crate::BagError;

/// No row of numbers is longer; a file that has such a line is something else, and is not read into memory.
const MAX_LINE_BYTES: usize = 1 << 20;

/// Calls `visit` with number (from 1) and text of every line that is neither blank nor a `#` comment.
pub(crate) fn for_each_line(
    reader: impl BufRead,
    file: &str,
    mut visit: impl FnMut(usize, &str) -> Result<(), BagError>,
) -> Result<(), BagError> {
    for_each_line_and_comment(reader, file, |line, text| if text.starts_with('#') { Ok(()) } else { visit(line, text) })
}

/// As [`for_each_line`], comments too.
pub(crate) fn for_each_line_and_comment(
    mut reader: impl BufRead,
    file: &str,
    mut visit: impl FnMut(usize, &str) -> Result<(), BagError>,
) -> Result<(), BagError> {
    let mut bytes = Vec::new();
    for line in 1.. {
        bytes.clear();
        let read = reader.by_ref().take(MAX_LINE_BYTES as u64 + 1).read_until(b'\n', &mut bytes);
        if read.map_err(BagError::io(file))? == 0 {
            break;
        }
        if bytes.len() > MAX_LINE_BYTES {
            return Err(BagError::LineTooLong { file: file.into(), line, limit: MAX_LINE_BYTES });
        }
        let text = str::from_utf8(&bytes).map_err(|_| BagError::NotText { file: file.into(), line })?;
        let text = text.trim_start_matches('\u{feff}').trim();
        if !text.is_empty() {
            visit(line, text)?;
        }
    }
    Ok(())
}

/// The number in a field.
pub(crate) fn finite(text: &str, file: &str, line: usize, column: &str) -> Result<f64, BagError> {
    let value: f64 = text.parse().map_err(|_| BagError::NotANumber {
        file: file.into(),
        line,
        column: column.into(),
        text: text.chars().take(40).collect(),
    })?;
    if !value.is_finite() {
        return Err(BagError::NotFinite { file: file.into(), line, column: column.into(), value });
    }
    Ok(value)
}
