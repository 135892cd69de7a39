"""Neighbours drawn apart: horizontal contacts touch in a picture exactly when they are closed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from decks import results_of
from pound_solve.report.plot.geometry import DrawnStructure
from pound_solve.report.plot.neighbours import Contact, moves, reach

RIGHT, LEFT, UP = np.array([1.0, 0.0]), np.array([-1.0, 0.0]), np.array([0.0, 1.0])


def row(gaps, distances):
    """Buildings 0, 1, ... of two floors each, in a row, with a contact at each floor between neighbours."""
    place, building, contacts = {}, {}, []
    x = 0.0
    for b in range(len(gaps) + 1):
        for floor in range(2):
            left, right = 10 * b + 2 * floor + 1, 10 * b + 2 * floor + 2
            place[left], place[right] = np.array([x, 3.0 * floor]), np.array([x + 5.0, 3.0 * floor])
            building[left] = building[right] = b
            if b < len(gaps):
                name, other = f"{b} {floor}", 10 * (b + 1) + 2 * floor + 1
                contacts.append(Contact(name, right, other, RIGHT, gaps[b][floor]))
        x += 5.0 + (distances[b] if b < len(gaps) else 0.0)
    return contacts, place, building


LENGTHS = st.floats(0.0, 0.3)


@given(
    st.lists(st.tuples(st.tuples(LENGTHS, LENGTHS), LENGTHS), min_size=1, max_size=4), st.floats(0.5, 50.0)
)
def test_contacts_touch_exactly_when_they_are_closed(data, factor):
    """The end of the reach meets node J where the closure is the gap.  No building moves further than it
    must: one of its contacts with the building before has no reach then.
    """
    contacts, place, building = row([gaps for gaps, _ in data], [d for _, d in data])
    drawn = {c.name: factor * c.gap for c in contacts}
    moved = moves(contacts, place, building, drawn)
    shown = {n: xy + np.array([moved[building[n]], 0.0]) for n, xy in place.items()}
    for c in contacts:
        tip = shown[c.i] + reach(c, shown, drawn[c.name]) + factor * c.gap * c.along  # I moved by the gap
        assert tip == pytest.approx(shown[c.j], abs=1e-9)
    for b in range(len(data)):
        between = [c for c in contacts if building[c.i] == b]
        shortest = min(float(np.hypot(*reach(c, shown, drawn[c.name]))) for c in between)
        assert moved[b + 1] == 0.0 or shortest == pytest.approx(0.0, abs=1e-9)


def test_direction_and_kind_of_contact():
    """A contact that is given from right to left moves the right building; vertical contacts, and those
    within a building, move none; a wall has no reach.
    """
    contacts, place, building = row([(0.1, 0.1)], [0.0])
    turned = [Contact(c.name, c.j, c.i, LEFT, c.gap) for c in contacts]
    drawn = {c.name: 0.5 for c in contacts}
    assert (
        moves(turned, place, building, drawn) == moves(contacts, place, building, drawn) == {0: 0.0, 1: 0.5}
    )
    above = [
        Contact("up", 2, 13, UP, 0.1),
        Contact("within", 1, 2, RIGHT, 0.1),
        Contact("wall", 1, 0, LEFT, 0.1),
    ]
    assert moves(above, place, building, {c.name: 9.0 for c in above}) == {0: 0.0, 1: 0.0}
    assert not reach(above[2], place, 9.0).any()


def test_buildings_around_each_other_end():
    """Two buildings of which each stands to the right of the other at one floor: no moves satisfy both."""
    _, place, building = row([(0.1, 0.1)], [0.0])
    both = [Contact("a", 2, 11, RIGHT, 0.1), Contact("b", 14, 3, RIGHT, 0.1)]
    assert np.isfinite(list(moves(both, place, building, {"a": 1.0, "b": 1.0}).values())).all()


#: two columns that only node 5 joins, with a master at each; node 6 follows one of them
JOINED = """
NODES
 1 0 0 FIX=XYR
 2 4 0 FIX=XYR
 3 0 3
 4 4 3
 5 4 3 SLAVED=RX MASTER=4,3
 6 5 3 SLAVED=XYR MASTER=4
 7 9 0 FIX=XYR
 8 9 3
ELEMENTS
 1 COLUMN 1 3
 2 COLUMN 2 4
 3 COLUMN 7 8
PROPS
 COLUMN SPRING KX=1 KY=1 KR=1
WEIGHTS
 5,6 1
ANALYSIS
 STATIC
"""


def test_a_node_that_follows_several_joins_their_buildings(tmp_path):
    deck = tmp_path / "joined.inp"
    deck.write_text(JOINED)
    with results_of(deck, out=tmp_path) as results:
        rows = results.table("nodes")[["node", "slaved", "master"]].tolist()
        of = DrawnStructure(results).buildings()
    assert rows[4:6] == [(5, "XR", "3,4"), (6, "XYR", "4")] and all(row[1:] == ("", "") for row in rows[:4])
    assert {of[n] for n in range(1, 7)} == {of[1]} != {of[7]} == {of[8]}
