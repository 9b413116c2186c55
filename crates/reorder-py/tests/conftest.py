"""What the tests share: seeded points of every manifold, the command ``reorder``, recordings."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import reorder

REPOSITORY = Path(__file__).resolve().parents[3]
RECORDINGS = REPOSITORY / "tests" / "data"
SHAPES = ["lasa_angle", "lasa_gshape", "lasa_sine", "lasa_zshape"]

MANIFOLDS = {
    "r1": reorder.Rn(1),
    "r3": reorder.Rn(3),
    "r8": reorder.Rn(8),
    "s2": reorder.S2(),
    "so3": reorder.SO3(),
    "se2": reorder.SE2(0.7),
    "se3": reorder.SE3(0.3),
    "sim2": reorder.Sim2(2.0),
}
GROUPS = {name: MANIFOLDS[name] for name in ("so3", "se2", "se3", "sim2")}


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_points(name, n, seed):
    """Points of a manifold, anywhere on it."""
    rng = np.random.default_rng(seed)
    flat = rng.normal(size=(n, 8))
    angle = rng.uniform(-3, 3, size=(n, 1))
    if name == "s2":
        return unit(flat[:, :3])
    if name == "so3":
        return unit(flat[:, :4])
    if name == "se2":
        return np.hstack([flat[:, :2], angle])
    if name == "se3":
        return np.hstack([flat[:, :3], unit(flat[:, 3:7])])
    if name == "sim2":
        return np.hstack([flat[:, :2], angle, np.exp(flat[:, 3:4])])
    return flat[:, : MANIFOLDS[name].point_size]


def random_tangents(name, p, seed, length):
    """Tangents at p that are not longer than that, per coordinate."""
    rng = np.random.default_rng(seed)
    v = rng.uniform(-length, length, size=(len(p), MANIFOLDS[name].tangent_size))
    return v - p * np.sum(v * p, axis=1, keepdims=True) if name == "s2" else v


def close_points(name, p, q, tolerance):
    """Whether points agree: quaternions up to their sign, angles up to full turns."""
    p, q = np.array(p), np.array(q)
    quaternions = {"so3": slice(0, 4), "se3": slice(3, 7)}.get(name)
    if quaternions is not None:
        sign = np.sign(np.sum(p[..., quaternions] * q[..., quaternions], axis=-1, keepdims=True))
        q[..., quaternions] *= sign
    if name in ("se2", "sim2"):
        turned = p[..., 2] - q[..., 2]
        q[..., 2] = p[..., 2] - np.arctan2(np.sin(turned), np.cos(turned))
    return np.allclose(p, q, rtol=tolerance, atol=tolerance)


@pytest.fixture(params=sorted(MANIFOLDS))
def name(request):
    return request.param


@pytest.fixture(params=sorted(GROUPS))
def group(request):
    return request.param


@pytest.fixture(scope="session")
def command():
    """Runs the command ``reorder`` of the same sources and returns what it prints."""
    program = os.environ["REORDER_COMMAND"]

    def run(*arguments):
        ended = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
        assert ended.returncode == 0, ended.stderr
        return ended.stdout

    return run


def helix_poses(n, seed=3):
    """Poses of a smooth curve without its ends near each other, in random order, and that order."""
    t = np.linspace(0.0, 4.0, n)
    positions = 0.3 * np.column_stack([np.cos(t), np.sin(t), 0.5 * t])
    half = 0.15 * t
    quaternions = np.column_stack([0 * t, np.sin(half), 0 * t, np.cos(half)])
    rows = np.random.default_rng(seed).permutation(n)
    return reorder.poses(positions, quaternions)[rows], rows
