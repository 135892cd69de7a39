"""Two equal buildings that touch move alike: what their contacts deform by is rounding."""

from __future__ import annotations

import pytest

from verification.cases import run_text

#: the second one 6.45 m beside the first, so that the lengths of its members differ in their last digits
DECK = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 3.5
 3 0 7
 4 6 0 FIX=XYR
 5 6 3.5
 11 6.45 0 FIX=XYR
 12 6.45 3.5
 13 6.45 7
 14 12.45 0 FIX=XYR
 15 12.45 3.5
ELEMENTS
 1 C 1 2
 2 C 2 3
 3 C 4 5
 4 B 2 5
 11 C 11 12
 12 C 12 13
 13 C 14 15
 14 B 12 15
 21 Q 2 12
 22 Q 3 13
PROPS
 C FRAME E=2.7E7 A=0.16 I=0.0021 RULE=TAKEDA R=0.03 MI=200 MJ=200 LP=0.25
 B FRAME E=2.7E7 A=0.16 I=0.0021
 Q CONTACT GAP=0 ANGLE=0 LAW={law}
WEIGHTS
 2,3,5,12,13,15 240
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2
EQUAKE
 SYNTHETIC PGA=6 SEED=7 DURATION=8 RISE=1 STRONG=5
ANALYSIS
 HISTORY 4 METHOD={method}
"""


@pytest.mark.parametrize(
    ("law", "method"),
    [
        ("KELVIN_VOIGT K=1E6 E=0.65", "TAYLOR"),
        ("KELVIN_VOIGT K=1E6 E=0.65", "EXACT"),
        ("KELVIN_VOIGT K=1E6 E=0.65", "LAGUERRE TOL=1E-5"),
        ("KELVIN_VOIGT K=1E6 E=0.65", "NEWMARK DT=2E-3"),
        ("KELVIN_VOIGT K=1E6 E=0.65", "NEWMARK DT=2E-3 EVENTS=STEPPED"),
        ("LINEAR K=1E6", "HHT DT=2E-3"),
        ("LINEAR K=1E6", "GENERALISED_ALPHA DT=2E-3"),
        ("HERTZ K=1E7", "TAYLOR"),
        ("HUNT_CROSSLEY K=1E7 E=0.6", "NEWMARK DT=2E-3"),
        ("LAGRANGE", "TAYLOR"),
        ("LAGRANGE", "EXACT"),
        ("STEREOMECHANICS E=0.5", "TAYLOR"),
        ("KELVIN_VOIGT K=1E6 E=0.65", "AUTO"),
    ],
)
def test_equal_buildings_do_not_collide(law, method):
    r = run_text(DECK.format(law=law, method=method))
    assert r.status == "done", r.message
    assert not r.tables["contact_summary"]["closures"].any()
    assert r.tables["worst_hinges"]["ductility"].max() > 1.5
