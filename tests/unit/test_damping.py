"""Damping: ratios asked are ratios given; groups add up; matrices are symmetric and dissipate."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import structure_of
from pound_solve.analyses import modal
from pound_solve.assemble import AssemblyError

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
    assert [r[4] for r in modal.rows(s, 3)] == pytest.approx(100 * ratio[:3], rel=1e-12)


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
    at = {f: i for i, f in enumerate(s.freedoms.free)}
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
)


@settings(max_examples=60, deadline=None)
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
        rigid = np.array([1.0 if f[1] == d else 0.0 for f in (*s.freedoms.free, *s.freedoms.moved)])
        assert np.abs(s.damping @ rigid).max() < 1e-9 * np.abs(s.damping).max()
    # one support alone drags the structure along its quasi-static shape without damping forces
    follow = np.concatenate([s.influence()[:, 0], np.eye(4)[0]])
    assert np.abs(s.damping @ follow).max() < 1e-9 * np.abs(s.damping).max()
    assert np.linalg.eigvalsh(s.damping)[0] > -1e-9 * np.abs(s.damping).max()


@pytest.mark.parametrize(
    ("card", "words", "item"),
    [
        ("RAYLEIGH XI=0.05", "XI needs two", "XI"),
        ("RAYLEIGH XI=0.05 OMEGA=1,2 MODES=1,2", "XI needs two", "XI"),
        ("RAYLEIGH XI=0.05 ALPHA=1 OMEGA=1,2", "not both", "XI"),
        ("RAYLEIGH OMEGA=1,2", "go with XI", "OMEGA"),
        ("RAYLEIGH MODES=1,2 ALPHA=1", "go with XI", "MODES"),
        ("RAYLEIGH XI=0.05 MODES=1,99", "modes only", "MODES"),
    ],
)
def test_contradictions_are_diagnostics(card, words, item):
    with pytest.raises(AssemblyError) as caught:
        frame(" " + card)
    (found,) = caught.value.diagnostics
    assert found.code == "P332" and words in found.message
    line = len(FRAME.splitlines()) + 3
    assert found.span.line == line and found.span.column == 3 + card.index(item) + len(item)


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
