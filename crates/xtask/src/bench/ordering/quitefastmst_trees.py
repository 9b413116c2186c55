"""Prints the seconds that quitefastmst takes for its trees on one thread, as JSON: least of a few, processor time."""
import json
import os
import sys
import time

import numpy as np
import quitefastmst

quitefastmst.omp_set_num_threads(1)
folder, costs = sys.argv[1], {}
for name, dimension, repeats in (("r3 1e6", 3, 1), ("r7 1e5", 7, 3), ("embedded smooth 1e5", 7, 3)):
    points = np.fromfile(os.path.join(folder, name)).reshape(-1, dimension)
    quitefastmst.mst_euclid(points[:2000].copy(), M=0)
    taken = []
    for _ in range(repeats):
        start = time.process_time()
        quitefastmst.mst_euclid(points, M=0)
        taken.append(time.process_time() - start)
    costs[name] = min(taken)
print(json.dumps(costs))
