//! What the Python package `reorder` is made of: arrays in, arrays out, and the interpreter released meanwhile.
//!
//! Everything here is private to the package, whose Python files give it names, types and documentation for users.

mod arrays;
mod bags;
mod choice;
mod error;
mod fleet;
mod manifold;
mod order;
mod plan;
mod rowwise;
mod space;
mod spline;

use pyo3::pymodule;

#[pymodule]
mod _reorder {
    #[pymodule_export]
    use crate::bags::{read_poses, write_poses};
    #[pymodule_export]
    use crate::error::{BagError, GeometryError, OrderError, Refusal, ReorderError, SplineError};
    #[pymodule_export]
    use crate::fleet::{bag_outputs, check_task, find_bags, remove_abandoned, replay_bag, replay_table};
    #[pymodule_export]
    use crate::manifold::Manifold;
    #[pymodule_export]
    use crate::order::order;
    #[pymodule_export]
    use crate::plan::{Trajectory, plan};
    #[pymodule_export]
    use crate::spline::PoseSpline;
}
