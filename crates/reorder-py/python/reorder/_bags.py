"""Poses in bags and other files."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, List, Optional, Sequence, Tuple, Union

from . import _reorder

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class PoseSet:
    """Poses that were recorded together: a text file, one PoseArray or Path, or the messages of a topic with one pose each."""

    file: str
    """The file; for a bag, the MCAP or SQLite file."""
    topic: Optional[str]
    """Topic, in a bag."""
    message: Optional[int]
    """Message on the topic, from 0, where the poses are those of one message."""
    frame_id: str
    """Frame in which the poses are given; empty where the file does not say."""
    log_time_ns: int
    """When the first message was recorded, in ns since the epoch; 0 for a text file."""
    poses: NDArray[np.float64] = field(repr=False)
    """``frame_from_tool``, shape (n, 7), in the order of the file."""
    stamps_ns: Optional[NDArray[np.int64]] = field(repr=False)
    """When each pose held, in ns since the epoch, shape (n,), where file or messages say it."""

    def __len__(self) -> int:
        return len(self.poses)


def read_poses(
    path: Union[str, os.PathLike[str]],
    topic: Optional[str] = None,
    *,
    frames: Optional[Tuple[str, str]] = None,
    window_s: Optional[float] = None,
    gap_s: Optional[float] = None,
    damaged: bool = False,
) -> List[PoseSet]:
    """The sets of poses in a rosbag2 folder, an MCAP or ``.db3`` file, CSV, EuRoC, TUM or KITTI.

    :param topic: topic, where a bag has several with poses.
    :param frames: parent and child frame, where the topic holds transforms.
    :param window_s: of messages with one pose each, take together those recorded within so many seconds; else all.
    :param gap_s: the same, between silences that are longer.
    :param damaged: take what is whole of a damaged bag. What is lost then comes as a warning.
    :raises BagError: where the file cannot be read; the sentence names the file and the line or message.
    """
    sets, losses = _reorder.read_poses(path, topic, frames=frames, window_s=window_s, gap_s=gap_s, damaged=damaged)
    if losses:
        import warnings

        for loss in losses:
            warnings.warn(f"{loss}; what is whole was taken", stacklevel=2)
    return [PoseSet(os.fspath(file), *rest) for file, *rest in sets]


def write_poses(
    path: Union[str, os.PathLike[str]],
    poses: Any,
    *,
    topic: str = "/poses",
    frame_id: str = "",
    stamps_ns: Optional[Sequence[int]] = None,
) -> None:
    """Write poses, shape ``(n, 7)``, as a bag: a file where the path ends in ``.mcap``, else a rosbag2 folder. It appears whole or not at all.

    Without stamps they are one PoseArray; with stamps, ns since the epoch, a PoseStamped each.
    """
    stamps = None if stamps_ns is None else [int(stamp) for stamp in stamps_ns]
    _reorder.write_poses(path, poses, topic=topic, frame_id=frame_id, stamps_ns=stamps)
