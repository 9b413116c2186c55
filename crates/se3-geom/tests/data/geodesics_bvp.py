"""Lengths of the geodesics in the figures 4.2 and 5.5 by scipy's collocation solver, which shares no method with the crate.

pip install numpy scipy; python geodesics_bvp.py > geodesics_bvp.json
Tolerance 1e-10 on the relative residual (see make_monge_bvp.py); the meridian of figure 5.5 by adaptive quadrature too.
"""

import json

import numpy as np
import scipy
from scipy.integrate import quad, solve_bvp

from make_monge_bvp import egg_box, saddle, solve

# The meridian of figure 5.5: z = q (RIM + WALL (1 - q)) with q = r^2.
RIM, WALL = 1.0629, 13


def shortest(jet, p, q, bows):
    return min(s["length"] for s in (solve(jet, p, q, bow) for bow in bows) if s)


def slope(r, wall=WALL):
    return 2 * r * (RIM + wall * (1 - 2 * r * r))


def meridian():
    """r' = -L / sqrt(1 + f'^2) from r = 1 to r = 0 in unit time, with the length L unknown. From a flat start it does not
    converge, so the wall is raised in steps."""
    t, r, length = np.linspace(0, 1, 2001), np.linspace(1, 0, 2001)[None], [1.5]
    for wall in np.linspace(0, WALL, 25):
        found = solve_bvp(
            lambda _, y, p: -p[0] / np.hypot(1, slope(y, wall)),
            lambda a, b, _: np.array([a[0] - 1, b[0]]),
            t, r, p=length, tol=1e-10 if wall == WALL else 1e-4, max_nodes=100000)
        assert found.status == 0, (wall, found.message)
        t, r, length = found.x, found.y, found.p
    return float(length[0])


if __name__ == "__main__":
    print(json.dumps({
        "scipy": scipy.__version__,
        "example_4_2": shortest(saddle, (1, 1), (-1, -1), (-0.5, 0.0, 0.5)),
        "example_4_3": shortest(egg_box, (-3, -3), (3, 3), (-0.5, -0.25, 0.0, 0.25, 0.5)),
        "figure_5_5": meridian(),
        "figure_5_5_by_quadrature": quad(lambda r: np.hypot(1, slope(r)), 0, 1, epsabs=1e-13, epsrel=1e-13)[0],
    }, indent=1))
