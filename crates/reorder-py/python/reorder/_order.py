"""The order of points along the curve that they were sampled from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Union

from . import _reorder
from ._reorder import Manifold
from ._results import Ordering, ordering

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def order(
    points: Any,
    manifold: Union[str, Manifold] = "se3",
    *,
    metres_per_radian: Union[float, str, None] = None,
    method: str = "auto",
    topology: str = "auto",
    start: Optional[int] = None,
    start_at: Optional[ArrayLike] = None,
    components: str = "one",
    repair: str = "auto",
    denoise: bool = False,
    edges: bool = False,
) -> Ordering:
    """Recover the order of points, shape ``(n, k)``, along the curve that they were sampled from, as ``reorder order`` does.

    The manifold is a name (``"r1"`` to ``"r8"``, ``"s2"``, ``"so3"``, ``"se2"``, ``"se3"``, ``"sim2"``) or a :class:`Manifold`, and says what the
    k numbers are. An order that is uncertain is no error: its ``verdict`` is ``"ambiguous"``, and its ``doubts`` name the rows.

    :param metres_per_radian: how many metres count as much as one radian; ``"auto"`` (the default for a name) tells it from the points;
        the default for a :class:`Manifold` is its own weight.
    :param method: ``"auto"``, ``"mst"``, ``"nn-crust"``, ``"crust"`` (in the plane) or ``"nearest"``.
    :param topology: ``"auto"``, ``"open"`` or ``"closed"``.
    :param start: row at which the order starts; on an open curve one of its ends.
    :param start_at: a point, shape ``(k,)``, near which the order starts.
    :param components: ``"one"`` curve, or ``"auto"`` for as many as are clearly apart, outliers in none.
    :param repair: whether a shorter and smoother order is sought where the tree is none to trust: ``"auto"``, ``"always"`` or ``"off"``.
    :param denoise: move noisy points toward the curve of their neighbours before they are ordered.
    :param edges: say gap, reach and epsilon of every edge too.
    :raises OrderError: where the points admit no order; the sentence names the row.

    >>> order([[0.0, 0.0], [2.0, 0.1], [1.0, 0.0]], "r2").order
    array([0, 2, 1])
    """
    if isinstance(manifold, str):
        manifold, weight = Manifold(manifold), "auto" if metres_per_radian is None else metres_per_radian
    else:
        own = "auto" if manifold.metres_per_radian is None else manifold.metres_per_radian
        weight = own if metres_per_radian is None else metres_per_radian
    return ordering(
        _reorder.order(
            points,
            manifold,
            metres_per_radian=weight,
            method=method,
            topology=topology,
            start=start,
            start_at=start_at,
            components=components,
            repair=repair,
            denoise=denoise,
            edges=edges,
        )
    )
