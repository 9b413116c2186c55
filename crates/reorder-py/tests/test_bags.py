"""Poses in files."""

import numpy as np
import pytest
from conftest import RECORDINGS, REPOSITORY, helix_poses

import reorder


def test_a_bag_is_read():
    (recorded,) = reorder.read_poses(RECORDINGS / "lasa_sine")
    assert recorded.poses.shape == (len(recorded), 7) and recorded.poses.dtype == np.float64
    assert np.allclose(np.linalg.norm(recorded.poses[:, 3:], axis=1), 1)
    assert recorded.file.endswith("lasa_sine.mcap") and recorded.topic.startswith("/") and recorded.message == 0
    assert recorded.frame_id


@pytest.mark.parametrize("name", ["one.mcap", "folder"])
def test_what_is_written_is_read_to_the_last_bit(tmp_path, name):
    poses, _ = helix_poses(20)
    (again,) = [read.poses for read in _round_trip(tmp_path / name, poses)]
    # The first reading normalises, the second finds nothing to do but for an ε.
    assert np.allclose(again, poses, rtol=0, atol=2.3e-16)
    stamps = 1_700_000_000_000_000_000 + 1000 * np.arange(20)
    reorder.write_poses(tmp_path / "stamped.mcap", poses, topic="/tool", frame_id="base", stamps_ns=stamps)
    (stamped,) = reorder.read_poses(tmp_path / "stamped.mcap", "/tool")
    assert np.array_equal(stamped.stamps_ns, stamps) and stamped.frame_id == "base" and stamped.message is None
    halves = reorder.read_poses(tmp_path / "stamped.mcap", window_s=1e-5)
    assert [len(half) for half in halves] == [10, 10] or sum(map(len, halves)) == 20 and len(halves) == 2


def _round_trip(path, poses):
    reorder.write_poses(path, poses, frame_id="base")
    return reorder.read_poses(path)


@pytest.mark.parametrize("topic", ["/scan", "/tool"])
def test_mcap_and_sqlite_hold_the_same(topic):
    bags = REPOSITORY / "crates" / "pose-bag" / "tests" / "data"
    one, other = (reorder.read_poses(bags / name, topic) for name in ("rosbags_none", "rosbags_sqlite3_none"))
    assert len(one) == len(other) > 0 and all(np.array_equal(a.poses, b.poses) for a, b in zip(one, other))


def test_damage_is_refused_or_told(tmp_path):
    poses, _ = helix_poses(2000)
    path = tmp_path / "whole.mcap"
    reorder.write_poses(path, poses, stamps_ns=np.arange(2000))
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:-2000])
    with pytest.raises(reorder.BagError, match=r"cut\.mcap is cut off"):
        reorder.read_poses(cut)
    with pytest.warns(UserWarning, match=r"cut\.mcap is cut off.*; what is whole was taken"):
        (rest,) = reorder.read_poses(cut, damaged=True)
    assert 0 < len(rest) <= 2000


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda folder: reorder.read_poses(folder / "none.mcap"), r"none\.mcap: No such file"),
        (lambda folder: reorder.read_poses(RECORDINGS / "lasa_sine", "/nowhere"), "has no poses on topic /nowhere"),
        (lambda folder: reorder.write_poses(folder / "a.mcap", [[0.0] * 7]), "pose 0: the quaternion is zero"),
        (lambda folder: reorder.write_poses(folder / "a.mcap", [[0, 0, 0, 0, 0, 0, 1.0]], stamps_ns=[1, 2]), "2 stamps_ns for 1 poses"),
        (lambda folder: reorder.read_poses(RECORDINGS / "lasa_sine", window_s=1.0, gap_s=1.0), "by window or by gap"),
        (lambda folder: reorder.read_poses(RECORDINGS / "lasa_sine", window_s=-1.0), "-1 is no positive time"),
    ],
)
def test_what_cannot_be_read_or_written_is_named(tmp_path, call, sentence):
    with pytest.raises(reorder.ReorderError, match=sentence):
        call(tmp_path)
    assert not list(tmp_path.iterdir())
