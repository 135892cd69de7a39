"""What every damper law of the catalog keeps: no force at rest, a force against the motion, and all its
work lost as damping.
"""

from __future__ import annotations

import numpy as np
import pytest

from pound_deck.schema import Spec
from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law, consistent
from samples import values, written
from verification.cases import Ran, run_text

pytestmark = pytest.mark.full

DAMPERS = catalog().family("damper")
RATES = np.concatenate([-np.geomspace(1e3, 1e-9, 61), [0.0], np.geomspace(1e-9, 1e3, 61)])

DECK = """UNITS kN m s
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 3 0 FIX=YR
ELEMENTS
 1 COLUMN 1 2
 2 DAMPER 1 2
PROPS
 COLUMN SPRING KX=4000
 DAMPER DASHPOT CX=60 LAW={law}
WEIGHTS
 2 1000
EQUAKE
 SINE AMPLITUDE=4 PERIOD=0.9 DURATION=3
DRIFT
 "storey" 1 2
OUTPUT
 EVERY={every}
ANALYSIS
 HISTORY 4 METHOD={method}
"""


def law_of(spec: Spec, c: float = 3.0) -> Law:
    """A law of the items of its sample."""
    given = {f.name: f.default for f in spec.fields} | values(spec, 1.0, 0.1)
    law = spec.impl(given, c, None, None)
    assert isinstance(law, Law), "its sample is a linear dashpot: give one that is not"
    return law


def keep(law: Law) -> None:
    """Hold a law to the contract on its own."""
    for v in RATES.tolist():
        state = consistent(law, law.start(), 0.0, v)
        force, stiffness, slope = law.force(state, 0.0, v)
        assert (force > 0.0) == (v > 0.0) and (force < 0.0) == (v < 0.0), v
        assert stiffness == 0.0 and slope >= 0.0
        assert law.dissipated_power(state, 0.0, v) <= force * v * (1 + 1e-12)
        assert law.stored(state, 0.3) == 0.0


def shaken(spec: Spec, method: str, every: float = 0.001) -> Ran:
    """An oscillator with such a damper under a sine."""
    return run_text(DECK.format(law=f"{spec.name} {written(spec, 1.0, 0.1)}", method=method, every=every))


def balanced(r: Ran, tol: float) -> None:
    """Hold a run to the contract."""
    assert r.status == "done", r.message
    energy = dict(zip(r.tables["energy"]["item"].tolist(), r.tables["energy"]["value"].tolist()))
    assert energy["hysteretic"] == 0.0 and energy["damping"] > 0.05 * energy["input"] > 0.0
    assert r.check() < tol
    (force,) = (x for x in r.tables["spring_envelope"] if x["element"] == 2)
    assert abs(force["force_max"]) > 0.0 > force["force_min"]


@pytest.mark.parametrize("name", DAMPERS)
def test_a_damper_resists_the_rate(name: str) -> None:
    keep(law_of(DAMPERS[name]))


@pytest.mark.parametrize("name", DAMPERS)
def test_all_its_work_is_damping(name: str) -> None:
    balanced(shaken(DAMPERS[name], "NEWMARK DT=5E-4"), 2e-5)
