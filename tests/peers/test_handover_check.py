"""The judgement of hand-overs is itself judged: a sound one passes, each mutant is named.

    python -m unittest discover -s tests/peers
"""

import copy
import math
import unittest

import numpy as np

from handover_check import check_handover, executed, state_at
from trajectory_check import Trajectory

STEP_NS = 10_000_000
TAKEN_OVER_NS = 1_000_000_000
END_NS = 3_000_000_000
LIMITS = {"a": {"velocity": 2.0, "acceleration": 3.0, "jerk": 20.0}}


def quintic(span_ns, begin, end):
    """Points of the quintic from a state to another, (position, velocity, acceleration) each."""
    powers = lambda t, k: [math.perm(n, k) * t ** max(n - k, 0) for n in range(6)]
    ends = [powers(t, k) for t in (0.0, span_ns / 1e9) for k in range(3)]
    polynomial = np.polynomial.Polynomial(np.linalg.solve(ends, [*begin, *end]))
    times_ns = list(range(0, span_ns + 1, STEP_NS))
    rows = [[[float(polynomial.deriv(k)(ns / 1e9))] for ns in times_ns] for k in range(3)]
    return Trajectory(["a"], times_ns, *rows)


def sound():
    """A rest-to-rest move, and one to elsewhere that begins with what is left of it until the hand-over."""
    running = quintic(END_NS, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    offset_ns = TAKEN_OVER_NS - 20 * STEP_NS
    state = [float(x[0]) for x in state_at(running, TAKEN_OVER_NS)]
    elsewhere = quintic(END_NS, state, (0.6, 0.0, 0.0))
    left = slice(offset_ns // STEP_NS, TAKEN_OVER_NS // STEP_NS)
    following = Trajectory(
        ["a"],
        [ns - offset_ns for ns in running.times_ns[left]]
        + [TAKEN_OVER_NS - offset_ns + ns for ns in elsewhere.times_ns],
        running.positions[left] + elsewhere.positions,
        running.velocities[left] + elsewhere.velocities,
        running.accelerations[left] + elsewhere.accelerations,
    )
    return running, following, offset_ns


def problems(change=lambda following: None, late_ns=0, takes_over_s=0.2):
    running, following, offset_ns = sound()
    following = copy.deepcopy(following)
    change(following)
    return check_handover(running, following, offset_ns + late_ns, takes_over_s, LIMITS)


class HandOver(unittest.TestCase):
    def test_a_sound_one_passes(self):
        self.assertEqual(problems(), [])

    def test_what_is_executed_switches_at_the_offset(self):
        running, following, offset_ns = sound()
        whole = executed(running, following, offset_ns)
        self.assertEqual(whole.times_ns, list(range(0, TAKEN_OVER_NS + END_NS + 1, STEP_NS)))
        self.assertEqual(whole.positions[-1], following.positions[-1])

    def test_a_stamp_that_is_a_millisecond_off_is_noticed(self):
        for late_ns in (-1_000_000, 1_000_000):
            said = problems(late_ns=late_ns)
            self.assertTrue(any("position jumps" in p and "first point" in p for p in said), said)

    def test_a_first_point_without_its_velocity_or_acceleration_is_noticed(self):
        for field, kind in (("velocities", "velocity"), ("accelerations", "acceleration")):
            said = problems(lambda following: getattr(following, field)[0].__setitem__(0, 0.0))
            self.assertTrue(any(f"The {kind} jumps" in p and "first point" in p for p in said), said)

    def test_times_that_count_from_the_hand_over_are_noticed(self):
        said = problems(takes_over_s=0.5)
        self.assertTrue(any("jumps" in p and "at the hand-over" in p for p in said), said)

    def test_a_trajectory_that_leads_nowhere_else_is_noticed(self):
        running, _, _ = sound()
        said = check_handover(running, running, 0, 0.2, LIMITS)
        self.assertTrue(any("still does what it did" in p for p in said), said)

    def test_a_start_from_rest_is_noticed(self):
        running, _, _ = sound()
        said = check_handover(running, running, END_NS, 0.0, LIMITS)
        self.assertTrue(any("rest at the end" in p for p in said), said)
        said = check_handover(running, running, 2 * END_NS, 0.0, LIMITS)
        self.assertTrue(any("hardly moves" in p for p in said), said)

    def test_a_moment_of_rest_on_the_way_is_no_start_from_rest(self):
        there, back = quintic(END_NS, (0.0,) * 3, (1.0, 0.0, 0.0)), quintic(END_NS, (1.0, 0.0, 0.0), (0.2, 0.0, 0.0))
        said = check_handover(executed(there, back, END_NS), quintic(END_NS, (1.0, 0.0, 0.0), (0.3, 0.0, 0.0)), END_NS, 0.0, LIMITS)
        self.assertEqual(said, [])


if __name__ == "__main__":
    unittest.main()
