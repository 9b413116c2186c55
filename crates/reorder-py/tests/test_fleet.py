"""Replays on a Ray cluster of two nodes on this machine."""

import json
import os
import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest
import ray
from conftest import helix_poses
from fleet_bags import Killer, check_complete, contents, single_process, write_bags
from ray.cluster_utils import Cluster

import reorder
from reorder import fleet
from reorder.fleet import _worker

MIB = 1 << 20


@pytest.fixture(scope="module")
def address():
    """Of a cluster of two raylets with a processor each."""
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    cluster.add_node(num_cpus=1)
    yield cluster.address
    ray.shutdown()
    cluster.shutdown()


def test_a_killed_worker_loses_no_bag_and_doubles_none(tmp_path, address):
    bags, output = tmp_path / "bags", tmp_path / "out"
    write_bags(bags, 12)
    (bags / "bad.mcap").write_text("no bag at all")
    command = os.environ["REORDER_COMMAND"]
    expected, summaries, _ = single_process(command, bags, output, "--score", "--robot", "ur5e")
    assert len(expected) == 12
    with Killer(output, 1, 12, seed=4) as killer:
        run = fleet.replay(bags, output, address=address, score=True, robot="ur5e", progress=False)
    assert len(killer.killed) == 1
    assert run.count("broken") == 1 and run.count("done") + run.count("kept") == 12
    check_complete(run, {**expected}, summaries, output)
    rows = {row["bag"]: row for row in pq.read_table(run.summary).to_pylist()}
    assert "bad.mcap is not an MCAP file" in rows[str(bags / "bad.mcap")]["error"]
    done = [row for row in rows.values() if row["verdict"]]
    assert {row["verdict"] for row in done} <= {"certified", "plausible", "ambiguous"} and len(done) == 12
    assert all(row["velocity_ratio"] <= 1 and row["duration_s"] > 0 for row in done if row["points"])
    assert any(row["points"] for row in done) and all(row["adjacency"] is not None for row in done)

    # What is there is kept, what is missing is made again.
    stamps = {path.name: path.stat().st_mtime_ns for path in output.glob("*.mcap")}
    (output / "run_003.mcap").unlink()
    again = fleet.replay(bags, output, address=address, score=True, robot="ur5e", progress=False)
    assert (again.count("kept"), again.count("done"), again.count("broken")) == (11, 1, 1)
    assert contents(output) == expected
    changed = {path.name for path in output.glob("*.mcap") if path.stat().st_mtime_ns != stamps[path.name]}
    assert changed == {"run_003.mcap"}


def test_a_bag_that_crashes_its_reader_is_reported_and_the_rest_go_on(tmp_path, address):
    bags, output = tmp_path / "bags", tmp_path / "out"
    write_bags(bags, 3)
    many, _ = helix_poses(400_000)
    # One message of that size, or many small ones.
    reorder.write_poses(bags / "array.mcap", many, topic="/tool")
    reorder.write_poses(bags / "large.mcap", many, topic="/tool", stamps_ns=np.arange(len(many)))
    run = fleet.replay(bags, output, address=address, memory=48 * MIB, retries=1, progress=False)
    assert [bag["status"] for bag in run.bags] == ["broken", "broken", "done", "done", "done"]
    assert "array.mcap: " in run.bags[0]["error"] and "0.05 GiB of memory" in run.bags[0]["error"]
    assert "large.mcap: its worker died, 2 times in a row (a bag may take 0.05 GiB of memory)" in run.bags[1]["error"]
    assert sorted(contents(output)) == ["run_000.mcap", "run_001.mcap", "run_002.mcap"]


def test_what_cannot_be_unpacked_for_want_of_memory_is_not_damaged(tmp_path):
    output = tmp_path / "out.mcap"
    output.write_text("half of a bag")
    damaged = {"bag": "a.mcap", "status": "done", "error": None, "lost": ["a.mcap is damaged after 3 messages"], "sets": []}
    assert json.loads(_worker._enough(json.dumps(damaged), str(output), 1 << 30)) == damaged and output.exists()
    starved = {**damaged, "lost": ["a.mcap is damaged after 3 readable messages: a chunk cannot be decompressed: out of memory"]}
    told = json.loads(_worker._enough(json.dumps(starved), str(output), 1 << 30))
    assert (told["status"], told["lost"]) == ("broken", []) and not output.exists()
    assert told["error"] == "a.mcap: a bag may take 1.00 GiB of memory, and this one needs more"


def test_what_cannot_begin_is_said_in_one_sentence(tmp_path, address):
    write_bags(tmp_path / "bags", 1)
    bags, output = tmp_path / "bags", tmp_path / "out"
    cases = [
        ({"memory": 1 << 50}, "no machine of the cluster has 1048576.00 GiB for a task"),
        ({"robot": "r2d2"}, "r2d2"),
        ({"topology": "knot"}, "topology: unknown variant `knot`"),
        ({"output": tmp_path / "one.mcap"}, "one.mcap is one file: name a folder"),
        ({"output": bags / "out"}, "outputs go where no bags are looked for"),
        ({"uris": "s3://bucket/bags"}, "s3://bucket/bags: only paths and file:// URIs"),
        ({"uris": tmp_path / "nowhere"}, "nowhere: No such file or directory"),
    ]
    for change, sentence in cases:
        given = {"uris": bags, "output": output, "address": address, **change}
        with pytest.raises(reorder.ReorderError, match=sentence.replace("/", r"\/")):
            fleet.replay(given.pop("uris"), given.pop("output"), **given)
    assert not output.exists() or not contents(output)


def test_the_command_starts_a_ray_of_its_own(tmp_path):
    bags, output = tmp_path / "bags", tmp_path / "out"
    write_bags(bags, 2)
    arguments = [sys.executable, "-m", "reorder.fleet", bags.as_uri(), "-o", str(output), "--score", "--memory", "0.25"]
    ended = subprocess.run(arguments, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("done") == 2 and "run_000.mcap" in ended.stdout
    assert f"2 done, 0 kept, 0 broken in" in ended.stderr and str(output / "summary.parquet") in ended.stderr
    assert len(contents(output)) == 2
    beside = subprocess.run(arguments[:3] + ["nowhere", "-o", str(output)], capture_output=True, text=True)
    assert (beside.returncode, beside.stderr.count("\n")) == (2, 1) and "nowhere: No such file" in beside.stderr
