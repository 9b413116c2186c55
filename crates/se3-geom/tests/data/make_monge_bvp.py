"""Geodesics on Monge patches by scipy's collocation solver: an oracle that shares no method with the crate (which shoots).

pip install numpy scipy; python make_monge_bvp.py > monge_bvp.json
The equation is x'' = -grad h (x' H x') / (1 + |grad h|^2). Each case is solved from several bowed starts and the shortest kept.
"""

import json

import numpy as np
import scipy
from scipy.integrate import solve_bvp


def saddle(x, y):
    return y, x, 0 * x, 1 + 0 * x, 0 * x


def egg_box(x, y):
    s, c = np.sin, np.cos
    return c(x) * c(y), -s(x) * s(y), -s(x) * c(y), -c(x) * s(y), -s(x) * c(y)


def bump(x, y):
    h = 2 * np.exp(-x * x - y * y)
    return -2 * x * h, -2 * y * h, (4 * x * x - 2) * h, 4 * x * y * h, (4 * y * y - 2) * h


def solve(jet, p, q, bow):
    p, q = np.array(p, float), np.array(q, float)

    def equation(_, state):
        x, y, u, v = state
        hx, hy, hxx, hxy, hyy = jet(x, y)
        k = (hxx * u * u + 2 * hxy * u * v + hyy * v * v) / (1 + hx * hx + hy * hy)
        return np.vstack([u, v, -hx * k, -hy * k])

    t = np.linspace(0, 1, 101)
    chord = q - p
    across = np.array([-chord[1], chord[0]])[:, None]
    path = p[:, None] + chord[:, None] * t + bow * across * np.sin(np.pi * t)
    slope = chord[:, None] + bow * np.pi * across * np.cos(np.pi * t)
    ends = lambda a, b: np.array([*(a[:2] - p), *(b[:2] - q)])
    found = solve_bvp(equation, ends, t, np.vstack([path, slope]), tol=1e-10, max_nodes=60000)
    if found.status != 0:
        return None
    x, y, u, v = found.y[:, 0]
    hx, hy, *_ = jet(x, y)
    length = np.sqrt(u * u + v * v + (hx * u + hy * v) ** 2)
    return {"length": float(length), "velocity": [float(u), float(v)], "middle": [float(c) for c in found.sol(0.5)[:2]]}


CASES = [
    ("saddle", saddle, (1, 1), (-1, -1)),
    ("saddle", saddle, (1.5, -0.2), (-0.4, 1.3)),
    ("egg_box", egg_box, (-3, -3), (3, 3)),
    ("egg_box", egg_box, (0.3, -1.1), (1.4, 0.6)),
    ("bump", bump, (-2, 0.1), (2, 0.05)),
    ("bump", bump, (-2, 0), (2, 0)),
]

if __name__ == "__main__":
    cases = []
    for name, jet, p, q in CASES:
        solved = [s for s in (solve(jet, p, q, bow) for bow in (-0.5, -0.25, 0.0, 0.25, 0.5)) if s]
        best = min(solved, key=lambda s: s["length"])
        cases.append({"surface": name, "from": p, "to": q, **best, "all_lengths": [s["length"] for s in solved]})
    print(json.dumps({"scipy": scipy.__version__, "tolerance": 1e-10, "cases": cases}, indent=1))
