"""The tables of 60 and 100 digits that the Rust tests read, through Python, with the bounds that they have there."""

import json

import numpy as np
import pytest
from conftest import REPOSITORY

import reorder

TABLES = REPOSITORY / "crates" / "se3-geom" / "tests" / "data"
# As in crates/se3-geom/tests/golden.rs.
SPATIAL, PLANAR = 4e-15, 1e-14


@pytest.fixture(scope="module")
def groups():
    return json.loads((TABLES / "groups_golden.json").read_text())


def column(cases, key):
    return np.array([case[key] for case in cases])


def assert_close(got, expected, bound):
    """‖got − expected‖ ≤ bound · ‖expected‖ row by row, scaled so that 1e-300 is a number like any other."""
    expected = np.asarray(expected)
    scale = np.maximum(np.abs(expected).max(axis=-1, keepdims=True), np.finfo(float).tiny)
    error = np.linalg.norm((got - expected) / scale, axis=-1)
    limit = bound * np.linalg.norm(expected / scale, axis=-1)
    worst = int(np.argmax(error - limit))
    assert (error <= limit).all(), (worst, got[worst], expected[worst])


def test_rotations_and_poses(groups):
    cases = groups["spatial"]
    assert len(cases) == 153
    twists = np.hstack([column(cases, "linear"), column(cases, "angular")])
    quaternions, translations = column(cases, "quaternion_xyzw"), column(cases, "translation")
    home, poses = [0, 0, 0, 0, 0, 0, 1], reorder.poses(translations, quaternions)
    se3, so3 = reorder.SE3(0.25), reorder.SO3()

    exp = se3.group_exp(twists)
    assert_close(exp[:, 3:], quaternions, SPATIAL)
    assert_close(exp[:, :3], translations, SPATIAL)
    assert_close(so3.exp(home[3:], twists[:, 3:]), quaternions, SPATIAL)
    log = se3.group_log(poses)
    assert_close(log[:, 3:], column(cases, "log_angular"), SPATIAL)
    assert_close(log[:, :3], column(cases, "log_linear"), SPATIAL)
    # α = 0.25 and β = 4 are a radian of 0.25 m, in half metres.
    distances = column(cases, "distance_from_identity_alpha_0.25_beta_4")
    assert_close(2 * se3.distance(home, poses)[:, None], distances[:, None], SPATIAL)
    half_turn = np.abs(quaternions[:, 3]) < np.finfo(float).eps
    assert half_turn.sum() == 2
    assert_close(so3.log(home[3:], quaternions[~half_turn]), column(cases, "log_angular")[~half_turn], SPATIAL)
    for quaternion in quaternions[half_turn]:
        with pytest.raises(reorder.GeometryError, match="row 0: no unique shortest geodesic .* cut locus"):
            so3.log(home[3:], quaternion)


def test_planar_motions(groups):
    cases = groups["planar"]
    assert len(cases) == 202
    cos_sin, translations = column(cases, "cos_sin"), column(cases, "translation")
    exp = reorder.SE2().group_exp(np.hstack([column(cases, "linear"), column(cases, "angular")[:, None]]))
    assert_close(np.column_stack([np.cos(exp[:, 2]), np.sin(exp[:, 2])]), cos_sin, PLANAR)
    assert_close(exp[:, :2], translations, PLANAR)
    log = reorder.SE2().group_log(exp)
    assert np.allclose(np.exp(1j * log[:, 2]), cos_sin @ [1, 1j], rtol=0, atol=PLANAR)


def test_directions():
    cases = json.loads((TABLES / "sphere_golden.json").read_text())["cases"]
    base, tangents = column(cases, "base"), column(cases, "tangent")
    sphere = reorder.S2()
    assert len(cases) > 50
    assert_close(sphere.exp(base, tangents), column(cases, "exp"), PLANAR)
    at, distances = column(cases, "exp"), column(cases, "distance")
    assert_close(sphere.distance(base, at)[:, None], distances[:, None], PLANAR)
    unique = distances < np.pi - 1e-15
    assert_close(sphere.log(base[unique], at[unique]), column(cases, "log")[unique], PLANAR)
