"""Plans, and their agreement with the command."""

import json

import numpy as np
import pytest
from conftest import RECORDINGS, REPOSITORY, helix_poses

import reorder

BAG = RECORDINGS / "lasa_sine"


@pytest.fixture(scope="module")
def planned():
    (recorded,) = reorder.read_poses(BAG)
    return recorded, reorder.plan(recorded.poses, "ur5e", frame_id=recorded.frame_id)


def test_it_is_the_commands_plan(planned, command, tmp_path):
    recorded, plan = planned
    command("plan", BAG, "--robot", "ur5e", "-o", tmp_path / "plan.csv", "--report", tmp_path / "report.json")
    theirs = json.loads((tmp_path / "report.json").read_text())
    rows = np.loadtxt(tmp_path / "plan.csv", delimiter=",", skiprows=1)
    assert np.array_equal(plan.ordering.order, theirs["order"])
    assert plan.ordering.verdict == theirs["verdict"] and plan.audit.keys() == theirs["plan"]["audit"].keys()
    # Quaternions are normalised once more on their way through an array; an optimiser of 1e-8 stands in between.
    trajectory = plan.trajectory
    mine = np.column_stack([trajectory.times, trajectory.positions, trajectory.velocities, trajectory.accelerations])
    assert mine.shape == rows.shape and np.allclose(mine, rows, rtol=0, atol=1e-5)
    assert len(trajectory) == len(rows) and trajectory.joint_names[0] == "shoulder_pan_joint"
    assert np.allclose(plan.pose_times_s, theirs["plan"]["pose_times_s"], atol=1e-5)


def test_it_is_audited_and_passes_its_poses(planned):
    recorded, plan = planned
    assert plan.audit["limits_ok"] and max(plan.audit["max_ratio"][k] for k in ("velocity", "acceleration", "jerk")) <= 1
    trajectory = plan.trajectory
    position, velocity, acceleration, jerk = trajectory.at(trajectory.times)
    assert np.allclose(position, trajectory.positions, atol=1e-12) and jerk.shape == position.shape
    assert not trajectory.velocities[[0, -1]].any() and not trajectory.accelerations[[0, -1]].any()
    assert trajectory.at(0.1)[0].shape == (6,) and trajectory.duration_s == trajectory.times[-1]
    along = plan.spline.pose(plan.spline.knots)
    assert np.allclose(along[:, :3], recorded.poses[plan.ordering.distinct, :3], atol=1e-12)


def test_it_starts_where_the_robot_stands(planned):
    recorded, _ = planned
    stands = [-1.57, -1.57, 1.57, -1.57, -1.57, 0.0]
    plan = reorder.plan(recorded.poses, "ur5e", start=stands, config={"timing": {"rate_hz": 50}})
    assert np.array_equal(plan.trajectory.positions[0], stands) and plan.report["plan"]["approach_s"] > 0
    # The last step ends at the end, so that steps are a little shorter.
    assert 0.019 < np.median(np.diff(plan.trajectory.times)) <= 0.02


def test_a_robot_from_files_is_the_shipped_one(planned):
    recorded, plan = planned
    robots = REPOSITORY / "config" / "robots"
    same = reorder.plan(recorded.poses, robots / "ur5e.urdf", limits=robots / "ur5e.yaml")
    assert np.allclose(same.trajectory.positions, plan.trajectory.positions, atol=1e-9)


def test_refusals_say_why(planned):
    recorded, _ = planned
    far, _ = helix_poses(15)
    with pytest.raises(reorder.Refusal, match="^ur5e: .*reach"):
        reorder.plan(far + [5, 0, 0, 0, 0, 0, 0], "ur5e", minimum_verdict="ambiguous")
    with pytest.raises(reorder.Refusal, match="the order is only Ambiguous, and Plausible is required: poses"):
        reorder.plan(recorded.poses[:8], "ur5e")
    with pytest.raises(reorder.ReorderError, match="r2d2"):
        reorder.plan(recorded.poses, "r2d2")
    with pytest.raises(reorder.ReorderError, match="unknown field `colour`"):
        reorder.plan(recorded.poses, "ur5e", config={"colour": "red"})
    with pytest.raises(reorder.ReorderError, match="a URDF has no acceleration and jerk limits"):
        reorder.plan(recorded.poses, "mine.urdf")
    with pytest.raises(reorder.ReorderError, match="frame"):
        reorder.plan(recorded.poses, "ur5e", frame_id="moon")
