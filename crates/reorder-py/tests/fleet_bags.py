"""Bags for the tests of the fleet, and runs of it that are disturbed."""

import json
import os
import random
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from conftest import RECORDINGS, SHAPES

import reorder

# Of ordinary priority, as the process is that they are compared with; Ray would have them stand back.
os.environ["RAY_worker_niceness"] = "0"


def write_bags(folder, count, seed=1):
    """So many recordings of 40 to 60 poses, each another part of a recorded shape, shuffled; some of one message, some of many."""
    folder.mkdir(parents=True)
    rng = np.random.default_rng(seed)
    recorded = {shape: reorder.read_poses(RECORDINGS / shape)[0].poses for shape in SHAPES}
    for k in range(count):
        poses = recorded[SHAPES[k % len(SHAPES)]]
        along = poses[reorder.order(poses, metres_per_radian=0.1).order]
        length = int(rng.integers(40, 60))
        first = int(rng.integers(0, len(along) - length + 1))
        part = along[first : first + length][rng.permutation(length)]
        stamps = None if k % 3 else 1_000_000 * np.arange(length)
        reorder.write_poses(folder / f"run_{k:03}.mcap", part, topic="/tool", frame_id="base_link", stamps_ns=stamps)


def contents(folder):
    """The bytes of every output by its name."""
    return {path.name: path.read_bytes() for path in folder.glob("*.mcap")}


def single_process(command, bags, output, *options):
    """What ``reorder replay`` makes of the bags in ``output``, and how many seconds it takes on one thread; the folder is gone afterwards."""
    begin = time.perf_counter()
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    arguments = [command, "replay", bags, "-o", output, "--format", "json", *options]
    ended = subprocess.run(list(map(str, arguments)), capture_output=True, text=True, env=environment)
    seconds = time.perf_counter() - begin
    assert ended.returncode in (0, 1, 2) and ended.stdout, ended.stderr
    made = contents(output)
    for path in output.iterdir():
        path.unlink()
    output.rmdir()
    return made, json.loads(ended.stdout)["bags"], seconds


def workers():
    """Processes of Ray that are at work on a bag."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and (entry / "cmdline").read_bytes().startswith(b"ray::replay "):
                found.append(int(entry.name))
        except OSError:
            pass  # It ended meanwhile.
    return found


class Killer:
    """Kills workers that are at work, so many, each after another random number of finished bags."""

    def __init__(self, output, kills, bags, seed):
        rng = random.Random(seed)
        self.after, self.output, self.killed = sorted(rng.sample(range(bags * 3 // 4), kills)), output, []
        self.rng, self.stopped = rng, threading.Event()
        self.thread = threading.Thread(target=self.work)

    def work(self):
        for after in self.after:
            while not self.stopped.wait(0.002):
                candidates = workers() if len(list(self.output.glob("*.mcap"))) >= after else []
                if candidates:
                    victim = self.rng.choice(candidates)
                    os.kill(victim, signal.SIGKILL)
                    self.killed.append(victim)
                    break

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stopped.set()
        self.thread.join()


def check_complete(run, expected, summaries, output):
    """Every result is there once, and each is the single process's byte for byte."""
    assert contents(output).keys() == expected.keys()
    different = [name for name, data in contents(output).items() if data != expected[name]]
    assert different == []
    assert {path.name for path in output.iterdir()} == {*expected, "summary.parquet"}, "and nothing beside it"
    plain = [{**bag, "status": "done"} for bag in summaries]
    assert [{**bag, "status": "done"} for bag in run.bags] == plain
    table = pq.read_table(run.summary).to_pylist()
    assert len(table) == sum(max(1, len(bag["sets"])) for bag in summaries)
    assert len({(row["bag"], row["topic"], row["message"]) for row in table}) == len(table), "none twice"
