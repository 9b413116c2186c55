"""Orders, and their agreement with the command."""

import json

import numpy as np
import pytest
from conftest import RECORDINGS, SHAPES, helix_poses

import reorder


def agree(mine, theirs, path="$"):
    """The same JSON, numbers to a rounding: quaternions of a table are normalised, those of an array may be already."""
    if isinstance(theirs, dict):
        assert mine.keys() == theirs.keys(), path
        for key, value in theirs.items():
            agree(mine[key], value, f"{path}.{key}")
    elif isinstance(theirs, list):
        assert len(mine) == len(theirs), path
        for k, value in enumerate(theirs):
            agree(mine[k], value, f"{path}[{k}]")
    elif isinstance(theirs, float):
        # Beyond 1e6 a reach is that of a line that is straight but for rounding.
        assert mine == pytest.approx(theirs, rel=1e-6) or min(mine, theirs) > 1e6, path
    else:
        assert mine == theirs, path


@pytest.mark.parametrize("shape", SHAPES)
def test_recorded_shapes_have_the_order_of_the_command(shape, command):
    bag = RECORDINGS / shape
    (recorded,) = reorder.read_poses(bag)
    truth = json.loads((RECORDINGS / f"{shape}.truth.json").read_text())
    found = reorder.order(recorded.poses, edges=True)
    assert json.loads(found.to_json()) == json.loads(command("order", bag, "--edges"))
    assert len(found) == len(recorded) and found.verdict in ("certified", "plausible", "ambiguous")
    assert sorted(found.order) == list(range(len(found))), truth.keys()


def test_every_option_is_the_commands(tmp_path, command):
    poses, _ = helix_poses(30)
    # Two curves, a dwell, and some noise, without which rounding would decide between equal distances.
    poses = np.vstack([poses, poses[:2], poses[:12] + [9, 0, 0, 0, 0, 0, 0]])
    poses = reorder.SE3().exp(poses, 1e-3 * np.random.default_rng(2).normal(size=(len(poses), 6)))
    poses[30:32] = poses[:2]
    table = tmp_path / "poses.csv"
    np.savetxt(table, poses, delimiter=",", header="x,y,z,qx,qy,qz,qw", comments="", fmt="%.17g")
    cases = [
        ({}, []),
        ({"metres_per_radian": 0.2}, ["--metres-per-radian", "0.2"]),
        ({"method": "nn-crust"}, ["--method", "nn-crust"]),
        ({"method": "nearest", "start": 4}, ["--method", "nearest", "--start", "4"]),
        ({"topology": "closed"}, ["--topology", "closed"]),
        ({"components": "auto"}, ["--components", "auto"]),
        ({"denoise": True}, ["--denoise"]),
        ({"method": "nearest", "start_at": poses[7]}, ["--start-at", ",".join(f"{x:.17g}" for x in poses[7])]),
    ]
    cases[-1][1].extend(["--method", "nearest"])
    answers = set()
    for options, arguments in cases:
        found = reorder.order(poses, "se3", repair="off", **options)
        agree(json.loads(found.to_json()), json.loads(command("order", table, "--repair", "off", *arguments)))
        answers.add(found.to_json())
    assert len(answers) == len(cases), "every option makes a difference"
    with pytest.raises(reorder.ReorderError, match="repair: unknown variant `never`"):
        reorder.order(poses, repair="never")


def test_every_manifold_is_ordered(command, tmp_path):
    t = np.linspace(0, 2.5, 40)
    rows = np.random.default_rng(5).permutation(40)
    circle = np.column_stack([np.cos(t), np.sin(t)])
    quaternions = np.column_stack([np.sin(t / 2), 0 * t, 0 * t, np.cos(t / 2)])
    cases = {
        "r2": (circle, "x,y"),
        "r4": (np.column_stack([circle, t, t**2]), "a,b,c,d"),
        "s2": (np.degrees(np.column_stack([0.3 * t, t])), "lat,lon"),
        "so3": (quaternions, "qx,qy,qz,qw"),
        "se2": (np.column_stack([circle, t]), "x,y,theta"),
        "se3": (reorder.poses(np.column_stack([circle, t]), quaternions), "x,y,z,qx,qy,qz,qw"),
        "sim2": (np.column_stack([circle, t, np.exp(0.2 * t)]), "x,y,theta,scale"),
    }
    for name, (points, header) in cases.items():
        table = tmp_path / f"{name}.csv"
        np.savetxt(table, points[rows], delimiter=",", header=header, comments="", fmt="%.17g")
        given = reorder.directions(points[rows]) if name == "s2" else points[rows]
        found = reorder.order(given, name)
        along = rows[found.order]
        assert (np.abs(np.diff(along)) == 1).all(), name
        named = ["--manifold", "rn"] if name == "r4" else []
        agree(json.loads(found.to_json()), json.loads(command("order", table, *named)))


def test_a_manifold_brings_its_own_weight():
    poses, _ = helix_poses(30)
    assert reorder.order(poses, reorder.SE3(0.25)).metres_per_radian == 0.25
    assert reorder.order(poses, reorder.SE3(0.25), metres_per_radian=0.5).metres_per_radian == 0.5
    assert reorder.order(poses).metres_per_radian == reorder.order(poses, metres_per_radian="auto").metres_per_radian


def test_dwells_and_doubts_are_typed():
    poses, rows = helix_poses(30)
    found = reorder.order(np.vstack([poses, poses[4:6]]))
    assert [group.tolist() for group in found.duplicates] == [[4, 30], [5, 31]]
    assert len(found.distinct) == 30 and found.order.dtype == np.int64
    assert (np.abs(np.diff(rows[found.distinct])) == 1).all()
    assert isinstance(found.certificate, reorder.Certificate) and found.certificate.distinct == 30
    few = reorder.order(poses[:5])
    assert few.verdict == "ambiguous" and isinstance(few.doubts[0], reorder.Doubt) and few.doubts[0].why
    with pytest.raises(AttributeError):
        few.verdict = "certified"


@pytest.mark.parametrize(
    ("points", "manifold", "options", "sentence"),
    [
        ([[0.0, 0.0]], "r2", {}, "there is 1 point to order, but at least"),
        ([[0, 0], [1, np.nan], [2, 0]], "r2", {}, "point 1 has a coordinate that is not a finite number"),
        ([[0, 0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 0]], "se3", {}, "point 1: the quaternion is zero"),
        ([[0, 0, 0, 0, 0, 0, 2]], "se3", {}, "point 0: the quaternion has norm 2.000000 instead of 1"),
        ([[0, 0, 0, -1.0]], "sim2", {}, "point 0: scale is not positive: -1"),
        ([[1, 2, 3.0]], "r2", {}, r"points has shape \(1, 3\), but its last axis must hold the 2 numbers"),
        ([1.0, 2.0], "r2", {}, r"points has shape \(2,\), but \(n, 2\) is needed"),
        ([[0.0, 0.0]] * 3, "r2", {"method": "magic"}, "method: unknown variant `magic`"),
        ([[0.0, 0.0]] * 3, "r2", {"metres_per_radian": 0.1}, "these points do not have both"),
        ([[0.0, 0.0, 0.0]] * 3, "se2", {"metres_per_radian": -1.0}, "metres_per_radian is -1"),
        ([[0.0, 0.0]] * 3, "r9", {}, "there is no manifold \"r9\""),
        ([[0.0, 0.0], [1, 0], [2, 0]], "r2", {"start": 1}, "the start 1 is not an end of the open curve"),
        ([[0.0, 0.0], [1, 0], [2, 0]], "r2", {"start_at": [[0.0, 0.0]]}, r"start_at has shape \(1, 2\)"),
    ],
)
def test_what_has_no_order_is_refused_in_the_words_of_the_libraries(points, manifold, options, sentence):
    with pytest.raises(reorder.ReorderError, match=sentence) as raised:
        reorder.order(points, manifold, **options)
    assert isinstance(raised.value, ValueError)
