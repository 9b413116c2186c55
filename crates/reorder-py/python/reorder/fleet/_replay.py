"""The run: bags handed out to workers, results gathered, the summary written."""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple, Union
from urllib.parse import unquote, urlparse

from .. import _reorder
from .._reorder import ReorderError
from . import _worker
from ._progress import Progress

SUMMARY = "summary.parquet"
#: Tasks that Ray knows of at a time: enough for every processor of a large cluster, and for an autoscaler to see what is coming.
IN_FLIGHT = 2000
MOMENT_S = 0.1
GIB = 1 << 30


class FleetError(ReorderError):
    """What keeps a run from beginning."""


@dataclass(frozen=True)
class Run:
    """What came of a run."""

    bags: List[Dict[str, Any]] = field(repr=False)
    """A summary a bag, by name, as ``reorder replay --format json`` has it; ``status`` is ``done``, ``kept`` or ``broken``."""
    summary: Path
    """The Parquet file with a row for every set of poses."""
    seconds: float
    """How long the run took, the start of Ray apart."""
    work_seconds: float
    """How long the bags took by themselves, all workers together."""
    peak_memory: int
    """The greatest memory of a worker, in bytes."""
    nodes: Dict[str, int]
    """How many bags each machine replayed."""

    def count(self, status: str) -> int:
        """How many bags have that status."""
        return sum(bag["status"] == status for bag in self.bags)

    def table(self) -> str:
        """The table of ``reorder replay``."""
        return _reorder.replay_table([json.dumps(bag) for bag in self.bags])


def replay(
    uris: Union[str, os.PathLike[str], Sequence[Union[str, os.PathLike[str]]]],
    output: Union[str, os.PathLike[str]],
    *,
    address: Optional[str] = None,
    topics: Sequence[str] = (),
    frames: Optional[Tuple[str, str]] = None,
    window_s: Optional[float] = None,
    gap_s: Optional[float] = None,
    topology: str = "auto",
    metres_per_radian: Union[float, str] = "auto",
    score: bool = False,
    robot: Union[str, os.PathLike[str], None] = None,
    limits: Union[str, os.PathLike[str], None] = None,
    minimum_verdict: str = "plausible",
    memory: int = GIB,
    retries: int = 3,
    progress: Optional[bool] = None,
) -> Run:
    """Put every bag in order (and plan for a robot) on the processors of a Ray cluster, and write MCAP files and a Parquet summary.

    :param uris: bags, and folders that are searched for them: paths, or ``file://`` URIs.
    :param output: folder for ``NAME.mcap`` of every bag and for ``summary.parquet``; not within a folder that is searched.
    :param address: of a Ray cluster (``"auto"``, ``"HOST:6379"``, ``"ray://HOST:10001"``); None starts a Ray on this machine for this run. A Ray
        that the program has already started is used as it is.
    :param topics: topics with poses; without any, the only one of each bag. ``frames``, ``window_s``, ``gap_s``, ``topology``,
        ``metres_per_radian``, ``score``, ``robot``, ``limits``, ``minimum_verdict``: as the options of ``reorder replay``.
    :param memory: bytes that a bag may take. Ray starts no more tasks on a machine than fit, and a bag that needs more ends its worker.
    :param retries: how often Ray tries a bag again whose worker or machine died.
    :param progress: whether a line on standard error shows how far the run is; None means where that is a terminal.
    :raises ReorderError: where a setting is wrong, or there is no bag. What is wrong with a bag stands in its summary.
    """
    paths = [_path(uri) for uri in ([uris] if isinstance(uris, (str, os.PathLike)) else uris)]
    settings = {
        "topics": list(topics),
        "frames": frames,
        "window_s": window_s,
        "gap_s": gap_s,
        "topology": topology,
        "metres_per_radian": metres_per_radian,
        "score": score,
        "robot": None if robot is None else _robot(os.fspath(robot)),
        "limits": None if limits is None else os.path.abspath(limits),
        "minimum_verdict": minimum_verdict,
    }
    _reorder.check_task(settings)
    folder = Path(os.path.abspath(output))
    if folder.suffix == ".mcap":
        raise FleetError(f"{folder} is one file: name a folder for the outputs")
    found = _reorder.find_bags(paths)
    outputs = _reorder.bag_outputs(paths, folder)
    work = [_Bag(os.fspath(path), name, size, os.fspath(to)) for (path, name, size), to in zip(found, outputs)]
    # Large ones first, or the run waits for one of them at its end.
    work.sort(key=lambda bag: (-bag.size, bag.name))
    shown = sys.stderr.isatty() if progress is None else progress
    with _cluster(address) as ray:
        _check_cluster(ray, memory)
        begin = time.perf_counter()
        results = _gather(ray, work, settings, memory, retries, Progress(len(work), sum(b.size for b in work), shown))
        seconds = time.perf_counter() - begin
    bags = [json.loads(results[bag.name].text) for bag in sorted(work, key=lambda bag: bag.name)]
    nodes: Dict[str, int] = {}
    for result in results.values():
        if result.node:
            nodes[result.node] = nodes.get(result.node, 0) + 1
    # Workers that died left what they had begun.
    _reorder.remove_abandoned(folder)
    from ._summary import write

    write(folder / SUMMARY, bags)
    took = [result.seconds for result in results.values()]
    peak = max((result.peak for result in results.values()), default=0)
    return Run(bags, folder / SUMMARY, seconds, sum(took), peak, nodes)


@dataclass(frozen=True)
class _Bag:
    path: str
    name: str
    size: int
    output: str


@dataclass(frozen=True)
class _Result:
    text: str
    seconds: float = 0.0
    node: str = ""
    peak: int = 0


def _path(uri: Union[str, os.PathLike[str]]) -> str:
    """The absolute path that all machines see the same."""
    text = os.fspath(uri)
    parts = urlparse(text)
    if "://" not in text:
        return os.path.abspath(text)
    if parts.scheme != "file" or parts.netloc not in ("", "localhost"):
        raise FleetError(f"{text}: only paths and file:// URIs that every machine can read; mount what lies elsewhere")
    return os.path.abspath(unquote(parts.path))


def _robot(robot: str) -> str:
    return os.path.abspath(robot) if robot.endswith(".urdf") else robot


@contextlib.contextmanager
def _cluster(address: Optional[str]) -> Iterator[Any]:
    """Ray, connected: as the program has it, else for the time of the run."""
    try:
        import pyarrow  # noqa: F401, to be missed before the work and not after it
        import ray
    except ImportError as error:
        raise FleetError(f"a fleet needs Ray and pyarrow ({error}): pip install 'reorder[fleet]'") from error
    if ray.is_initialized():
        yield ray
        return
    # A worker that the machine's memory was too small for counts as one that died, and is not tried for ever.
    os.environ.setdefault("RAY_task_oom_retries", "3")
    try:
        ray.init(address=address or "local", log_to_driver=False, logging_level="ERROR")
    except (ConnectionError, RuntimeError, ValueError) as error:
        raise FleetError(f"no Ray cluster at {address or 'this machine'}: {error}") from error
    try:
        yield ray
    finally:
        ray.shutdown()


def _check_cluster(ray: Any, memory: int) -> None:
    largest = max(node["Resources"].get("memory", 0) for node in ray.nodes() if node["Alive"])
    if largest < memory:
        raise FleetError(f"no machine of the cluster has {_gib(memory)} for a task, the largest has {_gib(int(largest))}: lower the memory of a bag")
    here = _worker.version()
    try:
        there = ray.get(ray.remote(_worker.version).options(name="version").remote())
    except ray.exceptions.RayError as error:
        raise FleetError(f"a worker cannot use the package reorder: install it on every machine ({_last_line(error)})") from error
    if there != here:
        raise FleetError(f"a worker has reorder {there} and this program has {here}: install the same on every machine")


def _gather(
    ray: Any, work: List[_Bag], settings: Dict[str, Any], memory: int, retries: int, progress: Progress
) -> Dict[str, _Result]:
    """The result of every bag by name; Ray tries those again whose workers die."""
    remote = ray.remote(num_cpus=1, memory=memory, max_retries=retries)(_worker.replay)
    waiting = iter(work)
    running: Dict[Any, _Bag] = {}
    results: Dict[str, _Result] = {}
    progress.draw()
    while True:
        for bag in itertools.islice(waiting, IN_FLIGHT - len(running)):
            task = remote.options(name=f"replay {bag.name}")
            running[task.remote(bag.path, bag.name, bag.output, settings, memory)] = bag
        if not running:
            break
        # All that are done after a moment: to ask for one at a time takes long where many are running.
        done, _ = ray.wait(list(running), num_returns=len(running), timeout=MOMENT_S)
        for reference in done:
            bag = running.pop(reference)
            try:
                result = _Result(*ray.get(reference))
            except ray.exceptions.RayError as error:
                result = _Result(json.dumps(_worker.broken(bag.path, _why(ray, error, memory, retries))))
            results[bag.name] = result
            progress.tell(json.loads(result.text), bag.size)
        progress.draw()
    progress.clear()
    return results


def _why(ray: Any, error: Exception, memory: int, retries: int) -> str:
    if isinstance(error, ray.exceptions.RayTaskError):
        return f"the replay ended in an error of the worker: {_last_line(error)}"
    what = "ran out of the machine's memory" if isinstance(error, ray.exceptions.OutOfMemoryError) else "died"
    return f"its worker {what}, {retries + 1} times in a row (a bag may take {_gib(memory)} of memory)"


def _last_line(error: Exception) -> str:
    return str(error).strip().splitlines()[-1]


def _gib(size: int) -> str:
    return f"{size / GIB:.2f} GiB"
