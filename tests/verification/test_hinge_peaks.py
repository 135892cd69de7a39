"""Peaks of the hinges of a frame by every rule and method, against another method."""

from __future__ import annotations

import pytest

from tiers import each_once
from verification.hinge_peaks import JOINTS, METHODS, RULES, Frames

pytestmark = pytest.mark.full

BOUNDS = {"AUTO": 1e-3, "TAYLOR": 1e-4, "LAGUERRE": 1e-6}  #: of the others 1e-2: their steps are of 2 ms
LEFT_OUT = ("WAYNE_STEWART",)  #: its hinges fall, which no step follows
frames = Frames()


@each_once(
    ("rule", [rule for rule in RULES if rule not in LEFT_OUT]),
    ("joints", [*JOINTS]),
    ("method", [method for method in METHODS if method != "EXACT"]),
    at_most=5,
)
def test_peaks_are_those_of_another_method(rule: str, joints: str, method: str) -> None:
    found = frames.deviation(rule, joints, method)
    if frames.by(rule, joints, method).message.startswith("A505"):  # it does not take such a law
        assert method in ("TAYLOR", "LAGUERRE")
        return
    assert isinstance(found, float) and found < BOUNDS.get(method, 1e-2), found


@pytest.mark.parametrize(("rule", "joints"), [("BOUC_WEN", "massless"), ("RAMBERG_OSGOOD", "mass")])
def test_rules_that_turn_with_the_rate_begin_at_rest(rule: str, joints: str) -> None:
    """Loads without moments: rates of 1e-19, which are rounding, turned them for ever."""
    assert frames.by(rule, joints, "NEWMARK").status == "done"
