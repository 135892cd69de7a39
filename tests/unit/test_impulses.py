"""Impulses of contacts by EXACT, which are closed forms, against the sum of the stored forces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from decks import results_of
from pound_solve.results import Results
from tiers import each_once

pytestmark = pytest.mark.full

#: node 3 has no mass, and a force in time
DECK = """UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
ELEMENTS
 1 S 1 2
 2 T 2 3
 9 WALL {node}
PROPS
 S SPRING KX=4000
 T SPRING KX=6000
 WALL CONTACT GAP=0.002 ANGLE=0 LAW={law}
WEIGHTS
 2 100
FORCES
 TABLE 3 20 0 POINTS=0,0,0.3,1,0.5,-1,0.8,1
INITIAL
 2 VX=0.3
DAMPING
 RAYLEIGH BETA=0.002
OUTPUT
 EVERY=0.0005
ANALYSIS
 HISTORY 1 METHOD=EXACT
"""
MASS = 10.0


def ran(folder: Path, node: int, law: str) -> Results:
    deck = folder / "model.inp"
    deck.write_text(DECK.format(node=node, law=law), encoding="utf-8")
    return results_of(deck)


@each_once(("node", [2, 3]), ("law", ["LINEAR K=5E4", "KELVIN_VOIGT K=5E4 C=60"]))
def test_impulse_is_the_integral_of_the_force(tmp_path: Path, node: int, law: str) -> None:
    r = ran(tmp_path, node, law)
    force, collisions = r.history("contact/force")[:, 0], r.table("collisions")
    assert len(collisions) > 2
    assert collisions["impulse"].sum() == pytest.approx(np.trapezoid(force, r.time), rel=5e-4)


def test_a_rigid_contact_gives_impulses_at_once_and_while_it_is_closed(tmp_path: Path) -> None:
    """What the mass gets at an impact is no force; a force that jumps is summed to half a sample."""
    r = ran(tmp_path, 2, "LAGRANGE")
    force, collisions = r.history("contact/force")[:, 0], r.table("collisions")
    at_once = MASS * (collisions["approach_velocity"] + collisions["separation_velocity"])
    lasting = (collisions["impulse"] - at_once).sum()
    assert len(collisions) > 2 and lasting > 0.5
    assert lasting == pytest.approx(np.trapezoid(force, r.time), rel=5e-3)
