"""Uniform beams against closed forms: deflections of meshes and the convergence of natural frequencies.

Frequencies: Blevins RD (1979), Formulas for Natural Frequency and Mode Shape, table 8-1
(Euler-Bernoulli beams).
Deflections: Timoshenko SP, Gere JM (1972), Mechanics of Materials, appendix;
the shear parts by the unit-load theorem.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from decks import solved, structure_of

pytestmark = pytest.mark.full

E, A, IZ, L, M = 2.0e8, 0.02, 3.0e-4, 8.0, 0.7  # kN/m2, m2, m4, m, t/m
EI = E * IZ
G = 10.0

SUPPORTS = {"simple": ("XY", "XY"), "cantilever": ("XYR", ""), "fixed": ("XYR", "XYR")}
# roots of the characteristic equations, to rounding
ROOTS = {
    "simple": [math.pi, 2 * math.pi],
    "cantilever": [
        brentq(lambda x: math.cos(x) * math.cosh(x) + 1, a, b, xtol=1e-15) for a, b in ((1, 3), (4, 5))
    ],
    "fixed": [
        brentq(lambda x: math.cos(x) * math.cosh(x) - 1, a, b, xtol=1e-15) for a, b in ((4, 5), (7, 8))
    ],
}


def fix(letters: str) -> str:
    return f"FIX={letters}" if letters else ""


def mesh(support: str, n: int, mass: str = "LUMPED", tail: str = "", section: str = "") -> str:
    left, right = (fix(x) for x in SUPPORTS[support])
    inner = f" 2 TO {n}  {L / n!r} TO {L - L / n!r}  0" if n > 2 else (f" 2 {L / 2!r} 0" if n == 2 else "")
    return f"""
MASS {mass}
GRAVITY {G!r}
NODES
 1 0 0 {left}
{inner}
 {n + 1} {L!r} 0 {right}
ELEMENTS
 1 TO {n}  B  1 TO {n}  2 TO {n + 1}
PROPS
 B FRAME E={E!r} A={A!r} I={IZ!r} WGT={M * G!r} {section}
{tail}
"""


def frequencies(support: str, n: int, mass: str) -> np.ndarray:
    """First two bending frequencies."""
    modes = structure_of(mesh(support, n, mass))
    y = [i for i, f in enumerate(modes.dofs.free) if f[1] == 1]
    bending = np.abs(modes.free_vibration.shapes[y]).max(axis=0) > 1e-6
    return modes.free_vibration.omega[bending][:2]


@pytest.mark.parametrize("mode", [0, 1])
@pytest.mark.parametrize(
    ("support", "mass", "order"),
    [
        ("simple", "CONSISTENT", 4),
        ("cantilever", "CONSISTENT", 4),
        ("fixed", "CONSISTENT", 4),
        ("simple", "LUMPED", 4),  # the lumped chain on smooth ends is better than its order
        ("fixed", "LUMPED", 4),
        ("cantilever", "LUMPED", 2),  # half a member's mass at the free end costs two orders
    ],
)
def test_frequencies_converge_at_the_right_order(support, mass, order, mode):
    exact = ROOTS[support][mode] ** 2 / L**2 * math.sqrt(EI / M)
    # the lumped fixed beam has a large next term (order 4.3 at n = 8);
    # finer meshes show rounding, some 1e-9
    n = 16 if (support, mass) == ("fixed", "LUMPED") else 8
    errors = {k: float(frequencies(support, k, mass)[mode] / exact - 1) for k in (n, 2 * n, 4 * n)}
    measured = [math.log2(abs(errors[k] / errors[2 * k])) for k in (n, 2 * n)]
    text = f"{support} {mass} mode {mode + 1}: errors {errors}, orders {measured}"
    assert abs(measured[-1] - order) < 0.05, text
    sign = 1 if mass == "CONSISTENT" else -1  # from above as Rayleigh-Ritz, from below with the mass lumped
    assert all(sign * e > 0 for e in errors.values()), text
    assert abs(errors[4 * n]) < {4: 2e-5, 2: 3e-3}[order], text


def test_axial_frequencies_of_a_rod():
    """Fixed-free rod: omega = pi/2L sqrt(EA/m); linear members,
    so order 2 from below (lumped) and above.
    """
    exact = math.pi / (2 * L) * math.sqrt(E * A / M)
    for mass, sign in (("LUMPED", -1), ("CONSISTENT", 1)):
        errors = []
        for n in (10, 20):
            s = structure_of(
                mesh("cantilever", n, mass).replace(f" {n + 1} {L!r} 0 ", f" {n + 1} {L!r} 0 FIX=YR")
            )
            shapes = s.free_vibration.shapes
            x = [i for i, f in enumerate(s.dofs.free) if f[1] == 0]
            axial = np.abs(shapes[x]).max(axis=0) > 1e-6
            errors.append(s.free_vibration.omega[axial][0] / exact - 1)
        # (pi/4n)^2/6 is the leading term of the exact dispersion 2n sin(pi/4n) of the lumped chain
        assert sign * errors[0] > 0
        assert math.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.01)
        assert abs(errors[0]) == pytest.approx((math.pi / 2 / 10) ** 2 / 24, rel=0.01)


@pytest.mark.parametrize("n", [1, 3, 8])
@pytest.mark.parametrize("shear", [False, True])
def test_meshes_are_exact_at_their_nodes(n, shear):
    """Cantilever under its weight: v(x) = w x^2 (6 L^2 - 4 L x + x^2)/24EI + w (L x - x^2/2)/GAs
    at every node.
    """
    ga, phi = 5.0e4, "G=1e7 AS=0.005"
    s = solved(mesh("cantilever", n, section=phi if shear else ""))
    w = -M * G
    for k in range(1, n + 2):
        x = (k - 1) * L / n
        v = w * x**2 * (6 * L**2 - 4 * L * x + x**2) / (24 * EI) + (
            w * (L * x - x**2 / 2) / ga if shear else 0
        )
        turn = w * x * (3 * L**2 - 3 * L * x + x**2) / (6 * EI)
        assert s.u[k] == pytest.approx([0, v, turn], rel=1e-10, abs=1e-16)
    for k in range(1, n + 1):  # end forces: what hangs beyond
        rest = L - (k - 1) * L / n
        assert s.force[k, "shear I"] == pytest.approx(-w * rest, rel=1e-10)
        assert s.force[k, "moment I"] == pytest.approx(-w * rest**2 / 2, rel=1e-10)


def test_simple_beam_at_midspan():
    """5 w L^4/384EI under weight, P L^3/48EI under a load at midspan, of a member or of a node alike."""
    s = solved(mesh("simple", 2))
    assert s.u[2][1] == pytest.approx(-5 * M * G * L**4 / (384 * EI), rel=1e-11)
    for n, tail in ((2, "LOADS\n 2 0 -30 0"), (4, "LOADS\n 3 0 -30 0")):
        s = solved(mesh("simple", n, tail=tail), self_weight=False)
        assert s.u[n // 2 + 1][1] == pytest.approx(-30 * L**3 / (48 * EI), rel=1e-11)
    # one member alone, ends free to turn: the slope is w L^3/24EI + P L^2/16EI
    s = solved(mesh("simple", 1, tail="MEMBER_LOADS\n 1 PY=-30"))
    slope = M * G * L**3 / (24 * EI) + 30 * L**2 / (16 * EI)
    assert s.u[1][2] == pytest.approx(-slope, rel=1e-11)
    assert s.u[2][2] == pytest.approx(slope, rel=1e-11)


def test_two_spans_over_three_supports():
    """Clapeyron: support moment w L^2/8, middle reaction 5 w L/4, outer ones 3 w L/8
    (spans L, pinned ends).
    """
    s = solved(f"""
NODES
 1 0 0 FIX=XY
 2 {L} 0 FIX=Y
 3 {2 * L} 0 FIX=Y
ELEMENTS
 1 TO 2 B 1 TO 2 2 TO 3
PROPS
 B FRAME E={E!r} A={A!r} I={IZ!r}
MEMBER_LOADS
 1,2 WY=-4
""")
    assert [s.reaction[k][1] for k in (1, 2, 3)] == pytest.approx([1.5 * L, 5 * L, 1.5 * L], rel=1e-11)
    assert s.force[1, "moment J"] == pytest.approx(-4 * L**2 / 8, rel=1e-11)
    assert s.force[2, "moment I"] == pytest.approx(4 * L**2 / 8, rel=1e-11)


def test_a_slender_mesh_is_no_mechanism():
    """A cantilever of 400 members; condition numbers grow as n^4, so half the digits remain,
    and no more is asked.
    """
    s = solved(mesh("cantilever", 400))
    assert s.u[401][1] == pytest.approx(-M * G * L**4 / (8 * EI), rel=1e-4)
    exact = ROOTS["cantilever"][0] ** 2 / L**2 * math.sqrt(EI / M)
    assert s.structure.free_vibration.omega[0] == pytest.approx(exact, rel=1e-5)


def test_low_modes_keep_their_digits():
    """100 consistent members, squared frequencies from 1 to 3e10:
    rounding of the stiff modes must not reach the first.
    """
    exact = ROOTS["cantilever"][0] ** 2 / L**2 * math.sqrt(EI / M)
    s = structure_of(mesh("cantilever", 100, "CONSISTENT"))
    assert s.free_vibration.omega[0] == pytest.approx(exact, rel=1e-8)
