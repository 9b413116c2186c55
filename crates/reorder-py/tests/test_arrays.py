"""Nothing is copied that lies right, and other threads run meanwhile."""

import pickle
import threading
import time
import tracemalloc

import numpy as np
import pytest
from conftest import RECORDINGS, helix_poses, random_points

import reorder

MIB = 1 << 20


def peak_of(call):
    """Greatest memory that numpy holds in a call beyond what it held before; Rust's own is not counted."""
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_contiguous_arrays_are_not_copied():
    points = random_points("se3", 200_000, 1)
    se3, size = reorder.SE3(), points.nbytes
    assert peak_of(lambda: se3.distance(points, points[::-1].copy()[0])) < size + MIB  # The copy here is ours.
    assert peak_of(lambda: se3.distance(points, points)) < MIB
    assert peak_of(lambda: reorder.Rn(7).exp(points, points)) < MIB
    columns = np.asfortranarray(points)
    assert peak_of(lambda: se3.distance(columns, points)) >= size, "else nothing was measured"


def test_results_are_handed_over():
    points = random_points("se3", 1000, 2)
    for made in (reorder.SE3().distance(points, points), reorder.SE3().log(points, points[::-1])):
        assert not made.flags.owndata and made.flags.writeable and made.flags.c_contiguous


@pytest.mark.parametrize("change", [np.asfortranarray, lambda p: p[:, ::-1][:, ::-1], np.ndarray.tolist, lambda p: p.astype(">f8")])
def test_whatever_makes_an_array_will_do(change):
    points = random_points("se3", 50, 3)
    assert np.array_equal(reorder.SE3().log(change(points), points[0]), reorder.SE3().log(points, points[0]))
    single = reorder.SE3().distance(points.astype(np.float32), points[0])
    assert np.allclose(single, reorder.SE3().distance(points, points[0]), atol=1e-5)


def test_arrays_that_do_not_go_together_are_refused():
    points = random_points("se3", 6, 4)
    with pytest.raises(reorder.ReorderError, match=r"p has \(2, 3\) rows and q has \(6,\): they must agree"):
        reorder.SE3().distance(points.reshape(2, 3, 7), points)
    with pytest.raises(TypeError, match="p is no array of numbers"):
        reorder.SE3().distance("pose", points)
    with pytest.raises(reorder.ReorderError, match="r3 is used as no group"):
        reorder.Rn(3).inverse([0.0, 0, 0])
    with pytest.raises(reorder.GeometryError, match="row 2: the quaternion is zero"):
        bad = points.copy()
        bad[2, 3:] = 0
        reorder.SE3().distance(points, bad)


def test_manifolds_are_values():
    assert reorder.SE3(0.5) == reorder.Manifold("se3", 0.5) != reorder.SE3(0.4)
    assert pickle.loads(pickle.dumps(reorder.SE2(0.3))) == reorder.SE2(0.3)
    assert repr(reorder.SE3(0.5)) == 'Manifold("se3", metres_per_radian=0.5)'
    assert reorder.SE3(0.5).injectivity_radius == 0.5 * np.pi and reorder.Rn(2).injectivity_radius == np.inf


def longest_wait_during(call):
    """The longest time that this thread does not get to run while another is in a call, as a share of the call."""
    span = []

    def work():
        begin = time.perf_counter()
        call()
        span.extend([begin, time.perf_counter()])

    thread, ticks = threading.Thread(target=work), []
    thread.start()
    while thread.is_alive():
        ticks.append(time.perf_counter())
        time.sleep(1e-3)
    thread.join()
    begin, end = span
    return max(np.diff([begin, *(tick for tick in ticks if begin < tick < end), end])) / (end - begin)


def test_other_threads_run_during_every_long_call():
    many, rows = helix_poses(60_000)
    ordered = many[np.argsort(rows)]
    t = np.linspace(0, 4, 400_000)
    spline = reorder.fit(ordered[::100], np.linspace(0, 4, 600))
    (recorded,) = reorder.read_poses(RECORDINGS / "lasa_sine")
    calls = {
        "order": lambda: reorder.order(many, metres_per_radian=0.1),
        "fit": lambda: reorder.fit(ordered, np.linspace(0, 4, len(ordered))),
        "at": lambda: spline.at(t),
        "log": lambda: reorder.SE3().log(np.repeat(many, 10, axis=0), many[0]),
        "plan": lambda: reorder.plan(recorded.poses, "ur5e"),
    }
    for name, call in calls.items():
        assert longest_wait_during(call) < 0.5, name
    numbers = np.random.default_rng(1).random(400_000).tolist()
    assert longest_wait_during(lambda: sorted(numbers)) > 0.5, "a call that keeps the interpreter shows"
