"""Bags replayed on many machines, by Ray: the engine of ``reorder replay``, a task a bag.

``pip install 'reorder[fleet]'`` brings Ray and pyarrow. From a program, or as ``reorder-fleet`` (``python -m reorder.fleet``)::

    from reorder import fleet

    run = fleet.replay(["recordings/"], "replayed/", robot="ur5e", score=True)
    print(run.table())

Without an address a Ray of its own starts on this machine and ends with the run. With one, the machines of that cluster do the work: each
needs this package and sees bags and outputs under the same paths (a shared file system). Each bag gives the bytes that ``reorder replay``
gives, and appears whole or not at all; ``summary.parquet`` beside them has a row for every set of poses. What is there already and
would be the same again is left as it is, so that a run that was stopped goes on where it stood.
"""

from __future__ import annotations

from ._replay import FleetError, Run, replay

__all__ = ["FleetError", "Run", "replay"]
