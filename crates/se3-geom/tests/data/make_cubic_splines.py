"""Writes cubic_splines.json: C2 cubic splines solved exactly, in rational numbers, from the very doubles in the file.

Each piece is an unknown cubic of its own; the conditions (values, slopes, second derivatives, ends) are written down one by one
and the dense system is eliminated. Nothing of this is how the crate does it. Results are the doubles nearest to the exact ones.
"""

import json
from fractions import Fraction as F
from math import cos, sin

KNOTS = {
    "even": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
    "uneven": [-1.5, -1.25, 0.0, 0.7, 3.1, 3.3, 9.0],
    "ratio_1e5": [0.0, 1e-5, 1.0, 1.00001, 2.5],
    "four": [2.0, 2.5, 4.5, 5.0],
    "three": [0.0, 0.3, 1.7],
    "two": [-1.0, 2.0],
}
VALUES = {
    "waves": lambda t: sin(3 * t) + 0.3 * cos(7 * t),
    "far_away": lambda t: 1e3 + 2.0 * sin(t),
}


def power_row(t, derivative):
    """The factors of the four coefficients in the derivative at distance t from the piece's start."""
    row = [F(0)] * 4
    for k in range(derivative, 4):
        factor = 1
        for i in range(derivative):
            factor *= k - i
        row[k] = factor * t ** (k - derivative)
    return row


def solve(rows, right):
    n = len(right)
    for col in range(n):
        pivot = next(r for r in range(col, n) if rows[r][col] != 0)
        rows[col], rows[pivot] = rows[pivot], rows[col]
        right[col], right[pivot] = right[pivot], right[col]
        for r in range(n):
            if r != col and rows[r][col] != 0:
                q = rows[r][col] / rows[col][col]
                rows[r] = [a - q * b for a, b in zip(rows[r], rows[col])]
                right[r] -= q * right[col]
    return [right[i] / rows[i][i] for i in range(n)]


def spline(x, y, ends, slopes):
    x, y = [F(v) for v in x], [F(v) for v in y]
    n = len(x) - 1
    h = [b - a for a, b in zip(x, x[1:])]
    rows, right = [], []

    def condition(terms, value):
        row = [F(0)] * (4 * n)
        for piece, sign, factors in terms:
            for k in range(4):
                row[4 * piece + k] += sign * factors[k]
        rows.append(row)
        right.append(value)

    for i in range(n):
        condition([(i, 1, power_row(F(0), 0))], y[i])
        condition([(i, 1, power_row(h[i], 0))], y[i + 1])
    for i in range(n - 1):
        for d in (1, 2):
            condition([(i, 1, power_row(h[i], d)), (i + 1, -1, power_row(F(0), d))], F(0))
    if ends == "natural":
        condition([(0, 1, power_row(F(0), 2))], F(0))
        condition([(n - 1, 1, power_row(h[-1], 2))], F(0))
    elif ends == "clamped":
        condition([(0, 1, power_row(F(0), 1))], F(slopes[0]))
        condition([(n - 1, 1, power_row(h[-1], 1))], F(slopes[1]))
    elif ends == "periodic":
        for d in (1, 2):
            condition([(n - 1, 1, power_row(h[-1], d)), (0, -1, power_row(F(0), d))], F(0))
    elif n == 1:
        condition([(0, 1, power_row(F(0), 2))], F(0))
        condition([(0, 1, power_row(F(0), 3))], F(0))
    elif n == 2:
        condition([(0, 1, power_row(F(0), 3))], F(0))
        condition([(1, 1, power_row(F(0), 3))], F(0))
    else:
        for i in (0, n - 2):
            condition([(i, 1, power_row(F(0), 3)), (i + 1, -1, power_row(F(0), 3))], F(0))
    flat = solve(rows, right)
    return [flat[4 * i : 4 * i + 4] for i in range(n)]


def evaluate(x, pieces, t):
    i = max(i for i in range(len(pieces)) if F(x[i]) <= F(t))
    local = F(t) - F(x[i])
    return [float(sum(c * f for c, f in zip(pieces[i], power_row(local, d)))) for d in range(4)]


def main():
    cases = []
    for knots_name, x in KNOTS.items():
        for values_name, of in VALUES.items():
            for ends in ("natural", "clamped", "periodic", "not-a-knot"):
                if ends == "periodic" and len(x) < 4:
                    continue
                y = [of(t) for t in x]
                slopes = [1.25, -0.75] if ends == "clamped" else None
                if ends == "periodic":
                    y[-1] = y[0]
                pieces = spline(x, y, ends, slopes)
                at = [a + (b - a) * f for a, b in zip(x, x[1:]) for f in (0.0, 0.375, 0.75)]
                cases.append(
                    {
                        "name": f"{knots_name}/{values_name}/{ends}",
                        "knots": x,
                        "values": y,
                        "ends": ends,
                        "slopes": slopes,
                        "at": at,
                        "derivatives": [evaluate(x, pieces, t) for t in at],
                    }
                )
    with open("cubic_splines.json", "w", encoding="utf-8") as file:
        file.write("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]\n")


main()
