"""What an order is, and how far it may be trusted: the figures of ``reorder order``. ``cargo doc -p reorder`` has the theory."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Certificate:
    """How densely the points sample the curve that the order draws: estimates from the points. Lengths are in the unit of the metric."""

    max_gap: float
    """The greatest distance between neighbours in the order."""
    reach: Optional[float]
    """Federer's reach of the curve by the samples; None where nothing bends, or the order is no curve."""
    epsilon: Optional[float]
    """max_gap / (2 reach): below 1 is what the reconstruction theorems ask for."""
    injectivity_radius: Optional[float]
    """Radius within which geodesics are unique; None where it is infinite."""
    margin: Optional[float]
    """injectivity_radius - max_gap."""
    required_reach: float
    """A curve through the points whose reach is greater, and whose own gaps are below twice its reach, has no other order."""
    distinct: int
    """Number of distinct points."""
    usable_reach: Optional[float]
    """The reach, corrected for the curvature of the space."""
    edge_epsilon: Optional[float]
    """The greatest epsilon of a single gap."""
    weakest: Optional[Tuple[int, int]]
    """Input rows of the ends of that gap."""
    curvature_radius: Optional[float]
    """The smallest ball through two neighbours, tangent at one of them."""
    turn_rad: float
    """Greatest turn of the order at a point."""
    roughness: float
    """Greatest miss of a point from its neighbours' parabola, in units of what a smooth curve allows."""
    noise: float
    """Nine of ten points miss it by no more than this share of the shortest gap around."""
    usual_miss: float
    """Half of the points miss it by no more than this share."""
    zigzag: int
    """How many points in a row turn back against the turn before."""
    opening: Optional[float]
    """Distance of the ends in units of the longest gap (open), or the longest gap in units of the next (closed)."""
    longest_to_usual: float
    """The greatest ratio of a gap to the median of the gaps around it."""
    closing_bound: Optional[float]
    """What the opening of a closed curve is compared with."""


@dataclass(frozen=True)
class Doubt:
    """A reason not to trust the order, and where."""

    at: Tuple[int, int]
    """The two input rows whose neighbourhood, or lack of it, is in question."""
    why: str
    """One sentence."""


@dataclass(frozen=True)
class Part:
    """One of several curves that were ordered apart."""

    topology: str
    method: str
    verdict: str
    certificate: Certificate


@dataclass(frozen=True)
class Repaired:
    """How a repaired order differs from the minimum spanning tree."""

    dropped: List[Tuple[int, int]]
    """Edges of the tree that the order does not follow."""
    added: List[Tuple[int, int]]
    """Neighbours in the order that are none in the tree."""


@dataclass(frozen=True)
class EdgeFigures:
    """How densely the curve is sampled around one gap."""

    at: Tuple[int, int]
    """Input rows of its ends."""
    gap: float
    """The distance between them, in the unit of the metric."""
    reach: Optional[float]
    """The smaller of the balls that touch the order at either end; None where the points lie on a geodesic."""
    epsilon: float
    """gap / (2 reach)."""


@dataclass(frozen=True, eq=False)
class Ordering:
    """Points in order, and how far that order may be trusted. All rows are 0-based input rows."""

    order: NDArray[np.int64]
    """Every input row once, in recovered order, shape (n,)."""
    topology: str
    """``"open"``, or ``"closed"`` where the last point is followed by the first."""
    method: str
    """How the order was found: ``"mst"``, ``"repaired"``, ``"nn-crust"``, ``"crust"`` or ``"nearest"``."""
    verdict: str
    """``"certified"``: the premise of a theorem holds by the samples; ``"plausible"``: every test agrees; ``"ambiguous"``: see ``doubts``."""
    weight_stable: Optional[bool]
    """Whether the order is the same when a radian counts for half and for twice as many metres; None without that weight."""
    metres_per_radian: Optional[float]
    """Metres that one radian counted for; None on manifolds without that weight."""
    components: List[NDArray[np.int64]]
    """The rows of each curve that the points look like, in order."""
    parts: List[Part]
    """What is known about each of them where they were ordered apart."""
    outliers: NDArray[np.int64]
    """Rows that stand apart from every curve."""
    duplicates: List[NDArray[np.int64]]
    """Groups of rows with equal points (a dwell)."""
    certificate: Certificate
    """Sampling figures."""
    repaired: Optional[Repaired]
    """What was repaired; None where nothing was."""
    moved: NDArray[np.float64]
    """How far each point was moved to find the order; empty where nothing was denoised."""
    doubts: List[Doubt]
    """Everything that speaks against the order."""
    distinct: NDArray[np.int64] = field(repr=False)
    """The order with equal points that stand together merged into the first of them: what a curve can be drawn through."""
    edges: Optional[List[EdgeFigures]] = field(repr=False)
    """The figures of every gap, where they were asked for."""

    def __len__(self) -> int:
        return len(self.order)

    def to_dict(self) -> Dict[str, Any]:
        """The object that ``reorder order --format json`` prints."""
        lists = {name: getattr(self, name).tolist() for name in ("order", "outliers", "moved")}
        groups = {name: [rows.tolist() for rows in getattr(self, name)] for name in ("components", "duplicates")}
        plain = ("topology", "method", "verdict", "weight_stable", "metres_per_radian")
        made = {"n": len(self), **lists, **groups, **{name: getattr(self, name) for name in plain}}
        made["certificate"] = asdict(self.certificate)
        made["repaired"] = None if self.repaired is None else asdict(self.repaired)
        made["parts"] = [asdict(part) for part in self.parts]
        made["doubts"] = [asdict(doubt) for doubt in self.doubts]
        if self.edges is not None:
            made["edges"] = [asdict(edge) for edge in self.edges]
        return made

    def to_json(self) -> str:
        """:meth:`to_dict` as JSON text."""
        return json.dumps(self.to_dict())


def ordering(parts: Tuple[Any, ...]) -> Ordering:
    """The order of which the Rust side hands over the long fields as arrays, and the others as JSON."""
    order, components, duplicates, outliers, moved, distinct, text = parts
    rest = json.loads(text)
    rest["parts"] = [Part(**{**part, "certificate": _certificate(part["certificate"])}) for part in rest["parts"]]
    rest["certificate"] = _certificate(rest["certificate"])
    rest["doubts"] = [Doubt(tuple(doubt["at"]), doubt["why"]) for doubt in rest["doubts"]]
    if rest["repaired"] is not None:
        rest["repaired"] = Repaired(**{name: [tuple(edge) for edge in edges] for name, edges in rest["repaired"].items()})
    if rest["edges"] is not None:
        rest["edges"] = [EdgeFigures(**{**edge, "at": tuple(edge["at"])}) for edge in rest["edges"]]
    return Ordering(
        order=order,
        components=components,
        duplicates=duplicates,
        outliers=outliers,
        moved=moved,
        distinct=distinct,
        **rest,
    )


def _certificate(figures: Dict[str, Any]) -> Certificate:
    weakest = figures["weakest"]
    return Certificate(**{**figures, "weakest": None if weakest is None else tuple(weakest)})
