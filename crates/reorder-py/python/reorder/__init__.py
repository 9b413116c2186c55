"""Poses in any order come in; an ordered, C2-interpolated trajectory that a manipulator can execute goes out, or a refusal that says why.

>>> import numpy as np, reorder
>>> t = np.array([0.6, 0.0, 1.2, 0.9, 2.1, 0.3, 1.5, 1.8, 2.7, 2.4])
>>> helix = np.column_stack([np.cos(t), np.sin(t), 0.3 * t])
>>> found = reorder.order(helix, "r3")
>>> found.order
array([1, 5, 0, 3, 2, 6, 7, 4, 9, 8])
>>> found.topology, found.verdict
('open', 'plausible')

Arrays are C-contiguous ``float64`` where nothing shall be copied; anything that numpy makes an array of will do. Leading axes are free:
``(…, 7)`` is any number of poses. Lengths are in m, angles in rad, times in s, quaternions ``x, y, z, w``. Poses are
``x, y, z, qx, qy, qz, qw``, ``world_from_tool``. scipy's ``Rotation`` may stand for quaternions, and its ``RigidTransform`` for poses;
scipy itself is not needed. Every call that takes long releases the interpreter to other threads.
"""

from __future__ import annotations

from ._bags import PoseSet, read_poses, write_poses
from ._manifolds import SE2, SE3, SO3, S2, Rn, Sim2, directions, poses, rotations
from ._order import order
from ._plan import Plan, plan
from ._reorder import (
    BagError,
    GeometryError,
    Manifold,
    OrderError,
    PoseSpline,
    Refusal,
    ReorderError,
    SplineError,
    Trajectory,
)
from ._results import Certificate, Doubt, EdgeFigures, Ordering, Part, Repaired

fit = PoseSpline.fit

__all__ = [
    "BagError",
    "Certificate",
    "Doubt",
    "EdgeFigures",
    "GeometryError",
    "Manifold",
    "OrderError",
    "Ordering",
    "Part",
    "Plan",
    "PoseSet",
    "PoseSpline",
    "Refusal",
    "Repaired",
    "ReorderError",
    "Rn",
    "S2",
    "SE2",
    "SE3",
    "SO3",
    "Sim2",
    "SplineError",
    "Trajectory",
    "directions",
    "fit",
    "order",
    "plan",
    "poses",
    "read_poses",
    "rotations",
    "write_poses",
]
