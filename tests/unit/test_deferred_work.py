"""EXACT between events: works are taken in lots, growth is looked for with them, searches have a cost."""

from __future__ import annotations

import numpy as np
import pytest

from pound_solve.integrate import costs
from pound_solve.integrate.closed_form import exact
from pound_solve.integrate.closed_form.deferred_work import DeferredWork
from pound_solve.numerics.types import Array
from verification.cases import run_text

DECK = """UNITS kN m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 A 1 2
PROPS
 A SPRING KX=25 {law}
WEIGHTS
 2 1
INITIAL
 2 VX=2
{motion}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY {end} METHOD=EXACT
"""


def test_works_are_taken_in_lots(monkeypatch: pytest.MonkeyPatch) -> None:
    """More intervals than are waited for are taken on the way; no lot changes the motion or its balance."""
    lots: list[int] = []
    real = DeferredWork.evaluated

    def evaluated(self: DeferredWork) -> tuple[Array, dict[int, float]]:
        lots.append(self.entries)
        return real(self)

    monkeypatch.setattr(DeferredWork, "evaluated", evaluated)
    deck = DECK.format(law="", motion="EQUAKE\n SINE AMPLITUDE=1 PERIOD=0.7", end=1)
    found = {}
    for most in (16, 10**6):
        lots.clear()
        monkeypatch.setattr(exact, "MAX_DEFERRED", most)
        found[most] = run_text(deck)
        assert found[most].status == "done" and found[most].check() < 1e-12
        taken = [n for n in lots if n]
        assert sum(taken) >= 100 and (len(taken) > 1) is (most == 16)
    assert np.abs(found[16].u - found[10**6].u).max() < 1e-13 * np.abs(found[16].u).max()


@pytest.mark.parametrize("method", ["EXACT", "TAYLOR", "LAGUERRE", "NEWMARK DT=0.001", "HHT DT=0.001"])
def test_every_method_tells_a_motion_that_grows_at_the_same_sample(method: str) -> None:
    """Beyond its yield point the spring pushes by 29 kN/m: the velocity of 2 grows as cosh(sqrt(29) t), and
    its energy is above ten times that at the start after acosh(sqrt(10)) / sqrt(29) = 0.338 s.
    """
    deck = DECK.format(law="FX=0.1 RULE=BILINEAR R=-29/25", motion="", end=1).replace("EXACT", method)
    assert run_text(deck.replace("HISTORY 1", "HISTORY 0.3")).status == "done"
    r = run_text(deck)
    assert r.message.startswith("A504 at t = 0.35 s: the motion grows without bound")
    assert r.time[-1] > 0.339  # methods with steps and TAYLOR leave the sample itself out
    node = r.tables["node_envelope"]
    assert max(node["t_max"].max(), node["t_min"].max()) <= 0.35 + 1e-12  # no peak is later


def test_the_cost_of_a_search_is_that_of_its_points_times_the_unknowns(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two equal masses apart, without events, have the windows and points of one and twice the unknowns."""
    for name in ("WINDOW", "ENVELOPE_POINT", "DECOMPOSITION", "PRODUCTS", "MODES"):
        monkeypatch.setattr(costs, name, 0.0)
    monkeypatch.setattr(costs, "GRID_POINT", 1.0)
    spent: list[float] = []
    monkeypatch.setattr(costs.Budget, "charge", lambda self, cost, *where: spent.append(cost))
    one = DECK.format(law="", motion="", end=1)
    two = one.replace("ELEMENTS\n", " 3 0 9 FIX=XYR\n 4 1 9 FIX=YR\nELEMENTS\n 2 A 3 4\n")
    two = two.replace(" 2 1\nINITIAL\n 2 VX", " 2,4 1\nINITIAL\n 2,4 VX")
    found = []
    for deck in (one, two):
        spent.clear()
        assert run_text(deck).status == "done"
        found.append(spent.copy())
    assert min(found[0]) >= 0.0 and sum(found[0]) > 0.0
    assert sum(found[1]) == pytest.approx(2.0 * sum(found[0]), rel=1e-12)
