"""Seconds that scipy's RotationSpline and CubicSpline together take on the curve of crates/se3-geom/benches/figures.rs:
orientation and position with their first and second derivatives. One thread, the least of some stretches, in time of the process:
a busy machine does not count against it."""

import json
import time

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

KNOTS_A_LOOP = 25
POINTS = 1_000_000
STRETCH = 100_000


def curve(knots):
    t = np.arange(knots) * 2.0 * np.pi / KNOTS_A_LOOP
    turns = np.stack([0.8 * np.sin(t), 0.6 * np.cos(2 * t), np.sin(t) + 0.3 * np.cos(3 * t)], 1)
    positions = np.stack([np.cos(t), np.sin(t), 0.4 * np.sin(3 * t)], 1)
    return t, Rotation.from_rotvec(turns), positions


def seconds(work, repeats):
    def once():
        start = time.process_time()
        work()
        return time.process_time() - start

    return min(once() for _ in range(repeats))


def fit(t, rotations, positions):
    return RotationSpline(t, rotations), CubicSpline(t, positions)


t, rotations, positions = curve(10_000)
costs = {"fit": seconds(lambda: fit(t, rotations, positions), 3)}
t, rotations, positions = curve(1_000)
splines = fit(t, rotations, positions)


def evaluate(at):
    return [spline(at, order) for spline in splines for order in range(3)]


evenly = np.arange(POINTS) * (t[-1] / POINTS)
for name, at in [("sorted", evenly), ("random", np.random.default_rng(1).random(POINTS) * t[-1])]:
    stretches = at.reshape(-1, STRETCH)
    costs[name] = min(seconds(lambda: evaluate(stretch), 1) for stretch in stretches) / STRETCH
costs["batch"] = seconds(lambda: evaluate(evenly), 1)
print(json.dumps(costs))
