//! Errors of the libraries as Python exceptions, with the sentences that they have there.

use std::fmt::Display;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::{PyErr, PyTypeInfo};

create_exception!(
    reorder,
    ReorderError,
    PyValueError,
    "What this package refuses, in one sentence that names what and where."
);
create_exception!(
    reorder,
    GeometryError,
    ReorderError,
    "Numbers that are no point, or two points without a unique geodesic."
);
create_exception!(reorder, OrderError, ReorderError, "Points that no order exists for.");
create_exception!(reorder, SplineError, ReorderError, "Poses through which no spline was put.");
create_exception!(reorder, BagError, ReorderError, "A file that cannot be read or written.");
create_exception!(
    reorder,
    Refusal,
    ReorderError,
    "No trajectory exists under the limits, or the order is too uncertain to be executed."
);

/// The exception of type `E` with the error's own sentence.
pub(crate) fn raised<E: PyTypeInfo>(error: impl Display) -> PyErr {
    PyErr::new::<E, _>(error.to_string())
}
