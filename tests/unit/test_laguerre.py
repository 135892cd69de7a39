"""LAGUERRE: its polynomials and stability, closed forms, TAYLOR's answers within TOL, stiff structures."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pound_solve.catalog import catalog
from pound_solve.integrate.series import march, single_pole, state
from pound_solve.numerics.record import record
from pound_solve.numerics.types import Array
from samples import written
from tiers import at_night, each_once
from unit.test_taylor import (
    BILINEAR,
    CONTACTS,
    HINGE,
    LOADS,
    OSCILLATOR,
    OTHERS,
    RULES,
    SHAKEN,
    frames,
    free,
    further_contacts,
    item,
    storeys,
)
from unit.test_taylor_massless import HELD, ZENER, hinged, of_first_order
from unit.test_taylor_modal import LIGHT
from verification.cases import Ran, run_text

LAST, GAMMA = single_pole.LAST_TERM, single_pole.pole(single_pole.LAST_TERM, single_pole.ROOT)


def by(text: str, tol: float, **params: object) -> Ran:
    """Run a deck by LAGUERRE."""
    head, _, last = text.rpartition("HISTORY ")
    end, _, rest = last.partition("\n")
    r = run_text(f"{head}HISTORY {end} METHOD=LAGUERRE TOL={tol}\n{rest}", params)
    assert r.status == "done", r.message
    return r


# ---------------------------------------------------------------- the polynomials


def transfer(z: Array) -> Array:
    """What a step makes of y' = lambda y, z = lambda h."""
    w = -GAMMA * z / (1.0 - GAMMA * z)
    at_end = single_pole.basis(LAST, GAMMA).sum(axis=1)
    return np.asarray(sum(c * w**n for n, c in enumerate(at_end)))


def test_the_pole_is_a_root() -> None:
    """At the end of a step the polynomial of the last term is zero; gamma to eight digits as tabulated."""
    laguerre = np.polynomial.laguerre.lagval(1.0 / GAMMA, np.eye(LAST + 1)[LAST])
    assert abs(laguerre) < 1e-12
    assert pytest.approx(0.33414237, abs=1e-8) == GAMMA


def test_powers_and_polynomials_are_inverse_to_each_other() -> None:
    both = single_pole.basis(LAST, GAMMA), single_pole.monomials(LAST, GAMMA)
    assert np.abs(both[0] @ both[1] - np.eye(LAST + 1)).max() < 1e-11
    assert np.abs(both[1] @ both[0] - np.eye(LAST + 1)).max() < 1e-11


def test_steps_are_stable_for_all_oscillations_and_damp_what_is_stiff() -> None:
    """A-stability (along the imaginary axis, and no pole to the left of it), and zero at infinity."""
    assert np.abs(transfer(1j * np.geomspace(1e-3, 1e8, 20_000))).max() <= 1.0 + 1e-12
    assert np.abs(transfer(-np.geomspace(1e-3, 1e8, 1000))).max() <= 1.0
    assert abs(transfer(np.array([-1e9]))[0]) < 1e-7


def test_steps_are_of_the_order_of_their_terms() -> None:
    z = np.array([0.2, 0.1]) * (0.6 + 0.8j)
    off = np.abs(transfer(z) - np.exp(z))
    assert math.log2(off[0] / off[1]) == pytest.approx(LAST + 1, abs=0.3)


# ---------------------------------------------------------------- closed forms


@pytest.mark.parametrize("tol", [1e-4, 1e-7, 1e-10])
@pytest.mark.parametrize("xi", [0.0, 0.05, 1.0, 10.0])
def test_free_vibration(xi: float, tol: float) -> None:
    deck = OSCILLATOR if xi else OSCILLATOR.replace("DAMPING\n RAYLEIGH XI=xi OMEGA=w,3*w PROPS=K\n", "")
    r = by(deck, tol, xi=xi, every=3.0, w=20)
    assert np.abs(r.u[:, 1, 0] - free(r.time, 20.0, xi, -1.0, 2.0)).max() < 20 * tol
    assert r.check() < 20 * tol


@pytest.mark.parametrize("c", [0.02, 1.5, 400.0])
def test_a_spring_in_series_with_a_dashpot(c: float) -> None:
    """The node between them has no mass: u'' = -9 u - 7 (u - z), c z' = 7 (u - z)."""
    r = by(ZENER.format(c=c), 1e-9)
    a = np.array([[0, 1, 0], [-16, 0, 7], [7 / c, 0, -7 / c]])
    exact = of_first_order(a, np.array([1.0, 0.5, 0.0]), r.time)
    assert np.abs(r.u[:, r.nodes.index(2), 0] - exact[0]).max() < 1e-8
    assert np.abs(r.u[:, r.nodes.index(3), 0] - exact[2]).max() < 1e-8


# ---------------------------------------------------------------- TAYLOR's answers

TOLS = (1e-4, 1e-7)
MOST = 15.0  #: times TOL, that displacements, drifts, deformations and contact forces are off at most


def off(a: Array, b: Array) -> float:
    """Largest difference as a share of the largest value."""
    return float(np.abs(a - b).max(initial=0.0) / max(np.abs(b).max(initial=0.0), 1e-300))


def agree(text: str, **params: object) -> Ran:
    """Compare runs with two tolerances with that of TAYLOR; return the last."""
    e = run_text(text, params, "TAYLOR")
    assert e.status == "done", e.message
    for tol in TOLS:
        r = by(text, tol, **params)
        assert off(r.u, e.u) < MOST * tol
        if "contact_summary" in e.tables:
            one, other = (x.tables["contact_summary"] for x in (r, e))
            assert np.array_equal(one["closures"], other["closures"])
            assert off(one["peak_force"], other["peak_force"]) < MOST * tol
        if "drift_envelope" in e.tables:
            for side in ("max", "min"):
                assert off(*(x.column("drift_envelope", side) for x in (r, e))) < MOST * tol
        for side in ("deformation_max", "deformation_min"):
            if "spring_envelope" in e.tables:
                assert off(*(x.column("spring_envelope", side) for x in (r, e))) < MOST * tol
        assert r.check() < MOST * tol
    assert abs(int(item(r, "events")) - int(item(e, "events"))) <= 3  # events at one instant
    return r


@pytest.mark.parametrize(
    "rule", ["TAKEDA", "FLAG_SHAPED", *at_night(*(x for x in OTHERS if x not in ("TAKEDA", "FLAG_SHAPED")))]
)
def test_rules_that_are_linear_in_pieces(rule: str) -> None:
    given = RULES[rule] if rule in RULES else written(catalog().family("hysteresis")[rule], 60.0, 0.015)
    agree(storeys(f"{'' if rule == 'ELASTIC' else 'FX=60 '}RULE={rule} {given}"))


@pytest.mark.parametrize("law", [*CONTACTS, *further_contacts()])
def test_contacts_that_are_linear_in_pieces(law: str) -> None:
    given = (CONTACTS | further_contacts())[law]
    agree(storeys(contact=f"LAW={law.split()[0]} {given}"))


@pytest.mark.parametrize("stiffness", ["TANGENT", "SECANT"])
def test_damping_that_follows_the_stiffness(stiffness: str) -> None:
    agree(storeys(BILINEAR, damping=f"STIFFNESS={stiffness}"))


@each_once(("load", LOADS), ("turn", ["0", "0.5"]), at_most=2)
def test_what_moves_hinges(load: str, turn: str) -> None:
    agree(hinged("RAYLEIGH ALPHA=0.4 BETA=0.001", turn, load=load))


@each_once(("damping", HELD), ("turn", ["0", "0.5"]), at_most=2)
def test_hinges_of_a_frame(damping: str, turn: str) -> None:
    agree(hinged(damping, turn))


@pytest.mark.parametrize("head", ["GEOMETRY PDELTA", "GEOMETRY PDELTA_MEMBER", "MASS CONSISTENT"])
def test_geometry_and_mass_of_a_frame(head: str) -> None:
    deck = frames(head=head, load=SHAKEN, hinge=HINGE)
    if head.startswith("MASS"):
        deck = deck.replace("I=0.0007", "I=0.0007 WGT=3").replace("I=0.0005", "I=0.0005 WGT=5")
    agree(deck)


#: a column that is touched at the joint of its two halves, where its mass is small, by its neighbour
TOUCHING = """UNITS kN m s
NODES
 1 0 0 FIX=XYR
 2 0 2
 3 0 4
 4 0 0 FIX=XYR
 5 0 2 FIX=YR
ELEMENTS
 1 COL 1 2
 2 COL 2 3
 3 COL 4 5
 4 MEET 2 5
PROPS
 COL FRAME E=2E7 A=0.1 I=0.002
 MEET CONTACT GAP=0 ANGLE=0 LAW={law}
WEIGHTS
 2 2
 3 150
 5 65
EQUAKE
 TABLE POINTS={points}
OUTPUT
 EVERY=0.02
ANALYSIS
 HISTORY 0.2
"""


@pytest.mark.parametrize("points", ["0,0,0.07,-3,0.2,3", "0,0,0.03,0,0.1,-3,0.2,3"])
@pytest.mark.parametrize("law", ["KELVIN_VOIGT K=1E6 E=0.6", "LINEAR K=1E5"])
def test_buildings_that_touch_at_rest(law: str, points: str) -> None:
    """The first powers of the motion that are not zero are below the error of a usual polynomial."""
    agree(TOUCHING.format(law=law, points=points))


def test_a_step_is_none_where_the_clock_does_not_show_it() -> None:
    """At 0, too, where each step shows, however short."""
    lengths = record(state.StepControl)
    for t in (0.0, 0.5):
        for length, shows in ((1e-3, True), (1e-17, False), (1e-300, False)):
            lengths.next_length = length
            assert (march.step_length(lengths, t, 1.0) > 0.0) == shows


@pytest.mark.parametrize("fit", [math.nan, 0.0, 0.5, 0.999, 1.0 - 1e-12])
def test_a_step_that_did_not_fit_is_tried_shorter(fit: float) -> None:
    """By so much that equal parts of what is left are not as long as before."""
    lengths = record(state.StepControl)
    for parts in (1, 2, 1000):
        h = 1.0 / parts
        march.shorten_step(lengths, h, fit)
        assert march.step_length(lengths, 0.0, 1.0) < h


# ---------------------------------------------------------------- stiff structures


@pytest.mark.parametrize("c", [1e-9, 1.0, 1e6])
def test_a_fast_mode_that_hardly_moves_costs_few_steps(c: float) -> None:
    """Of 1e6 to 1e8 rad/s, hardly damped to overdamped; TAYLOR would take two million steps and more."""
    steps = []
    for k in (1e6, 1e8, 1e10):
        r = by(LIGHT, 1e-8, k=k, c=c)
        w = math.sqrt(25.0 / (1.0 + 1e-6))
        assert np.abs(r.u[:, r.nodes.index(2), 0] - np.cos(w * r.time)).max() < 1e-6
        steps.append(int(item(r, "steps")))
    assert max(steps) < 2000  # the ring of the start, of 1e-16 of the energy, is followed until it is over


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (storeys(contact="LAW=HERTZ K=1e6"), "LAGUERRE needs linear pieces, and the law HERTZ"),
        (storeys(contact="LAW=STEREOMECHANICS E=0.5"), "LAGUERRE knows no rigid contact"),
        (frames(head="GEOMETRY LARGE"), "LAGUERRE needs linear pieces, and members change their stiffness"),
    ],
)
def test_what_it_does_not_take_is_told(text: str, why: str) -> None:
    r = run_text(text, None, "LAGUERRE")
    assert r.status != "done" and "A505" in r.message and why in r.message
