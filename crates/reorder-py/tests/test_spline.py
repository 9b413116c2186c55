"""The spline through poses, against derivatives by differences and scipy's cubic spline."""

import numpy as np
import pytest
from conftest import helix_poses
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import reorder


def ordered(n=25):
    poses, rows = helix_poses(n)
    return poses[np.argsort(rows)], np.linspace(0.0, 3.0, n)


def test_it_passes_every_pose_at_its_time():
    poses, times = ordered()
    spline = reorder.fit(poses, times)
    # Positions are evaluated as polynomials of size 1, quaternions as products of three.
    assert np.allclose(spline.pose(times), poses, rtol=0, atol=1e-14)
    assert np.array_equal(spline.knots, times) and spline.domain == (0.0, 3.0) and not spline.is_closed


def test_positions_are_scipys_cubic_spline():
    poses, times = ordered()
    spline, scipys = reorder.fit(poses, times), CubicSpline(times, poses[:, :3], bc_type="natural")
    t = np.linspace(0, 3, 301)
    assert np.allclose(spline.pose(t)[:, :3], scipys(t), rtol=0, atol=1e-13)
    in_world = reorder.rotations(spline.pose(t))
    assert np.allclose(in_world.apply(spline.twist(t)[:, :3]), scipys(t, 1), rtol=0, atol=1e-12)
    assert np.allclose(in_world.apply(spline.acceleration(t)[:, :3]), scipys(t, 2), rtol=0, atol=1e-11)


def test_derivatives_are_those_of_the_curve():
    poses, times = ordered()
    spline, t = reorder.fit(poses, times), np.linspace(0.01, 2.99, 97)
    h = 1e-5
    # Central differences: h² of the third derivative, and rounding of size ε/h, are both near 1e-10.
    before, after = Rotation.from_quat(spline.pose(t - h)[:, 3:]), Rotation.from_quat(spline.pose(t + h)[:, 3:])
    rate = (before.inv() * after).as_rotvec() / (2 * h)
    assert np.allclose(spline.twist(t)[:, 3:], rate, rtol=0, atol=1e-8)
    difference = (spline.twist(t + h) - spline.twist(t - h))[:, 3:] / (2 * h)
    assert np.allclose(spline.acceleration(t)[:, 3:], difference, rtol=0, atol=1e-5)
    difference = (spline.acceleration(t + h) - spline.acceleration(t - h))[:, 3:] / (2 * h)
    inside = np.abs(t[:, None] - times).min(axis=1) > 2 * h
    assert inside.sum() > 50 and np.allclose(spline.jerk(t)[inside, 3:], difference[inside], rtol=0, atol=1e-4)


def test_all_at_once_is_each_by_itself():
    poses, times = ordered()
    spline, t = reorder.fit(poses, times), np.random.default_rng(1).uniform(-1, 4, size=(6, 50))
    pose, twist, acceleration = spline.at(t)
    assert pose.shape == (6, 50, 7) and twist.shape == acceleration.shape == (6, 50, 6)
    assert np.array_equal(pose, spline.pose(t)) and np.array_equal(twist, spline.twist(t))
    assert np.array_equal(acceleration, spline.acceleration(t))
    assert np.array_equal(pose[2, 3], spline.pose(t[2, 3])) and spline.pose(0.5).shape == (7,)


def test_ends_are_natural_clamped_or_periodic():
    poses, times = ordered()
    assert np.allclose(reorder.fit(poses, times).acceleration([0.0, 3.0]), 0, atol=1e-11)
    twists = np.array([[0.1, 0, 0, 0, 0, 0.2], [0, 0.3, 0, 0.1, 0, 0]])
    clamped = reorder.fit(poses, times, ends=(twists[0], twists[1]))
    assert np.allclose(clamped.twist([0.0, 3.0]), twists, atol=1e-12)
    t = np.linspace(0, 2 * np.pi, 13)[:-1]
    loop = reorder.poses(np.column_stack([np.cos(t), np.sin(t), 0 * t]), Rotation.from_rotvec(t[:, None] * [0, 0, 1]))
    closed = reorder.fit(loop, ends="periodic", metres_per_radian=0.5)
    first, last = closed.domain
    assert closed.is_closed and len(closed.knots) == 13
    assert np.allclose(closed.twist(first), closed.twist(np.nextafter(last, first)), atol=1e-11)


def test_scipys_rotations_are_taken_and_given():
    poses, times = ordered()
    rotations, so3 = Rotation.from_quat(poses[:, 3:]), reorder.SO3()
    moved = so3.exp(rotations, [0.0, 0.0, 0.1])
    assert isinstance(moved, Rotation)
    assert np.allclose((rotations.inv() * moved).as_rotvec(), [0, 0, 0.1])
    assert np.allclose(so3.log(rotations[0], rotations[3]), (rotations[0].inv() * rotations[3]).as_rotvec())
    assert np.array_equal(reorder.order(rotations, "so3").order, reorder.order(poses[:, 3:], "so3").order)
    assert np.allclose(reorder.poses(poses[:, :3], rotations), poses)
    assert isinstance(so3.geodesic(rotations[0], rotations[1], [0.2, 0.4]), Rotation)


def test_scipys_rigid_transforms_are_taken():
    transform = pytest.importorskip("scipy.spatial.transform").RigidTransform
    poses, times = ordered()
    transforms = transform.from_components(poses[:, :3], Rotation.from_quat(poses[:, 3:]))
    assert np.allclose(reorder.fit(transforms, times).pose(0.7), reorder.fit(poses, times).pose(0.7), atol=1e-14)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"times": [0.0, 1.0]}, "25 knots belong to these points, 2 given"),
        ({"times": np.zeros(25)}, r"knot 1 \(0\) does not come after the one before"),
        ({"ends": "loose"}, 'ends: "loose" is neither'),
        ({"ends": ([0.0] * 6, [0.0] * 5)}, r"the second of ends has shape \(5,\)"),
        ({"metres_per_radian": 0.0}, "metres_per_radian is 0, but must be"),
    ],
)
def test_what_has_no_spline_is_refused(change, sentence):
    poses, times = ordered()
    with pytest.raises(reorder.ReorderError, match=sentence):
        reorder.fit(poses, **{"times": times, **change})


def test_half_a_turn_is_refused_by_name():
    poses = reorder.poses(np.eye(3), [[0, 0, 0, 1], [0, 0, 1, 0], [0, 0, 1, 0.1] / np.sqrt(1.01)])
    with pytest.raises(reorder.SplineError, match="poses 0 and 1 are half a turn apart"):
        reorder.fit(poses, [0.0, 1.0, 2.0])
    with pytest.raises(reorder.ReorderError, match="t holds NaN at place 1"):
        reorder.fit(poses[1:], [0.0, 1.0]).pose([0.0, np.nan])
