"""The summary of all bags as Parquet: a row for every set of poses, and one for a bag that has none."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Dict, Iterable, Iterator

import pyarrow as pa
import pyarrow.parquet as pq

#: Lengths in m, angles in rad, times in s; ratios are peak over limit. `order` holds the rows of the set in recovered order.
SCHEMA = pa.schema(
    [
        ("bag", pa.string()),
        ("status", pa.string()),
        ("error", pa.string()),
        ("lost", pa.list_(pa.string())),
        ("output", pa.string()),
        ("topic", pa.string()),
        ("message", pa.int64()),
        ("poses", pa.int64()),
        ("order", pa.list_(pa.int64())),
        ("topology", pa.string()),
        ("verdict", pa.string()),
        ("doubts", pa.int64()),
        ("adjacency", pa.float64()),
        ("exact", pa.bool_()),
        ("kendall_tau", pa.float64()),
        ("points", pa.int64()),
        ("duration_s", pa.float64()),
        ("velocity_ratio", pa.float64()),
        ("acceleration_ratio", pa.float64()),
        ("jerk_ratio", pa.float64()),
        ("position_margin", pa.float64()),
        ("pose_error_max_m", pa.float64()),
        ("pose_error_max_rad", pa.float64()),
        ("refused", pa.string()),
    ]
)


def rows(bag: Dict[str, Any]) -> Iterator[Dict[str, Any]]:
    """The rows of one bag, from its summary as ``reorder replay --format json`` has it."""
    of_bag = {key: bag[key] for key in ("bag", "status", "error", "lost", "output")}
    for found in bag["sets"] or [None]:
        if found is None:
            yield of_bag
            continue
        score, trajectory = found["score"] or {}, dict(found["trajectory"] or {})
        ratios = trajectory.pop("max_ratio", (None, None, None))
        plain = {key: found[key] for key in ("topic", "message", "order", "topology", "verdict", "doubts", "refused")}
        yield {
            **of_bag,
            **plain,
            "error": found["error"],
            "poses": found["n"],
            **{key: score.get(key) for key in ("adjacency", "exact", "kendall_tau")},
            **dict(zip(("velocity_ratio", "acceleration_ratio", "jerk_ratio"), ratios)),
            **trajectory,
        }


def write(path: Path, bags: Iterable[Dict[str, Any]]) -> None:
    """Writes it whole or not at all."""
    table = pa.Table.from_pylist([row for bag in bags for row in rows(bag)], schema=SCHEMA)
    partial = path.with_name(f".{path.name}.partial")
    pq.write_table(table, partial)
    os.replace(partial, path)
