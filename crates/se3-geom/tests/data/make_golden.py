#!/usr/bin/env python3
"""Writes so3_se3_golden.json: exp and log of SO(3) and SE(3) and the product distance at 60 digits.

The formulas here are the matrix exponential by power series and the quaternion half-angle, in mpmath; nothing is shared with
the code under test. Usage: pip install mpmath==1.3.0; python make_golden.py
"""
import json, pathlib, random
from mpmath import mp, mpf, matrix, eye, sqrt, sin, cos, asin, acos

mp.dps = 60
rng = random.Random(20261122)


def exp_quaternion_xyzw(v):
    angle = sqrt(sum(x * x for x in v))
    scale = sin(angle / 2) / angle if angle else mpf(1) / 2
    return [x * scale for x in v] + [cos(angle / 2)]


def expm(a):
    total, term = eye(4), eye(4)
    for k in range(1, 120):
        term = term * a / k
        total += term
    return total


cases = []
for exponent in [-12, -8, -6, -4, -2, -1, -0.3]:
    cases.append(10.0 ** exponent)
cases += [0.5, 0.9999999, 1.0, 1.5, 2.0, 2.0000001, 2.5, 3.0, 3.1, 3.14, 3.1415, 3.14159265]
out = []
for angle in cases:
    for _ in range(3):
        axis = [rng.uniform(-1, 1) for _ in range(3)]
        norm = sum(x * x for x in axis) ** 0.5
        w = [angle * x / norm for x in axis]          # doubles: the exact inputs
        v = [rng.uniform(-1, 1) for _ in range(3)]
        wm, vm = [mpf(x) for x in w], [mpf(x) for x in v]
        hat = matrix([[0, -wm[2], wm[1], vm[0]], [wm[2], 0, -wm[0], vm[1]], [-wm[1], wm[0], 0, vm[2]], [0, 0, 0, 0]])
        full = expm(hat)
        theta = sqrt(sum(x * x for x in wm))
        p = [full[i, 3] for i in range(3)]
        alpha, beta = mpf("0.25"), mpf(4)
        distance = sqrt(alpha * theta**2 + beta * sum(x * x for x in p))
        out.append({
            "angular": w, "linear": v,
            "quaternion_xyzw": [float(x) for x in exp_quaternion_xyzw(wm)],
            "translation": [float(x) for x in p],
            "distance_from_identity_alpha_0.25_beta_4": float(distance),
        })
path = pathlib.Path(__file__).with_name("so3_se3_golden.json")
path.write_text(json.dumps({"meta": __doc__.strip().splitlines()[0], "cases": out}, indent=0) + "\n")
