"""The compiled part of the package. What users need is named in ``reorder``."""

import pathlib
from os import PathLike
from typing import Any, Literal, Sequence, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Path = str | PathLike[str]

class ReorderError(ValueError):
    """What this package refuses, in one sentence that names what and where."""

class GeometryError(ReorderError):
    """Numbers that are no point, or two points without a unique geodesic."""

class OrderError(ReorderError):
    """Points that no order exists for."""

class SplineError(ReorderError):
    """Poses through which no spline was put."""

class BagError(ReorderError):
    """A file that cannot be read or written."""

class Refusal(ReorderError):
    """No trajectory exists under the limits, or the order is too uncertain to be executed."""

@final
class Manifold:
    """A Riemannian manifold with its metric. Its points and tangents are rows of arrays; see ``Rn``, ``S2``, ``SO3``, ``SE2``, ``SE3``, ``Sim2``.

    Two arrays go together row by row, or one of them is a single row for all of the other.
    """

    def __new__(cls, name: str, metres_per_radian: float | None = None) -> Manifold: ...
    @property
    def name(self) -> str:
        """r1 to r8, s2, so3, se2, se3 or sim2."""
    @property
    def metres_per_radian(self) -> float | None:
        """How many metres count as much as one radian; None where nothing is weighed."""
    @property
    def point_size(self) -> int:
        """How many numbers a point has."""
    @property
    def tangent_size(self) -> int:
        """How many numbers a tangent vector has."""
    @property
    def injectivity_radius(self) -> float:
        """Radius within which geodesics are unique."""
    def exp(self, p: Any, v: ArrayLike) -> Any:
        """The points, shape (…, point_size), reached from p along v in unit time; a scipy Rotation where p is one."""
    def log(self, p: Any, q: Any) -> Array:
        """The initial velocities, shape (…, tangent_size), of the shortest geodesics from p to q.

        :raises GeometryError: where a point is none, or a geodesic is not unique; the sentence names the row.
        """
    def distance(self, p: Any, q: Any) -> Array:
        """Geodesic distances, shape (…)."""
    def norm(self, p: Any, v: ArrayLike) -> Array:
        """Lengths of tangent vectors at p, shape (…)."""
    def geodesic(self, p: Any, q: Any, t: ArrayLike) -> Any:
        """The points at fractions t of the shortest geodesics from p (t = 0) to q (t = 1)."""
    def compose(self, a: Any, b: Any) -> Any:
        """Products ab; on so3, se2, se3 and sim2."""
    def inverse(self, a: Any) -> Any:
        """Inverses; on so3, se2, se3 and sim2."""
    def group_exp(self, v: ArrayLike) -> Array:
        """The group exponential: screws on se3, arcs on se2, spirals on sim2."""
    def group_log(self, a: Any) -> Array:
        """Its principal logarithm."""
    def __eq__(self, other: object) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __repr__(self) -> str: ...

@final
class PoseSpline:
    """A C2 curve through every one of its poses: midpoint-chart cubics of rotations, the cubic spline of positions.

    Twists, accelerations and jerks are in the body (tool) frame, ``vx, vy, vz, wx, wy, wz`` per unit of the parameter: the linear parts are the
    derivatives of the position turned into the tool frame. Beyond its domain an open curve stays at its end, with the derivatives it has
    there; a closed one goes round again. Increasing times are the quickest.
    """

    @staticmethod
    def fit(
        poses: Any,
        times: ArrayLike | None = None,
        *,
        ends: Literal["natural", "periodic"] | tuple[ArrayLike, ArrayLike] | None = None,
        metres_per_radian: float = 1.0,
    ) -> PoseSpline:
        """The spline that passes ``poses``, shape (n, 7), at ``times``, shape (n,).

        Without times the knots are centripetal in the metric where a radian counts as so many metres. Ends: ``"natural"`` (no acceleration),
        ``"periodic"`` (closed; one more time says when the first pose is reached again), or a pair of twists, shape (6,).

        :raises SplineError: where there is no such curve; the sentence names the poses.
        """
    @property
    def knots(self) -> Array:
        """The parameter at every pose."""
    @property
    def domain(self) -> tuple[float, float]:
        """First and last parameter."""
    @property
    def is_closed(self) -> bool:
        """Whether the curve ends where it began."""
    def pose(self, t: ArrayLike) -> Array:
        """Poses, shape (…, 7), at parameters t, shape (…)."""
    def twist(self, t: ArrayLike) -> Array:
        """First derivatives, shape (…, 6)."""
    def acceleration(self, t: ArrayLike) -> Array:
        """Second derivatives, shape (…, 6)."""
    def jerk(self, t: ArrayLike) -> Array:
        """Third derivatives, shape (…, 6); they jump at the knots."""
    def at(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations in one go."""
    def __repr__(self) -> str: ...

@final
class Trajectory:
    """Joint motion in time: points, and between them the quintics that a ros2_control joint_trajectory_controller executes."""

    @property
    def joint_names(self) -> list[str]:
        """From base to tool."""
    @property
    def duration_s(self) -> float:
        """Time of the last point."""
    @property
    def times(self) -> Array:
        """Times of the points in s, shape (n,)."""
    @property
    def positions(self) -> Array:
        """In rad (m for prismatic joints), shape (n, joints)."""
    @property
    def velocities(self) -> Array:
        """Per s."""
    @property
    def accelerations(self) -> Array:
        """Per s²."""
    def at(self, t: ArrayLike) -> tuple[Array, Array, Array, Array]:
        """Positions, velocities, accelerations and jerks, shape (…, joints), at times t in s, shape (…)."""
    def __len__(self) -> int: ...
    def __repr__(self) -> str: ...

def order(
    points: Any,
    manifold: Manifold,
    *,
    metres_per_radian: float | str,
    method: str,
    topology: str,
    start: int | None,
    start_at: ArrayLike | None,
    components: str,
    repair: str,
    denoise: bool,
    edges: bool,
) -> tuple[Any, ...]: ...
def plan(
    poses: Any,
    robot: str,
    *,
    limits: Path | None,
    config: str,
    start: ArrayLike | None,
    frame_id: str,
    metres_per_radian: float | None,
    topology: str | None,
    start_pose: int | None,
    minimum_verdict: str | None,
    rate_hz: float | None,
) -> tuple[tuple[Any, ...], PoseSpline, Trajectory, Array, str]: ...
def read_poses(
    path: Path,
    topic: str | None,
    *,
    frames: tuple[str, str] | None,
    window_s: float | None,
    gap_s: float | None,
    damaged: bool,
) -> tuple[list[tuple[Any, ...]], list[str]]: ...
def write_poses(
    path: Path, poses: Any, *, topic: str, frame_id: str, stamps_ns: Sequence[int] | None
) -> None: ...
def check_task(settings: dict[str, Any]) -> None: ...
def find_bags(paths: Sequence[Path]) -> list[tuple[pathlib.Path, str, int]]: ...
def bag_outputs(paths: Sequence[Path], output: Path) -> list[pathlib.Path]: ...
def replay_bag(path: Path, name: str, output: Path | None, settings: dict[str, Any]) -> str: ...
def replay_table(summaries: Sequence[str]) -> str: ...
def remove_abandoned(folder: Path) -> None: ...
