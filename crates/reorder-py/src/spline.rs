//! The C² spline through poses, evaluated at many times at once.

use bag_replay::planner::se3_geom::{Ends, Motion, Pose, PoseSpline as Curve, Se3, Twist, centripetal_knots};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{Rows, array};
use crate::error::{ReorderError, SplineError, raised};
use crate::space::{Space, points};

type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

const TWIST: usize = 6;
const TWIST_LAYOUT: &str = "vx, vy, vz, wx, wy, wz";

/// A C2 curve through every one of its poses: midpoint-chart cubics of rotations, the cubic spline of positions.
///
/// Twists, accelerations and jerks are in the body (tool) frame, ``vx, vy, vz, wx, wy, wz`` per unit of the parameter: the linear parts are the
/// derivatives of the position turned into the tool frame. Beyond its domain an open curve stays at its end, with the derivatives it has
/// there; a closed one goes round again. Increasing times are the quickest.
#[pyclass(frozen, module = "reorder")]
pub(crate) struct PoseSpline {
    pub(crate) curve: Curve,
}

#[pymethods]
impl PoseSpline {
    /// The spline that passes ``poses``, shape (n, 7), at ``times``, shape (n,).
    ///
    /// Without times the knots are centripetal in the metric where a radian counts as so many metres. Ends: ``"natural"`` (no acceleration),
    /// ``"periodic"`` (closed; one more time says when the first pose is reached again), or a pair of twists, shape (6,).
    ///
    /// :raises SplineError: where there is no such curve; the sentence names the poses.
    #[staticmethod]
    #[pyo3(signature = (poses, times = None, *, ends = None, metres_per_radian = 1.0))]
    fn fit<'py>(
        py: Python<'py>,
        poses: Bound<'py, PyAny>,
        times: Option<Bound<'py, PyAny>>,
        ends: Option<Bound<'py, PyAny>>,
        metres_per_radian: f64,
    ) -> PyResult<Self> {
        let rows = Rows::of("poses", &poses, Se3::POINT, Se3::LAYOUT)?.listed("poses")?;
        let times = times.map(|times| Rows::of_numbers("times", &times)).transpose()?;
        let ends = ends.map_or(Ok(Ends::Natural), |ends| ends_of(&ends))?;
        let Some(metric) = Se3::with_metres_per_radian(metres_per_radian) else {
            return Err(raised::<ReorderError>(format!(
                "metres_per_radian is {metres_per_radian}, but must be a positive finite number"
            )));
        };
        let (numbers, times) = (rows.numbers()?, times.as_ref().map(Rows::numbers).transpose()?);
        py.detach(|| fit(metric, numbers, times, ends)).map(|curve| Self { curve }).map_err(raised::<SplineError>)
    }

    /// The parameter at every pose.
    #[getter]
    fn knots<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let knots = self.curve.knots().to_vec();
        let count = knots.len();
        array(py, knots, &[count], None)
    }

    /// First and last parameter.
    #[getter]
    fn domain(&self) -> (f64, f64) {
        self.curve.domain()
    }

    /// Whether the curve ends where it began.
    #[getter]
    fn is_closed(&self) -> bool {
        self.curve.is_closed()
    }

    /// Poses, shape (…, 7), at parameters t, shape (…).
    fn pose<'py>(&self, py: Python<'py>, t: Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let [poses] = self.sampled(py, &t, [Part::Pose])?;
        Ok(poses)
    }

    /// First derivatives, shape (…, 6).
    fn twist<'py>(&self, py: Python<'py>, t: Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let [twists] = self.sampled(py, &t, [Part::Twist])?;
        Ok(twists)
    }

    /// Second derivatives, shape (…, 6).
    fn acceleration<'py>(&self, py: Python<'py>, t: Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let [accelerations] = self.sampled(py, &t, [Part::Acceleration])?;
        Ok(accelerations)
    }

    /// Third derivatives, shape (…, 6); they jump at the knots.
    fn jerk<'py>(&self, py: Python<'py>, t: Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let [jerks] = self.sampled(py, &t, [Part::Jerk])?;
        Ok(jerks)
    }

    /// Poses, twists and accelerations in one go.
    fn at<'py>(&self, py: Python<'py>, t: Bound<'py, PyAny>) -> PyResult<(Array<'py>, Array<'py>, Array<'py>)> {
        let [poses, twists, accelerations] = self.sampled(py, &t, [Part::Pose, Part::Twist, Part::Acceleration])?;
        Ok((poses, twists, accelerations))
    }

    fn __repr__(&self) -> String {
        let (first, last) = self.curve.domain();
        let kind = if self.curve.is_closed() { "closed" } else { "open" };
        format!("<PoseSpline: {kind}, {} knots from {first} to {last}>", self.curve.knots().len())
    }
}

/// What of a motion is asked for.
#[derive(Clone, Copy)]
enum Part {
    Pose,
    Twist,
    Acceleration,
    Jerk,
}

impl Part {
    fn width(self) -> usize {
        if matches!(self, Self::Pose) { Se3::POINT } else { TWIST }
    }

    fn put(self, motion: &Motion, numbers: &mut Vec<f64>) {
        match self {
            Self::Pose => Se3::put(&motion.pose, numbers),
            Self::Twist => Se3::put_tangent(&motion.twist, numbers),
            Self::Acceleration => Se3::put_tangent(&motion.acceleration, numbers),
            Self::Jerk => Se3::put_tangent(&motion.jerk, numbers),
        }
    }
}

impl PoseSpline {
    fn sampled<'py, const N: usize>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        parts: [Part; N],
    ) -> PyResult<[Array<'py>; N]> {
        let times = Rows::of_numbers("t", t)?;
        let numbers = times.numbers()?;
        let sampled = py.detach(|| {
            if let Some(place) = numbers.iter().position(|t| !t.is_finite()) {
                return Err(format!("t holds {} at place {place}, which is no time", numbers[place]));
            }
            let mut sampled = parts.map(|part| Vec::with_capacity(numbers.len() * part.width()));
            for motion in self.curve.along(numbers.iter().copied()) {
                parts.iter().zip(&mut sampled).for_each(|(part, sampled)| part.put(&motion, sampled));
            }
            Ok(sampled)
        });
        let sampled = sampled.map_err(raised::<ReorderError>)?;
        let mut arrays = Vec::with_capacity(N);
        for (part, numbers) in parts.iter().zip(sampled) {
            arrays.push(array(py, numbers, &times.lead, Some(part.width()))?);
        }
        arrays.try_into().map_err(|_| raised::<ReorderError>("not as many arrays as were asked for"))
    }
}

/// Natural, periodic, or the two twists of clamped ends.
fn ends_of(given: &Bound<'_, PyAny>) -> PyResult<Ends> {
    if let Ok(word) = given.extract::<String>() {
        return match word.as_str() {
            "natural" => Ok(Ends::Natural),
            "periodic" => Ok(Ends::Periodic),
            _ => Err(raised::<ReorderError>(format!(
                "ends: {word:?} is neither \"natural\" nor \"periodic\", nor a pair of twists"
            ))),
        };
    }
    let (start, end): (Bound<'_, PyAny>, Bound<'_, PyAny>) = given.extract()?;
    let twist = |name: &str, given: &Bound<'_, PyAny>| -> PyResult<Twist> {
        Ok(Se3::tangent(Rows::of(name, given, TWIST, TWIST_LAYOUT)?.single(name)?.numbers()?))
    };
    Ok(Ends::Clamped { start: twist("the first of ends", &start)?, end: twist("the second of ends", &end)? })
}

fn fit(metric: Se3, numbers: &[f64], times: Option<&[f64]>, ends: Ends) -> Result<Curve, String> {
    let poses = points(metric, numbers, "pose")?;
    let knots = match times {
        Some(times) => times.to_vec(),
        None if ends == Ends::Periodic => {
            let around: Vec<Pose> = poses.iter().chain(poses.first()).copied().collect();
            centripetal_knots(&metric, &around)
        }
        None => centripetal_knots(&metric, &poses),
    };
    Curve::through(&poses, &knots, ends).map_err(|error| error.to_string())
}
