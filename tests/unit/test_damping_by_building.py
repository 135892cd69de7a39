"""Damping by the modes of one building: as if each building stood alone in its deck."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import pound_solve
from decks import structure_of
from pound_solve.driver.prepare import prepare
from pound_solve.driver.request import Request
from pound_solve.structure.assembly import AssemblyError
from tiers import each_once
from verification.cases import Ran, run_text

A = {
    "NODES": " 1 0 0 FIX=XYR\n 2 4 0 FIX=XYR\n 3 0 3\n 4 4 3\n 5 0 6.5\n 6 4 6.5\n",
    "ELEMENTS": " 1 COL 1 3\n 2 COL 2 4\n 3 COL 3 5\n 4 COL 4 6\n 5 BEAM 3 4\n 6 BEAM 5 6\n",
    "PROPS": " COL FRAME E=2e7 A=0.04 I=2e-4 RULE=BILINEAR R=0.05 MI=12 MJ=12 KH=2e4\n"
    " BEAM FRAME E=2e7 A=0.06 I=6e-4\n",
    "WEIGHTS": " 3 TO 6 60 WR=2\n",
}
B = {
    "NODES": " 11 9 0 FIX=XYR\n 12 9 3 FIX=YR\n 13 9 6 FIX=YR\n 14 9 9 FIX=YR\n",
    "ELEMENTS": " 11 S 11 12\n 12 S 12 13\n 13 T 13 14\n",
    "PROPS": " S SPRING KX=3000 FX=25 RULE=BILINEAR R=0.1\n T SPRING KX=1500\n",
    "WEIGHTS": " 12 TO 14 90\n",
}
LOADING = """EQUAKE
 SINE AMPLITUDE=4 PERIOD=0.5 DURATION=1
OUTPUT
 EVERY=0.02
ANALYSIS
 MODAL 6
 HISTORY 2 METHOD=EXACT
"""


def deck(*buildings: dict[str, str], damping: str, names: str = "", contact: bool = False) -> str:
    parts = {section: "".join(b[section] for b in buildings) for section in A}
    if contact:  # of no stiffness while it is open, which it always is
        parts["ELEMENTS"] += " 20 HIT 4 12\n"
        parts["PROPS"] += " HIT CONTACT GAP=5 K=1e5\n"
    text = "".join(f"{section}\n{lines}" for section, lines in parts.items())
    return f"UNITS kN m s\nGRAVITY 9.81\n{text}DAMPING\n{damping}{names}{LOADING}"


NAMES = 'BUILDINGS\n "A" NODES=3\n "B" NODES=12\n'
CARDS = [
    ("RAYLEIGH XI=0.03 MODES=1,2{a}", "RAYLEIGH XI=0.05,0.06 MODES=1,3{b}"),
    ("RAYLEIGH XI=0.03 MODES=1,2 STIFFNESS=TANGENT{a}", "RAYLEIGH ALPHA=0.2 BETA=0.001{b}"),
    ("MODAL XI=0.02,0.07{a}", "MODAL XI=0.03,0.05 MODES=1,3{b}"),
    ("CAUGHEY XI=0.05 MODES=1,2{a}", "CAUGHEY XI=0.04 MODES=1,2,3{b}"),
    ("RAYLEIGH XI=0.03 MODES=1,2 PROPS=COL{a}", "MODAL XI=0.05{b}"),
]


def modes(*runs: Ran) -> np.ndarray:
    """Frequency and damping ratio of all modes of some runs, by frequency."""
    rows = np.concatenate([[(m["omega"], m["damping"]) for m in r.tables["modes"]] for r in runs])
    return np.array(rows[np.argsort(rows[:, 0])])


@pytest.mark.full
@each_once(("cards", CARDS), ("contact", (True, False)), at_most=1)
def test_each_building_as_if_it_stood_alone(cards: tuple[str, str], contact: bool) -> None:
    a, b = cards
    alone = [
        run_text(deck(A, damping=f" {a.format(a='')}\n")),
        run_text(deck(B, damping=f" {b.format(b='')}\n")),
    ]
    written = f" {a.format(a=' BUILDING=A')}\n {b.format(b=' BUILDING=B')}\n"
    both = run_text(deck(A, B, damping=written, names=NAMES, contact=contact))
    assert both.status == alone[0].status == alone[1].status == "done"
    each, whole = modes(*alone), modes(both)
    count = min(len(each), len(whole))
    assert count >= 6
    np.testing.assert_allclose(whole[:count], each[:count], rtol=1e-12)
    assert all(f"building {x}" in row["group"] for x, row in zip("AB", both.tables["damping"], strict=True))
    overview = dict(both.tables["overview"].tolist())["damping"]
    assert re.search(r" of building A.*: .*; .* of building B", overview)
    moved = 0
    for own in alone:
        at = [both.nodes.index(n) for n in own.nodes]
        size = np.abs(own.u).max(axis=(0, 1))
        assert size[0] > 0.01  # and the springs yield
        difference = np.abs(both.u[:, at] - own.u).max(axis=(0, 1))
        assert (difference <= 1e-12 * size.max()).all()
        moved += len(at)
    assert moved == len(both.nodes)


def damped(card: str) -> object:
    return structure_of(deck(A, B, damping=card, names=NAMES))


@pytest.mark.parametrize(
    ("card", "message"),
    [
        (" MODAL XI=0.05 BUILDING=C\n", "there is no building 'C'; the buildings are A, B"),
        (" MODAL XI=0.05 BUILDING=A NODES=3\n", "BUILDING stands for all nodes of a building"),
        (" RAYLEIGH ALPHA=0.1 BUILDING=A NODES=3\n", "BUILDING stands for all nodes of a building"),
    ],
)
def test_what_is_refused(card: str, message: str) -> None:
    with pytest.raises(AssemblyError, match=message) as refused:
        damped(card)
    assert [d.code for d in refused.value.diagnostics] == ["P332"]


@pytest.mark.parametrize(
    ("cards", "messages"),
    [
        (" MODAL XI=0.05 BUILDING=A\n MODAL XI=0.05 BUILDING=B\n", []),
        (" MODAL XI=0.05 BUILDING=A\n", ["building 'B' has no damping"]),
        (" MODAL XI=0.05 BUILDING=A\n RAYLEIGH BETA=0.01\n", ["building 'A' has two dampings"]),
        (" RAYLEIGH BETA=0.01 BUILDING=A PROPS=COL\n RAYLEIGH BETA=0.01\n", []),
        (" RAYLEIGH BETA=0.01\n MODAL XI=0.05\n", []),
    ],
)
def test_a_building_damped_twice_or_not_at_all(cards: str, messages: list[str], tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(deck(A, B, damping=cards, names=NAMES))
    found = [d for d in prepare(Request(str(path))).warnings if d.code == "P339"]
    assert [d.severity for d in found] == ["warning"] * len(messages)
    assert all(d.message.startswith(m) for d, m in zip(found, messages)) and len(found) == len(messages)


def test_buildings_without_a_name_have_numbers() -> None:
    """`building 1` is the one with the lowest node."""
    first = structure_of(deck(A, B, damping=' MODAL XI=0.05 BUILDING="building 1"\n'))
    same = structure_of(deck(A, B, damping=" MODAL XI=0.05 BUILDING=A\n", names=NAMES))
    np.testing.assert_array_equal(first.damping, same.damping)


@pytest.mark.full
def test_the_warning_stands_in_report_and_results(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(deck(A, B, damping=" MODAL XI=0.05 BUILDING=A\n", names=NAMES))
    with pound_solve.run(path) as found:
        assert "P339" in str(found.table("warnings").tolist())
    assert "building 'B' has no damping" in path.with_suffix(".rpt").read_text().split("\f")[0]
