"""Pushover of one building of several: as if it stood alone, or against its neighbour."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

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
    return np.array([tuple(row) for row in ran.tables["capacity_curve"]], float)


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
