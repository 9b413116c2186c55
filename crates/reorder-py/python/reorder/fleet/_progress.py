"""How far a run is, on a terminal."""

from __future__ import annotations

import sys
import time
from typing import Any, Dict


class Progress:
    """A line that is written over on standard error, and a line of its own for every bag that something is wrong with."""

    def __init__(self, bags: int, total: int, shown: bool) -> None:
        self.bags, self.total, self.shown = bags, total, shown
        self.done = self.bytes = 0
        self.begin = time.monotonic()

    def tell(self, bag: Dict[str, Any], size: int) -> None:
        """A bag is done."""
        self.done, self.bytes = self.done + 1, self.bytes + size
        wrong = [f"warning: {loss}; what is whole was taken" for loss in bag["lost"]]
        wrong += [bag["error"]] if bag["error"] else []
        wrong += [f"warning: {bag['bag']}, topic {s['topic']}: {s['error']}" for s in bag["sets"] if s["error"]]
        if wrong:
            self.clear()
        for sentence in wrong:
            print(f"reorder: {sentence}", file=sys.stderr)

    def draw(self) -> None:
        """Writes the line."""
        if not self.shown:
            return
        seconds = time.monotonic() - self.begin
        rate = self.bytes / seconds if seconds > 0 else 0.0
        left = f"{(self.total - self.bytes) / rate:.0f} s left" if rate > 0 else "some time left"
        line = f"{self.done} of {self.bags} bags, {self.bytes / 1e6:.1f} of {self.total / 1e6:.1f} MB, {rate / 1e6:.1f} MB/s, {left}"
        print(f"\r{line}\x1b[K", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Takes the line away."""
        if self.shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
