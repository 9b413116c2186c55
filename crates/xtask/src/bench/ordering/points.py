"""Writes the sets of points that `cargo xtask bench ordering` works on into a folder, as little-endian doubles.

Noisy closed curves, the noise 0.01 in each coordinate; poses as x y z qx qy qz qw with quaternions of either sign, and beside them
the seven numbers (p, 2q) with q in one hemisphere, whose Euclidean tree is the usual, inexact stand-in. Also a CSV of poses.
"""
import os
import sys

import numpy as np

SIGMA = 0.01


def curve(n, dimension):
    r = np.random.default_rng(0)
    t = r.random(n) * 2 * np.pi
    columns = [np.cos(t), np.sin(t), 0.4 * np.sin(3 * t), 0.4 * np.cos(2 * t), 0.3 * np.sin(2 * t + 1), 0.3 * np.cos(3 * t),
               0.2 * np.sin(5 * t)]
    return np.stack(columns[:dimension], 1) + SIGMA * r.standard_normal((n, dimension))


def exponential(v):
    angle = np.linalg.norm(v, axis=1, keepdims=True)
    return np.concatenate([v * np.sinc(angle / 2 / np.pi) / 2, np.cos(angle / 2)], 1)


def product(a, b):
    ax, ay, az, aw = a.T
    bx, by, bz, bw = b.T
    return np.stack([aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz], 1)


def normalised(q):
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def poses(kind, n):
    r = np.random.default_rng(0)
    t = r.random(n) * 2 * np.pi
    noisy = lambda q, sigma: product(q, exponential(sigma * r.standard_normal((len(q), 3))))
    place = np.stack([np.cos(t), np.sin(t), 0.4 * np.sin(3 * t)], 1) + SIGMA * r.standard_normal((n, 3))
    if kind == "smooth":
        rotation = noisy(exponential(np.stack([0.4 * np.cos(2 * t), 0.3 * np.sin(2 * t + 1), 0.3 * np.cos(3 * t)], 1)), SIGMA)
    elif kind == "full turns":
        rotation = noisy(exponential(np.stack([0 * t, 0 * t, 3 * t], 1)), SIGMA)
    elif kind == "clusters":
        count = max(2, n // 1000)
        which = r.integers(0, count, n)
        place = r.uniform(-1, 1, (count, 3))[which] + 1e-3 * r.standard_normal((n, 3))
        rotation = noisy(normalised(r.standard_normal((count, 4)))[which], 1e-3)
    elif kind == "duplicates":
        return poses("smooth", n // 10)[r.integers(0, n // 10, n)]
    elif kind == "identical":
        return np.tile(poses("smooth", 1), (n, 1))
    else:
        place, rotation = r.uniform(-1, 1, (n, 3)), normalised(r.standard_normal((n, 4)))
    rotation *= np.where(r.random(n) < 0.5, -1, 1)[:, None]
    return np.concatenate([place, rotation], 1)


def write(folder, name, array):
    path = os.path.join(folder, name)
    np.ascontiguousarray(array).tofile(path + ".part")
    os.replace(path + ".part", path)


folder = sys.argv[1]
write(folder, "r3 1e6", curve(10**6, 3))
write(folder, "r7 1e5", curve(10**5, 7))
write(folder, "se3 smooth 1e6", poses("smooth", 10**6))
for kind in ("smooth", "full turns", "clusters", "duplicates", "identical", "uniform"):
    write(folder, f"se3 {kind} 1e5", poses(kind, 10**5))
smooth = poses("smooth", 10**5)
smooth[:, 3:] *= 2 * np.where(smooth[:, 6:] < 0, -1, 1)
write(folder, "embedded smooth 1e5", smooth)
# A curve as a recorder would leave it: dense, clean, shuffled.
n = 10**6
t = np.random.default_rng(1).permutation(n) / n * 2 * np.pi
place = np.stack([np.cos(t), np.sin(t), 0.4 * np.sin(3 * t)], 1)
rotation = exponential(np.stack([0.4 * np.cos(2 * t), 0.3 * np.sin(2 * t + 1), 0.3 * np.cos(3 * t)], 1))
path = os.path.join(folder, "poses.csv")
np.savetxt(path + ".part", np.concatenate([place, rotation], 1), "%.17g", ",", header="x,y,z,qx,qy,qz,qw", comments="")
os.replace(path + ".part", path)
