//! The operations of a manifold and of a group on rows of arrays, with the interpreter released.

use bag_replay::planner::se3_geom::LieGroup;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{Rows, array, together};
use crate::error::{GeometryError, raised};
use crate::space::{Grouped, Space};

type Numbers<'py> = Bound<'py, PyAny>;
type Result<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

fn points_of<'py, S: Space>(_: S, name: &str, given: &Numbers<'py>) -> PyResult<Rows<'py>> {
    Rows::of(name, given, S::POINT, S::LAYOUT)
}

fn tangents_of<'py, S: Space>(_: S, name: &str, given: &Numbers<'py>) -> PyResult<Rows<'py>> {
    Rows::of(name, given, S::TANGENT, S::TANGENT_LAYOUT)
}

/// `work` on row after row of `a` and `b`, with the interpreter released; it appends `width` numbers each time.
fn each<'py>(
    py: Python<'py>,
    (a, b): ((&str, Rows<'py>), (&str, Rows<'py>)),
    width: Option<usize>,
    work: impl Fn(&[f64], &[f64], &mut Vec<f64>) -> std::result::Result<(), String> + Sync,
) -> Result<'py> {
    let lead = together((a.0, &a.1), (b.0, &b.1))?;
    let (of_a, of_b, widths) = (a.1.numbers()?, b.1.numbers()?, [a.1.width, b.1.width]);
    let is_one = [a.1.lead.is_empty(), b.1.lead.is_empty()];
    let count: usize = lead.iter().product();
    let numbers: std::result::Result<_, String> = py.detach(|| {
        let row = |k: usize, which: usize| {
            let from = if is_one[which] { 0 } else { k * widths[which] };
            from..from + widths[which]
        };
        let mut numbers = Vec::with_capacity(count * width.unwrap_or(1));
        for k in 0..count {
            work(&of_a[row(k, 0)], &of_b[row(k, 1)], &mut numbers).map_err(|why| format!("row {k}: {why}"))?;
        }
        Ok(numbers)
    });
    array(py, numbers.map_err(raised::<GeometryError>)?, &lead, width)
}

pub(crate) fn exp<'py, S: Space>(py: Python<'py>, space: S, p: &Numbers<'py>, v: &Numbers<'py>) -> Result<'py> {
    let (p, v) = (points_of(space, "p", p)?, tangents_of(space, "v", v)?);
    each(py, (("p", p), ("v", v)), Some(S::POINT), |p, v, out| {
        S::put(&space.exp(&S::point(p)?, S::tangent(v)), out);
        Ok(())
    })
}

pub(crate) fn log<'py, S: Space>(py: Python<'py>, space: S, p: &Numbers<'py>, q: &Numbers<'py>) -> Result<'py> {
    let (p, q) = (points_of(space, "p", p)?, points_of(space, "q", q)?);
    each(py, (("p", p), ("q", q)), Some(S::TANGENT), |p, q, out| {
        let tangent = space.log(&S::point(p)?, &S::point(q)?).map_err(|error| error.to_string())?;
        S::put_tangent(&tangent, out);
        Ok(())
    })
}

pub(crate) fn distance<'py, S: Space>(py: Python<'py>, space: S, p: &Numbers<'py>, q: &Numbers<'py>) -> Result<'py> {
    let (p, q) = (points_of(space, "p", p)?, points_of(space, "q", q)?);
    each(py, (("p", p), ("q", q)), None, |p, q, out| {
        out.push(space.distance(&S::point(p)?, &S::point(q)?));
        Ok(())
    })
}

pub(crate) fn norm<'py, S: Space>(py: Python<'py>, space: S, p: &Numbers<'py>, v: &Numbers<'py>) -> Result<'py> {
    let (p, v) = (points_of(space, "p", p)?, tangents_of(space, "v", v)?);
    each(py, (("p", p), ("v", v)), None, |p, v, out| {
        out.push(space.norm(&S::point(p)?, S::tangent(v)));
        Ok(())
    })
}

/// For one pair of points any number of places between them, for several pairs one each or the same.
pub(crate) fn geodesic<'py, S: Space>(
    py: Python<'py>,
    space: S,
    (p, q): (&Numbers<'py>, &Numbers<'py>),
    t: &Numbers<'py>,
) -> Result<'py> {
    let tangents = log(py, space, p, q)?.into_any();
    let (tangents, t) = (tangents_of(space, "p and q", &tangents)?, Rows::of_numbers("t", t)?);
    let scaled = each(py, (("p and q", tangents), ("t", t)), Some(S::TANGENT), |v, t, out| {
        out.extend(v.iter().map(|x| x * t[0]));
        Ok(())
    })?;
    exp(py, space, p, scaled.as_any())
}

pub(crate) fn compose<'py, S: Grouped>(py: Python<'py>, space: S, a: &Numbers<'py>, b: &Numbers<'py>) -> Result<'py> {
    let (a, b) = (points_of(space, "a", a)?, points_of(space, "b", b)?);
    each(py, (("a", a), ("b", b)), Some(S::POINT), |a, b, out| {
        S::put(&S::Group::compose(&S::point(a)?, &S::point(b)?), out);
        Ok(())
    })
}

pub(crate) fn inverse<'py, S: Grouped>(py: Python<'py>, space: S, a: &Numbers<'py>) -> Result<'py> {
    each_one(py, ("a", points_of(space, "a", a)?), S::POINT, |a, out| {
        S::put(&S::Group::inverse(&S::point(a)?), out);
        Ok(())
    })
}

pub(crate) fn group_exp<'py, S: Grouped>(py: Python<'py>, space: S, v: &Numbers<'py>) -> Result<'py> {
    each_one(py, ("v", tangents_of(space, "v", v)?), S::POINT, |v, out| {
        S::put(&S::Group::exp(S::tangent(v)), out);
        Ok(())
    })
}

pub(crate) fn group_log<'py, S: Grouped>(py: Python<'py>, space: S, a: &Numbers<'py>) -> Result<'py> {
    each_one(py, ("a", points_of(space, "a", a)?), S::TANGENT, |a, out| {
        let tangent = S::Group::log(&S::point(a)?).map_err(|error| error.to_string())?;
        S::put_tangent(&tangent, out);
        Ok(())
    })
}

/// [`each`] of one array.
fn each_one<'py>(
    py: Python<'py>,
    (name, a): (&str, Rows<'py>),
    width: usize,
    work: impl Fn(&[f64], &mut Vec<f64>) -> std::result::Result<(), String> + Sync,
) -> Result<'py> {
    let none = Rows::of_numbers("", PyArrayDyn::<f64>::zeros(py, Vec::<usize>::new(), false).as_any())?;
    each(py, ((name, a), ("", none)), Some(width), |a, _, out| work(a, out))
}
