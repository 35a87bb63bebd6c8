"""Octahedral cubature rules: weights (of a total of 1) and free coordinates that solve the moment equations.

`python3 octahedral_rules.py` (mpmath) prints the constants of `src/product/octahedral.rs`. On the sphere a monomial of a lower
even degree is a sum of monomials of the top degree, so these suffice; by symmetry exponents are even and in falling order.
"""
from itertools import permutations, product

from mpmath import findroot, mp, mpf, nstr, sqrt

mp.dps = 40


def double_factorial(k):
    return mpf(1) if k < 2 else k * double_factorial(k - 2)


def moment(exponents):
    a, b, c = exponents
    above = double_factorial(a - 1) * double_factorial(b - 1) * double_factorial(c - 1)
    return above / double_factorial(a + b + c + 1)


def orbit(kind, p=None):
    point = {
        "faces": lambda: (1, 0, 0),
        "edges": lambda: (sqrt(mpf(1) / 2), sqrt(mpf(1) / 2), 0),
        "corners": lambda: (sqrt(mpf(1) / 3),) * 3,
        "diagonals": lambda: (p, p, sqrt(1 - 2 * p * p)),
        "sides": lambda: (p, sqrt(1 - p * p), 0),
    }[kind]()
    signs = list(product((1, -1), repeat=3))
    return {tuple(mpf(s * x) for s, x in zip(sign, q)) for q in set(permutations(point)) for sign in signs}


def solve(kinds, degree, start):
    monomials = [(degree - b - c, b, c) for b in range(0, degree + 1, 2) for c in range(0, b + 1, 2) if degree - b - c >= b]

    def residuals(*x):
        weights, free = x[: len(kinds)], list(x[len(kinds):])
        orbits = [orbit(kind, free.pop(0)) if kind in ("diagonals", "sides") else orbit(kind) for kind in kinds]
        sums = [sum(w * sum(p[0]**a * p[1]**b * p[2]**c for p in o) for w, o in zip(weights, orbits)) for a, b, c in monomials]
        return [s / moment(e) - 1 for s, e in zip(sums, monomials)]

    return findroot(residuals, [mpf(x) for x in start], tol=1e-30, maxsteps=60)


print(6, [nstr(x, 20) for x in solve(["faces", "edges", "corners"], 6, [0.05, 0.04, 0.03])])
print(8, [nstr(x, 20) for x in solve(["faces", "corners", "sides"], 8, [0.01, 0.03, 0.03, 0.46])])
kinds = ["faces", "corners", "diagonals", "diagonals", "sides"]
print(14, [nstr(x, 20) for x in solve(kinds, 14, [0.0115, 0.0119, 0.0111, 0.0119, 0.0118, 0.37, 0.6943, 0.3742])])
