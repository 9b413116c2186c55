"""Seconds that the package reorder takes: orders of poses in a folder (wall), and the spline of scipy_splines.py (time of the process)."""

import json
import os
import sys
import time

import numpy as np
import reorder

KNOTS_A_LOOP = 25
POINTS = 1_000_000


def least(clock, work, repeats):
    def once():
        start = clock()
        work()
        return clock() - start

    return min(once() for _ in range(repeats))


def curve(knots):
    t = np.arange(knots) * 2.0 * np.pi / KNOTS_A_LOOP
    turns = np.stack([0.8 * np.sin(t), 0.6 * np.cos(2 * t), np.sin(t) + 0.3 * np.cos(3 * t)], 1)
    places = np.stack([np.cos(t), np.sin(t), 0.4 * np.sin(3 * t)], 1)
    home = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    rotations = reorder.SE3().group_exp(np.hstack([0 * turns, turns]))[:, 3:]
    assert rotations.shape == (knots, 4) and reorder.SE3().distance(home, home) == 0
    return t, reorder.poses(places, rotations)


costs = {}
for name, repeats in [("noisy 1e4", 9), ("clean 1e4", 9), ("clean 1e6", 1)]:
    poses = np.fromfile(os.path.join(sys.argv[1], name), "<f8").reshape(-1, 7)
    costs[f"order {name}"] = least(time.perf_counter, lambda: reorder.order(poses, metres_per_radian=1.0), repeats)
t, poses = curve(1_000)
spline = reorder.fit(poses, t)
evenly = np.arange(POINTS) * (t[-1] / POINTS)
costs["batch"] = least(time.process_time, lambda: spline.at(evenly), 3)
print(json.dumps(costs))
