"""The paper's two buildings with lumped floors by scipy's ``solve_ivp``: the second peer of pair_lumped.py.

Horizontal DOF only; units kN, m, s, t.  Between two changes (a column yields or unloads, a contact
touches or lets go) the equations are smooth; each change is a terminal event, after which the integration
starts again.  Drift and force peaks are events too, which only note themselves.  Needs numpy and scipy.
LSODA is left out: between its steps scipy interpolates with jumps, in which it then finds no root.

Prints one JSON object, in the form of ``opensees_cole.py``; each peak is a root that scipy polishes.
"""

import argparse
import json
import time

import numpy as np
from scipy.integrate import solve_ivp
from two_buildings import BUILDINGS, GAP, STIFF, G, rayleigh, read_two_columns

# DOFs: building 1 floors 1 and 2, building 2 floors 1 and 2; columns in the order of their storeys
DRIFT = np.array([[1, 0, 0, 0], [-1, 1, 0, 0], [0, 0, 1, 0], [0, 0, -1, 1]], float)
CLOSE = np.array([[1, 0, -1, 0], [0, 1, 0, -1]], float)
NAMES = [f"B{j} storey {i}" for j in BUILDINGS for i in (1, 2)]
MASS = np.repeat([b["W"] / G for b in BUILDINGS.values()], 2)
K = np.repeat([b["k"] for b in BUILDINGS.values()], 2)
FY = np.repeat([b["Fy"] for b in BUILDINGS.values()], 2)
ALPHA, BETA = np.repeat([rayleigh(b) for b in BUILDINGS.values()], 2, axis=0).T


class Model:
    """The lumped buildings: their state of columns and contacts, and the smooth equations that it gives."""

    def __init__(self, record, k_contact, c_contact):
        self.times, self.ground = (np.array(x) for x in read_two_columns(record))
        self.k, self.c = k_contact, c_contact
        self.slip = np.zeros(4)  # plastic drift
        self.flow = np.zeros(4)  # 0 elastic, +-1 yields forwards, backwards
        self.pressed = np.zeros(2, bool)
        self.form()

    def form(self):
        """Matrices of y' = a y + b + ground acceleration x e, for the present state."""
        elastic, p = self.flow == 0, CLOSE[self.pressed]
        k = DRIFT.T @ np.diag(K * elastic) @ DRIFT + self.k * p.T @ p
        c = DRIFT.T @ np.diag(BETA * K) @ DRIFT + np.diag(ALPHA * MASS) + self.c * p.T @ p
        f0 = np.where(elastic, -K * self.slip, self.flow * FY)
        held = DRIFT.T @ f0 - self.k * GAP * p.sum(axis=0)
        self.a = np.block([[np.zeros((4, 4)), np.eye(4)], [-k / MASS[:, None], -c / MASS[:, None]]])
        self.b = np.concatenate([np.zeros(4), -held / MASS])
        self.e = np.concatenate([np.zeros(4), np.full(4, -G)])

    def rate(self, t, y):
        """Right-hand side."""
        return self.a @ y + self.b + self.e * np.interp(t, self.times, self.ground)

    def force(self, contact, y):
        """Force of a pressed contact [kN]."""
        row = CLOSE[contact]
        return self.k * (row @ y[:4] - GAP) + self.c * (row @ y[4:])

    def changes(self):
        """Events that end the present state: (function, direction, what to do)."""
        for i, row in enumerate(DRIFT):
            if self.flow[i]:  # unloads where its rate turns

                def reversal(y, i=i, row=row):
                    self.slip[i] = row @ y[:4] - self.flow[i] * FY[i] / K[i]
                    self.flow[i] = 0

                yield (lambda t, y, row=row: row @ y[4:]), -self.flow[i], reversal
                continue
            for sign in (1.0, -1.0):

                def yields(y, i=i, sign=sign):
                    self.flow[i] = sign

                limit = self.slip[i] + sign * FY[i] / K[i]
                yield (lambda t, y, row=row, limit=limit: row @ y[:4] - limit), sign, yields
        for i, row in enumerate(CLOSE):

            def flips(y, i=i):
                self.pressed[i] = not self.pressed[i]

            yield (lambda t, y, row=row: row @ y[:4] - GAP), (-1.0 if self.pressed[i] else 1.0), flips

    def peaks(self):
        """Events that only note a turning drift or contact force: (function, index)."""
        for i, row in enumerate(DRIFT):
            yield (lambda t, y, row=row: row @ y[4:]), i
        for i in np.flatnonzero(self.pressed):
            row = CLOSE[i]
            if self.c:
                yield (lambda t, y, row=row: row @ (self.k * y[4:] + self.c * self.rate(t, y)[4:])), 4 + i
            else:
                yield (lambda t, y, row=row: row @ y[4:]), 4 + i


def event(function, direction, terminal):
    """The function as an event of solve_ivp."""

    def g(t, y):
        return function(t, y)

    g.direction, g.terminal = direction, terminal
    return g


def analyse(record, method, rtol, duration, k_contact, c_contact):
    """Run once and return the results as a dict; reading the record is left out of the time."""
    model = Model(record, k_contact, c_contact)
    longest = float(model.times[1])  # a longer step would miss samples
    start, used = time.perf_counter(), time.process_time()
    t, y = 0.0, np.zeros(8)
    scale = np.concatenate([np.full(4, 1e-2), np.full(4, 0.1)])  # of displacements [m] and velocities [m/s]
    high, low, peak, closures, evaluations, restarts = [0.0] * 4, [0.0] * 4, [0.0] * 2, [0, 0], 0, 0
    while t < duration:
        model.form()
        changes, peaks = list(model.changes()), list(model.peaks())
        events = [event(g, way, True) for g, way, _ in changes] + [event(g, 0.0, False) for g, _ in peaks]
        own = {"jac": model.a} if method == "Radau" else {}
        step = solve_ivp(
            model.rate, (t, duration), y, method, events=events, rtol=rtol, atol=rtol * scale,
            max_step=longest, **own,
        )  # fmt: skip
        evaluations, restarts = evaluations + step.nfev, restarts + 1
        for (_, i), turns in zip(peaks, step.y_events[len(changes) :]):
            for at in turns:
                if i < 4:
                    high[i], low[i] = max(high[i], DRIFT[i] @ at[:4]), min(low[i], DRIFT[i] @ at[:4])
                else:
                    peak[i - 4] = max(peak[i - 4], model.force(i - 4, at))
        t, y = float(step.t[-1]), step.y[:, -1].copy()
        for (_, _, act), hits in zip(changes, step.y_events):
            if len(hits):
                act(y)
        for i, row in enumerate(DRIFT):
            high[i], low[i] = max(high[i], row @ y[:4]), min(low[i], row @ y[:4])
        for i, hits in enumerate(step.y_events[len(changes) - 2 : len(changes)]):
            if len(hits) and model.pressed[i]:
                closures[i] += 1
                peak[i] = max(peak[i], model.force(i, y))  # a dashpot presses at once
    used, seconds = time.process_time() - used, time.perf_counter() - start
    return {
        "program": "scipy",
        "solver": method,
        "rtol": rtol,
        "solve_seconds": seconds,
        "cpu_seconds": used,
        "evaluations": evaluations,
        "restarts": restarts,
        "sane": bool(np.isfinite(y).all()),
        "drift": {name: [float(hi), float(lo)] for name, hi, lo in zip(NAMES, high, low)},
        "peak_force": [float(f) for f in peak],
        "closures": closures,
    }


def main():
    """Read the command line, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("record", help="file of two columns: time [s], ground acceleration [g]")
    add("--method", choices=["RK45", "DOP853", "Radau"], default="DOP853")
    add("--rtol", type=float, default=1e-6)
    add("--duration", type=float, default=10.0, help="analysed time [s]")
    add("--k-contact", type=float, default=10 * STIFF, help="[kN/m]")
    add("--c-contact", type=float, default=0.0, help="[kN s/m]; it may pull until the overlap is gone")
    print(json.dumps(analyse(**vars(parser.parse_args())), indent=1))


if __name__ == "__main__":
    main()
