#!/usr/bin/env python3
"""Writes groups_golden.json: exp and log of SO(3), SE(3), SE(2), Sim(2), and the SE(3) product distance, at 100 digits.

Everything is a power series of the exponential (of quaternions' half angle, of 3x3 matrices, of complex numbers) in mpmath;
no closed form with a cancellation, and nothing shared with the code under test. Inputs are exact doubles; every output is the
nearest double. "log_*" is the exact logarithm of the *rounded* element, its rotation normalised first: it judges log alone.
Usage: pip install mpmath==1.4.1; python make_golden.py
"""
import json, math, pathlib, random
from mpmath import mp, mpf, mpc, matrix, eye, sqrt, sin, cos, atan2, log, exp, lu_solve

mp.dps = 100
TERMS = 150  # 12^150/150! < 1e-100
rng = random.Random(20260311)

TINY = [0.0, 1e-300, 1e-250, 1e-200, 3e-162, 1e-158, 1e-154, 1e-120, 1e-60, 1e-30, 1e-18, 3e-16, 1e-13, 1e-10, 1e-9, 1e-8, 3e-8,
        1e-7, 1e-6, 1e-5]
MIDDLE = [1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.4999999, 0.5000001, 0.8, 0.9999999, 1.0000001, 1.5, 1.9999999, 2.0000001, 2.6, 3.0, 3.1]
NEAR_PI = [math.pi - gap for gap in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15)]
BEYOND = [math.pi, 10.0]
ANGLES = TINY + MIDDLE + NEAR_PI + BEYOND


def doubles(values):
    return [float(x) for x in values]


def vector(size, scale=1.0):
    return [scale * rng.uniform(-1, 1) for _ in range(size)]


def left_jacobian(w):
    """sum hat(w)^k/(k+1)!"""
    hat = matrix([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    total, term = eye(3), eye(3)
    for k in range(2, TERMS):
        term = term * hat / k
        total += term
    return total


def phi(z):
    """sum z^k/(k+1)!"""
    total = term = mpc(1)
    for k in range(2, TERMS):
        term = term * z / k
        total += term
    return total


def spatial_case(angle):
    axis = vector(3)
    norm = math.sqrt(sum(x * x for x in axis))
    w = [angle * x / norm for x in axis]
    v = vector(3, 10.0 ** rng.choice([-6, 0, 0, 3]))
    wm = [mpf(x) for x in w]
    theta = sqrt(sum(x * x for x in wm))
    scale = sin(theta / 2) / theta if theta else mpf(1) / 2
    quaternion = doubles([x * scale for x in wm] + [cos(theta / 2)])
    t_exact = left_jacobian(wm) * matrix([mpf(x) for x in v])
    translation = doubles(t_exact)
    # The logarithm of the rounded element.
    q = [mpf(x) for x in quaternion]
    if q[3] < 0:
        q = [-x for x in q]
    sine = sqrt(sum(x * x for x in q[:3]))
    stretch = 2 * atan2(sine, q[3]) / sine if sine else mpf(2)
    log_w = [x * stretch for x in q[:3]]
    log_v = lu_solve(left_jacobian(log_w), matrix([mpf(x) for x in translation]))
    distance = sqrt(mpf("0.25") * sum(x * x for x in log_w) + 4 * sum(mpf(x) ** 2 for x in translation))
    return {"angle": angle, "linear": v, "angular": w, "quaternion_xyzw": quaternion, "translation": translation,
            "log_linear": doubles(log_v), "log_angular": doubles(log_w),
            "distance_from_identity_alpha_0.25_beta_4": float(distance)}


def planar_case(omega, sigma):
    v = vector(2, 10.0 ** rng.choice([-6, 0, 0, 3]))
    z = mpc(sigma, omega)
    t_exact = phi(z) * mpc(*v)
    translation = doubles([t_exact.real, t_exact.imag])
    cos_sin = doubles([cos(mpf(omega)), sin(mpf(omega))])
    scale = float(exp(mpf(sigma)))
    log_z = mpc(log(mpf(scale)), atan2(mpf(cos_sin[1]), mpf(cos_sin[0])))
    log_v = mpc(*translation) / phi(log_z)
    return {"linear": v, "angular": omega, "scaling": sigma, "translation": translation, "cos_sin": cos_sin, "scale": scale,
            "log_linear": doubles([log_v.real, log_v.imag]), "log_angular": float(log_z.imag), "log_scaling": float(log_z.real)}


spatial = [spatial_case(angle) for angle in ANGLES for _ in range(3)]
signed = [s * a for a in ANGLES for s in ((1, -1) if a else (1,))]
planar = [planar_case(omega, 0.0) for omega in signed for _ in range(2)]
similar = [planar_case(omega, sigma) for omega in signed
           for sigma in (1e-300, 1e-12, -1e-5, 0.7, -3.0)]


def lines(cases):
    return "[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]"


path = pathlib.Path(__file__).with_name("groups_golden.json")
path.write_text('{"meta": %s,\n"spatial": %s,\n"planar": %s,\n"similar": %s}\n' % (
    json.dumps(__doc__.strip().splitlines()[0]), lines(spatial), lines(planar), lines(similar)))
