"""Manifolds by name, and the arrays that stand for their points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._reorder import Manifold

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def Rn(n: int) -> Manifold:
    """Flat space of 1 to 8 dimensions. Points and tangents: ``(…, n)``.

    >>> Rn(3).distance([1.0, 0.0, 0.0], [1.0, 3.0, 4.0])
    array(5.)
    """
    return Manifold(f"r{n}")


def S2() -> Manifold:
    """Directions. Points: unit vectors ``(…, 3)``; tangents ``(…, 3)``, orthogonal to them, in rad; distances are angles in rad.

    >>> S2().distance([0.0, 0.0, 1.0], [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])
    array([1.57079633, 3.14159265])
    """
    return Manifold("s2")


def SO3() -> Manifold:
    """Rotations. Points: quaternions ``x, y, z, w``, ``(…, 4)``, or scipy's ``Rotation``, which ``exp`` then returns too; tangents: body rates
    ``(…, 3)`` in rad; distances are angles in rad.

    >>> SO3().distance([0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0])
    array(3.14159265)
    """
    return Manifold("so3")


def SE2(metres_per_radian: float = 1.0) -> Manifold:
    """Poses in the plane, a radian counting as so many metres. Points ``x, y, theta``, ``(…, 3)``; tangents: body twists ``vx, vy, omega``.

    >>> SE2(metres_per_radian=2.0).distance([0.0, 0.0, 0.0], [3.0, 0.0, 2.0])
    array(5.)
    """
    return Manifold("se2", metres_per_radian)


def SE3(metres_per_radian: float = 1.0) -> Manifold:
    """Poses, a radian counting as so many metres. Points ``x, y, z, qx, qy, qz, qw``, ``(…, 7)``; tangents: body twists
    ``vx, vy, vz, wx, wy, wz``, ``(…, 6)``. Geodesics are slerp and a straight line; screws are ``group_exp``'s.

    >>> SE3().distance([0, 0, 0, 0, 0, 0, 1], [[0, 0, 0.5, 0, 0, 0, 1], [0, 0, 0, 1, 0, 0, 0]])
    array([0.5       , 3.14159265])
    """
    return Manifold("se3", metres_per_radian)


def Sim2(metres_per_radian: float = 1.0) -> Manifold:
    """Poses in the plane with a scale, whose logarithm counts as an angle does. Points ``x, y, theta, scale``, ``(…, 4)``; tangents
    ``vx, vy, omega, sigma``.

    >>> round(float(Sim2().distance([0, 0, 0, 1], [0, 0, 0, np.e])), 12)
    1.0
    """
    return Manifold("sim2", metres_per_radian)


def directions(lat_lon_deg: ArrayLike) -> NDArray[np.float64]:
    """Unit vectors ``(…, 3)`` of latitudes and longitudes ``(…, 2)`` in degrees; longitudes may go round more than once.

    >>> directions([[0.0, 90.0], [90.0, 0.0]]).round(12)
    array([[0., 1., 0.],
           [0., 0., 1.]])
    """
    lat, lon = np.moveaxis(np.radians(np.asarray(lat_lon_deg, dtype=float)), -1, 0)
    return np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)


def poses(positions: ArrayLike, rotations: Any) -> NDArray[np.float64]:
    """Poses ``(…, 7)`` of positions ``(…, 3)`` in m and rotations: scipy's ``Rotation``, or quaternions ``x, y, z, w``, ``(…, 4)``. One row of
    either goes with all of the other.

    >>> poses([[0.1, 0.2, 0.3], [0.1, 0.2, 0.4]], [0, 0, 0, 1])
    array([[0.1, 0.2, 0.3, 0. , 0. , 0. , 1. ],
           [0.1, 0.2, 0.4, 0. , 0. , 0. , 1. ]])
    """
    quaternions = rotations.as_quat() if hasattr(rotations, "as_quat") else rotations
    p, q = np.asarray(positions, dtype=float), np.asarray(quaternions, dtype=float)
    lead = np.broadcast_shapes(p.shape[:-1], q.shape[:-1])
    return np.concatenate([np.broadcast_to(p, (*lead, 3)), np.broadcast_to(q, (*lead, 4))], axis=-1)


def rotations(poses: ArrayLike) -> Any:
    """scipy's ``Rotation`` of poses ``(n, 7)`` or of one pose ``(7,)``; scipy must be there."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(np.asarray(poses, dtype=float)[..., 3:])
