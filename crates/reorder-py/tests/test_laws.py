"""The laws that every manifold obeys, through arrays. Coordinates are of order 1, so that 1e-12 is some thousand roundings."""

import numpy as np
import pytest
from conftest import GROUPS, MANIFOLDS, close_points, random_points, random_tangents

N = 200
TOLERANCE = 1e-12


def test_log_undoes_exp(name):
    m, p = MANIFOLDS[name], random_points(name, N, 1)
    # Below half a turn, so that the way is the shortest: √3 · 1.7 < π.
    v = random_tangents(name, p, 2, 1.7)
    assert np.allclose(m.log(p, m.exp(p, v)), v, rtol=0, atol=1e-11)


def test_exp_undoes_log(name):
    m, p, q = MANIFOLDS[name], random_points(name, N, 3), random_points(name, N, 4)
    assert close_points(name, m.exp(p, m.log(p, q)), q, 1e-11)


def test_the_norm_of_log_is_the_distance(name):
    m, p, q = MANIFOLDS[name], random_points(name, N, 5), random_points(name, N, 6)
    assert np.allclose(m.norm(p, m.log(p, q)), m.distance(p, q), rtol=TOLERANCE)
    assert (m.distance(p, q) > 0).all()


def test_distances_are_symmetric_and_vanish_at_home(name):
    m, p, q = MANIFOLDS[name], random_points(name, N, 7), random_points(name, N, 8)
    assert np.allclose(m.distance(p, q), m.distance(q, p), rtol=TOLERANCE)
    assert np.allclose(m.distance(p, p), 0.0, atol=1e-15 * N)


def test_no_way_round_is_shorter(name):
    m, (p, q, r) = MANIFOLDS[name], (random_points(name, N, seed) for seed in (9, 10, 11))
    assert (m.distance(p, r) <= m.distance(p, q) + m.distance(q, r) + TOLERANCE).all()


def test_geodesics_have_even_speed(name):
    m, p, q = MANIFOLDS[name], random_points(name, N, 12), random_points(name, N, 13)
    assert np.allclose(m.distance(p, m.geodesic(p, q, 0.25)), 0.25 * m.distance(p, q), rtol=1e-10)
    along = m.geodesic(p[0], q[0], np.linspace(0, 1, 5))
    assert np.allclose(m.distance(p[0], along), np.linspace(0, 1, 5) * m.distance(p[0], q[0]), atol=TOLERANCE)


def test_the_metric_is_left_invariant(group):
    m, (g, p, q) = GROUPS[group], (random_points(group, N, seed) for seed in (14, 15, 16))
    if group == "sim2":
        g[:, 3] = 1.0  # Of similarities only the rigid motions keep distances.
    assert np.allclose(m.distance(m.compose(g, p), m.compose(g, q)), m.distance(p, q), rtol=1e-11)
    # The screw norm would not be; and another frame of the tool does change it.
    if group == "se3":
        assert not np.allclose(m.distance(m.compose(p, g), m.compose(q, g)), m.distance(p, q), rtol=1e-3)


def test_groups_are_groups(group):
    m, (a, b, c) = GROUPS[group], (random_points(group, N, seed) for seed in (17, 18, 19))
    assert close_points(group, m.compose(m.compose(a, b), c), m.compose(a, m.compose(b, c)), 1e-10)
    assert close_points(group, m.compose(m.inverse(a), m.compose(a, b)), b, 1e-10)
    assert close_points(group, m.group_exp(m.group_log(a)), a, 1e-10)


def test_a_single_row_goes_with_all(name):
    m, p, q = MANIFOLDS[name], random_points(name, N, 20), random_points(name, N, 21)
    every = np.broadcast_to(p[0], q.shape)
    assert np.array_equal(m.distance(p[0], q), m.distance(every, q))
    assert np.array_equal(m.log(q, p[0]), m.log(q, every))
    assert m.distance(p[0], q[0]).shape == ()
    assert m.exp(p.reshape(10, 20, -1), m.log(p, q).reshape(10, 20, -1)).shape == (10, 20, m.point_size)


@pytest.mark.parametrize("metres_per_radian", [0.01, 1.0, 50.0])
def test_the_weight_weighs(metres_per_radian):
    import reorder

    turned = [0, 0, 0, 0, 0, np.sin(0.25), np.cos(0.25)]
    home = [0, 0, 0, 0, 0, 0, 1]
    assert np.isclose(reorder.SE3(metres_per_radian).distance(home, turned), 0.5 * metres_per_radian)
    assert np.isclose(reorder.SE2(metres_per_radian).distance([0, 0, 0], [0, 0, 0.5]), 0.5 * metres_per_radian)
