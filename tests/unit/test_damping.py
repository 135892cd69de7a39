"""Damping: ratios asked are ratios given; groups add up; matrices are symmetric and dissipate;
dashpots that follow the stiffness move as the closed forms say, and balance their energy.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from decks import structure_of
from pound_solve.analyses import modal
from pound_solve.driver.prepare import DeckError, prepare
from pound_solve.driver.request import Request
from pound_solve.laws.automaton import REVERSAL_DOWN, REVERSAL_UP, BranchKind, Law, Rule, drive, linear
from pound_solve.laws.hysteresis import bilinear, slack_growing
from pound_solve.numerics.modes import condense, massless
from pound_solve.structure.assembly import AssemblyError
from pound_solve.structure.damping import caughey
from pound_solve.structure.damping.secant import SecantLaw
from pound_solve.structure.elements.base import LawSpring
from tiers import at_night, each_once
from verification.cases import run_text

pytestmark = pytest.mark.full

FRAME = """
GRAVITY 9.81
MASS {mass}
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 5 3.2
 4 5 0 FIX=XYR
 5 6 3.5 SLAVED=XYR MASTER=3
 6 0 6
ELEMENTS
 1 C 1 2
 2 B 2 3
 3 D 4 3
 4 C 2 6
 5 S 6 3
PROPS
 C FRAME E=2e8 A=0.01 I=1e-4 WGT=5
 D FRAME E=2e8 A=0.01 I=3e-4 WGT=4 END2=0.4
 B FRAME E=2e8 A=0.01 I=2e-4 WGT=9 PIN=J
 S SPRING KX=900 FX=50 RULE=BILINEAR R=0.1
WEIGHTS
 2,5 50 60 7
 6 30
"""


def frame(damping: str, mass: str = "LUMPED"):
    return structure_of(FRAME.format(mass=mass) + (f"\nDAMPING\n{damping}\n" if damping else ""))


def modal_damping(s):
    n = s.n_free
    return s.free_vibration.shapes.T @ s.damping[:n, :n] @ s.free_vibration.shapes


@pytest.mark.parametrize("mass", ["LUMPED", "CONSISTENT"])
@pytest.mark.parametrize("xi", [0.02, 0.3])
def test_rayleigh_at_two_modes(xi, mass):
    s = frame(f" RAYLEIGH XI={xi} MODES=1,3", mass)
    w = s.free_vibration.omega
    c = modal_damping(s)
    ratio = np.diag(c) / (2 * w)
    assert ratio[[0, 2]] == pytest.approx([xi, xi], rel=1e-8)
    # between them less, elsewhere more, all on xi_n = alpha/2w + beta w/2, and nothing couples the modes
    assert ratio[1] < xi < ratio[3]
    a, b = 2 * xi * w[0] * w[2] / (w[0] + w[2]), 2 * xi / (w[0] + w[2])
    assert ratio == pytest.approx(a / (2 * w) + b * w / 2, rel=1e-7)
    assert np.abs(c - np.diag(np.diag(c))).max() < 1e-9 * np.abs(c).max()
    assert [r[4] for r in modal.natural_modes(s, 3)] == pytest.approx(100 * ratio[:3], rel=1e-12)


def test_rayleigh_at_two_frequencies_of_a_single_mass():
    """k/m = 400: omega 20; asked for 5 % at 20 and 50."""
    s = structure_of("""
GRAVITY 10
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 S 1
PROPS
 S SPRING KX=400
WEIGHTS
 1 10
DAMPING
 RAYLEIGH XI=0.05 OMEGA=20,50
""")
    assert s.damping[0, 0] == pytest.approx(2 * 0.05 * 20, rel=1e-14)
    alpha, beta = 2 * 0.05 * 1000 / 70, 0.1 / 70
    assert s.damping[0, 0] == pytest.approx(alpha + beta * 400, rel=1e-14)


@pytest.mark.parametrize("mass", ["LUMPED", "CONSISTENT"])
def test_alpha_and_beta_as_given(mass):
    s = frame(" RAYLEIGH ALPHA=0.3 BETA=0.002", mass)
    assert s.damping == pytest.approx(0.3 * s.mass + 0.002 * s.initial_stiffness, rel=1e-13)
    assert s.initial_stiffness != pytest.approx(
        s.stiffness
    )  # the hysteretic spring is damped by its initial stiffness


@pytest.mark.parametrize("mass", ["LUMPED", "CONSISTENT"])
def test_groups_add_up_to_the_whole(mass):
    """Nodes of each group, property sets of each group: all members' masses count,
    those between groups too.
    """
    whole = frame(" RAYLEIGH ALPHA=0.3 BETA=0.002", mass).damping
    groups = frame(
        """
 RAYLEIGH ALPHA=0.3 NODES=1,2 BETA=0.002 PROPS=C,S
 RAYLEIGH ALPHA=0.3 NODES=3,4,5 BETA=0.002 PROPS=B
 RAYLEIGH ALPHA=0.3 NODES=6 BETA=0.002 PROPS=D
""",
        mass,
    ).damping
    assert groups == pytest.approx(whole, abs=1e-13 * np.abs(whole).max())


def test_a_lumped_group_takes_the_mass_at_its_nodes():
    """Half of each member's mass belongs to each of its nodes, whatever group the other node is of."""
    s = frame(" RAYLEIGH ALPHA=1 BETA=0 NODES=2 PROPS=C")
    at = {f: i for i, f in enumerate(s.dofs.free)}
    mass = (50 + 5 * 3 + 9 * np.hypot(5, 0.2) / 2) / 9.81
    assert s.damping[at[2, 0], at[2, 0]] == pytest.approx(mass, rel=1e-13)
    assert np.count_nonzero(s.damping) == 3  # node 2: ux, uy, rz
    # a support need not be named for the mass of the columns that stand on it
    named = frame(" RAYLEIGH ALPHA=1 BETA=0 NODES=1,2 PROPS=C")
    assert named.damping == pytest.approx(s.damping, rel=1e-14)


def test_modal_damping_gives_each_mode_its_ratio():
    xi = (0.01, 0.2, 0.05)
    s = frame(" MODAL XI=0.01,0.2,0.05")
    w, c = s.free_vibration.omega, modal_damping(s)
    wanted = np.array([xi[min(i, 2)] for i in range(len(w))])
    assert np.diag(c) == pytest.approx(2 * wanted * w, rel=1e-9)
    assert np.abs(c - np.diag(np.diag(c))).max() < 1e-9 * np.abs(c).max()


def test_cards_of_different_kinds_add_up():
    a, b = frame(" MODAL XI=0.02").damping, frame(" RAYLEIGH BETA=0.001").damping
    both = frame(" MODAL XI=0.02\n RAYLEIGH BETA=0.001").damping
    assert both == pytest.approx(a + b, abs=1e-12 * np.abs(a).max())


CARDS = st.one_of(
    st.builds("RAYLEIGH ALPHA={!r} BETA={!r}".format, st.floats(0, 5), st.floats(0, 0.1)),
    st.builds("RAYLEIGH XI={!r} MODES={},{}".format, st.floats(0, 1), st.integers(1, 8), st.integers(1, 8)),
    st.builds(
        "RAYLEIGH XI={!r} OMEGA={!r},{!r}".format, st.floats(0, 1), st.floats(0.1, 50), st.floats(0.1, 50)
    ),
    st.builds(
        "RAYLEIGH ALPHA={!r} BETA={!r} NODES={} PROPS={}".format,
        st.floats(0, 5),
        st.floats(0, 0.1),
        st.sampled_from(["1,2", "3", "2,6", "5", "1 TO 4"]).map(
            lambda x: x if "TO" not in x else "1,2,3,4"
        ),
        st.sampled_from(["B", "C,S", "S"]),
    ),
    st.builds("MODAL XI={!r},{!r}".format, st.floats(0, 1), st.floats(0, 1)),
    st.builds(
        "MODAL XI={!r},{!r} {}".format,
        st.floats(0, 1),
        st.floats(0, 1),
        st.sampled_from(["OMEGA=3,20", "MODES=2,5", "MODES=6,2 OVER=MODE"]),
    ),
    st.builds("CAUGHEY XI={!r} OMEGA={!r}".format, st.floats(0, 1), st.floats(0.1, 50)),
    st.builds("CAUGHEY XI={!r} MODES=1,4".format, st.floats(0, 1)),
)


@settings(max_examples=60)
@given(cards=st.lists(CARDS, min_size=1, max_size=3), mass=st.sampled_from(["LUMPED", "CONSISTENT"]))
def test_damping_is_symmetric_and_takes_energy(cards, mass):
    c = frame("\n".join(" " + x for x in cards), mass).damping
    size = max(np.abs(c).max(), 1e-200)  # subnormal numbers have no digits to agree in
    assert np.abs(c - c.T).max() <= 1e-14 * size
    assert np.linalg.eigvalsh(c)[0] >= -1e-12 * size


def test_moved_supports_are_not_held_by_mass_damping():
    """Mass-proportional damping acts on the motion relative to the supports:
    carried along with them, nothing resists.
    """
    text = FRAME.format(mass="LUMPED") + "\nDAMPING\n RAYLEIGH ALPHA=0.5\n MODAL XI=0.05\n"
    moved = [(n, d) for n in (1, 4) for d in range(2)]
    s = structure_of(text, moved=moved)
    for d in range(2):
        rigid = np.array([1.0 if f[1] == d else 0.0 for f in (*s.dofs.free, *s.dofs.moved)])
        assert np.abs(s.damping @ rigid).max() < 1e-9 * np.abs(s.damping).max()
    # one support alone drags the structure along its quasi-static shape without damping forces
    drive = np.concatenate([s.influence()[:, 0], np.eye(4)[0]])
    assert np.abs(s.damping @ drive).max() < 1e-9 * np.abs(s.damping).max()
    assert np.linalg.eigvalsh(s.damping)[0] > -1e-9 * np.abs(s.damping).max()


@pytest.mark.parametrize(
    ("card", "words", "item"),
    [
        ("RAYLEIGH XI=0.05", "XI needs the circular", "XI"),
        ("RAYLEIGH XI=0.05 OMEGA=1,2 MODES=1,2", "XI needs the circular", "XI"),
        ("RAYLEIGH XI=0.05 ALPHA=1 OMEGA=1,2", "not both", "XI"),
        ("RAYLEIGH OMEGA=1,2", "go with XI", "OMEGA"),
        ("RAYLEIGH MODES=1,2 ALPHA=1", "go with XI", "MODES"),
        ("RAYLEIGH XI=0.05,0.02 OMEGA=3,3", "lies between", "XI"),
        ("RAYLEIGH XI=0.05,0.11 OMEGA=3,6", "between 0.025 and 0.1", "XI"),
        ("RAYLEIGH XI=0.05,0.02 OMEGA=3,6", "between 0.025 and 0.1", "XI"),
        ("MODAL XI=0.05,0.02 OMEGA=1,2 MODES=1,2", "XI needs the circular", "XI"),
        ("MODAL XI=0.05,0.04,0.03 OMEGA=1,2", "3 values for 2 frequencies", "XI"),
        ("MODAL XI=0.05 MODES=2,2", "the same (", "MODES"),
        ("MODAL XI=0.05 OVER=MODE", "OVER needs OMEGA or MODES", "OVER"),
        ("MODAL XI=0.05,0.01 MODES=1,2 BEYOND=LINEAR", "the line falls", "BEYOND"),
        ("CAUGHEY XI=0.05", "XI needs the circular", "XI"),
        ("CAUGHEY XI=0.05 MODES=1,1", "the same (", "MODES"),
        ("CAUGHEY XI=0.05,0.001,0.05 MODES=1,2,3", "between the given", "XI"),
        ("CAUGHEY XI=0.05 MODES=1,2,3", "beyond the given", "XI"),
    ],
)
def test_contradictions_are_diagnostics(card, words, item):
    with pytest.raises(AssemblyError) as caught:
        frame(" " + card)
    (found,) = caught.value.diagnostics
    assert found.code == "P332" and words in found.message
    line = len(FRAME.splitlines()) + 3
    assert found.span.line == line and found.span.column == 3 + card.index(item) + len(item)


@pytest.mark.parametrize("card", ["MODAL XI=0.05", "RAYLEIGH XI=0.05", "CAUGHEY XI=0.05"])
def test_a_mode_beyond_the_last_is_the_last(card):
    last = len(frame(f" {card} MODES=1,2").free_vibration.omega)
    told, plain = frame(f" {card} MODES=1,99"), frame(f" {card} MODES=1,{last}")
    (found,) = told.remarks
    assert (found.code, found.severity) == ("P346", "warning") and f"its last one, {last}," in found.message
    assert np.array_equal(told.damping, plain.damping) and not plain.remarks


def test_one_mode_stands_for_both_of_a_line():
    text = """
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 S 1 2
PROPS
 S SPRING KX=4
WEIGHTS
 2 9.81
DAMPING
 MODAL XI=0.05,0.05 MODES=1,2 BEYOND=LINEAR
"""
    assert structure_of(text).damping[0, 0] == pytest.approx(2 * 0.05 * 2.0, rel=1e-14)
    with pytest.raises(AssemblyError, match="the same"):
        structure_of(text.replace("0.05,0.05", "0.05,0.02"))


def test_a_rigid_body_mode_carries_no_ratio():
    with pytest.raises(AssemblyError, match="zero frequency"):
        structure_of("""
NODES
 1 0 0 FIX=YR
 2 1 0 FIX=YR
ELEMENTS
 1 S 1 2
PROPS
 S SPRING KX=1
WEIGHTS
 1,2 1
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2
""")


# ---------------------------------------------------------------- ratios over frequency

CHAIN = """
GRAVITY 10
NODES
 1 TO {last} 0 0 TO {n} FIX=YR
ELEMENTS
 1 C 1
 2 TO {n} C 1 TO {before} 2 TO {n}
PROPS
 C SPRING KX=400 {law}
WEIGHTS
 1 TO {n} 10
DAMPING
 {card}
"""


def chain(card: str, n: int = 6, law: str = ""):
    """Storeys of mass 1 and stiffness 400 on top of each other."""
    text = CHAIN.format(card=card, n=n, last=n, before=n - 1, law=law).replace("0 0 TO", "0 1 TO")
    return structure_of(text)


def chain_omega(n: int = 6):
    """Closed form for n equal storeys: omega = 2 sqrt(k/m) sin((2 j - 1) pi / (4 n + 2))."""
    return 40 * np.sin((2 * np.arange(1, n + 1) - 1) * np.pi / (4 * n + 2))


def complex_ratios(s):
    """Ratios from the complex eigenvalues of the whole system, by frequency: -Re / |lambda|."""
    n = s.n_free
    inverse = np.linalg.inv(s.mass[:n, :n])
    k, c = s.initial_stiffness[:n, :n], s.initial_damping[:n, :n]
    values = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ k, -inverse @ c]]))
    values = values[np.argsort(np.abs(values))][::2]
    return np.abs(values), -values.real / np.abs(values)


W = chain_omega()
LAW = "FX=1E6 RULE=BILINEAR"


def rayleigh(x1, x2):
    """Ratios of alpha M + beta K with `x1` in mode 1 and `x2` in mode 3."""
    alpha, beta = np.linalg.solve([[1 / W[0], W[0]], [1 / W[2], W[2]]], [2 * x1, 2 * x2])
    return alpha / (2 * W) + beta * W / 2


def line(x2, x4):
    """Straight line over frequency through `x2` in mode 2 and `x4` in mode 4."""
    return x2 + (x4 - x2) * (W - W[1]) / (W[3] - W[1])


@pytest.mark.parametrize(
    ("card", "law", "wanted"),
    [
        ("RAYLEIGH XI=0.05 MODES=1,3", "", rayleigh(0.05, 0.05)),
        ("RAYLEIGH XI=0.05,0.04 MODES=1,3", "", rayleigh(0.05, 0.04)),
        ("RAYLEIGH XI=0.03,0.06 OMEGA=10,20", "", 0.03 * W / 10),  # stiffness proportional
        ("RAYLEIGH XI=0.06,0.03 OMEGA=10,20", "", 0.06 * 10 / W),  # mass proportional
        ("RAYLEIGH XI=0.05 MODES=1,3 STIFFNESS=TANGENT", LAW, rayleigh(0.05, 0.05)),
        ("RAYLEIGH XI=0.05 MODES=1,3 STIFFNESS=SECANT", LAW, rayleigh(0.05, 0.05)),
        ("MODAL XI=0.07", "", np.full(6, 0.07)),
        ("MODAL XI=0.01,0.2,0.05", "", [0.01, 0.2, 0.05, 0.05, 0.05, 0.05]),
        ("MODAL XI=0.02,0.08 MODES=2,4", "", [0.02, 0.02, line(0.02, 0.08)[2], 0.08, 0.08, 0.08]),
        ("MODAL XI=0.08,0.02 MODES=4,2", "", [0.02, 0.02, line(0.02, 0.08)[2], 0.08, 0.08, 0.08]),
        ("MODAL XI=0.05,0.08 MODES=2,4 BEYOND=LINEAR", "", line(0.05, 0.08)),
        ("MODAL XI=0.05,0.05 MODES=2,4 BEYOND=LINEAR", "", np.full(6, 0.05)),
        ("MODAL XI=0.02,0.08 MODES=2,4 OVER=MODE", "", [0.02, 0.02, 0.05, 0.08, 0.08, 0.08]),
        ("MODAL XI=0.05,0.08 MODES=2,4 OVER=MODE BEYOND=2", "", [0.035, 0.05, 0.065, 0.08, 0.095, 0.11]),
        ("MODAL XI=0.1,0.02,0.3 OMEGA=10,20,30 BEYOND=3", "", np.interp(W, [10, 20, 30], [0.1, 0.02, 0.3])),
        ("CAUGHEY XI=0.05 MODES=3", "", 0.05 * W[2] / W),  # one term: mass proportional
        ("CAUGHEY XI=0.05,0.04 MODES=1,3", "", rayleigh(0.05, 0.04)),
        (
            "CAUGHEY XI=0.01,0.02,0.03,0.05,0.06,0.05 MODES=1,2,3,4,5,6",
            "",
            [0.01, 0.02, 0.03, 0.05, 0.06, 0.05],
        ),
    ],
)
def test_the_ratios_asked_are_those_of_the_complex_modes(card, law, wanted):
    s = chain(card, law=law)
    assert s.free_vibration.omega == pytest.approx(W, rel=1e-12)
    omega, ratio = complex_ratios(s)
    assert omega == pytest.approx(W, rel=1e-10)  # classical damping leaves |lambda| at omega
    assert ratio == pytest.approx(np.array(wanted), rel=1e-9)
    assert [r[4] for r in modal.natural_modes(s, 6)] == pytest.approx(100 * ratio, rel=1e-9)


def test_the_report_says_what_ratios_the_modes_get():
    ((_, text),) = chain("MODAL XI=0.02,0.08 OMEGA=10,20").damping_texts
    assert text == "XI 0.02, 0.08 at omega 10, 20, constant beyond; 6 modes have 0.02 to 0.08"
    ((_, text),) = chain("CAUGHEY XI=0.05 OMEGA=6,14,26,39").damping_texts
    assert text.startswith("4 terms, XI 0.05, 0.05, 0.05, 0.05 at omega 6, 14, 26, 39; 6 modes have 0.04")
    ((_, text),) = chain("RAYLEIGH ALPHA=1 BETA=0.1 STIFFNESS=1").damping_texts
    assert text == "alpha 1, beta 0.1 of the tangent stiffness (ALPHA and BETA given)"


# ---------------------------------------------------------------- Caughey's series


def test_two_terms_are_rayleigh_damping():
    a, b = (chain(f"{kind} XI=0.02,0.05 OMEGA=6,30").damping for kind in ("CAUGHEY", "RAYLEIGH"))
    assert a == pytest.approx(b, abs=1e-13 * np.abs(b).max())


def test_two_terms_with_massless_dofs_are_rayleigh_damping_after_condensation():
    """On the DOFs without mass themselves, which the series cannot damp, nothing acts."""
    a, b = (frame(f" {kind} XI=0.05 MODES=1,3") for kind in ("CAUGHEY", "RAYLEIGH"))
    n = a.n_free
    light = massless(a.mass[:n, :n])
    assert light.any() and not a.damping[:n, :n][light].any()
    t = condense(a.initial_stiffness[:n, :n], light)
    one, other = (t.T @ s.damping[:n, :n] @ t for s in (a, b))
    assert one == pytest.approx(other, abs=1e-9 * np.abs(other).max())


@pytest.mark.parametrize("points", [(5, 20, 40), (4, 12, 27, 41), (4, 10, 20, 30, 40)])
def test_the_series_is_that_of_the_powers_of_the_matrices(points):
    """Against Caughey's own form, with coefficients from the (ill-conditioned) equations."""
    xi = np.array([0.05, 0.05, 0.055, 0.06, 0.07])[: len(points)]
    s = chain(f"CAUGHEY XI={','.join(map(str, xi))} OMEGA={','.join(map(str, points))}")
    w = np.array(points, float)
    a = np.linalg.solve(w[:, None] ** (2 * np.arange(len(w))), 2 * xi * w)
    k, m = s.initial_stiffness, s.mass
    series = m @ sum(a[b] * np.linalg.matrix_power(np.linalg.solve(m, k), b) for b in range(len(w)))
    assert s.damping == pytest.approx(series, abs=1e-9 * np.abs(series).max())


@given(
    gaps=st.lists(st.floats(0.05, 3.0), min_size=1, max_size=12),
    xi=st.lists(st.floats(0.0, 1.0), min_size=12, max_size=12),
)
def test_the_series_hits_all_its_points(gaps, xi):
    w = np.cumsum(gaps)
    x = np.array(xi[: len(w)])
    assert caughey.rates(w, w, x) == pytest.approx(2 * x * w, rel=1e-14, abs=0.0)


def test_equal_frequencies_of_two_buildings_are_no_two_points():
    with pytest.raises(AssemblyError, match="the same"):
        structure_of(PAIR.format(card="CAUGHEY XI=0.05 MODES=1,2"))


# ---------------------------------------------------------------- groups

PAIR = """
GRAVITY 10
NODES
 1 TO 3 0 3 TO 9 FIX=YR
 11 TO 13 1 3 TO 9 FIX=YR
 14 1 9 SLAVED=XYR MASTER=13
ELEMENTS
 1 C 1
 2 TO 3 C 1 TO 2 2 TO 3
 11 C 11
 12 TO 13 C 11 TO 12 12 TO 13
 99 P 3 13
PROPS
 C SPRING KX=400
 P CONTACT LAW=LINEAR K=1E6 GAP=0
WEIGHTS
 1 TO 3,11 TO 13 10
DAMPING
 {card}
"""


@pytest.mark.parametrize("kind", ["MODAL XI={}", "CAUGHEY XI={} MODES=1,2"])
def test_each_building_has_its_own_ratios(kind):
    """Two equal buildings: their modes come in pairs that the whole structure's modes mix as they like."""
    low, high = kind.format(0.02) + " NODES=1 TO 3", kind.format(0.07) + " NODES=11 TO 14"
    s = structure_of(PAIR.format(card=low + "\n " + high))
    n = s.n_free
    k, m, c = (x[:n, :n] for x in (s.initial_stiffness, s.mass, s.damping))
    for half, xi in ((slice(0, 3), 0.02), (slice(3, 6), 0.07)):
        w2, x = np.linalg.eigh(k[half, half])  # unit masses
        assert m[half, half] == pytest.approx(np.eye(3), rel=1e-14)
        own = x.T @ c[half, half] @ x
        count = 2 if "MODES" in kind else 3
        assert np.diag(own)[:count] == pytest.approx(2 * xi * np.sqrt(w2)[:count], rel=1e-10)
    assert not c[:3, 3:].any()


def test_half_a_building_has_no_modes():
    with pytest.raises(AssemblyError, match="node 3 ux is connected to these nodes"):
        structure_of(PAIR.format(card="MODAL XI=0.02 NODES=1,2"))
    with pytest.raises(AssemblyError, match="none of these nodes can move"):
        frame(" MODAL XI=0.02 NODES=1,4")


# ---------------------------------------------------------------- dashpots that follow the stiffness

STOREYS = """
GRAVITY 10
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
 3 2 0 FIX=YR
 4 3 0 FIX=XYR
ELEMENTS
 1 S 1 2
 2 S 2 3
 3 L 1 3
 4 W 3 4
PROPS
 S SPRING KX=4000 FX={fy} RULE=BILINEAR R={r}
 L SPRING KX=500
 W CONTACT GAP={gap} LAW=KELVIN_VOIGT K=1e5 E=0.6
WEIGHTS
 2,3 100
DAMPING
 RAYLEIGH XI=0.05 MODES=1,2 STIFFNESS={stiffness} {group}
EQUAKE
 SINE AMPLITUDE=4 OMEGA=12 {supports}
INITIAL
 2,3 VX={v}
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 3 METHOD=EXACT
 MODAL 2
"""
FOLLOW = ["TANGENT", "SECANT"]


def storeys(stiffness, fy=60.0, r=0.1, gap=0.02, group="", supports="", v=0.0):
    return STOREYS.format(stiffness=stiffness, fy=fy, r=r, gap=gap, group=group, supports=supports, v=v)


def energy(ran):
    return dict(zip(ran.column("energy", "item").astype(str), ran.column("energy", "value")))


@pytest.mark.parametrize("stiffness", ["SECANT", *at_night("TANGENT")])
def test_what_stays_elastic_is_damped_by_its_initial_stiffness(stiffness):
    a, b = (run_text(storeys(x, fy=1e6)) for x in ("INITIAL", stiffness))
    for one, other in ((a.u, b.u), (a.v, b.v), (a.force, b.force)):
        assert np.abs(one - other).max() < 1e-12 * np.abs(one).max()
    for table, columns in (
        ("spring_envelope", ("force_max", "force_min", "deformation_max", "deformation_min")),
        ("modes", ("damping",)),
    ):
        for name in columns:
            assert b.column(table, name) == pytest.approx(a.column(table, name), rel=1e-12)
    for name, value in energy(a).items():
        if name != "residual":
            assert energy(b)[name] == pytest.approx(value, rel=1e-10)


@each_once(("r", [0.1, 0.0, -0.02]), ("stiffness", FOLLOW))
def test_energy_balances_where_springs_yield_and_storeys_pound(stiffness, r):
    ran = run_text(storeys(stiffness, r=r))
    assert ran.status == "done" and ran.check() < 1e-12
    assert ran.column("spring_envelope", "yield_events").min() > 3 and len(ran.tables["collisions"]) > 2
    assert energy(ran)["damping"] > 1.0 < energy(ran)["contact"]


@pytest.mark.parametrize("stiffness", ["TANGENT", *at_night("INITIAL", "SECANT")])
def test_moved_supports_in_the_total_form(stiffness):
    """All supports moved together: the motion is that relative to the ground; dashpots of springs and of
    the contact with the wall, which moves too, lose the same.  The ground starts with -a/w, and so do the
    storeys.
    """
    relative = run_text(storeys(stiffness))
    total = run_text(storeys(stiffness, supports="SUPPORTS=1,4", v=-4 / 12))
    ground = total.u[:, [total.nodes.index(1)], :]
    assert np.abs(total.u - ground - relative.u).max() < 1e-11 * np.abs(relative.u).max()
    for name in ("damping", "hysteretic", "contact"):
        assert energy(total)[name] == pytest.approx(energy(relative)[name], rel=1e-10)
    lost = "contact_summary", "energy_lost"
    assert total.column(*lost) == pytest.approx(relative.column(*lost), rel=1e-10)
    assert total.check() < 1e-12


@pytest.mark.parametrize("stiffness", FOLLOW)
def test_dashpots_stand_beside_the_laws_of_their_group(stiffness):
    """The matrix holds the linear part only; laws of two cards add up; contacts have none."""
    one = "RAYLEIGH ALPHA=0.5 BETA=0.01 STIFFNESS={} PROPS=S"
    text = storeys(stiffness).replace(
        f"RAYLEIGH XI=0.05 MODES=1,2 STIFFNESS={stiffness} ",
        "\n ".join([one.format(stiffness), f"RAYLEIGH BETA=0.002 STIFFNESS={stiffness}"]),
    )
    s = structure_of(text)
    linear = np.array([[0.0, 0.0], [0.0, 500.0]])
    assert s.damping == pytest.approx(0.5 * s.mass + 0.002 * linear, rel=1e-14)
    whole = np.array([[8000.0, -4000.0], [-4000.0, 4000.0]])
    assert s.initial_damping == pytest.approx(s.damping + 0.012 * whole, rel=1e-13)
    found = [x.branch(x.law.start()).damping for x in s.laws]
    assert found[:2] == pytest.approx([48.0, 48.0], rel=1e-14) and found[2] == 0.0
    group = structure_of(storeys(stiffness, group="PROPS=L"))
    assert group.laws == structure_of(storeys("INITIAL")).laws


def test_laws_have_no_share_with_elastic():
    s = structure_of(storeys("ELASTIC", group="PROPS=S,L"))
    plain = structure_of(storeys("INITIAL", group="PROPS=L"))
    assert s.laws == plain.laws and s.damping == pytest.approx(plain.damping, rel=1e-14)
    assert s.initial_damping is s.damping


def test_a_softening_branch_has_no_dashpot():
    (s, *_) = structure_of(storeys("TANGENT", r=-0.1)).laws
    after = drive(s.law, s.law.start(), 0.0, 0.05)
    assert s.law.branch(after).stiffness == -400.0 and s.branch(after).damping == 0.0


# one storey, elastic, perfectly plastic: mass 1, k = 100, released with a velocity

FREE = """
GRAVITY 1
NODES
 1 0 0 FIX=YR
ELEMENTS
 1 S 1
PROPS
 S SPRING KX=100 FX=5 RULE=ELASTO_PLASTIC
WEIGHTS
 1 1
DAMPING
 RAYLEIGH BETA={beta} STIFFNESS={stiffness}
INITIAL
 1 VX=2
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 3 METHOD=EXACT
"""


def decay(t, c, x0, v0):
    """Displacement and velocity of m = 1, k = 100 and a dashpot c."""
    s, w = c / 2, np.sqrt(100 - c * c / 4)
    swing, drop = np.exp(-s * t), (v0 + s * x0) / w
    x = swing * (x0 * np.cos(w * t) + drop * np.sin(w * t))
    return x, swing * ((-s * x0 + w * drop) * np.cos(w * t) - (s * drop + w * x0) * np.sin(w * t))


@pytest.mark.parametrize("xi", [0.05, 0.4])
@pytest.mark.parametrize("stiffness", ["INITIAL", *FOLLOW])
def test_one_storey_yields_turns_and_swings_out_as_the_closed_form_says(stiffness, xi):
    """Elastic to the yield point, plastic to the turn, then a free decay about the plastic deformation.

    Dashpots: beta k all along with INITIAL; none while it yields with TANGENT; with SECANT beta k until
    the turn, and beta times 5 over the deformation there afterwards.
    """
    beta, k, fy, v0 = 2 * xi / 10, 100.0, 5.0, 2.0
    dy, c = fy / k, beta * k
    ty = brentq(lambda t: decay(t, c, 0.0, v0)[0] - dy, 0.0, 0.05)
    vy = decay(ty, c, 0.0, v0)[1]
    plastic = 0.0 if stiffness == "TANGENT" else c

    def slide(t):
        if plastic == 0.0:
            return dy + vy * t - 0.5 * fy * t * t, vy - fy * t
        end, swing = fy / plastic, np.exp(-plastic * t)
        return dy - end * t + (vy + end) * (1 - swing) / plastic, (vy + end) * swing - end

    turn = vy / fy if plastic == 0.0 else np.log(1 + plastic * vy / fy) / plastic
    dt = slide(turn)[0]
    after = beta * fy / dt if stiffness == "SECANT" else c
    ran = run_text(FREE.format(beta=beta, stiffness=stiffness))
    wanted = []
    for t in ran.time:
        if t < ty:
            wanted.append(decay(t, c, 0.0, v0))
        elif t < ty + turn:
            wanted.append(slide(t - ty))
        else:
            x, v = decay(t - ty - turn, after, dy, 0.0)
            wanted.append((dt - dy + x, v))
    u, v = np.array(wanted).T
    assert np.abs(ran.u[:, 0, 0] - u).max() < 1e-12 * dt
    assert np.abs(ran.v[:, 0, 0] - v).max() < 1e-12 * v0
    # the spring's force is that of the rule: 5 at most, whatever the dashpot adds
    assert ran.column("spring_envelope", "force_max") == pytest.approx([fy], rel=1e-12)
    assert ran.column("spring_envelope", "deformation_max") == pytest.approx([dt], rel=1e-12)
    found = energy(ran)
    left = 0.5 * v[-1] ** 2 + 0.5 * k * (u[-1] - (dt - dy)) ** 2
    assert found["hysteretic"] == pytest.approx(fy * (dt - dy), rel=1e-11)
    assert found["damping"] == pytest.approx(0.5 * v0**2 - left - fy * (dt - dy), rel=1e-10)
    assert found["contact"] == 0.0


@pytest.mark.parametrize("stiffness", FOLLOW)
def test_steps_converge_to_the_exact_method_with_order_two(stiffness):
    """Motion, spring forces and dashpot losses: halving the step leaves a quarter of the error."""

    def figures(method):
        ran = run_text(storeys(stiffness).replace("METHOD=EXACT", method))
        losses = [energy(ran)[name] for name in ("damping", "hysteretic", "contact")]
        return ran.u, ran.column("spring_envelope", "force_max"), np.array(losses)

    exact, *steps = (
        figures(m) for m in ("METHOD=EXACT", "METHOD=NEWMARK DT=0.001", "METHOD=NEWMARK DT=0.0005")
    )
    for wanted, coarse, fine in zip(exact, *steps):
        one, half = (np.abs(x - wanted).max() / np.abs(wanted).max() for x in (coarse, fine))
        assert half < 2e-4 and one / half > 3.5


# ---------------------------------------------------------------- laws that know their secant stiffness

BILINEAR = (bilinear.RULE, (100.0, 5.0, -5.0, 0.1))
SLACK = (slack_growing.RULE, slack_growing.growing_slack(100.0, (5.0, -5.0), (0.01, -0.02), 0.05).p)


def spring(law, **factors):
    return LawSpring(1, "X", "", ((1, 0),), (1.0,), law, 100.0, **factors)


def test_secant_dashpot_along_a_hand_worked_path():
    """k = 100, yield at 0.05, then slope 10: force 6 at 0.15, 7 at 0.25."""
    s = spring(SecantLaw(*BILINEAR), secant=0.02)
    state, here = s.law.start(), 0.0
    for d, c in (
        (0.04, 2.0),  # elastic
        (0.15, 2.0),  # yielding: the stiffness is that of the last turn until it turns
        (0.14, 0.02 * 6.0 / 0.15),  # turned at 0.15
        (-0.1, 0.02 * 6.0 / 0.15),  # yields the other way
        (-0.09, 0.02 * 6.0 / 0.15),  # a turn nearer than 0.15 changes nothing
        (0.25, 0.02 * 6.0 / 0.15),
        (0.24, 0.02 * 7.0 / 0.25),
    ):
        state, here = drive(s.law, state, here, d), d
        assert s.branch(state).damping == pytest.approx(c, rel=1e-14)
    assert spring(s.law, secant=0.02, beta=0.01).branch(state).damping == pytest.approx(1.0 + 0.56)
    # the force that is told is the rule's: 7 at 0.25, less 100 times 0.01
    assert s.force(state, 0.24, 3.0) == pytest.approx(6.0, rel=1e-14)


@pytest.mark.parametrize("own", [BILINEAR, SLACK], ids=["bilinear", "slack"])
@given(path=st.lists(st.floats(-0.4, 0.4), min_size=1, max_size=15))
def test_the_rule_itself_is_unchanged(own, path):
    law, plain = SecantLaw(*own), Law(*own)
    state, same, here = law.start(), plain.start(), 0.0
    for d in path:
        state, same, here = drive(law, state, here, d), drive(plain, same, here, d), d
        assert law.branch(state) == plain.branch(same) and state[3][:-2] == same[3]
        assert law.stored(state, d) == plain.stored(same, d) and law.work(state, d) == plain.work(same, d)
        assert 0.0 <= state[3][-1] <= 100.0 * (1 + 1e-12)


def bend(k, d):
    return k * np.tanh(d)


CURVED = Rule(
    BranchKind.ELASTIC.named("loading", "unloading"),
    lambda p: (0, (0.0, 0.0)),
    lambda p, at, m: linear(p[0], 0.0, REVERSAL_DOWN if at == 0 else REVERSAL_UP),
    lambda p, at, m, way, d, v: (1 - at, (d, bend(p[0], d))),
    curve=lambda p, at, m, d0, d, v: (bend(p[0], d), p[0] / np.cosh(d) ** 2, 0.0, 0.0),
    parameters=1,
    variables=2,
)


def test_a_curved_law_has_a_secant_too():
    s = spring(SecantLaw(CURVED, (3.0,)), secant=0.5)
    state = s.law.start()
    assert s.branch(state).damping == 1.5
    assert s.branch(s.law.transition(state, 0, 0.7)).damping == pytest.approx(
        0.5 * bend(3, 0.7) / 0.7, rel=1e-14
    )


# ---------------------------------------------------------------- the numbers of the manual

ROOT = Path(__file__).parents[2]
PORTAL = """
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 5 3
 4 5 0 FIX=XYR
ELEMENTS
 1 C 1 2
 2 B 2 3
 3 C 4 3
PROPS
 C FRAME E=2E8 A=0.02 I=2E-4 RULE=BILINEAR R=0.02 MI=80 MJ=80 KH=4E5
 B FRAME E=2E8 A=0.02 I=4E-4
WEIGHTS
 2,3 200
DAMPING
 {card}
EQUAKE
 SINE AMPLITUDE=4 OMEGA=9
OUTPUT
 EVERY=0.01
ANALYSIS
 HISTORY 2 METHOD=EXACT
"""
#: the same hinges as springs between nodes
SPRINGS = (
    PORTAL.replace(" 2 0 3\n", " 2 0 3\n 11 0 0 FIX=XY\n 12 0 3 SLAVED=XY MASTER=2\n")
    .replace(" 4 5 0 FIX=XYR\n", " 4 5 0 FIX=XYR\n 13 5 3 SLAVED=XY MASTER=3\n 14 5 0 FIX=XY\n")
    .replace(" 1 C 1 2\n", " 1 C 11 12\n 11 H 11\n 12 H 12 2\n")
    .replace(" 3 C 4 3\n", " 3 C 14 13\n 13 H 13 3\n 14 H 14\n")
    .replace(" RULE=BILINEAR R=0.02 MI=80 MJ=80 KH=4E5", "\n H SPRING KR=4E5 MR=80 RULE=BILINEAR R=0.02")
)
RAYLEIGH = "RAYLEIGH XI=0.05 MODES=1,2 STIFFNESS="


def manual_table(name):
    text = (ROOT / "manual" / "theory-damping.md").read_text("utf-8")
    body = text.split(f"<!-- table: {name} -->")[1].split("<!-- end -->")[0].strip().splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in body]


@pytest.mark.slow
def test_portal_with_hinges_of_the_manual():
    """Hinges have no mass; the dashpot beside a yielding spring is what the manual warns of."""
    decks = [
        SPRINGS.format(card=RAYLEIGH + "INITIAL"),
        *(PORTAL.format(card=RAYLEIGH + x) for x in ("INITIAL", *FOLLOW, "ELASTIC")),
        PORTAL.format(card="MODAL XI=0.05"),
    ]
    for (_, *row), deck in zip(manual_table("hinges"), decks, strict=True):
        ran = run_text(deck)
        assert ran.check() < 1e-11
        sway = 1000 * np.abs(ran.u[:, ran.nodes.index(2), 0]).max()
        assert row == [f"{x:.1f}" for x in (sway, energy(ran)["damping"], energy(ran)["hysteretic"])]


@pytest.mark.slow
def test_diaphragms_of_the_manual():
    text = (ROOT / "examples" / "cole2011" / "distributed.inp").read_text("utf-8")
    head, tail = text[: text.index("   RAYLEIGH")], text[text.index("DRIFT\n") :]

    def both(card):
        """The card for each building: `{b}` its number, and all its nodes."""
        nodes = "1000 TO 1000+n,2000 TO 2000+n", "3000 TO 3000+n,4000 TO 4000+n"
        return "".join(f" {card.format(b=b + 1)} NODES={n}\n" for b, n in enumerate(nodes)) + "\n"

    rayleigh = "RAYLEIGH XI=xi OMEGA=lo*s{b},hi*s{b} PROPS=COL{b}"
    cards = [
        rayleigh,
        rayleigh + " STIFFNESS=TANGENT",
        rayleigh + ",SLAB{b}",
        "MODAL XI=xi",
        "MODAL XI=xi,0 OMEGA=hi*s{b}*1.05,hi*s{b}*1.3",
    ]
    for (_, *row), card in zip(manual_table("diaphragms"), cards, strict=True):
        ran = run_text(head + both(card) + tail)
        drifts = [np.abs(ran.column("drift_envelope", x)).max() for x in ("max", "min")]
        peaks = [f"{x:.0f}" for x in ran.column("contact_summary", "peak_force")]
        assert row == [f"{abs(ran.column('modes', 'damping')[4]):.2f}", *peaks, f"{1000 * max(drifts):.2f}"]


LOADED = """
NODES
 1 0 0 FIX=XYR
 2 1 0 FIX=YR
ELEMENTS
 1 S 1 2
PROPS
 S SPRING KX=4 FX=1 RULE=BILINEAR R=0.25
GRAVITY 1
WEIGHTS
 2 1
LOADS
 2 2
DAMPING
 {card} AFTER={after}
ANALYSIS
 MODAL 1 AFTER=STATIC
"""


@pytest.mark.parametrize(
    ("card", "after", "c"),
    [
        ("MODAL XI=0.05", "REST", 2 * 0.05 * 2.0),
        ("MODAL XI=0.05", "STATIC", 2 * 0.05 * 1.0),  # yielded: stiffness 1 of 4
        ("CAUGHEY XI=0.05 MODES=1", "STATIC", 2 * 0.05 * 1.0),
        ("RAYLEIGH XI=0.05 MODES=1,1", "REST", 0.05 * 2.0 + 0.05 / 2.0 * 4.0),
        ("RAYLEIGH XI=0.05 MODES=1,1", "STATIC", 0.05 * 1.0 + 0.05 / 1.0 * 4.0),  # of the initial stiffness
    ],
)
def test_damping_on_modes_of_the_loaded_structure(tmp_path, card, after, c):
    deck = tmp_path / "loaded.inp"
    deck.write_text(LOADED.format(card=card, after=after))
    structure = prepare(Request(str(deck))).structure
    assert structure.damping[0, 0] == pytest.approx(c, rel=1e-12)
    assert len(structure.damping_texts) == 1


def test_the_secant_dashpots_of_the_loaded_structure_are_part_of_the_initial_damping(tmp_path):
    deck = tmp_path / "loaded.inp"
    deck.write_text(LOADED.format(card="RAYLEIGH XI=0.05 MODES=1,1 STIFFNESS=SECANT", after="STATIC"))
    structure = prepare(Request(str(deck))).structure
    assert structure.damping[0, 0] == pytest.approx(0.05) and structure.laws[0].secant == pytest.approx(
        0.05
    )
    assert structure.initial_damping[0, 0] == pytest.approx(0.05 + 0.05 * 4.0)


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("RAYLEIGH ALPHA=1", "whose MODES"),
        ("MODAL XI=0.05,0.04,0.03 OMEGA=1,2", "3 values for 2 frequencies"),
    ],
)
def test_mistakes_of_damping_on_loaded_modes_are_told_before_the_run(tmp_path, card, words):
    deck = tmp_path / "loaded.inp"
    deck.write_text(LOADED.format(card=card, after="STATIC"))
    with pytest.raises(DeckError, match=words):
        prepare(Request(str(deck)))


def test_a_static_state_that_does_not_exist_is_left_to_the_analysis(tmp_path):
    deck = tmp_path / "loaded.inp"
    deck.write_text(LOADED.format(card="MODAL XI=0.05", after="STATIC").replace("R=0.25", "R=0"))
    assert prepare(Request(str(deck))).structure.damping[0, 0] == 0.0
