"""At every sample of a method with steps inertia, dashpots, springs and contact forces are in balance,
however the laws curve and wherever events cut the steps.
"""

from __future__ import annotations

import numpy as np
import pytest

from pound_solve.analyses.history import BALANCE
from pound_solve.assess.stability.scenes import cases
from pound_solve.assess.stability.scenes.case import METHOD, items
from pound_solve.catalog import catalog
from tiers import each_once
from verification.cases import run_text

pytestmark = pytest.mark.full

DECK = """UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
ELEMENTS
 1 SPRING 1 2
 2 DASHPOT 1 2
 3 WALL 2
PROPS
 SPRING SPRING KX=4000
 DASHPOT DASHPOT CX=20
 WALL CONTACT GAP=0.01 LAW={law}
WEIGHTS
 2 1000
INITIAL
 2 VX=0.7
OUTPUT
 EVERY=0.005
ANALYSIS
 HISTORY 2
"""
NOT_HERE = {"LAGRANGE", "STEREOMECHANICS", "EQUIVALENT"}  #: rigid; between diaphragms only
LAWS = [
    items(spec, 0.002, 200.0) for name, spec in catalog().family("contact").items() if name not in NOT_HERE
]


def imbalance(law: str, method: str) -> float:
    """Largest force that is missing at a sample, over the largest of the contact."""
    r = run_text(DECK.format(law=law), None, method, 1e-3)
    assert r.status == "done", r.message
    node, contact = r.nodes.index(2), r.force[:, -1]
    u, v, a = (x[:, node, 0] for x in (r.u, r.v, r.a))
    left = 100.0 * a + 20.0 * v + 4000.0 * u + contact
    size = np.abs(contact).max()
    assert size > 10.0
    return float(np.abs(left).max() / size)


@each_once(("method", ["NEWMARK", "CENTRAL"]), ("law", LAWS))
def test_forces_are_in_balance(law: str, method: str) -> None:
    assert imbalance(law, method) < 1e-11


STEPS = {case.law: case.deck for case in cases(("hysteresis",)) if case.variant == "a step"}


@pytest.mark.parametrize("rule", STEPS)
def test_a_ground_that_begins_to_accelerate_at_once_is_in_balance(rule: str) -> None:
    """Laws that turn at that instant are kept with the load after it, and the total accelerations, too:
    they are the springs' forces, which do not jump.
    """
    text = STEPS[rule].replace(METHOD, "NEWMARK DT=0.002").replace("HISTORY 2.0", "HISTORY 0.3")
    r = run_text(text)
    checks = {row["check"]: float(row["value"]) for row in r.tables["checks"]}
    assert checks[BALANCE] < 1e-9
    rows = r.tables["node_envelope"]
    assert rows["min"][rows["quantity"] == "acceleration"].min() > -1.0  # -5 with the load before the jump
