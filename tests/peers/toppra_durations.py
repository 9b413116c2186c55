"""The least durations of paths under limits of joint velocity and acceleration, by toppra (Pham & Pham, T-RO 2018).

Reads {"paths": [{"gridpoints": [n], "q": [n][dof], "dq": ..., "ddq": ..., "velocity": [dof], "acceleration": [dof]}]} from the file
named, prints the durations in s as a JSON list. toppra sees the path's own derivatives at the gridpoints, so that no other spline
stands between.
"""

import json
import sys

import numpy as np
import toppra
from toppra.algorithm import TOPPRA
from toppra.constraint import DiscretizationType, JointAccelerationConstraint, JointVelocityConstraint
from toppra.interpolator import AbstractGeometricPath


class Tabulated(AbstractGeometricPath):
    """A path that is known at its gridpoints alone, with its derivatives."""

    def __init__(self, given):
        self.gridpoints = np.array(given["gridpoints"])
        self.derivatives = [np.array(given[name]) for name in ("q", "dq", "ddq")]

    def __call__(self, path_positions, order=0):
        index = np.searchsorted(self.gridpoints, path_positions)
        if not np.array_equal(self.gridpoints[index], path_positions):
            raise ValueError("the path is known at its gridpoints only")
        return self.derivatives[order][index]

    @property
    def dof(self):
        return self.derivatives[0].shape[1]

    @property
    def path_interval(self):
        return self.gridpoints[[0, -1]]


def duration(given):
    path = Tabulated(given)
    symmetric = [np.outer(given[name], [-1.0, 1.0]) for name in ("velocity", "acceleration")]
    constraints = [
        JointVelocityConstraint(symmetric[0]),
        JointAccelerationConstraint(symmetric[1], discretization_scheme=DiscretizationType.Interpolation),
    ]
    instance = TOPPRA(constraints, path, gridpoints=path.gridpoints, solver_wrapper="seidel")
    _, speeds, _ = instance.compute_parameterization(0.0, 0.0)
    if speeds is None or not np.isfinite(speeds).all():
        raise ValueError("toppra found no parameterization")
    # The path acceleration is constant between gridpoints.
    return float(np.sum(2.0 * np.diff(path.gridpoints) / (speeds[1:] + speeds[:-1])))


def main():
    toppra.setup_logging("ERROR")
    with open(sys.argv[1], encoding="utf-8") as text:
        paths = json.load(text)["paths"]
    print(json.dumps([duration(given) for given in paths]))


if __name__ == "__main__":
    main()
