"""Judges how one trajectory takes over from another that is being executed, from their messages alone."""

import numpy as np

from trajectory_check import Trajectory, basis_rows, check_trajectory

# Stamps and times are whole nanoseconds, each rounded once.
STAMP_ROUNDING_S = 2e-9
# Of quintics through positions of some radians 10 ms apart: 60 eps 3 / 0.01^2 in the acceleration.
ROUNDING = 1e-9
# Before and after a hand-over, to see that the robot is under way.
AROUND_NS = 500_000_000


def state_at(trajectory, time_ns):
    """Position, velocity and acceleration that a controller plays then; at rest before the start and after the end."""
    times = np.array(trajectory.times_ns)
    fields = [np.array(f, float) for f in (trajectory.positions, trajectory.velocities, trajectory.accelerations)]
    if not times[0] <= time_ns < times[-1]:
        held = fields[0][0 if time_ns < times[0] else -1]
        return held, np.zeros_like(held), np.zeros_like(held)
    i = int(np.searchsorted(times, time_ns, side="right")) - 1
    h = (times[i + 1] - times[i]) / 1e9
    u = (time_ns - times[i]) / (times[i + 1] - times[i])
    ends = np.stack([*(f[i] for f in fields), *(f[i + 1] for f in fields)])
    return tuple(basis_rows(np.array([u]), np.array([h]), order)[0, 0] @ ends for order in range(3))


def executed(running, following, offset_ns):
    """What a controller plays in the end: `following` in place of `running` from `offset_ns` of it on."""
    before = sum(ns < offset_ns for ns in running.times_ns)
    return Trajectory(
        running.names,
        running.times_ns[:before] + [offset_ns + ns for ns in following.times_ns],
        running.positions[:before] + following.positions,
        running.velocities[:before] + following.velocities,
        running.accelerations[:before] + following.accelerations,
    )


def check_handover(running, following, offset_ns, takes_over_s, limits):
    """Problems as sentences (none: nobody sees a jump, and all that is executed keeps the limits).

    `following` starts `offset_ns` after `running` does, and leads elsewhere from `takes_over_s` of its own time on.
    """
    if running.names != following.names:
        return [f"The joints are {following.names}, before they were {running.names}."]
    problems = []
    tolerances = [
        ROUNDING + STAMP_ROUNDING_S * max(limits[name][kind] for name in running.names)
        for kind in ("velocity", "acceleration", "jerk")
    ]
    takes_over_ns = round(takes_over_s * 1e9)
    for place, at_ns in (("first point", 0), ("hand-over", takes_over_ns)):
        states = state_at(running, offset_ns + at_ns), state_at(following, at_ns)
        for kind, was, comes, tolerance in zip(("position", "velocity", "acceleration"), *states, tolerances):
            jump = float(np.abs(was - comes).max())
            if not jump <= tolerance:
                problems.append(f"The {kind} jumps by {jump:.3g} at the {place}.")
    # At one moment it may stand, as between the approach and the first pose; the hand-over must not wait for the rest at the end.
    if not offset_ns + takes_over_ns < running.times_ns[-1] - AROUND_NS:
        problems.append("The hand-over waits for the rest at the end.")
    around = range(takes_over_ns - AROUND_NS, takes_over_ns + AROUND_NS + 1, AROUND_NS // 10)
    if not max(np.abs(state_at(running, offset_ns + ns)[1]).max() for ns in around) > 0.01:
        problems.append("The robot hardly moves around the hand-over: that is a start from rest.")
    later_ns = takes_over_ns + 500_000_000
    if np.abs(state_at(running, offset_ns + later_ns)[0] - state_at(following, later_ns)[0]).max() < 1e-4:
        problems.append("Half a second after the hand-over the robot still does what it did before.")
    return problems + check_trajectory(executed(running, following, offset_ns), limits)[0]
