//! Arrays of Python as rows of numbers, without a copy where they lie in memory as they are needed.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{ReorderError, raised};

/// Numbers of shape (…, width), row by row.
pub(crate) struct Rows<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
    /// The shape without the last axis.
    pub(crate) lead: Vec<usize>,
    pub(crate) width: usize,
}

impl<'py> Rows<'py> {
    /// The rows of an array, of what numpy makes an array of, or of scipy's `Rotation` and `RigidTransform`.
    pub(crate) fn of(name: &str, given: &Bound<'py, PyAny>, width: usize, layout: &str) -> PyResult<Self> {
        let array = contiguous(name, &as_numbers(given)?)?;
        match array.shape().split_last() {
            Some((&last, lead)) if last == width => {
                let lead = lead.to_vec();
                Ok(Self { array: array.try_readonly().map_err(PyErr::from)?, lead, width })
            }
            _ => {
                let shape = shape_of(array.shape());
                Err(raised::<ReorderError>(format!(
                    "{name} has shape {shape}, but its last axis must hold the {width} numbers {layout}"
                )))
            }
        }
    }

    /// Numbers of any shape, one a row.
    pub(crate) fn of_numbers(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = contiguous(name, given)?;
        let lead = array.shape().to_vec();
        Ok(Self { array: array.try_readonly().map_err(PyErr::from)?, lead, width: 1 })
    }

    /// All numbers, where they lie.
    pub(crate) fn numbers(&self) -> PyResult<&[f64]> {
        self.array.as_slice().map_err(PyErr::from)
    }

    /// Refuses all but a list of rows, shape (n, width).
    pub(crate) fn listed(self, name: &str) -> PyResult<Self> {
        if self.lead.len() == 1 {
            return Ok(self);
        }
        let shape = shape_of(self.array.shape());
        Err(raised::<ReorderError>(format!("{name} has shape {shape}, but (n, {}) is needed", self.width)))
    }

    /// Refuses all but a single row, shape (width,).
    pub(crate) fn single(self, name: &str) -> PyResult<Self> {
        if self.lead.is_empty() {
            return Ok(self);
        }
        let shape = shape_of(self.array.shape());
        Err(raised::<ReorderError>(format!("{name} has shape {shape}, but ({},) is needed", self.width)))
    }
}

/// The leading shape of two arrays that go together row by row, one of which may be a single row for all of the other.
pub(crate) fn together(a: (&str, &Rows<'_>), b: (&str, &Rows<'_>)) -> PyResult<Vec<usize>> {
    let ((of_a, a), (of_b, b)) = (a, b);
    match (a.lead.as_slice(), b.lead.as_slice()) {
        (lead, other) if lead == other => Ok(lead.to_vec()),
        ([], lead) | (lead, []) => Ok(lead.to_vec()),
        (lead, other) => {
            let [lead, other] = [lead, other].map(shape_of);
            Err(raised::<ReorderError>(format!(
                "{of_a} has {lead} rows and {of_b} has {other}: they must agree, or one of them be a single row"
            )))
        }
    }
}

/// A new array of that shape; the numbers are handed over, not copied.
pub(crate) fn array<'py>(
    py: Python<'py>,
    numbers: Vec<f64>,
    lead: &[usize],
    width: Option<usize>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let shape: Vec<usize> = lead.iter().copied().chain(width).collect();
    PyArray1::from_vec(py, numbers).reshape(shape)
}

/// Rows of an input as an array of int64.
pub(crate) fn indices<'py>(py: Python<'py>, rows: &[usize]) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_iter(py, rows.iter().map(|&row| row as i64))
}

/// scipy's rotations by their quaternions x, y, z, w, and rigid transforms as x, y, z, qx, qy, qz, qw; all else as it is. Nothing of scipy is imported.
fn as_numbers<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = given.py();
    if given.hasattr(intern!(py, "as_quat"))? {
        return given.call_method0(intern!(py, "as_quat"));
    }
    if given.hasattr(intern!(py, "as_components"))? {
        let (translation, rotation): (Bound<'py, PyAny>, Bound<'py, PyAny>) =
            given.call_method0(intern!(py, "as_components"))?.extract()?;
        let options = PyDict::new(py);
        options.set_item("axis", -1)?;
        return numpy(py)?.call_method("concatenate", ((translation, as_numbers(&rotation)?),), Some(&options));
    }
    Ok(given.clone())
}

/// The array itself where its numbers are 64 bit and lie row by row; else a copy.
fn contiguous<'py>(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    if let Ok(array) = given.cast::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
    {
        return Ok(array.clone());
    }
    let py = given.py();
    let options = PyDict::new(py);
    options.set_item("dtype", "float64")?;
    options.set_item("order", "C")?;
    // Not ascontiguousarray, which makes a row of a single number.
    let made = numpy(py)?.call_method("asarray", (given,), Some(&options));
    let made = made.map_err(|error| PyTypeError::new_err(format!("{name} is no array of numbers: {error}")))?;
    Ok(made.cast_into::<PyArrayDyn<f64>>()?)
}

fn numpy(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import(intern!(py, "numpy"))
}

fn shape_of(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        many => format!("({})", many.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}
