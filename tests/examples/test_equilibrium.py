"""Base shears of the examples: equal to inertia and loads, and to the shears of the storey above."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pound_solve.driver.run import Prepared
from pound_solve.results import Results
from pound_solve.structure.buildings import buildings
from tiers import at_night

pytestmark = pytest.mark.full

Run = Callable[..., tuple[int, Results, Prepared]]

EXAMPLES = Path(__file__).parents[2] / "examples"
DECKS = sorted(
    p for p in EXAMPLES.rglob("*.inp") if "HISTORY" in p.read_text("utf-8") and p.parent.name != "open"
)
LONG = ("distributed", "steel_20x6", "two_bars", "unequal_frames")
INSIDE = ("fixed", "uplift")  #: have mass between base and first floor
BALANCE = "base shear and overturning moment less inertia and loads, over the largest"


@pytest.mark.parametrize(
    "deck",
    [*(p for p in DECKS if p.stem not in LONG), *at_night(*(p for p in DECKS if p.stem in LONG))],
    ids=lambda p: p.stem,
)
def test_base_shear_is_inertia_and_the_shear_of_the_columns(
    deck: Path, run: Callable[..., tuple[int, Results, Prepared]]
) -> None:
    """The residual of equilibrium, and base shear against the shear of the lowest storey, which is the sum
    of those of its columns: both to 1e-9, where the method makes no error in time.
    """
    status, results, prepared = run(deck)
    assert status == 0, results.message
    exact = dict(results.table("overview").tolist())["error of the method"].startswith("rounding only")
    found = [check.value for check in results.checks if check.name == BALANCE]
    if not exact or not found:
        pytest.skip("a method in steps, or no building")
    assert found[0] < 1e-9
    if "storey/shear" not in results.histories or deck.stem in INSIDE:  # or no floor above the base
        return
    base, shear = results.history("building/base"), results.history("storey/shear")
    shears, lowest = list(results.labels("building/base")), list(results.labels("storey/shear"))
    nodes = prepared.model.nodes
    for b in buildings(prepared.structure):
        if b.floors and all(nodes[n].y <= b.base for n in b.nodes if nodes[n].fixed[:1] == "X"):
            own = base[:, shears.index(f"{b.name} shear X")]
            columns = shear[:, lowest.index(f"{b.name} storey 1")]
            assert np.abs(own - columns).max() <= 1e-9 * np.abs(own).max(), b.name
