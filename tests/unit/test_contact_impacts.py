"""Every contact law in free impacts, integrated by scipy on the law's own force, and by the program."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from pound_solve.catalog import catalog
from pound_solve.laws.automaton import Law, State, consistent
from pound_solve.laws.contact import restitution
from pound_solve.laws.contact.kelvin_voigt import Built
from tiers import each_once
from verification.cases import run_text

pytestmark = pytest.mark.full

#: laws whose force gives back E at any speed (BILINEAR_IMPACT does at one speed, rigid ones have no force:
#: they have tests of their own)
LAWS = {
    name: spec
    for name, spec in catalog().family("contact").items()
    if spec.field("E") and spec.field("K") and not spec.field("DM")
}
FORMS: list[tuple[str, dict[str, Any]]] = [
    *((name, {}) for name in LAWS),
    ("KELVIN_VOIGT", {"TENSION": "YES"}),
    ("POWER_LAW_DAMPED", {"TENSION": "YES"}),
    ("POWER_LAW_DAMPED", {"N": 2.0}),
    ("JANKOWSKI", {"N": 2.5}),
    ("HUNT_CROSSLEY", {"N": 1.0}),
    ("HUNT_CROSSLEY", {"N": 3.0}),
    ("RUBBER_BUMPER", {"THICKNESS": 1.0, "KU": 3.0}),
]
IDS = ["-".join([name, *(f"{k}={v}" for k, v in items.items())]) for name, items in FORMS]
#: a dashpot makes the force jump at touch
JUMPS = {"KELVIN_VOIGT", "MAHMOUD_JANKOWSKI"}


def build(name: str, mass: float = 1.0, **items: Any) -> Built:
    spec = catalog().family("contact")[name]
    values = {f.name: f.default for f in spec.fields} | {"GAP": 0.0, "K": 1.0} | items
    return spec.impl(values, mass)  # type: ignore[no-any-return]


class Impact:
    """Two free masses run into each other; every branch of the law is one smooth piece."""

    def __init__(self, law: Law, gap: float, v0: float, masses: tuple[float, float] = (2.0, 2.0)) -> None:
        self.law, self.jumps = law, list[tuple[str, float]]()
        m1, m2 = masses
        state = law.transition(law.start(), 0, gap, v0)
        y = np.array([gap, 0.0, v0, 0.0, 0.0])  # u1, u2, v1, v2, work of the damping
        self.pieces: list[tuple[State, Any]] = []
        time = 0.0

        def rates(t: float, y: Any) -> list[float]:
            d, v = y[0] - y[1], y[2] - y[3]
            f, still = law.force(state, d, v)[0], law.force(state, d, 0.0)[0]
            return [y[2], y[3], -f / m1, f / m2, (f - still) * v]

        self.jumps.append((law.branch(state).name, law.force(state, gap, v0)[0]))
        for _ in range(10):
            if law.branch(state).name in ("open", "released"):
                break
            crossings = []
            for e in law.branch(state).events:

                def rise(t: float, y: Any, e: Any = e) -> float:
                    return e.on_d * (y[0] - y[1]) + e.on_v * (y[2] - y[3]) + e.constant

                rise.terminal, rise.direction = True, 1.0  # type: ignore[attr-defined]
                crossings.append(rise)
            run = solve_ivp(
                rates, (time, time + 1e12), y, "DOP853", events=crossings, rtol=1e-12, atol=1e-14 * v0,
                first_step=1e-12, dense_output=True,
            )  # fmt: skip
            way = next(i for i, found in enumerate(run.t_events) if len(found))
            time, y = float(run.t[-1]), run.y[:, -1]
            self.pieces.append((state, run))
            d, v = y[0] - y[1], y[2] - y[3]
            before = law.force(state, d, v)[0]
            state = law.transition(state, way, d, v)
            self.jumps.append((law.branch(state).name, law.force(state, d, v)[0] - before))
        self.state, self.time, self.y = state, time, y
        self.e = -(y[2] - y[3]) / v0

    def motion(self) -> tuple[Any, Any, Any]:
        """Overlap's deformation, rate and force on a fine grid of every piece."""
        out = []
        for state, run in self.pieces:
            t = np.linspace(run.t[0], run.t[-1], 4001)
            y = run.sol(t)
            d, v = y[0] - y[1], y[2] - y[3]
            out.append((d, v, np.array([self.law.force(state, *x)[0] for x in zip(d, v)])))
        d, v, f = (np.concatenate(x) for x in zip(*out))
        return d, v, f


@pytest.mark.parametrize(("name", "items"), FORMS, ids=IDS)
@settings(max_examples=3, phases=(Phase.explicit, Phase.generate))
@given(
    e=st.floats(0.05, 1.0),
    v0=st.floats(0.01, 10.0),
    masses=st.tuples(st.floats(0.1, 10.0), st.floats(0.1, 10.0)),
    gap=st.floats(-0.5, 0.5),
)
def test_a_free_impact_gives_back_what_was_asked(
    name: str, items: dict[str, Any], e: float, v0: float, masses: tuple[float, float], gap: float
) -> None:
    reduced = masses[0] * masses[1] / sum(masses)
    gap = max(gap, 0.0)
    built = build(name, reduced, E=e, GAP=gap, **items)
    assert built.e_asked == e
    assert built.e_given == pytest.approx(e, rel=1e-12)
    hit = Impact(built.law, gap, v0, masses)
    assert hit.e == pytest.approx(e, abs=1e-8)
    # momentum, and the energy that the damping and the release have taken once no overlap is left
    assert masses[0] * hit.y[2] + masses[1] * hit.y[3] == pytest.approx(masses[0] * v0, rel=1e-12)
    lost = hit.y[4] + built.law.dissipated(hit.state, gap)
    energy = 0.5 * reduced * v0 * v0
    assert lost == pytest.approx(energy * (1.0 - e * e), abs=1e-8 * energy)
    if name not in JUMPS and items.get("TENSION") != "YES":
        top = built.k * v0  # any force of the right size
        for branch, jump in hit.jumps:
            assert abs(jump) < 1e-6 * max(top, 1.0), branch


@pytest.mark.parametrize("e", [0.05, 0.3, 0.65, 0.95])
@pytest.mark.parametrize(("name", "items"), FORMS, ids=IDS)
def test_force_never_pulls_and_its_tangent_is_its_slope(name: str, items: dict[str, Any], e: float) -> None:
    law = build(name, E=e, **items).law
    hit = Impact(law, 0.0, 1.0)
    f = hit.motion()[2]
    pulls = items.get("TENSION") == "YES"
    assert (f.min() < -1e-3) if pulls and e < 0.9 else (f.min() >= -1e-12 * f.max() or pulls)
    for state, run in hit.pieces:
        for t in np.linspace(run.t[0], run.t[-1], 15)[1:-1]:
            y = run.sol(t)
            x, rate = y[0] - y[1], y[2] - y[3]
            h = 1e-6 * min(x, 0.1)
            if x <= 0.0 or abs(law.force(state, x, rate)[0]) < 1e-3 * law.force(state, x, 0.0)[0]:
                continue  # too near to where the force ends
            _, k, c = law.force(state, x, rate)
            slope = (law.force(state, x + h, rate)[0] - law.force(state, x - h, rate)[0]) / (2 * h)
            drag = (law.force(state, x, rate + 1e-6)[0] - law.force(state, x, rate - 1e-6)[0]) / 2e-6
            size = law.force(state, x, 0.0)[0] / x
            # the pull of a sticky release has a falling slope, which is not followed
            assert k == pytest.approx(max(slope, 0.0) if pulls else slope, abs=2e-6 * (size + abs(slope)))
            assert c == pytest.approx(drag, abs=1e-6 * (abs(c) + size))


@pytest.mark.parametrize("name", LAWS)
def test_open_there_is_no_force_and_in_a_trial_beyond_it_the_tangents_are_finite(name: str) -> None:
    law = build(name, E=0.3, GAP=0.1).law
    for d, v in ((0.2, 1.0), (0.05, -1.0), (-3.0, 2.0)):
        assert law.force(law.start(), d, v) == (0.0, 0.0, 0.0)
    touched = law.transition(law.start(), 0, 0.1, 1.0)
    for x in (0.0, 1e-300, 1e-17, 1e-9, -1e-12, -0.5):
        assert all(map(math.isfinite, law.force(touched, 0.1 + x, 1.0)))
        assert abs(law.force(touched, 0.1 + x, 1.0)[1]) < 1e7


# ---------------------------------------------------------------------- tables

ASKED = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.65, 0.7, 0.8, 0.9, 0.95)
PUBLISHED = {  # research/pounding-facts.md, table 2.2
    "MAHMOUD_JANKOWSKI": ".1025 .2055 .3070 .4071 .5061 .6046 .6538 .7030 .8014 .9004 .9501",
    "JANKOWSKI": ".0933 .1915 .2917 .3930 .4946 .5962 .6470 .6977 .7989 .8997 .9499",
    "HUNT_CROSSLEY": ".5158 .5469 .5813 .6197 .6630 .7120 .7390 .7680 .8329 .9090 .9524",
    "HERTZDAMP": ".6653 .6723 .6842 .7016 .7252 .7561 .7748 .7960 .8471 .9132 .9535",
    "YE_2009": ".0694 .1555 .2562 .3629 .4704 .5773 .6303 .6832 .7885 .8939 .9468",
    "GONTHIER": ".1010 .2046 .3042 .3978 .4877 .5773 .6229 .6696 .7680 .8764 .9359",
    "MODIFIED_KELVIN": ".0741 .1656 .2707 .3796 .4877 .5936 .6457 .6973 .7992 .8999 .9500",
    # the path of Kelvin-Voigt: its row
    "POWER_LAW_DAMPED": ".2527 .3249 .3971 .4720 .5503 .6323 .6748 .7182 .8081 .9020 .9505",
}
HUNT_CROSSLEY = "9.9982 4.9192 3.0871 2.0825 1.4328 .9749 .7931 .6348 .3731 .1665 .0789"
EXACT = {  # table 2.3
    "MAHMOUD_JANKOWSKI": "4.8069 2.2240 1.3360 .8790 .5973 .4047 .3293 .2639 .1558 .0700 .0333",
    "JANKOWSKI": "5.3743 2.4865 1.4937 .9828 .6678 .4525 .3682 .2950 .1742 .0783 .0373",
    **dict.fromkeys(
        ("HUNT_CROSSLEY", "HERTZDAMP", "YE_2009", "GONTHIER", "MODIFIED_KELVIN"), HUNT_CROSSLEY
    ),
}
DIGITS = 0.5001e-4


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_relations_give_the_table(name: str) -> None:
    for e, real in zip(ASKED, PUBLISHED[name].split(), strict=True):
        built = build(name, E=e, RELATION="PUBLISHED")
        assert abs(built.e_given - float(real)) < DIGITS, e
        assert Impact(built.law, 0.0, 1.0).e == pytest.approx(built.e_given, abs=1e-8)


@pytest.mark.parametrize("name", EXACT)
def test_exact_constants_are_those_of_the_table(name: str) -> None:
    for e, constant in zip(ASKED, EXACT[name].split(), strict=True):
        assert abs(build(name, E=e).xi - float(constant)) < DIGITS, e


def test_the_bumpers_published_relation_is_a_fit_to_the_exact_one() -> None:
    for e in ASKED[1:]:
        built = build("RUBBER_BUMPER", E=e, RELATION="PUBLISHED")
        assert built.e_given == pytest.approx(e, abs=0.016)


UNIT = {  # largest overlap and force, time of release: m = k = v0 = 1, e = 0.65
    "MAHMOUD_JANKOWSKI": (0.65, 0.82141, 2.8790),
    "JANKOWSKI": (0.77463, 0.82032, 3.18),
    "HUNT_CROSSLEY": (0.92875, 1.03320, 3.4173),
    "MODIFIED_KELVIN": (0.81549, 0.96139, 3.20),
}


@pytest.mark.parametrize("name", UNIT)
def test_unit_impact(name: str) -> None:
    hit = Impact(build(name, E=0.65).law, 0.0, 1.0)
    d, _, f = hit.motion()
    overlap, force, time = UNIT[name]
    assert d.max() == pytest.approx(overlap, abs=0.6e-5)
    assert f.max() == pytest.approx(force, abs=0.6e-5)
    # the facts have two of the times to two places only, and 2.8788 for Mahmoud-Jankowski:
    # acos(xi) / sqrt(1 - xi^2) + pi / 2 = 2.87900
    assert hit.time == pytest.approx(time, abs=0.6e-4 if round(time, 2) != time else 0.006)
    if name == "MAHMOUD_JANKOWSKI":
        xi = build(name, E=0.65).xi
        assert hit.time == pytest.approx(math.acos(xi) / math.sqrt(1 - xi * xi) + math.pi / 2, rel=1e-10)


@given(st.floats(0.05, 1.0))
def test_relations_of_damping_by_the_force_are_the_implicit_ones(e: float) -> None:
    d = restitution.in_both_phases_constant(e)
    if e < 0.999:  # beyond, the logarithms of this form cancel
        assert math.log1p(d) - math.log1p(-d * e) == pytest.approx(d * (1 + e), rel=1e-7)
    assert restitution.in_both_phases(d) == pytest.approx(e, rel=1e-13)
    assert restitution.in_restitution(restitution.in_restitution_constant(e)) == pytest.approx(e, rel=1e-13)


@pytest.mark.parametrize("x", [0.5, -0.5])
def test_share_is_one_function_on_both_sides_of_its_series(x: float) -> None:
    for scale in (0.2, 0.2002, 1e-3, 1e-9):
        y = x * scale
        series = math.fsum((-y) ** j / (j + 2) for j in range(60))
        assert restitution.phi(y) == pytest.approx(series, rel=1e-13)


def test_hertz_impact_in_closed_form() -> None:
    """delta = (5 m v^2 / 4 k)^0.4, duration 2.94328 delta / v."""
    hit = Impact(build("HERTZ", K=7.0).law, 0.0, 2.0)
    d, _, f = hit.motion()
    deep = (5.0 * 4.0 / (4.0 * 7.0)) ** 0.4
    assert d.max() == pytest.approx(deep, rel=1e-6)
    assert f.max() == pytest.approx(7.0 * deep**1.5, rel=1e-6)
    whole = 2.0 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)
    assert whole == pytest.approx(2.94328, abs=1e-5)
    assert hit.time == pytest.approx(whole * deep / 2.0, rel=1e-9)


# ---------------------------------------------------------------------- slow touches

GUARDED = ("HUNT_CROSSLEY", "HERTZDAMP", "MODIFIED_KELVIN", "RUBBER_BUMPER")


@pytest.mark.parametrize("name", GUARDED)
def test_damping_after_a_slow_touch_is_that_of_the_impact_that_gets_there(name: str) -> None:
    """At any overlap the damping is no larger than in a free impact that reaches it, and the same where
    one just does; closed from the start it does not depend on how slow the touch was.
    """
    law = build(name, E=0.3).law
    n = law.p[1]
    share = 0.5 if name == "RUBBER_BUMPER" else restitution.phi(law.p[3])
    deep = ((n + 1.0) * share) ** (1.0 / (n + 1.0))
    assert Impact(law, 0.0, 1.0).motion()[0].max() == pytest.approx(deep, rel=1e-6)
    states = [law.transition(law.start(), 0, 0.0, v0) for v0 in (1.0, 1e-3, 1e-9, 0.0)]
    if name == "RUBBER_BUMPER":
        states = [law.transition(s, 0, deep, 0.0) for s in states]
    rate = -0.01
    near = deep * (1 - 1e-12)
    fast, *slow = (law.force(consistent(law, s, near, rate), near, rate) for s in states)
    for f in slow:
        assert f[0] == pytest.approx(fast[0], rel=1e-9)
        assert f[2] == pytest.approx(fast[2], rel=1e-5)
    deeper = [law.force(consistent(law, s, 2.0 * deep, rate), 2.0 * deep, rate) for s in states]
    assert all(f[0] == pytest.approx(deeper[0][0], rel=1e-12) for f in deeper)
    tangents = law.force(states[-1], 0.5 * deep, rate)
    h = 1e-6
    slope = law.force(states[-1], 0.5 * deep + h, rate)[0] - law.force(states[-1], 0.5 * deep - h, rate)[0]
    assert tangents[1] == pytest.approx(slope / (2 * h), rel=1e-6)


# ---------------------------------------------------------------------- the program's own impacts

DECK = """UNITS kN m s
NODES
   1  0 0  FIX=YR
   2  1 0  FIX=YR
ELEMENTS
   1  HIT 1 2
PROPS
   HIT CONTACT GAP={gap} LAW={law}
WEIGHTS
   1  981
   2  490.5
INITIAL
   1  VX=1
ANALYSIS
   HISTORY {length} METHOD={method}
OUTPUT
   EVERY={length}/50
"""
STIFF = {"KELVIN_VOIGT": 1e5, "MAHMOUD_JANKOWSKI": 1e5, "MODIFIED_KELVIN": 1e5, "RUBBER_BUMPER": 1e8}


def impact(law: str, method: str, e: float, gap: float = 0.01, length: float = 0.2) -> Any:
    card = f"{law} K={STIFF.get(law.split()[0], 1e6):g} E={e}"
    return run_text(DECK.format(law=card, method=method, gap=gap, length=length))


@each_once(
    ("law", [*LAWS, "POWER_LAW_DAMPED TENSION=YES", "RUBBER_BUMPER THICKNESS=0.03 KU=1E6"]),
    ("e", [0.2, 0.65]),
    at_most=8,
)
def test_steps_give_back_what_was_asked(law: str, e: float) -> None:
    steep = law.split()[0] in ("JANKOWSKI", "POWER_LAW_DAMPED")  # forces like the fourth root of time
    errors = []
    for dt in (1e-3, 2.5e-4):
        r = impact(law, f"NEWMARK DT={dt}", e)
        (hit,) = r.tables["collisions"]
        errors.append(abs(hit["restitution"] - e))
        assert hit["impulse"] == pytest.approx(100 / 3 * (1 + hit["restitution"]), rel=2e-3)
        assert r.tables["contact_laws"]["e_given"][0] == pytest.approx(e, rel=1e-12)
        if "TENSION" not in law:
            assert r.force.min() >= 0.0
    assert errors[0] < 3e-3
    assert errors[1] < 1e-12 or errors[0] / errors[1] > (2.5 if steep else 10.0)
    assert abs(r.check()) < 1e-3


@pytest.mark.parametrize("method", ["NEWMARK DT=5E-4", "HHT DT=5E-4", "CENTRAL DT=5E-4", "AUTO"])
def test_bodies_pressed_together_at_rest_fly_apart(method: str) -> None:
    """All that HERTZ holds, U = k delta^(n+1)/(n+1), becomes motion: m w^2/2 with the relative speed w and
    the reduced mass m; their momenta are opposite.
    """
    deck = DECK.replace("INITIAL\n   1  VX=1\n", "")
    r = run_text(deck.format(law="HERTZ K=1E6", method=method, gap=-0.01, length=0.2))
    apart = math.sqrt(2.0 * 1e6 * 0.01**2.5 / 2.5 / (100 / 3))
    (hit,) = r.tables["collisions"]
    assert r.force[0, 0] == pytest.approx(1e6 * 0.01**1.5, rel=1e-12)
    assert hit["t_start"] == 0.0 and hit["approach_velocity"] == 0.0
    assert hit["separation_velocity"] == pytest.approx(apart, rel=1e-4)
    assert r.v[-1, :, 0] == pytest.approx([-apart / 3, 2 * apart / 3], rel=1e-4)


@pytest.mark.parametrize("e", [0.05, 0.65, 1.0])
def test_exact_gives_back_what_was_asked(e: float) -> None:
    for law in ("KELVIN_VOIGT", "KELVIN_VOIGT TENSION=YES", "MAHMOUD_JANKOWSKI"):
        r = impact(law, "EXACT", e, length=0.5)
        (hit,) = r.tables["collisions"]
        assert hit["restitution"] == pytest.approx(e, rel=1e-10)
        assert abs(r.check()) < 1e-10


@pytest.mark.parametrize("law", ["HUNT_CROSSLEY", "JANKOWSKI"])
def test_auto_takes_steps_and_meets_its_tolerance(law: str) -> None:
    r = impact(law, "AUTO TOL=1E-3", 0.65)
    (hit,) = r.tables["collisions"]
    assert hit["restitution"] == pytest.approx(0.65, abs=1e-3)
    reduced = 100 / 3
    v, k = 1.0, 1e6
    f = Impact(build(law, reduced, K=k, E=0.65).law, 0.0, v, (100.0, 50.0)).motion()[2].max()
    assert hit["peak_force"] == pytest.approx(f, rel=1e-3)


CRITICAL = """UNITS kN m s
GRAVITY 1
NODES
 1 0 0 FIX=XYR
 2 0 1 FIX=YR
 3 1 0 FIX=XYR
 4 1 1 FIX=YR
ELEMENTS
 1 STOREY 1 2
 2 STOREY 3 4
 3 MEET 2 4
PROPS
 STOREY SPRING KX=(2*pi)^2
 MEET CONTACT GAP=0.05 ANGLE=0 LAW=TABLE DEPTHS=0.0025,0.0075,0.015 FORCES=200,280,600 KU=1E5
WEIGHTS
 2,4 1
DAMPING
 RAYLEIGH ALPHA=4*pi BETA=0
INITIAL
 2 VX=1
ANALYSIS
 HISTORY 0.6 METHOD={method}
OUTPUT
 EVERY=0.02
"""


def test_critically_damped_storeys_that_pound() -> None:
    """Their modes do not span the space: the series knows no bounds, and yet no turn is passed over."""
    exact, steps = (run_text(CRITICAL.format(method=m)) for m in ("EXACT", "NEWMARK DT=1E-5"))
    forces = [r.tables["contact_summary"]["peak_force"][0] for r in (exact, steps)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)
    assert exact.u[-1] == pytest.approx(steps.u[-1], rel=1e-6, abs=1e-9)
