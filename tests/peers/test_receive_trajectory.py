"""The receiver's judgement is itself judged: sound trajectories pass, each mutant is named.

    python -m unittest discover -s tests/peers
"""

import copy
import unittest

import numpy as np

from trajectory_check import Trajectory, check_ordered_poses, check_trajectory

DURATION_S = 1.6
STEP_NS = 8_000_000
TRAVEL_RAD = np.array([1.0, -0.5])
# Peaks of the rest-to-rest quintic 10u^3 - 15u^4 + 6u^5: at u = 1/2, (3 - sqrt 3)/6, 0.
PEAKS = (15 / 8 / DURATION_S, 10 / np.sqrt(3) / DURATION_S**2, 60 / DURATION_S**3)


def limits_at(factor):
    velocity, acceleration, jerk = (peak * factor for peak in PEAKS)
    return {
        name: {"velocity": travel * velocity, "acceleration": travel * acceleration, "jerk": travel * jerk}
        for name, travel in (("a", 1.0), ("b", 0.5))
    }


def sound():
    times_ns = np.arange(0, round(DURATION_S * 1e9) + 1, STEP_NS)
    shape = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6])
    rows = [
        (TRAVEL_RAD * shape.deriv(k)(times_ns / 1e9 / DURATION_S)[:, None] / DURATION_S**k).tolist()
        for k in range(3)
    ]
    return Trajectory(["a", "b"], times_ns.tolist(), *rows)


def problems_of(change):
    trajectory = sound()
    change(trajectory)
    return check_trajectory(trajectory, limits_at(1.0))[0]


class SoundTrajectory(unittest.TestCase):
    def test_passes_at_exactly_its_own_peaks(self):
        problems, ratios = check_trajectory(sound(), limits_at(1.0))
        self.assertEqual(problems, [])
        # The grid is 1/2000 of the motion: it misses a peak by its curvature times the step squared, below 2e-6.
        for kind in ("velocity", "acceleration", "jerk"):
            self.assertAlmostEqual(ratios[kind], 1.0, delta=2e-6)
        # The jerk is nearly constant over a step where it is greatest: there a steps by nearly J h.
        self.assertGreater(ratios["acceleration_step"], 0.95)

    def test_limits_a_hundred_thousandth_too_low_are_each_noticed(self):
        problems, _ = check_trajectory(sound(), limits_at(1.0 - 1e-5))
        self.assertEqual([p.split(" of ")[0] for p in problems], ["The velocity", "The acceleration", "The jerk"])

    def test_a_short_last_interval_is_not_blamed_for_rounding(self):
        trajectory = sound()
        shape = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6])
        trajectory.times_ns.insert(-1, trajectory.times_ns[-1] - 1000)
        u = trajectory.times_ns[-2] / 1e9 / DURATION_S
        for k, field in enumerate((trajectory.positions, trajectory.velocities, trajectory.accelerations)):
            # About 1, where the polynomial in 1 - u does not cancel: 1 - shape(1 - u).
            value = 1 - shape(1 - u) if k == 0 else (-1) ** (k + 1) * shape.deriv(k)(1 - u)
            field.insert(-1, (TRAVEL_RAD * value / DURATION_S**k).tolist())
        self.assertEqual(check_trajectory(trajectory, limits_at(1.001))[0], [])

    def test_jerk_that_peaks_inside_an_interval_is_found_off_the_grid(self):
        # From rest to rest in one interval with a kick in acceleration: the jerk's vertex lies between grid points.
        h, a1 = 1.0, 0.3
        trajectory = Trajectory(["a"], [0, 10**9], [[0.0], [1.0]], [[0.0], [0.0]], [[0.0], [a1]])
        wide = {"a": {"velocity": 1e3, "acceleration": 1e3, "jerk": 1.0}}
        u = np.linspace(0, 1, 1_000_001)
        dense = np.abs(60 - 360 * u + 360 * u**2 + a1 * (3 - 24 * u + 30 * u**2)).max() / h**3
        self.assertAlmostEqual(check_trajectory(trajectory, wide)[1]["jerk"], dense, places=6)


class Mutants(unittest.TestCase):
    def assert_blamed(self, change, *words):
        problems = problems_of(change)
        for word in words:
            self.assertTrue(any(word in p for p in problems), f"{word!r} not in {problems}")

    def test_dropped_last_point(self):
        def change(t):
            for field in (t.times_ns, t.positions, t.velocities, t.accelerations):
                field.pop()

        self.assert_blamed(change, "The last velocity", "The last acceleration")

    def test_reversed_points(self):
        def change(t):
            for field in (t.times_ns, t.positions, t.velocities, t.accelerations):
                field.reverse()

        self.assert_blamed(change, "Times must increase strictly")

    def test_reversed_points_under_the_old_times(self):
        def change(t):
            for field in (t.positions, t.velocities, t.accelerations):
                field.reverse()

        self.assert_blamed(change, "change in position", "change in velocity")

    def test_flipped_velocities(self):
        def change(t):
            t.velocities = [[-v for v in row] for row in t.velocities]

        self.assert_blamed(change, "change in position", "change in velocity", "The jerk")

    def test_flipped_accelerations(self):
        def change(t):
            t.accelerations = [[-a for a in row] for row in t.accelerations]

        self.assert_blamed(change, "change in velocity")

    def test_repeated_time(self):
        def change(t):
            t.times_ns[7] = t.times_ns[6]

        self.assert_blamed(change, "point 6 is at 48000000 ns, point 7 at 48000000 ns")

    def test_negative_first_time(self):
        def change(t):
            t.times_ns[0] = -1

        self.assert_blamed(change, "must not be negative")

    def test_nonzero_final_velocity(self):
        def change(t):
            t.velocities[-1] = [1e-3, 0.0]

        self.assert_blamed(change, "The last velocity of a is 0.001")

    def test_nonzero_first_acceleration(self):
        def change(t):
            t.accelerations[0] = [0.0, 1e-3]

        self.assert_blamed(change, "The first acceleration of b is 0.001")

    def test_positions_of_two_joints_exchanged(self):
        def change(t):
            t.positions = [row[::-1] for row in t.positions]

        self.assert_blamed(change, "change in position")

    def test_one_point_a_tenth_of_a_millirad_off(self):
        def change(t):
            t.positions[50][1] += 1e-4

        self.assert_blamed(change, "change in position of b between")

    def test_accelerations_left_out(self):
        def change(t):
            t.accelerations = [[] for _ in t.accelerations]

        self.assert_blamed(change, "Point 0 has 0 accelerations for 2 joints")

    def test_not_a_number(self):
        def change(t):
            t.velocities[3][0] = float("nan")

        self.assert_blamed(change, "Point 3 has velocities that are not finite")

    def test_a_joint_without_limits(self):
        def change(t):
            t.names = ["a", "c"]

        self.assert_blamed(change, "The joints are ['a', 'c']")

    def test_no_points(self):
        self.assertTrue(check_trajectory(Trajectory(["a", "b"], [], [], [], []), limits_at(1.0))[0])


class OrderedPoses(unittest.TestCase):
    def setUp(self):
        angles = np.linspace(0.1, 0.5, 5)
        self.recorded = [[x, 2 * x, 0.0, np.sin(x / 2), 0.0, 0.0, np.cos(x / 2)] for x in angles]
        self.recorded[3] = list(self.recorded[1])
        self.report = {"n": 5, "order": [4, 1, 3, 0, 2], "duplicates": [[1, 3]]}
        self.ordered = [copy.copy(self.recorded[i]) for i in (4, 1, 0, 2)]

    def problems(self):
        return check_ordered_poses(self.ordered, self.report, self.recorded)

    def test_input_without_duplicates_in_the_reported_order_passes(self):
        self.ordered[0][3:] = [-x for x in self.ordered[0][3:]]  # the same rotation
        self.assertEqual(self.problems(), [])

    def test_dropped_last_pose(self):
        self.ordered.pop()
        self.assertIn("3 ordered poses arrived; the input without duplicates has 4.", self.problems())

    def test_dropped_input(self):
        self.report = {"n": 4, "order": [1, 3, 0, 2], "duplicates": [[1, 3]]}
        self.ordered.pop(0)
        self.assertIn("The report speaks of 4 poses; 5 were recorded.", self.problems())

    def test_exchanged_poses(self):
        self.ordered.reverse()
        self.assertIn("Ordered pose 0 is not input 4, which the report puts there.", self.problems())

    def test_swapped_quaternion_order(self):
        self.ordered = [p[:3] + [p[6], p[3], p[4], p[5]] for p in self.ordered]
        self.assertTrue(self.problems())

    def test_order_that_names_an_input_twice(self):
        self.report["order"] = [4, 1, 3, 0, 0]
        self.assertIn("The reported order does not name every input once.", self.problems())


if __name__ == "__main__":
    unittest.main()
