"""The reduced system: what is left out, why, and that nothing is lost by it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from decks import scene_of
from pound_solve.structure.reduction_checks import ReductionError

TAIL = """
EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.7 {more}
ANALYSIS
 HISTORY 1
"""


def tail(more=""):
    return TAIL.format(more=more)


def decided(place):
    return {d.decision: d for d in place.decisions}


def response(m, c, k, f, omega):
    return np.linalg.solve(k + 1j * omega * c - omega**2 * m, f)


def same_response(place, omegas=(0.3, 2.0, 9.0, 40.0), rel=1e-9):
    """Harmonic response of the reduced system, spread over all DOFs, is that of the structure as assembled.

    Harmonic motion exp(i w t) of every input; in the total form displacement,
    velocity and acceleration of one motion are tied by i w.
    """
    s, n = place.structure, place.structure.n_free
    moved = len(s.dofs.moved)
    whole = np.any((s.stiffness[:n] != 0) | (s.damping[:n] != 0) | (s.mass[:n] != 0), axis=1)
    for w in omegas:
        if place.total:
            x = np.concatenate(
                [np.array([1, 1j * w, -(w**2)]) * amplitude for amplitude in (1.0, -0.4)][
                    : len(place.motions)
                ]
            )
            at = place.support_inputs @ x
            dynamic = s.stiffness + 1j * w * s.damping - w**2 * s.mass
            f = -dynamic[:n, n:] @ at
        else:
            x = np.array([1.0, -0.4][: len(place.motions)], complex)
            f = -s.ground[:, :n].T @ (place.acceleration_inputs @ x)
        full = np.zeros(n, complex)
        on = np.ix_(whole, whole)
        full[whole] = response(
            s.mass[:n, :n][on], s.damping[:n, :n][on], s.stiffness[:n, :n][on], f[whole], w
        )
        small = response(place.mass, place.damping, place.stiffness, place.inputs @ x, w)
        got = place.expand @ small + place.expand_inputs @ x
        assert np.abs(got - full).max() <= rel * np.abs(full).max()
    assert moved == len(place.support_inputs)


SHEAR = """
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 0 6
ELEMENTS
 1 TO 2 S 1 TO 2 2 TO 3
PROPS
 S SPRING KX=400 KY=9000 KR=70
WEIGHTS
 2,3 10 10 4
"""


def test_what_the_ground_does_not_reach_is_dropped():
    """Springs couple nothing: a ground motion along x leaves uy and rz at rest."""
    place = scene_of(SHEAR + tail())
    assert place.dofs == ((2, 0), (3, 0)) and place.size == 2
    found = decided(place)["dropped"]
    assert found.subject == "4 of 6 degrees of freedom"
    assert found.why == "nothing sets them in motion: 2 uy, 2 rz, 3 uy, 3 rz"
    same_response(place)


@pytest.mark.parametrize(
    ("more", "kept"),
    [
        (tail("DIRECTION=Y"), ((2, 1), (3, 1))),
        ("LOADS\n 3 0 -1\n" + tail(), ((2, 0), (2, 1), (3, 0), (3, 1))),
        ("INITIAL\n 3 VR=0.1\n" + tail(), ((2, 0), (2, 2), (3, 0), (3, 2))),
        ("INITIAL\n 2 UY=0.1\n" + tail(), ((2, 0), (2, 1), (3, 0), (3, 1))),
    ],
)
def test_what_is_loaded_or_starts_in_motion_stays(more, kept):
    assert scene_of(SHEAR + more).dofs == kept


def test_long_lists_are_cut_short():
    deck = SHEAR.replace("3 0 6", "3 TO 12 0 6 TO 33").replace(
        "1 TO 2 S 1 TO 2 2 TO 3", "1 TO 11 S 1 TO 11 2 TO 12"
    )
    assert decided(scene_of(deck + tail()))["dropped"].why.endswith(
        "2 uy, 2 rz, 3 uy, 3 rz, 4 uy, 4 rz, and 16 more"
    )


def test_contacts_and_dashpots_join_what_they_touch():
    """A node that only a contact, or a dashpot, links to a shaken one is awake;
    the gap's size is no matter.
    """
    far = """
NODES
 1 0 0 FIX=XYR
 2 0 3 FIX=YR
 3 1 3 FIX=YR
ELEMENTS
 1 S 1 2
 9 C 2 3
PROPS
 S SPRING KX=400
 C {}
WEIGHTS
 2 10
"""
    supports = tail("SUPPORTS=1")
    # only support 1 moves: node 3 has no weight on it and no spring of its own
    for c in ("CONTACT GAP=5 LAW=LINEAR K=9", "DASHPOT CX=3"):
        assert (3, 0) in scene_of(far.format(c) + supports).dofs
    assert (3, 0) not in scene_of(far.format("SPRING KY=2") + supports).dofs


@pytest.mark.parametrize("law", ["LINEAR K=9", "HERTZ K=9", "TABLE DEPTHS=1 FORCES=9"])
def test_an_overlap_sets_in_motion(law):
    deck = """
NODES
 1 0 0 FIX=R
 2 0 3 FIX=R
ELEMENTS
 1 S 1
 2 S 2
 9 C 1 2
PROPS
 S SPRING KX=400 KY=400
 C CONTACT GAP={} LAW={}
WEIGHTS
 1,2 10
"""
    assert (1, 1) not in scene_of(deck.format(0.1, law) + tail()).dofs
    assert (1, 1) in scene_of(deck.format(-0.1, law) + tail()).dofs


PORTAL = """
NODES
 1 0 0 FIX=XYR
 2 0 3
 3 5 3.2
 4 5 0 FIX=XY
 5 2.5 3.1
ELEMENTS
 1 C 1 2
 2 TO 3 B 2,5 5,3
 4 C 4 3
PROPS
 C FRAME E=2e8 A=0.01 I=1e-4 {weight}
 B FRAME E=2e8 A=0.01 I=2e-4
 D DASHPOT CR=30 CX=5
WEIGHTS
 2,3 500
LOADS
 5 0 -30 4
"""
PORTAL = PORTAL.replace(" 2 TO 3 B 2,5 5,3", " 2 B 2 5\n 3 B 5 3")


@pytest.mark.parametrize(
    ("damping", "kept", "condensed"),
    [
        ("", 4, 6),
        ("DAMPING\n RAYLEIGH ALPHA=0.3 BETA=0.004", 4, 6),
        ("DAMPING\n MODAL XI=0.05", 4, 6),
        # members of different beta meet at nodes 2 and 3 and their rotations follow no more;
        # node 5 between beams does, and so does the hinged foot 4
        ("DAMPING\n RAYLEIGH BETA=0.004 PROPS=C\n RAYLEIGH BETA=0.01 PROPS=B", None, 4),
    ],
)
def test_massless_dofs_are_condensed_without_error(damping, kept, condensed):
    place = scene_of(PORTAL.format(weight="") + damping + tail())
    if kept is not None:
        assert place.dofs == ((2, 0), (2, 1), (3, 0), (3, 1))
    assert decided(place)["condensed"].subject.startswith(f"{condensed} massless")
    same_response(place)
    # under the loads the expanded static state is the whole structure's
    small = np.linalg.solve(place.stiffness, place.constant)
    n = place.structure.n_free
    full = np.linalg.solve(place.structure.stiffness[:n, :n], place.structure.loads[:n])
    assert place.expand @ small + place.expand_constant == pytest.approx(full, rel=1e-9, abs=1e-12)


def test_natural_frequencies_of_the_scene_are_the_structures():
    place = scene_of(PORTAL.format(weight="WGT=2") + tail())
    w2 = np.sort(np.linalg.eigvals(np.linalg.solve(place.mass, place.stiffness)).real)
    assert np.sqrt(w2) == pytest.approx(place.structure.free_vibration.omega, rel=1e-9)


def test_massless_dofs_on_dashpots_are_kept_and_named():
    deck = PORTAL.format(weight="").replace(" 4 C 4 3", " 4 C 4 3\n 5 D 5") + tail()
    place = scene_of(deck)
    assert {(5, 0), (5, 2)} <= set(place.dofs)
    assert (5, 1) not in place.dofs and (2, 2) not in place.dofs
    assert decided(place)["kept"].why == "dashpots move them: 5 ux, 5 rz"
    same_response(place)


def test_massless_dofs_on_laws_are_kept():
    deck = (
        PORTAL.format(weight="")
        .replace(" 4 C 4 3", " 4 C 4 3\n 5 H 5 3")
        .replace(" D DASHPOT CR=30 CX=5", " H SPRING KX=5 KR=40 FX=1 MR=3 RULE=ELASTO_PLASTIC")
    )
    kept = set(scene_of(deck + tail()).dofs)
    assert {(5, 0), (5, 2), (3, 2)} <= kept and (5, 1) not in kept and (2, 2) not in kept


@pytest.mark.parametrize(
    "damping", ["", "DAMPING\n RAYLEIGH ALPHA=0.3 BETA=0.004", "DAMPING\n MODAL XI=0.05"]
)
def test_moved_supports(damping):
    """Two supports on motions of their own, massless DOFs condensed onto them too."""
    more = f"""
{damping}
EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.7 SUPPORTS=1
 SINE AMPLITUDE=1 PERIOD=0.9 SUPPORTS=4
ANALYSIS
 HISTORY 1
"""
    place = scene_of(PORTAL.format(weight="WGT=3") + more)
    assert place.total and place.structure.dofs.moved == ((1, 0), (4, 0))
    assert not place.acceleration_inputs.any()
    same_response(place)
    # both supports held apart for ever: the quasi-static shape
    x = np.array([0.3, 0, 0, -0.2, 0, 0])
    n, s = place.structure.n_free, place.structure
    wanted = np.linalg.solve(s.stiffness[:n, :n], -s.stiffness[:n, n:] @ [0.3, -0.2])
    got = place.expand @ np.linalg.solve(place.stiffness, place.inputs @ x) + place.expand_inputs @ x
    assert got == pytest.approx(wanted, rel=1e-9, abs=1e-13)


def test_a_massless_node_between_moved_supports_keeps_its_dashpots():
    """Springs and dashpots of different ratio to two moved supports and
    to nothing else: no static follower.
    """
    deck = """
NODES
 1 0 0 FIX=XYR
 2 9 0 FIX=XYR
 3 5 0 FIX=YR
 4 5 1 FIX=YR
ELEMENTS
 1 A 1 3
 2 B 3 2
 3 A 1 4
PROPS
 A SPRING KX=100
 B SPRING KX=300
WEIGHTS
 4 10
DAMPING
 RAYLEIGH BETA=0.1 PROPS=A
 RAYLEIGH BETA=0.01 PROPS=B
EQUAKE
 SINE AMPLITUDE=2 PERIOD=0.7 SUPPORTS=1
 SINE AMPLITUDE=1 PERIOD=0.9 SUPPORTS=2
ANALYSIS
 HISTORY 1
"""
    place = scene_of(deck)
    assert (3, 0) in place.dofs
    same_response(place)


@settings(max_examples=25)
@given(st.data())
def test_random_frames_lose_nothing(data):
    """A pile of storeys with random damping groups and dashpots: harmonic response as assembled."""
    storeys = data.draw(st.integers(1, 3))
    rate = st.sampled_from([0.0, 0.003, 0.01])
    legs, beams = data.draw(rate), data.draw(rate)
    damping = f"DAMPING\n RAYLEIGH ALPHA=0.2 BETA={legs} PROPS=C\n RAYLEIGH BETA={beams} PROPS=B\n"
    nodes, elements, e = [" 1 0 0 FIX=XYR", " 2 5 0 FIX=XY"], [], 0
    for i in range(1, storeys + 1):
        nodes += [f" {2 * i + 1} 0 {3 * i}", f" {2 * i + 2} 5 {3 * i}"]
        for prop, a, b in (
            ("C", 2 * i - 1, 2 * i + 1),
            ("C", 2 * i, 2 * i + 2),
            ("B", 2 * i + 1, 2 * i + 2),
        ):
            e += 1
            elements.append(f" {e} {prop} {a} {b}")
    if data.draw(st.booleans()):
        elements.append(f" {e + 1} D {data.draw(st.integers(3, 2 * storeys + 2))}")
    place = scene_of(
        "NODES\n"
        + "\n".join(nodes)
        + "\nELEMENTS\n"
        + "\n".join(elements)
        + f"""
PROPS
 C FRAME E=2e7 A=0.05 I=1e-3 PIN={data.draw(st.sampled_from(["NONE", "I", "J"]))}
 B FRAME E=2e7 A=0.05 I=2e-3
 D DASHPOT CX=5 CY=4 CR={data.draw(st.sampled_from([0, 3]))}
WEIGHTS
 3 TO {2 * storeys + 2} 100
{damping}
"""
        + tail()
    )
    same_response(place, rel=1e-8)


def test_inputs_of_two_directions():
    place = scene_of(
        PORTAL.format(weight="")
        + tail().replace("ANALYSIS", " SINE AMPLITUDE=1 PERIOD=0.3 DIRECTION=Y\nANALYSIS")
    )
    assert place.acceleration_inputs.tolist() == [[1, 0], [0, 1], [0, 0]]
    same_response(place)


def test_excitation_is_the_motion():
    place = scene_of(SHEAR + tail("START=0.2"))
    x, motion = place.excitation, place.motions[0]
    for t in (0.0, 0.1, 0.2, 0.35, 0.77, 1.0):
        assert x.value(t)[0] == pytest.approx(float(motion.acceleration.value(t)), rel=1e-12, abs=1e-14)
        local = x.local(x.piece(t), t)
        assert local[0] == pytest.approx(x.value(t)) and local[1] == pytest.approx(x.value(t, 1))
    assert x.value(0.5)[0] == pytest.approx(2 * np.sin(2 * np.pi * 0.3 / 0.7), rel=1e-9)
    assert not x.value(0.5, x.degree + 1).any()


def test_mass_on_an_arm_needs_rotational_inertia_at_its_master():
    """Without it one joint motion of ux and rz has no inertia: a frequency of rounding,
    that none can follow.
    """
    deck = """
NODES
 1 0 3 FIX=Y
 2 0 4.5 SLAVED=XYR MASTER=1
ELEMENTS
 1 S 1
PROPS
 S SPRING KX=300 KR=800
WEIGHTS
 2 2 {}
"""
    with pytest.raises(ReductionError, match="node 1 rz has no inertia of its own"):
        scene_of(deck.format("") + tail())
    place = scene_of(deck.format("2 0.01") + tail())
    assert place.size == 2
    same_response(place)
