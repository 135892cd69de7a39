"""Pushover of one building of several: as if it stood alone, or against its neighbour."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from pound_solve.driver.prepare import DeckError, prepare
from pound_solve.driver.request import Request
from tiers import each_once
from unit.test_damping_by_building import A, B
from verification.cases import Ran, run_text

GAP = 0.02
NAMES = 'BUILDINGS\n "A" NODES=3\n "B" NODES=12\n'
LOADS = {"A": " 3 FX=8\n 5 FX=5 FY=-90\n", "B": " 13 FX=4\n"}


def deck(names: str, card: str, geometry: str = "SMALL", gap: float = GAP) -> str:
    buildings = [{"A": A, "B": B}[n] for n in names]
    parts = {section: "".join(b[section] for b in buildings) for section in A}
    parts["LOADS"] = "".join(LOADS[n] for n in names)
    if len(names) > 1:
        parts["ELEMENTS"] += " 20 HIT 4 12\n"
        parts["PROPS"] += f" HIT CONTACT GAP={gap} K=1e5\n"
    text = "".join(f"{section}\n{lines}" for section, lines in parts.items())
    given = "".join(f"{line}\n" for line in NAMES.splitlines() if line[:2] != ' "' or line[2] in names)
    head = f"UNITS kN m s\nGRAVITY 9.81\nGEOMETRY {geometry}\n"
    return f"{head}{text}{given}ANALYSIS\n STATIC GRAVITY=YES\n {card}\n"


def curve(ran: Ran) -> np.ndarray:
    assert ran.status == "done", ran.message
    columns = "displacement", "base_shear", "factor", "events"
    return np.array([[row[c] for c in columns] for row in ran.tables["capacity_curve"]], float)


def events(ran: Ran) -> list[tuple[object, ...]]:
    return [(e["element"], e["component"], e["before"], e["after"]) for e in ran.tables["push_events"]]


@pytest.mark.full
@each_once(
    (
        "pattern",
        [
            "TRIANGULAR",
            "UNIFORM",
            "MODE",
            "MODE ADAPTIVE=YES",
            "LOADS",
            "FORCES NODES=3,5 FORCES=1,2",
            "UNIFORM NODES=5",
        ],
    ),
    ("geometry", ["SMALL", "PDELTA", "LARGE"]),
    at_most=1,
)
def test_a_building_without_its_neighbour_is_the_deck_with_it_alone(pattern: str, geometry: str) -> None:
    """Pressed at rest by its neighbour (a gap below zero), which must leave no trace."""
    card = f"PUSHOVER 5 0.25 PATTERN={pattern} STEPS=20"
    alone = run_text(deck("A", card, geometry))
    both = run_text(deck("AB", f"{card} BUILDING=A NEIGHBOURS=NO", geometry, gap=-0.001))
    assert events(both) == events(alone) and len(events(alone)) >= 2
    np.testing.assert_allclose(curve(both), curve(alone), rtol=1e-12)
    first, last = (np.array([p[x] for p in both.tables["push_pattern"]]) for x in ("first", "last"))
    assert {int(p["node"]) for p in both.tables["push_pattern"]} <= {3, 4, 5, 6}
    assert first.any() and last.any()


def test_away_from_the_neighbour_its_presence_makes_no_difference() -> None:
    card = "PUSHOVER 5 -0.2 PATTERN=TRIANGULAR BUILDING=A"
    beside, alone = (run_text(deck("AB", card + more)) for more in ("", " NEIGHBOURS=NO"))
    np.testing.assert_allclose(curve(beside), curve(alone), rtol=1e-12, atol=1e-12)


def test_a_building_is_held_by_its_neighbour() -> None:
    """The sum of both base shears is that of all loads; each gets its part from the contact on."""
    card = "PUSHOVER 5 0.2 PATTERN=UNIFORM BUILDING=A STEPS=40"
    alone = curve(run_text(deck("AB", card + " NEIGHBOURS=NO")))
    ran = run_text(deck("AB", card))
    of_a = curve(ran)
    touch = next(e["displacement"] for e in ran.tables["push_events"] if e["element"] == 20)
    before = of_a[of_a[:, 0] < touch]
    np.testing.assert_allclose(before[:, 1], np.interp(before[:, 0], alone[:, 0], alone[:, 1]), rtol=1e-9)
    # the static loads of A are 13; what the pattern adds goes into A until both touch, then into both
    np.testing.assert_allclose(before[:, 1], 13.0 + before[:, 2], rtol=1e-12)
    late = of_a[of_a[:, 0] > touch + 0.01]
    into_b = 13.0 + late[:, 2] - late[:, 1]
    assert (into_b > 5.0).all() and len(late) > 10
    whole = curve(run_text(deck("AB", card.replace("BUILDING=A", "NODES=3 TO 6"))))
    np.testing.assert_allclose(whole[:, 1], 17.0 + whole[:, 2], rtol=1e-12)
    np.testing.assert_allclose(whole[:, [0, 2]], of_a[:, [0, 2]], rtol=1e-12)


TOUCHING = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
 3 3 0 FIX=YR
 4 6 0 FIX=XYR
ELEMENTS
 1 ONE 1 2
 2 OTHER 3 4
 3 HIT 2 3
PROPS
 ONE SPRING KX=4000
 OTHER SPRING KX=3000
 HIT CONTACT GAP=0 ANGLE=0 LAW={law}
WEIGHTS
 2,3 500
BUILDINGS
 "A" NODES=2
 "B" NODES=3
ANALYSIS
 STATIC
 PUSHOVER 2 {target} PATTERN=UNIFORM BUILDING=A STEPS=10
"""


@pytest.mark.parametrize(
    ("law", "force"),
    [
        ("LINEAR K=1E5", lambda x: 1e5 * x),
        ("KELVIN_VOIGT K=1E5 E=0.6", lambda x: 1e5 * x),
        ("HERTZ K=1E6", lambda x: 1e6 * x**1.5),
        ("HUNT_CROSSLEY K=1E6 E=0.6", lambda x: 1e6 * x**1.5),
        (
            "TABLE DEPTHS=0.001,0.002 FORCES=50,200",
            lambda x: 5e4 * min(x, 1e-3) + 1.5e5 * max(x - 1e-3, 0.0),
        ),
        ("BILINEAR_IMPACT K1=1E5 K2=4E4 DY=0.001", lambda x: 1e5 * min(x, 1e-3) + 4e4 * max(x - 1e-3, 0.0)),
        ("STEREOMECHANICS E=0.6", None),
    ],
)
def test_buildings_that_touch_share_the_push_from_the_start(
    law: str, force: Callable[[float], float] | None
) -> None:
    """A gap of zero: the contact is in series with the neighbour; away from it there is neither."""
    pushed = curve(run_text(TOUCHING.format(law=law, target=0.1)))[1:]
    for u, push in pushed[:, [0, 2]]:
        moved = u
        if force is not None:
            moved = brentq(lambda w, u: force(u - w) - 3000.0 * w, 0.0, u, args=(u,), xtol=1e-15)
        assert push == pytest.approx(4000.0 * u + 3000.0 * moved, rel=1e-9)
    pulled = curve(run_text(TOUCHING.format(law=law, target=-0.1)))
    np.testing.assert_allclose(np.abs(pulled[:, 2]), 4000.0 * np.abs(pulled[:, 0]), rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize(
    ("items", "message"),
    [
        ("NEIGHBOURS=NO", "NEIGHBOURS=NO needs a building"),
        ("BUILDING=C", "there is no building 'C'; the buildings are A, B"),
        ("BUILDING=B", "node 5 is not of building 'B'"),
        ("BUILDING=A NODES=3,12", "node 12 is not of building 'A'"),
        ("BUILDING=A BASE=1,11", "node 11 is not of building 'A'"),
    ],
)
def test_what_is_refused(items: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(deck("AB", f"PUSHOVER 5 0.2 {items}"))
    with pytest.raises(DeckError) as refused:
        prepare(Request(str(path)))
    assert [(d.code, d.message) for d in refused.value.diagnostics] == [("P335", message)]
