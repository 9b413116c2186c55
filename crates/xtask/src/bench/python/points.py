"""Writes the sets of poses that `cargo xtask bench python` orders into a folder, as little-endian doubles x y z qx qy qz qw: independent
points of a closed curve, in random order; of the noisy set each number of place and rotation vector is off by 0.01."""
import os
import sys

import numpy as np


def poses(n, sigma):
    r = np.random.default_rng(0)
    t = r.random(n) * 2 * np.pi
    places = np.stack([np.cos(t), np.sin(t), 0.4 * np.sin(3 * t)], 1) + sigma * r.standard_normal((n, 3))
    turns = np.stack([0.8 * np.sin(t), 0.6 * np.cos(2 * t), np.sin(t) + 0.3 * np.cos(3 * t)], 1)
    turns += sigma * r.standard_normal((n, 3))
    angle = np.linalg.norm(turns, axis=1, keepdims=True)
    return np.concatenate([places, turns * np.sinc(angle / 2 / np.pi) / 2, np.cos(angle / 2)], 1)


for name, n, sigma in [("noisy 1e4", 10_000, 0.01), ("clean 1e4", 10_000, 0.0), ("clean 1e6", 1_000_000, 0.0)]:
    partial = os.path.join(sys.argv[1], "partial")
    poses(n, sigma).astype("<f8").tofile(partial)
    os.replace(partial, os.path.join(sys.argv[1], name))
