"""exp, log and distance on the unit sphere at 60 digits. pip install mpmath; python make_sphere_golden.py > sphere_golden.json

The base point and the tangent are rounded to doubles first, the base then normalised at 60 digits, and log and distance are
those of the rounded end point: what a program with the same inputs should find.
"""

import json
import random

from mpmath import mp, mpf

mp.dps = 60
dot = lambda u, v: sum(a * b for a, b in zip(u, v))
norm = lambda u: mp.sqrt(dot(u, u))
scaled = lambda u, k: [a * k for a in u]
unit = lambda u: scaled(u, 1 / norm(u))
plus = lambda u, v: [a + b for a, b in zip(u, v)]
doubles = lambda u: [float(a) for a in u]
exact = lambda u: [mpf(a) for a in u]


def tangent_at(p, raw):
    return plus(raw, scaled(p, -dot(raw, p)))


def log(p, q):
    angle = 2 * mp.atan2(norm(plus(p, scaled(q, -1))), norm(plus(p, q)))
    across = tangent_at(p, q)
    length = norm(across)
    return angle, scaled(across, angle / length) if length else [mpf(0)] * 3


angles = [0, 1e-300, 1e-160, 1e-16, 1e-9, 1e-8, 1e-4, 0.1, 0.5, 1, mp.pi / 2, 2, 2.5, 3, 3.1]
angles += [mp.pi - mpf(10) ** -k for k in (2, 4, 6, 8)]
generator = random.Random(7)
cases = []
for angle in angles:
    for raw_base in ([1, 0, 0], [0.6, -0.48, 0.64], None):
        base = raw_base or [generator.gauss(0, 1) for _ in range(3)]
        base = doubles(unit(exact(base)))
        p = unit(exact(base))
        raw = [generator.gauss(0, 1) for _ in range(3)]
        tangent = doubles(scaled(unit(tangent_at(p, exact(raw))), mpf(angle)))
        v = tangent_at(p, exact(tangent))
        length = norm(v)
        ratio = mp.sin(length) / length if length else mpf(1)
        end = plus(scaled(p, mp.cos(length)), scaled(v, ratio))
        point = doubles(end)
        distance, back = log(p, unit(exact(point)))
        cases.append(
            {
                "angle": float(angle),
                "base": base,
                "tangent": tangent,
                "exp": point,
                "distance": float(distance),
                "log": doubles(back),
            }
        )
print(json.dumps({"digits": 60, "cases": cases}, indent=1))
