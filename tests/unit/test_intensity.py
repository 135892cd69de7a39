"""Intensity measures: closed forms, fine sums, and the table of the report."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import results_of
from pound_solve.loading.intensity import (
    HOUSNER,
    arias,
    cumulative_absolute_velocity,
    housner,
    intensity,
    significant_duration,
)
from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.spectrum import response_spectrum


def lines(*points: float) -> Piecewise:
    """Straight lines between time, value, time, value, ..."""
    return Piecewise.from_samples(points[::2], points[1::2])


def sine(amplitude: float, periods: int, n: int = 400) -> Piecewise:
    """Chords of a sine of period 1, `n` in each."""
    t = np.linspace(0.0, periods, periods * n + 1)
    return Piecewise.from_samples(t, amplitude * np.sin(2 * np.pi * t))


def test_a_sine() -> None:
    """Arias pi a^2 t / (4 g), CAV 2 a t / pi; velocity a/pi from rest, displacement a t / (2 pi)."""
    ground = sine(3.0, 8)
    x = math.pi / 400  # half of the angle of a chord
    # exact for chords: sums of sin^2 and of products of neighbours
    square = 0.5 * (1 - 2 / 3 * math.sin(x) ** 2)
    assert arias(ground, 9.81) == pytest.approx(math.pi / (2 * 9.81) * 9.0 * 8 * square, rel=1e-12)
    assert arias(ground, 9.81) == pytest.approx(math.pi * 9.0 * 8 / (4 * 9.81), rel=5e-5)
    assert cumulative_absolute_velocity(ground) == pytest.approx(
        3.0 * 8 * 2 / math.pi * x / math.tan(x), rel=1e-12
    )
    found = intensity(ground, 9.81)
    assert found.pga == pytest.approx(3.0, rel=1e-12)
    assert found.pgv == pytest.approx(3.0 / math.pi, rel=3e-5)
    assert found.pgd == pytest.approx(3.0 * 8 / (2 * math.pi), rel=3e-5)


def test_a_constant_acceleration_and_a_ramp() -> None:
    constant, ramp = lines(0, 2, 10, 2), lines(0, 0, 10, 5)
    assert arias(constant, 9.81) == pytest.approx(math.pi / (2 * 9.81) * 40, rel=1e-14)
    assert significant_duration(constant) == pytest.approx(9.0, rel=1e-13)
    assert significant_duration(constant, 0.05, 0.75) == pytest.approx(7.0, rel=1e-13)
    assert cumulative_absolute_velocity(constant) == pytest.approx(20.0, rel=1e-14)
    # the integral of the square grows with the cube of the time
    expected = 10 * (0.95 ** (1 / 3) - 0.05 ** (1 / 3))
    assert significant_duration(ramp) == pytest.approx(expected, rel=1e-13)
    assert cumulative_absolute_velocity(lines(0, -1, 4, 3)) == pytest.approx(
        0.5 * 1 * 1 + 0.5 * 3 * 3, rel=1e-14
    )


def test_a_jump_is_no_line() -> None:
    jump = Piecewise(np.array([0.0, 1.0, 3.0]), np.array([[2.0, -1.0], [0.0, 0.0]]))
    assert cumulative_absolute_velocity(jump) == pytest.approx(4.0, rel=1e-14)
    assert arias(jump, 1.0) == pytest.approx(math.pi / 2 * 6.0, rel=1e-14)


def test_quiet_before_and_after_does_not_count() -> None:
    ground = lines(0, 0, 5, 0, 5.5, 1, 6.5, -1, 7, 0, 50, 0)
    moved = lines(0, 0, 0.5, 1, 1.5, -1, 2, 0)
    for name in ("arias", "d5_75", "d5_95", "cav", "pga", "pgv", "housner"):
        assert getattr(intensity(ground, 9.81), name) == pytest.approx(
            getattr(intensity(moved, 9.81), name), rel=1e-11
        )


def test_no_motion_has_no_duration() -> None:
    found = intensity(Piecewise.zero(0.0, 3.0), 9.81)
    assert math.isnan(found.d5_95) and math.isnan(found.d5_75)
    assert (found.arias, found.cav, found.housner, found.pga) == (0.0, 0.0, 0.0, 0.0)


def test_the_spectrum_intensity_of_a_brief_shock() -> None:
    """Of an impulse I the undamped pseudo-velocity is I at every period; damped, it is a constant share."""
    shock, xi = lines(0, 1e5, 1e-5, 1e5), 0.05
    share = math.exp(-xi / math.sqrt(1 - xi**2) * math.acos(xi))
    assert housner(shock) == pytest.approx(2.4 * share, rel=1e-4)
    assert (HOUSNER[0], HOUSNER[-1]) == pytest.approx((0.1, 2.5), rel=1e-14)


def test_the_quadrature_of_the_spectrum_intensity() -> None:
    rng = np.random.default_rng(2)
    t = np.linspace(0, 12, 1201)
    ground = Piecewise.from_samples(
        t, np.sin(np.pi * t / 12) * np.convolve(rng.standard_normal(1201), np.ones(5), "same")
    )
    fine = np.linspace(0.1, 2.5, 1921)
    expected = np.trapezoid(response_spectrum(ground, fine).psv[0], fine)
    assert housner(ground) == pytest.approx(expected, rel=3e-3)


@settings(max_examples=40)
@given(st.integers(0, 1000), st.floats(0.1, 10.0))
def test_properties(seed: int, factor: float) -> None:
    rng = np.random.default_rng(seed)
    t, a = np.cumsum(rng.uniform(0.01, 0.2, 30)), rng.standard_normal(30)
    ground = Piecewise.from_samples(t, a)
    scaled = -factor * ground.divided(3)  # the other sign, another size, more breaks
    assert arias(scaled, 9.81) == pytest.approx(factor**2 * arias(ground, 9.81), rel=1e-12)
    assert cumulative_absolute_velocity(scaled) == pytest.approx(
        factor * cumulative_absolute_velocity(ground), rel=1e-12
    )
    assert significant_duration(scaled) == pytest.approx(significant_duration(ground), rel=1e-10)
    fine = np.linspace(t[0], t[-1], 200_001)
    values = np.interp(fine, t, a)
    total = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] ** 2 + values[:-1] ** 2))])
    between = np.interp([0.05, 0.75], total / total[-1], fine)
    assert significant_duration(ground, 0.05, 0.75) == pytest.approx(np.diff(between)[0], abs=2e-5)
    assert cumulative_absolute_velocity(ground) == pytest.approx(
        np.trapezoid(np.abs(values), fine), rel=1e-6
    )


DECK = """UNITS kN m s
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
ELEMENTS
 1 COLUMN 1 2
PROPS
 COLUMN SPRING KX=4000
WEIGHTS
 2 981
EQUAKE
 TABLE POINTS=0,0,0.5,2,1.5,-2,2,0
 TABLE POINTS=0,1,2,1 DIRECTION=R SCALE=0
 TABLE POINTS=0,3,2,3 DIRECTION=Y
ANALYSIS
{modal}
 HISTORY 2 METHOD=EXACT FROM=REST
"""


@pytest.mark.parametrize("modal", ["", " MODAL 1"])
def test_the_report_has_them_for_every_motion(tmp_path: Path, modal: str) -> None:
    deck = tmp_path / "model.inp"
    deck.write_text(DECK.format(modal=modal))
    with results_of(deck) as results:
        along, up = results.table("intensity")
        assert results.table_units("intensity")["arias"] == "m/s"
    ground = lines(0, 0, 0.5, 2, 1.5, -2, 2, 0)
    expected = intensity(ground, 9.81)
    assert (along["motion"], along["direction"], up["motion"]) == ("1 TABLE", "X", "3 TABLE")
    for name in ("arias", "d5_75", "d5_95", "cav", "housner"):
        assert along[name] == pytest.approx(getattr(expected, name), rel=1e-14)
    assert up["cav"] == pytest.approx(6.0, rel=1e-14)
    assert math.isnan(up["t1"])  # nothing moves in Y
    period = 2 * math.pi / math.sqrt(4000 / 100)
    if modal:
        assert along["t1"] == pytest.approx(period, rel=1e-12)
        assert along["sa_t1"] == pytest.approx(response_spectrum(ground, period).psa[0, 0], rel=1e-10)
    else:
        assert math.isnan(along["t1"]) and math.isnan(along["sa_t1"])
