"""Joints without mass at the instant at which the force of a law falls: closed form, energy, methods."""

from __future__ import annotations

import numpy as np
import pytest

from verification.cases import run_text

#: a spring fails in a row with one that is yielding, which unloads then
UNLOADS = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
ELEMENTS
 1 A 1 2
 2 D 1 2
 3 B 2 3
PROPS
 A SPRING KX=1000 FX=10 RULE=WAYNE_STEWART R=0.1 FU=14 FI=0.5 PTRI=-0.2 RPINCH=0.09
 D SPRING KX=300
 B SPRING KX=2000 FX=12 RULE=TAKEDA R=0.3 ALFA=0.4 BETA=0.3
WEIGHTS
 3 98.1
INITIAL
 3 VX=1.5
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 1
"""

#: one fails that held another back from its yield point: this yields in no time, and then turns back
YIELDS = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 0 1 FIX=YR
 4 2 0 FIX=YR
ELEMENTS
 1 T 1 2
 2 C 2 3
 3 A 2 4
PROPS
 T SPRING KX=2000 FX=24 RULE=BILINEAR R=0.3
 C SPRING KX=2000 ANGLE=0
 A SPRING KX=1000 FX=10 RULE=WAYNE_STEWART R=0.1 FU=14 FI=0.5 PTRI=-0.2 RPINCH=0.09
WEIGHTS
 3 20
 4 981
INITIAL
 3 VX=-0.7
 4 VX=1.05
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 0.3
"""


@pytest.mark.parametrize("deck", [UNLOADS, YIELDS], ids=["unloads", "yields"])
@pytest.mark.parametrize("method", ["TAYLOR", "EXACT"])
def test_no_energy_is_made_or_lost_where_a_force_falls(deck, method):
    r = run_text(deck, method=method)
    assert r.status == "done", r.message
    assert r.check() < 1e-12  # 1e-3 where the way of the joint is left out


def test_the_force_that_falls_does_the_work_of_its_joint():
    """The joint moves on D and on the unloading line of B, along which B comes from the yield line."""
    r = run_text(UNLOADS, method="TAYLOR")
    far = (14.0 + 200.0 * 0.05 + 0.5) / (200.0 + 90.0)  # the falling branch meets the pinched line
    lost = 90.0 * far - 0.5
    area = 0.5 * 10.0 * 0.01 + 12.0 * 0.04 + 0.5 * (14.0 + lost) * (far - 0.05)
    pull = lost + 300.0 * far
    ductility = (pull - 0.7 * 12.0) / (0.3 * 12.0)
    unloading = 2000.0 * ductility**-0.4
    work = r.tables["spring_envelope"]["plastic_work"]
    assert work[0] == pytest.approx(area + 0.5 * lost**2 / (300.0 + unloading), rel=1e-12)


@pytest.mark.parametrize("deck", [UNLOADS, YIELDS], ids=["unloads", "yields"])
def test_both_methods_take_the_same_way(deck):
    a, b = run_text(deck, method="TAYLOR"), run_text(deck, method="EXACT")
    assert np.abs(a.u - b.u).max() < 1e-12 * np.abs(b.u).max()
