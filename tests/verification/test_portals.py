"""Portal frames against Kleinlogel A (1952), Rigid Frame Formulas, the rectangular frames with hinged
and with fixed legs: k = (I_beam / I_column) (h / L), hinged N = 2k + 3, fixed N1 = k + 2 and N2 = 6k + 1.

The formulas neglect axial strain: the tops of the legs are held vertically and the beam's ends move
together, so that the comparison is exact.  A second pass with real areas checks that the difference
is the axial strain.
"""

from __future__ import annotations

import numpy as np
import pytest

from decks import solved

H, L, IC, IB = 4.0, 7.0, 2.0e-4, 5.0e-4
K = IB / IC * H / L


def portal(bases: str, loads: str, stiff: bool = True) -> str:
    held, together = ("FIX=Y", "SLAVED=X MASTER=2") if stiff else ("", "")
    return f"""
NODES
 1 0 0 FIX={bases}
 2 0 {H} {held}
 3 {L} {H} {held} {together}
 4 {L} 0 FIX={bases}
ELEMENTS
 1 LEG 1 2
 2 BEAM 2 3
 3 LEG 4 3
PROPS
 LEG FRAME E=2e8 A={0.02 if stiff else 20.0} I={IC!r}
 BEAM FRAME E=2e8 A={0.02 if stiff else 20.0} I={IB!r}
{loads}
"""


def results(bases, loads, stiff=True):
    """Base shear x, base moment, corner moment of the left leg, all of them forces on the leg;
    and the legs' thrusts.
    """
    s = solved(portal(bases, loads, stiff))
    vertical = [s.reaction[a][1] + (s.reaction[b][1] if stiff else 0.0) for a, b in ((1, 2), (4, 3))]
    return s, s.reaction[1], s.reaction[4], s.force[1, "moment J"], s.force[3, "moment J"], vertical


W, P = 6.0, 11.0  # kN/m downwards on the beam, kN to the right at its left end
UNIFORM, LATERAL = f"MEMBER_LOADS\n 2 WY={-W}", f"LOADS\n 2 {P} 0 0"


def check(bases, loads, base_x, base_m, corner, vertical, stiff=True, rel=1e-10):
    s, left, right, top_left, top_right, thrusts = results(bases, loads, stiff)
    size = max(map(abs, (*base_m, *corner)))
    assert [left[0], right[0]] == pytest.approx(base_x, rel=rel)
    assert [left[2], right[2]] == pytest.approx(base_m, rel=rel, abs=rel * size)
    assert [top_left, top_right] == pytest.approx(corner, rel=rel)
    assert thrusts == pytest.approx(vertical, rel=rel)
    # resultants: all reactions balance all loads
    load = np.array([0.0, -W * L, -W * L**2 / 2]) if loads == UNIFORM else np.array([P, 0.0, -P * H])
    assert s.total() == pytest.approx(-load, abs=1e-9 * np.abs(load).max())


@pytest.mark.parametrize(("stiff", "rel"), [(True, 1e-10), (False, 1e-3)])
class TestKleinlogel:
    """Moments on a leg are anticlockwise; equilibrium of the left one,
    with the base pushing H to the right, is M_base + M_top + H h = 0: under gravity load
    its top is turned clockwise, against the beam's end.
    """

    def test_hinged_legs_uniform_load(self, stiff, rel):
        corner = W * L**2 / (4 * (2 * K + 3))  # M_B = M_C = - w L^2 / 4N
        thrust = corner / H
        check("XY", UNIFORM, [thrust, -thrust], [0, 0], [-corner, corner], [W * L / 2] * 2, stiff, rel)

    def test_hinged_legs_lateral_load(self, stiff, rel):
        corner = P * H / 2  # M_B = - M_C = P h / 2
        check(
            "XY", LATERAL, [-P / 2, -P / 2], [0, 0], [corner, corner], [-P * H / L, P * H / L], stiff, rel
        )

    def test_fixed_legs_uniform_load(self, stiff, rel):
        base, corner = W * L**2 / (12 * (K + 2)), W * L**2 / (6 * (K + 2))
        thrust = (base + corner) / H
        check(
            "XYR", UNIFORM, [thrust, -thrust], [-base, base], [-corner, corner], [W * L / 2] * 2, stiff, rel
        )

    def test_fixed_legs_lateral_load(self, stiff, rel):
        base = P * H / 2 * (3 * K + 1) / (6 * K + 1)
        corner = P * H / 2 * 3 * K / (6 * K + 1)
        up = 2 * corner / L
        check("XYR", LATERAL, [-P / 2, -P / 2], [base, base], [corner, corner], [-up, up], stiff, rel)


def test_sway_by_slope_deflection():
    """Rigid beam: fixed legs sway by P h^3/24EI, hinged ones by P h^3/6EI."""
    for bases, factor in (("XYR", 24), ("XY", 6)):
        s = solved(portal(bases, LATERAL).replace(f"I={IB!r}", "I=1e4"))
        assert s.u[2][0] == pytest.approx(P * H**3 / (factor * 2e8 * IC), rel=1e-6)
