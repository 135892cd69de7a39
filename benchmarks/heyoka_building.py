"""One elastic building of the paper by heyoka, a Taylor integrator that compiles each system; prints JSON.

Runs in an environment of its own (pip install heyoka numpy); see ``pair_building.py``.
"""

import argparse
import json
import time

import heyoka as hy
import numpy as np
from two_buildings import BUILDINGS, G, rayleigh


def building(n):
    """Mass, damping and stiffness of building 1 with `n` elements in each diaphragm [t, kN s/m, kN/m].

    Unknowns 0 to n are floor 1, the next n + 1 the roof.
    """
    b = BUILDINGS[1]
    size = 2 * (n + 1)
    share = np.r_[0.5, np.ones(n - 1), 0.5] / n
    mass = np.tile(b["W"] / G * share, 2)
    columns, slabs = np.zeros((size, size)), np.zeros((size, size))

    def spring(k, i, j, into):
        into[i, i] += k
        if j is not None:
            into[j, j] += k
            into[i, j] -= k
            into[j, i] -= k

    for end in (0, n):
        spring(b["k"] / 2, end, None, columns)
        spring(b["k"] / 2, end, n + 1 + end, columns)
    for floor in (0, n + 1):
        for i in range(n):
            spring(n * b["kD"], floor + i, floor + i + 1, slabs)
    alpha, beta = rayleigh(b)
    return mass, alpha * np.diag(mass) + beta * columns, columns + slabs


def main():
    """Integrate, and print the times and the last displacements of both floors' left ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--n", type=int, default=20)
    parser.add_argument("--duration", type=float, default=10.0)
    parser.add_argument("--tol", type=float, default=1e-15)
    parser.add_argument("--repeat", type=int, default=5)
    args = parser.parse_args()
    mass, damping, stiffness = building(args.n)
    size = len(mass)
    u, v = (hy.make_vars(*(f"{name}{i}" for i in range(size))) for name in "uv")
    right = []
    for i in range(size):
        terms = [(-stiffness[i, j] / mass[i]) * u[j] for j in np.flatnonzero(stiffness[i])]
        terms += [(-damping[i, j] / mass[i]) * v[j] for j in np.flatnonzero(damping[i])]
        right.append((v[i], hy.sum(terms)))
    start = np.r_[np.zeros(size), np.zeros(size // 2), np.ones(size // 2)]
    out = {}
    for compact in (True, False):
        begun = time.process_time()
        system = [*zip(u, v), *((v[i], right[i][1]) for i in range(size))]
        solver = hy.taylor_adaptive(system, start, tol=args.tol, compact_mode=compact)
        compiled, best = time.process_time() - begun, float("inf")
        for _ in range(args.repeat):
            solver.time, solver.state[:] = 0.0, start
            begun = time.process_time()
            steps = solver.propagate_until(args.duration)[3]
            best = min(best, time.process_time() - begun)
        name = "compact" if compact else "unrolled"
        out[name] = {"compilation": compiled, "solution": best, "steps": int(steps)}
        out[name]["ends"] = [float(solver.state[0]), float(solver.state[size // 2])]
    print(json.dumps(out))


if __name__ == "__main__":
    main()
