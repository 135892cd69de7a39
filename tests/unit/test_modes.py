"""Free vibration: closed forms, participation, orthonormality, rigid bodies, massless DOFs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import structure_of
from pound_solve.analyses import modal
from pound_solve.numerics import modes

PHI = (1 + math.sqrt(5)) / 2


def shear_building(n: int = 2, k: float = 4.2e5, w: float = 1600.0, extra: str = "") -> str:
    return f"""
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 TO {n + 1} 0 3 TO {3 * n} FIX=YR
ELEMENTS
 1 TO {n} S 1 TO {n} 2 TO {n + 1}
PROPS
 S SPRING KX={k!r}
WEIGHTS
 2 TO {n + 1} {w!r}
{extra}
"""


def test_two_storeys():
    """omega^2 = (3 -+ sqrt 5)/2 k/m, shapes 1 : (1 + sqrt 5)/2 and (1 + sqrt 5)/2 : -1."""
    s = structure_of(shear_building())
    m = 1600 / 9.81
    wanted = [(3 + sign * math.sqrt(5)) / 2 * 4.2e5 / m for sign in (-1, 1)]
    assert s.free_vibration.omega**2 == pytest.approx(wanted, rel=1e-13)
    unit = 1 / math.sqrt(m * (1 + PHI**2))
    assert pytest.approx(unit * np.array([[1, PHI], [PHI, -1]]), rel=1e-13) == s.free_vibration.shapes.T
    rows = modal.natural_modes(s, None)
    # gamma = sum m phi for mass-normalised shapes
    gammas = [m * unit * (1 + PHI), m * unit * (PHI - 1)]
    assert [r[5] for r in rows] == pytest.approx(gammas, rel=1e-12)
    assert [r[6] for r in rows] == pytest.approx([g**2 for g in gammas], rel=1e-12)
    assert sum(r[6] for r in rows) == pytest.approx(2 * m, rel=1e-13)
    assert [r[3] for r in rows] == pytest.approx([2 * math.pi / math.sqrt(x) for x in wanted], rel=1e-13)


@pytest.mark.parametrize("n", [1, 3, 10, 40])
def test_uniform_shear_building(n):
    """omega_j = 2 sqrt(k/m) sin((2j-1) pi / (4n+2))."""
    s = structure_of(shear_building(n, 1000.0, 9.81))
    wanted = [
        2 * math.sqrt(1000.0) * math.sin((2 * j - 1) * math.pi / (4 * n + 2)) for j in range(1, n + 1)
    ]
    assert s.free_vibration.omega == pytest.approx(wanted, rel=1e-12)
    rows = modal.natural_modes(s, 100)
    assert len(rows) == n
    assert sum(r[6] for r in rows) == pytest.approx(n, rel=1e-12)
    assert sum(r[7] for r in rows) == pytest.approx(100, rel=1e-12)
    assert all(r[8] == 0 for r in rows)  # nothing moves along y


FRAME = """
GRAVITY 9.81
MASS {mass}
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 5 3.2
 4 5 0 FIX=XY
 5 6 3.5 SLAVED=XYR MASTER=3
ELEMENTS
 1 C 1 2
 2 B 2 3
 3 C 4 3
PROPS
 C FRAME E=2e8 A=0.01 I=1e-4 WGT=5
 B FRAME E=2e8 A=0.01 I=2e-4 WGT=9 END1=0.2 END2=0.1 PIN=J
WEIGHTS
 2,5 50 60 7
"""


@pytest.mark.parametrize("mass", ["LUMPED", "CONSISTENT"])
def test_shapes_are_orthonormal_and_participation_is_complete(mass):
    s = structure_of(FRAME.format(mass=mass))
    n = s.n_free
    k, m, v = s.initial_stiffness[:n, :n], s.mass[:n, :n], s.free_vibration
    size = len(v.omega)
    assert v.shapes.T @ m @ v.shapes == pytest.approx(np.eye(size), abs=1e-12)
    assert v.shapes.T @ k @ v.shapes == pytest.approx(np.diag(v.omega**2), abs=1e-11 * v.omega[-1] ** 2)
    rows = modal.natural_modes(s, 100)
    for d in range(2):
        # independent of modes: g' M^-1 g over the DOFs with mass
        heavy = np.any(m != 0, axis=1)
        g = s.ground[d, :n][heavy]
        wanted = float(g @ np.linalg.solve(m[np.ix_(heavy, heavy)], g))
        assert sum(r[6 + 3 * d] for r in rows) == pytest.approx(wanted, rel=1e-10)
        assert sum(r[7 + 3 * d] for r in rows) == pytest.approx(100, rel=1e-10)
        if mass == "LUMPED":  # all nodal mass but that at the supports
            weights = 100 + 5 * 3 / 2 + 9 * math.hypot(5, 0.2) + 5 * 3.2 / 2 + (20 if d else 0)
            assert wanted == pytest.approx(weights / 9.81, rel=1e-12)


def test_massless_rotations_are_condensed_exactly():
    """Cantilever with two lumped masses: 1/omega^2 are the eigenvalues of F M,
    F the flexibilities a^2(3b-a)/6EI.
    """
    ei, masses, at = 2e4, np.array([3.0, 2.0]), (2.0, 5.0)
    s = structure_of(f"""
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 {at[0]} 0 FIX=X
 3 {at[1]} 0 FIX=X
ELEMENTS
 1 B 1 2
 2 B 2 3
PROPS
 B FRAME E=2e8 A=0.01 I=1e-4
WEIGHTS
 2 {masses[0]}
 3 {masses[1]}
""")
    flexibility = np.array(
        [[min(a, b) ** 2 * (3 * max(a, b) - min(a, b)) / (6 * ei) for b in at] for a in at]
    )
    wanted = np.sort(1 / np.sqrt(np.linalg.eigvals(flexibility * masses)))
    assert s.free_vibration.omega == pytest.approx(wanted, rel=1e-12)
    # the rotations in the shapes are the static ones: no moment is left on them
    turn = [i for i, f in enumerate(s.dofs.free) if f[1] == 2]
    assert np.abs(s.stiffness[turn] @ s.free_vibration.shapes).max() < 1e-11 * np.abs(s.stiffness).max()


@pytest.mark.parametrize("mass", ["LUMPED", "CONSISTENT"])
def test_a_free_beam_has_three_rigid_body_modes(mass):
    """Their frequencies are exactly zero, and the first bending mode is that of the free-free beam."""
    n, length = 20, 6.0
    s = structure_of(f"""
GRAVITY 10
MASS {mass}
NODES
 1 TO {n + 1} 0 TO {length * 0.8!r} 0 TO {length * 0.6!r}
ELEMENTS
 1 TO {n} B 1 TO {n} 2 TO {n + 1}
PROPS
 B FRAME E=2e8 A=0.01 I=1e-4 WGT=10
""")
    v = s.free_vibration
    assert (v.omega[:3] == 0).all() and v.omega[3] > 0
    m = s.mass
    assert v.shapes.T @ m @ v.shapes == pytest.approx(np.eye(len(v.omega)), abs=1e-10)
    assert np.abs(s.stiffness @ v.shapes[:, :3]).max() < 1e-10 * np.abs(s.stiffness).max()
    exact = 4.730040744862704**2 / length**2 * math.sqrt(2e4)
    assert v.omega[3] == pytest.approx(exact, rel=3e-6 if mass == "CONSISTENT" else 1e-2)
    rows = modal.natural_modes(s, 3)
    assert sum(r[6] for r in rows) == pytest.approx(
        length, rel=1e-10
    )  # a unit motion is rigid: all the mass
    assert math.isinf(rows[0][3]) and math.isnan(rows[0][4])


def test_a_mass_held_by_nothing_has_no_mode():
    s = structure_of(shear_building(2, extra="").replace("2 TO 3 0 3 TO 6 FIX=YR", "2 TO 3 0 3 TO 6 FIX=R"))
    assert len(s.free_vibration.omega) == 2  # the floors' uy are held by nothing
    rows = modal.natural_modes(s, None)
    assert all(r[9] == 0 and r[10] == 0 for r in rows)


def test_mass_on_a_slave_alone():
    """A mass on an arm makes a singular mass matrix of its master: one direction of it is massless.

    Column with sway stiffness k and turning stiffness kr, mass m at the height a above its top,
    no rotational inertia: the springs act one after the other, 1/K = 1/k + a^2/kr.
    """
    k, kr, a, m = 300.0, 800.0, 1.5, 2.0
    s = structure_of(f"""
GRAVITY 1
NODES
 1 0 3 FIX=Y
 2 0 {3 + a} SLAVED=XYR MASTER=1
ELEMENTS
 1 S 1
PROPS
 S SPRING KX={k} KR={kr}
WEIGHTS
 2 {m}
""")
    assert s.free_vibration.omega == pytest.approx([math.sqrt(1 / (1 / k + a**2 / kr) / m)], rel=1e-12)


def test_low_modes_beside_stiff_ones():
    """Two masses tied by a spring 1e10 on a spring 1: omega = sqrt(k / 2m) as far as K can hold both."""
    s = structure_of("""
GRAVITY 1
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 SOFT 1
 2 STIFF 1 2
PROPS
 SOFT SPRING KX=1
 STIFF SPRING KX=1e10
WEIGHTS
 1,2 1
""")
    # the stiffness matrix itself holds 1 + 1e10 to 2e-6 of the soft spring: K's rounding, 1e-16 * 1e10
    assert s.free_vibration.omega[0] == pytest.approx(math.sqrt(0.5), rel=1e-6)
    assert s.free_vibration.omega[1] == pytest.approx(math.sqrt(2e10), rel=1e-9)


@pytest.mark.parametrize("far", [3e8, 1e9, 2147483649, 5e9, 1e10, 1e11])
def test_a_node_far_away(far):
    """Modes below the rounding of others are told in their order, if as zero; the others are right."""
    s = structure_of(f"""
NODES
 1 0 0 FIX=XYR
 2 5 0 FIX=XYR
 3 0 3
 4 5 3
 5 -{far:.12g} 6
 6 5 6
ELEMENTS
 1 C 1 3
 2 C 2 4
 3 C 3 5
 4 C 4 6
 5 C 3 4
 6 C 5 6
PROPS
 C FRAME E=2.8E7 A=0.16 I=6E-4
WEIGHTS
 3 TO 6 100
""")
    omega = s.free_vibration.omega
    assert np.all(np.diff(omega) >= 0.0)
    assert omega[2] == pytest.approx(8.9302, rel=1e-4)


@settings(max_examples=60)
@given(st.data())
def test_random_systems(data):
    """Any K = B'B and lumped or consistent M, massless DOFs among them:
    M- and K-orthogonal, none lost.
    """
    n = data.draw(st.integers(1, 7))
    rng = np.random.default_rng(data.draw(st.integers(0, 2**31)))
    b = rng.normal(size=(n, n)) + 2 * np.eye(n)
    k = b.T @ b
    light = rng.random(n) < 0.3
    a = (
        np.diag(rng.uniform(0.5, 3, n))
        if data.draw(st.booleans())
        else (lambda q: q.T @ q + np.eye(n))(rng.normal(size=(n, n)))
    )
    m = np.where(light[:, None] | light, 0.0, a)
    v = modes.solve(k, m)
    assert len(v.omega) == n - light.sum()
    assert (np.diff(v.omega) >= 0).all()
    if len(v.omega):
        assert v.shapes.T @ m @ v.shapes == pytest.approx(np.eye(len(v.omega)), abs=1e-10)
        residual = k @ v.shapes - m @ v.shapes * v.omega**2
        assert np.abs(residual).max() < 1e-10 * np.abs(k).max() * np.abs(v.shapes).max()


def test_a_massless_mechanism_is_an_error():
    k = np.array([[1.0, 0, 0], [0, 1, -1], [0, -1, 1]])
    with pytest.raises(np.linalg.LinAlgError):
        modes.solve(k, np.diag([1.0, 0, 0]))


PAIR = """
GRAVITY 9.81
NODES
 1 0 0 FIX=XYR
 2 TO 3 0 3 TO 6 FIX=YR
 11 5 0 FIX=XYR
 12 5 3 FIX=YR
ELEMENTS
 1 S 1 2
 2 S 2 3
 3 T 11 12
 9 HIT 2 12
PROPS
 S SPRING KX=4.2e5
 T SPRING KX={k!r}
 HIT CONTACT GAP=0.1 K=1e6
WEIGHTS
 2,3,12 1600
BUILDINGS
 "low" NODES=12
"""


def test_modes_belong_to_buildings():
    """Each building vibrates on its own; where a period of both is the same, no mode belongs to one."""
    found = modal.kinetic_shares(structure_of(PAIR.format(k=3e5)), 3)
    assert [(s.mode, s.building) for s in found] == [(1, "building 1"), (2, "low"), (3, "building 1")]
    assert [s.kinetic for s in found] == pytest.approx([100.0] * 3, rel=1e-12)
    s = structure_of(PAIR.format(k=4.2e5 * (3 - math.sqrt(5)) / 2))
    shares = {(x.mode, x.building): x.kinetic for x in modal.kinetic_shares(s, 3)}
    for mode in (1, 2, 3):
        assert sum(x for (n, _), x in shares.items() if n == mode) == pytest.approx(100.0, abs=0.2)
    assert shares[3, "building 1"] == pytest.approx(100.0, rel=1e-12)
    held = sum(x for (n, name), x in shares.items() if name == "low" and n < 3)
    assert held == pytest.approx(100.0, abs=0.2)
