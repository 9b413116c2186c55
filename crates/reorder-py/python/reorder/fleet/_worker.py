"""What a worker does with one bag."""

from __future__ import annotations

import json
import os
import resource
import time
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

from .. import _reorder

_first: Optional[int] = None


def version() -> str:
    """Of the package on the machine that it runs on."""
    from importlib.metadata import version

    return version("reorder")


def replay(path: str, name: str, output: str, settings: Dict[str, Any], memory: int) -> Tuple[str, float, str, int]:
    """The summary of a bag as JSON, how many seconds it took, Ray's name of the machine, and the greatest memory of the worker so far in bytes."""
    import ray

    # A task has one processor; the pool of threads is made when it is first wanted.
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    bound_memory(memory)
    begin = time.perf_counter()
    text = _reorder.replay_bag(path, name, output, settings)
    text = _enough(text, output, memory)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return text, time.perf_counter() - begin, ray.get_runtime_context().get_node_id(), peak


def _enough(text: str, output: str, memory: int) -> str:
    """The summary, or that of a bag without result where a decoder had not enough memory: what it could not unpack is not damaged."""
    summary = json.loads(text)
    sentences = [*summary["lost"], summary["error"] or ""]
    if not any("out of memory" in sentence or "not enough memory" in sentence for sentence in sentences):
        return text
    Path(output).unlink(missing_ok=True)
    return json.dumps(broken(summary["bag"], f"a bag may take {memory / 2**30:.2f} GiB of memory, and this one needs more"))


def broken(path: str, why: str) -> Dict[str, Any]:
    """As the engine says it of a bag that nothing came of."""
    return {"bag": path, "status": "broken", "error": f"{path}: {why}", "lost": [], "output": None, "sets": []}


def bound_memory(memory: int) -> None:
    """Lets this process have so many bytes more than it had before its first bag. A bag that needs more ends the worker, not the machine.

    Counted is private writable memory (``RLIMIT_DATA``), so that Ray's shared object store does not count.
    """
    global _first
    if _first is None:
        lines = Path("/proc/self/status").read_text().splitlines()
        _first = next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmData:"))
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (_first + memory, hard))
