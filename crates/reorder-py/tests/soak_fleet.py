"""At length: so many bags on two nodes, with workers killed at random; every result is there, none twice. Prints the throughput."""

import os
import shutil
import sys
import tempfile
from pathlib import Path

import ray
from fleet_bags import Killer, check_complete, contents, single_process, write_bags
from ray.cluster_utils import Cluster

from reorder import fleet

KILLS = 10


def main(count):
    command = os.environ["REORDER_COMMAND"]
    options = ["--score", "--robot", "ur5e"]
    with tempfile.TemporaryDirectory() as folder:
        bags, output = Path(folder) / "bags", Path(folder) / "out"
        write_bags(bags, count)
        expected, summaries, alone = single_process(command, bags, output, *options)
        print(f"one process, one thread: {count} bags in {alone:.1f} s, {count / alone:.2f} a second", flush=True)
        cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
        cluster.add_node(num_cpus=1)
        try:
            run = fleet.replay(bags, output, address=cluster.address, score=True, robot="ur5e", progress=False)
            check_complete(run, expected, summaries, output)
            busy = run.work_seconds / (2 * run.seconds)
            print(
                f"two nodes of one processor: {count} bags in {run.seconds:.1f} s, {count / run.seconds:.2f} a second,"
                f" {alone / run.seconds:.2f} times one process; workers busy {busy:.0%}, {run.peak_memory / 2**20:.0f} MiB at most,"
                f" bags a machine {sorted(run.nodes.values())}",
                flush=True,
            )
            again = fleet.replay(bags, output, address=cluster.address, score=True, robot="ur5e", progress=False)
            assert again.count("kept") == count
            print(f"again, all kept: {again.seconds:.1f} s, {count / again.seconds:.1f} a second", flush=True)
            shutil.rmtree(output)
            with Killer(output, KILLS, count, seed=count) as killer:
                run = fleet.replay(bags, output, address=cluster.address, score=True, robot="ur5e", progress=False)
            check_complete(run, expected, summaries, output)
            print(
                f"{len(killer.killed)} workers killed: all {len(contents(output))} results there, none twice, byte for byte;"
                f" {run.seconds:.1f} s",
                flush=True,
            )
            assert len(killer.killed) == KILLS
        finally:
            ray.shutdown()
            cluster.shutdown()


if __name__ == "__main__":
    main(int(sys.argv[1]))
