"""Derivatives against differences of EXACT itself, on generated pairs of buildings."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pound_solve.driver.request import Request
from pound_solve.sensitivity import Derivatives, derivatives
from sensitivity import pairs
from tiers import at_night

WITHOUT = {"contact_loss", "energy_residual", "correlation"}  #: quantities without derivatives
STEP = 1e-5  #: of the differences
#: largest deviation from extrapolated differences, and as a fraction of that between both steps
DEVIATION, OF_STEPS = 1e-6, 0.1


def differences(deck: Path, name: str, answer: Derivatives) -> dict[tuple[str, str], tuple[float, float]]:
    """Extrapolated differences by a PARAM of 1, and those of half the step less those of the whole one;
    empty if the runs have other events.
    """
    runs = [
        derivatives(Request(str(deck), {name: repr(1.0 + step)}), ())
        for step in (STEP, -STEP, 0.5 * STEP, -0.5 * STEP)
    ]
    if any(run.sequence != answer.sequence for run in runs):
        return {}
    both = {}
    for quantity, labels in answer.slopes.items():
        for label in labels:
            a, b, c, d = (run.values[quantity][label] for run in runs)
            whole, half = (a - b) / (2.0 * STEP), (c - d) / STEP
            both[quantity, label] = (4.0 * half - whole) / 3.0, half - whole
    return both


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
@pytest.mark.parametrize("seed", [2, 3, 4, 8, 43, *at_night(*range(10, 60))])
def test_derivatives_are_those_of_differences(tmp_path: Path, seed: int) -> None:
    text, names = pairs.deck(seed, 3)
    deck = tmp_path / "deck.inp"
    deck.write_text(text, encoding="utf-8")
    answer = derivatives(Request(str(deck)), names)
    assert len(answer.sequence) > 2
    assert not unexplained(answer)
    compared = 0
    for j, name in enumerate(names):
        for (quantity, label), (expected, steps) in differences(deck, name, answer).items():
            value, slope = answer.values[quantity][label], answer.slopes[quantity][label][j]
            size = max(abs(slope), abs(expected), 1e-2 * abs(value))
            assert abs(slope - expected) <= max(DEVIATION * size, OF_STEPS * abs(steps)), (
                name,
                quantity,
                label,
            )
            compared += 1
    assert compared > 10
