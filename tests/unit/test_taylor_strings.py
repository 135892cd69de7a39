"""TAYLOR with P-Delta by the present axial force: an ODE solver, and NEWMARK that converges to it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from verification.cases import run_text

MAST = """UNITS kN m s
GRAVITY 10
GEOMETRY PDELTA_VARYING
NODES
 1 0 0 FIX=XYR
 2 0 2 FIX=R
ELEMENTS
 1 COLUMN 1 2
PROPS
 COLUMN FRAME E=1E6 A=8E-3 I=6.666666666666667E-4
WEIGHTS
 2 100
{load}
OUTPUT
 EVERY=0.05
ANALYSIS
 HISTORY 3 FROM=REST METHOD=TAYLOR
"""
STIFF, ACROSS, MASS, LENGTH = 4000.0, 1000.0, 10.0, 2.0  #: EA/L, 12 EI/L^3


@pytest.mark.parametrize("shaken", [False, True])
def test_a_mast_that_throbs(shaken: bool) -> None:
    """The axial frequency is twice the other: the one excites the other, by the product alone."""
    load = "INITIAL\n 2 UX=0.05 UY=-0.1"
    if shaken:
        load += "\nFORCES\n SINE 2 FX=30 OMEGA=9\nLOADS\n 2 0 -100"
    r = run_text(MAST.format(load=load))
    assert r.status == "done", r.message
    assert r.check() < 1e-12
    sine, down = (30.0, -100.0) if shaken else (0.0, 0.0)

    def rates(t: float, y: list[float]) -> list[float]:
        u, w, _, _ = y
        across = sine * np.sin(9.0 * t) - ACROSS * u - STIFF * w * u / LENGTH
        return [y[2], y[3], across / MASS, (down - STIFF * w) / MASS]

    t = np.arange(61) * 0.05
    options = {"rtol": 1e-13, "atol": 1e-15}
    told = solve_ivp(rates, (0.0, 3.0), [0.05, -0.1, 0.0, 0.0], "DOP853", t, **options).y
    at = r.nodes.index(2)
    assert np.abs(r.u[:, at, 0] - told[0]).max() < 1e-11 * np.abs(told[0]).max()
    assert np.abs(r.u[:, at, 1] - told[1]).max() < 1e-11 * np.abs(told[1]).max()


TOWER = """UNITS kN m s
GRAVITY 9.81
GEOMETRY PDELTA_VARYING
NODES
 1 0 0 FIX=XYR
 2 1.5 0 FIX=XYR
 3 0 4
 4 1.5 4
 5 0 8
 6 1.5 8
ELEMENTS
 1 COLUMN 1 3
 2 COLUMN 2 4
 3 COLUMN 3 5
 4 COLUMN 4 6
 5 BEAM 3 4
 6 BEAM 5 6
PROPS
 COLUMN FRAME E=2E8 A=0.01 I=4E-5 END2=0.2 RULE=BILINEAR R=0.02 LP=0.3 MI=150 MJ=150
 BEAM FRAME E=2E8 A=0.01 I=2E-4 END1=0.2 END2=0.2
WEIGHTS
 3,4,5,6 400 {down} 0
LOADS
 3,4,5,6 0 -400
DAMPING
 RAYLEIGH ALPHA=0.1
EQUAKE
 {motion}
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 1
"""
MOTION = "SINE AMPLITUDE=4 PERIOD=1.5"
APART = f"{MOTION} SUPPORTS=1\n SINE AMPLITUDE=3 PERIOD=1.1 SUPPORTS=2"


@pytest.mark.parametrize(
    "motion",
    [
        MOTION,
        pytest.param(
            f"{MOTION} SUPPORTS=1\n SINE AMPLITUDE=3 PERIOD=1.1 SUPPORTS=2", marks=pytest.mark.full
        ),
    ],
)
def test_newmark_converges_to_a_tower(motion: str) -> None:
    """A narrow one that overturns, with hinges at rotations without mass; its supports move together, or
    each on its own.
    """
    text = TOWER.format(motion=motion, down=400)
    r = run_text(text, None, "TAYLOR")
    assert r.status == "done", r.message
    assert r.check() < 1e-11
    size = np.abs(r.u).max()
    far, near = (np.abs(run_text(text, None, "NEWMARK", dt).u - r.u).max() for dt in (2e-3, 5e-4))
    assert near < 1e-3 * size and far > 9.0 * near


def test_a_node_without_mass_is_refused_in_words() -> None:
    """The beams' strings act there."""
    r = run_text(TOWER.format(motion=MOTION, down=0), None, "TAYLOR")
    assert r.message.startswith("A505"), r.message
    assert "the P-Delta force of element 5 acts on a node without mass" in r.message
