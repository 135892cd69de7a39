"""Axial stiffness along a direction of the elements that meet a node."""

import pytest

from decks import model_of
from pound_solve.structure.assembly import assemble, stiffness_along

DECK = """NODES
 1 1 1 FIX=XYR
 2 4 5
 3 4 10
 4 9 5
ELEMENTS
 1 ROD 1 2
 2 UP 2 3
 3 AWAY 3 4
 4 GROUND 2
PROPS
 ROD FRAME E=10 A=2 I=1E-3
 UP FRAME E=10 A=1E6 I=1E-9
 AWAY FRAME E=10 A=2 I=1E-3
 GROUND SPRING KX=7 KY=5
"""


@pytest.mark.parametrize(("normal", "share"), [((1.0, 0.0), 0.6), ((0.0, -1.0), -0.8)])
def test_a_rod_has_its_axial_stiffness_times_the_squared_cosine(normal, share):
    model = model_of(DECK)
    found = stiffness_along(model, assemble(model).parts, 2, normal)
    assert found[1] == pytest.approx(10.0 * 2.0 / 5.0 * share**2, rel=1e-9)


def test_only_elements_that_meet_the_node_and_resist_along_the_direction_count():
    model = model_of(DECK)
    found = stiffness_along(model, assemble(model).parts, 2, (1.0, 0.0))
    assert set(found) == {1, 4}  # a column is at a right angle, another rod elsewhere
    assert found[4] == pytest.approx(7.0)
