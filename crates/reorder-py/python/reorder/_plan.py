"""An audited joint trajectory through unordered poses."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Union

from . import _reorder
from ._reorder import PoseSpline, Trajectory
from ._results import Ordering, ordering

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Plan:
    """An ordered, interpolated, timed and audited motion."""

    ordering: Ordering
    """The recovered order with its verdict."""
    spline: PoseSpline
    """The C2 curve through the distinct poses in order; its parameter is no time."""
    trajectory: Trajectory
    """What the robot executes: quintic between points, at rest at both ends."""
    pose_times_s: NDArray[np.float64]
    """When the tool is at each input pose, shape (n,), in s from the trajectory's start."""
    report: Dict[str, Any] = field(repr=False)
    """The object of ``reorder plan --report``: the order's, and the plan's audit under ``"plan"``."""

    @property
    def audit(self) -> Dict[str, Any]:
        """Limits of joints, checked over the whole trajectory: ``limits_ok``, ``max_ratio`` (peak over limit), ``position_margin`` …"""
        return self.report["plan"]["audit"]


def plan(
    poses: Any,
    robot: Union[str, os.PathLike[str]],
    *,
    limits: Union[str, os.PathLike[str], None] = None,
    config: Union[Mapping[str, Any], str, None] = None,
    start: Optional[ArrayLike] = None,
    frame_id: str = "",
    metres_per_radian: Optional[float] = None,
    topology: Optional[str] = None,
    start_pose: Optional[int] = None,
    minimum_verdict: Optional[str] = None,
    rate_hz: Optional[float] = None,
) -> Plan:
    """Plan a joint trajectory through poses, shape ``(n, 7)``, ``base_from_tool``, in any order, as ``reorder plan`` does.

    :param robot: ``"ur5e"``, ``"vx300s"``, ``"panda"``, or the path of a URDF, which needs ``limits``.
    :param limits: path of a file in the form of ``config/robots/ur5e.yaml``.
    :param config: what else shapes a plan: the planner's keys of ``config/reorder.yaml``, as a mapping or YAML text, for example
        ``{"timing": {"constant_tool_speed_m_s": 0.05}}``; the keywords here precede it.
    :param start: joint positions the robot stands at, in rad, from base to tool; the trajectory then starts there.
    :param frame_id: frame of the poses; empty means the robot's base frame.
    :param metres_per_radian: how many metres count as much as one radian; 0.1 where nothing says otherwise.
    :param topology: ``"auto"``, ``"open"`` or ``"closed"``.
    :param start_pose: row of the pose at which the trajectory starts.
    :param minimum_verdict: the least certain order that is planned; ``"plausible"`` where nothing says otherwise.
    :param rate_hz: trajectory points a second.
    :raises Refusal: where no trajectory exists under the limits, or the order is too uncertain; one sentence says why.
    :raises ReorderError: where the input is at fault.
    """
    text = "{}" if config is None else config if isinstance(config, str) else json.dumps(dict(config))
    order, spline, trajectory, times, report = _reorder.plan(
        poses,
        os.fspath(robot),
        limits=limits,
        config=text,
        start=start,
        frame_id=frame_id,
        metres_per_radian=metres_per_radian,
        topology=topology,
        start_pose=start_pose,
        minimum_verdict=minimum_verdict,
        rate_hz=rate_hz,
    )
    return Plan(ordering(order), spline, trajectory, times, json.loads(report))
