"""The command ``reorder-fleet``."""

from __future__ import annotations

import argparse
import sys
from typing import List, Optional, Tuple

from .._reorder import ReorderError
from ._replay import GIB, replay


def _frames(text: str) -> Tuple[str, str]:
    parent, colon, child = text.partition(":")
    if not colon:
        raise argparse.ArgumentTypeError("not two frames with a colon between")
    return parent.lstrip("/"), child.lstrip("/")


def _weight(text: str) -> "float | str":
    return text if text == "auto" else float(text)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="reorder-fleet",
        description="Put the poses of many recordings in order on the processors of this machine, or of a Ray cluster.",
    )
    add = parser.add_argument
    add("bags", nargs="+", metavar="BAG|FOLDER", help="bags, and folders that are searched for them")
    add("-o", "--output", required=True, metavar="FOLDER", help="where NAME.mcap of every bag and summary.parquet go")
    add("--address", help="of a Ray cluster, as auto or HOST:6379 [default: a Ray on this machine]")
    add("--topic", action="append", default=[], help="topic with poses, several times for several")
    add("--frames", type=_frames, metavar="PARENT:CHILD", help="the frames whose transforms are meant")
    add("--window", type=float, metavar="SECONDS", help="take together poses recorded within so many seconds")
    add("--gap", type=float, metavar="SECONDS", help="take together poses between silences that are longer")
    add("--topology", default="auto", choices=["auto", "open", "closed"])
    add("--metres-per-radian", default="auto", type=_weight, metavar="L")
    add("--score", action="store_true", help="compare the order with the recorded one")
    add("--robot", metavar="NAME|FILE.urdf", help="plan a trajectory too")
    add("--limits", metavar="FILE.yaml", help="frames and limits of every joint")
    add("--minimum-verdict", default="plausible", choices=["ambiguous", "plausible", "certified"])
    add("--memory", type=float, default=1.0, metavar="GIB", help="memory that a bag may take [default: 1]")
    add("--retries", type=int, default=3, help="how often a bag is tried again whose worker died [default: 3]")
    return parser


def main(arguments: Optional[List[str]] = None) -> int:
    """Exit code 0 is success, 2 bad input or a broken or damaged bag, 1 a set without trajectory."""
    given = _parser().parse_args(arguments)
    try:
        run = replay(
            given.bags,
            given.output,
            address=given.address,
            topics=given.topic,
            frames=given.frames,
            window_s=given.window,
            gap_s=given.gap,
            topology=given.topology,
            metres_per_radian=given.metres_per_radian,
            score=given.score,
            robot=given.robot,
            limits=given.limits,
            minimum_verdict=given.minimum_verdict,
            memory=int(given.memory * GIB),
            retries=given.retries,
        )
    except ReorderError as error:
        print(f"reorder: {error}", file=sys.stderr)
        return 2
    print(run.table(), end="")
    counts = ", ".join(f"{run.count(status)} {status}" for status in ("done", "kept", "broken"))
    print(f"{counts} in {run.seconds:.1f} s on {len(run.nodes)} machine(s); {run.summary}", file=sys.stderr)
    if run.count("broken") or any(bag["lost"] for bag in run.bags):
        return 2
    still = [found for bag in run.bags for found in bag["sets"] if given.robot and not found["trajectory"]]
    return 2 if any(found["bad_input"] for found in still) else 1 if still else 0


if __name__ == "__main__":
    sys.exit(main())
