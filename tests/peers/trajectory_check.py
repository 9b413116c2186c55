"""Judges a joint trajectory from its published points alone; shares no code with what planned it.

Between successive points a controller plays the quintic with the positions, velocities and
accelerations of both ends (ros2_controllers' joint trajectory controller does). That curve is C2
across the points by construction, so what remains to be shown is that it obeys the limits and that
the three published fields are derivatives of one another.
"""

from dataclasses import dataclass

import numpy as np

GRID = 10  # parts that each interval between published points is cut into
MARGIN = 1e-6  # relative to a limit
# Published doubles are the results of a few roundings each, not of one.
ROUNDING = 4 * np.finfo(float).eps
# What the joint trajectory controller takes for a final velocity of zero.
AT_REST = np.finfo(np.float32).eps

# Quintic Hermite basis on u in [0, 1], ascending powers of u, for q0, h v0, h^2 a0, q1, h v1, h^2 a1.
BASIS = np.array(
    [
        [1, 0, 0, -10, 15, -6],
        [0, 1, 0, -6, 8, -3],
        [0, 0, 0.5, -1.5, 1.5, -0.5],
        [0, 0, 0, 10, -15, 6],
        [0, 0, 0, -4, 7, -3],
        [0, 0, 0, 0.5, -1, 0.5],
    ]
)


@dataclass
class Trajectory:
    """Points as published: `times_ns` counts whole nanoseconds, the others have a row a point."""

    names: list
    times_ns: list
    positions: list
    velocities: list
    accelerations: list


def check_trajectory(trajectory, limits):
    """Problems as sentences (none: the trajectory is sound) and the peak-over-limit ratios.

    `limits` maps each joint to its `velocity` (rad/s), `acceleration` (rad/s2), `jerk` (rad/s3).
    """
    problems = shape_problems(trajectory, limits)
    if problems:
        return problems, {}
    fields = (trajectory.positions, trajectory.velocities, trajectory.accelerations)
    q, v, a = (np.array(field, float) for field in fields)
    bounds = {
        kind: np.array([limits[name][kind] for name in trajectory.names], float)
        for kind in ("velocity", "acceleration", "jerk")
    }
    seconds = np.array(trajectory.times_ns) / 1e9
    h = np.diff(np.array(trajectory.times_ns)) / 1e9

    problems = rest_problems(trajectory.names, v, a)
    ratios = {}
    for kind, ratio in [*quintic_ratios(h, q, v, a, bounds), *relation_ratios(h, q, v, a, bounds["jerk"])]:
        ratios[kind] = float(ratio.max())
        if ratios[kind] > 1.0 + MARGIN:
            interval, joint = np.unravel_index(np.argmax(ratio), ratio.shape)
            problems.append(
                f"{MEANINGS[kind]} of {trajectory.names[joint]} between {seconds[interval]:.6f} s and "
                f"{seconds[interval + 1]:.6f} s is {ratios[kind]:.6g} times what its limits allow."
            )
    return problems, ratios


MEANINGS = {
    "velocity": "The velocity",
    "acceleration": "The acceleration",
    "jerk": "The jerk",
    "acceleration_step": "The step in acceleration",
    "velocity_relation": "The disagreement of accelerations with the change in velocity",
    "position_relation": "The disagreement of velocities and accelerations with the change in position",
}


def shape_problems(trajectory, limits):
    names = trajectory.names
    problems = []
    if len(set(names)) != len(names) or set(names) != set(limits):
        problems.append(f"The joints are {names}, the limits are of {sorted(limits)}.")
    n = len(trajectory.times_ns)
    if n < 2:
        problems.append(f"The trajectory has {n} points; a motion needs two.")
    for kind in ("positions", "velocities", "accelerations"):
        field = getattr(trajectory, kind)
        for i, row in enumerate(field):
            if len(row) != len(names):
                problems.append(f"Point {i} has {len(row)} {kind} for {len(names)} joints.")
                break
            if not np.isfinite(row).all():
                problems.append(f"Point {i} has {kind} that are not finite.")
                break
        if len(field) != n:
            problems.append(f"There are {len(field)} rows of {kind} for {n} times.")
    times = np.array(trajectory.times_ns)
    if n and times[0] < 0:
        problems.append(f"The first time is {times[0]} ns; it must not be negative.")
    stuck = np.flatnonzero(np.diff(times) <= 0)
    if len(stuck):
        i = stuck[0]
        problems.append(
            f"Times must increase strictly: point {i} is at {times[i]} ns, point {i + 1} at {times[i + 1]} ns."
        )
    return problems


def rest_problems(names, v, a):
    problems = []
    for end, row in (("first", 0), ("last", -1)):
        for kind, values in (("velocity", v[row]), ("acceleration", a[row])):
            joint = np.argmax(np.abs(values))
            if abs(values[joint]) > AT_REST:
                problems.append(f"The {end} {kind} of {names[joint]} is {values[joint]:.6g}, not zero.")
    return problems


def quintic_ratios(h, q, v, a, bounds):
    """Peak over limit of the played curve, a row an interval and a column a joint."""
    u = np.linspace(0.0, 1.0, GRID + 1)
    # From q0, lest the difference of two near positions drown in their size.
    played = np.stack([np.zeros_like(q[1:]), v[:-1], a[:-1], np.diff(q, axis=0), v[1:], a[1:]], axis=1)
    published = np.stack([q[:-1], v[:-1], a[:-1], q[1:], v[1:], a[1:]], axis=1)
    for order, kind in ((1, "velocity"), (2, "acceleration"), (3, "jerk")):
        rows = basis_rows(u, h, order)
        values = np.einsum("iuk,ikj->iuj", rows, played)
        peak = np.abs(values).max(axis=1)
        if kind == "jerk":
            peak = np.maximum(peak, quadratic_vertex(values[:, 0], values[:, GRID // 2], values[:, -1]))
        blur = ROUNDING * np.einsum("iuk,ikj->iuj", np.abs(rows), np.abs(published)).max(axis=1)
        yield kind, np.maximum(peak - blur, 0.0) / bounds[kind]


def basis_rows(u, h, order):
    """The derivative of that order of the six basis functions: interval x u x basis function."""
    derived = np.polynomial.polynomial.polyder(BASIS, order, axis=1)
    values = np.polynomial.polynomial.polyval(u, derived.T)
    powers = np.array([0, 1, 2, 0, 1, 2])
    return values.T[None] * (h[:, None] ** (powers - order))[:, None, :]


def quadratic_vertex(first, middle, last):
    """The extreme inside an interval of the quadratics with these values at u = 0, 1/2, 1, or 0."""
    c1 = -3 * first + 4 * middle - last
    c2 = 2 * (first - 2 * middle + last)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -c1 / (2 * c2)
        return np.where((at > 0) & (at < 1), np.abs(first - c1**2 / (4 * c2)), 0.0)


def relation_ratios(h, q, v, a, jerk):
    """How far the fields are from being derivatives of one another, over how far they may be.

    For any curve with |jerk| <= J, Taylor's theorem with integral remainder gives

        a1 - a0                                       = int j               <= J h
        v1 - v0 - (a0 + a1) h/2                       = int (h/2 - t) j     <= J h^2 / 4
        q1 - q0 - (v0 + v1) h/2 + (a1 - a0) h^2/12    = int (h^2/12 - t(h-t)/2) j
                                                                            <= J h^3 sqrt(3)/54

    each bound being J times the integral over [0, h] of the kernel's absolute value.
    """
    h = h[:, None]
    dq, dv, da = np.diff(q, axis=0), np.diff(v, axis=0), np.diff(a, axis=0)
    size_q, size_v, size_a = (np.abs(x[:-1]) + np.abs(x[1:]) for x in (q, v, a))
    relations = {
        "acceleration_step": (da, size_a, h),
        "velocity_relation": (dv - (a[:-1] + a[1:]) * h / 2, size_v + size_a * h / 2, h**2 / 4),
        "position_relation": (
            dq - (v[:-1] + v[1:]) * h / 2 + da * h**2 / 12,
            size_q + size_v * h / 2 + size_a * h**2 / 12,
            h**3 * np.sqrt(3) / 54,
        ),
    }
    for kind, (residual, size, kernel) in relations.items():
        yield kind, np.maximum(np.abs(residual) - ROUNDING * size, 0.0) / (jerk * kernel)


def check_ordered_poses(ordered, report, recorded=None):
    """Problems of the ordered poses against the report, and against the recorded input if given.

    Poses are rows x, y, z, qx, qy, qz, qw.
    """
    order, duplicates = report["order"], report["duplicates"]
    problems = []
    if sorted(order) != list(range(report["n"])):
        problems.append("The reported order does not name every input once.")
    if recorded is not None and report["n"] != len(recorded):
        problems.append(f"The report speaks of {report['n']} poses; {len(recorded)} were recorded.")
    merged = {row for group in duplicates for row in sorted(group)[1:]}
    kept = [row for row in order if row not in merged]
    if len(ordered) != len(kept):
        problems.append(f"{len(ordered)} ordered poses arrived; the input without duplicates has {len(kept)}.")
    if problems or recorded is None:
        return problems
    for place, row in enumerate(kept):
        if not same_pose(ordered[place], recorded[row]):
            problems.append(f"Ordered pose {place} is not input {row}, which the report puts there.")
            break
    return problems


def same_pose(a, b):
    """Equal up to the quaternion's sign and the rounding of making it a unit one."""
    a, b = np.array(a, float), np.array(b, float)
    sign = 1.0 if a[3:] @ b[3:] >= 0 else -1.0
    return np.array_equal(a[:3], b[:3]) and np.abs(a[3:] - sign * b[3:]).max() <= ROUNDING
