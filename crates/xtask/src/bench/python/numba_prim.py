"""Wall seconds that a spanning tree of 1e4 poses takes by Prim's algorithm, compiled by numba: what one writes in Python who wants it fast.

The distance is that of the product metric, a radian counting as a metre. The angle is only worked out where the places alone are near
enough, and the points that are left stand together, so that the inner loop is short. One thread; the compilation does not count."""

import json
import math
import os
import sys
import time

import numba
import numpy as np


@numba.njit(fastmath=True)
def tree_length(places, quaternions):
    n = places.shape[0]
    nearest = np.full(n, np.inf)
    left = np.arange(n)
    left[0] = n - 1
    count, current, total = n - 1, 0, 0.0
    while count > 0:
        least, chosen = np.inf, -1
        for k in range(count):
            j = left[k]
            squared = (
                (places[j, 0] - places[current, 0]) ** 2
                + (places[j, 1] - places[current, 1]) ** 2
                + (places[j, 2] - places[current, 2]) ** 2
            )
            if squared < nearest[j]:
                cosine = abs(
                    quaternions[j, 0] * quaternions[current, 0]
                    + quaternions[j, 1] * quaternions[current, 1]
                    + quaternions[j, 2] * quaternions[current, 2]
                    + quaternions[j, 3] * quaternions[current, 3]
                )
                angle = 2.0 * math.acos(min(cosine, 1.0))
                nearest[j] = min(nearest[j], squared + angle * angle)
            if nearest[j] < least:
                least, chosen = nearest[j], k
        total += math.sqrt(least)
        current = left[chosen]
        count -= 1
        left[chosen] = left[count]
    return total


def least_seconds(name):
    poses = np.fromfile(os.path.join(sys.argv[1], name), "<f8").reshape(-1, 7)
    places, quaternions = poses[:, :3].copy(), poses[:, 3:].copy()
    tree_length(places[:100], quaternions[:100])

    def once():
        start = time.perf_counter()
        tree_length(places, quaternions)
        return time.perf_counter() - start

    return min(once() for _ in range(3))


print(json.dumps({name: least_seconds(name) for name in ("noisy 1e4", "clean 1e4")}))
