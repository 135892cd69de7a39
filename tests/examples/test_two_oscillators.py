"""Example 01 against an independent integration, and NEWMARK against EXACT."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

DECK = Path(__file__).parents[2] / "examples" / "01_two_oscillators" / "two_oscillators.inp"

# the deck's numbers, written down a second time
MASS, OMEGA, XI = 1000 / 9.81, 2 * np.pi / np.array([0.8, 0.4]), 0.05
K, GAP, E = 1e6, 0.01, 0.65
END, QUIET = 5.0, 3.0


def dashpot() -> float:
    """Dashpot of the contact, from the restitution of a free impact that ends at zero force."""
    xi = brentq(lambda x: np.exp(-2 * x * np.arccos(x) / np.sqrt(1 - x * x)) - E, 1e-6, 0.9, xtol=1e-15)
    return 2 * xi * np.sqrt(K * MASS / 2)


def integrate() -> tuple[np.ndarray, np.ndarray]:
    """Extremes of both drifts, shape (2, 2), and collisions (start, end, velocities), shape (n, 4).

    Where a velocity is zero its drift is stationary: those instants are events too, so nothing is sampled.
    """
    c_contact = dashpot()

    def contact(y: np.ndarray) -> float:
        return K * (y[0] - y[1] - GAP) + c_contact * (y[2] - y[3])

    def motion(pressed: bool, shaken: bool):
        def f(t: float, y: np.ndarray) -> np.ndarray:
            force = contact(y) if pressed else 0.0
            ground = np.sin(2 * np.pi * t / 0.6) if shaken else 0.0
            pull = np.array([-force, force]) / MASS
            return np.r_[y[2:], pull - OMEGA**2 * y[:2] - 2 * XI * OMEGA * y[2:] - ground]

        return f

    def closes(t: float, y: np.ndarray) -> float:
        return y[0] - y[1] - GAP

    def opens(t: float, y: np.ndarray) -> float:
        return contact(y)

    closes.terminal = opens.terminal = True
    closes.direction, opens.direction = 1, -1
    stops = [lambda t, y: y[2], lambda t, y: y[3]]

    t, y, pressed = 0.0, np.zeros(4), False
    found: list[tuple[int, float]] = []
    collisions: list[list[float]] = []
    while t < END:
        shaken = t < QUIET
        s = solve_ivp(
            motion(pressed, shaken),
            (t, QUIET if shaken else END),
            y,
            method="DOP853",
            rtol=1e-12,
            atol=1e-15,
            events=[opens if pressed else closes, *stops],
            max_step=0.01,
        )
        found += [(i, state[i]) for i in range(2) for state in s.y_events[1 + i]]
        t, y = float(s.t[-1]), s.y[:, -1]
        if s.status == 1:
            if pressed:
                collisions[-1] += [t, y[3] - y[2]]
            else:
                collisions.append([t, y[2] - y[3]])
            pressed = not pressed
    extremes = np.array([[pick(d for j, d in found if j == i) for pick in (max, min)] for i in range(2)])
    return extremes, np.array([[a, b, v0, v1] for a, v0, b, v1 in collisions])


@pytest.fixture(scope="module")
def exact(run):
    return run(DECK)[1]


def test_an_independent_integration_agrees(exact):
    extremes, collisions = integrate()
    drifts, table = exact.table("drift_envelope"), exact.table("collisions")
    np.testing.assert_allclose(np.c_[drifts["max"], drifts["min"]], extremes, rtol=1e-9)
    np.testing.assert_allclose(np.c_[table["t_start"], table["t_end"]], collisions[:, :2], rtol=1e-9)
    speeds = np.c_[table["approach_velocity"], table["separation_velocity"]]
    np.testing.assert_allclose(speeds, collisions[:, 2:], rtol=1e-7)


@pytest.mark.full
def test_newmark_comes_near_and_nearer(exact, run):
    def quantities(results) -> np.ndarray:
        d, c = results.table("drift_envelope"), results.table("contact_summary")
        return np.r_[d["max"], d["min"], c["peak_force"], c["impulse"]]

    assert exact.table("run")["value"][1].startswith(("EXACT", "TAYLOR"))
    errors = []
    for dt in (2e-3, 1e-3, 5e-4):
        _, results, _ = run(DECK, None, "NEWMARK", dt)
        assert results.table("contact_summary")["closures"].tolist() == [8]
        errors.append(np.abs(quantities(results) / quantities(exact) - 1))
    # the figures of the README, drifts and peak force
    assert errors[1][:4].max() < 1.0e-3 and errors[1][4] < 1.3e-3
    assert errors[2][:4].max() < 2.7e-4 and errors[2][4] < 3.3e-4
    for coarse, fine in pairwise(errors):
        assert np.all(np.log2(coarse / fine) > 1.4)  # second order; 2e-3 is too coarse for the clean rate
    assert np.all(np.log2(errors[1] / errors[2]) > 1.8)
