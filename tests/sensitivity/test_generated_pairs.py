"""Derivatives against differences of EXACT itself, on generated pairs of buildings."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pound_solve.driver.request import Request
from pound_solve.sensitivity import Derivatives, derivatives
from sensitivity import pairs
from tiers import at_night

QUICK = 2, 3, 4, 24, 31
#: the others up to 60 take longer than half a minute, or have a joint that jumps
LONG = {11, 12, 18, 19, 20, 21, 26, 29, 30, 33, 35, 37, 38, 41, 42, 55, 56, 57, 59}
NIGHT = sorted({*range(1, 61)} - {*QUICK} - LONG)
WITHOUT = {"contact_loss", "energy_residual", "correlation"}  #: quantities without derivatives
#: of the differences: the larger one is short of a change of events more rarely, the smaller one of digits
STEPS = 1e-4, 1e-5
DEVIATION = 1e-6  #: from one of the differences
SMALL = 1e-2  #: derivatives below this fraction of the quantity are rounding of the differences
SIZE = {"residual_drift": "storey_drift"}  #: quantity that has the size of another one


def differences(deck: Path, name: str, step: float, answer: Derivatives) -> dict[tuple[str, str], float]:
    """Differences by a PARAM of 1, extrapolated from a step and its half; empty if the runs have other
    events.
    """
    runs = [
        derivatives(Request(str(deck), {name: repr(1.0 + x)}), ())
        for x in (step, -step, 0.5 * step, -0.5 * step)
    ]
    if any(run.sequence != answer.sequence for run in runs):
        return {}
    both = {}
    for quantity, labels in answer.slopes.items():
        for label in labels:
            a, b, c, d = (run.values[quantity][label] for run in runs)
            both[quantity, label] = (4.0 * (c - d) / step - (a - b) / (2.0 * step)) / 3.0
    return both


def compared(deck: Path, names: list[str]) -> dict[tuple[str, str, str], float]:
    """Deviations from the nearest differences, by PARAM, quantity and label."""
    answer = derivatives(Request(str(deck)), names)
    assert not unexplained(answer)
    deviations: dict[tuple[str, str, str], float] = {}
    for j, name in enumerate(names):
        for step in STEPS:
            for (quantity, label), expected in differences(deck, name, step, answer).items():
                slope = answer.slopes[quantity][label][j]
                value = answer.values[SIZE.get(quantity, quantity)][label]
                size = max(abs(slope), abs(expected), SMALL * abs(value))
                key = name, quantity, label
                deviations[key] = min(abs(slope - expected) / (size or 1.0), deviations.get(key, math.inf))
    return deviations


def unexplained(answer: Derivatives) -> list[tuple[str, str]]:
    """Quantities that have neither derivatives nor a flag, but for those that never have any."""
    return [
        (quantity, label)
        for quantity, labels in answer.values.items()
        for label, value in labels.items()
        if math.isfinite(value) and quantity not in WITHOUT
        if label not in answer.slopes.get(quantity, {})
        if not any(flag.startswith(f"{quantity} {label} ") for flag in answer.flags)
    ]


@pytest.mark.full
@pytest.mark.parametrize("seed", [*QUICK, *at_night(*NIGHT)])
def test_derivatives_are_those_of_differences(tmp_path: Path, seed: int) -> None:
    text, names = pairs.deck(seed, 2)
    deck = tmp_path / "deck.inp"
    deck.write_text(text, encoding="utf-8")
    deviations = compared(deck, names)
    assert len(deviations) > 10
    assert max(deviations.values()) <= DEVIATION, max(deviations, key=deviations.__getitem__)


MOVED = """UNITS kN m s
PARAM gap = 1
PARAM motion = 1
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 1 0 FIX=XYR
 4 1 3 FIX=YR
ELEMENTS
 1 COL 1 2
 2 WALL 2 4
 3 STIFF 3 4
PROPS
 COL SPRING KX=4000 RULE=BILINEAR FX=40 R=0.1
 STIFF SPRING KX=9000
 WALL CONTACT GAP=0.01*gap ANGLE=0 LAW=KELVIN_VOIGT K=1E5 E=0.65
WEIGHTS
 2,4 981
DAMPING
 RAYLEIGH ALPHA=0.4 BETA=0.001
EQUAKE
 SINE AMPLITUDE=2*motion PERIOD=0.6 DURATION=1 SUPPORTS=1
 SINE AMPLITUDE=3*motion PERIOD=0.6 DURATION=1 SUPPORTS=3
ANALYSIS
 HISTORY 1 METHOD=EXACT
"""


@pytest.mark.slow
def test_derivatives_with_supports_that_move_apart(tmp_path: Path) -> None:
    deck = tmp_path / "deck.inp"
    deck.write_text(MOVED, encoding="utf-8")
    deviations = compared(deck, ["gap", "motion"])
    assert len(deviations) > 20
    assert max(deviations.values()) <= DEVIATION
