//! Manifolds: exponential, logarithm and distance of many points at once.

use bag_replay::planner::reorder::Weighted;
use bag_replay::planner::se3_geom::{Euclidean, Manifold as _, Se2, Se3, Sim2, So3, Sphere};
use numpy::PyArrayDyn;
use pyo3::intern;
use pyo3::prelude::*;

use crate::error::{ReorderError, raised};
use crate::rowwise;
use crate::space::{Chosen, Space, on_group, on_space};

type Numbers<'py> = Bound<'py, PyAny>;
/// What makes a manifold again, and from what.
type Reduced<'py> = (Bound<'py, PyAny>, (&'static str, Option<f64>));
type Result<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

/// A Riemannian manifold with its metric. Its points and tangents are rows of arrays; see ``Rn``, ``S2``, ``SO3``, ``SE2``, ``SE3``, ``Sim2``.
///
/// Two arrays go together row by row, or one of them is a single row for all of the other.
#[pyclass(frozen, eq, from_py_object, module = "reorder")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Manifold {
    pub(crate) space: Chosen,
    /// Metres that count as much as one radian, where that is part of the metric.
    pub(crate) metres_per_radian: Option<f64>,
}

#[pymethods]
impl Manifold {
    /// By its name: r1 … r8, s2, so3, se2, se3, sim2.
    #[new]
    #[pyo3(signature = (name, metres_per_radian = None))]
    fn new(name: &str, metres_per_radian: Option<f64>) -> PyResult<Self> {
        let flat = |space| (space, None);
        let (space, length) = match name {
            "r1" => flat(Chosen::R1(Euclidean)),
            "r2" => flat(Chosen::R2(Euclidean)),
            "r3" => flat(Chosen::R3(Euclidean)),
            "r4" => flat(Chosen::R4(Euclidean)),
            "r5" => flat(Chosen::R5(Euclidean)),
            "r6" => flat(Chosen::R6(Euclidean)),
            "r7" => flat(Chosen::R7(Euclidean)),
            "r8" => flat(Chosen::R8(Euclidean)),
            "s2" => flat(Chosen::S2(Sphere)),
            "so3" => flat(Chosen::So3(So3)),
            "se2" => weighted::<Se2>(Chosen::Se2, metres_per_radian)?,
            "se3" => weighted::<Se3>(Chosen::Se3, metres_per_radian)?,
            "sim2" => weighted::<Sim2>(Chosen::Sim2, metres_per_radian)?,
            _ => {
                let known = "r1 to r8, s2, so3, se2, se3 and sim2";
                return Err(raised::<ReorderError>(format!("there is no manifold {name:?}, only {known}")));
            }
        };
        if length.is_none() && metres_per_radian.is_some() {
            return Err(raised::<ReorderError>(format!(
                "metres_per_radian weighs rotations against translations, and {name} does not have both"
            )));
        }
        Ok(Self { space, metres_per_radian: length })
    }

    /// r1 to r8, s2, so3, se2, se3 or sim2.
    #[getter]
    fn name(&self) -> &'static str {
        match self.space {
            Chosen::R1(_) => "r1",
            Chosen::R2(_) => "r2",
            Chosen::R3(_) => "r3",
            Chosen::R4(_) => "r4",
            Chosen::R5(_) => "r5",
            Chosen::R6(_) => "r6",
            Chosen::R7(_) => "r7",
            Chosen::R8(_) => "r8",
            Chosen::S2(_) => "s2",
            Chosen::So3(_) => "so3",
            Chosen::Se2(_) => "se2",
            Chosen::Se3(_) => "se3",
            Chosen::Sim2(_) => "sim2",
        }
    }

    /// How many metres count as much as one radian; None where nothing is weighed.
    #[getter]
    fn metres_per_radian(&self) -> Option<f64> {
        self.metres_per_radian
    }

    /// How many numbers a point has.
    #[getter]
    fn point_size(&self) -> usize {
        on_space!(self.space, space => point_size(space))
    }

    /// How many numbers a tangent vector has.
    #[getter]
    fn tangent_size(&self) -> usize {
        on_space!(self.space, space => tangent_size(space))
    }

    /// Radius within which geodesics are unique.
    #[getter]
    fn injectivity_radius(&self) -> f64 {
        on_space!(self.space, space => space.injectivity_radius())
    }

    /// The points, shape (…, point_size), reached from p along v in unit time; a scipy Rotation where p is one.
    fn exp<'py>(&self, py: Python<'py>, p: Numbers<'py>, v: Numbers<'py>) -> PyResult<Bound<'py, PyAny>> {
        let moved = on_space!(self.space, space => rowwise::exp(py, space, &p, &v))?;
        as_given(&p, moved)
    }

    /// The initial velocities, shape (…, tangent_size), of the shortest geodesics from p to q.
    ///
    /// :raises GeometryError: where a point is none, or a geodesic is not unique; the sentence names the row.
    fn log<'py>(&self, py: Python<'py>, p: Numbers<'py>, q: Numbers<'py>) -> Result<'py> {
        on_space!(self.space, space => rowwise::log(py, space, &p, &q))
    }

    /// Geodesic distances, shape (…).
    fn distance<'py>(&self, py: Python<'py>, p: Numbers<'py>, q: Numbers<'py>) -> Result<'py> {
        on_space!(self.space, space => rowwise::distance(py, space, &p, &q))
    }

    /// Lengths of tangent vectors at p, shape (…).
    fn norm<'py>(&self, py: Python<'py>, p: Numbers<'py>, v: Numbers<'py>) -> Result<'py> {
        on_space!(self.space, space => rowwise::norm(py, space, &p, &v))
    }

    /// The points at fractions t of the shortest geodesics from p (t = 0) to q (t = 1).
    fn geodesic<'py>(
        &self,
        py: Python<'py>,
        p: Numbers<'py>,
        q: Numbers<'py>,
        t: Numbers<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let between = on_space!(self.space, space => rowwise::geodesic(py, space, (&p, &q), &t))?;
        as_given(&p, between)
    }

    /// Products ab; on so3, se2, se3 and sim2.
    fn compose<'py>(&self, py: Python<'py>, a: Numbers<'py>, b: Numbers<'py>) -> PyResult<Bound<'py, PyAny>> {
        let product = on_group!(self.space, space => rowwise::compose(py, space, &a, &b), else Err(self.no_group()))?;
        as_given(&a, product)
    }

    /// Inverses; on so3, se2, se3 and sim2.
    fn inverse<'py>(&self, py: Python<'py>, a: Numbers<'py>) -> PyResult<Bound<'py, PyAny>> {
        let inverse = on_group!(self.space, space => rowwise::inverse(py, space, &a), else Err(self.no_group()))?;
        as_given(&a, inverse)
    }

    /// The group exponential: screws on se3, arcs on se2, spirals on sim2.
    fn group_exp<'py>(&self, py: Python<'py>, v: Numbers<'py>) -> Result<'py> {
        on_group!(self.space, space => rowwise::group_exp(py, space, &v), else Err(self.no_group()))
    }

    /// Its principal logarithm.
    fn group_log<'py>(&self, py: Python<'py>, a: Numbers<'py>) -> Result<'py> {
        on_group!(self.space, space => rowwise::group_log(py, space, &a), else Err(self.no_group()))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        Ok((py.get_type::<Self>().into_any(), (self.name(), self.metres_per_radian)))
    }

    fn __repr__(&self) -> String {
        match self.metres_per_radian {
            Some(length) => format!("Manifold({:?}, metres_per_radian={length:?})", self.name()),
            None => format!("Manifold({:?})", self.name()),
        }
    }
}

impl Manifold {
    fn no_group(&self) -> PyErr {
        raised::<ReorderError>(format!("{} is used as no group here: so3, se2, se3 and sim2 are", self.name()))
    }
}

/// The space with that weight, 1 m where none is given.
fn weighted<M: Weighted>(chosen: fn(M) -> Chosen, length_m: Option<f64>) -> PyResult<(Chosen, Option<f64>)> {
    let length_m = length_m.unwrap_or(1.0);
    let metric = M::with_metres_per_radian(length_m);
    let metric = metric.ok_or_else(|| {
        raised::<ReorderError>(format!("metres_per_radian is {length_m}, but must be a positive finite number"))
    })?;
    Ok((chosen(metric), Some(length_m)))
}

fn point_size<S: Space>(_: S) -> usize {
    S::POINT
}

fn tangent_size<S: Space>(_: S) -> usize {
    S::TANGENT
}

/// Points in the form in which points were given: as scipy's `Rotation` where it was one.
fn as_given<'py>(given: &Numbers<'py>, points: Bound<'py, PyArrayDyn<f64>>) -> PyResult<Bound<'py, PyAny>> {
    let py = given.py();
    if given.hasattr(intern!(py, "as_quat"))? {
        return given.get_type().call_method1(intern!(py, "from_quat"), (points,));
    }
    Ok(points.into_any())
}
