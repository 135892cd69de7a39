"""Derivatives of responses whose closed forms are known."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from decks import results_of
from pound_solve.driver.request import Request
from pound_solve.sensitivity import derivatives

STEP = 1e-30  #: of complex differences, which have no rounding

WALL = """UNITS kN m s
PARAM {params}
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 COL 1 2
 2 WALL 2
PROPS
 COL SPRING KX=ks {rule}
 WALL CONTACT GAP=gap ANGLE=0 LAW={law}
WEIGHTS
 2 m*9.81
DRIFT
 "d" 1 2
INITIAL
 2 VX=v
ANALYSIS
 HISTORY {length} METHOD=EXACT
OUTPUT
 EVERY=0.1
"""
BALLS = """UNITS kN m s
PARAM {params}
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
ELEMENTS
 1 MEET 2 3
PROPS
 MEET CONTACT GAP=gap ANGLE=0 LAW=LINEAR K=k
WEIGHTS
 2,3 m*9.81
DRIFT
 "first" 1 2
 "second" 1 3
INITIAL
 2 VX=v
 3 VX=w
ANALYSIS
 HISTORY 1 METHOD=EXACT
OUTPUT
 EVERY=0.1
"""


def compared(
    folder: Path,
    deck: str,
    values: dict[str, float],
    quantity: str,
    label: str,
    closed: Callable[..., complex],
) -> None:
    """Compare a quantity and its derivatives by all PARAMs with its closed form."""
    path = folder / "deck.inp"
    path.write_text(deck, encoding="utf-8")
    answer = derivatives(Request(str(path)), list(values))
    expected = [closed(**values | {name: x + STEP * 1j}).imag / STEP for name, x in values.items()]
    assert answer.values[quantity][label] == pytest.approx(closed(**values).real, rel=1e-11)
    size = np.abs(answer.values[quantity][label] / np.array(list(values.values())))
    assert (np.abs(answer.slopes[quantity][label] - expected) <= 1e-10 * (np.abs(expected) + size)).all()


def params(values: dict[str, float]) -> str:
    return " ".join(f"{name}={x!r}" for name, x in values.items())


def force_of_linear_wall(ks: complex, gap: complex, k: complex, m: complex, v: complex) -> complex:
    """Peak force of a mass on a spring that leaves the origin at `v` and strikes a LINEAR wall."""
    arrival = cmath.sqrt(v * v - ks / m * gap * gap)
    middle, omega2 = k * gap / (ks + k), (ks + k) / m
    return k * (middle + cmath.sqrt((gap - middle) ** 2 + arrival**2 / omega2) - gap)


def test_peak_force_of_a_linear_wall(tmp_path: Path) -> None:
    values = {"ks": 900.0, "gap": 0.02, "k": 4e4, "m": 40.0, "v": 0.3}
    deck = WALL.format(params=params(values), rule="", law="LINEAR K=k", length=0.5)
    compared(tmp_path, deck, values, "contact_force", "2", force_of_linear_wall)
    compared(tmp_path, deck, values, "penetration", "2", lambda k, **x: force_of_linear_wall(k=k, **x) / k)


def test_a_dashpot_that_closes_has_its_peak_force_at_the_moving_instant(tmp_path: Path) -> None:
    values = {"ks": 900.0, "gap": 0.02, "k": 1e4, "c": 2000.0, "m": 40.0, "v": 0.3}
    deck = WALL.format(params=params(values), rule="", law="KELVIN_VOIGT K=k C=c", length=0.5)

    def closed(ks: complex, gap: complex, k: complex, c: complex, m: complex, v: complex) -> complex:
        return c * cmath.sqrt(v * v - ks / m * gap * gap)

    compared(tmp_path, deck, values, "contact_force", "2", closed)


def test_impulse_of_a_linear_wall(tmp_path: Path) -> None:
    """It turns the velocity of the mass round; the spring, which acts meanwhile, is a tiny one."""
    values = {"gap": 0.02, "k": 4e4, "m": 40.0, "v": 0.3}
    deck = WALL.format(params=params(values), rule="", law="LINEAR K=k", length=0.5).replace(
        "KX=ks", "KX=1e-9"
    )
    compared(tmp_path, deck, values, "impulse", "2", lambda gap, k, m, v: 2.0 * m * v)


def test_ductility_of_an_elastoplastic_spring(tmp_path: Path) -> None:
    values = {"ks": 900.0, "fy": 6.0, "m": 40.0, "v": 0.3}
    deck = WALL.format(params=params(values), rule="FX=fy RULE=BILINEAR R=0", law="LINEAR K=1E4", length=3)

    def closed(ks: complex, fy: complex, m: complex, v: complex) -> complex:
        return 0.5 * (1.0 + m * v * v * ks / fy**2)

    compared(tmp_path, deck.replace("GAP=gap", "GAP=9"), values, "ductility", "1 X", closed)


@pytest.mark.parametrize("first", [True, False])
def test_equal_balls_exchange_their_velocities(tmp_path: Path, first: bool) -> None:
    """The displacements at the end: their derivatives by velocities before the collision grow at 0 or 1."""
    values = {"gap": 0.05, "k": 4e4, "m": 40.0, "v": 0.5, "w": 0.1}
    deck = BALLS.format(params=params(values))

    def closed(gap: complex, k: complex, m: complex, v: complex, w: complex) -> complex:
        parted = gap / (v - w) + math.pi / cmath.sqrt(2.0 * k / m)
        apart = gap - (v - w) * (1.0 - parted)
        return 0.5 * (v + w) + (0.5 if first else -0.5) * apart

    compared(tmp_path, deck, values, "peak_drift", "first" if first else "second", closed)


def test_values_are_those_of_the_run(tmp_path: Path) -> None:
    values = {"ks": 900.0, "gap": 0.02, "k": 1e4, "m": 40.0, "v": 0.3}
    path = tmp_path / "deck.inp"
    path.write_text(
        WALL.format(params=params(values), rule="", law="LINEAR K=k", length=0.5), encoding="utf-8"
    )
    answer, results = derivatives(Request(str(path)), ["k"]), results_of(path)
    contact, drift = results.table("contact_summary"), results.table("drift_envelope")
    assert answer.values["contact_force"]["2"] == pytest.approx(contact["peak_force"][0], rel=1e-13)
    assert answer.values["min_gap"]["2"] == pytest.approx(contact["min_gap"][0], rel=1e-13)
    assert answer.values["peak_drift"]["d"] == pytest.approx(
        max(drift["max"][0], -drift["min"][0]), rel=1e-13
    )
